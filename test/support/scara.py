"""A third kinematics, written as somebody would add it: a SCARA arm. Nothing of the project knows it.

The shoulder turns by A, the elbow by B against the upper arm, the third axis is linear. With p the place of the tool,
seen from the shoulder, and m = L1 + L2·e^(iB): |p| = |m| gives B, and A = arg p - arg m.
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Sequence
from math import acos, cos, degrees, radians, sin, sqrt
from typing import NamedTuple

from cnc_ptp.kinematics.kinematics import Bounds, Point, Reasons, Shape
from cnc_ptp.kinematics.way import Way

SHORT = 0.1
"""Part of the way to where the arm is stretched or folded."""


class Scara(NamedTuple):
    """Axes 0 (shoulder, deg), 1 (elbow, deg) and 2 (mm); programmed x, y are mm from the tool at `origin`."""

    upper: float = 300.0
    lower: float = 200.0
    origin: Point = (0.0, 90.0, 0.0)

    name = "#SCARA"
    plane = (0, 1)
    likeness = (0, 1.0)
    reasons = Reasons()

    def _tool(self, a: float, b: float) -> complex:
        shoulder, elbow = radians(a), radians(a + b)
        return complex(
            self.upper * cos(shoulder) + self.lower * cos(elbow), self.upper * sin(shoulder) + self.lower * sin(elbow)
        )

    @property
    def _zero(self) -> complex:
        return self._tool(self.origin[0], self.origin[1])

    def forward(self, machine: Point) -> Point:
        p = self._tool(machine[0], machine[1]) - self._zero
        return p.real, p.imag, machine[2] - self.origin[2]

    def inverse(self, programmed: Point, near: Point) -> Point:
        shape = self.shape([(q, 0.0, 0.0, 0.0) for q in programmed], near)
        return shape[0][0], shape[1][0], shape[2][0]

    def _elbow(self, p: complex) -> float:
        """cos B."""
        return (abs(p) ** 2 - self.upper**2 - self.lower**2) / (2.0 * self.upper * self.lower)

    def shape(self, programmed: Sequence[Shape], near: Point) -> list[Shape]:
        (x, x1, x2, x3), (y, y1, y2, y3), (z, z1, z2, z3) = programmed
        p, p1, p2, p3 = complex(x, y) + self._zero, complex(x1, y1), complex(x2, y2), complex(x3, y3)
        arms = self.upper * self.lower
        c, conj = self._elbow(p), p.conjugate()
        c1 = (conj * p1).real / arms
        c2 = (abs(p1) ** 2 + (conj * p2).real) / arms
        c3 = (3.0 * (p1.conjugate() * p2).real + (conj * p3).real) / arms
        b = acos(max(-1.0, min(1.0, c))) * (1.0 if near[1] >= 0.0 else -1.0)
        s = sin(b) or 1e-300
        b1 = -c1 / s
        b2 = (-c2 - c * b1 * b1) / s
        b3 = (-c3 + s * b1**3 - 3.0 * c * b1 * b2) / s
        e = complex(cos(b), sin(b)) * self.lower
        m, m1, m2 = self.upper + e, 1j * e * b1, e * (1j * b2 - b1 * b1)
        m3 = e * (1j * b3 - 3.0 * b1 * b2 - 1j * b1**3)
        of_p, of_m = turning(p, p1, p2, p3), turning(m, m1, m2, m3)
        a1, a2, a3 = (one.imag - other.imag for one, other in zip(of_p, of_m, strict=True))
        ray = p / m * complex(cos(radians(near[0])), -sin(radians(near[0])))
        a = near[0] + degrees(phase(ray))
        return [
            (a, degrees(a1), degrees(a2), degrees(a3)),
            (degrees(b), degrees(b1), degrees(b2), degrees(b3)),
            (z + self.origin[2], z1, z2, z3),
        ]

    def possible(self, way: Way) -> bool:
        """In reach: the distance from the shoulder is largest and smallest where it turns round, and at the ends."""
        places = [0.0, 1.0, *way.changes(lambda u: self._away(way.shape(u)))]
        return all(abs(self._elbow(complex(*way.point(u)[:2]) + self._zero)) < 0.999 for u in places)

    def _away(self, shape: Sequence[Shape]) -> float:
        p = complex(shape[0][0], shape[1][0]) + self._zero
        return (p.conjugate() * complex(shape[0][1], shape[1][1])).real

    def permits(self, machine: Point) -> bool:
        return True

    def _most(self, middle: Sequence[Shape], reach: Sequence[Bounds], half: float) -> tuple[float, list[float]]:
        """|p| at most, and the largest of the derivatives of cos B, one to four."""
        s1, s2, s3 = (abs(complex(reach[0][n], reach[1][n])) for n in range(3))
        s4 = s3 * s3 / s2 if s2 > 0.0 else 0.0
        far = abs(complex(middle[0][0], middle[1][0]) + self._zero) + s1 * half
        terms = (far * s1, s1**2 + far * s2, 3.0 * s1 * s2 + far * s3, 3.0 * s2**2 + 4.0 * s1 * s3 + far * s4)
        return far, [term / (self.upper * self.lower) for term in terms]

    def fits(self, middle: Sequence[Shape], reach: Sequence[Bounds], half: float) -> bool:
        c = self._elbow(complex(middle[0][0], middle[1][0]) + self._zero)
        s1 = abs(complex(reach[0][0], reach[1][0]))
        near = s1 * half <= SHORT * abs(self.upper - self.lower)
        return near and self._most(middle, reach, half)[1][0] * half <= SHORT * (1.0 - abs(c))

    def bounds(self, middle: Sequence[Shape], reach: Sequence[Bounds], half: float, near: Point) -> list[Bounds]:
        """What it is in the middle, and `half` times the largest of the next derivative."""
        p = complex(middle[0][0], middle[1][0]) + self._zero
        s1, s2, s3 = (abs(complex(reach[0][n], reach[1][n])) for n in range(3))
        s4 = s3 * s3 / s2 if s2 > 0.0 else 0.0
        _, (c1, c2, c3, c4) = self._most(middle, reach, half)
        s = sqrt(1.0 - (abs(self._elbow(p)) + c1 * half) ** 2)
        b1 = c1 / s
        b2 = (c2 + b1**2) / s
        b3 = (c3 + b1**3 + 3.0 * b1 * b2) / s
        b4 = (c4 + b1**4 + 6.0 * b1**2 * b2 + 3.0 * b2**2 + 4.0 * b1 * b3) / s
        of_m = [b1, b2 + b1**2, b3 + 3.0 * b1 * b2 + b1**3]
        of_m.append(b4 + 4.0 * b1 * b3 + 3.0 * b2**2 + 6.0 * b1**2 * b2 + b1**4)
        turns = [
            one + other
            for one, other in zip(
                most(abs(p) - s1 * half, s1, s2, s3, s4),
                most(abs(self.upper - self.lower), *[self.lower * each for each in of_m]),
                strict=True,
            )
        ]
        found = []
        for (_, *values), following in zip(self.shape(middle, near)[:2], (turns[1:], (b2, b3, b4)), strict=True):
            found.append(tuple(abs(q) + degrees(n) * half for q, n in zip(values, following, strict=True)))
        return [*found, reach[2]]


def turning(z: complex, z1: complex, z2: complex, z3: complex) -> tuple[complex, complex, complex]:
    """Derivatives of ln z."""
    w1 = z1 / z
    w2 = z2 / z - w1 * w1
    return w1, w2, z3 / z - 3.0 * w1 * w2 - w1**3


def most(least: float, z1: float, z2: float, z3: float, z4: float) -> tuple[float, float, float, float]:
    """Bounds of the derivatives of ln z from those of z."""
    w1 = z1 / least
    w2 = z2 / least + w1**2
    w3 = z3 / least + 3.0 * w1 * w2 + w1**3
    return w1, w2, w3, z4 / least + 4.0 * w1 * w3 + 3.0 * w2**2 + 6.0 * w1**2 * w2 + w1**4
