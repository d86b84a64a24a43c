"""Ramps to a velocity: closed forms by hand, both directions, A+ against A-, and Ruckig as second method."""

from __future__ import annotations

import random

import pytest
import ruckig

from cnc_ptp.motion import Limits, plan_to_velocity, stopping_distance

LIMITS = Limits(2000.0, 5000.0, 10000.0, 50000.0)


@pytest.mark.parametrize(
    ("v", "a", "wanted", "duration"),
    [
        (0.0, 0.0, 2000.0, 0.5),
        (2000.0, 0.0, 0.0, 0.4),
        (2000.0, 0.0, 1500.0, 0.2),
        (0.0, 0.0, 500.0, 0.2),
        (-2000.0, 0.0, 0.0, 0.4),
        (0.0, 0.0, -2000.0, 0.5),
        (250.0, 5000.0, 500.0, 0.1),
        (250.0, -5000.0, 0.0, 0.1),
        (700.0, 0.0, 700.0, 0.0),
    ],
)
def test_ramps_by_hand(v, a, wanted, duration, check_table):
    profile = plan_to_velocity(0.0, v, a, wanted, LIMITS)
    assert profile.duration == pytest.approx(duration, rel=1e-13, abs=1e-300)
    assert profile.end[1:] == (wanted, 0.0)
    check_table(profile, (0.0, v, a), profile.end, LIMITS)


def test_growth_uses_a_plus_and_reduction_a_minus():
    growing = plan_to_velocity(0.0, 100.0, 0.0, 2000.0, LIMITS)
    assert max(row[3] for row in growing.rows) == 5000.0
    slowing = plan_to_velocity(0.0, 2000.0, 0.0, 0.0, LIMITS)
    assert min(row[3] for row in slowing.rows) == -10000.0
    backwards = plan_to_velocity(0.0, -100.0, 0.0, -2000.0, LIMITS)
    assert min(row[3] for row in backwards.rows) == -5000.0


def test_acceleration_above_its_bound_is_left_with_full_jerk():
    profile = plan_to_velocity(0.0, 0.0, 9000.0, 2000.0, LIMITS)
    assert profile.rows[0][3:] == (9000.0, -50000.0)
    assert profile.rows[1][1:] == pytest.approx((9000.0 * 0.08**2 / 2 - 50000.0 * 0.08**3 / 6, 560.0, 5000.0, 0.0))
    assert profile.rows[1][3:] == (5000.0, 0.0)
    assert profile.end[1] == 2000.0


@pytest.mark.parametrize(
    ("up", "down", "v", "a", "wanted"),
    [
        (5000.0, 10000.0, -2000.0, 0.0, 2000.0),
        (10000.0, 5000.0, -2000.0, 0.0, 2000.0),
        (5000.0, 10000.0, -2000.0, 9000.0, 2000.0),
        (10000.0, 5000.0, -100.0, 9000.0, 2000.0),
        (5000.0, 10000.0, -100.0, 9000.0, 2000.0),
        (10000.0, 5000.0, -2000.0, 9000.0, 2000.0),
        (5000.0, 10000.0, -2000.0, 9000.0, 10.0),
        (10000.0, 5000.0, -2000.0, 0.0, 10.0),
        (5000.0, 10000.0, -10.0, 0.0, 10.0),
        (5000.0, 10000.0, -10.0, 0.0, 2000.0),
        (10000.0, 5000.0, 30.0, -4000.0, 2000.0),
        (5000.0, 10000.0, -2000.0, 12000.0, 2000.0),
        (5000.0, 10000.0, 2000.0, 0.0, -2000.0),
        (10000.0, 5000.0, 2000.0, 0.0, -2000.0),
    ],
)
def test_reversal_keeps_both_bounds(up, down, v, a, wanted, check_table, check_limits):
    limits = Limits(2000.0, up, down, 50000.0)
    profile = plan_to_velocity(0.0, v, a, wanted, limits)
    check_table(profile, (0.0, v, a), profile.end, limits)
    assert profile.end[1:] == (wanted, 0.0)
    if abs(a) <= min(up, down):
        check_limits(profile, limits)


def test_reversal_with_unequal_ramps_is_not_slower_than_stopping_between(draw_limits):
    draw = random.Random(30)
    for _ in range(2000):
        limits = draw_limits(draw, symmetric=False)
        v, wanted = -draw.random() * limits.velocity, draw.random() * limits.velocity
        through = plan_to_velocity(0.0, v, 0.0, wanted, limits).duration
        stop = plan_to_velocity(0.0, v, 0.0, 0.0, limits).duration
        start = plan_to_velocity(0.0, 0.0, 0.0, wanted, limits).duration
        assert through <= (stop + start) * (1 + 1e-12)


def test_random_ramps_keep_limits_and_end_exactly(check_table, check_limits, draw_limits, draw_start):
    draw = random.Random(31)
    for _ in range(3000):
        limits = draw_limits(draw, symmetric=draw.random() < 0.3)
        p, v, a = draw_start(draw, limits)
        wanted = draw.choice([0.0, draw.uniform(-1.0, 1.0) * limits.velocity])
        profile = plan_to_velocity(p, v, a, wanted, limits)
        assert profile.end[1:] == (wanted, 0.0)
        check_table(profile, (p, v, a), profile.end, limits)
        check_limits(profile, limits)


def test_stop_way_is_the_way_of_the_stop_ramp(draw_limits, draw_start):
    draw = random.Random(32)
    for _ in range(3000):
        limits = draw_limits(draw, symmetric=False)
        _, v, a = draw_start(draw, limits)
        a *= draw.choice([1.0, 1.0, 3.0])
        profile = plan_to_velocity(0.0, v, a, 0.0, limits)
        largest = max(abs(row[1]) for row in profile.rows)
        distance = stopping_distance(v, a, limits.deceleration, limits.jerk)
        assert distance == pytest.approx(profile.end[0], rel=1e-9, abs=1e-9 * largest)


def test_as_fast_as_ruckig_in_its_velocity_mode(draw_limits, draw_start):
    draw = random.Random(33)
    planner, trajectory, problem = ruckig.Ruckig(1), ruckig.Trajectory(1), ruckig.InputParameter(1)
    problem.control_interface = ruckig.ControlInterface.Velocity
    compared = 0
    for _ in range(5000):
        limits = draw_limits(draw, symmetric=True)
        p, v, a = draw_start(draw, limits)
        wanted = draw.uniform(-1.0, 1.0) * limits.velocity
        problem.current_position, problem.current_velocity, problem.current_acceleration = [p], [v], [a]
        problem.target_velocity, problem.target_acceleration = [wanted], [0.0]
        problem.max_acceleration, problem.max_jerk = [limits.acceleration], [limits.jerk]
        try:
            planner.calculate(problem, trajectory)
        except ruckig.RuckigError:
            continue
        compared += 1
        ours = plan_to_velocity(p, v, a, wanted, limits).duration
        assert ours == pytest.approx(trajectory.duration, rel=1e-9, abs=1e-12)
    assert compared > 4500
