"""Rest to rest: the examples of TX1250 2.1 by hand, then seeded and generated problems, integrated again."""

from __future__ import annotations

import math
import random
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples
from motion_checker import Motions, assert_all, assert_motions, over_acceleration, over_velocity, steps
from motion_problems import Problem, random_problems
from ruckig_peer import RuckigPeer

from cnc_ptp.motion import Limits, plan_rest_to_rest, plan_rest_to_rest_batch
from cnc_ptp.motion.rest_to_rest import reachable_velocity

PRINTED = {
    "1.1": (1000.0, Limits(2000.0, 5000.0, 5000.0, 50000.0), 1.0),
    "1.2": (1000.0, Limits(2000.0, 5000.0, 10000.0, 50000.0), 0.5 + 0.05 + 0.4),
    "1.3": (1000.0, Limits(2000.0, 15000.0, 15000.0, 50000.0), 0.4 + 0.1 + 0.4),
    "2.1": (1000.0, Limits(2000.0, 5000.0, 5000.0, 20000.0), (math.sqrt(1250.0**2 + 2e7) - 1250.0) / 5000.0 + 0.5),
    "2.2": (1000.0, Limits(2000.0, 5000.0, 5000.0, 50000.0), 1.0),
    "2.3": (1000.0, Limits(2000.0, 5000.0, 5000.0, 100000.0), 0.45 + 0.05 + 0.45),
    "3.1": (800.0, Limits(1500.0, 5000.0, 5000.0, 50000.0), 0.4 + 200.0 / 1500.0 + 0.4),
    "3.2": (800.0, Limits(1750.0, 5000.0, 5000.0, 50000.0), 0.45 + 12.5 / 1750.0 + 0.45),
    "3.3": (800.0, Limits(2000.0, 5000.0, 5000.0, 50000.0), (math.sqrt(500.0**2 + 1.6e7) - 500.0) / 5000.0 + 0.2),
}


@pytest.mark.parametrize("figure", PRINTED)
def test_printed_dynamics_have_the_duration_of_the_closed_form(figure, check_table, check_limits):
    target, limits, duration = PRINTED[figure]
    profile = plan_rest_to_rest(0.0, target, limits)
    assert profile.duration == pytest.approx(duration, rel=1e-14)
    check_table(profile, (0.0, 0.0, 0.0), (target, 0.0, 0.0), limits)
    check_limits(profile, limits)


def test_figure_1_1_phase_by_phase():
    profile = plan_rest_to_rest(0.0, 1000.0, Limits(2000.0, 5000.0, 5000.0, 50000.0))
    rows = [row for row in profile.rows if row[2] != 2000.0 or row[4]]
    expected = [
        (0.0, 0.0, 0.0, 0.0, 50000.0),
        (0.1, 50000.0 / 6000.0, 250.0, 5000.0, 0.0),
        (0.4, 50000.0 / 6000.0 + 300.0, 1750.0, 5000.0, -50000.0),
        (0.5, 500.0, 2000.0, 0.0, -50000.0),
        (0.6, 700.0 - 50000.0 / 6000.0, 1750.0, -5000.0, 0.0),
        (0.9, 1000.0 - 50000.0 / 6000.0, 250.0, -5000.0, 50000.0),
        (1.0, 1000.0, 0.0, 0.0, 0.0),
    ]
    assert np.array(rows) == pytest.approx(np.array(expected), rel=1e-13)


def test_reduced_velocity_comes_from_the_smaller_ramp_and_the_ramps_use_their_own():
    limits = Limits(2000.0, 5000.0, 10000.0, 50000.0)
    profile = plan_rest_to_rest(0.0, 500.0, limits)
    reduced = reachable_velocity(500.0, 5000.0, 50000.0)
    assert max(row[2] for row in profile.rows) == reduced
    assert max(row[3] for row in profile.rows) == 5000.0
    assert min(row[3] for row in profile.rows) == -math.sqrt(reduced * 50000.0)
    cruise = next(row for row in profile.rows if row[4] == 0.0 and row[3] == 0.0)
    assert cruise[2] == reduced


def way_of_ramps(v: float, limits: Limits) -> float:
    """The distance of both ramps, each V/2·(V/A + A/J), or V·√(V/J) where A is not reached."""
    _, up, down, jerk = limits
    return sum(0.5 * v * (v / a + a / jerk) if v * jerk >= a * a else v * math.sqrt(v / jerk) for a in (up, down))


def top(distance: float, limits: Limits) -> float:
    return max(row[2] for row in plan_rest_to_rest(0.0, distance, limits).rows)


@pytest.mark.parametrize(
    "limits",
    [
        Limits(904.0, 5000.0, 3000.0, 50_000.0),  # 848 for the smaller A on both sides
        Limits(904.0, 3000.0, 5000.0, 50_000.0),
        Limits(2000.0, 5000.0, 10_000.0, 50_000.0),
        Limits(10.0, 100.0, 5000.0, 1e6),
        Limits(1500.0, 6000.0, 6000.0, 100_000.0),
    ],
)
def test_the_reached_velocity_does_not_jump_where_the_way_becomes_too_short(limits):
    needed = way_of_ramps(limits.velocity, limits)
    both = min(limits.acceleration, limits.deceleration)
    for short in (0.0, 1e-15, 1e-12, 1e-6):
        assert top(needed * (1.0 - short), limits) == pytest.approx(limits.velocity, rel=2.0 * short + 1e-13)
    distances = np.linspace(1e-3, 1.1, 2000) * needed
    reached = np.array([top(distance, limits) for distance in distances])
    steps = np.diff(reached)
    assert (steps >= -1e-12 * limits.velocity).all()
    assert steps[distances[1:] > 0.1 * needed].max() < 0.01 * limits.velocity
    lower = np.array([reachable_velocity(distance, both, limits.jerk) for distance in distances])
    assert (reached >= np.minimum(lower, limits.velocity) * (1.0 - 1e-12)).all()
    assert reached[:600] == pytest.approx(lower[:600])
    batch = plan_rest_to_rest_batch(0.0, distances, *limits)
    assert batch.rows[2].max(axis=0) == pytest.approx(reached, rel=1e-14)


@pytest.mark.parametrize(
    ("distance", "velocity"),
    [
        (1000.0, 2000.0),
        (800.0, (math.sqrt(500.0**2 + 1.6e7) - 500.0) / 2.0),
        (10.0, 125.0 ** (1 / 3) * 10000.0 ** (1 / 3)),
    ],
)
def test_reachable_velocity_solves_the_two_ramps(distance, velocity):
    assert reachable_velocity(distance, 5000.0, 50000.0) == pytest.approx(velocity, rel=1e-14)


def test_backwards_is_the_mirror_image_to_the_bit():
    limits = Limits(1234.5, 5000.0, 7000.0, 33333.0)
    forwards, backwards = plan_rest_to_rest(0.0, 777.7, limits), plan_rest_to_rest(0.0, -777.7, limits)
    assert [row[0] for row in forwards.rows] == [row[0] for row in backwards.rows]
    assert [tuple(-x for x in row[1:]) for row in forwards.rows] == [row[1:] for row in backwards.rows]


def test_no_distance_takes_no_time():
    profile = plan_rest_to_rest(3.0, 3.0, Limits(1.0, 1.0, 1.0, 1.0))
    assert profile.duration == 0.0
    assert profile.state_at(0.5) == (3.0, 0.0, 0.0, 0.0)


def many(seed: int, count: int) -> list[Problem]:
    """Rest to rest over eight decades, near zero and at ±1e5."""
    return random_problems(seed, count, ("rest",))


def test_many_problems_over_eight_decades_one_by_one():
    problems = many(20, 5000)
    profiles = [plan_rest_to_rest(problem.position, problem.target, problem.limits) for problem in problems]
    assert_motions(problems, profiles)


def test_twenty_thousand_problems_in_one_call():
    problems = many(22, 20_000)
    columns = np.array([(problem.position, problem.target, *problem.limits) for problem in problems]).T
    batch = plan_rest_to_rest_batch(*columns)
    starts = np.array([columns[0], np.zeros(len(batch)), np.zeros(len(batch))])
    motions = Motions(batch.rows.transpose(0, 2, 1), starts, columns[2:])
    assert (motions.d >= 0.0).all()
    assert (batch.rows[1, 7] == columns[1]).all()
    for found in (*steps(motions), over_velocity(motions), over_acceleration(motions)):
        assert_all(found, "batch", problems)


def test_never_slower_than_ruckig_with_the_smaller_ramp_on_both_sides():
    """TX1250 2.1 reduces V by A = min(A+, A-): equal to the optimum where A+ = A-, never slower where not."""
    peer, compared = RuckigPeer(), 0
    for problem in many(23, 5000):
        limits = problem.limits
        both = min(limits.acceleration, limits.deceleration)
        duration = plan_rest_to_rest(problem.position, problem.target, limits).duration
        way = problem.target - problem.position
        if way == 0.0:
            continue
        peer.scale(duration, abs(way))
        theirs = peer.to_position(way, 0.0, 0.0, limits._replace(acceleration=both, deceleration=both))
        if theirs is not None:
            compared += 1
            assert duration <= theirs * (1 + 1e-9), problem
            if limits.acceleration == limits.deceleration:
                assert duration >= theirs * (1 - 1e-9), problem
    assert compared > 4000


scales = st.floats(min_value=1e-3, max_value=1e5)


@settings(max_examples=examples(200), deadline=None)
@given(scales, scales, scales, scales, st.floats(min_value=-1e5, max_value=1e5))
def test_any_problem_ends_exactly_and_is_as_long_as_its_phases(v, up, down, jerk, target):
    limits = Limits(v, up, down, jerk)
    profile = plan_rest_to_rest(0.0, target, limits)
    assert profile.end == (target, 0.0, 0.0)
    ways = 0.0
    for row, following in pairwise(profile.rows):
        d = following[0] - row[0]
        ways += row[2] * d + row[3] * d * d / 2 + row[4] * d**3 / 6
    assert ways == pytest.approx(target, rel=1e-9, abs=1e-29)


def test_batch_equals_the_single_plans(draw_limits):
    draw = random.Random(21)
    problems = [
        (draw.uniform(-1e3, 1e3), draw.uniform(-1e3, 1e3), draw_limits(draw, symmetric=draw.random() < 0.5))
        for _ in range(1000)
    ]
    problems[7] = (5.0, 5.0, problems[7][2])
    columns = np.array([(start, target, *limits) for start, target, limits in problems]).T
    batch = plan_rest_to_rest_batch(*columns)
    assert len(batch) == 1000
    assert batch.rows.shape == (5, 8, 1000)
    for index, (start, target, limits) in enumerate(problems):
        single, one = plan_rest_to_rest(start, target, limits), batch.profile(index)
        assert one.duration == pytest.approx(single.duration, rel=1e-13)
        assert one.end == single.end
        times = np.linspace(0.0, single.duration, 7)
        assert one.sample(times)[:3] == pytest.approx(single.sample(times)[:3], rel=1e-9, abs=1e-9 * limits.velocity)


def test_batch_takes_plain_numbers_for_all():
    batch = plan_rest_to_rest_batch(0.0, [1000.0, 800.0], 2000.0, 5000.0, 5000.0, 50000.0)
    assert batch.duration[0] == pytest.approx(1.0, rel=1e-14)
    assert batch.duration[1] == pytest.approx(PRINTED["3.3"][2], rel=1e-14)


def test_batch_in_which_every_velocity_is_reached():
    batch = plan_rest_to_rest_batch(0.0, [3000.0, -3000.0], 2000.0, 5000.0, 5000.0, 50000.0)
    assert batch.duration == pytest.approx([2.0, 2.0], rel=1e-14)
