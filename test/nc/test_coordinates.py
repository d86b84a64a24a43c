"""Coordinates against matrices of NumPy and closed forms: offsets, rotation, scale, mirror, coordinate systems, units."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nc_support import run

from cnc_ptp.nc.arcs import extreme_points
from cnc_ptp.nc.canonical import CircularMove
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.parameters import OffsetTables
from cnc_ptp.path import Arc, Line

lengths = st.integers(-9999, 9999).map(lambda n: n / 100.0)
angles = st.integers(-360, 360).map(float)
points = st.tuples(lengths, lengths, lengths)
sixes = st.tuples(lengths, lengths, lengths, angles, angles, angles)


def target(text: str) -> np.ndarray:
    """Machine position of the last block."""
    return np.array(run(text)[-1].motion.target)


def word(point: tuple[float, ...]) -> str:
    return " ".join(f"{axis}{value:.2f}" for axis, value in zip("XYZ", point, strict=True))


def far(point: tuple[float, ...]) -> str:
    """A point with X1000, so that the block always moves."""
    return f"X1000 Y{point[1]:.2f} Z{point[2]:.2f}"


def about(axis: int, degrees: float) -> np.ndarray:
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix


def system(values: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Shift and rotation: about Z, then about the new Y, then about the new X."""
    x, y, z, a, b, c = values
    return np.array([x, y, z]), about(2, c) @ about(1, b) @ about(0, a)


def listed(values: tuple[float, ...]) -> str:
    return "[" + ", ".join(f"{value:.2f}" for value in values) + "]"


@given(points, points, points)
def test_offsets_add_up(zero, added, point):
    before = "\n".join(f"V.G.NP[1].V.{axis} = {value:.2f}" for axis, value in zip("XYZ", zero, strict=True))
    end = target(f"{before}\nG54 G00\nG92 {word(added)}\n{far(point)}")
    np.testing.assert_allclose(end, np.array(zero) + np.array(added) + [1000.0, *point[1:]], atol=1e-9)


@given(st.sampled_from([17, 18, 19]), angles, lengths, lengths, points)
def test_rotation_in_each_plane(plane, angle, first, second, point):
    axis = {17: 2, 18: 1, 19: 0}[plane]
    i, j = {17: (0, 1), 18: (2, 0), 19: (1, 2)}[plane]
    centre = np.zeros(3)
    centre[i], centre[j] = first, second
    end = target(
        f"G{plane} G00\n#ROTATION ON [ANGLE={angle} CENTER1={first:.2f} CENTER2={second:.2f}]\n{word(point)}\nG91 X1"
    )
    expected = about(axis, angle) @ (np.array(point) - centre) + centre + about(axis, angle) @ [1.0, 0.0, 0.0]
    np.testing.assert_allclose(end, expected, atol=1e-8)


@given(sixes, sixes, points, points)
def test_systems_within_each_other(outer, inner, zero, point):
    """The zero offset of the workpiece places the outer system; G92 within it is its own."""
    text = f"G92 {word(zero)}\n#CS ON {listed(outer)}\nG92 X5\n#CS ON [2] {listed(inner)}\nG00 {far(point)}"
    end = target(text)
    (v1, r1), (v2, r2) = system(outer), system(inner)
    programmed = np.array([1000.0, point[1], point[2]])
    expected = np.array(zero) + v1 + r1 @ (np.array([5.0, 0.0, 0.0]) + v2 + r2 @ programmed)
    np.testing.assert_allclose(end, expected, atol=1e-7)


@given(sixes, sixes, points)
def test_a_fixture_lies_below_the_workpiece(fixture, workpiece, point):
    """#ACS counts as if it had been switched on before #CS."""
    first = target(f"#CS ON {listed(workpiece)}\n#ACS ON {listed(fixture)}\nG00 {far(point)}")
    second = target(f"#ACS ON {listed(fixture)}\n#CS ON {listed(workpiece)}\nG00 {far(point)}")
    np.testing.assert_allclose(first, second, atol=1e-7)


@given(sixes, points, points)
def test_what_was_switched_on_is_gone_when_it_is_off(values, first, second):
    text = f"G00 {word(first)}\n#CS ON {listed(values)}\nG92 X7\n{far(second)}\n#CS OFF\nX1 Y1 Z1"
    np.testing.assert_allclose(target(text), [1.0, 1.0, 1.0], atol=1e-9)


def test_mirror():
    (move,) = (block.motion for block in run("G00 G21\nG03 X20 Y0 I10 F600") if block.motion)
    assert (move.target, move.center, move.sweep) == ((-20.0, 0.0, 0.0), (-10.0, 0.0), -180.0)
    (move,) = (block.motion for block in run("G00 G23\nG03 X20 Y0 I10 F600") if block.motion)
    assert (move.target, move.center, move.sweep) == ((-20.0, 0.0, 0.0), (-10.0, 0.0), 180.0)


def test_scale_and_its_arcs():
    (move,) = (block.motion for block in run("#SCALE X2 Y2\n#SCALE ON\nG02 X20 Y0 I10 F600") if block.motion)
    assert (move.target, move.center, move.radius) == ((40.0, 0.0, 0.0), (20.0, 0.0), 20.0)


def test_a_rotated_arc_is_the_arc_of_rotated_points():
    (move,) = (block.motion for block in run("#ROTATION ON [ANGLE=90]\nG02 X20 Y0 I10 F600") if block.motion)
    assert (move.target, move.center, move.sweep) == ((0.0, 20.0, 0.0), (0.0, 10.0), -180.0)


def test_inch():
    (move,) = (block.motion for block in run("G70 G01 X1 Y=0.5 F10") if block.motion)
    assert (move.target, move.feed) == ((25.4, 12.7, 0.0), 254.0 / 60.0)
    (move,) = (block.motion for block in run("G70 G02 X2 I1 F10") if block.motion)
    assert (move.target, move.center) == ((50.8, 0.0, 0.0), (25.4, 0.0))
    (move,) = (block.motion for block in run("G70\nG71 G91 G00 X1") if block.motion)
    assert move.target == (1.0, 0.0, 0.0)
    (_, move) = (block.motion for block in run("G70 G00 X2\nY[V.A.ABS.X]") if block.motion)
    assert move.target == (50.8, 50.8, 0.0)


def test_an_offset_moves_nothing_and_acts_with_the_next_absolute_word():
    moves = [
        block.motion.target
        for block in run("V.G.NP[1].V.X = 10 V.G.NP[1].V.Y = 20\nG54\nG00 X1\nG91 Y1\nG90 Y1")
        if block.motion
    ]
    assert moves == [(11.0, 0.0, 0.0), (11.0, 1.0, 0.0), (11.0, 21.0, 0.0)]


def test_offsets_by_index_and_their_end():
    text = "V.G.NP[7].V.X = 10\nG159=7 G00 X0\nV.G.NP_AKT.V.X = 30\nX0\nG159=7 X0\nG53 X0\nX[V.G.NP_AKT.IDX + 5]"
    moves = [block.motion.target[0] for block in run(text) if block.motion]
    assert moves == [10.0, 30.0, 10.0, 0.0, 5.0]


def test_g92_adds_with_g91_and_sets_with_g90():
    text = "G92 X10\nG91\nG92 X5\nG90 G00 X0\nY[V.A.BZP.X]\nG92 X0\nX1"
    moves = [block.motion.target[:2] for block in run(text) if block.motion]
    assert moves == [(15.0, 0.0), (15.0, 15.0), (1.0, 15.0)]


def test_preset_gives_the_present_position_a_value():
    text = "G00 X10 Y10\n#PSET X100\nX110 Y11\n#PRESET X\nX1\n#PSET X0 Y0\n#PRESET\nX2 Y2"
    moves = [block.motion.target[:2] for block in run(text) if block.motion]
    assert moves == [(10.0, 10.0), (20.0, 11.0), (1.0, 11.0), (2.0, 2.0)]


def test_a_system_that_is_stored_is_switched_on_by_its_number():
    text = "#CS DEF [3] [10]\n#CS DEF [4] [20, 5]\nG00 X0 Y1\n#CS ON [3]\nX0\n#CS OFF\n#CS ON\nX0 Y0\n#CS OFF ALL\nX1"
    moves = [block.motion.target[:2] for block in run(text) if block.motion]
    assert moves == [(0.0, 1.0), (10.0, 1.0), (20.0, 5.0), (1.0, 5.0)]


@pytest.mark.parametrize(
    ("text", "column"),
    [
        ("G99 X10\nG00 X11", 5), ("G98 X-5\nG00 X-6", 5), ("G99 X10\nG91\nG99 X2\nG90 G00 X13", 9),
        ("G99 Y8\nG02 X20 I10 J0.001 F100\nG03 X0 I-10 F100", 1),
    ],
)  # fmt: skip
def test_limits_of_the_program(text, column):
    with pytest.raises(ProgramError) as refused:
        run(text)
    assert "lies beyond the software limit" in str(refused.value)


def test_limits_permit_what_is_within_them():
    assert len(run("G98 X-5\nG99 X10\nG91\nG99 X2\nG90 G00 X12\nX-5\nX[V.A.+SWE.X]")) == 3


def test_rotary_axes_are_in_degrees_and_not_scaled():
    axes = ("X", "C")
    (move,) = (block.motion for block in run("G70 G00 X1 C90", axes=axes, rotary=["C"]) if block.motion)
    assert move.target == (25.4, 90.0)
    with pytest.raises(ProgramError) as refused:
        run("#SCALE X2 C2", axes=axes, rotary=["C"])
    assert (
        str(refused.value) == "P-ERR-21607 test.nc line 1 column 11 '#SCALE X2 C2': axis C is rotary and is not scaled"
    )


def test_offsets_of_the_machine_count_until_the_program_changes_them():
    text = "G54 G00 X0\nV.G.NP[1].V.X = V.G.NP[1].V.X + 5\nX0 Z1\nG54 X0"
    moves = [
        block.motion.target for block in run(text, offsets=OffsetTables(zero={1: (10.0, 0.0, 3.0)})) if block.motion
    ]
    assert moves == [(10.0, 0.0, 0.0), (10.0, 0.0, 4.0), (15.0, 0.0, 4.0)]


def test_a_cycle_gives_its_caller_the_coordinates_back():
    text = "%L UP\nG92 X50\nG91 G70\nM29\n%MAIN\nLL CYCLE [NAME=UP]\nG00 X1\nLL UP\nX1\nM30"
    moves = [block.motion.target[0] for block in run(text) if block.motion]
    assert moves == [1.0, 26.4]


ARCS = """G00 X10 Y0 Z5
G03 X10 Y0 I-10 F600
G02 X-10 Y0 Z2 I-10
G19 G03 Y20 Z2 J10
G18 G02 X-10 Z2 K5
G91 G17 G03 X5 Y5 Z-1 R5"""
"""Full circles, helices and arcs in all planes."""


def elements(text: str) -> list[Arc | Line]:
    """What the path makes of the motions of a program."""
    found: list[Arc | Line] = []
    position = (0.0, 0.0, 0.0)
    for block in run(text):
        move = block.motion
        if isinstance(move, CircularMove):
            shape = (move.center, move.plane, move.radius, move.sweep)
            found.append(Arc(position, move.target, *shape, range(3), move.directions))
        elif move is not None:
            found.append(Line(position, move.target, range(3)))
        position = move.target if move is not None else position
    return found


def on(element: Arc | Line, part: float) -> np.ndarray:
    return np.array([state[0] for state in element.evaluate(part * element.length, 0.0, 0.0, 0.0)])


@given(sixes, sixes, st.sampled_from(["", "G21", "G22", "G23", "#SCALE X0.5 Y0.5 Z0.5\n#SCALE ON"]), st.booleans())
def test_arcs_in_tilted_systems_are_those_of_turned_points(outer, inner, change, fixture):
    """Each arc of the run without systems, point by point: shifted, turned, mirrored and scaled."""
    command = "#ACS" if fixture else "#CS"
    text = f"{command} ON {listed(outer)}\n#CS ON [2] {listed(inner)}\n{change}\n{ARCS}"
    (v1, r1), (v2, r2) = system(outer), system(inner)
    changed = np.diag({"": (1, 1, 1), "G21": (-1, 1, 1), "G22": (1, -1, 1), "G23": (-1, -1, 1)}.get(change, (0.5,) * 3))
    plain, tilted = elements(ARCS)[1:], elements(text)[1:]
    assert len(plain) == len(tilted) == 5
    for before, after in zip(plain, tilted, strict=True):
        for part in np.linspace(0.0, 1.0, 13):
            expected = v1 + r1 @ (v2 + r2 @ (changed @ on(before, part)))
            np.testing.assert_allclose(
                on(after, part), expected, atol=1e-9 * (1.0 + np.abs(v1).max() + np.abs(v2).max())
            )


@given(sixes, st.sampled_from(range(1, 6)))
def test_extreme_points_of_tilted_arcs_are_those_of_many_samples(values, number):
    text = f"#CS ON {listed(values)}\n{ARCS}"
    arc = elements(text)[number]
    move = [block.motion for block in run(text) if block.motion][number]
    corners = np.array([arc.start, arc.target, *extreme_points(arc.start, move)])
    samples = np.array([on(arc, part) for part in np.linspace(0.0, 1.0, 721)])
    assert corners.min(axis=0) == pytest.approx(samples.min(axis=0), abs=1e-3)
    assert corners.max(axis=0) == pytest.approx(samples.max(axis=0), abs=1e-3)
    assert (corners.min(axis=0) <= samples.min(axis=0) + 1e-9).all()
    assert (corners.max(axis=0) >= samples.max(axis=0) - 1e-9).all()


def test_limits_count_for_the_highest_point_of_a_tilted_circle():
    """A circle of radius 10 in a plane that is tilted by 30 deg about X reaches Z = ±5."""
    text = "G98 Z{}\nG99 Z{}\n#CS ON [0, 0, 0, 30]\nG00 X10\nG03 X10 I-10 F600"
    assert len(run(text.format(-5.001, 5.001))) == 2
    with pytest.raises(ProgramError) as refused:
        run(text.format(-6, 4.9))
    reason = "axis Z: 5 mm lies beyond the software limit 4.9 mm of G99"
    assert str(refused.value) == f"P-ERR-120002 test.nc line 5 column 1 'G03 X10 I-10 F600': {reason}"


def test_inverse_time_feed_of_a_tilted_helix():
    """G93 F10: 10 s for the length of the helix."""
    (_, move) = (
        block.motion for block in run("#CS ON [0,0,0,40,10,5]\nG00 X10\nG93 G03 X10 Z30 I-10 F10") if block.motion
    )
    assert move.feed == pytest.approx(math.hypot(20.0 * math.pi, 30.0) / 10.0, rel=1e-12)
