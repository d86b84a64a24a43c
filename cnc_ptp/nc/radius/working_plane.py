"""The plane in which the radius is compensated, within machine coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, radians
from typing import Final, NamedTuple

from cnc_ptp.nc.canonical import CircularMove, Direction, LinearMove
from cnc_ptp.nc.coordinates.frame import Frame, dot
from cnc_ptp.nc.radius.shapes import Line, Point, Shape, arc_through

ALONG: Final = 1e-12
"""A direction with a smaller part across a plane is in it."""


class WorkingPlane(NamedTuple):
    """`axes`: places of its two axes; `directions`: where they point if the plane is tilted in the machine."""

    axes: tuple[int, int]
    directions: tuple[Direction, Direction] | None = None

    def coordinates(self, position: Sequence[float]) -> Point:
        """Of a machine position in the plane, mm."""
        if self.directions is None:
            return position[self.axes[0]], position[self.axes[1]]
        return dot(position, self.directions[0]), dot(position, self.directions[1])

    def position(self, point: Point, beside: Sequence[float]) -> tuple[float, ...]:
        """The machine position with these coordinates, across the plane that of `beside`."""
        if self.directions is None:
            placed = list(beside)
            placed[self.axes[0]], placed[self.axes[1]] = point
            return tuple(placed)
        first, second = self.coordinates(beside)
        along, across = point[0] - first, point[1] - second
        return tuple([b + along * u + across * v for b, u, v in zip(beside, *self.directions, strict=True)])

    def shape(self, start: Sequence[float], motion: LinearMove | CircularMove) -> Shape:
        """What a motion from `start` (machine coordinates) is in the plane."""
        begin = self.coordinates(start)
        if isinstance(motion, LinearMove):
            return Line(begin, self.coordinates(motion.target))
        if self.directions is None or motion.directions is None:
            return arc_through(motion.center, begin, radians(motion.sweep))
        centre = tuple([motion.center[0] * u + motion.center[1] * v for u, v in zip(*motion.directions, strict=True)])
        (a, b), (c, d) = (self.coordinates(direction) for direction in motion.directions)
        turn = 1.0 if a * d - b * c > 0.0 else -1.0
        return arc_through(self.coordinates(centre), begin, turn * radians(motion.sweep))

    def handedness(self, frame: Frame | None) -> int:
        """-1 if the frame mirrors the plane, so that left becomes right, else 1."""
        if frame is None or not frame.turned:
            return 1
        (a, b), (c, d) = (self.coordinates(column(frame, axis)) for axis in self.axes)
        return 1 if a * d - b * c > 0.0 else -1


def working_plane(frame: Frame | None, first: int, second: int) -> WorkingPlane | None:
    """The programmed plane of two axes; None if it is tilted and what is square in it is not square in the machine.

    So it is where only one of them is turned: X of #FACE.
    """
    if frame is None or not frame.turned:
        return WorkingPlane((first, second))
    u, v = column(frame, first), column(frame, second)
    across = [abs(x) + abs(y) for axis, (x, y) in enumerate(zip(u, v, strict=True)) if axis not in (first, second)]
    if max(across, default=0.0) <= ALONG * hypot(*u, *v):
        return WorkingPlane((first, second))
    circle = frame.circle(first, second) if second in frame.main else None
    return None if circle is None else WorkingPlane((first, second), circle.directions)


def column(frame: Frame, axis: int) -> tuple[float, ...]:
    """Where a programmed millimetre of an axis goes in the machine, one value for each axis; C is no main axis."""
    if axis not in frame.main:
        return tuple([1.0 if index == axis else 0.0 for index in range(len(frame.shift))])
    place = frame.main.index(axis)
    parts = {index: frame.linear[row][place] for row, index in enumerate(frame.main) if index >= 0}
    return tuple([parts.get(index, 0.0) for index in range(len(frame.shift))])
