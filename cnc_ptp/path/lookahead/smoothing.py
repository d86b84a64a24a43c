"""Many short blocks become a smooth curve: `#HSC ON [BSPLINE PATH_DEV=…]`.

Points go in one by one, cubic pieces come out as soon as they no longer depend on points to come. The curve has
continuous position, direction and curvature (q, q1, q2) from one corner to the next, and every point and every middle
of a chord is within the deviation of it. Corners and long lines stay what they are. docs/path.md has the mathematics.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import radians
from typing import Final, NamedTuple

from cnc_ptp.path.cubic import Cubic
from cnc_ptp.path.geometry import NEGLIGIBLE_MM
from cnc_ptp.path.lookahead.polyline import Point, Polyline, distance
from cnc_ptp.path.lookahead.polyline_corners import CornerFinder, Vertex
from cnc_ptp.path.lookahead.smooth_curve import KnotSpan, SmoothCurve, Tolerance

LONGEST_SPAN: Final = 2.0
"""mm of a piece of the curve at most; longer ones would follow the points no better and need more of them ahead."""
CORNER_ANGLE: Final = radians(36.0)
"""Largest turn that is smoothed. Chords on the smallest radii that CAM systems write turn by less."""
LONG_LINE: Final = 4.0
"""A chord of that many longest spans is a straight line, but for its last spans on both sides."""
STANDSTILL: Final = 1e-6
"""mm: where the path axes move less, the path is that of the other axes, and straight."""
LEAST_PART: Final = 1e-3
"""A change of the feed nearer than this part of a piece to its end takes effect there."""

STRAIGHT: Final = 1e-9
"""Less change of q1 over a piece, or less q2 (1/mm), is rounding."""


class SmoothPiece(NamedTuple):
    """A piece of the path: over the block at its middle, with the feed of all of it.

    ends   the curve ends here: what follows begins with another direction, or nothing follows
    """

    geometry: Cubic
    block: int
    feed: float
    ends: bool


class Smoother:
    """Points in, pieces out; what it keeps does not grow.

    path_axes     indices of the axes of the path; with them u is nearly the path length
    path_dev      mm, above 0: largest distance of the curve over the path axes
    track_dev     mm or deg: the same for each other axis; 0: not limited
    corner_angle  rad
    """

    def __init__(
        self,
        start: Point,
        path_axes: Sequence[int],
        path_dev: float,
        track_dev: float,
        *,
        corner_angle: float = CORNER_ANGLE,
        longest: float = LONGEST_SPAN,
    ) -> None:
        self._path_axes = list(path_axes)
        self._all_axes = list(range(len(start)))
        self._tolerance = Tolerance(len(start), path_axes, path_dev, track_dev)
        self._corner_angle = corner_angle
        self._longest = longest
        self._last: Point = tuple(start)
        """The point that was added last."""
        self._from: Point = self._last
        """The point up to which it is known where the corners are."""
        self._finder: CornerFinder | None = None
        self._curve: SmoothCurve | None = None
        self._pieces: list[SmoothPiece] = []

    def add(self, target: Point, block: int, feed: float) -> None:
        """The next point, with number and feed of the block that ends there; left out where nothing moves."""
        length = distance(self._last, target, self._path_axes)
        if length < STANDSTILL:
            whole = distance(self._last, target, self._all_axes)
            if whole < NEGLIGIBLE_MM:
                return
            self.finish()
            self._give_line(self._last, target, whole, block, feed, ends=True)
            self._from = self._last = tuple(target)
            return
        if self._finder is None:
            self._finder = CornerFinder(self._last, self._path_axes, self._tolerance.path_dev, self._corner_angle)
        self._last = tuple(target)
        for vertex in self._finder.add(self._last, length, block, feed):
            self._continue_to(vertex)

    def finish(self) -> None:
        """The path ends at the last point; what is added afterwards begins there."""
        if self._finder is not None:
            for vertex in self._finder.finish():
                self._continue_to(vertex)
            self._finder = None

    def take(self) -> list[SmoothPiece]:
        """The pieces that are finished since the last call."""
        pieces, self._pieces = self._pieces, []
        return pieces

    def _continue_to(self, vertex: Vertex) -> None:
        begin, self._from = self._from, vertex.point
        if vertex.length >= LONG_LINE * self._longest or (self._curve is None and vertex.corner):
            self._add_line(begin, vertex)
            return
        curve = self._curve
        if curve is None:
            curve = self._curve = self._new_curve(begin, None, vertex)
        curve.polyline.append(vertex.point, vertex.length, vertex.block, vertex.feed)
        if vertex.corner:
            self._close(curve, None)
        else:
            self._give_spans(curve, curve.advance(), ends=False)

    def _new_curve(self, start: Point, direction: Sequence[float] | None, vertex: Vertex) -> SmoothCurve:
        return SmoothCurve(Polyline(start, vertex.block, vertex.feed), self._tolerance, self._longest, direction)

    def _close(self, curve: SmoothCurve, direction: Sequence[float] | None) -> None:
        self._give_spans(curve, curve.close(direction), ends=direction is None)
        self._curve = None

    def _add_line(self, begin: Point, vertex: Vertex) -> None:
        """A long chord: the curve before it merges within the first longest span, the next one leaves in the last."""
        length, end = vertex.length, vertex.point
        direction = [(b - a) / length for a, b in zip(begin, end, strict=True)]
        start, rest = begin, length
        if self._curve is not None:
            start = [a + d * self._longest for a, d in zip(begin, direction, strict=True)]
            self._curve.polyline.append(start, self._longest, vertex.block, vertex.feed)
            self._close(self._curve, direction)
            rest -= self._longest
        if vertex.corner:
            self._give_line(start, end, rest, vertex.block, vertex.feed, ends=True)
            return
        leave = [b - d * self._longest for b, d in zip(end, direction, strict=True)]
        self._give_line(start, leave, rest - self._longest, vertex.block, vertex.feed, ends=False)
        self._curve = self._new_curve(leave, direction, vertex)
        self._curve.polyline.append(end, self._longest, vertex.block, vertex.feed)

    def _give_line(self, begin: Point, end: Point, length: float, block: int, feed: float, *, ends: bool) -> None:
        start = [(a, (b - a) / length, 0.0, 0.0) for a, b in zip(begin, end, strict=True)]
        self._pieces.append(SmoothPiece(Cubic(start, length), block, feed, ends))

    def _give_spans(self, curve: SmoothCurve, spans: Sequence[KnotSpan], *, ends: bool) -> None:
        for index, span in enumerate(spans):
            self._give_span(curve.polyline, span, ends=ends and index == len(spans) - 1)
        curve.polyline.forget(curve.begin)

    def _give_span(self, polyline: Polyline, span: KnotSpan, *, ends: bool) -> None:
        """The piece of a span; several where the feed changes."""
        changes = feed_changes(polyline, span)
        begin = span.begin
        whole = cubic_of(span.piece, span.length)
        for number, end in enumerate(changes):
            piece = whole
            if len(changes) > 1:
                piece = Cubic(whole.shape(begin - span.begin), end - begin)
            chord = polyline.chord_at(0.5 * (begin + end))
            ended = ends and number == len(changes) - 1
            self._pieces.append(SmoothPiece(piece, polyline.blocks[chord], polyline.feeds[chord], ended))
            begin = end


def feed_changes(polyline: Polyline, span: KnotSpan) -> list[float]:
    """Places within a span where the feed changes, and its end."""
    changes: list[float] = []
    near = LEAST_PART * span.length
    low = span.begin
    index = polyline.chord_at(span.begin)
    while index < len(polyline.places) - 1 and polyline.places[index] < span.end - near:
        place = polyline.places[index]
        if polyline.feeds[index + 1] != polyline.feeds[index] and place > low + near:
            changes.append(place)
            low = place
        index += 1
    changes.append(span.end)
    return changes


def cubic_of(piece: Sequence[float], length: float) -> Cubic:
    """Straight where the piece is so but for rounding: the planner has less to do there."""
    shapes = [(piece[i], piece[i + 1], piece[i + 2], piece[i + 3]) for i in range(0, len(piece), 4)]
    for _, _, q2, q3 in shapes:
        if (abs(q2) + abs(q3) * length) * max(length, 1.0) > STRAIGHT:
            return Cubic(shapes, length)
    return Cubic([(q, q1 + length * (0.5 * q2 + length * q3 / 6.0), 0.0, 0.0) for q, q1, q2, q3 in shapes], length)
