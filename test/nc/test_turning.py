"""Diameters, cutting speeds and the stock-removal cycles: what they do, calculated by hand, and what they refuse."""

from __future__ import annotations

from math import pi

import pytest
from nc_support import FACING, GEARS, HERE, lines, run, three_spindles

from cnc_ptp.machine.program_files import called_programs
from cnc_ptp.nc.canonical import CuttingSpeed, GearChange, SpindleFunction
from cnc_ptp.nc.modal_state import FacingAxis
from cnc_ptp.nc.program import Spindle, SpindleTable, TurningAxes

BEFORE = "G18 G51 F600\n"
CONE = "@DBEGIN=20 @ZBEGIN=0 @DEND=30 @ZEND=-20"
PLANE = "@DBEGIN=40 @ZBEGIN=0 @DEND=10 @ZEND=0"


def turned(text: str, turning_axes: TurningAxes = FACING["X"], **options) -> list[str]:
    files = called_programs(text, [str(HERE / "library")])
    return lines(BEFORE + text, turning=turning_axes, files=files, **options)


def cycle(begin: str, name: str, parameters: str) -> list[str]:
    """The blocks of a call behind the way to its beginning."""
    blocks = turned(f"G00 {begin}\nL CYCLE [NAME={name}.nc {parameters}]\nM30")
    assert blocks[-1] == "end"
    return blocks[1:-1]


def moves(*points: tuple[str, float, float]) -> list[str]:
    """R: rapid, F: at the feed; radius and Z."""
    text = {"R": "rapid ({:g}, 0, {:g})", "F": "line ({:g}, 0, {:g}) feed 10"}
    return [text[kind].format(x, z) for kind, x, z in points]


# feed per turn


@pytest.mark.parametrize("restart", ["M03", "M04 S200", "G97 M03 S500", "S[M3 REV200]"])
@pytest.mark.parametrize("stop", ["M05", "M19", "S[M5]"])
def test_a_spindle_that_turns_again_leads_the_feed(stop: str, restart: str) -> None:
    text = f"M03 S300 G95 F0.5\nG01 X40\n{stop}\n{restart}\nX20\nM30"
    assert any("line (10, 0, 0) feed" in line for line in turned(text, spindles=three_spindles()))


def test_m05_in_the_block_of_a_feed_per_turn_may_come_behind_it() -> None:
    block = turned("M03 S300 G95 F0.5\nG01 X40 M05\nM30")[-2]
    assert block == "S[M5] | line (20, 0, 0) feed 2.5, 0.5 mm per turn of S"


def test_a_spindle_of_the_plc_is_not_said_to_stand() -> None:
    table = three_spindles(plc_control=True)
    assert turned("M03 S300 G95 F0.5\nM05\nG01 X40\nM30", spindles=table)[-2] == "line (20, 0, 0) feed 2.5"


# diameters


@pytest.mark.parametrize(("relative", "radius"), [(False, 25.0), (True, 22.5)])
def test_increments_are_diameters_if_the_axis_says_so(relative: bool, radius: float) -> None:
    axes = TurningAxes((FacingAxis(0, True, relative),))
    assert turned("G01 X40\nG91 X5", axes)[-1] == f"line ({radius:g}, 0, 0) feed 10"


def test_g90_alone_may_be_in_radii() -> None:
    axes = TurningAxes((FacingAxis(0, False, True),))
    assert turned("G01 X40\nG91 X5\nG90 X[V.A.PROG.X + 1]", axes)[-1] == "line (43.5, 0, 0) feed 10"


def test_the_programmed_position_is_read_as_it_is_written() -> None:
    assert turned("G01 X40\nX[V.A.PROG.X - 4]\nG52\nX[V.A.PROG.X - 4]\nZ[V.A.ABS.X]") == moves(
        ("F", 20, 0), ("F", 18, 0), ("F", 14, 0), ("F", 14, 14)
    )


def test_offsets_are_radii() -> None:
    assert turned("G92 X3\nG01 X40")[-1] == "line (23, 0, 0) feed 10"


# cutting speed


def speeds(text: str, spindles: SpindleTable) -> list[object]:
    blocks = run(BEFORE + text, turning=FACING["X"], spindles=spindles)
    return [function for block in blocks for function in block.functions]


def test_the_speed_is_limited_by_the_gear() -> None:
    table = SpindleTable((Spindle("S", "S1", 6, limits=(1500.0,)),), "S")
    assert speeds("M03 S100\nG96 S100", table)[-1] == SpindleFunction("S", None, 1500.0)


def test_the_gear_is_chosen_for_the_speed() -> None:
    """60 m/min at 40 mm: 477.46 rpm, in the first stage; at 10 mm 1909.86 rpm, in the third."""
    table = three_spindles(ranges=GEARS, automatic=True)
    found = speeds("G00 X40\nG96 M03 S60\nG00 X10\nS60", table)
    low, high = 60_000.0 / (pi * 40.0), 60_000.0 / (pi * 10.0)
    assert found[1:3] == [GearChange("S", 1), SpindleFunction("S", 3, pytest.approx(low))]
    assert found[4:] == [GearChange("S", 3), SpindleFunction("S", None, pytest.approx(high))]
    assert [each for each in found if isinstance(each, CuttingSpeed)] == [CuttingSpeed("S", pytest.approx(1000.0))] * 2


def test_a_start_near_the_turning_centre_is_limited_with_a_warning() -> None:
    """100 m/min at 10 mm is 1591.5 rpm."""
    warning = "warning 20633 'axis X is 5 mm from the turning centre: spindle S turns at 1500 rpm (G196, P-AXIS-00212),"
    near = turned("G00 X10\nM3 S100\nG196 S1500\nG96 S100")
    assert any(f"{warning} slower than the cutting speed needs'" in line for line in near)
    assert not any("20633" in line for line in turned("G00 X60\nM3 S100\nG196 S1500\nG96 S100\nG01 X10"))


def test_g96_needs_its_own_s() -> None:
    assert turned("M03 S500\nG96\nG97\nG96\nS100")[1:] == ["S[G96 1666.666667 mm/s by axis 0] | S[REV15915494.30919]"]


def test_inches_without_feet() -> None:
    """P-CHAN-00360 is 0: m/min with G70, too."""
    assert turned("G70 G00 X2\nM03 S10\nG96 S100")[-1].startswith("S[G96 1666.666667 mm/s by axis 0]")


# stock removal


def test_roughing_of_a_cone() -> None:
    """Radius 20 to 10.5 in three cuts of 3.1667 mm; the second ends on the cone with 0.5 mm left."""
    second = 20.0 - 2.0 * 9.5 / 3.0
    end = -20.0 * (second - 10.5) / 5.0
    assert cycle("X40 Z2", "roughing", f"{CONE} @CUT=4 @ALLOWANCE=0.5") == [
        "rapid (16.833333, 0, 2)",
        "line (16.833333, 0, -20) feed 10",
        "line (17.333333, 0, -19.5) feed 10",
        "rapid (17.333333, 0, 2)",
        "rapid (13.666667, 0, 2)",
        f"line (13.666667, 0, {end:.6f}) feed 10",
        f"line (14.166667, 0, {end + 0.5:.6f}) feed 10",
        "rapid (14.166667, 0, 2)",
        *moves(("R", 10.5, 2), ("F", 10.5, 0), ("F", 11, 0.5), ("R", 11, 2)),
        *moves(("R", 10.5, 2), ("F", 10.5, 0), ("F", 15.5, -20), ("F", 20.5, -20), ("R", 20.5, 2), ("R", 20, 2)),
    ]


def test_finishing_takes_the_allowance() -> None:
    found = cycle(
        "X24 Z1", "roughing", "@DBEGIN=20 @ZBEGIN=0 @DEND=20 @ZEND=-5 @CUT=2 @ALLOWANCE=0.2 @FINISH=1 @CLEAR=1"
    )
    assert found == moves(
        ("R", 10.2, 1), ("F", 10.2, -5), ("F", 11.2, -4), ("R", 11.2, 1),
        ("R", 10, 1), ("F", 10, 0), ("F", 10, -5), ("F", 13, -5), ("R", 13, 1), ("R", 12, 1),
    )  # fmt: skip


def test_roughing_inside_of_a_bore() -> None:
    found = cycle("X20 Z1", "roughing", "@DBEGIN=24 @ZBEGIN=0 @DEND=24 @ZEND=-5 @CUT=2 @CLEAR=1")
    assert found == moves(("R", 12, 1), ("F", 12, -5), ("F", 11, -4), ("R", 11, 1), ("R", 10, 1))


def test_facing() -> None:
    assert cycle("X44 Z3", "facing", f"{PLANE} @CUT=2") == moves(
        ("R", 22, 1.5), ("F", 5, 1.5), ("F", 5.5, 2), ("R", 22, 2),
        ("R", 22, 0), ("F", 5, 0), ("F", 5.5, 0.5), ("R", 22, 0.5), ("R", 22, 3),
    )  # fmt: skip


def test_facing_of_a_cone() -> None:
    found = cycle("X44 Z2", "facing", "@DBEGIN=40 @ZBEGIN=0 @DEND=10 @ZEND=1 @CUT=2 @CLEAR=1")
    assert found == moves(
        ("R", 22, 0), ("F", 20, 0), ("F", 21, 1), ("R", 22, 1),
        ("R", 22, 0), ("F", 20, 0), ("F", 5, 1), ("F", 5, 3), ("R", 22, 3), ("R", 22, 2),
    )  # fmt: skip


def test_a_cycle_leaves_diameters_as_they_were() -> None:
    text = "L CYCLE [NAME=roughing.nc @DBEGIN=20 @ZBEGIN=0 @DEND=20 @ZEND=-5 @CUT=2]"
    assert turned(f"G00 X24 Z1\n{text}\nX50")[-1] == "rapid (25, 0, 1)"
    assert turned(f"G52 G00 X12 Z1\n{text}\nX50")[-1] == "rapid (50, 0, 1)"


@pytest.mark.parametrize(
    ("begin", "name", "parameters", "reason"),
    [
        ("X40 Z2", "roughing", f"{CONE} @CUT=0", "PM1 = depth of cut is not above 0, PV1 = 0"),
        ("X44 Z3", "facing", f"{PLANE} @CUT=-1", "PM1 = depth of cut is not above 0, PV1 = -1"),
        ("X40 Z-30", "roughing", f"{CONE} @CUT=1", "PM1 = the contour does not lead away from the tool, PV1 = 0, PV2 = -20"),
        ("X8 Z3", "facing", f"{PLANE} @CUT=1", "PM1 = the contour does not lead away from the tool, PV1 = 40, PV2 = 10"),
        ("X40 Z2", "roughing", "@DBEGIN=30 @ZBEGIN=0 @DEND=20 @ZEND=-9 @CUT=1",
         "PM1 = the contour is deeper at its end than where it begins, PV1 = 30, PV2 = 20"),
        ("X44 Z3", "facing", "@DBEGIN=40 @ZBEGIN=0 @DEND=10 @ZEND=-1 @CUT=1",
         "PM1 = the contour is deeper at its end than where it begins, PV1 = 0, PV2 = -1"),
        ("X20.6 Z2", "roughing", f"{CONE} @CUT=1 @ALLOWANCE=0.5", "PM1 = there is no stock at the beginning of the contour, PV1 = 20"),
        ("X44 Z0", "facing", f"{PLANE} @CUT=1", "PM1 = there is no stock at the beginning of the contour, PV1 = 0"),
    ],
)  # fmt: skip
def test_wrong_contours_are_refused(begin: str, name: str, parameters: str, reason: str) -> None:
    number = {"roughing": 71, "facing": 72}[name]
    assert cycle(begin, name, parameters) == [f"error {number} '#ERROR {number} of the program: {reason}'"]
