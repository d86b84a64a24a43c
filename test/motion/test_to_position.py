"""Position targets from any state: examples of TX1250 2.2 and 2.3, seeded problems, and Ruckig's durations.

CNC_PTP_RANDOM_PROBLEMS sets how many problems are compared (20,000; set it to some hundred thousand before a release).
"""

from __future__ import annotations

import math
import os
import random
from itertools import pairwise

import pytest
import ruckig
from hypothesis import given, settings
from hypothesis import strategies as st

from cnc_ptp.motion import Limits, plan_rest_to_rest, plan_to_position, plan_to_velocity, stop_way, to_position

LIMITS = Limits(2000.0, 5000.0, 5000.0, 50000.0)
COUNT = int(os.environ.get("CNC_PTP_RANDOM_PROBLEMS", "20000"))


def case(p, v, a, target, limits):
    """A failing problem as a line that can be pasted."""
    return f"plan_to_position({p!r}, {v!r}, {a!r}, {target!r}, {limits!r})"


def test_from_rest_it_is_the_closed_form():
    for target in (1000.0, -800.0, 3000.0, 100.0, 1e-3):
        closed, general = plan_rest_to_rest(5.0, target, LIMITS), plan_to_position(5.0, 0.0, 0.0, target, LIMITS)
        assert general.duration == pytest.approx(closed.duration, rel=1e-13)
        assert general.end == closed.end == (target, 0.0, 0.0)


def test_from_full_velocity_it_cruises_and_stops():
    profile = plan_to_position(0.0, 2000.0, 0.0, 1500.0, LIMITS)
    assert profile.duration == pytest.approx(0.5 + 0.5, rel=1e-14)
    assert profile.rows[0] == (0.0, 0.0, 2000.0, 0.0, 0.0)


def test_at_the_braking_point_it_is_the_stop_ramp():
    profile = plan_to_position(0.0, 2000.0, 0.0, 500.0, LIMITS)
    assert profile.duration == pytest.approx(0.5, rel=1e-14)
    assert len(profile.rows) == 4


def test_new_target_behind_stops_and_returns_by_itself(check_table):
    """TX1250 2.3: V 2000 mm/s, new target behind the axis; the standstill of the stop lies in the table."""
    profile = plan_to_position(2100.0, 2000.0, 0.0, 2000.0, LIMITS)
    check_table(profile, (2100.0, 2000.0, 0.0), (2000.0, 0.0, 0.0), LIMITS)
    back = plan_rest_to_rest(2600.0, 2000.0, LIMITS)
    assert profile.duration == pytest.approx(0.5 + back.duration, rel=1e-13)
    assert profile.state_at(0.5)[:3] == pytest.approx((2600.0, 0.0, 0.0), rel=1e-12, abs=1e-9)


def test_direct_reversal_does_not_stand_still_and_is_faster(check_table):
    profile = plan_to_position(2100.0, 2000.0, 0.0, 2000.0, LIMITS, direct=True)
    check_table(profile, (2100.0, 2000.0, 0.0), (2000.0, 0.0, 0.0), LIMITS)
    assert profile.duration < plan_to_position(2100.0, 2000.0, 0.0, 2000.0, LIMITS).duration
    assert profile.state_at(0.45)[2] == -5000.0


def test_override_down_and_up_again(check_table):
    """TX1250 2.2: override 100 % -> 75 % -> 100 % on the way from 0 to 5000 mm."""
    profile = plan_rest_to_rest(0.0, 5000.0, LIMITS)
    for moment, velocity in ((0.7, 1500.0), (0.75, 2000.0)):
        p, v, a, _ = profile.state_at(moment)
        profile = plan_to_position(p, v, a, 5000.0, LIMITS._replace(velocity=velocity))
        check_table(profile, (p, v, a), (5000.0, 0.0, 0.0), LIMITS)
    assert max(row[2] for row in profile.rows) == pytest.approx(2000.0, rel=1e-14)


def test_a_velocity_above_the_limit_is_left_with_the_full_ramp(check_table):
    limits = LIMITS._replace(velocity=500.0)
    profile = plan_to_position(0.0, 2000.0, 0.0, 5000.0, limits)
    check_table(profile, (0.0, 2000.0, 0.0), (5000.0, 0.0, 0.0), limits)
    assert profile.rows[3][2] == pytest.approx(500.0, rel=1e-12)
    assert profile.rows[3][0] == plan_to_velocity(0.0, 2000.0, 0.0, 500.0, limits).duration


def test_a_rise_of_acceleration_from_motion_is_left_in_time(check_table, check_limits):
    """All branches of the rising piece: free and bounded stop, from a < 0, from standstill, beyond -A-."""
    problems = [
        (0.0, 100.0, 10.0, 30.0, LIMITS),
        (0.0, 100.0, 10.0, 60.0, LIMITS._replace(deceleration=900.0)),
        (0.0, 100.0, 10.0, 8.0, LIMITS._replace(deceleration=3000.0)),
        (0.0, 1000.0, -2000.0, 100.0, LIMITS),
        (0.0, 100.0, 0.0, 4.0, LIMITS._replace(velocity=50.0)),
        (0.0, 900.0, -5000.0, 200.0, LIMITS._replace(velocity=500.0)),
        (0.0, 1900.0, -4900.0, 700.0, LIMITS._replace(deceleration=4900.0, velocity=1500.0)),
        (0.0, 0.0, 0.0, 2.0, LIMITS),
    ]
    for p, v, a, target, limits in problems:
        profile = plan_to_position(p, v, a, target, limits)
        check_table(profile, (p, v, a), (target, 0.0, 0.0), limits)
        if v <= limits.velocity:
            check_limits(profile, limits)


@pytest.mark.parametrize("direct", [False, True])
def test_random_problems_keep_limits_and_end_exactly(direct, check_table, check_limits, draw_limits, draw_start):
    draw = random.Random(40)
    for _ in range(4000):
        limits = draw_limits(draw, symmetric=draw.random() < 0.3)
        p, v, a = draw_start(draw, limits)
        target = p + draw.uniform(-1.0, 1.0) * 10 ** draw.uniform(-3, 5)
        profile = plan_to_position(p, v, a, target, limits, direct=direct)
        check_table(profile, (p, v, a), (target, 0.0, 0.0), limits)
        check_limits(profile, limits)


def test_random_states_above_the_limits_are_left_and_end_exactly(check_table, draw_limits, draw_start):
    draw = random.Random(41)
    for _ in range(4000):
        limits = draw_limits(draw, symmetric=draw.random() < 0.3)
        p, v, a = draw_start(draw, limits)
        v, a = v * draw.choice([1.0, 3.0]), a * draw.choice([1.0, 4.0])
        target = p + draw.uniform(-1.0, 1.0) * 10 ** draw.uniform(-3, 5)
        profile = plan_to_position(p, v, a, target, limits)
        check_table(profile, (p, v, a), (target, 0.0, 0.0), limits)
        reached = max(limits.velocity, abs(v), abs(v + a * abs(a) / (2.0 * limits.jerk)))
        assert max(abs(row[2]) for row in profile.rows) <= reached * (1 + 1e-9)
        assert max(abs(row[3]) for row in profile.rows) <= max(abs(a), *limits[1:3]) * (1 + 1e-9)


scales = st.floats(min_value=1e-3, max_value=1e5)
values = st.floats(min_value=-1e5, max_value=1e5)


@settings(max_examples=300, deadline=None)
@given(values, values, values, values, scales, scales, scales, scales, st.booleans())
def test_any_problem_has_a_table_that_ends_exactly(p, v, a, target, velocity, up, down, jerk, direct):
    profile = plan_to_position(p, v, a, target, Limits(velocity, up, down, jerk), direct=direct)
    assert profile.end == (target, 0.0, 0.0)
    assert profile.rows[0][0] == 0.0
    assert all(math.isfinite(value) for row in profile.rows for value in row)
    assert all(row[0] <= following[0] for row, following in pairwise(profile.rows))


def test_planning_again_from_any_sample_lands_at_the_same_end_at_the_same_time(draw_start):
    draw = random.Random(42)
    for _ in range(1000):
        acceleration = 10 ** draw.uniform(2, 4)
        limits = Limits(10 ** draw.uniform(1, 3), acceleration, acceleration, 10 ** draw.uniform(3, 6))
        p, v, a = draw_start(draw, limits)
        target = draw.uniform(-1e3, 1e3)
        profile = plan_to_position(p, v, a, target, limits, direct=True)
        for _ in range(5):
            t = draw.uniform(0.0, 1.0) * profile.duration
            again = plan_to_position(*profile.state_at(t)[:3], target, limits, direct=True)
            assert again.end == profile.end
            assert t + again.duration == pytest.approx(profile.duration, rel=1e-7)


def test_planning_again_while_braking_does_not_reverse_far_from_zero():
    """Rounding of the place must not be taken for an overshoot: no return motion, the same time of arrival."""
    draw = random.Random(45)
    for _ in range(1000):
        begin, way = draw.choice([0.0, 1e3, -1e5]), draw.choice([-1, 1]) * 10 ** draw.uniform(-2, 4)
        limits = Limits(*(10 ** draw.uniform(low, high) for low, high in ((0, 4), (1, 4.7), (1, 4.7), (3, 6))))
        profile = plan_to_position(begin, 0.0, 0.0, begin + way, limits)
        for _ in range(5):
            t = draw.uniform(profile.rows[-2][0], profile.duration)
            again = plan_to_position(*profile.state_at(t)[:3], begin + way, limits)
            assert t + again.duration == pytest.approx(profile.duration, rel=1e-7)
            assert min(math.copysign(1.0, way) * row[2] for row in again.rows) >= -1e-9 * limits.velocity


def test_solvers_stay_in_their_brackets_at_a_vanishing_slope():
    """The slope is 0 where √q = 0 in the free equation and a = -A- in the bounded one; a target behind ends it."""
    assert to_position._solve_free(2.0, 2.0, -4.0, -8.0) == 2.0
    assert to_position._solve_bounded(-3.0, -3.0, 9.0, 0.0, 3.0) == -3.0
    assert to_position._leave_at_constant_acceleration(10.0, 5.0, 4.0, -90.0, 8.0, 100.0) == 508.0


def peer():
    """Ruckig's duration of a problem; None where it raises. Posed from 0: far from 0 its own rounding shows."""
    planner, trajectory, problem = ruckig.Ruckig(1), ruckig.Trajectory(1), ruckig.InputParameter(1)
    problem.target_velocity, problem.target_acceleration = [0.0], [0.0]

    def duration(p, v, a, target, limits, forwards=True):
        up, down = (limits[1], limits[2]) if forwards else (limits[2], limits[1])
        problem.current_position, problem.current_velocity, problem.current_acceleration = [p], [v], [a]
        problem.target_position, problem.max_velocity, problem.max_jerk = [target], [limits.velocity], [limits.jerk]
        problem.max_acceleration, problem.min_acceleration = [up], [-down]
        try:
            planner.calculate(problem, trajectory)
        except ruckig.RuckigError:
            return None
        return trajectory.duration

    return duration


def test_never_slower_than_ruckig_with_equal_ramps(draw_limits, draw_start):
    """Equal ramps, start within the limits, with and without reversal: the semantics coincide, so do the durations."""
    draw, ruckig_duration, compared = random.Random(43), peer(), 0
    while compared < COUNT:
        limits = draw_limits(draw, symmetric=True)
        p, v, a = draw_start(draw, limits)
        target = p + draw.uniform(-1.0, 1.0) * 10 ** draw.uniform(-3, 5)
        theirs = ruckig_duration(0.0, v, a, target - p, limits)
        if theirs is None:
            continue
        compared += 1
        ours = plan_to_position(p, v, a, target, limits, direct=True).duration
        assert ours <= theirs * (1 + 1e-9), case(p, v, a, target, limits)


def test_never_slower_than_ruckig_with_unequal_ramps_and_no_reversal(draw_limits, draw_start):
    """A+ against A- of one direction is Ruckig's max against min acceleration as long as the axis moves that way."""
    draw, ruckig_duration, compared = random.Random(44), peer(), 0
    while compared < COUNT:
        limits = draw_limits(draw, symmetric=False)
        p, v, a = draw_start(draw, limits)
        target = p + draw.uniform(-1.0, 1.0) * 10 ** draw.uniform(-3, 5)
        s = math.copysign(1.0, target - p - stop_way(v, a, limits.deceleration, limits.jerk))
        if s * v < 0.0 or (s * a < 0.0 and s * v < a * a / (2.0 * limits.jerk)):
            continue
        theirs = ruckig_duration(0.0, v, a, target - p, limits, forwards=s > 0.0)
        if theirs is None:
            continue
        compared += 1
        ours = plan_to_position(p, v, a, target, limits).duration
        assert ours <= theirs * (1 + 1e-9), case(p, v, a, target, limits)
