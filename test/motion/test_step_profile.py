"""Motions with steps of the acceleration: closed-form times, re-integration, seeded problems."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from cnc_ptp.errors import CncError
from cnc_ptp.motion import (
    Limits,
    Profile,
    plan_rest_to_rest,
    step_stopping_distance,
    step_to_position,
    step_to_velocity,
)

LIMITS = Limits(100.0, 2000.0, 3000.0, 1.0)
"""The jerk does not count."""


def test_a_long_way_takes_the_time_of_a_trapezium() -> None:
    """T = D/V + V/2·(1/A+ + 1/A-)."""
    profile = step_to_position(5.0, 0.0, 45.0, LIMITS)
    assert profile.duration == pytest.approx(0.4 + 50.0 * (1.0 / 2000.0 + 1.0 / 3000.0), rel=1e-14)
    assert profile.end == (45.0, 0.0, 0.0)
    assert [row[3:] for row in profile.rows] == [(2000.0, 0.0), (0.0, 0.0), (-3000.0, 0.0), (0.0, 0.0)]


def test_a_short_way_takes_the_time_of_a_triangle() -> None:
    """T = √(2D·(1/A+ + 1/A-)), the peak is below V."""
    profile = step_to_position(0.0, 0.0, 0.5, LIMITS)
    assert profile.duration == pytest.approx(math.sqrt(2.0 * 0.5 * (1.0 / 2000.0 + 1.0 / 3000.0)), rel=1e-14)
    assert max(row[2] for row in profile.rows) == pytest.approx(math.sqrt(2.0 * 0.5 / (1.0 / 2000.0 + 1.0 / 3000.0)))


def test_a_velocity_above_the_limit_is_left_with_the_deceleration() -> None:
    """150 to 100 mm/s with 3000 mm/s²: 1/60 s, then cruise and brake."""
    profile = step_to_position(0.0, 150.0, 20.0, LIMITS)
    assert profile.rows[1][0] == pytest.approx(1.0 / 60.0) and profile.rows[1][2] == pytest.approx(100.0)
    cruise = (20.0 - 125.0 / 60.0 - step_stopping_distance(100.0, 3000.0)) / 100.0
    assert profile.duration == pytest.approx(1.0 / 60.0 + cruise + 1.0 / 30.0)


@pytest.mark.parametrize(("v", "wanted", "seconds"), [(80.0, 0.0, 80.0 / 3000.0), (0.0, 60.0, 0.03), (50.0, 50.0, 0.0)])
def test_ramps(v: float, wanted: float, seconds: float) -> None:
    profile = step_to_velocity(1.0, v, wanted, LIMITS)
    assert profile.duration == pytest.approx(seconds)
    assert profile.end == (pytest.approx(1.0 + 0.5 * (v + wanted) * seconds), wanted, 0.0)


def assert_sound(profile: Profile, v: float, target: float, limits: Limits) -> None:
    """Integrated anew from its accelerations it ends at rest at the target, and keeps its limits."""
    times = np.unique(np.concatenate([np.linspace(0.0, profile.duration, 2001), profile.starts]))
    middle = 0.5 * (times[1:] + times[:-1])
    a = profile.sample(middle)[2]
    velocity = v + np.concatenate([[0.0], np.cumsum(a * np.diff(times))])
    distance = cumulative_trapezoid(velocity, times, initial=0.0)
    scale = abs(target) + v + 1.0
    assert abs(velocity[-1]) < 1e-9 * (v + limits.velocity)
    assert distance[-1] == pytest.approx(target, abs=1e-9 * scale)
    assert np.all((a == 0.0) | (a == limits.acceleration) | (a == -limits.deceleration))
    assert np.all(profile.sample(times)[3] == 0.0)
    assert velocity.min() > -1e-9 * limits.velocity
    assert velocity.max() <= max(v, limits.velocity) * (1.0 + 1e-12)


def test_random_problems_are_sound_and_no_slower_than_with_any_jerk() -> None:
    draw = random.Random(11)
    for _ in range(300):
        limits = Limits(*(10.0 ** draw.uniform(0.0, 4.0) for _ in range(3)), 10.0 ** draw.uniform(3.0, 9.0))
        v = draw.choice([0.0, draw.uniform(0.0, 2.0) * limits.velocity])
        distance = step_stopping_distance(v, limits.deceleration) * draw.choice([1.0, 1.5]) + 10.0 ** draw.uniform(
            -3.0, 3.0
        )
        profile = step_to_position(0.0, v, distance, limits)
        assert_sound(profile, v, distance, limits)
        if v == 0.0:
            assert profile.duration <= plan_rest_to_rest(0.0, distance, limits).duration * (1.0 + 1e-12)


def test_no_way_is_no_motion() -> None:
    assert step_to_position(3.0, 0.0, 3.0, LIMITS).duration == 0.0


def test_bad_values_are_refused() -> None:
    with pytest.raises(CncError, match="P-ERR-23001 motion limit acceleration = 0"):
        step_to_position(0.0, 0.0, 1.0, LIMITS._replace(acceleration=0.0))
    with pytest.raises(CncError, match="P-ERR-23002 motion value velocity = nan"):
        step_to_velocity(0.0, 0.0, math.nan, LIMITS)
