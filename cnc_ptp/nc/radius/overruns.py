"""Overruns of a closed contour: what a program adds before its start and behind its end.

A contour often begins with a piece that leads to it, and ends with one that leads away: a line that is longer than its
edge, or an arc to the first edge. They bound nothing of the part, so the tool may come near them on its way around;
where the tool itself is on them, it must be clear of the part. The contour closes where an element meets the first one
again. To be sure, nothing but its first element may lie before that point and nothing but the rest of that element and
one more behind it; they are shorter than the edges between, which do not cross or lead back along themselves, arcs of
half a turn at most, and meet neither the edges nor each other elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, pairwise
from math import fsum, pi
from typing import Final, NamedTuple

from cnc_ptp.nc.radius.corners import OPPOSITE
from cnc_ptp.nc.radius.shapes import Arc, Point, Shape, distance, intersections, turn_between

SAME_POINT: Final = 1e-4
"""mm: points nearer to each other than this are one (the vendor's position increment)."""
HALF_TURN: Final = pi + 1e-6
"""Radians of an arc that leads to a contour or from it, at most."""


class Closing(NamedTuple):
    """Where a contour closes.

    begin   place on its first element, from which on that is an edge of the part
    last    number of the element that meets the first one there
    end     place on that element up to which it is an edge
    """

    begin: float
    last: int
    end: float

    def edge(self, owner: int, other: int, shapes: Sequence[Shape]) -> Shape | None:
        """What of an element counts for the path along another one; None: nothing."""
        shape = shapes[other]
        if other > self.last or (other == 0 and self.begin == 1.0):
            return None if self._is_edge(owner) or self._lie_apart(owner, other) else shape
        if other == 0 and owner:
            return part(shape, self.begin, 1.0)
        if other == self.last and owner != other:
            return part(shape, 0.0, self.end)
        return shape

    def edges(self, shapes: Sequence[Shape]) -> list[Shape]:
        """From where the contour closes to there again."""
        inner = shapes[1 : self.last]
        found = [part(shapes[0], self.begin, 1.0), *inner, part(shapes[self.last], 0.0, self.end)]
        return [each for each in found if each is not None]

    def overruns(self, shapes: Sequence[Shape]) -> list[Shape]:
        """Before that and behind it."""
        rest = part(shapes[self.last], self.end, 1.0)
        found = [part(shapes[0], 0.0, self.begin), rest, *shapes[self.last + 1 :]]
        return [each for each in found if each is not None]

    def points(self, shapes: Sequence[Shape]) -> list[Point]:
        """Where overruns may meet edges: where the contour closes, and the end of an overrun along the first edge."""
        found = [shapes[0].point(self.begin)]
        rest, edges = part(shapes[self.last], self.end, 1.0), self.edges(shapes)
        if rest is not None and edges and edges[0].distance(rest.point(0.5)) < SAME_POINT:
            found.append(rest.end)
        return found

    def _is_edge(self, number: int) -> bool:
        return number <= self.last and (number > 0 or self.begin < 1.0)

    def _lie_apart(self, one: int, other: int) -> bool:
        """Of two that are no edges: one before the loop, one behind it."""
        return (one == 0) != (other == 0)


def closing(shapes: Sequence[Shape], *, complete: bool) -> Closing | None:
    """Of the elements of a contour; None for one that does not close, or whose overruns may be more than that.

    `complete`: none is missing behind the first one.
    """
    for last in range(max(1, len(shapes) - 2), len(shapes)):
        for begin, end in meetings(shapes[0], shapes[last], adjacent=complete and last == 1):
            found = Closing(begin, last, end)
            if _is_sure(found.edges(shapes), found.overruns(shapes), found.points(shapes)):
                return found
    return None


def _is_sure(edges: Sequence[Shape], overruns: Sequence[Shape], points: Sequence[Point]) -> bool:
    """Whether edges bound an area, and overruns are short and meet them at these points alone."""
    if fsum(each.length for each in overruns) > fsum(each.length for each in edges):
        return False
    if any(isinstance(each, Arc) and abs(each.sweep) > HALF_TURN for each in overruns):
        return False
    if any(not _meet_only_at(points, overrun, edge) for overrun in overruns for edge in edges):
        return False
    if any(not _meet_only_at(points, one, other) for one, other in combinations(overruns, 2)):
        return False
    if any(abs(turn_between(a.last_direction, b.first_direction)) > OPPOSITE for a, b in pairwise(edges)):
        return False
    pairs = [(one, other) for place, one in enumerate(edges) for other in edges[place + 2 :]]
    return bool(edges) and all(_meet_only_at(points[:1], one, other) for one, other in pairs)


def meetings(first: Shape, later: Shape, *, adjacent: bool) -> Iterator[tuple[float, float]]:
    """Places on both where a later element meets the first one; `adjacent`: it begins at its end anyway."""
    if distance(first.end, later.end) < SAME_POINT:
        yield 1.0, 1.0
    elif not adjacent and later.distance(first.end) < SAME_POINT:
        yield 1.0, min(1.0, max(0.0, later.place(first.end)))
    if not adjacent:
        yield from intersections(first, later)


def _meet_only_at(points: Sequence[Point], one: Shape, other: Shape) -> bool:
    found = [one.point(place) for place, _ in intersections(one, other)]
    return all(any(distance(each, point) < SAME_POINT for point in points) for each in found)


def part(shape: Shape, begin: float, end: float) -> Shape | None:
    """Between two places; None for a point."""
    if (end - begin) * shape.length < SAME_POINT:
        return None
    return shape.part(begin, end)
