"""Motions become parts of one path: each is linked to the one before it, by a corner curve or as it is.

The last motion is kept back, because what follows decides where it is left.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import Final

from cnc_ptp.nc.contour import Contour
from cnc_ptp.path.geometry import AxisLimits
from cnc_ptp.path.lookahead.corners import corner, kink_square
from cnc_ptp.path.lookahead.parts import PathPart
from cnc_ptp.path.lookahead.spans import Curve, Span, whole

SLOWEST: Final = 1.0
"""mm/s; a corner that could only be passed more slowly is an exact stop."""


class LinkedMotion:
    """A motion of the path: its element, the limits of the axes and the feed (mm/s, inf in rapid traverse)."""

    __slots__ = ("axes", "feed", "span")

    def __init__(self, element: Curve, axes: Sequence[AxisLimits], feed: float, block: int) -> None:
        self.span = whole(element, block)
        self.axes, self.feed = axes, feed


class PathBuilder:
    """Makes parts of motions that follow each other."""

    def __init__(self, path_axes: Sequence[int], cycle_time: float) -> None:
        """`path_axes`: those whose path the feed is for; `cycle_time` in s."""
        self._path_axes, self._cycle_time = path_axes, cycle_time
        self._last: LinkedMotion | None = None
        self._entry = inf
        """y with which the last motion may be entered."""

    def begin(self, motion: LinkedMotion) -> None:
        """The first motion, from rest."""
        self._last, self._entry = motion, inf

    def link(self, motion: LinkedMotion, contour: Contour | None) -> list[PathPart]:
        """The parts that are known once `motion` follows; a kink that cannot be passed is an exact stop."""
        last = self._last
        assert last is not None
        if contour is not None:
            made = corner(last.span, motion.span, contour, self._path_axes)
            if made is not None:
                before, curve, after = made
                spans = [before, *curve] if before.length > 0.0 else curve
                parts = [self._part(last if span.block == last.span.block else motion, span) for span in spans]
                motion.span = after
                self._last = motion
                return parts
        square = kink_square(last.span, motion.span, narrower(last.axes, motion.axes), self._cycle_time)
        parts = [self._part(last, last.span)]
        self._last, self._entry = motion, square if square >= SLOWEST * SLOWEST else 0.0
        return parts

    def finish(self) -> list[PathPart]:
        """The last motion: nothing follows it."""
        last, self._last = self._last, None
        return [] if last is None or last.span.length <= 0.0 else [self._part(last, last.span)]

    def _part(self, motion: LinkedMotion, span: Span) -> PathPart:
        entry, self._entry = self._entry, inf
        return PathPart(span, motion.axes, self._path_axes, motion.feed, span.block, entry)


def narrower(axes: Sequence[AxisLimits], others: Sequence[AxisLimits]) -> list[AxisLimits]:
    """The smaller limits of each axis."""
    return [
        AxisLimits(*[min(pair) for pair in zip(one, other, strict=True)])
        for one, other in zip(axes, others, strict=True)
    ]
