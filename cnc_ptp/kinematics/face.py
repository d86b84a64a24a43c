"""Face machining with a C axis: #FACE [X, C] (TF5200 spindle 2.8.8, P-CHAN-00008).

Words of X and C are Cartesian x and y on the face. With z = x + i·y the radius is |z| and the angle that of z. Both
come from w = ln z: its real part is ln r, its imaginary part the angle in rad, and along a path

    w' = z'/z      w'' = z''/z - w'²      w''' = z'''/z - 3·w'·w'' - w'³

From them r' = r·a', r'' = r·(a'' + a'²), r''' = r·(a''' + 3·a'·a'' + a'³), where a is the real part of w. On a line
through the centre the angle stays, and the radius changes its sign there.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import atan2, cos, degrees, radians, sin
from typing import Final, NamedTuple

from cnc_ptp.kinematics.kinematics import Bounds, Point, Reasons, Shape
from cnc_ptp.kinematics.way import Way

CENTRE: Final = 1e-6
"""mm; nearer to the centre of rotation a point has no angle."""
AT_CENTRE: Final = "the centre of rotation, where the C axis has no angle"
REASONS: Final = Reasons(
    impossible=f"{AT_CENTRE} (P-CHAN-00008)",
    none=AT_CENTRE,
    forbidden="the centre of rotation, which X must not pass (P-CHAN-00008)",
    elsewhere="the centre of rotation at an angle at which the C axis is not",
)
SHARE: Final = 0.1
"""Part of the distance from the centre by which a place of a part may be away from its middle."""


class Face(NamedTuple):
    """X is the distance from the centre of rotation, C the angle.

    x, c     places of the axes
    origin   machine position of the programmed zero point, at the angle 0
    through  X may pass the centre (milling machine); on a lathe it stays on its side
    names    of the two axes
    """

    x: int
    c: int
    origin: Point
    through: bool
    names: tuple[str, str] = ("X", "C")

    @property
    def name(self) -> str:
        return f"#FACE [{self.names[0]}, {self.names[1]}]"

    @property
    def plane(self) -> tuple[int, int]:
        return self.x, self.c

    @property
    def likeness(self) -> tuple[int, float]:
        return self.x, 1.0

    @property
    def reasons(self) -> Reasons:
        return REASONS

    def forward(self, machine: Point) -> Point:
        """x = r·cos C, y = r·sin C."""
        point = [m - o for m, o in zip(machine, self.origin, strict=True)]
        radius, angle = point[self.x], radians(point[self.c])
        point[self.x], point[self.c] = radius * cos(angle), radius * sin(angle)
        return tuple(point)

    def inverse(self, programmed: Point, near: Point) -> Point:
        """On the side of the centre on which `near` is; the angle is the nearest. At the centre it stays."""
        point = [p + o for p, o in zip(programmed, self.origin, strict=True)]
        z, side, ray = complex(programmed[self.x], programmed[self.c]), self._side(near), self._ray(near)
        radius = abs(z)
        point[self.x] = self.origin[self.x] + side * radius
        point[self.c] = near[self.c]
        if radius >= CENTRE:
            turned = side * z * ray.conjugate()
            point[self.c] += degrees(atan2(turned.imag, turned.real))
        return tuple(point)

    def shape(self, programmed: Sequence[Shape], near: Point) -> list[Shape]:
        """See the formulas above."""
        shape = [(q + o, q1, q2, q3) for (q, q1, q2, q3), o in zip(programmed, self.origin, strict=True)]
        z, z1, z2, z3 = self._vectors(programmed)
        ray = self._ray(near)
        if through_centre(z, z1, z2, z3):
            radius, along = (z * ray.conjugate()).real, (z1 * ray.conjugate()).real
            shape[self.x] = (self.origin[self.x] + radius, along, 0.0, 0.0)
            shape[self.c] = (near[self.c], 0.0, 0.0, 0.0)
            return shape
        w1 = z1 / z
        w2 = z2 / z - w1 * w1
        w3 = z3 / z - 3.0 * w1 * w2 - w1 * w1 * w1
        radius, (a1, a2, a3) = self._side(near) * abs(z), (w1.real, w2.real, w3.real)
        turned = self._side(near) * z * ray.conjugate()
        angle = near[self.c] + degrees(atan2(turned.imag, turned.real))
        place = self.origin[self.x] + radius
        shape[self.x] = (place, radius * a1, radius * (a2 + a1 * a1), radius * (a3 + 3.0 * a1 * a2 + a1 * a1 * a1))
        shape[self.c] = (angle, degrees(w1.imag), degrees(w2.imag), degrees(w3.imag))
        return shape

    def possible(self, way: Way) -> bool:
        """A line through the centre needs X to pass it, an arc through it has no angle there."""
        ends = min(abs(self._vectors(way.shape(u))[0]) for u in (0.0, 1.0))
        if way.straight and (self.through or ends < CENTRE):
            return True
        nearest = [abs(self._vectors(way.shape(u))[0]) for u in way.changes(partial(self._approach, way))]
        return min(ends, *nearest, 1.0) >= CENTRE

    def _approach(self, way: Way, u: float) -> float:
        """How the square of the distance from the centre changes."""
        z, z1, _, _ = self._vectors(way.shape(u))
        return (z.conjugate() * z1).real

    def permits(self, machine: Point) -> bool:
        return self.through or machine[self.x] >= self.origin[self.x] - CENTRE

    def fits(self, middle: Sequence[Shape], reach: Sequence[Bounds], half: float) -> bool:
        """The part is short against its distance from the centre, or goes straight through that."""
        z, z1, z2, z3 = self._vectors(middle)
        return through_centre(z, z1, z2, z3) or self._reach(reach, 0) * half <= SHARE * abs(z)

    def bounds(self, middle: Sequence[Shape], reach: Sequence[Bounds], half: float, near: Point) -> list[Bounds]:
        """What it is in the middle, and `half` times the largest of the next derivative."""
        bounds = list(reach)
        z, z1, z2, z3 = self._vectors(middle)
        size = [self._reach(reach, order) for order in range(3)]
        if through_centre(z, z1, z2, z3):
            bounds[self.x], bounds[self.c] = (size[0], 0.0, 0.0), (0.0, 0.0, 0.0)
            return bounds
        least, most = abs(z) - size[0] * half, abs(z) + size[0] * half
        fourth = size[2] * size[2] / size[1] if size[1] > 0.0 else 0.0  # exactly that of a circle
        w1 = size[0] / least
        w2 = size[1] / least + w1 * w1
        w3 = size[2] / least + 3.0 * w1 * w2 + w1**3
        w4 = fourth / least + 4.0 * w1 * w3 + 3.0 * w2 * w2 + 6.0 * w1 * w1 * w2 + w1**4
        r2, r3 = most * (w2 + w1 * w1), most * (w3 + 3.0 * w1 * w2 + w1**3)
        r4 = most * (w4 + 4.0 * w1 * w3 + 3.0 * w2 * w2 + 6.0 * w1 * w1 * w2 + w1**4)
        shape = self.shape(middle, near)
        further = {self.x: (r2, r3, r4), self.c: (degrees(w2), degrees(w3), degrees(w4))}
        for axis, (one, two, three) in further.items():
            _, q1, q2, q3 = shape[axis]
            bounds[axis] = (abs(q1) + one * half, abs(q2) + two * half, abs(q3) + three * half)
        return bounds

    def _vectors(self, programmed: Sequence[Shape]) -> tuple[complex, complex, complex, complex]:
        """z and its derivatives."""
        x, y = programmed[self.x], programmed[self.c]
        return complex(x[0], y[0]), complex(x[1], y[1]), complex(x[2], y[2]), complex(x[3], y[3])

    def _reach(self, reach: Sequence[Bounds], order: int) -> float:
        """Largest |z'|, |z''| or |z'''|."""
        return abs(complex(reach[self.x][order], reach[self.c][order]))

    def _side(self, machine: Point) -> float:
        """1, or -1 beyond the centre."""
        return -1.0 if machine[self.x] < self.origin[self.x] - CENTRE else 1.0

    def _ray(self, machine: Point) -> complex:
        """Direction from the centre to positive X on the face."""
        angle = radians(machine[self.c] - self.origin[self.c])
        return complex(cos(angle), sin(angle))


def through_centre(z: complex, z1: complex, z2: complex, z3: complex) -> bool:
    """The path is a line through the centre, or does not move on the face at its centre."""
    if z2 != 0.0 or z3 != 0.0:
        return False
    if z1 == 0.0:
        return abs(z) < CENTRE
    return abs((z1.conjugate() * z).imag) < CENTRE * abs(z1)
