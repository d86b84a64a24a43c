"""Through a position at a velocity, and targets that need a stronger ramp: re-integrated, and durations by Ruckig."""

from __future__ import annotations

import math
import random

import pytest
from ruckig_peer import RuckigPeer

from cnc_ptp.errors import CncError
from cnc_ptp.motion import (
    Limits,
    plan_rest_to_rest,
    plan_through_position,
    plan_to_position,
    plan_to_velocity,
    plan_with_ramp,
    stopping_distance,
)

LIMITS = Limits(2000.0, 5000.0, 5000.0, 50000.0)
WEAK = Limits(800.0, 1000.0, 500.0, 4000.0)


def ramp_way(v: float, to: float, a: float, j: float) -> float:
    """Distance of a ramp between two velocities without acceleration."""
    change = abs(to - v)
    t = change / a + a / j if change * j >= a * a else 2.0 * math.sqrt(change / j)
    return 0.5 * (v + to) * t


@pytest.mark.parametrize("end", [500.0, 1200.0, 2000.0, 2600.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_from_rest_it_is_a_ramp_a_cruise_and_a_ramp(check_table, end: float, side: float) -> None:
    """Closed form: the ways of both ramps, the rest at V."""
    target = 3000.0
    profile = plan_through_position(7.0, 0.0, 0.0, 7.0 + side * target, side * end, LIMITS)
    check_table(profile, (7.0, 0.0, 0.0), (7.0 + side * target, side * end, 0.0), LIMITS)
    ways = ramp_way(0.0, 2000.0, 5000.0, 50000.0), ramp_way(2000.0, end, 5000.0, 50000.0)
    times = 2000.0 / 5000.0 + 0.1, 2.0 * ways[1] / (2000.0 + end)
    assert profile.duration == pytest.approx(sum(times) + (target - sum(ways)) / 2000.0, rel=1e-12)


def test_a_velocity_above_that_of_the_limits_is_reached_in_the_target_only() -> None:
    profile = plan_through_position(0.0, 0.0, 0.0, 3000.0, 2600.0, LIMITS)
    last_ramp = 600.0 / 5000.0 + 5000.0 / 50000.0
    assert profile.state_at(profile.duration - last_ramp)[1] == pytest.approx(2000.0)
    assert (
        max(profile.sample([0.001 * k for k in range(int(1000 * (profile.duration - last_ramp)))])[1]) < 2000.0 + 1e-9
    )
    assert profile.end == (3000.0, 2600.0, 0.0)


@pytest.mark.parametrize(
    ("start", "target", "velocity"), [((0.0, 2000.0, 0.0), 100.0, 300.0), ((0.0, 0.0, 0.0), 50.0, 1900.0)]
)
def test_what_cannot_be_reached_ends_behind_the_target(check_table, start, target: float, velocity: float) -> None:
    """Too fast or too slow: the plain ramp to the velocity, immediately."""
    profile = plan_through_position(*start, target, velocity, LIMITS)
    ramp = plan_to_velocity(*start, velocity, LIMITS)
    assert profile.end[0] > target and profile.end[1:] == (velocity, 0.0)
    assert profile.duration == ramp.duration and profile.end[0] == pytest.approx(ramp.end[0], rel=1e-13)
    check_table(profile, start, profile.end, LIMITS)


def test_many_are_smooth_within_their_limits_and_as_fast_as_ruckig(check_table, check_limits, draw_start) -> None:
    draw, peer, compared = random.Random(17), RuckigPeer(), 0
    for _ in range(1500):
        acceleration = draw.uniform(500.0, 8000.0)
        limits = Limits(draw.uniform(100.0, 2000.0), acceleration, acceleration, draw.uniform(5e3, 2e5))
        p, v, a = draw_start(draw, limits)
        side = math.copysign(1.0, v + a * abs(a) / (2.0 * limits.jerk) or 1.0)
        end, target = side * draw.uniform(1.0, limits.velocity), p + side * draw.uniform(1.0, 4000.0)
        if side * v < 0.0:
            continue
        profile = plan_through_position(p, v, a, target, end, limits)
        check_table(profile, (p, v, a), profile.end, limits)
        check_limits(profile, limits)
        if profile.end[0] != target:
            assert side * (profile.end[0] - target) > 0.0
            continue
        assert profile.end == (target, end, 0.0)
        peer.scale(profile.duration, abs(target - p))
        duration = peer.through(side * (target - p), side * v, side * a, side * end, limits)
        on_the_edge = abs(v + a * abs(a) / (2.0 * limits.jerk)) > limits.velocity * (1.0 - 1e-12)
        if duration is not None and not (a and on_the_edge):  # Ruckig rounds an acceleration that leads exactly to V
            compared += 1
            assert profile.duration == pytest.approx(duration, rel=1e-7, abs=1e-9)
    assert compared > 700


@pytest.mark.parametrize("bad", [{"target": math.nan}, {"velocity": math.inf}, {"p": 2e12}])
def test_what_is_no_number_is_refused(bad: dict[str, float]) -> None:
    values = {"p": 0.0, "v": 0.0, "a": 0.0, "target": 1.0, "velocity": 1.0} | bad
    with pytest.raises(CncError) as error:
        plan_through_position(**values, limits=LIMITS)
    assert error.value.number == 23002


# ---------------------------------------------------------------- a stronger ramp


def test_limits_that_suffice_are_kept() -> None:
    profile, first = plan_with_ramp(0.0, 800.0, 0.0, 5000.0, WEAK, LIMITS)
    assert profile == plan_to_position(0.0, 800.0, 0.0, 5000.0, WEAK) and first == WEAK


def test_the_stronger_ramp_brakes_where_the_own_one_would_lead_past(check_table) -> None:
    """From 800 mm/s A- 500 needs 690 mm; 200 mm are enough for A- 5000."""
    assert stopping_distance(800.0, 0.0, WEAK.deceleration, WEAK.jerk) == pytest.approx(690.0)
    profile, first = plan_with_ramp(0.0, 800.0, 0.0, 200.0, WEAK, LIMITS)
    assert first == Limits(800.0, 1000.0, 5000.0, 50000.0)
    check_table(profile, (0.0, 800.0, 0.0), (200.0, 0.0, 0.0), first)
    assert max(row[1] for row in profile.rows) == 200.0


def test_a_target_behind_is_stopped_for_strongly_and_returned_to_weakly() -> None:
    profile, first = plan_with_ramp(0.0, 800.0, 0.0, -100.0, WEAK, LIMITS)
    stop = plan_to_velocity(0.0, 800.0, 0.0, 0.0, first)
    back = plan_rest_to_rest(stop.end[0], -100.0, WEAK)
    assert profile.duration == pytest.approx(stop.duration + back.duration, rel=1e-13)
    assert profile.end == (-100.0, 0.0, 0.0)
    assert {abs(row[4]) for row in profile.rows} == {0.0, 50000.0, 4000.0}
