"""Shape of a path at a place: each axis's position and derivatives by the parameter; what motion makes of them."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

AxisState = tuple[float, float, float, float]
"""Position, velocity, acceleration, jerk of one axis."""
Shape = tuple[float, float, float, float]
"""q, q1, q2, q3 of one axis at a place of the path."""
Bounds = tuple[float, float, float]
"""Largest |q1|, |q2|, |q3| of one axis over a part of the path."""


def states(shape: Sequence[Shape], v: float, a: float, j: float) -> tuple[AxisState, ...]:
    """State of each axis at a place that moves with u' = v, u'' = a, u''' = j.

    q' = q1·v, q'' = q1·a + q2·v², q''' = q1·j + 3·q2·v·a + q3·v³.
    """
    square, cross, cube = v * v, 3.0 * v * a, v * v * v
    return tuple(
        [(q, q1 * v, q1 * a + q2 * square, q1 * j + q2 * cross + q3 * cube) for q, q1, q2, q3 in shape]
    )  # fmt: skip


def speed_of(shape: Sequence[Shape], axes: Sequence[int]) -> float:
    """|dq/du| of the given axes: the path velocity is u' times that."""
    square = 0.0
    for axis in axes:
        first = shape[axis][1]
        square += first * first
    return sqrt(square)
