"""The figures of a run and the page: what is in it, that it needs no network, that texts cannot become code."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from recording_support import MACHINE, smooth_run, time_figure

from cnc_ptp.parameters import load_machine
from cnc_ptp.plots.path_figures import actual_path_figures, path_axes
from cnc_ptp.plots.report import report_page
from cnc_ptp.plots.report_figures import state_bands
from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.blocks import CommandRecord, Event
from cnc_ptp.recording import statistics
from cnc_ptp.recording.reader import Diagnostic, read_recording
from cnc_ptp.recording.selection import selected
from cnc_ptp.recording.statistics import Extreme, axis_units, in_machine_order, last_diagnostics, summary, torque_units
from cnc_ptp.recording.writer import Recording
from cnc_ptp.wire.layout import Header, encode
from cnc_ptp.wire.schemas import load_schema

EVIL = '</script><script>alert("1")</script><img src=x onerror=alert(2)>'
PROJECT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "run.mcap"
    smooth_run(path, 2.0, text=EVIL)
    return path


@pytest.fixture
def recorded(path):
    return read_recording(path)


def test_summary(recorded):
    figures = summary(recorded)
    extreme = figures.pop("following_error")
    assert figures == {
        "program_time_s": pytest.approx(1.89),
        "duration_s": pytest.approx(2.0),
        "cycles": 2000,
        "blocks": 200,
        "lost_blocks": 0,
        "units": {},
        "lateness_p50_ms": None,
        "lateness_p99_ms": None,
        "errors": 1,
        "warnings": 1,
        "commands": 3,
        "refused": 1,
        "complete": True,
        "missing": "",
    }
    errors = recorded.states["/x/state"]["following_error"]
    assert extreme["x"] == Extreme(errors[250], 250, 0.25)
    assert abs(extreme["x"].value) == np.abs(errors).max()


def test_lateness_and_lost_blocks_come_from_the_nodes(recorded):
    recorded.diagnostics = [
        Diagnostic(1, "x", {"lateness p50 [ms]": "0.9", "lateness p99 [ms]": "3.0", "lost blocks": "0"}),
        Diagnostic(2, "y", {"lateness p50 [ms]": "1.1", "lateness p99 [ms]": "none", "lost blocks": "3"}),
        Diagnostic(3, "x", {"lateness p50 [ms]": "0.9", "lateness p99 [ms]": "2.9", "lost blocks": "1"}),
    ]
    figures = summary(recorded)
    assert (figures["lateness_p50_ms"], figures["lateness_p99_ms"], figures["lost_blocks"]) == (1.1, 2.9, 4)
    page = report_page(recorded)
    assert "1.1 / 2.9 ms" in page
    assert "<h2>Nodes</h2>" in page


def test_missing_cycles_count_as_lost_blocks(recorded):
    rows = recorded.states["/x/state"]
    recorded.states["/x/state"] = np.delete(rows, [*range(100, 110), *range(500, 535)])
    assert summary(recorded)["lost_blocks"] == 1 + 4


def test_nan_is_the_largest_following_error(recorded):
    rows = recorded.states["/y/state"] = recorded.states["/y/state"].copy()
    rows["following_error"][77] = np.nan
    assert summary(recorded)["following_error"]["y"].cycle == 77


def test_units_come_from_the_machine_file(recorded):
    assert axis_units(recorded) == {}
    recorded.machine_yaml = (PROJECT / "config" / "mill.yaml").read_text()
    assert axis_units(recorded) == {"x": "mm", "y": "mm", "z": "mm"}
    assert path_axes(recorded, {"x": "mm", "y": "mm", "z": "deg"}) == ["x", "y"]


def test_every_quantity_has_a_plot_and_all_zoom_together(recorded):
    figure = time_figure(recorded, {"z": "deg"})
    titles = [annotation.text for annotation in figure.layout.annotations]
    assert titles[:5] == [
        "States, events and commands",
        "channel: feed in mm/min",
        "Override in %",
        "channel: program line",
        "s: speed in rpm",
    ]
    assert titles[5:10] == [
        "X: position in mm",
        "X: velocity in mm/s",
        "X: acceleration in mm/s²",
        "X: jerk in mm/s³",
        "X: following error in mm",
    ]
    assert titles[15] == "Z: position in deg"
    axes = [axis for name, axis in figure.to_dict()["layout"].items() if name.startswith("xaxis")]
    assert len(axes) == len(titles) == 20
    leaders = [axis["matches"] for axis in axes if "matches" in axis]
    assert len(leaders) == 19
    assert len(set(leaders)) == 1
    position = next(trace for trace in figure.data if trace.yaxis == "y6" and trace.name == "actual")
    assert (position.y.min(), position.y.max()) == (
        recorded.states["/x/state"]["actual_position"].min(),
        recorded.states["/x/state"]["actual_position"].max(),
    )


def test_torque_feedforward_and_friction_have_plots_where_they_are_in_use(recorded):
    """Feedforward and torque of x and the friction current of y; what the recording lacks or is 0 has none."""
    x, y = (recorded.states[f"/{axis}/state"].copy() for axis in "xy")
    x["feedforward_velocity"], x["additive_torque"], x["actual_torque"] = 5.0, 0.25, -0.125
    y["friction_current"][1000:] = 37.0
    recorded.states |= {"/x/state": x, "/y/state": y}
    figure = time_figure(recorded, {"z": "deg"}, {"x": "Nm"})
    titles = [annotation.text for annotation in figure.layout.annotations]
    rest = [title for title in titles if "feedforward" in title or "torque" in title or "friction" in title]
    assert rest == [
        "X: feedforward in mm/s",
        "X: torque in Nm",
        "Y: friction compensation, current in digits of the drive",
    ]
    lines = {trace.name: set(trace.y) for trace in figure.data if trace.name in ("to the position controller", "drive")}
    assert lines == {"to the position controller": {5.0}, "drive": {-0.125}}
    assert "to the drive" not in {trace.name for trace in figure.data}


def test_recordings_without_actual_torque_are_shown(recorded):
    """As they were before the field came."""
    rows = recorded.states["/x/state"]
    names = [name for name in rows.dtype.names if name != "actual_torque"]
    recorded.states["/x/state"] = rows[names]
    rows["additive_torque"] = 1.0
    titles = [annotation.text for annotation in time_figure(recorded, {}).layout.annotations]
    assert "X: torque in Nm or N" in titles


def test_units_stand_in_the_order_of_the_machine_file(tmp_path):
    """However the nodes of the graph were heard; a recording without a machine file keeps that order."""
    smooth_run(tmp_path / "run.mcap", 0.1, axes=("z", "q", "y", "x"))
    recorded = read_recording(tmp_path / "run.mcap")
    recorded.diagnostics = [Diagnostic(1, name, {"blocks": "5"}) for name in ("plc", "y", "s", "x", "y", "channel")]
    assert in_machine_order(recorded) is recorded
    page = report_page(recorded)
    assert re.findall("largest following error of ([a-z])", page) == ["z", "q", "y", "x"]
    recorded.machine_yaml = (PROJECT / "config" / "mill.yaml").read_text()
    page = report_page(recorded)
    assert re.findall("largest following error of ([a-z])", page) == ["x", "y", "z", "q"]
    titles = re.findall('"([A-Z]): position in mm"', page)
    assert titles == ["X", "Y", "Z", "Q"]
    assert list(last_diagnostics(in_machine_order(recorded))) == ["channel", "s", "x", "y", "plc"]


def test_a_report_reads_the_machine_file_once(recorded, monkeypatch):
    recorded.machine_yaml = (PROJECT / "config" / "mill.yaml").read_text() + "# of this test\n"
    read = []
    monkeypatch.setattr(statistics, "load_machine", lambda *given: read.append(given) or load_machine(*given))
    assert "largest following error of x" in report_page(selected(recorded, end=1.0))
    assert read == [(recorded.machine_yaml, "machine.yaml")]


def test_torque_units_come_from_the_machine_file(recorded):
    assert torque_units(recorded) == {}
    axes = "/machine: {ros__parameters: {channels: [ch], axes: [a, b, c]}}\n"
    linear = "/b: {ros__parameters: {antr.feed_const_num: 100000, antr.feed_const_denom: 1}}\n"
    recorded.machine_yaml = axes + linear + "/c: {ros__parameters: {kenngr.achs_typ: ACHSTYP_ROTATOR}}\n"
    assert torque_units(recorded) == {"a": "N", "b": "Nm", "c": "Nm"}


def test_path_is_drawn_in_the_plane_and_in_space(recorded):
    plane, space = actual_path_figures(recorded, {})
    assert [trace.type for trace in plane.data] == ["scatter", "scatter"]
    assert [trace.name for trace in space.data] == ["run", "cursor"]
    assert space.data[0].type == "scatter3d"
    radius = np.hypot(plane.data[1].x, plane.data[1].y)
    assert radius == pytest.approx(np.full(len(radius), 42.7), abs=0.1)


def test_path_can_be_coloured_by_the_following_error(recorded):
    """Of all axes together: the root of the sum of squares; on the circle 40 mm · 2π / (16.7 1/s), and 3 mm/s of z."""
    for figure in actual_path_figures(recorded, {}):
        [menu] = figure.layout.updatemenus
        assert [button.label for button in menu.buttons] == ["feed", "following error"]
        changes, _ = menu.buttons[1].args
        [colours] = next(value for name, value in changes.items() if name.endswith(".color"))
        expected = np.hypot(40.0 * 2.0 * np.pi / 16.7, 3.0 / 16.7)
        assert colours == pytest.approx(np.full(len(colours), expected), rel=1e-5)
        assert changes["hovertemplate"][0].endswith(":.4f} mm<extra></extra>")


@pytest.mark.parametrize(("axes", "count"), [((), 0), (("x",), 0), (("x", "y"), 1), (("u", "v", "w"), 2)])
def test_path_needs_two_axes(tmp_path, axes, count):
    smooth_run(tmp_path / "run.mcap", 0.1, axes=axes)
    assert len(actual_path_figures(read_recording(tmp_path / "run.mcap"), {})) == count


def test_state_bands(recorded):
    rows = recorded.states["/x/state"][:30].copy()
    rows["state"] = [1] * 5 + [5] * 20 + [200] * 5
    assert [(name, round(begin, 6), round(end, 6)) for name, begin, end in state_bands(rows, AxisStateCode, 1e-3)] == [
        ("STANDSTILL", 0.0, 0.005),
        ("SYNCHRONIZED_MOTION", 0.005, 0.025),
        ("DISABLED", 0.025, 0.03),
    ]
    assert list(state_bands(rows[:0], AxisStateCode, 1e-3)) == []


def test_page_is_self_contained(recorded):
    page = report_page(recorded, program="bracket.nc", date="2026-05-04 12:00")
    own = re.sub(r"<script>/\*\*.*?</script>", "", page, count=1, flags=re.DOTALL)  # without the library
    assert len(own) < len(page) - 4_000_000
    assert re.findall(r"<[a-z]+[^>]*\s(?:src|href)\s*=|@import|url\(|https?:", own) == []
    assert "default-src 'none'" in own
    assert "<h1>bracket.nc</h1><p>2026-05-04 12:00 · run.mcap</p>" in own
    assert len(page) < 7_000_000


def test_texts_cannot_become_code(recorded):
    recorded.commands.append(CommandRecord(5, EVIL, EVIL, EVIL, False, 1, EVIL))
    recorded.events.append(Event(5, EVIL, 7, 1, EVIL))
    recorded.diagnostics = [Diagnostic(0, EVIL, {EVIL: EVIL})]
    recorded.states[f"/{EVIL}/state"] = recorded.states["/x/state"]
    recorded.topics[f"/{EVIL}/state"] = recorded.topics["/x/state"]
    recorded.attachments = {EVIL: EVIL}
    recorded.complete, recorded.missing = False, EVIL
    page = report_page(recorded, program=EVIL, date=EVIL)
    assert EVIL not in page
    assert '<script>alert("1")' not in page
    assert "<img src=x" not in page
    assert "&lt;img src=x onerror=alert(2)&gt;" in page


def test_tables_mark_errors_and_refusals(recorded):
    page = report_page(recorded)
    assert '<tr class="error"><td class="number">1.200</td><td class="number">1200</td>' in page
    assert '<tr class="warning">' in page
    assert '<tr class="refused"><td class="number">0.900</td>' in page
    assert '<td class="text">target = 9999</td>' in page
    assert '<td class="text">P-ERR-23010 x: target 9999.0 mm; refused</td>' in page


def test_arguments_that_are_no_object_are_shown_as_they_are(recorded):
    recorded.commands = [
        CommandRecord(1, "x", "a", "{broken", True, 0, ""),
        CommandRecord(1, "x", "b", "[1]", True, 0, ""),
    ]
    page = report_page(recorded)
    assert "{broken" in page
    assert "[1]" in page


def test_programs_are_shown_once_with_line_numbers(recorded):
    arguments = json.dumps({"program": "part.nc", "text": "N10 G1 X<1\nM30\n"})
    recorded.commands = [
        CommandRecord(0, "channel", "load", arguments, True, 0, ""),
        CommandRecord(0, "channel", "load", arguments.replace("part", "other"), False, 1, "busy"),
    ]
    page = report_page(recorded)
    assert '<td class="text">program = part.nc, text = (2 lines)</td>' in page
    assert "<summary>NC program part.nc</summary><pre>    1  N10 G1 X&lt;1\n    2  M30</pre>" in page
    assert "<summary>NC program other.nc</summary>" not in page


def test_long_tables_are_cut_and_say_so(recorded):
    recorded.events = [Event(cycle, "x", 0, 0, "tick") for cycle in range(1500)]
    page = report_page(recorded)
    assert "The first 1000 of 1500 events." in page
    assert page.count(">tick<") == 1000


def test_incomplete_recording_says_so(recorded, path, tmp_path):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[:-200])
    page = report_page(read_recording(cut))
    assert '<p class="warn">Incomplete recording: the file ends at offset ' in page
    assert "<h1>cut.mcap</h1>" in page


def test_recording_without_states(tmp_path):
    with Recording(tmp_path / "run.mcap", MACHINE) as recording:
        recording.raw(
            "/events",
            "cnc_ptp/msg/Event",
            encode(load_schema("cnc_ptp/msg/Event"), Event(0, "x", 0, 0, ""), lambda _: Header()),
            0,
        )
    recorded = read_recording(tmp_path / "run.mcap")
    assert summary(recorded)["cycles"] == 0
    assert summary(recorded)["program_time_s"] is None
    page = report_page(recorded)
    assert "The recording holds no states." in page
    assert "No commands." in page
