"""The closed form against polynomials that are multiplied out from roots known beforehand, in 60 digits."""

from __future__ import annotations

import random
from decimal import Decimal, localcontext

import pytest

from cnc_ptp.motion.quartic import largest_root


@pytest.mark.parametrize(
    ("p", "q", "e", "root"),
    [
        (0.0, 0.0, 0.0, 0.0),
        (0.0, 0.0, 4.0, 1.0),  # x⁴ - 1
        (-5.0, 0.0, 9.0, 2.0),  # (x² - 1)(x² - 4)
        (5.0, 0.0, 25.0, 0.0),  # x²(x² + 5)
        (0.0, -8.0, 0.0, 2.0),  # x(x³ - 8)
        (0.0, 8.0, 0.0, 0.0),  # x(x³ + 8)
        (-7.0, 6.0, 49.0, 2.0),  # x(x - 1)(x - 2)(x + 3)
        (-7.0, -6.0, 49.0, 3.0),  # x(x + 1)(x + 2)(x - 3)
    ],
)
def test_roots_by_hand(p, q, e, root):
    assert largest_root(p, q, e) == pytest.approx(root, rel=1e-12, abs=1e-12)


def test_a_double_root_has_half_the_digits():
    """x⁴ - 4x² + 4x - 1 = (x - 1)²(x² + 2x - 1)."""
    assert largest_root(-4.0, 4.0, 20.0) == pytest.approx(1.0, abs=1e-7)


def expanded(x: Decimal, s: Decimal, m: Decimal) -> tuple[float, float, float]:
    """p, q, e of (X - x)(X - s)(X² + (x + s)X + m): no X³, roots x and s, and two of any kind."""
    b, c = -(x + s), x * s
    p, q, r = m + c - b * b, b * m - b * c, c * m
    return float(p), float(q), float(p * p - 4 * r)


def test_random_roots_over_twelve_decades():
    """Apart by a tenth and more, to 1e-11 of the largest; beside x and s < x a complex pair or two smaller real roots."""
    draw = random.Random(50)
    with localcontext(prec=60):
        for _ in range(20000):
            x = Decimal(draw.choice((-1, 1)) * 10 ** draw.uniform(-6, 6))
            s = x - abs(x) * Decimal(10 ** draw.uniform(-1, 2))
            half = -(x + s) / 2
            apart = abs(x) * Decimal(10 ** draw.uniform(-1, 2))
            complex_pair = draw.random() < 0.5 or half + apart >= x
            m = half * half + (apart * apart if complex_pair else -apart * apart)
            p, q, e = expanded(x, s, m)
            scale = max(abs(float(x)), abs(float(s)), float(abs(m)) ** 0.5)
            assert largest_root(p, q, e) == pytest.approx(float(x), rel=1e-11, abs=1e-11 * scale), (x, s, m)
