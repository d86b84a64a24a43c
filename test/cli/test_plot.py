"""`cnc_ptp plot` and the parts of a recording that a report shows."""

import re

import numpy as np
import pytest
from click.testing import CliRunner

from cnc_ptp import cli
from cnc_ptp.plots.over_time import Marker, label_rows
from cnc_ptp.plots.panels import AXIS, SPINDLE
from cnc_ptp.plots.recording_picture import OTHER, Heading, draw_rows, panel_of
from cnc_ptp.protocol.blocks import Event
from cnc_ptp.recording.fields import chosen_rows, quantity, usual_rows
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.rows import Line, PlotRow
from cnc_ptp.recording.selection import selected

SCENARIO = """
- {at: 0.1, to: x, do: move_absolute, target: 120, velocity: 400}
- {at: 0.2, to: c, do: move_relative, distance: -90}
- {at: 0.5, to: x, do: set_override, percent: 50}
"""


def call(*arguments):
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """x and c move, y and z stand; 1.5 s."""
    folder = tmp_path_factory.mktemp("plot")
    (folder / "moves.yaml").write_text(SCENARIO)
    options = ("--scenario", folder / "moves.yaml", "--duration", "1.5", "--record", folder / "run.mcap")
    assert call("simulate", "config/ptp.yaml", *options).exit_code == 0
    return folder / "run.mcap"


def texts(svg):
    return [text.strip() for text in re.findall(r"<text[^>]*>([^<]*)</text>", svg)]


def test_usual_picture_stands_beside_the_recording(recording):
    result = call("plot", recording)
    picture = recording.with_suffix(".svg")
    assert (result.exit_code, result.output) == (0, f"{picture}: 8 plots, 0 s to 1.5 s\n")
    svg = picture.read_text()
    found = texts(svg)
    for heading in (
        "X: position in mm",
        "X: velocity in mm/s",
        "X: acceleration in mm/s²",
        "C: position in deg",
        "C: following error in deg",
        "x: move absolute 120",
        "c: move relative −90",
        "x: set override 50 %",
    ):
        assert heading in found, found
    assert not any(text.startswith(("Y:", "Z:")) for text in found)
    assert call("plot", recording).exit_code == 0
    assert picture.read_text() == svg  # the same for the same recording


def test_chosen_fields_share_a_plot_by_quantity(recording):
    recorded = read_recording(recording)
    words = ["x/set_velocity", "/c/state/set_velocity", "x/actual_velocity", "x/following_error", "state"]
    rows = chosen_rows(recorded, words, {"x": "mm", "c": "deg"}, {})
    assert [(row.heading, [line.name for line in row.lines]) for row in rows] == [
        ("X: velocity in mm/s", ["set", "actual"]),
        ("C: velocity in deg/s", ["set"]),
        ("X: following error in mm", ["following error"]),
        ("State", ["X", "C"]),
    ]
    both = chosen_rows(recorded, ["x/set_position", "z/set_position"], {}, {})
    assert [(row.heading, [line.name for line in row.lines]) for row in both] == [
        ("Position in mm", ["X set", "Z set"])
    ]


def test_fields_are_found_without_their_unit(tmp_path):
    """The following error of a spindle is `following_error_deg`, its speed `set_speed_rpm`."""
    (tmp_path / "turn.yaml").write_text("- {at: 0.01, to: s, do: start, direction: cw, speed_rpm: 100}\n")
    options = ("--scenario", tmp_path / "turn.yaml", "--duration", "0.2", "--record", tmp_path / "run.mcap")
    assert call("simulate", "config/mill.yaml", *options).exit_code == 0
    rows = chosen_rows(read_recording(tmp_path / "run.mcap"), ["following_error", "s/set_speed"], {}, {})
    assert [(row.heading, row.lines[0].field) for row in rows] == [
        ("S: following error in deg", "following_error_deg"),
        ("S: speed in rpm", "set_speed_rpm"),
    ]


@pytest.mark.parametrize(
    ("field", "found"),
    [
        ("set_speed_rpm", ("speed", "set")),
        ("actual_position_deg", ("position", "actual")),
        ("set_acceleration_deg_s2", ("acceleration", "set")),
        ("set_position_modulo", ("position_modulo", "set")),
        ("following_error", ("following_error", "")),
        ("override_percent", ("override", "")),
    ],
)
def test_quantities(field, found):
    assert quantity(field) == found


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["x/set_velocty"], "no field 'set_velocty' of 'x'; did you mean 'set_velocity' or 'actual_velocity' or 'additive_velocity'?"),
        (["--topics", "xx/set_velocity"], "no unit 'xx' with states; did you mean 'x'?"),
        (["set_velocitty"], "no field 'set_velocitty'; did you mean 'set_velocity' or 'actual_velocity' or 'additive_velocity'?"),
        (["x"], "'x' as a unit, not as a field; give one of its fields, x/set_position"),
        (["--axes", "x,w"], "no axis or spindle 'w'; known are x, y, z, c"),
    ],
)  # fmt: skip
def test_unknown_names(recording, arguments, text):
    result = call("plot", recording, *arguments, "-o", recording.parent / "no.svg")
    expected = f"P-ERR-26011 recording {recording}: holds {text}; nothing was drawn\n"
    assert (result.exit_code, result.stderr) == (2, expected)
    assert not (recording.parent / "no.svg").exists()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--from", "3"], "nothing from 3 s to the end, it covers 0 s to 1.499 s; nothing was drawn"),
        (["--from", "0.5", "--to", "0.5"], "nothing from 0.5 s to 0.5 s, it covers 0 s to 1.499 s; nothing was drawn"),
        (["--to", "-1"], "nothing from the start to -1 s, it covers 0 s to 1.499 s; nothing was drawn"),
        (["--axes", "y"], "no axis and no spindle moves there; nothing was drawn, choose fields with --topics"),
        (["--to", "0.1"], "no axis and no spindle moves there; nothing was drawn, choose fields with --topics"),
    ],
)  # fmt: skip
def test_parts_in_which_there_is_nothing(recording, options, text):
    result = call("plot", recording, *options)
    assert (result.exit_code, result.stderr) == (2, f"P-ERR-26011 recording {recording}: {text}\n")


def test_part_of_a_recording(recording):
    part = selected(read_recording(recording), begin=0.2, end=0.4, units=["x"])
    assert list(part.states) == ["/x/state"]
    assert (part.states["/x/state"]["cycle"][0], part.states["/x/state"]["cycle"][-1]) == (200, 399)
    assert {command.command for command in part.commands} == set()
    whole = selected(read_recording(recording), begin=0.0)
    assert [command.command for command in whole.commands if command.target == "c"] == ["move_relative"]
    result = call("plot", recording, "--from", "0.2", "--to", "0.4", "-o", recording.parent / "part.png")
    assert result.output == f"{recording.parent}/part.png: 8 plots, 0.2 s to 0.4 s\n"
    assert (recording.parent / "part.png").read_bytes().startswith(b"\x89PNG")


def test_events_of_other_axes_are_left_out(recording):
    """Those of the chosen ones stay, and those that come of no axis and no spindle."""
    recorded = read_recording(recording)
    recorded.events = [Event(300, source, 1, 23001, "text") for source in ("x", "c", "plc", "supervisor")]
    part = selected(recorded, units=["x"])
    assert [event.source for event in part.events] == ["x", "plc", "supervisor"]
    assert len(selected(recorded, begin=0.1).events) == 4


def test_report_of_a_part(recording):
    output = recording.parent / "part.html"
    result = call("report", recording, "--from", "0.25", "--to", "0.75", "--axes", "x", "-o", output)
    assert result.exit_code == 0, result.output
    assert result.output.endswith("cycles 250 to 749\n")
    page = output.read_text()
    assert "X: position in mm" in page
    assert "C: position" not in page
    assert '<td class="text">percent = 50 %</td>' in page


def test_page_of_some_plots(recording):
    output = recording.parent / "run.html"
    assert call("plot", recording, "x/set_velocity", "-o", output).exit_code == 0
    page = output.read_text()
    assert "X: velocity in mm" in page
    assert "<h2>Events</h2>" not in page


def test_output_that_is_no_picture_or_the_recording(recording):
    result = call("plot", recording, "-o", "run.pdf")
    text = "P-ERR-27030 run.pdf: the file name of a picture must end in .svg, .png or .html; nothing was started\n"
    assert (result.exit_code, result.stderr) == (2, text)


@pytest.mark.parametrize(("command", "name"), [("report", "full.html"), ("plot", "full.svg")])
def test_output_that_cannot_be_written(recording, tmp_path, command, name):
    (tmp_path / name).symlink_to("/dev/full")
    result = call(command, recording, "-o", tmp_path / name)
    text = f"P-ERR-27030 {tmp_path}/{name} cannot be written: No space left on device; the recording is unchanged\n"
    assert (result.exit_code, result.stderr) == (2, text)


def test_values_and_labels_of_the_picture(recording):
    recorded = read_recording(recording)
    rows = [row for row in usual_rows(recorded, {"x": "mm", "c": "deg"}) if row.title == "velocity"]
    drawing = draw_rows(recorded, rows, Heading("t", "c"), (0.0, 1.5))
    first, second = drawing.axes
    highest = recorded.states["/x/state"]["set_velocity"].max()
    drawn = next(line for line in first.lines if len(line.get_xdata()) > 2 and line.get_linewidth() == 1.4)
    assert np.max(drawn.get_ydata()) == highest
    assert (first.get_xlim(), second.get_xlim()) == ((0.0, 1.5), (0.0, 1.5))


@pytest.mark.parametrize(
    ("field", "panel"),
    [
        ("set_velocity", AXIS["velocity"]),
        ("actual_speed_rpm", SPINDLE["speed"]),
        ("actual_position_deg", AXIS["position"]),
        ("following_error_deg", AXIS["following error"]),
        ("feedforward_velocity", AXIS["feedforward"]),
        ("friction_current", AXIS["friction current"]),
        ("override_percent", OTHER),
    ],
)
def test_pictures_have_the_panels_of_the_figures(field, panel):
    """Whatever the row is called."""
    assert panel_of(PlotRow("", "as the report calls it", "", [Line("", np.empty(0), field)])) == panel


def test_labels_of_a_part_begin_at_its_begin():
    [label] = label_rows([Marker(10.0, "stop")], 10.0, 12.0)
    assert (label.row, label.at_left) == (0, False)
    [label] = label_rows([Marker(11.99, "x: move absolute 100")], 10.0, 12.0)
    assert label.at_left
