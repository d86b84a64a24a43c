"""Positioning: which turn, which direction, and the motion, re-integrated from the samples."""

from __future__ import annotations

import math
import random
from itertools import pairwise

import pytest
from curve_support import POLYNOMIAL, TOP
from long_support import examples

from cnc_ptp.spindle.acceleration_curves import AccelerationCurve
from cnc_ptp.spindle.positioning import (
    SAME_PLACE,
    PositioningLimits,
    next_target,
    plan_positioning,
    shortest_direction,
    stopping_distance,
)
from cnc_ptp.spindle.speed_ramp import ConstantRamp
from cnc_ptp.spindle.speed_table import SpeedTable

UP, DOWN = 3000.0, 4000.0
RAMP = ConstantRamp(acceleration=UP, deceleration=DOWN)


def limits(speed: float = 1200.0) -> PositioningLimits:
    return PositioningLimits(speed, UP, DOWN, RAMP)


def check_table(table: SpeedTable, position: float, speed: float, target: float, top: float) -> None:
    """Starts at the state, ends at rest at the target, no faster than `top`; position and speed are integrals of the rest."""
    assert table.state_at(0.0)[:2] == pytest.approx((position, speed), abs=1e-9)
    assert table.end == (target, 0.0, 0.0)
    n, t = 4000, table.duration
    if t == 0.0:
        return
    states = [table.state_at(t * k / n) for k in range(n + 1)]
    for (p0, v0, a0), (p1, v1, _) in pairwise(states):
        assert -DOWN - 1e-6 <= a0 * math.copysign(1.0, v0 or v1) <= UP + 1e-6
        assert abs(p1 - p0 - 0.5 * (v0 + v1) * t / n) <= 0.25 * (UP + DOWN) * (t / n) ** 2 + 1e-8
        assert abs(v1 - v0) <= max(UP, DOWN) * t / n + 1e-8
        assert abs(v1) <= max(abs(speed), top) + 1e-8


def test_seeded_positionings() -> None:
    """From any state in a given direction: the first place that is the goal and can be reached."""
    draw = random.Random(21)
    for _ in range(examples(300)):
        position, goal = draw.uniform(-1e4, 1e4), draw.uniform(-720.0, 720.0)
        speed = draw.choice((0.0, draw.uniform(-9000.0, 9000.0)))
        direction, turn = draw.choice((-1.0, 1.0)), draw.choice((360.0, 120.0))
        bound = limits(draw.uniform(100.0, 2000.0))
        target = next_target(position, speed, goal, turn, direction, bound)
        assert math.remainder(target - goal, turn) == pytest.approx(0.0, abs=1e-8)
        table = plan_positioning(position, speed, target, direction, bound)
        assert table is not None
        check_table(table, position, speed, target, bound.speed)
        rest = position + math.copysign(0.5 * speed * speed / DOWN, speed)
        assert -2.0 * SAME_PLACE <= (target - rest) * direction < turn


@pytest.mark.parametrize(
    ("position", "goal", "direction"),
    [(0.0, 90.0, 1.0), (0.0, 270.0, -1.0), (350.0, 10.0, 1.0), (10.0, 350.0, -1.0), (0.0, 180.0, 1.0)],
)
def test_shortest_way_from_rest(position: float, goal: float, direction: float) -> None:
    assert shortest_direction(position, goal, 360.0) == direction


@pytest.mark.parametrize("position", [100.0, 100.0 + 1e-9, 100.0 - 1e-9, 460.0, -260.0])
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_spindle_that_is_there_makes_no_turn(position: float, direction: float) -> None:
    target = next_target(position, 0.0, 100.0, 360.0, direction, limits())
    assert target == pytest.approx(position, abs=2e-9)


def test_a_fast_spindle_comes_down_along_its_curve_first() -> None:
    """The distance from 40000 °/s down to 1200 °/s is that of the curve, then the constant deceleration counts."""
    curve = AccelerationCurve(POLYNOMIAL, top_speed=TOP)
    bound = PositioningLimits(1200.0, UP, DOWN, curve)
    target = next_target(0.0, 40_000.0, 90.0, 360.0, 1.0, bound)
    table = plan_positioning(0.0, 40_000.0, target, 1.0, bound)
    assert table is not None and table.end == (target, 0.0, 0.0)
    assert 0.0 <= target - stopping_distance(40_000.0, bound) < 360.0
    assert table.state_at(0.1)[2] == pytest.approx(-curve.acceleration(table.state_at(0.1)[1]), rel=1e-9)


def test_too_late_for_a_target() -> None:
    assert plan_positioning(0.0, 1000.0, 100.0, 1.0, limits()) is None  # needs 125 deg


def test_override_0_stops_before_the_target_or_brakes_for_it() -> None:
    held = plan_positioning(0.0, 1000.0, 500.0, 1.0, limits(0.0))
    assert held is not None and held.end == (125.0, 0.0, 0.0)
    braking = plan_positioning(0.0, 1000.0, 125.0, 1.0, limits(0.0))
    assert braking is not None and braking.end == (125.0, 0.0, 0.0)


def test_against_the_motion_it_comes_to_rest_first() -> None:
    target = next_target(0.0, 1000.0, 90.0, 360.0, -1.0, limits())
    assert target == pytest.approx(90.0)  # rest at 125, then back
    table = plan_positioning(0.0, 1000.0, target, -1.0, limits())
    assert table is not None
    check_table(table, 0.0, 1000.0, target, 1200.0)
    assert max(table.state_at(k * 0.001)[0] for k in range(1000)) == pytest.approx(125.0, abs=0.01)


def test_far_away_from_zero_after_days_of_rotation() -> None:
    """12000 rpm for two days: positions of 1e10 deg have steps of 2e-6 deg."""
    draw = random.Random(31)
    for _ in range(500):
        position, speed = draw.uniform(-1e10, 1e10), draw.uniform(-9000.0, 9000.0)
        bound, direction = limits(draw.uniform(0.0, 2000.0)), draw.choice((-1.0, 1.0))
        target = next_target(position, speed, draw.uniform(0.0, 360.0), 360.0, direction, bound)
        table = plan_positioning(position, speed, target, direction, bound)
        assert table is not None and (bound.speed == 0.0 or table.end[0] == target)
        again = plan_positioning(*table.state_at(0.7 * table.duration)[:2], target, direction, bound)
        assert again is not None and again.end[0] == pytest.approx(target, abs=1e-4)
