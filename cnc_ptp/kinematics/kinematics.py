"""What a kinematics has to offer: programmed (Cartesian) positions, machine positions, and derivatives along a path.

A new one is a file with a class like `Face` or `Cylinder`, and a command that switches it on (nc/transformations.py).
Lengths in mm, angles in degrees; a point has one value for each axis of the path, in its order.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

from cnc_ptp.kinematics.way import Point as Point
from cnc_ptp.kinematics.way import Shape as Shape
from cnc_ptp.kinematics.way import Way

Bounds = tuple[float, float, float]
"""Largest |q1|, |q2|, |q3| of one axis over a part of the path."""


class Reasons(NamedTuple):
    """Why a path is refused, for the texts of errors: the path …

    impossible  goes through …, when the program is read
    none        comes to …, where the axes have no position
    forbidden   goes through …, where `permits` says no
    elsewhere   leaves …, where the axes are not at its start
    """

    impossible: str = "places at which the machine has no position"
    none: str = "a place at which the machine has no position"
    forbidden: str = "a place at which the machine must not be"
    elsewhere: str = "from a place at which the machine is not"


class Kinematics(Protocol):
    """Between programmed and machine axes; it is never changed."""

    @property
    def name(self) -> str:
        """As programs switch it on: #FACE [X, C]."""

    @property
    def plane(self) -> tuple[int, int]:
        """Places of the two axes whose words are Cartesian, in mm."""

    @property
    def likeness(self) -> tuple[int, float]:
        """For estimates: the axis whose limits the second axis of the plane has, and mm in one unit of that axis."""

    @property
    def origin(self) -> Point:
        """Machine position of the programmed zero point."""

    @property
    def reasons(self) -> Reasons:
        """For the texts of errors."""

    def forward(self, machine: Point) -> Point:
        """The programmed point of a machine position."""

    def inverse(self, programmed: Point, near: Point) -> Point:
        """The machine position of a programmed point, as near as it can be to `near`."""

    def shape(self, programmed: Sequence[Shape], near: Point) -> list[Shape]:
        """Of the machine axes, from that of the programmed ones at a place; `near`: a machine position beside it."""

    def possible(self, way: Way) -> bool:
        """The axes can go a whole programmed motion; looked at when the program is read."""

    def permits(self, machine: Point) -> bool:
        """The axes may be there; soft limits are not meant."""

    def fits(self, middle: Sequence[Shape], reach: Sequence[Bounds], half: float) -> bool:
        """`bounds` are good for all places up to `half` beside the middle; else they need shorter parts."""

    def bounds(self, middle: Sequence[Shape], reach: Sequence[Bounds], half: float, near: Point) -> list[Bounds]:
        """Of the machine axes, up to `half` beside a place with the programmed shape `middle`.

        `reach`: those of the programmed axes there.
        """
