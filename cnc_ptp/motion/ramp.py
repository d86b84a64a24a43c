"""Ramps: the fastest transition from a velocity and an acceleration to another velocity with acceleration 0.

Everything here is closed form. Symbols: v, a the state; J the jerk; A+ (`acceleration`) bounds the growth of |v|,
A- (`deceleration`) its reduction. `v + a|a|/(2J)` is the velocity that remains when a is taken to 0 immediately: if it
is below the target velocity the ramp pushes upwards, otherwise downwards. An acceleration above its bound is left
with full jerk.
"""

from __future__ import annotations

from math import sqrt

from cnc_ptp.motion.limits import Limits
from cnc_ptp.motion.profile import Piece

NEGLIGIBLE = 4e-15
"""Relative velocity difference that counts as rounding."""


def ramp(v: float, a: float, wanted: float, limits: Limits) -> list[Piece]:
    """Pieces of the time-optimal ramp from (v, a) to (wanted, 0), in mm/s and mm/s²; empty when already there."""
    jerk = limits.jerk
    left = a * abs(a) / (2.0 * jerk)
    lack = wanted - v - left
    if abs(lack) <= NEGLIGIBLE * (abs(v) + abs(wanted) + abs(left)):
        return [(abs(a) / jerk, a, -jerk if a > 0.0 else jerk)] if a else []
    if lack > 0.0:
        return _upwards(v, a, wanted, limits)
    return [(d, -a, -j) for d, a, j in _upwards(-v, -a, -wanted, limits)]


def _upwards(v: float, a: float, wanted: float, limits: Limits) -> list[Piece]:
    """The ramp when v must grow: below zero that is a reduction of |v|, above zero its growth."""
    _, acceleration, deceleration, jerk = limits
    if wanted <= 0.0:
        return push(v, a, wanted, deceleration, jerk)
    lowest = v if a >= 0.0 else v - a * a / (2.0 * jerk)
    if lowest >= 0.0 or acceleration == deceleration:
        return push(v, a, wanted, acceleration, jerk)
    return _through_zero(v, a, wanted, limits)


def push(v: float, a: float, wanted: float, bound: float, jerk: float) -> list[Piece]:
    """Raise v to `wanted` > v + a|a|/(2J) under a <= bound: jerk +J, constant, -J.

    From above the bound: -J, constant, -J.
    """
    if a > bound:
        hold = (wanted - v - a * a / (2.0 * jerk)) / bound
        return [((a - bound) / jerk, a, -jerk), (hold, bound, 0.0), (bound / jerk, bound, -jerk)]
    top_squared = jerk * (wanted - v) + 0.5 * a * a
    if top_squared <= bound * bound:
        top = sqrt(top_squared)
        return [((top - a) / jerk, a, jerk), (top / jerk, top, -jerk)]
    hold = (top_squared - bound * bound) / (jerk * bound)
    return [((bound - a) / jerk, a, jerk), (hold, bound, 0.0), (bound / jerk, bound, -jerk)]


def _through_zero(v: float, a: float, wanted: float, limits: Limits) -> list[Piece]:
    """The ramp from backward to forward motion when A+ and A- differ: a <= A- before standstill, a <= A+ after it."""
    _, acceleration, deceleration, jerk = limits
    both = min(acceleration, deceleration)
    peak_squared = jerk * (wanted - v) + 0.5 * a * a
    if peak_squared <= both * both or 2.0 * jerk * wanted <= both * both:
        return push(v, a, wanted, deceleration, jerk)
    crossing_squared = a * a + 2.0 * jerk * v
    if a > acceleration and crossing_squared >= acceleration * acceleration:
        return push(v, a, wanted, acceleration, jerk)
    if a > deceleration and crossing_squared >= deceleration * deceleration:
        crossing = sqrt(crossing_squared)
        return [((a - crossing) / jerk, a, -jerk), *push(0.0, crossing, wanted, acceleration, jerk)]
    pieces, crossing = _to_standstill(v, a, limits)
    return pieces + push(0.0, crossing, wanted, acceleration, jerk)


def _to_standstill(v: float, a: float, limits: Limits) -> tuple[list[Piece], float]:
    """From backward motion up to v = 0, passed with the largest acceleration that A- and A+ allow; and this one."""
    _, acceleration, deceleration, jerk = limits
    crossing = min(acceleration, deceleration)
    rising_squared = a * a - 2.0 * jerk * v
    if a <= crossing and rising_squared <= crossing * crossing:
        return [((sqrt(rising_squared) - a) / jerk, a, jerk)], sqrt(rising_squared)
    top = deceleration
    if a <= top:
        top = min(top, sqrt(0.5 * (a * a + crossing * crossing) - jerk * v))
    d = abs(top - a) / jerk
    j = jerk if top > a else -jerk
    v += d * (a + 0.5 * j * d) + (top * top - crossing * crossing) / (2.0 * jerk)
    return [(d, a, j), (max(0.0, -v) / top, top, 0.0), ((top - crossing) / jerk, top, -jerk)], crossing


def stopping_distance(v: float, a: float, deceleration: float, jerk: float) -> float:
    """Signed distance (mm) of the fastest stop from velocity v and acceleration a under A- and J.

    With q = vJ + a²/2 (the square of the deceleration peak) and v + a|a|/(2J) >= 0:
    distance = (g(q) + a·q - a³/6)/J², see `brake_term` for g. The opposite case is its mirror image.
    """
    if v + a * abs(a) / (2.0 * jerk) < 0.0:
        return -stopping_distance(-v, -a, deceleration, jerk)
    distance = 0.0
    if a < -deceleration:
        d = (-deceleration - a) / jerk
        distance = d * (v + d * (0.5 * a + d * (jerk / 6.0)))
        v += d * (a + d * (0.5 * jerk))
        a = -deceleration
    q = v * jerk + 0.5 * a * a
    return distance + (brake_term(q, deceleration) + a * q - a * a * a / 6.0) / (jerk * jerk)


def brake_term(q: float, deceleration: float) -> float:
    """g(q): q^1.5 while the peak √q stays within A-, q·A-/2 + q²/(2A-) beyond (the two meet smoothly at q = A-²)."""
    if q <= deceleration * deceleration:
        return q * sqrt(q) if q > 0.0 else 0.0
    return 0.5 * q * (deceleration + q / deceleration)


def brake(v: float, a: float, deceleration: float, jerk: float) -> list[Piece]:
    """Pieces of the stop from a forward state (v + a|a|/(2J) >= 0, a >= -A-): -J, constant -A-, +J."""
    q = max(0.0, v * jerk + 0.5 * a * a)
    if q <= deceleration * deceleration:
        top = sqrt(q)
        return [(max(0.0, a + top) / jerk, a, -jerk), (top / jerk, -top, jerk)]
    hold = (q - deceleration * deceleration) / (jerk * deceleration)
    return [
        (max(0.0, a + deceleration) / jerk, a, -jerk),
        (hold, -deceleration, 0.0),
        (deceleration / jerk, -deceleration, jerk),
    ]
