"""Finds the corners of a polyline that are meant: where its direction turns by more than rounded points explain."""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, pi
from typing import Final

from cnc_ptp.path.lookahead.polyline import Point, distance

WIDEST_REACH: Final = 0.02
"""mm before and behind a point over which its turn is measured at most; points rounded to 0.001 mm turn by 6 deg."""
REACH: Final = 4.0
"""The same in path deviations."""


class Vertex:
    """A point with the chord before it.

    place    mm along the polyline
    length   mm of the chord, over the path axes
    corner   the curve ends here
    """

    __slots__ = ("block", "corner", "feed", "length", "place", "point")

    def __init__(self, point: Point, place: float, length: float, block: int, feed: float) -> None:
        self.point, self.place, self.length = point, place, length
        self.block, self.feed = block, feed
        self.corner = False


class CornerFinder:
    """Takes points one after the other, and gives them back when it is known whether they are corners.

    The turn of a point is the angle between the directions from the last point at least the reach before it and to the
    first at least the reach behind it, so that short chords between rounded points do not count. Of several points
    within the reach the one with the largest turn is the corner.
    """

    def __init__(self, start: Point, path_axes: Sequence[int], path_dev: float, angle: float) -> None:
        """`angle`: rad, the largest turn that is smoothed."""
        self._path_axes = path_axes
        self._reach = min(WIDEST_REACH, REACH * path_dev)
        self._angle = angle
        self._known = [Vertex(start, 0.0, 0.0, 0, 0.0)]
        self._next = 1
        """Index of the first point that is not decided."""
        self._corner_place = 0.0

    @property
    def last(self) -> Vertex:
        return self._known[-1]

    def add(self, point: Point, length: float, block: int, feed: float) -> list[Vertex]:
        """The points that are decided now."""
        self._known.append(Vertex(point, self._known[-1].place + length, length, block, feed))
        decided = []
        ahead = self._known[-1].place - 2.0 * self._reach
        while self._next < len(self._known) - 1 and self._known[self._next].place <= ahead:
            decided.append(self._decide())
        if decided:
            self._forget()
        return decided

    def finish(self) -> list[Vertex]:
        """The rest; the last point is a corner."""
        decided = []
        while self._next < len(self._known) - 1:
            decided.append(self._decide())
        if self._next < len(self._known):
            self._known[-1].corner = True
            decided.append(self._known[-1])
        return decided

    def _decide(self) -> Vertex:
        index = self._next
        vertex = self._known[index]
        turn = self._turn(index)
        if turn > self._angle and self._is_largest(index, turn):
            vertex.corner = True
            self._corner_place = vertex.place
        self._next += 1
        return vertex

    def _is_largest(self, index: int, turn: float) -> bool:
        """No corner is less than the reach before it, no larger turn less than the reach behind it."""
        place = self._known[index].place
        if self._corner_place > 0.0 and place - self._corner_place < self._reach:
            return False
        other = index + 1
        while other < len(self._known) - 1 and self._known[other].place - place < self._reach:
            if self._turn(other) > turn:
                return False
            other += 1
        return True

    def _turn(self, index: int) -> float:
        """rad between the directions before and behind a point."""
        known, place = self._known, self._known[index].place
        before = index - 1
        while before > 0 and place - known[before].place < self._reach and known[before].place > self._corner_place:
            before -= 1
        behind = index + 1
        while behind < len(known) - 1 and known[behind].place - place < self._reach:
            behind += 1
        return angle_between(known[before].point, known[index].point, known[behind].point, self._path_axes)

    def _forget(self) -> None:
        """Keeps what the turn of the next point may need."""
        place = self._known[self._next].place - self._reach
        count = 0
        while count + 1 < self._next and self._known[count + 1].place <= place:
            count += 1
        if count > 0:
            del self._known[:count]
            self._next -= count


def angle_between(before: Point, here: Point, behind: Point, axes: Sequence[int]) -> float:
    """rad by which the direction changes at `here`; 0 if one of the three lies on another."""
    lengths = distance(before, here, axes) * distance(here, behind, axes)
    if lengths <= 0.0:
        return 0.0
    product = 0.0
    for axis in axes:
        product += (here[axis] - before[axis]) * (behind[axis] - here[axis])
    cosine = product / lengths
    if cosine >= 1.0:
        return 0.0
    return acos(cosine) if cosine > -1.0 else pi
