"""Smoothing: distance from the points by cumulated chords, joints, corners, lines, feed, and the velocity that results."""

from __future__ import annotations

import itertools
import math
import random
import runpy
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from long_support import long

from cnc_ptp.errors import CncError
from cnc_ptp.path import AxisLimits
from cnc_ptp.path.cubic import Cubic
from cnc_ptp.path.lookahead.parts import PathPart, UndividedPart, division_of, whole_cell
from cnc_ptp.path.lookahead.path_profile import PathProfile, pieces_of
from cnc_ptp.path.lookahead.smoothing import LONG_LINE, LONGEST_SPAN, Smoother, SmoothPiece
from cnc_ptp.path.lookahead.velocity_plan import MovingStart, plan_velocity

FEED = 100.0
AXES = [AxisLimits(500.0, 1000.0, 1000.0, 20000.0)] * 3
CONTOUR = Path(__file__).parents[2] / "examples" / "contour.py"
Point = tuple[float, ...]


def smooth(points, path_dev=0.005, track_dev=5.0, *, every=1, feed=lambda block: FEED, path_axes=None, **options):
    """All pieces; block n ends at point n. `every`: points between two calls of take."""
    axes = range(min(3, len(points[0]))) if path_axes is None else path_axes
    smoother = Smoother(points[0], axes, path_dev, track_dev, **options)
    pieces: list[SmoothPiece] = []
    for block, point in enumerate(points[1:], start=1):
        smoother.add(point, block, feed(block))
        if block % every == 0:
            pieces += smoother.take()
    smoother.finish()
    return pieces + smoother.take()


def chords_of(points, path_axes) -> np.ndarray:
    """Length of each chord; over all axes where the path axes rest."""
    steps = np.diff(np.asarray(points, float), axis=0)
    lengths = np.linalg.norm(steps[:, list(path_axes)], axis=1)
    return np.where(lengths < 1e-6, np.linalg.norm(steps, axis=1), lengths)


def curve_at(pieces, places) -> np.ndarray:
    """Positions of all axes at places along all pieces; one row each."""
    ends = np.cumsum([piece.geometry.length for piece in pieces])
    index = np.minimum(np.searchsorted(ends, places), len(pieces) - 1)
    starts = np.array([piece.geometry.start for piece in pieces])
    u = (places - np.concatenate([[0.0], ends])[index])[:, None]
    q, q1, q2, q3 = np.moveaxis(starts[index], 2, 0)
    return q + u * (q1 + u * (q2 / 2 + u * q3 / 6))


def deviations(points, pieces, path_axes=(0, 1, 2), *, between=0) -> tuple[float, float]:
    """Largest distance over the path axes, and of any other axis, at all points, middles of chords, and between."""
    axes = [axis for axis in path_axes if axis < len(points[0])]
    lengths = chords_of(points, axes)
    knots = np.concatenate([[0.0], np.cumsum(lengths)])
    assert sum(piece.geometry.length for piece in pieces) == pytest.approx(knots[-1], rel=1e-9, abs=1e-9)
    places = np.concatenate([knots, 0.5 * (knots[1:] + knots[:-1]), np.linspace(0.0, knots[-1], between)])
    moving = np.concatenate([[True], lengths > 0.0])
    polyline = np.array([np.interp(places, knots[moving], values) for values in np.array(points, float)[moving].T]).T
    misses = curve_at(pieces, places) - polyline
    others = [axis for axis in range(misses.shape[1]) if axis not in axes]
    track = float(np.abs(misses[:, others]).max()) if others else 0.0
    return float(np.linalg.norm(misses[:, axes], axis=1).max()), track


def check_joints(pieces) -> None:
    """Positions meet everywhere; direction and curvature meet except behind an end."""
    for piece, following in itertools.pairwise(pieces):
        end = np.array(piece.geometry.shape(piece.geometry.length))
        begin = np.array(following.geometry.start)
        assert np.abs(end[:, 0] - begin[:, 0]).max() < 1e-9
        if not piece.ends:
            scale = 1.0 + np.abs(begin).max(axis=0)
            assert np.abs(end[:, 1] - begin[:, 1]).max() < 1e-9 * scale[1]
            assert np.abs(end[:, 2] - begin[:, 2]).max() < 1e-7 * scale[2]


def check_ends(points, pieces) -> None:
    """First and last point, exactly; no curvature at the ends of a curve."""
    assert [shape[0] for shape in pieces[0].geometry.start] == pytest.approx(points[0], abs=1e-9)
    assert pieces[-1].geometry.target == pytest.approx(points[-1], abs=1e-9)
    assert pieces[-1].ends
    for piece, following in itertools.pairwise([None, *pieces, None]):
        if piece is None or piece.ends:
            if following is not None:
                assert max(abs(shape[2]) for shape in following.geometry.start) < 1e-9
            if piece is not None:
                end = piece.geometry.shape(piece.geometry.length)
                scale = max(1.0, *(abs(shape[3]) for shape in end))
                assert max(abs(shape[2]) for shape in end) < 1e-7 * scale


def wave(count, chord, radius, wavelength, digits=3) -> list[Point]:
    """Points on a sine whose smallest radius of curvature is `radius`, rounded."""
    amplitude = (wavelength / math.tau) ** 2 / radius
    points, x = [], 0.0
    for _ in range(count + 1):
        points.append((round(x, digits), round(amplitude * math.sin(math.tau * x / wavelength), digits), 0.0))
        x += chord / math.hypot(1.0, amplitude * math.tau / wavelength * math.cos(math.tau * x / wavelength))
    return points


def arc(radius, chord, turn, digits=6, start=0.0) -> list[Point]:
    """Points on a circle around the origin."""
    count = max(2, round(radius * turn / chord))
    angles = [start + turn * number / count for number in range(count + 1)]
    return [(round(radius * math.cos(a), digits), round(radius * math.sin(a), digits), 0.0) for a in angles]


def random_contour(draw) -> list[Point]:
    """Chords of 0.001 to 60 mm in two, three or five axes: arcs, corners, U-turns, spikes, noise, repeated points."""
    count, axes = draw.choice([1, 2, 3, 5, 20, 100, 300]), draw.choice([2, 3, 5])
    digits, slope = draw.choice([3, 4, 6]), draw.uniform(-0.3, 0.3)
    chord, bend, direction = 10 ** draw.uniform(-2, 0.3), 0.0, draw.uniform(0.0, math.tau)
    place = [0.0] * axes
    points = [tuple(place)]
    for number in range(count):
        if draw.random() < 0.05:
            bend = draw.choice([0.0, 1.0]) * draw.uniform(-1, 1) * 10 ** draw.uniform(-2, 1)
        if draw.random() < 0.04:
            direction += draw.choice([math.pi, draw.uniform(-math.pi, math.pi)])
        if draw.random() < 0.05:
            chord = 10 ** draw.uniform(-3, 0.3)
        if draw.random() < 0.02:
            points.append(points[-1])
            continue
        step = chord * (30.0 if draw.random() < 0.02 else draw.uniform(0.5, 1.5))
        direction += max(-1.0, min(1.0, bend * step))
        place[0] += step * math.cos(direction)
        place[1] += step * math.sin(direction)
        place[2:3] = [value + step * slope * math.sin(number / 30) for value in place[2:3]]
        place[3:] = [value + step * draw.choice([0.0, 1.0, 10.0 * draw.uniform(-1, 1)]) for value in place[3:]]
        spike = draw.gauss(0.0, 0.02) if draw.random() < 0.02 else 0.0
        points.append(tuple(round(value + (spike if axis == 1 else 0.0), digits) for axis, value in enumerate(place)))
    return points


@pytest.mark.parametrize("group", [*range(2), *long(range(2, 8))])
def test_random_contours_are_within_the_deviation_with_continuous_joints(group):
    for seed in range(15 * group, 15 * group + 15):
        draw = random.Random(seed)
        points, path_dev, track_dev = (
            random_contour(draw),
            draw.choice([0.001, 0.005, 0.02, 0.2]),
            draw.choice([0.01, 1]),
        )
        pieces = smooth(points, path_dev, track_dev)
        if len(set(points)) == 1:
            assert pieces == []
            continue
        path, track = deviations(points, pieces, between=20_000)
        assert path <= path_dev, seed
        assert track <= track_dev, seed
        check_joints(pieces)
        check_ends(points, pieces)


def test_pieces_do_not_depend_on_when_they_are_taken():
    for seed in range(20):
        points = random_contour(random.Random(seed))
        found = [
            [(piece.geometry.start, piece.geometry.length, piece.block, piece.feed, piece.ends) for piece in pieces]
            for pieces in (smooth(points), smooth(points, every=7), smooth(points, every=10**9))
        ]
        assert found[0] == found[1] == found[2]


def test_pieces_come_while_points_arrive():
    points = wave(3000, 0.05, 15.0, 60.0)
    smoother = Smoother(points[0], (0, 1, 2), 0.005, 0.0)
    given, behind = 0.0, []
    for block, point in enumerate(points[1:], start=1):
        smoother.add(point, block, FEED)
        given += sum(piece.geometry.length for piece in smoother.take())
        behind.append(0.05 * block - given)
    assert max(behind) < 8 * LONGEST_SPAN


@pytest.mark.parametrize(
    ("points", "lengths"),
    [
        ([(0.0, 0.0, 0.0), (3.0, 4.0, 0.0)], [5.0]),
        ([(0.0, 0.0, 0.0), (3.0, 0.0, 0.0), (3.0, 4.0, 0.0)], [3.0, 4.0]),
        ([(0.0, 0.0, 0.0), (3.0, 0.0, 0.0), (1.0, 0.0, 0.0)], [3.0, 2.0]),
        ([(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (30.0, 0.0, 0.0), (30.0, 0.0, 0.0)], [30.0]),
        ([(1.0, 2.0, 3.0), (1.0, 2.0, 3.0)], []),
        ([(1.0, 2.0, 3.0)], []),
    ],
)
def test_single_blocks_and_corners_by_hand(points, lengths):
    """One block, two with a corner, a U-turn, repeated points, nothing that moves."""
    pieces = smooth(points)
    assert [piece.geometry.length for piece in pieces] == lengths
    assert all(piece.ends for piece in pieces)
    assert all(shape[2:] == (0.0, 0.0) for piece in pieces for shape in piece.geometry.start)


def test_collinear_points_become_straight_pieces():
    points = [(0.05 * number, 0.0, 0.03 * number) for number in range(400)]
    pieces = smooth(points)
    assert all(shape[2:] == (0.0, 0.0) for piece in pieces for shape in piece.geometry.start)
    assert len(pieces) < 20
    assert deviations(points, pieces)[0] < 1e-9


def test_corners_above_the_angle_are_kept_and_those_below_are_rounded():
    for degrees, kept in ((30.0, False), (35.0, False), (37.0, True), (90.0, True), (179.0, True), (180.0, True)):
        turn = math.radians(degrees)
        points = [(0.05 * number, 0.0, 0.0) for number in range(101)]
        points += [(5 + 0.05 * n * math.cos(turn), 0.05 * n * math.sin(turn), 0.0) for n in range(1, 101)]
        pieces = smooth(points)
        corners = [piece.geometry.target for piece in pieces if piece.ends]
        assert len(corners) == (2 if kept else 1), degrees
        if kept:
            assert corners[0] == pytest.approx((5.0, 0.0, 0.0), abs=1e-12)
        assert deviations(points, pieces)[0] <= 0.005


def test_corner_of_rounded_points_between_arcs_is_one_corner_at_its_point():
    """A circle of 10 mm, then 90 deg to the side onto another one."""
    first = arc(10.0, 0.02, 1.5, digits=3)
    x, y, _ = first[-1]
    second = arc(10.0, 0.02, 1.5, digits=3, start=1.5 + math.pi / 2)
    dx, dy = x - second[0][0], y - second[0][1]
    points = first + [(round(a + dx, 3), round(b + dy, 3), 0.0) for a, b, _ in second[1:]]
    corners = [piece.geometry.target for piece in smooth(points) if piece.ends]
    assert corners == [pytest.approx(first[-1], abs=1e-9), pytest.approx(points[-1], abs=1e-9)]


def test_narrow_radius_in_short_chords_is_no_corner():
    """0.3 mm radius through 90 deg, in chords that turn by 10 deg."""
    points = [(-2.0 + 0.05 * n, -0.3, 0.0) for n in range(40)]
    points += arc(0.3, 0.052, math.pi / 2, digits=3, start=-math.pi / 2)
    points += [(0.3, 0.05 * n, 0.0) for n in range(1, 41)]
    assert [piece.ends for piece in smooth(points)].count(True) == 1


def test_long_line_between_curves_is_straight_and_joined_without_a_step():
    """Half circle of 10 mm radius, line of 40 mm, half circle: the stadium."""
    left = arc(10.0, 0.05, math.pi, digits=3, start=math.pi / 2)
    right = [(40.0 - x, -y, 0.0) for x, y, _ in left]
    points = left + right
    pieces = smooth(points)
    (line,) = [piece for piece in pieces if piece.geometry.length > LONG_LINE * LONGEST_SPAN]
    assert line.geometry.length == pytest.approx(40.0 - 2.0 * LONGEST_SPAN)
    assert [shape[1:] for shape in line.geometry.start] == [(1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)]
    assert [piece.ends for piece in pieces].count(True) == 1
    check_joints(pieces)
    assert deviations(points, pieces, between=9000)[0] <= 0.005


def test_long_lines_with_a_slight_bend_are_rounded_within_the_deviation():
    points = [(0.0, 0.0, 0.0), (50.0, 0.0, 0.0), (100.0, 5.0, 0.0), (130.0, 5.0, 0.0)]
    pieces = smooth(points)
    assert [piece.ends for piece in pieces].count(True) == 1
    assert deviations(points, pieces, between=100_000)[0] <= 0.005
    check_joints(pieces)


def test_blocks_with_other_axes_alone_are_straight_pieces_of_their_own():
    points = [(0.05 * n, 0.0, 0.0, 0.0) for n in range(21)]
    points += [(1.0, 0.0, 0.0, 90.0)] + [(1.0 + 0.05 * n, 0.0, 0.0, 90.0) for n in range(1, 21)]
    pieces = smooth(points)
    turns = [piece for piece in pieces if piece.geometry.start[3][1] != 0.0]
    assert [(piece.geometry.length, piece.block, piece.ends) for piece in turns] == [(90.0, 21, True)]
    assert deviations(points, pieces)[0] < 1e-9
    check_ends(points, pieces)


def test_a_feed_change_takes_effect_at_its_point():
    points = wave(600, 0.05, 15.0, 60.0)
    for change in (1, 7, 200, 213, 599):
        pieces = smooth(points, feed=lambda block, change=change: 50.0 if block <= change else 20.0)
        slow = sum(piece.geometry.length for piece in pieces if piece.feed == 50.0)
        assert slow == pytest.approx(chords_of(points, (0, 1, 2))[:change].sum(), abs=2e-3 * LONGEST_SPAN)
        assert sorted({piece.feed for piece in pieces}) == [20.0, 50.0]
        check_joints(pieces)


def test_blocks_are_those_at_the_middles_of_the_pieces():
    points = wave(600, 0.05, 15.0, 60.0)
    pieces = smooth(points)
    knots = np.cumsum(chords_of(points, (0, 1, 2)))
    ends = np.cumsum([piece.geometry.length for piece in pieces])
    middles = ends - [0.5 * piece.geometry.length for piece in pieces]
    assert [piece.block for piece in pieces] == list(np.searchsorted(knots, middles, side="right") + 1)


def test_parameter_is_nearly_the_path_length():
    for points in (wave(3000, 0.05, 10.0, 40.0), wave(3000, 0.01, 15.0, 60.0), wave(1000, 0.3, 15.0, 60.0, 6)):
        speeds = [
            piece.geometry.speed(u, (0, 1, 2)) for piece in smooth(points) for u in (0.0, 0.5 * piece.geometry.length)
        ]
        assert 0.98 < min(speeds) <= max(speeds) < 1.02


@pytest.mark.parametrize("degree", [1, 2])
def test_parabolas_come_out_as_they_are(degree):
    """Inside, away from the ends without curvature: a control point is exact for parabolas of u."""
    points = [(0.001 * n, 1e-6 * (0.01 * n) ** degree, 0.0) for n in range(20_001)]
    pieces = smooth(points)
    places = np.linspace(8.0, 12.0, 50)
    x, y, _ = curve_at(pieces, places).T
    assert np.abs(y - 1e-6 * (10.0 * x) ** degree).max() < 1e-10


def test_deviation_of_a_circle_grows_with_the_fourth_power_of_the_span():
    """-0.029·h⁴·q'''' by docs/path.md; q'''' = r⁻³ towards the centre."""
    points, worst = arc(10.0, 0.002, 3.0, digits=12), []
    for longest in (1.0, 2.0):
        pieces = smooth(points, 0.05, longest=longest)
        places = np.linspace(12.0, 16.0, 300)
        radii = np.linalg.norm(curve_at(pieces, places), axis=1)
        worst.append(np.abs(radii - 10.0).max())
    assert worst[1] == pytest.approx(0.029 * 2.0**4 * 1e-3, rel=0.3)
    assert worst[1] / worst[0] == pytest.approx(16.0, rel=0.2)


def node_speeds(pieces, axes=AXES) -> list[float]:
    """mm/s that each piece permits at constant velocity."""
    found = []
    for piece in pieces:
        part = PathPart(piece.geometry, axes, (0, 1, 2), math.inf, piece.block)
        found.append(math.sqrt(whole_cell(part).limit))
    return found


def duration(pieces, axes=AXES) -> float:
    """s from rest to rest, by the velocity planner."""
    cells, origin = [], 0.0
    for piece in pieces:
        part = PathPart(piece.geometry, axes, (0, 1, 2), piece.feed, piece.block)
        cells += UndividedPart(part, origin, division_of(part, whole_cell(part))).take(10**9)
        origin += piece.geometry.length
    plan = plan_velocity(cells, MovingStart(0.0), 1.0)
    assert plan is not None
    return PathProfile(pieces_of(plan, MovingStart(0.0), 0.0)).duration


@pytest.mark.parametrize(
    ("chord", "radius", "wavelength", "digits"),
    [(0.05, 15.0, 60.0, 3), (0.05, 50.0, 100.0, 3), (0.02, 15.0, 60.0, 3), (0.5, 20.0, 60.0, 4)],
)
def test_contour_of_short_chords_runs_at_the_feed(chord, radius, wavelength, digits):
    """3,000 chords at 100 mm/s with 1,000 mm/s² and 20,000 mm/s³: within 10 % of one straight block as long."""
    points = wave(3000, chord, radius, wavelength, digits)
    pieces = smooth(points, 0.005)
    assert deviations(points, pieces, between=20_000)[0] <= 0.005
    length = sum(piece.geometry.length for piece in pieces)
    inner = [speed for piece, speed in zip(pieces[6:-6], node_speeds(pieces)[6:-6], strict=True)]
    assert min(inner) >= 100.0
    straight = SmoothPiece(Cubic([(0.0, 1.0, 0.0, 0.0)] + [(0.0, 0.0, 0.0, 0.0)] * 2, length), 1, FEED, True)
    assert duration(pieces) <= 1.10 * duration([straight])


def test_example_contour_is_smoothed_in_constant_memory():
    points = list(runpy.run_path(str(CONTOUR))["points"](3000))
    smoother = Smoother(points[0], (0, 1, 2), 0.005, 0.0)
    count, memory = 0, []
    tracemalloc.start()
    for block, point in enumerate(points[1:], start=1):
        smoother.add(point, block, FEED)
        count += len(smoother.take())
        if block in (1000, 2999):
            memory.append(tracemalloc.get_traced_memory()[0])
    tracemalloc.stop()
    assert count > 500
    assert memory[1] < memory[0] + 100_000


def test_example_contour_is_within_the_deviation():
    points = list(runpy.run_path(str(CONTOUR))["points"](12_000))
    pieces = smooth(points)
    assert deviations(points, pieces)[0] <= 0.005
    check_joints(pieces)


def test_example_contour_is_a_program(tmp_path, monkeypatch, capsys):
    contour = runpy.run_path(str(CONTOUR))
    lines = list(contour["program"](contour["points"](2000)))
    assert lines[:2] == ["%CONTOUR", "N10 G90 G17 G21"]
    assert lines[3] == "G01 X60Y28Z-0.5 F6000"
    assert lines[-2:] == ["#HSC OFF", "M30"]
    assert len(lines) == 2005
    monkeypatch.setattr("sys.argv", ["contour.py", str(tmp_path / "contour.nc"), "2000"])
    contour["main"]()
    assert (tmp_path / "contour.nc").read_text().splitlines() == lines


def test_a_tolerance_below_the_rounding_of_numbers_is_refused_with_its_block():
    points = [(1000.0 + x, y, z) for x, y, z in arc(1.0, 0.01, 3.0, digits=12)]
    with pytest.raises(CncError) as error:
        smooth(points, 1e-14)
    assert str(error.value).startswith("P-ERR-22115 the curve near block 1 deviates by ")
    assert str(error.value).endswith(" times the tolerance of 1e-14 mm, and cannot be made finer; the path stops")
