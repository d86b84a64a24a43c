"""Seeded elements and axis limits of the path tests."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import pytest

from cnc_ptp.path import Arc, AxisLimits, Line


def random_axes(draw: random.Random, count: int = 3) -> list[AxisLimits]:
    """Axes of a machine, each with its own velocity, A+, A- and jerk."""
    return [
        AxisLimits(draw.uniform(50, 1000), draw.uniform(500, 9000), draw.uniform(500, 9000), 10 ** draw.uniform(3.5, 6))
        for _ in range(count)
    ]


def random_arc(draw: random.Random, radius: float, axes: int = 3) -> Arc:
    """An arc or helix of up to two turns in one of the three planes, with its target on the circle."""
    first, second = draw.choice([(0, 1), (2, 0), (1, 2)])
    start = [draw.uniform(-100, 100) for _ in range(axes)]
    begin, sweep = draw.uniform(-math.pi, math.pi), draw.choice([-1, 1]) * draw.uniform(1.0, 700.0)
    center = (start[first] - radius * math.cos(begin), start[second] - radius * math.sin(begin))
    target = [value + draw.choice([0.0, draw.uniform(-2.0, 2.0) * radius]) for value in start]
    target[first] = center[0] + radius * math.cos(begin + math.radians(sweep))
    target[second] = center[1] + radius * math.sin(begin + math.radians(sweep))
    return Arc(start, target, center, (first, second), radius, sweep, range(3))


def random_line(draw: random.Random, axes: int = 3) -> Line:
    start = [draw.uniform(-100, 100) for _ in range(axes)]
    return Line(start, [value + draw.choice([0.0, draw.uniform(-50, 50)]) for value in start], range(3))


@pytest.fixture(scope="session")
def draw_axes() -> Callable[..., list[AxisLimits]]:
    return random_axes


@pytest.fixture(scope="session")
def draw_arc() -> Callable[..., Arc]:
    return random_arc


@pytest.fixture(scope="session")
def draw_line() -> Callable[..., Line]:
    return random_line
