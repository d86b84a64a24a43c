"""Seeded elements and axis limits of the path tests."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import numpy as np
import pytest

from cnc_ptp.path import Arc, AxisLimits, Line


def random_axes(draw: random.Random, count: int = 3) -> list[AxisLimits]:
    """Axes of a machine, each with its own velocity, A+, A- and jerk."""
    return [
        AxisLimits(draw.uniform(50, 1000), draw.uniform(500, 9000), draw.uniform(500, 9000), 10 ** draw.uniform(3.5, 6))
        for _ in range(count)
    ]


def random_arc(draw: random.Random, radius: float, axes: int = 3, *, tilted: bool | None = None) -> Arc:
    """An arc or helix of up to two turns in one of the three planes, with its target on the circle.

    `tilted`: turned in space with its plane; None: every second one.
    """
    first, second = draw.choice([(0, 1), (2, 0), (1, 2)])
    start = [draw.uniform(-100, 100) for _ in range(axes)]
    begin, sweep = draw.uniform(-math.pi, math.pi), draw.choice([-1, 1]) * draw.uniform(1.0, 700.0)
    center = (start[first] - radius * math.cos(begin), start[second] - radius * math.sin(begin))
    target = [value + draw.choice([0.0, draw.uniform(-2.0, 2.0) * radius]) for value in start]
    target[first] = center[0] + radius * math.cos(begin + math.radians(sweep))
    target[second] = center[1] + radius * math.sin(begin + math.radians(sweep))
    if not (draw.random() < 0.5 if tilted is None else tilted):
        return Arc(start, target, center, (first, second), radius, sweep, range(3))
    turn = random_rotation(draw)
    start[:3], target[:3] = turn @ start[:3], turn @ target[:3]
    directions = tuple([*turn[:, axis], *[0.0] * (axes - 3)] for axis in (first, second))
    return Arc(start, target, center, (first, second), radius, sweep, range(3), directions)


def random_rotation(draw: random.Random) -> np.ndarray:
    """Right-handed or mirrored; sometimes about one axis alone."""
    wanted = np.array([[draw.gauss(0, 1) for _ in range(3)] for _ in range(3)])
    if draw.random() < 0.3:
        wanted[0], wanted[:, 0] = (1.0, 0.0, 0.0), (1.0, 0.0, 0.0)
    return np.linalg.qr(wanted)[0]


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


@pytest.fixture(scope="session")
def draw_rotation() -> Callable[..., np.ndarray]:
    return random_rotation
