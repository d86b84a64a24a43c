"""Sine-squared ramps of the acceleration (#SLOPE [TYPE=SIN2]): re-integration, limits, changes on the way."""

from __future__ import annotations

import random
from math import pi

import numpy as np
import pytest
from long_support import long
from machine_support import CYCLE_TIME, MILL, MachineBench
from scipy.integrate import cumulative_simpson

from cnc_ptp.motion import (
    Limits,
    plan_rest_to_rest,
    sine_from_rest,
    sine_stopping_distance,
    sine_to_position,
    sine_to_rest,
)
from cnc_ptp.motion.profile import Profile
from cnc_ptp.path.geometry import Line
from cnc_ptp.path.interpolator import PathInterpolator
from cnc_ptp.path.planner import SINE

LIMITS = Limits(100.0, 2000.0, 1500.0, 40_000.0)


def assert_consistent(profile: Profile, limits: Limits) -> None:
    """Each state is the integral of the next one; limits hold; the jerk is continuous."""
    t = np.linspace(0.0, profile.duration, 200_001)
    p, v, a, j = profile.sample(t)
    for below, above, size in ((p, v, 1e-7), (v, a, 1e-5), (a, j, 0.05)):
        error = below - below[0] - cumulative_simpson(above, x=t, initial=0.0)
        assert np.abs(error).max() < size
    assert a.max() <= limits.acceleration * (1 + 1e-9) and a.min() >= -limits.deceleration * (1 + 1e-9)
    assert np.abs(j).max() <= limits.jerk * (1 + 1e-9) and v.max() <= limits.velocity * (1 + 1e-9)
    starts = np.array(profile.starts)
    assert not profile.sample(starts)[3].any()  # each ramp begins without jerk, and ends without:
    ends = profile.sample(starts[1:] - 1e-6 * np.diff(starts))[3]
    assert np.abs(ends).max() <= 1e-5 * limits.jerk


@pytest.mark.parametrize("distance", [0.01, 5.0, *long([1e-6, 1.0, 30.0, 400.0])])
def test_rest_to_rest(distance: float) -> None:
    profile = sine_from_rest(3.0, 3.0 + distance, LIMITS)
    assert profile.end == (3.0 + distance, 0.0, 0.0)
    assert_consistent(profile, LIMITS)


def test_a_long_line_takes_as_long_as_its_closed_form() -> None:
    """s/v + v/2·(1/a+ + 1/a-) + half of the two ramp times π/2·a/J."""
    v, up, down, jerk = limits = LIMITS._replace(jerk=200_000.0)
    ramps = 0.5 * pi / jerk * (up + down)
    expected = 400.0 / v + 0.5 * v * (1.0 / up + 1.0 / down) + 0.5 * ramps
    assert sine_from_rest(0.0, 400.0, limits).duration == pytest.approx(expected, rel=1e-12)


@pytest.mark.long
def test_random_starts() -> None:
    chance = random.Random(7)
    for _ in range(40):
        v = chance.uniform(0.0, 100.0)
        a = chance.choice((0.0, chance.uniform(-0.2, 0.2) * 2000.0)) if v > 60.0 else 0.0
        if v + a * abs(a) / 40_000.0 > 100.0:
            continue
        to_rest = sine_to_rest(1.0, v, a, LIMITS)
        assert to_rest.end[0] - 1.0 == pytest.approx(sine_stopping_distance(v, a, LIMITS), abs=1e-10)
        assert to_rest.end[1:] == (0.0, 0.0)
        target = to_rest.end[0] + chance.choice((0.001, 1.0, 50.0))
        to_position = sine_to_position(1.0, v, a, target, LIMITS)
        assert to_position.end == (target, 0.0, 0.0)
        for profile in (to_rest, to_position):
            assert_consistent(profile, LIMITS)


@pytest.mark.long
def test_overrides_and_holds_at_random_moments() -> None:
    """The path interpolator changes its profile only where a ramp ends; every cycle continues the one before."""
    chance = random.Random(11)
    for _ in range(100):
        path = PathInterpolator()
        line = Line((0.0,), (60.0,), frozenset((0,)))
        path.start(line, LIMITS, 80.0, planner=SINE)
        rows = [(0.0, 0.0, 0.0, 0.0, False)]
        while not path.done:
            rows += path.step(chance.randint(1, 60), CYCLE_TIME)
            path.set_override(chance.choice((0.0, 0.3, 0.7, 1.0, 1.2)) if len(rows) < 3000 else 1.0)
        s, v, a, j = np.array([row[:4] for row in rows]).T
        assert path.distance_to_go == 0.0 and len(rows) < 60_000
        assert v.min() >= -1e-9 and v.max() <= 100.0 * (1 + 1e-9)
        assert np.abs(j).max() <= LIMITS.jerk * (1 + 1e-9)
        assert a.max() <= LIMITS.acceleration * (1 + 1e-9) and a.min() >= -LIMITS.deceleration * (1 + 1e-9)
        assert np.abs(np.diff(a)).max() <= LIMITS.jerk * CYCLE_TIME * (1 + 1e-9)
        assert np.diff(v) == pytest.approx(0.5 * CYCLE_TIME * (a[1:] + a[:-1]), abs=1e-2)
        assert np.diff(s) == pytest.approx(0.5 * CYCLE_TIME * (v[1:] + v[:-1]), abs=1e-5)


def test_a_lower_override_in_mid_acceleration_still_ends_at_the_target() -> None:
    """There the path slows down and brakes in one go, with ramps of different sizes."""
    chance = random.Random(3)
    for _ in range(300):
        path = PathInterpolator()
        target = chance.uniform(2.0, 20.0)
        path.start(Line((0.0,), (target,), frozenset((0,))), LIMITS, 100.0, planner=SINE)
        rows = path.step(chance.randint(10, 90), CYCLE_TIME)
        path.set_override(chance.uniform(0.02, 0.5))
        while not path.done:
            rows += path.step(100, CYCLE_TIME)
        s, v, _, _ = np.array([row[:4] for row in rows]).T
        assert s.max() <= target + 1e-9 and v.min() >= -1e-9
        assert np.diff(s) == pytest.approx(0.5 * CYCLE_TIME * (v[1:] + v[:-1]), abs=1e-5)
        assert target - s[-1] <= v[-1] * CYCLE_TIME + 1e-9


def test_a_program_with_sin2_ends_at_its_target_and_is_slower_than_a_trapezium() -> None:
    benches = [MachineBench(f"#SLOPE [TYPE={name}]\nG01 X30 F3000\nY20\nM30").run() for name in ("SIN2", "TRAPEZ")]
    assert [bench.errors() for bench in benches] == [[], []]
    assert [bench.position("x") for bench in benches] == [30.0, 30.0]
    cycles = [sum(1 for line in bench.column("channel", "line") if line == 2) for bench in benches]
    axis = MILL.axes["x"]
    limits = Limits(50.0, axis.acceleration, axis.deceleration, axis.jerk)
    for count, plan in zip(cycles, (sine_from_rest, plan_rest_to_rest), strict=True):
        assert count * CYCLE_TIME == pytest.approx(plan(0.0, 30.0, limits).duration, abs=2 * CYCLE_TIME)
    assert cycles[0] > cycles[1]
    jerk = np.array(benches[0].column("x", "set_jerk"))
    assert 0.99 * axis.jerk < np.abs(jerk).max() <= axis.jerk * (1 + 1e-9)
    assert np.abs(np.diff(jerk)).max() < 0.5 * axis.jerk
