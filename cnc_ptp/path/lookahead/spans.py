"""A part of an element of a path, from one place of it to another: what trimming at the corners leaves of a block."""

from __future__ import annotations

from collections.abc import Sequence

from cnc_ptp.path.cubic import Cubic
from cnc_ptp.path.geometry import Arc, Line
from cnc_ptp.path.shape import AxisState, Bounds, Shape

Curve = Line | Arc | Cubic


class Span:
    """Part of an element.

    begin, end   of the part, by the parameter of the element (mm; deg if only rotary axes move)
    length       of the part: its own parameter u is 0 … `length`
    block        number of the program block to which it belongs
    """

    __slots__ = ("begin", "block", "element", "end", "length")

    def __init__(self, element: Curve, begin: float, end: float, block: int) -> None:
        self.element = element
        self.begin, self.end = begin, end
        self.length = end - begin
        self.block = block

    def place(self, u: float) -> float:
        """Parameter of the element at u; exactly the end at the end."""
        return self.end if u >= self.length else self.begin + u

    def shape(self, u: float) -> list[Shape]:
        """q, q1, q2, q3 of each axis at u."""
        return self.element.shape(self.place(u))

    def evaluate(self, u: float, v: float, a: float, j: float) -> tuple[AxisState, ...]:
        """State of each axis at u that moves with u' = v, u'' = a, u''' = j."""
        return self.element.evaluate(self.place(u), v, a, j)

    def bounds(self, begin: float, end: float) -> list[Bounds]:
        """Largest |q1|, |q2|, |q3| of each axis from u = `begin` to `end`."""
        return self.element.bounds(self.place(begin), self.place(end))

    def speed(self, u: float, axes: Sequence[int]) -> float:
        """|dq/du| of the given axes: the path velocity is u' times that."""
        return self.element.speed(self.place(u), axes)

    def largest_speed(self, begin: float, end: float, axes: Sequence[int]) -> float:
        """Largest |dq/du| of the given axes from u = `begin` to `end`; the same everywhere on lines and arcs."""
        element = self.element
        if isinstance(element, Cubic):
            return element.largest_speed(self.place(begin), self.place(end), axes)
        return self.speed(begin, axes)


def whole(element: Curve, block: int) -> Span:
    """All of an element."""
    return Span(element, 0.0, element.length, block)
