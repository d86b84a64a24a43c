"""Roots and crossings of polynomials against NumPy and by substitution."""

from __future__ import annotations

import random

import numpy as np
import pytest

from cnc_ptp.motion.polynomials import crossing, roots_between, value


def test_value_is_horner() -> None:
    assert value((2.0, -1.0, 0.5), 4.0) == 2.0 - 4.0 + 8.0 and value((), 3.0) == 0.0


def test_roots_in_an_interval_are_those_of_numpy() -> None:
    draw = random.Random(11)
    for _ in range(300):
        coefficients = [draw.uniform(-5.0, 5.0) for _ in range(draw.randint(2, 5))]
        low, high = sorted(draw.uniform(-3.0, 3.0) for _ in range(2))
        expected = sorted(
            root.real for root in np.roots(coefficients[::-1]) if abs(root.imag) < 1e-9 and low < root.real < high
        )
        assert roots_between(coefficients, low, high) == pytest.approx(expected, abs=1e-9)


def test_a_constant_has_no_roots() -> None:
    assert roots_between((3.0,), -1.0, 1.0) == [] == roots_between((0.0,), -1.0, 1.0)


def test_crossings_of_growing_and_falling_polynomials() -> None:
    draw = random.Random(12)
    for _ in range(300):
        slopes = [draw.uniform(0.0, 3.0) for _ in range(4)]
        sign = draw.choice((-1.0, 1.0))
        coefficients = [draw.uniform(-2.0, 2.0), *(sign * (slope + 0.01) for slope in slopes)]
        end = draw.uniform(0.1, 4.0)
        level = value(coefficients, draw.uniform(0.001, 0.999) * end)
        x = crossing(coefficients, level, end)
        assert 0.0 < x < end and value(coefficients, x) == pytest.approx(
            level, abs=1e-12 * max(1.0, abs(value(coefficients, end)))
        )
