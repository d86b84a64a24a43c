"""Threads, faces and lateral surfaces in the report: sections, and numbers that are known from the program."""

from __future__ import annotations

import re
from cmath import phase
from dataclasses import replace
from html import unescape
from math import nan, pi
from pathlib import Path

import numpy as np
import pytest
from machine_support import ROOT, MachineBench

from cnc_ptp.parameters import load_machine, machine_text
from cnc_ptp.plots.report import report_page
from cnc_ptp.plots.thread_sections import unrolled
from cnc_ptp.recording.reader import Recorded, read_recording
from cnc_ptp.recording.rows import SET
from cnc_ptp.recording.surfaces import surfaces
from cnc_ptp.recording.thread_passes import ThreadPass, phase_against, thread_passes
from cnc_ptp.recording.writer import Recording

LATHE = ROOT / "config" / "lathe.yaml"
TWO_STARTS = """%T
G18 G90 M03 S400
G00 X36 Z105
G33 Z75 K3
G00 X40
Z105
X36
G33 Z75 K3 S.OFFSET=120
G00 X40
G33 X60 I2
M30
"""
SURFACES = """%T
G00 G90 X30 Z100
M19 S.POS=0 S200
#CAX [S, C]
G92 X5 C30
#FACE [X, C]
G01 X20 C0 F2000
X0 C20
X-20 C0
#FACE OFF
G00 X40
#CYL [Z, C, X25]
G01 Z80 F2000
C[50 * 3.14159265358979]
Z60
#CYL OFF
#CAX OFF
M30
"""


def record(path: Path, machine: Path, program: str, scenario: str = "", acceleration: int = 18000) -> Recorded:
    """`acceleration`: of the main spindle, deg/s²."""
    text = machine_text(machine).replace(
        "a_beschl: 18000, a_brems: 18000", f"a_beschl: {acceleration}, a_brems: {acceleration}"
    )
    bench = MachineBench(program, scenario, machine=load_machine(text, "machine.yaml")).run()
    assert not bench.failed
    with Recording(path, text) as recording:
        for each in bench.records:
            recording.command(each)
        for blocks in zip(*bench.blocks.values(), strict=True):
            for name, block in zip(bench.blocks, blocks, strict=True):
                recording.block(name, block)
    return read_recording(path)


@pytest.fixture(scope="module")
def threads(tmp_path_factory):
    return record(tmp_path_factory.mktemp("threads") / "run.mcap", LATHE, TWO_STARTS)


@pytest.fixture(scope="module")
def workpiece(tmp_path_factory):
    return record(tmp_path_factory.mktemp("surfaces") / "run.mcap", LATHE, SURFACES)


def passes_of(recorded: Recorded) -> list[ThreadPass]:
    return thread_passes(recorded, load_machine(recorded.machine_yaml, "machine.yaml"))


def headings(page: str) -> list[str]:
    return [unescape(text) for text in re.findall(r"<h2>(.*?)</h2>", page)]


def thread_table(page: str) -> list[dict[str, str]]:
    part = page.partition("<h2>Threads</h2>")[2].partition("</table>")[0]
    head, *rows = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in re.findall(r"<tr>(.*?)</tr>", part)]
    return [dict(zip(head, row, strict=True)) for row in rows]


def test_the_table_has_a_line_for_each_pass(threads):
    first, second, face = thread_table(report_page(threads))
    assert [(row["pass"], row["line"], row["axis"], row["lead mm"], row["rpm"]) for row in (first, second, face)] == [
        ("1", "4", "Z", "3.000", "400.0"),
        ("2", "8", "Z", "3.000", "400.0"),
        ("3", "10", "X", "2.000", "400.0"),
    ]
    assert float(first["against pass 1 deg"]) == 0.0
    assert float(second["against pass 1 deg"]) == pytest.approx(120.0, abs=0.02)
    assert face["against pass 1 deg"] == "–"
    # the groove is at Z105 where the angle is a multiple of 360 deg: 105/3 turns before it is at Z0
    assert float(first["phase deg"]) % 360.0 == pytest.approx(0.0, abs=0.02) or first["phase deg"].startswith("359.9")
    assert float(first["pitch error set µm"]) == pytest.approx(0.0, abs=0.001)
    assert float(first["pitch error actual µm"]) < 0.2
    assert 100.0 < float(first["from mm"]) < 105.0
    assert 75.0 < float(first["to mm"]) < 75.6


@pytest.mark.long
def test_a_dip_of_the_speed_is_in_the_table(tmp_path):
    scenario = "- {at: 2.5, to: s, do: set_override, percent: 90}"
    recorded = record(
        tmp_path / "run.mcap", LATHE, "%T\nG18 G90 M03 S400\nG00 X36 Z105\nG33 Z75 K1.5\nM30\n", scenario, 6000
    )
    [row] = thread_table(report_page(recorded))
    # 6000 deg/s² within one block of 10 ms before the path knows: 2.0 µm (docs/threads.md)
    assert float(row["pitch error set µm"]) == pytest.approx(2.02, abs=0.05)
    assert float(row["rpm"]) == pytest.approx(360.0, abs=0.5)


def test_sections_come_only_with_such_motion(threads, workpiece):
    assert [title for title in headings(report_page(threads)) if "hread" in title or "ace" in title] == [
        "Threads",
        "Unrolled threads",
    ]
    assert [title for title in headings(report_page(workpiece)) if "hread" in title or "ace" in title] == [
        "Front face",
        "Lateral surface, unrolled",
    ]
    page = report_page(workpiece)
    assert "#FACE [X, C], " in page
    assert "#CYL [Z, C, X25], " in page


def test_a_groove_is_straight_on_the_unrolled_surface(threads):
    each = passes_of(threads)[0]
    position, angle = unrolled(each.position, each.angle)
    assert np.nanmin(angle) >= 0.0
    assert np.nanmax(angle) < 360.0
    slopes = np.diff(position) / np.diff(angle)
    assert slopes[~np.isnan(slopes)] == pytest.approx(-3.0 / 360.0, rel=1e-3)
    turns = (each.angle[-1] - each.angle[0]) / 360.0
    assert np.isnan(position).sum() == pytest.approx(turns, abs=1.0)


def test_passes_of_other_axes_have_no_phase_against_each_other(threads):
    first, second, face = passes_of(threads)
    assert phase_against(first, second) == pytest.approx(120.0, abs=0.02)
    assert phase_against(second, first) == pytest.approx(-120.0, abs=0.02)
    assert str(phase_against(first, face)) == str(nan)


def test_the_recording_says_which_spindle_leads(tmp_path):
    """The spindles turn together, so the angles of both fit the thread; S2 is the main one."""
    program = """%T
G18 G90 G00 X36 Z105
#MAIN SPINDLE [S2]
#SET AX LINK [1, S1=S]
#ENABLE AX LINK [1]
M03 S400
G33 Z95 K1.5
#DISABLE AX LINK [1]
M30
"""
    [each] = passes_of(record(tmp_path / "run.mcap", LATHE, program))
    assert (each.channel, each.axis, each.spindle) == ("channel", "z", "s2")


def test_the_recording_says_which_axis_counts(threads, tmp_path):
    """At 45 deg both axes go the same way; in a chain the axis changes, and there a pass ends."""
    program = "%T\nG18 G90 M03 S400\nG00 X36 Z105\nG33 X46 Z95 I1.5\nX46.5 Z85 K1.5\nM30\n"
    found = passes_of(record(tmp_path / "run.mcap", LATHE, program))
    assert [(each.axis, each.spindle, each.line) for each in found] == [("x", "s", 4), ("z", "s", 5)]
    assert [each.axis for each in passes_of(threads)] == ["z", "z", "x"]


def test_an_older_recording_does_not_say_it_and_has_no_passes(threads):
    rows = threads.threads["channel"]
    older = rows[[name for name in rows.dtype.names if name not in ("axis", "spindle")]]
    machine = load_machine(threads.machine_yaml, "machine.yaml")
    assert thread_passes(replace(threads, threads={"channel": older}), machine) == []
    assert thread_passes(threads, None) == []


def test_the_c_axis_of_another_main_spindle(tmp_path):
    """#MAIN SPINDLE [S2]: its angle is drawn, while S1 turns."""
    program = SURFACES.replace("M19 S.POS=0 S200\n", "#MAIN SPINDLE [S2]\nM19 S.POS=0 S200\nS1[M03 REV300]\n")
    recorded = record(tmp_path / "run.mcap", LATHE, program)
    machine = load_machine(recorded.machine_yaml, "machine.yaml")
    face, lateral = surfaces(recorded, machine, SET)
    x, y = face.points
    between = (x > 1.0) & (y > 1.0)
    assert between.sum() > 100
    assert abs(x + y - 20.0)[between].max() < 1e-9
    assert np.ptp(lateral.points[1]) == pytest.approx(25.0 * pi, abs=1e-6)


def test_the_face_is_cartesian(workpiece):
    """Lines between the programmed corners, from the zero point that G92 has set."""
    face = surfaces(workpiece, load_machine(workpiece.machine_yaml, "machine.yaml"))[0]
    path = face.points[0] + 1j * face.points[1]
    for corner in (20.0, 20.0j, -20.0):
        assert abs(path - corner).min() < 0.3  # following errors
    between = (path.real > 1.0) & (path.imag > 1.0)
    assert between.sum() > 100
    assert abs(path.real + path.imag - 20.0)[between].max() < 0.2
    assert abs(phase(path[-1])) == pytest.approx(pi, abs=0.01)


def test_set_values_on_the_face_are_on_the_programmed_lines(workpiece):
    face = surfaces(workpiece, load_machine(workpiece.machine_yaml, "machine.yaml"), SET)[0]
    x, y = face.points
    between = (x > 1.0) & (y > 1.0)
    assert between.sum() > 100
    assert abs(x + y - 20.0)[between].max() < 1e-9


def test_the_lateral_surface_is_unrolled(workpiece):
    machine = load_machine(workpiece.machine_yaml, "machine.yaml")
    [lateral] = [each for each in surfaces(workpiece, machine) if each.kind == "#CYL"]
    assert lateral.axes == ("Z", "circumference")
    along, around = lateral.points
    assert along[-1] == pytest.approx(60.0, abs=0.5)
    turns = around[-1] / (50.0 * pi)  # C50π is one circumference behind the zero point
    assert turns == pytest.approx(round(turns), abs=0.01)
    assert np.ptp(around) == pytest.approx(25.0 * pi, abs=0.3)  # from the end of the face, half a turn before
    assert lateral.velocity.max() <= 2000.0 / 60.0 * 1.001


def test_a_part_of_a_recording_without_its_machine_has_no_surfaces(workpiece):
    assert surfaces(workpiece, None) == []
