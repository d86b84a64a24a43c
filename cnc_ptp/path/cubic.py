"""A cubic piece of a path: what corners and smoothed contours consist of.

Each axis is q(u) = q0 + q1·u + q2·u²/2 + q3·u³/6 over the parameter u, which is nearly the path length. Pieces follow
each other with continuous q1 and q2, so the acceleration of the axes is continuous and their jerk has a limit.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import copysign, sqrt
from typing import Final

from cnc_ptp.path.shape import AxisState, Bounds, Shape

FALSE_POSITIONS: Final = 3
"""Steps to the largest speed within a cell; what remains is below 1e-8 of it."""
HALVINGS: Final = 8
"""Steps before these where it is looked for between places that are further apart."""


class Cubic:
    """A piece over 0 … `length` (mm of u); `start`: q, q1, q2, q3 of each axis at u = 0."""

    __slots__ = ("length", "start", "target")

    def __init__(self, start: Sequence[Shape], length: float) -> None:
        self.start = tuple(start)
        self.length = length
        self.target = tuple([shape[0] for shape in self.shape(length)])

    def shape(self, u: float) -> list[Shape]:
        """q, q1, q2, q3 of each axis at u."""
        return [shape_at(axis, u) for axis in self.start]

    def evaluate(self, u: float, v: float, a: float, j: float) -> tuple[AxisState, ...]:
        """State of each axis at u that moves with u' = v, u'' = a, u''' = j.

        q' = q1·v, q'' = q1·a + q2·v², q''' = q1·j + 3·q2·v·a + q3·v³.
        """
        square, cross, cube = v * v, 3.0 * v * a, v * v * v
        states: list[AxisState] = []
        for axis in self.start:
            q, q1, q2, q3 = shape_at(axis, u)
            states.append((q, q1 * v, q1 * a + q2 * square, q1 * j + q2 * cross + q3 * cube))
        return tuple(states)

    def bounds(self, begin: float, end: float) -> list[Bounds]:
        """Largest |q1|, |q2|, |q3| of each axis from u = `begin` to `end`.

        q2 is linear; q1 is a parabola, whose vertex counts if it is between the two.
        """
        found: list[Bounds] = []
        for axis in self.start:
            _, first0, second0, third = shape_at(axis, begin)
            _, first1, second1, _ = shape_at(axis, end)
            first = max(abs(first0), abs(first1))
            if second0 * second1 < 0.0:
                first = max(first, abs(first0 - 0.5 * second0 * second0 / third))
            found.append((first, max(abs(second0), abs(second1)), abs(third)))
        return found

    def within(self, room: Sequence[tuple[float, float]]) -> bool:
        """All of it lies between the lowest and highest position of each axis, if `room` has them."""
        for axis, (low, high) in enumerate(room):
            ends = [self.start[axis][0], self.target[axis]]
            ends += [self.shape(u)[axis][0] for u in self._turning_points(axis)]
            if min(ends) < low or max(ends) > high:
                return False
        return True

    def _turning_points(self, axis: int) -> list[float]:
        """Places within the piece at which the axis stands: q1 + q2·u + q3·u²/2 = 0."""
        _, q1, q2, q3 = self.start[axis]
        square = q2 * q2 - 2.0 * q1 * q3
        if square < 0.0:
            return []
        root = -(q2 + copysign(sqrt(square), q2))
        found = [2.0 * q1 / root] if root != 0.0 else []
        if q3 != 0.0:
            found.append(root / q3)
        return [u for u in found if 0.0 < u < self.length]

    def speed(self, u: float, axes: Sequence[int]) -> float:
        """|dq/du| of the given axes: the path velocity is u' times that."""
        square = 0.0
        for axis in axes:
            first = shape_at(self.start[axis], u)[1]
            square += first * first
        return sqrt(square)

    def largest_speed(self, begin: float, end: float, axes: Sequence[int]) -> float:
        """Largest |dq/du| of the given axes from u = `begin` to `end`, which are near each other.

        Its square has the slope 2·q1·q2; where that falls through 0, regula falsi finds the place. That happens in one
        place at most, so if the signs at both ends do not show it, it is looked for where the slope falls.
        """
        largest = max(self.speed(begin, axes), self.speed(end, axes))
        low, high = begin, end
        rising, falling = self._slope(low, axes), self._slope(high, axes)
        if rising <= 0.0 or falling >= 0.0:
            low, high = self._near_maximum(begin, end, axes)
            if low >= high:
                return largest
            rising, falling = self._slope(low, axes), self._slope(high, axes)
        for _ in range(FALSE_POSITIONS):
            place = low + (high - low) * rising / (rising - falling)
            slope = self._slope(place, axes)
            if slope > 0.0:
                low, rising = place, slope
            else:
                high, falling = place, slope
        return max(largest, self.speed(low + (high - low) * rising / (rising - falling), axes))

    def _near_maximum(self, begin: float, end: float, axes: Sequence[int]) -> tuple[float, float]:
        """Two places between which the slope falls through 0, near each other; no part of u if it nowhere does."""
        first, last = self._falling_slope(axes)
        low, high = max(begin, first), min(end, last)
        if low >= high or self._slope(low, axes) <= 0.0 or self._slope(high, axes) >= 0.0:
            return 0.0, 0.0
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if self._slope(middle, axes) > 0.0:
                low = middle
            else:
                high = middle
        return low, high

    def _falling_slope(self, axes: Sequence[int]) -> tuple[float, float]:
        """From where to where q1·q2 falls: its derivative, q2² + q1·q3, is a + b·u + c·u² with c = 3/2·q3² >= 0."""
        a = b = c = 0.0
        for axis in axes:
            _, q1, q2, q3 = self.start[axis]
            a += q2 * q2 + q1 * q3
            b += 3.0 * q2 * q3
            c += 1.5 * q3 * q3
        square = b * b - 4.0 * a * c
        if square <= 0.0 or c <= 0.0:
            return 0.0, 0.0
        return (-b - sqrt(square)) / (2.0 * c), (-b + sqrt(square)) / (2.0 * c)

    def _slope(self, u: float, axes: Sequence[int]) -> float:
        slope = 0.0
        for axis in axes:
            _, first, second, _ = shape_at(self.start[axis], u)
            slope += first * second
        return slope


def shape_at(axis: Shape, u: float) -> Shape:
    """q, q1, q2, q3 at u of an axis that has those of `axis` at u = 0."""
    q, q1, q2, q3 = axis
    return q + u * (q1 + u * (0.5 * q2 + u * (q3 / 6.0))), q1 + u * (q2 + 0.5 * u * q3), q2 + u * q3, q3
