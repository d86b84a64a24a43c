"""The runtime table of a spindle: segments in which the speed is a polynomial of the time."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from cnc_ptp.motion.polynomials import value
from cnc_ptp.spindle.acceleration_curves import RampPart

Motion = tuple[float, float, float]
"""Position in °, speed in °/s, acceleration in °/s²."""


class Segment(NamedTuple):
    """From `start` s on, with d = t - start:

    v(d) = speed[0] + speed[1]·d + …,  p(d) = position[0] + position[1]·d + …,  a(d) = rate[0] + rate[1]·d + …
    """

    start: float
    position: tuple[float, ...]
    speed: tuple[float, ...]
    rate: tuple[float, ...]


class SpeedTable:
    """An immutable table: segments, and after its end the end speed endlessly.

    duration   seconds from the start to the end
    end        (p, v, a) at the end, a = 0
    """

    __slots__ = ("_falling", "_starts", "duration", "end", "segments")

    def __init__(self, segments: Sequence[Segment]) -> None:
        last = segments[-1]
        self.segments = tuple(segments)
        self._starts = tuple(segment.start for segment in segments)
        self._falling = tuple(
            (segment.start, segment.position[::-1], segment.speed[::-1], segment.rate[::-1]) for segment in segments
        )
        """The powers from the highest one down, as Horner's scheme takes them."""
        self.duration = last.start
        self.end: Motion = (last.position[0], last.speed[0], 0.0)

    def state_at(self, t: float) -> Motion:
        """(p, v, a) at t seconds after the start; before it as at 0."""
        if t < 0.0:
            t = 0.0
        start, position, speed, rate = self._falling[bisect_right(self._starts, t) - 1]
        d = t - start
        if len(speed) == 1:
            return position[1] + d * position[0], speed[0], 0.0
        if len(speed) == 2:
            return position[2] + d * (position[1] + d * position[0]), speed[1] + d * speed[0], rate[0]
        p = v = a = 0.0
        for power in position:
            p = p * d + power
        for power in speed:
            v = v * d + power
        for power in rate:
            a = a * d + power
        return p, v, a

    def states_at(self, times: Sequence[float]) -> list[Motion]:
        """`state_at` for growing times >= 0; shorter where all are in one segment of constant acceleration."""
        index = bisect_right(self._starts, times[0]) - 1
        start, position, speed, rate = self._falling[index]
        if len(speed) != 2 or bisect_right(self._starts, times[-1]) - 1 != index:
            return [self.state_at(t) for t in times]
        (p2, p1, p0), (v1, v0), a = position, speed, rate[0]
        return [(p0 + d * (p1 + d * p2), v0 + d * v1, a) for d in [t - start for t in times]]


def segment(start: float, position: float, powers: Sequence[float]) -> Segment:
    """One segment of the speed `powers`; distance and acceleration are its integral and derivative."""
    positions = (position, *(power / (k + 1) for k, power in enumerate(powers)))
    rate = tuple(k * power for k, power in enumerate(powers))[1:] or (0.0,)
    return Segment(start, positions, tuple(powers), rate)


def table(
    position: float, parts: Iterable[RampPart], end_speed: float, *, end_position: float | None = None
) -> SpeedTable:
    """Parts strung together from `position`; then `end_speed`. Parts without duration leave no segment.

    `end_position`: where the last part ends exactly; rounding falls between it and the part.
    """
    segments: list[Segment] = []
    t = 0.0
    for duration, powers in parts:
        if duration > 0.0:
            segments.append(segment(t, position, powers))
            position = value(segments[-1].position, duration)
            t += duration
    segments.append(segment(t, position if end_position is None else end_position, (end_speed,)))
    return SpeedTable(segments)


def distance_of(parts: Iterable[RampPart]) -> float:
    """Distance in ° of all parts."""
    return sum(value((0.0, *(power / (k + 1) for k, power in enumerate(powers))), d) for d, powers in parts)
