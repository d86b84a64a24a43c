"""The polyline that is smoothed: its points with their place along it, as far as they are still needed."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from math import sqrt

Point = Sequence[float]


class Polyline:
    """Points (all axes), each with its place u (mm from the first) and block and feed of the chord that ends there."""

    __slots__ = ("blocks", "feeds", "places", "points")

    def __init__(self, first: Point, block: int, feed: float) -> None:
        self.places = [0.0]
        self.points = [first]
        self.blocks = [block]
        self.feeds = [feed]

    @property
    def end(self) -> float:
        return self.places[-1]

    def append(self, point: Point, length: float, block: int, feed: float) -> None:
        self.places.append(self.places[-1] + length)
        self.points.append(point)
        self.blocks.append(block)
        self.feeds.append(feed)

    def chord_at(self, u: float) -> int:
        """Index of the point at the end of the chord at u; at a point, of the chord behind it."""
        return min(bisect_right(self.places, u), len(self.places) - 1)

    def forget(self, u: float) -> None:
        """What is before the chord at u is no longer needed."""
        count = self.chord_at(u) - 1
        if count > 0:
            del self.places[:count]
            del self.points[:count]
            del self.blocks[:count]
            del self.feeds[:count]

    def moments(self, begin: float, end: float) -> list[float]:
        """∫P dx, ∫P·x dx, ∫P·x² dx of each axis over x = -1 … 1 between two places; three values for each axis.

        Simpson's rule on each chord, which is exact for these cubics.
        """
        places, points = self.places, self.points
        axes = len(points[0])
        sums = [0.0] * (3 * axes)
        index = self.chord_at(begin)
        middle, scale = 0.5 * (begin + end), 2.0 / (end - begin)
        last = len(places) - 1
        low = begin
        while low < end and index <= last:
            high = end if index == last else min(places[index], end)
            before, after = points[index - 1], points[index]
            origin = places[index - 1]
            rate = 1.0 / (places[index] - origin)
            part0, part1 = (low - origin) * rate, (high - origin) * rate
            x0, x2 = (low - middle) * scale, (high - middle) * scale
            x1 = 0.5 * (x0 + x2)
            weight = (x2 - x0) / 6.0
            for axis in range(axes):
                base = before[axis]
                rise = after[axis] - base
                p0, p2 = weight * (base + rise * part0), weight * (base + rise * part1)
                p1 = 2.0 * (p0 + p2)
                place = 3 * axis
                sums[place] += p0 + p1 + p2
                first0, first1, first2 = p0 * x0, p1 * x1, p2 * x2
                sums[place + 1] += first0 + first1 + first2
                sums[place + 2] += first0 * x0 + first1 * x1 + first2 * x2
            low = high
            index += 1
        return sums


def distance(before: Point, after: Point, axes: Sequence[int]) -> float:
    """Over the given axes."""
    square = 0.0
    for axis in axes:
        difference = after[axis] - before[axis]
        square += difference * difference
    return sqrt(square)
