"""A part of a path that is Cartesian for the program and curved for the axes of the machine (kinematics/).

It is as short as the kinematics needs it: near the centre of a face the parts become short, so that what they permit
differs from part to part and the path slows down there alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from cnc_ptp.errors import CncError
from cnc_ptp.kinematics.kinematics import Kinematics, Point
from cnc_ptp.path.lookahead.spans import Span
from cnc_ptp.path.shape import AxisState, Bounds, Shape

SHORTEST: Final = 1e-8
"""mm; a shorter part of a path does not come away from the place where the axes have no position."""
NO_POSITION: Final = 22121
ANGLE_AT_CENTRE: Final = 22122
SAME_POSITION: Final = 1e-4
"""mm or deg by which the axes may miss the start of a motion."""


class TransformedSpan:
    """From `begin` to `end` of a Cartesian span, as the axes of the machine see it; as parts.py Geometry asks.

    length   of the part: its own parameter u is 0 … `length`, that of the Cartesian path
    block    number of the program block to which it belongs
    """

    __slots__ = ("_begin", "_kinematics", "_near", "_span", "block", "length")

    def __init__(self, span: Span, begin: float, end: float, kinematics: Kinematics, near: Point) -> None:
        """`near`: machine position in its middle."""
        self._span, self._begin, self._kinematics, self._near = span, begin, kinematics, near
        self.length = end - begin
        self.block = span.block

    def shape(self, u: float) -> list[Shape]:
        """q, q1, q2, q3 of each machine axis at u."""
        return self._kinematics.shape(self._span.shape(self._begin + u), self._near)

    def bounds(self, begin: float, end: float) -> list[Bounds]:
        """Largest |q1|, |q2|, |q3| of each machine axis from u = `begin` to `end`."""
        begin, end = self._begin + begin, self._begin + end
        half = 0.5 * (end - begin)
        middle, reach = self._span.shape(begin + half), self._span.bounds(begin, end)
        return self._kinematics.bounds(middle, reach, half, self._near)

    def keeps_away(self, distance: float) -> bool:
        """`bounds` would be good for places at this distance (mm) beside the part, too."""
        quarter = 0.25 * self.length
        return all(
            self._kinematics.fits(
                self._span.shape(self._begin + place),
                self._span.bounds(self._begin + place - quarter, self._begin + place + quarter),
                quarter + distance,
            )
            for place in (quarter, 3.0 * quarter)
        )

    def speed(self, u: float, axes: Sequence[int]) -> float:
        """|dq/du| of the given axes on the Cartesian path."""
        return self._span.speed(self._begin + u, axes)

    def largest_speed(self, begin: float, end: float, axes: Sequence[int]) -> float:
        """The largest of it: feeds are those of the Cartesian path."""
        return self._span.largest_speed(self._begin + begin, self._begin + end, axes)

    def evaluate(self, u: float, v: float, a: float, j: float) -> tuple[AxisState, ...]:
        """State of each machine axis at u that moves with u' = v, u'' = a, u''' = j."""
        square, cube, cross = v * v, v * v * v, 3.0 * v * a
        return tuple(
            [(q, q1 * v, q1 * a + q2 * square, q1 * j + q2 * cross + q3 * cube) for q, q1, q2, q3 in self.shape(u)]
        )


def divided(span: Span, kinematics: Kinematics, near: Point) -> tuple[list[TransformedSpan], Point]:
    """The parts of a span that begins at the machine position `near`, and the machine position of its end.

    Raises CncError 22121 where the path comes to a place at which the machine has none.
    """
    parts: list[TransformedSpan] = []
    waiting = [(0.0, span.length)]
    while waiting:
        begin, end = waiting.pop()
        half = 0.5 * (end - begin)
        middle = span.shape(begin + half)
        if not kinematics.fits(middle, span.bounds(begin, end), half):
            if half < SHORTEST:
                raise CncError(NO_POSITION, f"the path of {kinematics.name} comes to {kinematics.reasons.none}")
            waiting += [(begin + half, end), (begin, begin + half)]
            continue
        near = positions(kinematics.shape(middle, near))
        parts.append(TransformedSpan(span, begin, end, kinematics, near))
    return parts, positions(kinematics.shape(span.shape(span.length), near))


def require_possible(span: Span, kinematics: Kinematics, start: Point) -> None:
    """The axes, which are at `start`, can run a whole span.

    Raises CncError 22121 where they have no position on it, 22122 if they are not at its start: at the centre of a face
    they may have any angle.
    """
    end = divided(span, kinematics, start)[1]
    if not kinematics.permits(end):
        raise CncError(NO_POSITION, f"the path of {kinematics.name} goes through {kinematics.reasons.forbidden}")
    begin = positions(kinematics.shape(span.shape(0.0), start))
    reached = kinematics.forward(end)
    wrong = [abs(a - b) for a, b in zip((*begin, *reached), (*start, *positions(span.shape(span.length))), strict=True)]
    if max(wrong) > SAME_POSITION:
        raise CncError(ANGLE_AT_CENTRE, f"the path of {kinematics.name} leaves {kinematics.reasons.elsewhere}")


def positions(shape: Sequence[Shape]) -> Point:
    """Of all axes."""
    return tuple([q for q, _, _, _ in shape])
