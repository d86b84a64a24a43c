"""Motions that excite an axis for its identification: back and forth from one position, within its limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from cnc_ptp.commissioning.faults import BAD_VELOCITIES, NO_ROOM, refusal
from cnc_ptp.commissioning.timing import Seconds
from cnc_ptp.parameters.declare import ids

EDGE = 0.01
"""Part of the travel that stays free at either end."""
PAUSE = 0.2
"""Seconds of rest between two motions, besides the settling."""
SPEEDS = 30
RANGE = 5000.0
"""Highest over lowest speed."""
LOWEST_INCREMENTS = 50.0
"""Increments of the encoder per second at the lowest speed."""
LOWEST_SPEED = 0.02
"""mm/s (deg/s): the table counts µm/s."""


@dataclass(frozen=True, slots=True)
class Room:
    """Travel and velocity that an axis may use; mm, s (deg, s). An axis without soft limits has infinite ones."""

    axis: str
    unit: str
    position: float
    low: float
    high: float
    max_velocity: float
    acceleration: float
    deceleration: float
    jerk: float
    encoder_increment: float = 0.0
    limited_by: str = ids.DYNAMIK_VB_MAX
    """The parameter that limits the highest velocity."""

    @property
    def travel(self) -> float:
        return self.high - self.low


@dataclass(frozen=True, slots=True)
class Motion:
    """One motion: starts at `at` s, goes `distance` (with sign) at `velocity`, lasts `duration` s."""

    at: float
    distance: float
    velocity: float
    duration: float


def ramp_time(velocity: float, acceleration: float, jerk: float) -> float:
    """Seconds from rest to `velocity` with limited jerk: v/a + a/j, or 2·sqrt(v/j) where a is not reached."""
    if velocity * jerk >= acceleration * acceleration:
        return velocity / acceleration + acceleration / jerk
    return 2.0 * math.sqrt(velocity / jerk)


def ramp_times(room: Room, velocity: float) -> tuple[float, float]:
    """Seconds up to `velocity` and down again."""
    return ramp_time(velocity, room.acceleration, room.jerk), ramp_time(velocity, room.deceleration, room.jerk)


def steady_time(room: Room, velocity: float, steady: float) -> float:
    """Seconds of constant velocity, at least `steady`.

    A start reduces a velocity that ramps with the smaller acceleration on both sides could not reach (TX1250 2.1), so
    the distance has to be long enough for those.
    """
    ramps = ramp_times(room, velocity)
    return max(steady, max(ramps) - 0.5 * sum(ramps))


def motion_time(room: Room, velocity: float, steady: float) -> float:
    """Seconds from rest to rest with at least `steady` seconds of constant velocity."""
    return sum(ramp_times(room, velocity)) + steady_time(room, velocity, steady)


def motion_distance(room: Room, velocity: float, steady: float) -> float:
    """mm (deg) from rest to rest: half the velocity in the ramps, as they are symmetric."""
    return velocity * (0.5 * sum(ramp_times(room, velocity)) + steady_time(room, velocity, steady))


def highest_velocity(room: Room, steady: Seconds) -> float:
    """The highest velocity at which the axis has room for its `steady` seconds; mm/s (deg/s)."""
    usable = room.travel * (1.0 - 2.0 * EDGE)
    if motion_distance(room, room.max_velocity, steady(room.max_velocity)) <= usable:
        return room.max_velocity
    low, high = 0.0, room.max_velocity
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if motion_distance(room, middle, steady(middle)) <= usable else (low, middle)
    return low


def speed_ladder(room: Room, steady: Seconds) -> list[float]:
    """Speeds from slow to as fast as there is room for, evenly spaced in their logarithm, with three digits.

    Raises CncError 27010 if there is no room to move.
    """
    high = highest_velocity(room, steady)
    low = max(high / RANGE, LOWEST_INCREMENTS * room.encoder_increment, LOWEST_SPEED)
    if high < 2.0 * low:
        raise refusal(
            NO_ROOM,
            room.axis,
            f"the soft limits leave {room.travel:g} {room.unit} (P-AXIS-00177, P-AXIS-00178), too little to drive "
            f"{steady(low):g} s with constant velocity; nothing was started",
        )
    ratio = (high / low) ** (1.0 / (SPEEDS - 1))
    return [min(high, float(f"{low * ratio**index:.3g}")) for index in range(SPEEDS)]


def check_speeds(room: Room, speeds: Sequence[float], steady: Seconds) -> list[float]:
    """Speeds that somebody asks for, in ascending order. Raises CncError 27011 for one that cannot be driven."""
    for speed in speeds:
        if not 0.0 < speed <= room.max_velocity:
            raise refusal(
                BAD_VELOCITIES,
                room.axis,
                f"the velocity {speed:g} {room.unit}/s is not above 0 and up to {room.max_velocity:g} {room.unit}/s "
                f"({room.limited_by}); nothing was started",
            )
        needed, usable = motion_distance(room, speed, steady(speed)), room.travel * (1.0 - 2.0 * EDGE)
        if needed > usable:
            raise refusal(
                BAD_VELOCITIES,
                room.axis,
                f"{speed:g} {room.unit}/s need {needed:.4g} {room.unit} of travel, the soft limits leave {usable:.4g} "
                f"{room.unit} (P-AXIS-00177, P-AXIS-00178); nothing was started",
            )
    return sorted(set(speeds))


def forth_and_back(room: Room, speeds: Sequence[float], *, steady: Seconds, rest: float) -> list[Motion]:
    """A motion to where there is room, then each speed back and forth; `rest` s before each motion."""
    longest = max(motion_distance(room, speed, steady(speed)) for speed in speeds)
    start, side = _start(room, longest)
    motions: list[Motion] = []
    time = rest
    if start != room.position:
        distance = start - room.position
        velocity = room.max_velocity
        # At most the whole distance at velocity and both ramps, even if the velocity is not reached.
        duration = abs(distance) / velocity + motion_time(room, velocity, 0.0)
        motions.append(Motion(time, distance, velocity, duration))
        time += duration + PAUSE + rest
    for speed in speeds:
        for direction in (side, -side):
            duration = motion_time(room, speed, steady(speed))
            motions.append(Motion(time, direction * motion_distance(room, speed, steady(speed)), speed, duration))
            time += duration + PAUSE + rest
    return motions


def _start(room: Room, longest: float) -> tuple[float, float]:
    """Start position and first direction: the present position, if there is room."""
    if math.isinf(room.travel):
        return room.position, 1.0
    edge = EDGE * room.travel
    if room.low + edge <= room.position <= room.high - edge - longest:
        return room.position, 1.0
    if room.low + edge + longest <= room.position <= room.high - edge:
        return room.position, -1.0
    return room.low + edge, 1.0
