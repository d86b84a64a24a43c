"""The runtime table of a spindle: segments in which the speed is a polynomial of the time."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from cnc_ptp.spindle.acceleration_curves import Leg
from cnc_ptp.spindle.polynomials import value

Motion = tuple[float, float, float]
"""Position in °, speed in °/s, acceleration in °/s²."""


class Segment(NamedTuple):
    """From `start` s on, with d = t - start:

    v(d) = speed[0] + speed[1]·d + …,  p(d) = way[0] + way[1]·d + …,  a(d) = rate[0] + rate[1]·d + …
    """

    start: float
    way: tuple[float, ...]
    speed: tuple[float, ...]
    rate: tuple[float, ...]


class SpeedTable:
    """An immutable table: segments, and after its end the end speed for ever.

    duration   seconds from the begin to the end
    end        (p, v, a) at the end, a = 0
    """

    __slots__ = ("_falling", "_starts", "duration", "end", "segments")

    def __init__(self, segments: Sequence[Segment]) -> None:
        last = segments[-1]
        self.segments = tuple(segments)
        self._starts = tuple(segment.start for segment in segments)
        self._falling = tuple(
            (segment.start, segment.way[::-1], segment.speed[::-1], segment.rate[::-1]) for segment in segments
        )
        """The powers from the highest one down, as Horner's scheme takes them."""
        self.duration = last.start
        self.end: Motion = (last.way[0], last.speed[0], 0.0)

    def state_at(self, t: float) -> Motion:
        """(p, v, a) at t seconds after the begin; before it as at 0."""
        if t < 0.0:
            t = 0.0
        start, way, speed, rate = self._falling[bisect_right(self._starts, t) - 1]
        d = t - start
        if len(speed) == 1:
            return way[1] + d * way[0], speed[0], 0.0
        if len(speed) == 2:
            return way[2] + d * (way[1] + d * way[0]), speed[1] + d * speed[0], rate[0]
        p = v = a = 0.0
        for power in way:
            p = p * d + power
        for power in speed:
            v = v * d + power
        for power in rate:
            a = a * d + power
        return p, v, a

    def states_at(self, times: Sequence[float]) -> list[Motion]:
        """`state_at` for growing times >= 0; shorter where all are in one segment of constant acceleration."""
        index = bisect_right(self._starts, times[0]) - 1
        start, way, speed, rate = self._falling[index]
        if len(speed) != 2 or bisect_right(self._starts, times[-1]) - 1 != index:
            return [self.state_at(t) for t in times]
        (p2, p1, p0), (v1, v0), a = way, speed, rate[0]
        return [(p0 + d * (p1 + d * p2), v0 + d * v1, a) for d in [t - start for t in times]]


def segment(start: float, position: float, powers: Sequence[float]) -> Segment:
    """One segment of the speed `powers`; way and acceleration are its integral and derivative."""
    way = (position, *(power / (k + 1) for k, power in enumerate(powers)))
    rate = tuple(k * power for k, power in enumerate(powers))[1:] or (0.0,)
    return Segment(start, way, tuple(powers), rate)


def table(position: float, legs: Iterable[Leg], end_speed: float, *, end_position: float | None = None) -> SpeedTable:
    """Legs strung together from `position`; then `end_speed`. Legs without duration leave no segment.

    `end_position`: where the last leg ends exactly; rounding falls between it and the leg.
    """
    segments: list[Segment] = []
    t = 0.0
    for duration, powers in legs:
        if duration > 0.0:
            segments.append(segment(t, position, powers))
            position = value(segments[-1].way, duration)
            t += duration
    segments.append(segment(t, position if end_position is None else end_position, (end_speed,)))
    return SpeedTable(segments)


def way_of(legs: Iterable[Leg]) -> float:
    """Way in ° of legs."""
    return sum(value((0.0, *(power / (k + 1) for k, power in enumerate(powers))), d) for d, powers in legs)
