"""The largest real root of a depressed polynomial of degree four, closed form (Ferrari, with Cardano's resolvent).

With a root z > 0 of z³ + 2pz² + ez - q² = 0, where e = p² - 4r, the polynomial x⁴ + px² + qx + r is the product of
x² - αx + (z + p + k)/2 and x² + αx + (z + p - k)/2 with α = √z and k = q/α, so k² = z² + 2pz + e.
"""

from __future__ import annotations

from math import acos, cbrt, copysign, cos, sqrt


def largest_root(p: float, q: float, e: float) -> float:
    """Largest real x with x⁴ + px² + qx + (p² - e)/4 = 0; there must be one.

    A caller that knows e without the subtraction p² - 4r keeps its digits.
    """
    z = _resolvent_root(p, q, e)
    alpha = sqrt(z)
    k = abs(q) / alpha if alpha > 0.0 else 0.0
    if e > 4.0 * abs(p) * z:
        k = sqrt(e + z * (z + 2.0 * p))
    t = z + 2.0 * p
    if -0.5 * z < t < 0.0:
        t = (k * k - e) / z
    root = sqrt(max(0.0, 2.0 * k - t))
    if q <= 0.0:
        return 0.5 * (root + alpha)
    if 2.0 * k + t <= 0.0:
        return max(0.5 * (root - alpha), 0.5 * (sqrt(-2.0 * k - t) + alpha))
    return 0.5 * (root - alpha)


def _resolvent_root(p: float, q: float, e: float) -> float:
    """A root z >= 0 of z³ + 2pz² + ez - q² = 0, the largest one unless two others coincide.

    For p > 0 the root is a difference, which one Newton step frees from its rounding.
    """
    g = 4.0 * p * p / 9.0 - e / 3.0
    h = 0.5 * q * q + p * (e - 8.0 * p * p / 9.0) / 3.0
    square = h * h - g * g * g
    if square >= 0.0:
        u = cbrt(h + copysign(sqrt(square), h))
        z = (u + g / u if u else 0.0) - 2.0 * p / 3.0
    else:
        ratio = max(-1.0, min(1.0, h / (g * sqrt(g))))
        z = 2.0 * sqrt(g) * cos(acos(ratio) / 3.0) - 2.0 * p / 3.0
    slope = e + z * (4.0 * p + 3.0 * z)
    if p > 0.0 and slope > 0.0:
        z -= (z * (e + z * (2.0 * p + z)) - q * q) / slope
    return max(0.0, z)
