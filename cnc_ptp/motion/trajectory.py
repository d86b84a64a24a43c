"""A trajectory through points at given times: a polynomial in each segment, its extrema, its evaluation.

With d = t - t0 in the segment from (t0, p0) to (t1, p1): p(d) = c0 + c1·d + … + c5·d⁵, of the degree that the points
determine: 1 with positions alone, 3 with velocities (cubic Hermite), 5 with accelerations too (quintic Hermite).
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cnc_ptp.motion.polynomials import derivative, roots_between, value
from cnc_ptp.motion.profile import Profile
from cnc_ptp.motion.setpoints import MotionState

Coefficients = list[float]
"""c0, c1, … of a polynomial."""


class TrajectoryPoint(NamedTuple):
    """Where the axis is at `time` (s); mm, mm/s, mm/s² (deg). What is not given is None."""

    time: float
    position: float
    velocity: float | None = None
    acceleration: float | None = None


class Extremum(NamedTuple):
    """The largest or smallest value in a segment, and its time in the trajectory, s."""

    time: float
    value: float


class TrajectorySegment:
    """From one point to the next one."""

    def __init__(self, begin: TrajectoryPoint, end: TrajectoryPoint) -> None:
        self.begin = begin.time
        self.duration = end.time - begin.time
        self.position = hermite(begin, end)
        self.velocity = derivative(self.position)
        self.acceleration = derivative(self.velocity)
        self.jerk = derivative(self.acceleration)

    def state_at(self, d: float) -> MotionState:
        """(p, v, a, j) at `d` seconds after its begin."""
        return (
            value(self.position, d),
            value(self.velocity, d),
            value(self.acceleration, d),
            value(self.jerk, d),
        )

    def extrema(self, polynomial: Coefficients) -> Iterator[Extremum]:
        """At its ends, and where the derivative is 0; in the order of time."""
        for d in (0.0, *roots_between(derivative(polynomial), 0.0, self.duration, touching=True), self.duration):
            yield Extremum(self.begin + d, value(polynomial, d))


class Trajectory(Profile):
    """A table of segments of a trajectory, at rest before its begin and after its end."""

    __slots__ = ("_segments",)

    def __init__(self, points: Sequence[TrajectoryPoint], *, delay: float = 0.0) -> None:
        """`points`: two at least, the first at time 0, in ascending times; `delay` in s before it begins."""
        segments = [TrajectorySegment(begin, end) for begin, end in pairwise(points)]
        last = points[-1]
        rows = [(delay + segment.begin, *segment.state_at(0.0)) for segment in segments]
        super().__init__([*rows, (delay + last.time, last.position, 0.0, 0.0, 0.0)])
        self._segments = segments

    @property
    def segments(self) -> list[TrajectorySegment]:
        """In the order of time."""
        return self._segments

    def state_at(self, t: float) -> MotionState:
        """(p, v, a, j) at t seconds after the start; at rest before its begin and from its end on."""
        if t < self.starts[0]:
            return self.rows[0][1], 0.0, 0.0, 0.0
        index = bisect_right(self.starts, t) - 1
        if index == len(self._segments):
            return self.end[0], 0.0, 0.0, 0.0
        return self._segments[index].state_at(t - self.starts[index])

    def sample(self, times: ArrayLike) -> NDArray[np.float64]:
        """As Profile.sample."""
        return np.array([self.state_at(t) for t in np.asarray(times, dtype=np.float64).tolist()]).T


def hermite(begin: TrajectoryPoint, end: TrajectoryPoint) -> Coefficients:
    """The polynomial that meets all that is given of both points."""
    t = end.time - begin.time
    way, v0, v1 = end.position - begin.position, begin.velocity, end.velocity
    if v0 is None or v1 is None:
        return [begin.position, way / t]
    if begin.acceleration is None or end.acceleration is None:
        return [
            begin.position,
            v0,
            (3.0 * way - (2.0 * v0 + v1) * t) / t**2,
            ((v0 + v1) * t - 2.0 * way) / t**3,
        ]
    a0, a1 = begin.acceleration, end.acceleration
    return [
        begin.position,
        v0,
        0.5 * a0,
        (20.0 * way - (12.0 * v0 + 8.0 * v1) * t - (3.0 * a0 - a1) * t**2) / (2.0 * t**3),
        (-30.0 * way + (16.0 * v0 + 14.0 * v1) * t + (3.0 * a0 - 2.0 * a1) * t**2) / (2.0 * t**4),
        (12.0 * way - 6.0 * (v0 + v1) * t + (a1 - a0) * t**2) / (2.0 * t**5),
    ]
