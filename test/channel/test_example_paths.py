"""Every example program and every cycle that ships, before the checker that knows nothing of the planner.

Left out: homing.nc, in which the set positions jump where the axes get their reference, and programs in which the path
does not move. drill.nc is called by pocket.nc.
"""

from __future__ import annotations

import runpy
from itertools import chain, islice
from pathlib import Path

import pytest
from long_support import long, long_sets
from machine_support import MachineBench
from program_segments import findings

from cnc_ptp.nc.faults import ProgramError

MILL = "config/mill.yaml"
LATHE = "config/lathe.yaml"
PAIRS = [
    (MILL, "examples/pocket.nc"),
    *((LATHE, f"examples/threads/{name}.nc") for name in ("chain", "taper", "two_starts")),
    (LATHE, "examples/manual/tapered_thread.nc"),
    ("examples/probe.yaml", "examples/probe.nc"),
    *((MILL, f"examples/figures/path_{name}.nc") for name in ("corners", "velocity")),
    *(("examples/spindles/nc_spindle.yaml", f"examples/spindles/{name}.nc") for name in ("din", "brackets")),
    *(
        ("examples/spindles/synchronisation.yaml", f"examples/spindles/{name}.nc")
        for name in ("synchronised", "not_synchronised")
    ),
    ("examples/spindles/sensorless.yaml", "examples/spindles/open_loop.nc"),
    ("examples/spindles/synchronous.yaml", "examples/spindles/synchronous.nc"),
    ("examples/spindles/three_spindles.yaml", "examples/spindles/three_spindles.nc"),
    ("examples/spindles/tools.yaml", "examples/spindles/tools.nc"),
    ("examples/spindles/two_channels.yaml", "examples/spindles/channel1.nc"),
]
LONG = [
    *((MILL, f"examples/{name}") for name in ("bracket.nc", "cover.nc", "tapping.nc", "plate.ngc")),
    *((MILL, f"examples/{name}.nc") for name in ("manual/tapping", "manual/tapping_twice")),
    *((LATHE, f"examples/{name}.nc") for name in ("thread", "caxis", "turned_part", "turning", "lathe")),
    *((MILL, f"examples/figures/control_circle{name}.nc") for name in ("", "_feedforward")),
    *((LATHE, f"examples/{name}.nc") for name in ("threads/longitudinal", "manual/longitudinal_thread")),
    (LATHE, "examples/manual/two_starts.nc"),
]
CYCLES = {
    81: "G81[-5, 2]", 82: "G82[-5, 2, 0.1]", 83: "G83[-9, 2, 4]", 84: "S200 G84[-8, 2, 1.25, 0.1]", 85: "G85[-5, 2]", 86: "M03 S500\nG86[-5, 2]\nM05", 89: "G89[-5, 2, 0.1]",
}  # fmt: skip


@pytest.mark.parametrize(
    ("machine", "program"),
    [*PAIRS, *long_sets(LONG)],
    ids=lambda name: Path(name).stem,
)
def test_an_example_keeps_to_its_path_and_the_axes_to_their_limits(machine: str, program: str) -> None:
    assert findings(machine, program) == []


@pytest.mark.parametrize("part", ["surface", *long(["pocket"])])
def test_chords_of_a_cam_contour(part: str, tmp_path: Path) -> None:
    """Parts of the 150,000 blocks of examples/contour.py: rings with round and sharp corners, rows over the hill."""
    contour = runpy.run_path("examples/contour.py")
    path = contour["pocket"](1) if part == "pocket" else chain(*(contour["row"](y, forward=True) for y in (38.0, 40.0)))
    program = tmp_path / "contour.nc"
    program.write_text("\n".join(contour["program"](islice(contour["rounded"](path), 1200))))
    assert findings(MILL, str(program)) == []


@pytest.mark.parametrize("code", CYCLES)
def test_a_cycle_keeps_to_its_path_and_the_axes_to_their_limits(code: int, tmp_path: Path) -> None:
    program = tmp_path / "cycle.nc"
    program.write_text(f"G00 Z10 F300\n{CYCLES[code]}\nX20 Y-10\nG18 {CYCLES[code]}\nG17 Z10\nM30\n")
    assert findings(MILL, str(program)) == []


@pytest.mark.parametrize("words", ["PRE_DIST=2 POST_DIST=3 X9 Y1", "PRE_DIST=0 POST_DIST=0 X12 Y-2", "X10.5 Z1"])
def test_a_corner_with_an_interim_point(words: str, tmp_path: Path) -> None:
    program = tmp_path / "point.nc"
    program.write_text(f"G00 X0 Y0\n#CONTOUR MODE [POS {words}]\nG61 G01 X10 F3000\nY10\nG261 X0 Y20\nX-10\nM30\n")
    assert findings(MILL, str(program)) == []


def test_an_interim_point_beyond_a_soft_limit_is_refused(tmp_path: Path) -> None:
    program = tmp_path / "point.nc"
    program.write_text("G00 X0 Y0\n#CONTOUR MODE [POS X10 Y-201]\nG61 G01 X10 F3000\nY10\nM30\n")
    with pytest.raises(ProgramError, match="axis Y: -201 mm lies beyond the negative soft limit -200 mm"):
        findings(MILL, str(program))


def test_a_curve_that_would_leave_the_soft_limits_is_an_exact_stop(tmp_path: Path) -> None:
    """Its points lie within the limit of 300 mm, the curve between them would reach 314.5 mm."""
    program = "#CONTOUR MODE [POS PRE_DIST=0 POST_DIST=0 X250 Y50]\nG61 G01 X300 F3000\nY100\nM30\n"
    bench = MachineBench("G00 X250\n" + program).run()
    assert bench.errors() == []
    assert max(bench.column("x", "set_position")) == 300.0
    inside = MachineBench("G00 X200\n" + program.replace("X300", "X250").replace("X250 Y50", "X200 Y50")).run()
    assert 260.0 < max(inside.column("x", "set_position")) < 300.0
