"""One affine map from programmed to machine coordinates: a matrix for the main axes, a shift for all."""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

from cnc_ptp.nc.degrees import cosine, sine

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
LEAST: Final = 1e-12
"""Smaller parts of a matrix are rounding."""
SAME: Final = 1e-9
"""mm: an axis that is moved by less because of rounding stays where it is."""


def product(a: Matrix, b: Matrix) -> Matrix:
    rows = [tuple(sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)) for i in range(3)]
    return matrix(rows)


def matrix(rows: Sequence[Sequence[float]]) -> Matrix:
    first, second, third = ((row[0], row[1], row[2]) for row in rows)
    return (first, second, third)


def transposed(a: Matrix) -> Matrix:
    return matrix([[a[j][i] for j in range(3)] for i in range(3)])


def times(a: Matrix, v: Sequence[float]) -> Vector:
    return (
        a[0][0] * v[0] + a[0][1] * v[1] + a[0][2] * v[2],
        a[1][0] * v[0] + a[1][1] * v[1] + a[1][2] * v[2],
        a[2][0] * v[0] + a[2][1] * v[1] + a[2][2] * v[2],
    )


def diagonal(x: float, y: float, z: float) -> Matrix:
    return ((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z))


def rotation_about(axis: int, degrees: float) -> Matrix:
    """Mathematically positive rotation about main axis 0, 1 or 2; exact at the multiples of 90°."""
    c, s = cosine(degrees), sine(degrees)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    rows = [list(row) for row in IDENTITY]
    rows[i][i], rows[i][j], rows[j][i], rows[j][j] = c, -s, s, c
    return matrix(rows)


def inverse(a: Matrix) -> Matrix:
    """By cofactors; the determinant is not 0: rotations, mirrors and scales above 0."""
    cofactors = [
        [
            a[(i + 1) % 3][(j + 1) % 3] * a[(i + 2) % 3][(j + 2) % 3]
            - a[(i + 1) % 3][(j + 2) % 3] * a[(i + 2) % 3][(j + 1) % 3]
            for i in range(3)
        ]
        for j in range(3)
    ]
    determinant = sum(a[0][j] * cofactors[j][0] for j in range(3))
    return matrix([[value / determinant for value in row] for row in cofactors])


def main_axes(main: tuple[int, int, int], plane: tuple[int, int] | None) -> tuple[int, int, int]:
    """Places of X, Y, Z among the axes. In a `plane` of #FACE or #CYL (linear axis, C), C counts as Y.

    As X beside a linear axis that is Y.
    """
    if plane is None:
        return main
    x, y, z = main
    linear, c = plane
    return (c, y, z) if linear == y else (x, c, z)


class Frame:
    """machine = linear · programmed + shift. `main`: places of X, Y, Z among the axes, -1 for one that is not there."""

    def __init__(self, linear: Matrix, shift: tuple[float, ...], main: tuple[int, int, int]) -> None:
        self.linear, self.shift, self.main = linear, shift, main
        self.turned = linear != IDENTITY
        self._inverse = inverse(linear) if self.turned else IDENTITY

    def to_machine(self, programmed: Sequence[float]) -> tuple[float, ...]:
        """All axes, mm or deg."""
        return tuple([p + s for p, s in zip(self._mapped(self.linear, programmed), self.shift, strict=True)])

    def to_programmed(self, machine: Sequence[float]) -> tuple[float, ...]:
        return self._mapped(self._inverse, [m - s for m, s in zip(machine, self.shift, strict=True)])

    def target(
        self, programmed: Sequence[float], before: Sequence[float], position: Sequence[float]
    ) -> tuple[float, ...]:
        """Machine target of a motion from `before`, which is `position`: an axis that it does not move stays."""
        mapped = self.to_machine(programmed)
        if self.turned:
            return tuple([p if abs(m - p) < SAME else m for m, p in zip(mapped, position, strict=True)])
        together = zip(mapped, programmed, before, position, strict=True)
        return tuple([p if target == was else m for m, target, was, p in together])

    def _mapped(self, linear: Matrix, point: Sequence[float]) -> tuple[float, ...]:
        if not self.turned:
            return tuple(point)
        mapped = times(linear, [point[index] if index >= 0 else 0.0 for index in self.main])
        result = list(point)
        for index, value in zip(self.main, mapped, strict=True):
            if index >= 0:
                result[index] = value
        return tuple(result)

    def circle(self, first: int, second: int) -> "Circle | None":
        """What becomes of circles in the plane of these axes; None where they become ellipses or lie askew."""
        if not self.turned:
            return AS_IT_IS
        a, b = self.main.index(first), self.main.index(second)
        u, v, normal = (tuple([row[k] for row in self.linear]) for k in (a, b, 3 - a - b))
        scale = math.hypot(*u)
        if (
            abs(math.hypot(*v) - scale) > LEAST * scale
            or not square(u, v)
            or not square(u, normal)
            or not square(v, normal)
        ):
            return None
        if all(abs(value) <= LEAST * scale for value in (u[3 - a - b], v[3 - a - b])):
            return Circle(scale, u[a] * v[b] - u[b] * v[a] < 0.0, None)
        return Circle(scale, False, (self._direction(u, scale), self._direction(v, scale)))

    def _direction(self, main: Sequence[float], length: float) -> tuple[float, ...]:
        """A vector of the main axes as one of all axes, with length 1."""
        result = [0.0] * len(self.shift)
        for index, value in zip(self.main, main, strict=True):
            if index >= 0:
                result[index] = value / length
        return tuple(result)


def dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum([p * q for p, q in zip(a, b, strict=True)])


def square(a: Sequence[float], b: Sequence[float]) -> bool:
    """At right angles to each other."""
    return abs(dot(a, b)) <= LEAST * math.hypot(*a) * math.hypot(*b)


class Circle(NamedTuple):
    """A circle of the programmed plane in machine coordinates.

    over         it turns the other way round
    directions   of the axes of its plane in the machine; None if it stays in its plane
    """

    scale: float
    over: bool
    directions: tuple[tuple[float, ...], tuple[float, ...]] | None


AS_IT_IS: Final = Circle(1.0, False, None)
