"""Velocity along a path of many parts: limits of the axes, times against other methods, override and stop."""

from __future__ import annotations

import random
from itertools import pairwise

import numpy as np
import pytest
import toppra
import toppra.algorithm
import toppra.constraint
from curves import CYCLE, assert_within, parts_of, run, smooth_curve, spline
from jerk_optimum import JerkOptimum
from long_support import long

from cnc_ptp.motion import Limits, plan_rest_to_rest
from cnc_ptp.path.cubic import Cubic
from cnc_ptp.path.geometry import AxisLimits, Line
from cnc_ptp.path.lookahead.look_ahead import LookAhead
from cnc_ptp.path.lookahead.parts import PathPart, division_of, graded, whole_cell
from cnc_ptp.path.lookahead.path_cell import PathCell
from cnc_ptp.path.lookahead.path_profile import PathProfile, circular, duration_between, pieces_of
from cnc_ptp.path.lookahead.spans import whole
from cnc_ptp.path.lookahead.velocity_plan import MovingStart, plan_velocity

AXIS = AxisLimits(300.0, 1000.0, 1000.0, 20_000.0)


def straight_cells(length: float, count: int) -> list[PathCell]:
    ends = [length * index / count for index in range(count + 1)]
    return [PathCell(a, b, 1e4, 1e4, 1000.0, 1000.0, 20_000.0) for a, b in pairwise(ends)]


def planned(cells: list[PathCell]) -> PathProfile:
    start = MovingStart(0.0)
    plan = plan_velocity(cells, start, 1.0)
    assert plan is not None
    return PathProfile(pieces_of(plan, start, 0.0))


@pytest.mark.parametrize(
    ("length", "count", "excess"), [(150.0, 3000, 0.003), (150.0, 300, 0.003), (10.0, 100, 0.02), (0.5, 60, 0.025)]
)
def test_a_straight_path_takes_the_time_of_one_block(length: float, count: int, excess: float) -> None:
    best = plan_rest_to_rest(0.0, length, Limits(100.0, 1000.0, 1000.0, 20_000.0)).duration
    duration = planned(straight_cells(length, count)).duration
    assert best * (1.0 - 1e-9) <= duration <= best * (1.0 + excess)


def test_profile_in_time_is_that_of_its_plan() -> None:
    """By differences: u' is the derivative of u, u'' of u', and u''' of u''."""
    profile = planned(straight_cells(12.0, 57))
    step = 1e-6
    for t in np.linspace(0.001, profile.duration - 0.001, 400):
        (u0, v0, a0, _), (_u, v, a, j), (u1, v1, a1, _) = (profile.state_at(t + d) for d in (-step, 0.0, step))
        assert (u1 - u0) / (2.0 * step) == pytest.approx(v, abs=1e-6)
        assert (v1 - v0) / (2.0 * step) == pytest.approx(a, abs=0.02)
        assert (a1 - a0) / (2.0 * step) == pytest.approx(j, abs=25.0) or abs(j) < 20_000.0
    assert profile.state_at(profile.duration)[0] == pytest.approx(12.0, abs=1e-12)


@pytest.mark.parametrize("z", [-30.0, -2.0, -0.0101, -0.0099, -1e-5, 0.0, 1e-5, 0.0099, 0.0101, 2.0, 30.0])
def test_series_and_functions_agree(z: float) -> None:
    """Against the power series with 40 terms."""
    s = c = 0.0
    term_s, term_c = 1.0, 0.5
    for n in range(40):
        s, c = s + term_s, c + term_c
        term_s *= z / ((2 * n + 2) * (2 * n + 3))
        term_c *= z / ((2 * n + 3) * (2 * n + 4))
    assert circular(z) == pytest.approx((s, c), rel=1e-12)


@pytest.mark.parametrize("k", [-4.0, -1e-3, 0.0, 1e-3, 4.0])
def test_duration_of_a_piece(k: float) -> None:
    """∫du/v by many steps."""
    before, slope, distance = 3.0, 1.5, 0.8
    u = (np.arange(200_000) + 0.5) * distance / 200_000
    v = np.sqrt(before**2 + slope * u + k * u * u)
    after = float(np.sqrt(before**2 + slope * distance + k * distance**2))
    assert duration_between(distance, before, after, k) == pytest.approx(np.sum(distance / 200_000 / v), rel=1e-9)


def test_cells_grow_from_both_ends() -> None:
    for length, smallest, largest in ((1.0, 0.05, 0.4), (10.0, 0.01, 0.4), (0.05, 0.0025, 0.4), (0.3, 0.5, 0.4)):
        division = graded(length, smallest, largest)
        ends = [division.end(index) for index in range(division.cells)]
        cells = np.diff([0.0, *ends])
        assert ends[-1] == length and cells.min() > 0.0 and cells.max() <= max(largest, smallest) + 1e-12
        assert cells == pytest.approx(cells[::-1])


def test_three_thousand_short_blocks_take_the_time_of_a_straight_one() -> None:
    """0.05 mm each at F6000, a = 1,000 mm/s², J = 20,000 mm/s³."""
    x = np.arange(3001) * 0.05
    curve = spline(np.column_stack((x, 3.0 * np.sin(x / 12.0))))
    states, _ = run(parts_of(curve, [AXIS] * 2, 100.0))
    straight = plan_rest_to_rest(0.0, curve.x[-1], Limits(100.0, 1000.0, 1000.0, 20_000.0)).duration
    assert len(states) * CYCLE <= 1.01 * straight and len(states) * CYCLE <= 1.9
    assert_within(states, [AXIS] * 2)


@pytest.mark.parametrize("seed", [0, *long(range(1, 20))])
def test_near_the_optimum_of_topp_ra(seed: int) -> None:
    """The same limits of velocity and acceleration; the jerk is so large that it does not count."""
    curve = smooth_curve(seed)
    velocity = np.array([[-150.0, 150.0]] * 3)
    acceleration = np.array([[-1000.0, 1000.0]] * 3)
    constraints = [
        toppra.constraint.JointVelocityConstraint(velocity),
        toppra.constraint.JointAccelerationConstraint(acceleration),
    ]
    grid = np.linspace(0.0, curve.x[-1], 3001)
    path = toppra.SplineInterpolator(curve.x, curve(curve.x), bc_type="natural")
    solved = toppra.algorithm.TOPPRA(constraints, path, gridpoints=grid)
    speeds = solved.compute_parameterization(0.0, 0.0)[1]
    best = np.sum(2.0 * np.diff(grid) / (speeds[1:] + speeds[:-1]))
    axis = AxisLimits(150.0, 1000.0, 1000.0, 1e8)
    states, _ = run(parts_of(curve, [axis] * 3, 1e4))
    assert len(states) * CYCLE <= 1.05 * best
    assert_within(states, [axis] * 3)


@pytest.mark.parametrize("seed", long(range(5)))
def test_near_the_optimum_with_jerk(seed: int) -> None:
    """A solver over all of the path at once."""
    curve = smooth_curve(100 + seed)
    axis = AxisLimits(1e4, 1000.0, 1000.0, 20_000.0)
    states, rows = run(parts_of(curve, [axis] * 3, 150.0))
    assert_within(states, [axis] * 3)
    cells = 400
    optimum = JerkOptimum(curve, cells, 150.0, 1000.0, 20_000.0)
    middles = (np.arange(cells - 2) + 1.5) * optimum.cell
    squares = np.interp(middles, rows[:, 0], rows[:, 1]) ** 2
    best = min(optimum.solve(part * squares) for part in (0.9, 0.7, 0.5))
    assert len(states) * CYCLE <= 1.10 * best


@pytest.mark.long
def test_override_to_0_and_back_at_random_moments() -> None:
    """Limits hold, nothing steps, and the end is reached exactly."""
    curve = smooth_curve(7)
    whole = len(run(parts_of(curve, [AXIS] * 3, 120.0))[0])
    for seed in range(40):
        draw = random.Random(seed)
        script: list[tuple[int, float]] = []
        for cycle in sorted(draw.sample(range(2 * whole), 5)):
            script += [(cycle, 0.0), (cycle + draw.randrange(1, 600), draw.choice((0.3, 1.0, 1.2)))]
        script.append((3 * whole, 1.0))
        states, rows = run(parts_of(curve, [AXIS] * 3, 120.0), sorted(script))
        assert_within(states, [AXIS] * 3)
        assert np.all(np.diff(rows[:, 0]) >= -1e-9)


def test_the_feed_is_that_of_other_axes_where_they_move_alone() -> None:
    points = [(0.0, 0.0, 0.0, 10.0 * n) for n in range(4)]
    lines = [Line(a, b, (0, 1, 2)) for a, b in pairwise(points)]
    parts = [PathPart(whole(line, n), [AXIS] * 4, (0, 1, 2), 40.0, n) for n, line in enumerate(lines)]
    _, rows = run(parts)
    assert rows[:, 1].max() == pytest.approx(40.0)


def test_plans_that_are_shorter_than_a_cycle() -> None:
    """Three exact stops within one cycle: a part of 1e-9 mm takes about 0.13 ms."""
    lines = [Line((n * 1e-9, 0.0), ((n + 1) * 1e-9, 0.0), (0, 1)) for n in range(3)]
    parts = [PathPart(whole(line, n), [AXIS] * 2, (0, 1), 40.0, n, 0.0) for n, line in enumerate(lines)]
    ahead = LookAhead(1.0, 0.0)
    for part in parts:
        ahead.append(part)
    ahead.closed = True
    assert ahead.step(10, CYCLE) == [] and ahead.done
    best = 3.0 * plan_rest_to_rest(0.0, 1e-9, Limits(40.0, 1000.0, 1000.0, 20_000.0)).duration
    assert best <= CYCLE - ahead.remaining_time <= 2.0 * best


def test_an_axis_with_a_large_derivative_does_not_multiply_the_cells() -> None:
    """A corner of 1 mm in which A turns by 10,000 deg has as many cells as one of X and Y."""
    counts = []
    for bend in (1.0, 1e4):
        curve = Cubic([(0.0, 1.0, 0.0, 0.0), (0.0, 0.0, bend, 0.0)], 1.0)
        part = PathPart(whole(curve, 0), [AXIS, AxisLimits(*[bend * limit for limit in AXIS])], (0,), 1e9, 0)
        counts.append(division_of(part, whole_cell(part)).cells)
    assert counts[0] >= 10 and counts[1] <= 2 * counts[0]


def test_stop_comes_to_rest_on_a_ramp() -> None:
    curve = smooth_curve(3)
    for cycle in range(5, 1500, 149):
        parts = iter(parts_of(curve, [AXIS] * 3, 120.0))
        ahead = LookAhead(1.0, 0.0)
        rows: list[tuple[float, float, float, float]] = []
        stopped_at = 0
        while not ahead.stopped and not ahead.done:
            while ahead.wants:
                ahead.append(next(parts))
            if len(rows) >= cycle and not stopped_at:
                ahead.stop()
                stopped_at = len(rows)
            rows += ahead.step(1, CYCLE)
        u, v, a, _ = np.array(rows).T
        assert v[-1] == 0.0 and len(rows) - stopped_at < 500
        assert np.abs(np.diff(a)).max() <= 20_000.0 * CYCLE * 2.0  # the path's own; the axes' is checked above
        assert u[-1] < curve.x[-1]
