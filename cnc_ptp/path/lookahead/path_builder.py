"""Motions become parts of one path: each is linked to the one before it, by a corner curve or as it is.

Short blocks of #HSC become a smooth curve first, whose pieces are linked like motions. The last motion is kept back,
because what follows decides where it is left.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, sqrt
from typing import Final

from cnc_ptp.errors import CncError
from cnc_ptp.kinematics.kinematics import Kinematics, Point
from cnc_ptp.nc.contour import DEV, DIST, POS, Contour, Transition
from cnc_ptp.path.geometry import AxisLimits, Line
from cnc_ptp.path.lookahead.corners import LARGEST_BULGE, Corner, corner, kink_square, quiet_limits
from cnc_ptp.path.lookahead.parts import Geometry, PathPart
from cnc_ptp.path.lookahead.smoothing import Smoother
from cnc_ptp.path.lookahead.spans import Curve, Span, whole
from cnc_ptp.path.shape import Shape
from cnc_ptp.path.transformed_span import divided, positions, require_possible

SLOWEST: Final = 1.0
"""mm/s; a corner that could only be passed more slowly is an exact stop."""
KINK_CYCLES: Final = 3.0
"""Cycles on either side of a kink in which differences of the positions show it; there is no other one in them."""


class LinkedMotion:
    """A motion of the path: its element, the limits of the axes and the feed (mm/s, inf in rapid traverse).

    `shown`: the feed, in rapid traverse the velocity that the axes allow; `kinematics`: the element is Cartesian, and
    these are the axes; `room`: mm at its start that the curve of a corner may take, whatever its tolerance.
    """

    __slots__ = ("axes", "block", "feed", "kinematics", "room", "shown", "span", "transition")

    def __init__(
        self,
        element: Curve,
        axes: Sequence[AxisLimits],
        feed: float,
        block: int,
        transition: Transition,
        shown: float = inf,
        kinematics: Kinematics | None = None,
        room: float = inf,
    ) -> None:
        self.kinematics, self.room = kinematics, room
        self.span = whole(element, block)
        self.axes, self.feed, self.block = axes, feed, block
        self.shown = shown
        self.transition = transition


class PathBuilder:
    """Makes parts of motions that follow each other."""

    def __init__(self, path_axes: Sequence[int], cycle_time: float, start: Point = ()) -> None:
        """`path_axes`: those whose path the feed is for; `cycle_time` in s; `start`: machine position at the start."""
        self._path_axes, self._cycle_time = path_axes, cycle_time
        self.reached = start
        """Machine position at the end of the parts that are known, with kinematics."""
        self._last: LinkedMotion | None = None
        self._entry = inf
        """y with which the last motion may be entered."""
        self._quiet = 0.0
        """mm at its start that are near the kink there."""
        self._smoother: Smoother | None = None
        self._smoothed: LinkedMotion | None = None
        """The last motion that went into the smoother."""
        self._room = inf
        """mm of the first short block that a corner before the smooth curve may take; 0 until it is known."""

    def begin(self) -> None:
        """A path begins at rest."""
        self._last, self._entry, self._quiet = None, inf, 0.0
        self._smoother = None

    @property
    def kept(self) -> float:
        """Block of the motion that is kept back; all parts of blocks before it are known. inf without one."""
        return inf if self._last is None else self._last.block

    def passes(self, motion: LinkedMotion) -> bool:
        """False if the path has to stop before `motion`, whatever its velocity."""
        last = self._last
        if self._smoother is not None or motion.transition.smoothing is not None or last is None:
            # where a smooth curve begins and ends is known later; it may stop there
            return last is None or self._smoothes(motion) or self._possible(motion.span.shape(0.0), motion)
        return self._possible(last.span.shape(last.span.length), motion) and self._join(last, motion)[1] > 0.0

    def _possible(self, begin: Sequence[Shape], motion: LinkedMotion) -> bool:
        """The axes behind a kinematics can run `motion` from where they are at `begin`, of the programmed axes."""
        kinematics = motion.kinematics
        if kinematics is None:
            return True
        end = positions(kinematics.shape(begin, self.reached))
        try:
            require_possible(motion.span, kinematics, end)
        except CncError:
            return False  # reported when the path gets there
        return True

    def add(self, motion: LinkedMotion) -> list[PathPart]:
        """The parts that are known once `motion` follows."""
        parts: list[PathPart] = []
        before = self._smoothed
        smooth = self._smoothes(motion)
        if self._smoother is not None and (before is None or not smooth or not smoothed_together(before, motion)):
            parts = self._end_of_curve()
        smoothing, element = motion.transition.smoothing, motion.span.element
        if not smooth or smoothing is None or not isinstance(element, Line):
            return parts + self._link(motion)
        if self._smoother is None:
            self._smoother = Smoother(element.start, self._path_axes, smoothing.path_dev, smoothing.track_dev)
            self._room = 0.0
        if self._room == 0.0:
            self._room = 0.5 * element.length
        self._smoothed = motion
        self._smoother.add(element.target, motion.block, motion.feed)
        return parts + self._pieces()

    def _smoothes(self, motion: LinkedMotion) -> bool:
        """The motion becomes part of a smooth curve.

        Behind a kinematics only where the axes have a position everywhere within twice its deviation, not at the centre
        of a face: there it is run as it is.
        """
        smoothing, kinematics = motion.transition.smoothing, motion.kinematics
        if smoothing is None or motion.feed == inf or not isinstance(motion.span.element, Line):
            return False
        if kinematics is None:
            return True
        try:
            parts, _ = divided(motion.span, kinematics, self.reached)
        except CncError:
            return False
        return all(part.keeps_away(2.0 * smoothing.path_dev) for part in parts)

    def finish(self) -> list[PathPart]:
        """The rest: nothing follows."""
        parts = self._end_of_curve()
        last, self._last = self._last, None
        if last is not None and last.span.length > 0.0:
            parts += self._parts(last, last.span)
        return parts

    def _end_of_curve(self) -> list[PathPart]:
        if self._smoother is None:
            return []
        self._smoother.finish()
        parts = self._pieces()
        self._smoother = self._smoothed = None
        return parts

    def _pieces(self) -> list[PathPart]:
        """Those of the smooth curve that are finished."""
        parts: list[PathPart] = []
        smoother, motion = self._smoother, self._smoothed
        assert smoother is not None and motion is not None
        for piece in smoother.take():
            made = LinkedMotion(
                piece.geometry, motion.axes, piece.feed, piece.block, motion.transition,
                kinematics=motion.kinematics, room=self._room,
            )  # fmt: skip
            self._room = inf
            parts += self._link(made)
        return parts

    def _link(self, motion: LinkedMotion) -> list[PathPart]:
        """A kink that cannot be passed is an exact stop."""
        last, self._last = self._last, motion
        if last is None:
            return []
        made, square = self._join(last, motion)
        if made is not None:
            before, curve, motion.span = made
            spans = [before, *curve] if before.length > 0.0 else curve
            of_spans = [self._parts(last if span.block == last.block else motion, span) for span in spans]
            for part in of_spans[-2] if curve else ():
                part.feed = min(last.feed, motion.feed)  # the corner is within the middle piece
            return [part for parts in of_spans for part in parts]
        quiet = KINK_CYCLES * self._cycle_time * sqrt(square) if square < inf else 0.0
        parts = self._parts(last, last.span, quiet)
        self._entry, self._quiet = square, quiet
        return parts

    def _join(self, last: LinkedMotion, motion: LinkedMotion) -> tuple[Corner | None, float]:
        """The curve between two motions, or else the y with which the kink can be passed; 0 is an exact stop."""
        made = corner_between(last, motion, self._path_axes)
        if made is not None and self._passable(made, motion.kinematics):
            return made, inf
        limits = last.axes if last.axes is motion.axes else narrower(last.axes, motion.axes)
        square = kink_square(last.span, motion.span, limits, self._cycle_time, motion.kinematics, self.reached)
        if square < inf:
            alone = min(last.span.length, motion.span.length) / (KINK_CYCLES * self._cycle_time)
            square = min(square, alone * alone)
        return None, square if square >= SLOWEST * SLOWEST else 0.0

    def _passable(self, made: Corner, kinematics: Kinematics | None) -> bool:
        """The axes of the machine have a position everywhere on the curve."""
        if kinematics is None:
            return True
        try:
            for piece in made[1]:
                divided(piece, kinematics, self.reached)
        except CncError:
            return False
        return True

    def _parts(self, motion: LinkedMotion, span: Span, quiet: float = 0.0) -> list[PathPart]:
        """One, with kinematics several; none without length. `quiet`: mm at its end that are near a kink."""
        entry, self._entry = self._entry, inf
        (before, behind), self._quiet = (self._quiet, quiet), 0.0
        if span.length <= 0.0:
            return []
        axes = quiet_limits(motion.axes, self._cycle_time) if before or behind else ()
        pieces: Sequence[Geometry] = [span]
        if motion.kinematics is not None:
            pieces, self.reached = divided(span, motion.kinematics, self.reached)
        parts: list[PathPart] = []
        place = 0.0
        for piece in pieces:
            left = span.length - place - piece.length
            near = max(0.0, before - place), max(0.0, behind - left)
            part = PathPart(
                piece, motion.axes, self._path_axes, motion.feed, span.block, entry, near, axes,
                transformed=motion.kinematics is not None,
            )  # fmt: skip
            parts.append(part)
            entry, place = inf, place + piece.length
        return parts


def corner_between(last: LinkedMotion, motion: LinkedMotion, path_axes: Sequence[int]) -> Corner | None:
    """The curve between two motions by the contouring of the first; None where there can be none.

    Before a smooth curve it is within half of the first short block. Over more of them only within what their own
    contouring permits, because it passes their ends at a distance.
    """
    contour, following = last.transition.contour, motion.transition.contour
    if contour is None:
        return None
    if motion.room == inf or following == contour:
        return corner(last.span, motion.span, contour, path_axes)
    short = corner(last.span, motion.span, contour, path_axes, motion.room)
    if following is None or POS in (contour.mode, following.mode):
        return short
    path_dev = min(permitted_deviation(contour), permitted_deviation(following))
    both = contour._replace(mode=DEV, path_dev=path_dev, track_dev=min(contour.track_dev, following.track_dev))
    most = min(contour.pre_dist, contour.post_dist) if contour.mode == DIST else inf
    long = corner(last.span, motion.span, both, path_axes, most)
    return long if short is None or (long is not None and long[2].begin > short[2].begin) else short


def permitted_deviation(contour: Contour) -> float:
    """mm by which contouring with DEV or DIST may leave the path at the end of a block."""
    if contour.mode == DEV:
        return contour.path_dev
    return LARGEST_BULGE * min(contour.pre_dist, contour.post_dist)


def smoothed_together(motion: LinkedMotion, following: LinkedMotion) -> bool:
    """Two motions of one smooth curve; a corner on it takes part of several of them, so they have one contour."""
    (_, contour, smoothing), (_, other, others) = motion.transition, following.transition
    alike = smoothing == others and contour == other and following.feed < inf
    alike = alike and following.kinematics == motion.kinematics
    return alike and isinstance(following.span.element, Line)


def narrower(axes: Sequence[AxisLimits], others: Sequence[AxisLimits]) -> list[AxisLimits]:
    """The smaller limits of each axis."""
    pairs = zip(axes, others, strict=True)
    return [AxisLimits(*[min(pair) for pair in zip(one, other, strict=True)]) for one, other in pairs]
