"""Speed ramps against textbook constant-acceleration motion."""

from __future__ import annotations

import random

import pytest
from long_support import long

from cnc_ptp.spindle.speed_ramp import ConstantRamp, plan_speed

UP, DOWN = 900.0, 1600.0
RAMP = ConstantRamp(acceleration=UP, deceleration=DOWN)


def expected(position: float, speed: float, wanted: float, t: float) -> tuple[float, float]:
    """Position and speed at t: one ramp, or with a reversal one to 0 and one from there."""
    while True:
        stage = 0.0 if speed * wanted < 0.0 else wanted
        rate = UP if abs(stage) > abs(speed) else DOWN
        duration = abs(stage - speed) / rate
        a = rate if stage > speed else -rate
        if t <= duration:
            return position + speed * t + 0.5 * a * t * t, speed + a * t
        position += 0.5 * (speed + stage) * duration
        t -= duration
        speed = stage
        if stage == wanted:
            return position + wanted * t, wanted


@pytest.mark.parametrize("speed", [0.0, 500.0, -500.0, 1234.5])
@pytest.mark.parametrize("wanted", [0.0, 100.0, -100.0, 2000.0, -2000.0])
def test_ramps_are_textbook_motion(speed: float, wanted: float) -> None:
    profile = plan_speed(33.0, speed, wanted, RAMP)
    for k in range(400):
        t = k * 0.01
        p, v, a = profile.state_at(t)
        assert (p, v) == pytest.approx(expected(33.0, speed, wanted, t), abs=1e-8)
        assert abs(a) in (0.0, UP, DOWN)
    assert profile.state_at(10.0)[1] == wanted


@pytest.mark.parametrize("step", [77, *long([7])])
@pytest.mark.parametrize("wanted", [72_000.0, -72_000.0, 333.3])
def test_every_cycle_of_a_long_ramp_is_exact(wanted: float, step: int) -> None:
    """1e-9 relative, as along the curves, 80 s at 1 ms."""
    profile = plan_speed(0.0, -0.5 * wanted, wanted, RAMP)
    for k in range(0, 80_000, step):
        p, v, _ = profile.state_at(k * 0.001)
        distance, speed = expected(0.0, -0.5 * wanted, wanted, k * 0.001)
        assert v == pytest.approx(speed, rel=1e-9, abs=1e-9) and p == pytest.approx(distance, rel=1e-9, abs=1e-6)


def test_the_end_speed_is_exact_and_a_speed_that_is_reached_makes_no_ramp() -> None:
    draw = random.Random(3)
    for _ in range(200):
        speed, wanted = draw.uniform(-1e5, 1e5), draw.uniform(-1e5, 1e5)
        assert plan_speed(0.0, speed, wanted, RAMP).end[1:] == (wanted, 0.0)
        assert plan_speed(7.0, wanted, wanted, RAMP).duration == 0.0


def test_a_reversal_slows_down_with_the_deceleration_and_speeds_up_with_the_acceleration() -> None:
    profile = plan_speed(0.0, 800.0, -450.0, RAMP)
    assert [(segment.start, segment.rate[0]) for segment in profile.segments] == [(0.0, -DOWN), (0.5, -UP), (1.0, 0.0)]
