"""Positioning of a spindle (M19): which turn it stops in, and the way there (TF5200 spindle 2.3.2).

A faster spindle first comes down to the positioning speed on the ramp of endless rotation; from there on, and from
rest, acceleration and deceleration are constant. Units: °, °/s, °/s².
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import sqrt

from cnc_ptp.spindle.acceleration_curves import AccelerationCurve, Leg
from cnc_ptp.spindle.speed_ramp import Ramp, ramp_legs
from cnc_ptp.spindle.speed_table import SpeedTable, table, way_of

SAME_PLACE = 1e-7
"""°: a target this little behind the place where the spindle would stop is that place …"""
ROUNDING = 1e-15
"""… and this part of the positions besides, which count on for ever."""


@dataclass(frozen=True, slots=True)
class PositioningLimits:
    """Limits of one positioning."""

    speed: float
    acceleration: float
    deceleration: float
    ramp: Ramp | AccelerationCurve
    """From a larger speed down to `speed`, and to 0 before a reversal."""


def stop_way(speed: float, limits: PositioningLimits) -> float:
    """Least way in ° from an amount of speed >= 0 to standstill."""
    way = 0.0
    if speed > limits.speed:
        way, speed = way_of(ramp_legs(speed, limits.speed, limits.ramp)), limits.speed
    return way + 0.5 * speed * speed / limits.deceleration


def next_target(
    position: float, speed: float, goal: float, turn: float, direction: float, limits: PositioningLimits
) -> float:
    """The first place in `direction` (±1) that is `goal` modulo `turn` and at which the spindle can stop.

    A spindle that turns the other way comes to rest first.
    """
    start = position
    least = 0.0
    if speed * direction < 0.0:
        start = position - direction * way_of(ramp_legs(abs(speed), 0.0, limits.ramp))
    else:
        least = stop_way(abs(speed), limits)
    ahead = ((goal - start) * direction - least) % turn
    if turn - ahead < same_place(position):
        ahead -= turn
    return start + direction * (least + ahead)


def same_place(position: float) -> float:
    return SAME_PLACE + ROUNDING * abs(position)


def shortest_direction(position: float, goal: float, turn: float) -> float:
    """+1 or -1 for the shorter way from rest; half a turn goes forward."""
    return 1.0 if (goal - position) % turn <= 0.5 * turn + SAME_PLACE else -1.0


def plan_positioning(
    position: float, speed: float, target: float, direction: float, limits: PositioningLimits
) -> SpeedTable | None:
    """The table to standstill exactly at `target`, reached in `direction` (±1); None when it is too late for that.

    A spindle that turns the other way comes to rest first. With a positioning speed of 0 (override 0) it stops before
    the target, unless it brakes for it already.
    """
    legs: list[Leg] = []
    amount = abs(speed)
    if speed * direction < 0.0:
        legs = signed(list(ramp_legs(amount, 0.0, limits.ramp)), -1.0)
        amount = 0.0
    rest = (target - position) * direction - way_of(legs)
    least = stop_way(amount, limits)
    if least > rest + 2.0 * same_place(position):
        return None
    if limits.speed == 0.0 and least < rest - same_place(position):
        return table(position, signed([*legs, *ramp_legs(amount, 0.0, limits.ramp)], direction), 0.0)
    legs += approach(amount, rest, limits)
    return table(position, signed(legs, direction), 0.0, end_position=target)


def approach(speed: float, way: float, limits: PositioningLimits) -> Iterator[Leg]:
    """From `speed` >= 0 to standstill after `way`, which is long enough."""
    if speed > limits.speed:
        for duration, powers in ramp_legs(speed, limits.speed, limits.ramp):
            yield duration, powers
            way -= way_of([(duration, powers)])
        speed = limits.speed
    up, down = limits.acceleration, limits.deceleration
    top = sqrt(max(0.0, (2.0 * up * down * way + down * speed * speed) / (up + down)))
    top = max(speed, min(top, limits.speed))
    yield (top - speed) / up, (speed, up)
    cruise = way - 0.5 * (top * top - speed * speed) / up - 0.5 * top * top / down
    if cruise > 0.0 and top > 0.0:
        yield cruise / top, (top,)
    yield top / down, (top, -down)


def signed(legs: list[Leg], direction: float) -> list[Leg]:
    return legs if direction > 0.0 else [(d, tuple(-power for power in powers)) for d, powers in legs]
