"""Arcs against closed forms: random circles, written as programs, come back with their centre, radius and angle."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from nc_support import lines, run

from cnc_ptp.nc.arcs import correct_centre, extreme_points
from cnc_ptp.nc.canonical import CircularMove

coordinates = st.floats(-500.0, 500.0).map(lambda value: round(value, 4))
radii = st.floats(0.5, 400.0).map(lambda value: round(value, 4))
angles = st.floats(0.0, 360.0)
sweeps = st.floats(1.0, 359.0)
PLANES = {"G17": (0, 1, 2, "I", "J"), "G18": (2, 0, 1, "K", "I"), "G19": (1, 2, 0, "J", "K")}
AXES = "XYZ"


def on_circle(centre, radius, angle):
    return (
        centre[0] + radius * math.cos(math.radians(angle)),
        centre[1] + radius * math.sin(math.radians(angle)),
    )


def circle(centre, radius, angle, sweep, clockwise):
    """Start and target of an arc, and its signed angle."""
    turn = -sweep if clockwise else sweep
    return on_circle(centre, radius, angle), on_circle(centre, radius, angle + turn), turn


def only_arc(text, start):
    (block,) = run(text, start=start)
    assert isinstance(block.motion, CircularMove)
    return block.motion


@given(
    st.sampled_from(sorted(PLANES)),
    coordinates,
    coordinates,
    radii,
    angles,
    sweeps,
    coordinates,
    st.booleans(),
    st.booleans(),
)
def test_arc_by_centre(plane, c0, c1, radius, angle, sweep, height, clockwise, absolute):
    first, second, normal, word0, word1 = PLANES[plane]
    begin, end, turn = circle((c0, c1), radius, angle, sweep, clockwise)
    start = [0.0, 0.0, 0.0]
    start[first], start[second], start[normal] = *begin, height
    offset = (c0, c1) if absolute else (c0 - begin[0], c1 - begin[1])
    text = (
        f"{plane} {'G161' if absolute else 'G162'} G0{2 if clockwise else 3}"
        f" {AXES[first]}{end[0]:.9f} {AXES[second]}{end[1]:.9f}"
        f" {AXES[normal]}{height + 7.5:.9f} {word0}{offset[0]:.9f} {word1}{offset[1]:.9f} F1200"
    )
    arc = only_arc(text, tuple(start))
    assert arc.plane == (first, second)
    assert arc.feed == 20.0
    assert arc.center == pytest.approx((c0, c1), abs=1e-5)
    assert arc.radius == pytest.approx(radius, abs=1e-5)
    assert arc.sweep == pytest.approx(turn, abs=1e-3)
    assert arc.target[normal] == pytest.approx(height + 7.5, abs=1e-8)


@given(coordinates, coordinates, radii, angles, sweeps, st.booleans())
def test_arc_by_radius(c0, c1, radius, angle, sweep, clockwise):
    assume(abs(sweep - 180.0) > 0.5)
    begin, end, turn = circle((c0, c1), radius, angle, sweep, clockwise)
    signed = radius if sweep < 180.0 else -radius
    text = f"G0{2 if clockwise else 3} X{end[0]:.9f} Y{end[1]:.9f} R{signed:.9f} F60"
    arc = only_arc(text, (*begin, 0.0))
    assert arc.center == pytest.approx((c0, c1), abs=1e-4)
    assert arc.radius == pytest.approx(radius, abs=1e-8)
    assert arc.sweep == pytest.approx(turn, abs=1e-2)


@given(coordinates, coordinates, radii, angles, sweeps, st.floats(-0.4, 0.4), st.booleans())
def test_corrected_centre_has_equal_radii_and_lies_nearest(c0, c1, radius, angle, sweep, error, clockwise):
    begin, end, _ = circle((c0, c1), radius, angle, sweep, clockwise)
    moved = correct_centre(begin, end, (c0 + error, c1 - error))
    assert math.dist(moved.centre, begin) == pytest.approx(math.dist(moved.centre, end), abs=1e-9)
    assert moved.radius == pytest.approx(math.dist(moved.centre, end), abs=1e-9)
    assert moved.offset == pytest.approx(math.dist(moved.centre, (c0 + error, c1 - error)), abs=1e-9)
    along = ((end[0] - begin[0]), (end[1] - begin[1]))
    assert moved.offset <= math.hypot(error, error) + 1e-9, "the true centre is a candidate too"
    shift = (moved.centre[0] - c0 - error, moved.centre[1] - c1 + error)
    assert shift[0] * along[1] - shift[1] * along[0] == pytest.approx(0.0, abs=1e-6), "it moves along the chord"


@given(coordinates, coordinates, radii, angles, st.floats(1.0, 360.0), st.booleans(), coordinates)
def test_extreme_points_bound_the_arc(c0, c1, radius, angle, sweep, clockwise, rise):
    begin, end, turn = circle((c0, c1), radius, angle, sweep, clockwise)
    start, target = (*begin, 0.0), (*end, rise)
    points = extreme_points(start, CircularMove(target, (c0, c1), (0, 1), radius, turn, 1.0))
    assert len(points) <= 4
    samples = [on_circle((c0, c1), radius, angle + turn * step / 720.0) for step in range(721)]
    corners = [*points, start, target]
    for axis in (0, 1):
        for bound in (min, max):
            sampled = bound(sample[axis] for sample in samples)
            assert bound(corner[axis] for corner in corners) == pytest.approx(sampled, abs=radius * 1e-4)
    fractions = [point[2] / rise for point in points] if abs(rise) > 1e-3 else []
    assert fractions == sorted(fractions), "in the order of the path"
    assert all(0.0 < fraction < 1.0 for fraction in fractions)
    for point in points:
        assert math.dist(point[:2], (c0, c1)) == pytest.approx(radius, abs=1e-9)


@given(angles, sweeps, st.booleans(), st.sampled_from([(0, 1), (2, 0), (1, 2)]))
def test_extreme_points_of_a_plane_are_those_of_its_directions(angle, sweep, clockwise, plane):
    """A tilted plane is computed with the directions of its axes; here they are those of the machine."""
    begin, end, turn = circle((3.0, -2.0), 7.0, angle, sweep, clockwise)
    start, target = [1.0] * 3, [4.0] * 3
    start[plane[0]], start[plane[1]] = begin
    target[plane[0]], target[plane[1]] = end
    units = [tuple(float(axis == each) for axis in range(3)) for each in plane]
    move = CircularMove(tuple(target), (3.0, -2.0), plane, 7.0, turn, 1.0)
    expected = extreme_points(tuple(start), move._replace(directions=tuple(units)))
    found = extreme_points(tuple(start), move)
    assert len(found) == len(expected)
    for one, other in zip(found, expected, strict=True):
        assert one == pytest.approx(other, abs=1e-9)


def test_full_circle_by_centre_alone():
    assert lines("G02 I10 F600") == ["arc (0, 0, 0) plane 01 center (10, 0) radius 10 sweep -360 feed 10"]
    assert lines("G03 X0 Y0 J-5 F600") == ["arc (0, 0, 0) plane 01 center (0, -5) radius 5 sweep 360 feed 10"]


def test_full_circle_in_relative_dimensions_survives_rounding():
    text = "G91 G00 X0.1\nX0.2\nG90 G03 X0.3 I5 F600\nX0.3 I5 Y0"
    assert [line for line in lines(text) if "arc" in line] == [
        "arc (0.3, 0, 0) plane 01 center (5.3, 0) radius 5 sweep 360 feed 10"
    ] * 2


def test_full_circle_ends_exactly_where_it_began():
    arc = only_arc("G02 X0.00005 I10 F600", (0.0, 0.0, 0.0))
    assert (arc.target, arc.sweep) == ((0.0, 0.0, 0.0), -360.0)


def test_helix_of_the_manual():
    """Counter-clockwise in XY from X-10 Y0 Z0 to Z20 about the zero point, centre absolute."""
    assert lines("G17 G90 X-10 Y0 Z0 F500 G161\nG03 I0 J0 Z20") == [
        "rapid (-10, 0, 0)",
        "arc (-10, 0, 20) plane 01 center (0, 0) radius 10 sweep 360 feed 8.333333",
    ]


def test_further_axes_move_alongside():
    arc = run("G03 X10 Y10 I0 J10 Z4 C90 F60", axes=("X", "Y", "Z", "C"))[0].motion
    assert arc.target == (10.0, 10.0, 4.0, 90.0)


def test_half_circles_by_radius_of_the_manual():
    expected = ["rapid (-100, 0, 0)", "arc (0, 0, 0) plane 01 center (-50, 0) radius 50 sweep -180 feed 8.333333"]
    assert lines("G00 X-100 F500\nG02 X0 R50") == expected
    assert lines("G00 X-100 F500\nG02 R=50\nX0") == expected


def test_radius_is_modal_until_the_next_one():
    assert lines("G02 X10 Y10 R10 F60\nX20 Y0\nG03 X10 Y-10 R-10") == [
        "arc (10, 10, 0) plane 01 center (10, 0) radius 10 sweep -90 feed 1",
        "arc (20, 0, 0) plane 01 center (10, 0) radius 10 sweep -90 feed 1",
        "arc (10, -10, 0) plane 01 center (10, 0) radius 10 sweep 270 feed 1",
    ]


def test_half_circle_with_a_rounded_radius():
    arc = only_arc("G03 X20.001 R10 F60", (0.0, 0.0, 0.0))
    assert (arc.radius, arc.center) == (10.0005, (10.0005, 0.0))
    assert abs(arc.sweep) == pytest.approx(180.0)


def test_half_circle_beyond_the_tolerance_is_refused():
    with pytest.raises(Exception, match=r"start and target are 20\.003 mm apart, at most 20 mm can be reached"):
        lines("G03 X20.003 R10 F60")


def test_small_error_of_the_centre_is_corrected():
    arc = only_arc("G02 X10 I5.01 F60", (0.0, 0.0, 0.0))
    assert arc.center == pytest.approx((5.0, 0.0), abs=1e-12)
    assert (arc.radius, arc.sweep) == (pytest.approx(5.0), pytest.approx(-180.0))


def test_lathe_plane_by_axis_names():
    arc = run("G18 G02 X10 Z-10 K-10 I0 F60", axes=("X", "Z"))[0].motion
    assert (arc.plane, arc.center, arc.radius) == ((1, 0), (-10.0, 0.0), 10.0)
    assert arc.sweep == pytest.approx(-270.0)
