"""`cnc_ptp plot PROGRAM --machine MACHINE`: the run of a program as a page, and the same in a report."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from cnc_ptp import cli
from cnc_ptp.commands.look import program_plot
from cnc_ptp.parameters import read_machine
from cnc_ptp.plots import program_page
from cnc_ptp.plots.path_figures import path_axes
from cnc_ptp.plots.program_run import ProgramRun, program_run
from cnc_ptp.recording.reader import Recorded, read_recording
from cnc_ptp.recording.rows import SET
from cnc_ptp.recording.statistics import axis_units
from cnc_ptp.recording.surfaces import surfaces

MILL = "config/mill.yaml"
SQUARE = """%P
N10 G60 G01 X30 F3000
N20 G03 X30 Y20 I0 J10
N30 G04 0.5
N40 G01 X0
#CONTOUR MODE [DEV PATH_DEV=0.1]
N50 G261 Y40
N60 X30 Y0 Z5
M30
"""
TURN = 10.0 * math.pi
LENGTHS = {10: 30.0, 20: TURN, 30: 0.0, 40: 30.0}


def call(*arguments: object) -> Result:
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With the program square.nc and the recording of its run."""
    folder = tmp_path_factory.mktemp("plot")
    (folder / "square.nc").write_text(SQUARE)
    result = call("simulate", MILL, "--program", folder / "square.nc", "--record", folder / "run.mcap")
    assert result.exit_code == 0, result.output
    return folder


@pytest.fixture
def recorded(folder: Path) -> Recorded:
    return read_recording(folder / "run.mcap")


def run_of(recorded: Recorded) -> ProgramRun:
    run = program_run(recorded, path_axes(recorded, axis_units(recorded)))
    assert run is not None
    return run


def cells(page: str) -> list[list[str]]:
    """Rows of the table of blocks."""
    table = page.partition("<h2>Blocks</h2>")[2].partition("</table>")[0]
    return [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in table.split("<tr>")[2:]]


def test_page_of_a_program(folder: Path) -> None:
    result = call("plot", folder / "square.nc", "--machine", MILL)
    page = folder / "square.html"
    assert result.exit_code == 0, result.output
    text = page.read_text()
    said = re.fullmatch(r"(.*): ([\d.]+) MB, program time ([\d.]+) s, path ([\d.]+) mm\n", result.output)
    assert said and said[1] == str(page)
    simulated = re.search(r"program time ([\d.]+) s", call("simulate", MILL, "--program", folder / "square.nc").output)
    assert simulated and float(said[3]) == pytest.approx(float(simulated[1]), abs=0.02)
    for heading in ("Path of the program", "Over the path", "Blocks", "Over time"):
        assert f"<h2>{heading}</h2>" in text
    assert f"<b>{said[3]} s</b><span>program time</span>" in text
    assert "http-equiv" in text and "<script src" not in text
    rows = {row[1]: row for row in cells(text) if row[1]}
    assert rows["20"][:3] == ["3", "20", "N20 G03 X30 Y20 I0 J10"]
    for number, length in LENGTHS.items():
        assert float(rows[str(number)][3]) == pytest.approx(length, abs=2e-3)
    assert float(rows["30"][4]) == pytest.approx(0.5, abs=0.002)
    assert rows["10"][5:] == ["3000", "3000"]
    assert sum(float(row[4]) for row in cells(text)) == pytest.approx(float(said[3]), abs=0.002)


def test_table_and_path_of_a_recording_are_the_same(folder: Path) -> None:
    assert call("plot", folder / "square.nc", "--machine", MILL, "-o", folder / "plot.html").exit_code == 0
    assert call("report", folder / "run.mcap", "-o", folder / "report.html").exit_code == 0
    plot, report = ((folder / name).read_text() for name in ("plot.html", "report.html"))
    assert cells(report) == cells(plot) != []
    assert "<h2>Path of the program</h2>" in report


def test_programmed_path_is_in_closed_form(recorded: Recorded) -> None:
    """The corners of the program, and points of the arc at its radius; the run stays within the tolerance."""
    run = run_of(recorded)
    assert run.nodes == ("x", "y", "z") and run.total == 5
    programmed = run.programmed
    assert programmed is not None
    assert pytest.approx(np.array([[0, 0, 0], [30, 0, 0], [30, 0, 5]])) == programmed[:, [0, 1, -1]].T
    arc = programmed[:2, 1:-3]
    assert arc.shape[1] == 62
    assert np.hypot(arc[0] - 30.0, arc[1] - 10.0) == pytest.approx(np.full(62, 10.0))
    path = run.column("set_position")[:2]
    corner = np.hypot(path[0] - 0.0, path[1] - 40.0).min()
    assert 0.03 < corner <= 0.1
    assert run.length[-1] == pytest.approx(90.0 + TURN - 10.0 + math.hypot(30.0, 40.0, 5.0), abs=0.2)


def test_colours(recorded: Recorded) -> None:
    run = run_of(recorded)
    feed = program_page.run_path(run, "feed").colourings
    assert [colouring.title for colouring in feed] == ["feed", "acceleration", "block"]
    assert feed[0].values.max() == pytest.approx(3000.0)
    machine = run.machine
    assert machine is not None
    limit = math.hypot(*(max(axis.acceleration, axis.deceleration) for axis in machine.axes.values()))
    assert 0.0 < feed[1].values.max() <= limit
    assert (feed[2].values.min(), feed[2].values.max()) == (1.0, len(run.blocks))
    block = program_page.run_path(run, "block").colourings
    assert [colouring.title for colouring in block] == ["block", "feed", "acceleration"]


def test_long_runs_are_thinned_out(recorded: Recorded, monkeypatch: pytest.MonkeyPatch) -> None:
    run = run_of(recorded)
    assert "are drawn" not in program_page.path_note(run)
    monkeypatch.setattr(program_page, "POINTS", 50)
    monkeypatch.setattr(program_page, "MOST_ROWS", 3)
    path = program_page.run_path(run, "feed")
    assert path.points.shape[1] < 120 and path.programmed is not None and path.programmed.shape[1] < 66
    note = program_page.path_note(run)
    assert f"Of {len(run.length)} cycles about 50 are drawn" in note and "Of 66 programmed points about 50" in note
    assert program_page.table_note(run).endswith(f"The first 3 of {len(run.blocks)} blocks.")
    assert len(cells(f"<h2>Blocks</h2>{program_page.block_table(run)}")) == 3


def test_override_dialect_and_first_colour(folder: Path) -> None:
    def seconds(*options: str) -> float:
        result = call("plot", folder / "square.nc", "--machine", MILL, "-o", folder / "o.html", *options)
        assert result.exit_code == 0, result.output
        return float(result.output.split("program time ")[1].split()[0])

    assert seconds("--override", "50") > 1.5 * seconds()
    seconds("--override", "50", "--colour", "acceleration")
    text = (folder / "o.html").read_text()
    assert "override 50 %" in text and text.index('"label":"acceleration"') < text.index('"label":"feed"')
    (folder / "plate.ngc").write_text("G21 G90\nG00 X0 Y0 Z5\nG81 X10 Y10 Z-3 R2 F300\nG80\nM30\n")
    plate = call("plot", folder / "plate.ngc", "--machine", MILL, "--dialect", "iso", "-o", folder / "plate.html")
    assert plate.exit_code == 0, plate.output


@pytest.mark.parametrize(
    ("lines", "options", "status", "text"),
    [
        (
            ["G01 X10"],
            [],
            2,
            "P-ERR-20008 {} line 2 column 1 'G01 X10': G01 without a feed: no F greater than 0 was programmed",
        ),
        (
            ["G01 X10 F1000"],
            ["--override", "500"],
            2,
            "P-ERR-22006 --override 500 % is above 150 % (P-CHAN-00056); nothing was drawn",
        ),
        (["G04 0.1"], [], 2, "P-ERR-26011 program {}: does not move two axes along a path; nothing was drawn"),
        (["G01 X10 F1000", "#ERROR [ID=455 RC=2]"], [], 1, "error: P-ERR-22029 "),
    ],
)
def test_faults(tmp_path: Path, lines: list[str], options: list[str], status: int, text: str) -> None:
    program = tmp_path / "p.nc"
    program.write_text("\n".join(["%P", *lines, "M30", ""]))
    result = call("plot", program, "--machine", MILL, *options)
    print(result.output)
    assert result.exit_code == status
    assert text.format(program) in result.output.replace("\n", " ")
    assert not (tmp_path / "p.html").exists()


def test_wrong_usage(folder: Path) -> None:
    program = folder / "square.nc"
    for options, text in (
        (["--machine", folder / "no.yaml"], "no.yaml"),
        (
            ["--machine", MILL, "-o", folder / "no" / "p.html"],
            f"there is no folder {folder}/no, make it or give another name; nothing",
        ),
        (
            ["--machine", MILL, "-o", folder / "p.svg"],
            "p.svg: the file name of a report must end in .html; nothing was",
        ),
        (["--machine", MILL, "x/set_velocity"], "TOPIC is of a recording; with --machine an NC program is drawn; not"),
        (
            ["--machine", MILL, "--from", "1"],
            "--from is of a recording; with --machine an NC program is drawn; nothing",
        ),
        (
            ["--machine", MILL, "--axes", "x"],
            "--axes is of a recording; with --machine an NC program is drawn; nothing",
        ),
        (["--machine", MILL, "--colour", "red"], "'red' is not one of 'feed', 'acceleration', 'block'"),
        (["--machine", MILL, "--override", "0"], "0.0 is not in the range x>0.0"),
        (["--machine", MILL, "--shape", "red"], "No such option"),
        (["--colour", "block"], "--colour needs --machine: it is of an NC program; nothing was drawn"),
        (["--dialect", "iso"], "--dialect needs --machine: it is of an NC program; nothing was drawn"),
        ([], "square.nc is no recording; --machine draws an NC program; nothing was drawn"),
    ):
        result = call("plot", program, *options)
        assert (result.exit_code, text in result.output.replace("\n", " ")) == (2, True), result.output
    missing = call("plot", folder / "none.nc", "--machine", MILL)
    assert missing.exit_code == 2 and "P-ERR-26110" in missing.output
    itself = call("plot", folder / "square.nc", "--machine", MILL, "-o", folder / "square.nc")
    assert itself.exit_code == 2 and (folder / "square.nc").read_text() == SQUARE


def test_a_recording_without_its_program_has_a_path_all_the_same(recorded: Recorded) -> None:
    recorded.commands = []
    run = run_of(recorded)
    assert run.programmed is None and run.total is None and {block.text for block in run.blocks} == {""}
    assert "programmed" not in program_page.path_note(run)
    recorded.machine_yaml = ""
    assert run_of(recorded).machine is None


FACE = """%FACE
G00 G90 X30 Z100
M19 S.POS=0 S200
#CAX [S, C]
#FACE [X, C]
G01 X20 C0 F2000
X0 C20
#FACE OFF
#CAX OFF
M30
"""


def test_face_machining_is_drawn_in_its_coordinates(tmp_path: Path) -> None:
    program, page = tmp_path / "face.nc", tmp_path / "face.html"
    program.write_text(FACE)
    result = call("plot", program, "--machine", "config/lathe.yaml", "-o", page)
    assert result.exit_code == 0, result.output
    text = page.read_text()
    assert "<h2>Front face</h2>" in text
    assert "Set positions in Cartesian coordinates of the face" in text
    assert "<h2>Lateral surface" not in text


def test_the_face_of_another_main_spindle(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """#MAIN SPINDLE [S2]: the line from (20, 0) to (0, 20) is drawn by its angle."""
    drawn: list[Recorded] = []
    monkeypatch.setattr(program_plot, "program_page", lambda recorded, *_, **__: drawn.append(recorded) or "")
    program = tmp_path / "face.nc"
    program.write_text(FACE.replace("M19", "#MAIN SPINDLE [S2]\nM19"))
    assert call("plot", program, "--machine", "config/lathe.yaml").exit_code == 0
    [face] = surfaces(drawn[0], read_machine("config/lathe.yaml"), SET)
    x, y = face.points
    between = (x > 1.0) & (y > 1.0)
    assert between.sum() > 100
    assert abs(x + y - 20.0)[between].max() < 1e-9


def test_programs_without_kinematics_have_no_such_section(folder: Path, tmp_path: Path) -> None:
    page = tmp_path / "square.html"
    assert call("plot", folder / "square.nc", "--machine", MILL, "-o", page).exit_code == 0
    assert "Front face" not in page.read_text()
