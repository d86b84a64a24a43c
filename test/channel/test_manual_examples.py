"""The NC examples of pages 50 to 57 of the spindle manual: checked, run to their end, and what they cut by closed form."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from example_support import ExampleRun
from machine_support import ROOT
from thread_support import Pass, apart, column

from cnc_ptp.cli import main

FOLDER = ROOT / "examples" / "manual"
LATHE, MILL = ROOT / "config" / "lathe.yaml", ROOT / "config" / "mill.yaml"
MACHINES = {
    "tapping": MILL,
    "tapping_twice": MILL,
    "longitudinal_thread": LATHE,
    "two_starts": LATHE,
    "tapered_thread": LATHE,
}


THREADING_TOOL = 60.0, 38.0
"""mm along X and Z, of tool 5: the axes stand there where the tip is at 0."""


def run(name: str) -> ExampleRun:
    """As `cnc_ptp simulate` runs it; no event, and to the last block."""
    bench = ExampleRun(str(MACHINES[name]), str(FOLDER / f"{name}.nc"))
    assert not bench.failed
    assert bench.events == []
    assert bench.blocks["channel"][-1].blocks_done == bench.blocks["channel"][-1].blocks_total
    return bench


def test_each_program_has_its_machine():
    assert {path.stem for path in FOLDER.glob("*.nc")} == set(MACHINES)


@pytest.mark.parametrize("name", MACHINES)
def test_check_finds_no_error(name):
    path: Path = FOLDER / f"{name}.nc"
    result = CliRunner().invoke(main, ["check", str(path), "--machine", str(MACHINES[name])])
    assert result.exit_code == 0
    assert result.output.startswith(f"{name}.nc: no errors in ")


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "pitch", "ends"), [("tapping", 1.25, [-50.0]), ("tapping_twice", 1.5, [-50.0, -70.0])]
)
def test_tapping_turns_360_deg_for_each_pitch(name, pitch, ends):
    bench = run(name)
    tapping = np.array([bool(block.thread_lead) for block in bench.blocks["channel"]]).repeat(10)
    z, angle = column(bench, "z", "set_position"), column(bench, "s", "set_position_deg")
    starts = np.flatnonzero(np.diff(tapping.astype(int)) == 1) + 1
    for start, last, end in zip(starts, np.flatnonzero(np.diff(tapping.astype(int)) == -1), ends, strict=True):
        rows = slice(start, last - 20)
        assert z[rows].min() == pytest.approx(end, abs=1e-6)
        turned = (angle[rows] - angle[start]) / 360.0
        assert z[rows] == pytest.approx(z[start] - pitch * turned, abs=1e-6)


@pytest.mark.long
def test_five_passes_of_the_longitudinal_thread_lie_in_one_groove():
    bench = run("longitudinal_thread")
    x = column(bench, "x", "set_position")[column(bench, "channel", "line") == 5] - THREADING_TOOL[0]
    radii = list(dict.fromkeys(np.round(x, 6)))
    assert radii == [69.54 / 2.0, 69.08 / 2.0, 68.62 / 2.0, 68.16 / 2.0]
    cutting = Pass(bench, 5, 1.5)
    phases = cutting.phases(2.0, 54.0) % 360.0
    assert max(abs(apart(0.0, phase)) for phase in phases) < 0.002


def test_two_starts_are_180_deg_apart():
    bench = run("two_starts")
    first, second = (Pass(bench, line, 3.0).phase(2.0, 54.0) for line in (9, 13))
    assert apart(180.0, apart(first, second)) == pytest.approx(0.0, abs=0.002)


def test_the_taper_has_its_pitch_along_x():
    bench = run("tapered_thread")
    taper = Pass(bench, 5, 5.0, axis="x")
    assert taper.error(1.0, 48.0) < 1e-6
    lines = column(bench, "channel", "line") == 5
    x = column(bench, "x", "set_position")[lines] - THREADING_TOOL[0]
    z = column(bench, "z", "set_position")[lines] - THREADING_TOOL[1]
    assert z == pytest.approx(105.0 - (50.0 - x) * 15.0 / 49.5, abs=1e-9)
