"""The velocity that axes permit along a path, computed without the planner: no run within the limits is faster.

Only the shape of the path is asked: q1, q2, q3 of each axis at many places of it. With y = u'² and any acceleration and
jerk along the path, the limits A and J of an axis say

    |q2|·y <= A        |q3|·y^(3/2) <= J                                    at constant velocity
    u'' <= (A + |q2|·y)/|q1|        u''' <= (J + 3·|q2|·u'·|u''| + |q3|·u'³)/|q1|

so the velocity at a place is at most the least of feed, of what the shape there permits, of what can be reached from
any other place with the largest u'', and of what can be reached from a standstill with the largest u'' and u''' that
stand anywhere near it (a feed that is not exceeded has u'' <= √(2·u'''·(feed - u'))). Each of these is above what a
real run can do, so a share of the bound is never said to be higher than it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STEPS = 4000
"""Of the table of a start from rest."""
CLOSE = 1e-3
"""Part of the feed that does not count: pieces of a curve have a little more or less of it in u'."""
FEWEST, SPACING = 8, 0.25
"""Places on each part of a path, and mm between them."""


class PathBound:
    """Of one path: `u` of places, q1, q2, q3 of its axes there (places, axes), and the places at which it stops.

    feed, velocity   u' of the programmed feed, and of what is permitted at most, at each place
    """

    def __init__(
        self, u: Array, q1: Array, q2: Array, q3: Array, stops: Sequence[float],
        *, feed: float, acceleration: float, jerk: float,
    ) -> None:  # fmt: skip
        self.u, self.feed = u, feed / np.linalg.norm(q1, axis=1)
        slope, bend, twist = np.abs(q1), np.abs(q2), np.abs(q3)
        self.curve = self._constant(bend, twist, acceleration, jerk)
        along = ratio(acceleration + bend * (self.curve**2)[:, None], slope)
        cross = 3.0 * bend * (self.curve * along)[:, None] + twist * (self.curve**3)[:, None]
        self._stops = np.unique(np.asarray(stops))
        number = np.searchsorted(self._stops, u)
        self._starts = self._starts_of(number, along, ratio(jerk + cross, slope))
        self.velocity = np.minimum(self.curve, self._from_stops(u))
        self._reach(along)

    def _constant(self, bend: Array, twist: Array, acceleration: float, jerk: float) -> Array:
        """What feed and shape permit."""
        with np.errstate(divide="ignore"):
            by_bend = np.sqrt(acceleration / bend.max(axis=1))
            by_twist = np.cbrt(jerk / twist.max(axis=1))
        return np.minimum(self.feed, np.minimum(by_bend, by_twist))

    def _starts_of(self, number: NDArray[np.intp], along: Array, jerk: Array) -> dict[int, tuple[Array, Array]]:
        """Way and velocity of a start from rest between two stops; `number` of the stretch of each place."""
        first = np.searchsorted(number, np.unique(number))
        strongest = zip(np.maximum.reduceat(along, first), np.maximum.reduceat(jerk, first), strict=True)
        return {
            int(stretch): rest_to_feed(float(a), float(j), float(self.feed.max()))
            for stretch, (a, j) in zip(number[first], strongest, strict=True)
        }

    def _from_stops(self, u: Array) -> Array:
        """For each place, by its way from the stop before it and to the one behind it."""
        number = np.searchsorted(self._stops, u)
        last = len(self._stops) - 1
        before, behind = self._stops[np.maximum(number - 1, 0)], self._stops[np.minimum(number, last)]
        way = np.minimum(np.abs(u - before), np.abs(behind - u))
        found = np.full(len(u), self.feed.max())
        for stretch, start in self._starts.items():
            inside = slice(*np.searchsorted(number, [stretch, stretch + 1]))
            found[inside] = np.interp(way[inside], *start)
        return found

    def _reach(self, along: Array) -> None:
        """y grows along the path by at most 2·u'' for each mm, in both directions."""
        for order in (range(1, len(self.u)), range(len(self.u) - 2, -1, -1)):
            step = 1 if order.step < 0 else -1
            for n in order:
                strongest = max(along[n], along[n + step])
                reached = self.velocity[n + step] ** 2 + 2.0 * strongest * abs(self.u[n] - self.u[n + step])
                if self.velocity[n] ** 2 > reached:
                    self.velocity[n] = np.sqrt(reached)

    def at(self, u: Array) -> Array:
        """The bound at places in between, which grow; y is nearly linear there."""
        return np.minimum(np.sqrt(np.interp(u, self.u, self.velocity**2)), self._from_stops(u))

    def free(self, u: Array) -> NDArray[np.bool_]:
        """Where the axes permit the whole feed."""
        return self.at(u) >= np.interp(u, self.u, self.feed) * (1.0 - CLOSE)


def bound_of(parts: Sequence[Any], *, feed: float, acceleration: float, jerk: float) -> PathBound:
    """Of parts of a path that have a geometry with `shape`, and an `entry` of 0 where the path stops before them."""
    places: list[float] = []
    shapes: list[list[tuple[float, float, float]]] = []
    stops = [0.0]
    begin = 0.0
    for part in parts:
        if part.entry == 0.0:
            stops.append(begin)
        count = max(FEWEST, ceil(part.length / SPACING))
        for number in range(count):
            u = (number + 0.5) * part.length / count
            places.append(begin + u)
            shapes.append([axis[1:] for axis in part.geometry.shape(u)])
        begin += part.length
    q = np.array(shapes)
    return PathBound(
        np.array(places), q[:, :, 0], q[:, :, 1], q[:, :, 2], [*stops, begin],
        feed=feed, acceleration=acceleration, jerk=jerk,
    )  # fmt: skip


def ratio(strength: Array, slope: Array) -> Array:
    """The least over the axes that move."""
    with np.errstate(divide="ignore"):
        return np.where(slope > 0.0, strength / slope, np.inf).min(axis=1)


def rest_to_feed(acceleration: float, jerk: float, feed: float) -> tuple[Array, Array]:
    """Way and velocity of the fastest start on a line: jerk up, constant acceleration, jerk down towards the feed."""
    acceleration = min(acceleration, float(np.sqrt(feed * jerk)))
    ramp, constant = acceleration / jerk, feed / acceleration - acceleration / jerk
    t = np.linspace(0.0, 2.0 * ramp + constant, STEPS)
    rise, level, fall = np.minimum(t, ramp), np.clip(t - ramp, 0.0, constant), np.maximum(t - ramp - constant, 0.0)
    velocity = 0.5 * jerk * rise**2 + acceleration * (level + fall) - 0.5 * jerk * fall**2
    way = jerk * rise**3 / 6.0 + 0.5 * jerk * ramp**2 * level + 0.5 * acceleration * level**2
    way += (feed - 0.5 * jerk * ramp**2) * fall + 0.5 * acceleration * fall**2 - jerk * fall**3 / 6.0
    return way, velocity
