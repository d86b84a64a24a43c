"""Cubic pieces: the largest speed of the path in a part of one, against many places."""

from __future__ import annotations

import random

import numpy as np
import pytest

from cnc_ptp.path.cubic import Cubic

XYZ = (0, 1, 2)


def random_cubic(draw: random.Random) -> Cubic:
    return Cubic([(0.0, draw.gauss(0, 0.3), draw.gauss(0, 0.1), draw.gauss(0, 0.2)) for _ in XYZ], 1.0)


def speeds(cubic: Cubic, begin: float, end: float) -> np.ndarray:
    u = np.linspace(begin, end, 4001)
    return np.sqrt(sum((q1 + u * (q2 + 0.5 * u * q3)) ** 2 for _, q1, q2, q3 in cubic.start))


def test_the_largest_speed_of_random_parts() -> None:
    draw, inside = random.Random(5), 0
    for _ in range(3000):
        cubic = random_cubic(draw)
        begin, end = sorted((draw.random(), draw.random()))
        dense = speeds(cubic, begin, end)
        assert cubic.largest_speed(begin, end, XYZ) == pytest.approx(dense.max(), rel=1e-6)
        inside += dense.max() > max(dense[0], dense[-1])
    assert inside > 30


def test_a_maximum_that_the_slopes_at_the_ends_do_not_show() -> None:
    """As in a corner of random program 2221: the speed falls at the start, has its maximum, and falls at the end."""
    cubic = Cubic([(0.0, 0.17, -0.14, 0.14), (0.0, -0.12, -0.08, 0.09), (0.0, 0.2, 0.07, -0.17)], 1.0)
    dense = speeds(cubic, 0.0, 1.0)
    assert dense[1] < dense[0] and dense[-1] < dense[-2] and dense.max() > 1.0002 * dense[0]
    assert cubic.largest_speed(0.0, 1.0, XYZ) == pytest.approx(dense.max(), rel=1e-7)
    assert cubic.largest_speed(0.5, 1.0, XYZ) == pytest.approx(speeds(cubic, 0.5, 1.0).max(), rel=1e-7)
