"""Shape of a path at a place: position and derivatives of each axis by the parameter of the path."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

AxisState = tuple[float, float, float, float]
"""Position, velocity, acceleration, jerk of one axis."""
AxisStates = tuple[AxisState, ...]
AT_REST: AxisState = (0.0, 0.0, 0.0, 0.0)
Shape = tuple[float, float, float, float]
"""q, q1, q2, q3 of one axis at a place of the path."""
Bounds = tuple[float, float, float]
"""Largest |q1|, |q2|, |q3| of one axis over a part of the path."""


def standing(position: Sequence[float]) -> AxisStates:
    """States of axes at a standstill at `position` (mm, deg)."""
    return tuple([(value, 0.0, 0.0, 0.0) for value in position])


def without_jerk(states: Sequence[AxisState]) -> AxisStates:
    """The same states with jerk 0: without a limit of the jerk none is fed forward (P-AXIS-00337)."""
    return tuple([(p, v, a, 0.0) for p, v, a, _ in states])


def speed_of(shape: Sequence[Shape], axes: Sequence[int]) -> float:
    """|dq/du| of the given axes: the path velocity is u' times that."""
    square = 0.0
    for axis in axes:
        first = shape[axis][1]
        square += first * first
    return sqrt(square)
