"""Position targets from any state: examples of TX1250 2.2 and 2.3, and what once went wrong (many: test_many_problems)."""

from __future__ import annotations

import math
import random
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples
from motion_checker import assert_motions
from motion_problems import Problem

from cnc_ptp.motion import Limits, plan_rest_to_rest, plan_to_position, plan_to_velocity, stopping_distance, to_position

LIMITS = Limits(2000.0, 5000.0, 5000.0, 50000.0)


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
    """TX1250 2.2: override 100 % -> 75 % -> 100 % from 0 to 5000 mm."""
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


scales = st.floats(min_value=1e-3, max_value=1e5)
values = st.floats(min_value=-1e5, max_value=1e5)


@settings(max_examples=examples(300), deadline=None)
@given(values, values, values, values, scales, scales, scales, scales, st.booleans())
def test_any_problem_has_a_table_that_ends_exactly(p, v, a, target, velocity, up, down, jerk, direct):
    profile = plan_to_position(p, v, a, target, Limits(velocity, up, down, jerk), direct=direct)
    assert profile.end == (target, 0.0, 0.0)
    assert profile.rows[0][0] == 0.0
    assert all(math.isfinite(value) for row in profile.rows for value in row)
    assert all(row[0] <= following[0] for row, following in pairwise(profile.rows))


def test_planning_again_while_braking_does_not_reverse_far_from_zero():
    """Rounding of the place must not be taken for an overshoot: no return motion, the same time of arrival."""
    draw = random.Random(45)
    for _ in range(1000):
        begin, distance = draw.choice([0.0, 1e3, -1e5]), draw.choice([-1, 1]) * 10 ** draw.uniform(-2, 4)
        limits = Limits(*(10 ** draw.uniform(low, high) for low, high in ((0, 4), (1, 4.7), (1, 4.7), (3, 6))))
        profile = plan_to_position(begin, 0.0, 0.0, begin + distance, limits)
        for _ in range(5):
            t = draw.uniform(profile.rows[-2][0], profile.duration)
            again = plan_to_position(*profile.state_at(t)[:3], begin + distance, limits)
            assert t + again.duration == pytest.approx(profile.duration, rel=1e-7)
            assert min(math.copysign(1.0, distance) * row[2] for row in again.rows) >= -1e-9 * limits.velocity


def test_solvers_stay_in_their_brackets_where_the_target_is_behind():
    """The slope is 0 where √q = 0 in the free equation and a = -A- in the bounded one."""
    assert to_position._solve_free(2.0, 2.0, -4.0, -8.0) == 2.0
    assert to_position._solve_bounded(-3.0, -3.0, 9.0, 0.0, 3.0) == -3.0
    assert to_position._time_at_constant_acceleration(10.0, 5.0, 4.0, -90.0, 8.0, 100.0) == 0.0


PAST = {
    "leaving point not reached in 60 Newton steps, step of position 7e-5 of the way": Problem(
        0.0,
        0.0,
        -0.004644632025428232,
        0.0,
        Limits(35224.241414081844, 66709.65470592925, 66709.65470592925, 63839.36898215635),
        True,
    ),
    "the same after rounding: a way back of a picometre": Problem(
        0.0,
        -2.731150932245394e-12,
        1.521607089217735e-12,
        0.0,
        Limits(12737.11940664139, 523.3738047744405, 523.3738047744405, 9.795116938093683),
        True,
    ),
    "cruise 1e-7 above V after a start 1e8 above it": Problem(
        0.0,
        0.11418593258170709,
        3238.5067031502203,
        71.50610957613628,
        Limits(0.003043109583820121, 10954.210331265249, 10954.210331265249, 8.943880753561379),
        True,
    ),
    "cruise of 1e15 s beside a start acceleration 1e5 above the bound": Problem(
        416.1349222757789,
        0.0,
        378.30507672719625,
        228.01824629729197,
        Limits(0.03360424366498038, 0.009020640709298302, 2063.10452295828, 0.0010770412879645998),
        True,
    ),
    "constant A+ of 1e-7 of A-, step of position 2e-9 of the way": Problem(
        0.0,
        8708.941920036104,
        0.00038148980314496237,
        5755.85858892489,
        Limits(9193.83302306046, 0.0029887758676971233, 67243.01263199675, 68291.99714302424),
        False,
    ),
    "way back of 1e-3 mm at 1e5 mm counted in absolute places": Problem(
        100000.0,
        0.0,
        -0.015719136781629627,
        100000.00225707072,
        Limits(1000.0, 38.88882160285633, 38.88882160285633, 7.800176105915662),
        False,
    ),
}


@pytest.mark.parametrize("name", PAST)
def test_what_once_went_wrong(name):
    assert_motions([PAST[name]], [PAST[name].plan()])


def test_a_stop_and_return_far_from_zero_takes_as_long_as_at_zero():
    problem = PAST["way back of 1e-3 mm at 1e5 mm counted in absolute places"]
    near = problem._replace(position=0.0, target=problem.target - problem.position)
    assert problem.plan().duration == pytest.approx(near.plan().duration, rel=1e-14)


def test_a_brake_that_is_planned_again_steps_by_a_few_units_in_the_last_place():
    """A gap of 4e-15 of the place was once taken for rounding: 0.8 nm at 100 m. Now it is a motion of its own."""
    limits = Limits(100.0, 1000.0, 1000.0, 10000.0)
    for gap in (3e-10, -3e-10):
        problem = Problem(1e5, 50.0, 0.0, 1e5 + stopping_distance(50.0, 0.0, 1000.0, 10000.0) + gap, limits, True)
        assert_motions([problem], [problem.plan()])
