"""Corner curves: continuity at every joint, distance to the programmed path, and where there is no curve."""

from __future__ import annotations

import itertools
import math
import random

import numpy as np
import pytest
from long_support import long

from cnc_ptp.nc.contour import DIST, POS, Contour
from cnc_ptp.path import Arc, AxisLimits, Line
from cnc_ptp.path.cubic import Cubic
from cnc_ptp.path.lookahead.corners import EVEN, UNEVEN, corner, curve, kink_square, room
from cnc_ptp.path.lookahead.spans import Span, whole

XYZ = (0, 1, 2)


def corner_of(*points, contour=None, path_axes=XYZ):
    """The corner between two lines through three points."""
    first, second = (Line(begin, end, path_axes) for begin, end in itertools.pairwise(points))
    return corner(whole(first, 0), whole(second, 1), contour or Contour(), path_axes)


def random_element(draw, start, size):
    """A line, an arc or a helix of five axes (X, Y, Z, A, C) from `start`; A and C turn with it or rest."""
    target = [value + draw.choice([0.0, draw.uniform(-1, 1) * size]) for value in start]
    if draw.random() < 0.4:
        target[draw.randrange(3)] += size
        return Line(start, target, XYZ)
    first, second = draw.choice([(0, 1), (2, 0), (1, 2)])
    begin, sweep, radius = draw.uniform(-math.pi, math.pi), draw.choice([-1, 1]) * draw.uniform(5.0, 350.0), size
    center = (start[first] - radius * math.cos(begin), start[second] - radius * math.sin(begin))
    target[first] = center[0] + radius * math.cos(begin + math.radians(sweep))
    target[second] = center[1] + radius * math.sin(begin + math.radians(sweep))
    return Arc(start, target, center, (first, second), radius, sweep, XYZ)


def random_pair(draw):
    start = [draw.uniform(-100, 100) for _ in range(5)]
    first = random_element(draw, start, 10 ** draw.uniform(-1, 2))
    return whole(first, 3), whole(random_element(draw, first.target, 10 ** draw.uniform(-1, 2)), 4)


def with_corner(draw):
    """A pair, its contouring, and its corner, which has a curve."""
    while True:
        a, b = random_pair(draw)
        contour = Contour(path_dev=10 ** draw.uniform(-3, 0), track_dev=10 ** draw.uniform(-2, 1))
        result = corner(a, b, contour, XYZ)
        if result is not None and result[1]:
            return a, b, contour, result


def positions(span, places):
    return np.array([[axis[0] for axis in span.shape(u)] for u in places])


def on_original(a, b, first, last, places):
    """Points of the programmed path at the same parameter as on the curve."""
    before = a.length - first.length
    return np.array(
        [
            [axis[0] for axis in (a.shape(first.length + u) if u < before else b.shape(u - before))]
            for u in places
        ]
    )  # fmt: skip


def sampled(result, count=100):
    """Parameter and points of the three pieces of a curve."""
    _, pieces, _ = result
    h = pieces[0].length
    places = np.linspace(0.0, h, count)
    return (
        np.concatenate([places + n * h for n in range(3)]),
        np.concatenate([positions(piece, places) for piece in pieces]),
    )


def distance_to_polyline(points, polyline):
    """Of each point to the nearest segment."""
    begin, along = polyline[:-1], np.diff(polyline, axis=0)
    offset = points[:, None, :] - begin[None, :, :]
    part = np.clip((offset * along).sum(-1) / np.maximum((along * along).sum(-1), 1e-300), 0.0, 1.0)
    return np.linalg.norm(offset - part[..., None] * along, axis=-1).min(axis=1)


# the curve


def test_the_curve_solves_the_conditions_of_its_joints():
    """Against the twelve conditions as a system of linear equations."""
    draw = random.Random(60)
    for _ in range(200):
        h = 10 ** draw.uniform(-2, 1)
        ends = [tuple(draw.uniform(-2, 2) for _ in range(4)) for _ in range(2)]
        rows, values = np.zeros((12, 12)), np.zeros(12)

        def at(u, order):
            return [math.perm(n, order) * u ** (n - order) if n >= order else 0.0 for n in range(4)]

        for order in range(3):
            rows[order, 0:4], values[order] = at(0.0, order), ends[0][order]
            rows[3 + order, 8:12], values[3 + order] = at(h, order), ends[1][order]
            for joint in range(2):
                row = 6 + 3 * joint + order
                rows[row, 4 * joint : 4 * joint + 4] = at(h, order)
                rows[row, 4 * joint + 4 : 4 * joint + 8] = [-value for value in at(0.0, order)]
        expected = np.linalg.solve(rows, values).reshape(3, 4) * [1.0, 1.0, 2.0, 6.0]
        found = [piece.start[0] for piece in curve([ends[0]], [ends[1]], 3.0 * h)]
        assert found == pytest.approx(expected, rel=1e-8, abs=1e-8 * np.abs(expected).max())


def test_a_cubic_path_stays_what_it_is():
    path = Cubic([(1.0, 0.3, -2.0, 5.0), (7.0, -1.0, 0.5, 2.0)], 3.0)
    for n, piece in enumerate(curve(path.shape(0.0), path.shape(3.0), 3.0)):
        assert np.array(piece.start) == pytest.approx(np.array(path.shape(float(n))), rel=1e-12, abs=1e-12)


def largest_parts(before, after):
    """What unit jumps of q1, q2, q3 in the corner, and a unit q4 on each side, make the curve deviate at most."""
    u = np.linspace(0.0, before + after, 601)
    x = u - before

    def deviation(start, end, original):
        pieces = curve([(*start, 0.0)], [(*end, 0.0)], before + after)
        h = pieces[0].length
        values = [pieces[min(2, int(v / h))].shape(v - min(2, int(v / h)) * h)[0][0] for v in u]
        return np.abs(np.array(values) - original)

    at_rest = (0.0, 0.0, 0.0)
    found = []
    for n in (1, 2, 3):
        end = [math.perm(n, k) * after ** (n - k) / math.factorial(n) if n >= k else 0.0 for k in range(3)]
        found.append(deviation(at_rest, end, np.maximum(x, 0.0) ** n / math.factorial(n)).max())
    for side, distance in ((-1, before), (1, after)):
        total, steps = np.zeros_like(u), 40
        for t in (np.arange(steps) + 0.5) / steps * distance:
            far = distance - t
            end = (far**3 / 6.0, side * far**2 / 2.0, far)
            pair = (end, at_rest) if side < 0 else (at_rest, end)
            total += deviation(*pair, np.maximum(side * x - t, 0.0) ** 3 / 6.0) * distance / steps
        found.append(total.max())
    return found


def test_no_part_of_the_deviation_is_larger_than_its_constant():
    even = largest_parts(1.0, 1.0)
    assert even == pytest.approx([*EVEN, EVEN[3]], rel=1e-3)
    assert all(part <= limit * (1 + 1e-12) for part, limit in zip(even, [*EVEN, EVEN[3]], strict=True))
    for other in (1e-9, 0.03, 0.1, 0.25, 0.4, 0.525, 0.7, 0.9):
        for before, after in ((1.0, other), (other, 1.0)):
            for part, limit in zip(largest_parts(before, after), [*UNEVEN, UNEVEN[3]], strict=True):
                assert part <= limit * (1 + 1e-6)


# corners by hand


def test_right_angle_by_hand():
    """Deviation 13/72·d·√2 along the bisector, in the middle of the curve."""
    first, pieces, last = corner_of(
        (0.0, 0.0, 0.0), (100.0, 0.0, 0.0), (100.0, 100.0, 0.0), contour=Contour(path_dev=0.1)
    )
    d = 0.1 * 72.0 / 13.0 / math.sqrt(2.0)
    assert (first.begin, first.end, first.block) == (0.0, pytest.approx(100.0 - d, abs=1e-12), 0)
    assert (last.begin, last.end, last.block) == (pytest.approx(d, abs=1e-12), 100.0, 1)
    assert [piece.length for piece in pieces] == pytest.approx([2.0 * d / 3.0] * 3, rel=1e-12)
    assert [piece.block for piece in pieces] == [0, 1, 1]
    middle = [axis[0] for axis in pieces[1].shape(d / 3.0)]
    assert middle == pytest.approx([100.0 - 0.1 / math.sqrt(2.0), 0.1 / math.sqrt(2.0), 0.0], abs=1e-12)


@pytest.mark.parametrize(
    ("path_axes", "target", "contour", "distance"),
    [
        (XYZ, (20.0, 4.0, 0.0), Contour(path_dev=100.0), 5.0),
        (XYZ, (10.0, 0.04, 0.0), Contour(), 0.02),
        (XYZ, (10.0, 0.04, 0.0), Contour(remain_part=50.0), 0.01),
        (XYZ, (10.0, 50.0, 0.0), Contour(DIST, pre_dist=2.0, post_dist=2.0), 2.0),
        (XYZ, (10.0, 3.0, 0.0), Contour(DIST, pre_dist=2.0, post_dist=2.0), 1.5),
        ((0, 1), (10.0, 50.0, 500.0), Contour(track_dev=1.0), 72.0 / 13.0 / 10.0),
        ((0, 1), (10.0, 50.0, 500.0), Contour(track_dev=1e3), 72.0 / 13.0 / math.sqrt(2.0)),
        ((0, 1), (10.0, 50.0, 500.0), Contour(DIST, track_dev=0.01), 0.01 * 72.0 / 13.0 / 10.0),
    ],
    ids=[
        "half of A",
        "half of B",
        "REMAIN_PART",
        "DIST",
        "DIST within half a block",
        "TRACK_DEV",
        "large TRACK_DEV",
        "both",
    ],
)
def test_distances_from_the_corner(path_axes, target, contour, distance):
    first, _, last = corner_of((0.0, 0.0, 0.0), (10.0, 0.0, 0.0), target, contour=contour, path_axes=path_axes)
    assert 10.0 - first.end == pytest.approx(distance, abs=1e-12)
    assert last.begin == pytest.approx(distance, abs=1e-12)


def test_different_distances_are_shortened_apart_unless_by_track_dev():
    points = ((0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (10.0, 2.0, 20.0))
    contour = Contour(DIST, pre_dist=4.0, post_dist=3.0, track_dev=1e3)
    first, _, last = corner_of(*points, contour=contour, path_axes=(0, 1))
    assert (10.0 - first.end, last.begin) == pytest.approx((4.0, 1.0), abs=1e-12)
    first, pieces, last = corner_of(*points, contour=contour._replace(track_dev=1.0), path_axes=(0, 1))
    assert (10.0 - first.end) / last.begin == pytest.approx(4.0, rel=1e-12)
    result = (first, pieces, last)
    u, points_of_curve = sampled(result)
    whole_a, whole_b = whole(first.element, 0), whole(last.element, 1)
    deviation = np.abs(points_of_curve - on_original(whole_a, whole_b, first, last, u))[:, 2].max()
    assert 0.3 <= deviation <= 1.0


@pytest.mark.parametrize(("pre", "post"), [(10.0, 0.25), (0.25, 10.0)])
@pytest.mark.parametrize("radius", [0.2, *long([0.05, 1.0])])
def test_a_small_arc_does_not_throw_a_curve_of_different_distances_far_out(radius, pre, post):
    """The curvature of the arc counts on the whole curve, which is as long as both distances."""
    line = Line((-30.0, 0.0, 0.0), (0.0, 0.0, 0.0), XYZ)
    arc = Arc((0.0, 0.0, 0.0), (0.0, 2.0 * radius, 0.0), (0.0, radius), (0, 1), radius, 180.0, XYZ)
    contour = Contour(DIST, pre_dist=pre, post_dist=post, remain_part=0.0)
    result = corner(whole(line, 0), whole(arc, 1), contour, XYZ)
    path = np.vstack([positions(whole(element, 0), np.linspace(0.0, element.length, 1000)) for element in (line, arc)])
    assert (
        1e-6 < distance_to_polyline(sampled(result)[1], path).max() <= 0.5 * max(pre, min(post, math.pi / 2 * radius))
    )


def test_both_corners_of_a_short_block_meet_in_its_middle():
    lines = [
        whole(Line(begin, end, XYZ), n)
        for n, (begin, end) in enumerate(
            itertools.pairwise([(0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (10.0, 0.3, 0.0), (20.0, 0.3, 0.0)])
        )
    ]
    _, _, middle = corner(lines[0], lines[1], Contour(), XYZ)
    left, _, last = corner(middle, lines[2], Contour(), XYZ)
    assert (left.begin, left.end, left.length) == (0.15, 0.15, 0.0)
    assert last.begin == 0.15


def test_no_part_is_left_that_is_rounding():
    a = Span(Line((0.0, 0.0, 0.0), (10.0, 0.0, 0.0), XYZ), 5.0 - 4e-10, 10.0, 0)
    b = Span(Line((10.0, 0.0, 0.0), (10.0, 10.0, 0.0), XYZ), 0.0, 5.0 + 4e-10, 1)
    first, pieces, last = corner(a, b, Contour(DIST, pre_dist=5.0, post_dist=5.0), XYZ)
    assert (first.length, last.length) == (0.0, 0.0)
    assert sum(piece.length for piece in pieces) == pytest.approx(a.length + b.length, rel=1e-15)


def test_tangential_line_and_arc():
    """Only the curvature jumps; the deviation is that of a jump of q2 as long as the curve is short."""
    line = Line((-50.0, -10.0, 0.0), (0.0, -10.0, 0.0), XYZ)
    arc = Arc((0.0, -10.0, 0.0), (10.0, 0.0, 0.0), (0.0, 0.0), (0, 1), 10.0, 90.0, XYZ)
    a, b = whole(line, 0), whole(arc, 1)
    result = corner(a, b, Contour(path_dev=1e-4), XYZ)
    first, pieces, last = result
    assert last.begin == pytest.approx(math.sqrt(1e-4 * 10.0 / 0.00473278), rel=0.06)
    assert_smooth(result)
    u, points = sampled(result)
    deviation = np.linalg.norm(points - on_original(a, b, first, last, u), axis=1).max()
    assert 0.9e-4 <= deviation <= 1e-4
    bend = [piece.shape(piece.length)[1][2] for piece in pieces]
    assert bend == pytest.approx([-0.1 / 24.0, 0.1 * 25.0 / 24.0, 0.1], abs=0.012)


def test_on_an_arc_the_distance_ends_at_90_degrees():
    line = Line((-500.0, 0.0, 0.0), (0.0, 0.0, 0.0), XYZ)
    arc = Arc((0.0, 0.0, 0.0), (20.0, 0.0, 0.0), (10.0, 0.0), (0, 1), 10.0, -340.0 + 160.0, XYZ)
    full = Arc((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (10.0, 0.0), (0, 1), 10.0, -360.0, XYZ)
    for element in (arc, full):
        _, _, last = corner(whole(line, 0), whole(element, 1), Contour(path_dev=1e6), XYZ)
        assert last.begin == pytest.approx(5.0 * math.pi, rel=1e-12)


# many corners


def assert_smooth(result):
    """q, q1, q2 are the same on both sides of every joint."""
    first, pieces, last = result
    for before, after in itertools.pairwise([first, *pieces, last]):
        one, other = before.shape(before.length), after.shape(0.0)
        for order, allowed in ((0, 1e-9), (1, 1e-9)):
            assert [axis[order] for axis in one] == pytest.approx(
                [axis[order] for axis in other], rel=1e-9, abs=allowed
            )
        scale = max(abs(axis[2]) for piece in pieces for axis in piece.shape(0.0))
        assert [axis[2] for axis in one] == pytest.approx([axis[2] for axis in other], abs=1e-9 * max(1.0, scale))


@pytest.mark.parametrize("count", [200, *long([1000])])
def test_random_corners_are_smooth_and_within_their_tolerance(count):
    """Pairs of lines, arcs and helices of five axes; distance to the programmed path as a polyline."""
    draw = random.Random(61)
    used = []
    for _ in range(count):
        a, b, contour, result = with_corner(draw)
        first, _, last = result
        assert first.end >= 0.5 * a.length * (1 - 1e-12)
        assert last.begin <= 0.5 * b.length * (1 + 1e-12)
        assert_smooth(result)
        u, points = sampled(result, 40)
        original = on_original(a, b, first, last, u)
        deviation = np.abs(points - original)
        assert np.linalg.norm((points - original)[:, :3], axis=1).max() <= contour.path_dev * (1 + 1e-9)
        assert deviation[:, 3:].max() <= contour.track_dev * (1 + 1e-9)
        polyline = np.vstack(
            [
                positions(a, np.linspace(first.length, a.length, 100)),
                positions(b, np.linspace(0.0, last.begin, 100)),
            ]
        )[:, :3]
        steps = np.linalg.norm(np.diff(polyline, axis=0), axis=1)
        radii = [span.element.radius for span in (a, b) if isinstance(span.element, Arc)]
        sagitta = steps.max() ** 2 / (8.0 * min(radii)) if radii else 0.0
        assert distance_to_polyline(points[:, :3], polyline).max() <= contour.path_dev * (1 + 1e-9) + sagitta
        if last.begin < 0.999 * room(b, contour) and a.length - first.end < 0.999 * room(a, contour):
            share = np.linalg.norm((points - original)[:, :3], axis=1).max() / contour.path_dev
            used.append(max(share, deviation[:, 3:].max() / contour.track_dev))
    assert len(used) > 0.6 * count
    assert np.percentile(used, 5) > 0.9
    assert min(used) > 0.3


# no curve


def test_a_path_that_goes_straight_on_has_no_curve():
    line = Line((0.1, 0.2, 0.3), (100.7, 33.3, 47.1), XYZ)
    middle = [axis[0] for axis in line.shape(37.123)]
    parts = whole(Line(line.start, middle, XYZ), 0), whole(Line(middle, line.target, XYZ), 1)
    assert corner(*parts, Contour(), XYZ) == (parts[0], [], parts[1])
    arc = Arc((10.0, 0.0, 0.0), (-10.0, 0.0, 5.0), (0.0, 0.0), (0, 1), 10.0, 180.0, XYZ)
    halves = Span(arc, 0.0, 10.0, 0), Span(arc, 10.0, arc.length, 1)
    assert corner(*halves, Contour(), XYZ) == (halves[0], [], halves[1])


@pytest.mark.parametrize(
    ("degrees", "contour", "curved"),
    [
        (169.9, Contour(), True),
        (170.1, Contour(), False),
        (180.0, Contour(), False),
        (180.0, Contour(DIST), False),
        (29.0, Contour(max_angle=30.0), True),
        (31.0, Contour(max_angle=30.0), False),
        (90.0, Contour(path_dev=1e-7), False),
        (90.0, Contour(DIST, pre_dist=0.0), False),
        (90.0, Contour(remain_part=100.0), False),
    ],
)
def test_where_there_is_no_curve(degrees, contour, curved):
    x, y = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    points = (0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (10.0 + 10.0 * x, 10.0 * y, 0.0)
    assert (corner_of(*points, contour=contour) is not None) is curved


def test_the_angle_between_line_and_arc_does_not_count_for_max_angle():
    line = Line((-10.0, 0.0, 0.0), (0.0, 0.0, 0.0), XYZ)
    arc = Arc((0.0, 0.0, 0.0), (20.0, 0.0, 0.0), (10.0, 0.0), (0, 1), 10.0, -180.0, XYZ)
    assert corner(whole(line, 0), whole(arc, 1), Contour(max_angle=30.0), XYZ) is not None


def test_a_kink_of_other_axes_needs_track_dev():
    points = (0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (20.0, 0.0, 90.0)
    assert corner_of(*points, path_axes=(0, 1)) is None
    assert corner_of(*points[:2], (20.0, 5.0, 90.0), path_axes=(0, 1)) is None
    assert corner_of((0.0, 0.0, -90.0), (10.0, 0.0, 0.0), (10.0, 10.0, 90.0), path_axes=(0, 1)) is not None
    _, _, last = corner_of(*points, contour=Contour(track_dev=1.0), path_axes=(0, 1))
    assert last.begin == pytest.approx(72.0 / 13.0 / 9.0, rel=1e-12)
    assert corner_of(*points[:2], (10.0, 0.0, 90.0), contour=Contour(track_dev=1.0), path_axes=(0, 1)) is not None
    assert corner_of((0.0, 0.0), (0.0, 0.0), (10.0, 0.0), path_axes=(0, 1)) is None


# as it is


LIMITS = [AxisLimits(500.0, 3000.0, 2000.0, jerk) for jerk in (30000.0, 20000.0, 1000.0)]


def test_a_kink_that_a_cycle_hides():
    """The third difference of the sampled positions is half the jerk of the weakest axis."""
    a, b = Line((0.0, 0.0, 0.0), (10.0, 0.0, 0.0), XYZ), Line((10.0, 0.0, 0.0), (20.0, 1.0, 0.1), XYZ)
    cycle = 0.002
    v = math.sqrt(kink_square(whole(a, 0), whole(b, 1), LIMITS, cycle))
    path = [a.shape(10.0 + n * v * cycle) if n < 0 else b.shape(n * v * cycle) for n in range(-4, 5)]
    steps = np.diff([[axis[0] for axis in point] for point in path], axis=0) / cycle
    jerk = np.abs(np.diff(steps, axis=0)).max(axis=0) / cycle**2
    share = jerk / [axis.jerk for axis in LIMITS]
    assert share.max() == pytest.approx(0.5, rel=1e-6)
    assert np.argmax(share) == 2


def test_a_jump_of_curvature_that_a_cycle_hides():
    """v²/r may jump by half of what the jerk makes of the acceleration in one cycle."""
    line = whole(Line((-10.0, 0.0, 0.0), (0.0, 0.0, 0.0), XYZ), 0)
    arc = whole(Arc((0.0, 0.0, 0.0), (10.0, 10.0, 0.0), (0.0, 10.0), (0, 1), 10.0, 90.0, XYZ), 1)
    square = kink_square(line, arc, LIMITS, 0.002)
    assert square / 10.0 == pytest.approx(0.5 * 20000.0 * 0.002, rel=1e-12)


def test_where_nothing_jumps_no_velocity_is_too_high():
    line = Line((0.1, 0.2, 0.3), (100.7, 33.3, 47.1), XYZ)
    middle = [axis[0] for axis in line.shape(37.123)]
    assert (
        kink_square(whole(Line(line.start, middle, XYZ), 0), whole(Line(middle, line.target, XYZ), 1), LIMITS, 0.001)
        == math.inf
    )


def test_a_corner_with_its_curve_has_no_jump():
    draw = random.Random(62)
    for _ in range(200):
        _, _, _, (first, pieces, last) = with_corner(draw)
        for before, after in itertools.pairwise([first, *pieces, last]):
            assert kink_square(before, after, [AxisLimits(1.0, 1.0, 1.0, 1.0)] * 5, 0.001) > 1e9


# spans


def test_a_span_is_its_part_of_the_element():
    draw = random.Random(63)
    for _ in range(200):
        element = random_pair(draw)[0].element
        begin = draw.uniform(0.0, 0.5) * element.length
        span = Span(element, begin, element.length, 7)
        u = draw.random() * span.length
        assert span.shape(u) == element.shape(begin + u)
        assert span.evaluate(u, 3.0, 2.0, 1.0) == element.evaluate(begin + u, 3.0, 2.0, 1.0)
        assert span.bounds(0.0, u) == element.bounds(begin, begin + u)
        assert span.speed(u, XYZ) == element.speed(begin + u, XYZ)
        assert tuple(axis[0] for axis in span.shape(span.length)) == element.target


@pytest.mark.parametrize(("before", "after"), [(2.0, 3.0), (0.0, 0.0), (0.0, 1.0)])
@pytest.mark.parametrize("point", [(9.0, 1.0, 0.0), (12.0, -2.0, 0.5)])
def test_the_curve_goes_through_its_interim_point(before, after, point):
    contour = Contour(mode=POS, pre_dist=before, post_dist=after, point=point)
    first, curves, last = corner_of((0, 0, 0), (10, 0, 0), (10, 10, 0), contour=contour)
    assert first.length == 10.0 - before and last.length == 10.0 - after
    assert [span.block for span in curves] == [0, 0, 0, 1, 1, 1]
    assert curves[3].shape(0.0)[0][0] == pytest.approx(point[0], abs=1e-12)
    assert [axis[0] for axis in curves[3].shape(0.0)] == pytest.approx(point, abs=1e-12)
    for span, following in itertools.pairwise([first, *curves, last]):
        for one, other in zip(span.shape(span.length), following.shape(0.0), strict=True):
            assert one[:3] == pytest.approx(other[:3], abs=1e-9)


def test_no_curve_through_a_point_where_the_path_is_left_or_met():
    contour = Contour(mode=POS, pre_dist=2.0, post_dist=3.0, point=(8.0, 0.0, 0.0))
    assert corner_of((0, 0, 0), (10, 0, 0), (10, 10, 0), contour=contour) is None
    assert corner_of((0, 0, 0), (10, 0, 0), (10, 10, 0), contour=contour._replace(point=(10.0, 3.0, 0.0))) is None


@pytest.mark.parametrize("axis", [0, 1])
def test_no_curve_through_a_point_beyond_the_room_of_an_axis(axis):
    """Its extremes count, sampled here, not its ends."""
    contour = Contour(mode=POS, pre_dist=0.0, post_dist=0.0, point=(12.0, -2.0, 0.0))
    _, curves, _ = corner_of((0, 0, 0), (10, 0, 0), (10, 10, 0), contour=contour)
    sampled = [span.shape(span.length * n / 500)[axis][0] for span in curves for n in range(501)]
    for share, possible in ((1e-5, True), (-1e-5, False)):
        room = [(-100.0, 100.0)] * 3
        room[axis] = (min(sampled) - share, max(sampled) + share)
        found = corner_of((0, 0, 0), (10, 0, 0), (10, 10, 0), contour=contour._replace(room=tuple(room)))
        assert (found is not None) is possible


def test_no_curve_through_a_point_with_a_kink_of_another_axis():
    contour = Contour(mode=POS, track_dev=1.0, point=(9.0, 1.0, 0.0, 0.0))
    assert corner_of((0, 0, 0, 0), (10, 0, 0, 0), (10, 10, 0, 5), contour=contour) is None
