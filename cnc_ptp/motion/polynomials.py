"""Polynomials with ascending coefficients: value, roots in an interval, crossing of a level."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

HALVINGS = 200
"""More steps than a bisection of doubles can need."""


def value(coefficients: Sequence[float], x: float) -> float:
    """c0 + c1·x + c2·x² + …"""
    total = 0.0
    for coefficient in reversed(coefficients):
        total = total * x + coefficient
    return total


def derivative(coefficients: Sequence[float]) -> list[float]:
    """Of a constant: none, which is 0."""
    return [k * coefficient for k, coefficient in enumerate(coefficients)][1:]


def roots_between(coefficients: Sequence[float], low: float, high: float, *, touching: bool = False) -> list[float]:
    """Real roots in the open interval at which the sign changes, ascending; `touching`: multiple roots, too.

    The roots of the derivative cut the interval into monotonic pieces; each of them has one root at most.
    """
    if len(coefficients) < 2:
        return []
    borders = [low, *roots_between(derivative(coefficients), low, high, touching=touching), high]
    roots = []
    for left, right in pairwise(borders):
        if value(coefficients, left) * value(coefficients, right) < 0.0:
            roots.append(bisect(coefficients, left, right))
        elif touching and right < high and value(coefficients, right) == 0.0:
            roots.append(right)
    return roots


def bisect(coefficients: Sequence[float], low: float, high: float) -> float:
    """The root between two places with values of different sign, to the last bit."""
    rises = value(coefficients, low) < 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if (value(coefficients, middle) < 0.0) == rises:
            low = middle
        else:
            high = middle
    return high


def crossing(coefficients: Sequence[float], level: float, end: float) -> float:
    """Where a polynomial, monotonic in 0 … end, reaches `level`: Newton's method, kept inside by bisection."""
    shifted = [coefficients[0] - level, *coefficients[1:]]
    slopes = derivative(shifted)
    rises = value(shifted, end) > 0.0
    low, high = 0.0, end
    x = -shifted[0] / shifted[1] if shifted[1] else 0.5 * end
    for _ in range(HALVINGS):
        if not low < x < high:
            x = 0.5 * (low + high)
        miss = value(shifted, x)
        if miss == 0.0:
            return x
        if (miss > 0.0) == rises:
            high = x
        else:
            low = x
        slope = value(slopes, x)
        following = x - miss / slope if slope else 0.5 * (low + high)
        if following == x or not low < high:
            return x
        if abs(following - x) <= 1e-16 * end:
            return following
        x = following
    return x
