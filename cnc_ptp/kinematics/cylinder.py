"""Machining of a cylinder's lateral surface with a C axis: #CYL [Z, C, X60] (TF5200 spindle 2.8.8).

A word of C is the length of arc in mm on the cylinder; the axis turns by 180/(π·R) degrees for each of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, radians
from typing import NamedTuple

from cnc_ptp.kinematics.kinematics import Bounds, Point, Reasons, Shape
from cnc_ptp.kinematics.way import Way


class Cylinder(NamedTuple):
    """The unrolled surface.

    first, c   places of the axes
    radius     of the cylinder, mm
    origin     machine position of the programmed zero point
    names      of the two axes, and of the one in which the radius is measured
    """

    first: int
    c: int
    radius: float
    origin: Point
    names: tuple[str, str, str] = ("Z", "C", "X")

    @property
    def name(self) -> str:
        first, c, radial = self.names
        return f"#CYL [{first}, {c}, {radial}{self.radius:g}]"

    @property
    def plane(self) -> tuple[int, int]:
        return self.first, self.c

    @property
    def likeness(self) -> tuple[int, float]:
        return self.c, radians(self.radius)

    @property
    def reasons(self) -> Reasons:
        return Reasons()

    def forward(self, machine: Point) -> Point:
        point = [m - o for m, o in zip(machine, self.origin, strict=True)]
        point[self.c] *= radians(self.radius)
        return tuple(point)

    def inverse(self, programmed: Point, near: Point) -> Point:
        point = list(programmed)
        point[self.c] /= radians(self.radius)
        return tuple([p + o for p, o in zip(point, self.origin, strict=True)])

    def shape(self, programmed: Sequence[Shape], near: Point) -> list[Shape]:
        turn = degrees(1.0) / self.radius
        shape = [(q + o, q1, q2, q3) for (q, q1, q2, q3), o in zip(programmed, self.origin, strict=True)]
        q, q1, q2, q3 = programmed[self.c]
        shape[self.c] = (q * turn + self.origin[self.c], q1 * turn, q2 * turn, q3 * turn)
        return shape

    def possible(self, way: Way) -> bool:
        return True

    def permits(self, machine: Point) -> bool:
        return True

    def fits(self, middle: Sequence[Shape], reach: Sequence[Bounds], half: float) -> bool:
        return True

    def bounds(self, middle: Sequence[Shape], reach: Sequence[Bounds], half: float, near: Point) -> list[Bounds]:
        turn = degrees(1.0) / self.radius
        bounds = list(reach)
        q1, q2, q3 = reach[self.c]
        bounds[self.c] = (q1 * turn, q2 * turn, q3 * turn)
        return bounds
