"""Plots of a recording: which units and columns, columns as texts, commands in words."""

import base64
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples
from recording_support import smooth_run, time_figure

from cnc_ptp.plots.colours import BY_AXIS, DARK, INK, RED
from cnc_ptp.plots.path_figures import actual_path_figures
from cnc_ptp.plots.report import report_page
from cnc_ptp.plots.report_figures import colour_of
from cnc_ptp.protocol.blocks import CommandRecord
from cnc_ptp.recording.columns import STEPS, packed
from cnc_ptp.recording.command_words import argument_words, brief, command_words
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.rows import standing, time_rows


@pytest.fixture
def recorded(tmp_path):
    smooth_run(tmp_path / "run.mcap", 0.5)
    return read_recording(tmp_path / "run.mcap")


def still(recorded, *units):
    """The recording, in which these units stand."""
    for unit in units:
        rows = recorded.states[f"/{unit}/state"] = recorded.states[f"/{unit}/state"].copy()
        for name in rows.dtype.names:
            if name.startswith(("set_", "actual_", "following", "target", "distance")):
                rows[name] = rows[name][0] if "position" in name else 0
    return recorded


def headings(recorded):
    return [row.heading for row in time_rows(recorded, {}, {})]


def test_what_stands_has_no_plot_and_is_named(recorded):
    recorded = still(recorded, "y", "s")
    assert standing(recorded) == ["s", "y"]
    found = headings(recorded)
    assert [heading for heading in found if heading.startswith(("Y:", "s:"))] == []
    assert "X: position in mm" in found
    [override] = [row for row in time_rows(recorded, {}, {}) if row.title == "override"]
    assert [line.name for line in override.lines] == ["channel", "x", "z"]
    assert "Without plots, as they do not move: s, y." in report_page(recorded)


def test_spindle_has_angle_target_and_following_error_where_they_are_in_use(recorded):
    assert [heading for heading in headings(recorded) if heading.startswith("s:")] == ["s: speed in rpm"]
    rows = recorded.states["/s/state"] = recorded.states["/s/state"].copy()
    rows["set_position_deg"] = np.linspace(0.0, 720.0, len(rows))
    rows["target_position_deg"] = 765.0
    rows["following_error_deg"][7] = 0.1
    found = {row.title: [line.name for line in row.lines] for row in time_rows(recorded, {}, {}) if row.unit == "s"}
    assert found == {
        "speed": ["set", "actual"],
        "angle": ["set", "actual", "target"],
        "following error": ["following error"],
    }


def test_weight_of_the_feedforward_is_shown_where_it_acts(recorded):
    """In x and the spindle, constant as it is; y has a weight but nothing to weigh, z and old recordings have none."""
    assert not any(row.title == "feedforward weight" for row in time_rows(recorded, {}, {}))
    x, y, s = (recorded.states[f"/{unit}/state"].copy() for unit in "xys")
    x["feedforward_percent"], y["feedforward_percent"], s["feedforward_percent"] = 100.0, 100.0, 80.0
    x["additive_torque"] = 0.5
    recorded.states |= {"/x/state": x, "/y/state": y, "/s/state": s}
    [row] = [row for row in time_rows(recorded, {}, {}) if row.title == "feedforward weight"]
    assert (row.heading, row.legend) == ("Feedforward weight in %", True)
    assert [(line.name, line.rows[line.field][0]) for line in row.lines] == [("x", 100.0), ("s", 80.0)]
    names = [name for name in x.dtype.names if name != "feedforward_percent"]
    recorded.states["/x/state"] = x[names]
    [row] = [row for row in time_rows(recorded, {}, {}) if row.title == "feedforward weight"]
    assert [line.name for line in row.lines] == ["s"]


def test_space_is_drawn_only_where_there_is_a_path_in_it(recorded):
    assert len(actual_path_figures(recorded, {})) == 2
    assert len(actual_path_figures(still(recorded, "z"), {})) == 1
    assert actual_path_figures(still(recorded, "y"), {}) == []


def test_no_path_without_a_channel_that_moves_along_one(recorded):
    rows = recorded.states["/channel/state"] = recorded.states["/channel/state"].copy()
    rows["path_velocity"] = 0.0
    assert actual_path_figures(recorded, {}) == []


def test_commands_are_marked_in_all_plots(recorded):
    figure = time_figure(recorded, {})
    assert [shape.x0 for shape in figure.layout.shapes] == [0.0, 0.01, 0.9]
    assert {(shape.yref, shape.y0, shape.y1) for shape in figure.layout.shapes} == {("paper", 0, 1)}
    [marks] = [trace for trace in figure.data if trace.meta == "commands"]
    assert list(marks.customdata) == [
        "channel load program = bracket.nc",
        "channel start",
        "x move absolute target = 9999",
    ]
    recorded.commands *= 200
    for cycle, command in enumerate(recorded.commands):
        recorded.commands[cycle] = CommandRecord(cycle, command.target, command.command, "{}", True, 0, "")
    assert len(time_figure(recorded, {}).layout.shapes) == 0


def test_lines_have_the_colours_of_the_figures(recorded):
    """Set and actual values have two of their own, which differ; a unit has one of the figures'."""
    rows = list(time_rows(recorded, {}, {}))
    colours = {(row.title, line.name): colour_of(row, i) for row in rows for i, line in enumerate(row.lines)}
    pairs = {colours.pop(("position", "set")), colours.pop(("position", "actual"))}
    assert len(pairs) == 2
    assert {colour for colour in colours.values() if colour not in pairs} <= {*DARK}
    of_units = [colours["override", name] for name in ("channel", "x", "y", "z", "s")]
    assert of_units == [pair.set for pair in BY_AXIS[:5]]
    assert colours["following error", "following error"] == RED.set
    assert f"<style>:root {{ --ink: {INK}; " in report_page(recorded)


# commands in words


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("{}", ""),
        ('{"target": 100.0, "velocity": 50.5}', "target = 100 mm, velocity = 50.5 mm/s"),
        ('{"acceleration": 1e6, "jerk": 5e7}', "acceleration = 1000000 mm/s², jerk = 50000000 mm/s³"),
        ('{"percent": 75.0, "enabled": false}', "percent = 75 %, enabled = off"),
        ('{"speed_rpm": 3000.0, "position": 90}', "speed = 3000 rpm, position = 90 mm"),
        ('{"table": [[0, 1], [2, 3]], "above": ["x", "y"]}', "table = (2 rows), above = x y"),
        ('{"cycles": [1, 2, 3, 4, 5, 6, 7]}', "cycles = (7 values)"),
        ('{"text": "a\\nb", "source": null, "list": []}', "text = (2 lines), source = none, list = none"),
        ('{"limits": {"max_speed_rpm": 5}}', "limits = max speed 5 rpm"),
        ("{broken", "{broken"),
        ("[1]", "[1]"),
    ],
)
def test_arguments_have_names_and_units(arguments, words):
    assert argument_words(arguments, "mm") == words


def test_units_are_those_of_the_axis():
    command = CommandRecord(1, "c", "move_relative", '{"distance": -90.0, "velocity": 5}', True, 0, "")
    assert command_words(command, {"c": "deg"}) == "move relative distance = -90 deg, velocity = 5 deg/s"
    assert command_words(command, {}) == "move relative distance = -90, velocity = 5"
    assert brief(command) == "move relative −90"
    assert brief(CommandRecord(1, "c", "power", '{"enabled": true}', True, 0, "")) == "power on"
    assert brief(CommandRecord(1, "c", "odd", "[]", True, 0, "")) == "odd"


# columns


def unpacked(column):
    """The values again; as report.js does it."""
    data = zlib.decompress(base64.b64decode(column["text"]), -15)
    planes = np.frombuffer(data, dtype=np.uint8).reshape(4, -1)
    zigzag = np.ascontiguousarray(planes.T).view("<u4")[:, 0]
    wrapped = (zigzag >> np.uint32(1)) ^ (np.uint32(0) - (zigzag & np.uint32(1)))
    for _ in range(column["order"]):
        wrapped = np.cumsum(wrapped, dtype=np.uint32)
    numbers = wrapped.view(np.int32)
    values = column["offset"] + column["step"] * numbers.astype(np.float64)
    values[numbers == np.iinfo(np.int32).min] = np.nan
    return values


@settings(max_examples=examples(60), deadline=None)
@given(
    values=st.lists(st.floats(-1e6, 1e6) | st.just(float("nan")), min_size=1, max_size=200),
    turns=st.integers(0, 3),
)
def test_columns_keep_every_value_within_a_step(values, turns):
    column = np.array(values)
    for _ in range(turns):
        column = np.cumsum(column)
    text = packed(column)
    again = unpacked(text)
    finite = np.isfinite(column)
    span = float(np.ptp(column[finite])) if finite.any() else 0.0
    assert np.array_equal(np.isnan(again), ~finite)
    assert np.all(
        np.abs(again[finite] - column[finite]) <= 0.51 * span / STEPS + 1e-9 * np.abs(column[finite]) + 1e-300
    )


@given(values=st.lists(st.integers(1 - 2**30, 2**30 - 1), min_size=1, max_size=100))
def test_whole_numbers_stay_exact(values):
    assert unpacked(packed(np.array(values))).tolist() == [float(value) for value in values]


def test_smooth_motion_takes_little_room():
    """Ten minutes of a sine in cycles of 1 ms: 4.8 MB as numbers."""
    time = np.arange(600_000) * 1e-3
    assert len(packed(100.0 * np.sin(time))["text"]) < 200_000
    assert len(packed(np.arange(600_000))["text"]) < 5_000
