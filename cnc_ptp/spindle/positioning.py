"""Positioning of a spindle (M19): the turn in which it stops, and the motion to it (TF5200 spindle 2.3.2).

A faster spindle first comes down to the positioning speed on the ramp of endless rotation; from there on, and from
rest, acceleration and deceleration are constant. Units: °, °/s, °/s².
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import sqrt

from cnc_ptp.spindle.acceleration_curves import AccelerationCurve, RampPart
from cnc_ptp.spindle.speed_ramp import Ramp, ramp_parts
from cnc_ptp.spindle.speed_table import SpeedTable, distance_of, table

SAME_PLACE = 1e-7
"""°: a target this little behind the place where the spindle would stop is that place …"""
ROUNDING = 1e-15
"""… plus this part of the positions, which grow without limit."""


@dataclass(frozen=True, slots=True)
class PositioningLimits:
    """Limits of one positioning."""

    speed: float
    acceleration: float
    deceleration: float
    ramp: Ramp | AccelerationCurve
    """From a larger speed down to `speed`, and to 0 before a reversal."""


def stopping_distance(speed: float, limits: PositioningLimits) -> float:
    """Stopping distance in ° from a magnitude of speed >= 0."""
    distance = 0.0
    if speed > limits.speed:
        distance, speed = distance_of(ramp_parts(speed, limits.speed, limits.ramp)), limits.speed
    return distance + 0.5 * speed * speed / limits.deceleration


def next_target(
    position: float, speed: float, goal: float, turn: float, direction: float, limits: PositioningLimits
) -> float:
    """The first place in `direction` (±1) that is `goal` modulo `turn` and at which the spindle can stop.

    A spindle that turns in the other direction comes to rest first.
    """
    start = position
    least = 0.0
    if speed * direction < 0.0:
        start = position - direction * distance_of(ramp_parts(abs(speed), 0.0, limits.ramp))
    else:
        least = stopping_distance(abs(speed), limits)
    ahead = ((goal - start) * direction - least) % turn
    if turn - ahead < same_place(position):
        ahead -= turn
    return start + direction * (least + ahead)


def same_place(position: float) -> float:
    return SAME_PLACE + ROUNDING * abs(position)


def shortest_direction(position: float, goal: float, turn: float) -> float:
    """+1 or -1 for the shorter distance from rest; half a turn goes forward."""
    return 1.0 if (goal - position) % turn <= 0.5 * turn + SAME_PLACE else -1.0


def plan_positioning(
    position: float, speed: float, target: float, direction: float, limits: PositioningLimits
) -> SpeedTable | None:
    """The table to standstill exactly at `target`, reached in `direction` (±1); None when it is too late for that.

    A spindle that turns in the other direction comes to rest first. With a positioning speed of 0 (override 0) it stops
    before the target, unless it brakes for it already.
    """
    parts: list[RampPart] = []
    amount = abs(speed)
    if speed * direction < 0.0:
        parts = signed(list(ramp_parts(amount, 0.0, limits.ramp)), -1.0)
        amount = 0.0
    rest = (target - position) * direction - distance_of(parts)
    least = stopping_distance(amount, limits)
    if least > rest + 2.0 * same_place(position):
        return None
    if limits.speed == 0.0 and least < rest - same_place(position):
        return table(position, signed([*parts, *ramp_parts(amount, 0.0, limits.ramp)], direction), 0.0)
    parts += approach(amount, rest, limits)
    return table(position, signed(parts, direction), 0.0, end_position=target)


def approach(speed: float, distance: float, limits: PositioningLimits) -> Iterator[RampPart]:
    """From `speed` >= 0 to standstill after `distance`, which is long enough."""
    if speed > limits.speed:
        for duration, powers in ramp_parts(speed, limits.speed, limits.ramp):
            yield duration, powers
            distance -= distance_of([(duration, powers)])
        speed = limits.speed
    up, down = limits.acceleration, limits.deceleration
    top = sqrt(max(0.0, (2.0 * up * down * distance + down * speed * speed) / (up + down)))
    top = max(speed, min(top, limits.speed))
    yield (top - speed) / up, (speed, up)
    cruise = distance - 0.5 * (top * top - speed * speed) / up - 0.5 * top * top / down
    if cruise > 0.0 and top > 0.0:
        yield cruise / top, (top,)
    yield top / down, (top, -down)


def signed(parts: list[RampPart], direction: float) -> list[RampPart]:
    return parts if direction > 0.0 else [(d, tuple(-power for power in powers)) for d, powers in parts]
