"""Acceleration of an endlessly rotating spindle over its speed, a(n) (TF5200 spindle 2.8.4).

    hyperbola      a = a_konst for n < n_grenz, then b1 / (1 + b2·x²·(1 + b3·x²)) with x = n / n_grenz
    polynomial     a = a_konst for n < n_grenz, then a_konst + b1·Δn + b2·Δn² + b3·Δn³ with Δn = n - n_grenz
    asynchronous   a = a_max for n < n1, then a_max·n1 / n, from n2 on a_max·n1·n2 / n²

with the floor a_min everywhere. Units: °/s and °/s². Every piece is a quotient P(u) / Q(u) of two polynomials, so the
power series of the motion dn/dt = ±a(n) has the same recursion for all: Q(u)·u' = ±P(u).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import inf
from typing import NamedTuple

from cnc_ptp.motion.polynomials import crossing, roots_between, value
from cnc_ptp.parameters import CurveParameters

ORDER = 12
"""Highest power of time in a segment of a ramp …"""
TRUNCATION = 1e-14
"""… which ends where that power would be worth more than this part of the speed."""

RampPart = tuple[float, tuple[float, ...]]
"""A part of a ramp: duration in s, speed as ascending powers of the time since its start."""


class CurvePiece(NamedTuple):
    """a(n) = P(u) / Q(u) with u = n - origin, for low <= n <= high; ascending coefficients."""

    low: float
    high: float
    numerator: tuple[float, ...]
    denominator: tuple[float, ...] = (1.0,)
    origin: float = 0.0

    def acceleration(self, speed: float) -> float:
        u = speed - self.origin
        return value(self.numerator, u) / value(self.denominator, u)

    @property
    def constant(self) -> bool:
        return len(self.numerator) == len(self.denominator) == 1

    def crossings(self, level: float) -> list[float]:
        """Speeds inside the piece at which the acceleration passes `level`: roots of P - level·Q."""
        size = max(len(self.numerator), len(self.denominator))
        p, q = ([*part, *[0.0] * (size - len(part))] for part in (self.numerator, self.denominator))
        difference = [a - level * b for a, b in zip(p, q, strict=True)]
        roots = roots_between(difference, self.low - self.origin, self.high - self.origin)
        return [root + self.origin for root in roots]


class AccelerationCurve:
    """a(n) for 0 <= n <= top speed; above it the acceleration is that at the top speed."""

    def __init__(self, parameters: CurveParameters, *, top_speed: float, most: float = inf) -> None:
        """`top_speed` in °/s; `most` in °/s²: the limit of the tool, also below the floor."""
        pieces = [
            piece for raw in raw_pieces(parameters, top_speed) for piece in bounded(raw, parameters.minimum, most)
        ]
        last = pieces[-1]
        self.pieces = (*pieces, CurvePiece(last.high, inf, (last.acceleration(last.high),)))

    def acceleration(self, speed: float) -> float:
        """a(|speed|) in °/s²; where the curve steps, the value above the step."""
        return self._piece(abs(speed), grows=True).acceleration(abs(speed))

    def _piece(self, speed: float, *, grows: bool) -> CurvePiece:
        """The piece that a growing, or falling, speed goes through next."""
        if grows:
            return next(piece for piece in self.pieces if speed < piece.high)
        return next(piece for piece in reversed(self.pieces) if piece.low < speed)

    def parts(self, speed: float, target: float) -> Iterator[RampPart]:
        """The ramp from one magnitude of speed to another, both >= 0."""
        sign = 1.0 if target > speed else -1.0
        while speed != target:
            piece = self._piece(speed, grows=target > speed)
            border = min(piece.high, target) if sign > 0.0 else max(piece.low, target)
            duration, powers = part_to(piece, speed, border, sign)
            yield duration, powers
            reached = value(powers, duration)
            passed = (border - reached) * sign <= abs(border) * 1e-15
            speed = border if passed else reached


def raw_pieces(parameters: CurveParameters, top_speed: float) -> list[CurvePiece]:
    """The curve without floor, up to `top_speed`."""
    if parameters.kind == "asynchronous":
        a, n1, n2 = parameters.maximum, parameters.n1, parameters.n2
        pieces = [
            CurvePiece(0.0, n1, (a,)),
            CurvePiece(n1, n2, (a * n1,), (0.0, 1.0)),
            CurvePiece(n2, inf, (a * n1 * n2,), (0.0, 0.0, 1.0)),
        ]
    else:
        limit, b1, b2, b3 = parameters.limit_speed, parameters.b1, parameters.b2, parameters.b3
        law = CurvePiece(limit, inf, (parameters.constant, b1, b2, b3), origin=limit)
        if parameters.kind == "hyperbola":
            square = limit * limit
            law = CurvePiece(limit, inf, (b1,), (1.0, 0.0, b2 / square, 0.0, b2 * b3 / (square * square)))
        pieces = [CurvePiece(0.0, limit, (parameters.constant,)), law]
    return [
        piece._replace(high=min(piece.high, top_speed)) for piece in pieces if piece.low < min(piece.high, top_speed)
    ]


def bounded(piece: CurvePiece, least: float, most: float) -> Iterator[CurvePiece]:
    """The piece cut where it passes the bounds, constant beyond them; the upper bound counts where they contradict."""
    passed = piece.crossings(least) + (piece.crossings(most) if most < inf else [])
    borders = [piece.low, *sorted(passed), piece.high]
    for low, high in pairwise(borders):
        if low < high:
            middle = piece.acceleration(0.5 * (low + high))
            held = min(max(middle, least), most)
            part = piece._replace(low=low, high=high)
            yield part if held == middle else CurvePiece(low, high, (held,))


def part_to(piece: CurvePiece, speed: float, border: float, sign: float) -> RampPart:
    """The longest part from `speed` towards `border` that the power series carries."""
    if piece.constant:
        rate = sign * piece.numerator[0]
        return (border - speed) / rate, (speed, rate)
    powers = power_series(piece, speed, sign)
    reach = min(series_reach(powers), 2.0 * abs((border - speed) / powers[1]))
    if (value(powers, reach) - border) * sign < 0.0:
        return reach, powers
    return crossing(powers, border, reach), powers


def power_series(piece: CurvePiece, speed: float, sign: float) -> tuple[float, ...]:
    """Coefficients of n(t) for dn/dt = sign·P/Q from `speed` on.

    With Q·u' = sign·P, coefficient by coefficient: (k+1)·q0·u[k+1] = sign·p[k] - Σ q[i]·(k-i+1)·u[k-i+1], i = 1 … k,
    where p[k] and q[k] are the coefficients of t^k in P(u(t)) and Q(u(t)).
    """
    u = [speed - piece.origin]
    q: list[float] = []
    degree = max(len(piece.numerator), len(piece.denominator))
    products: list[list[float]] = [[] for _ in range(degree)]
    for k in range(ORDER):
        extend_products(products, u, k)
        p = sum(c * products[m][k] for m, c in enumerate(piece.numerator))
        q.append(sum(c * products[m][k] for m, c in enumerate(piece.denominator)))
        known = sum(q[i] * (k - i + 1) * u[k - i + 1] for i in range(1, k + 1))
        u.append((sign * p - known) / ((k + 1) * q[0]))
    return (speed, *u[1:])


def extend_products(products: Sequence[list[float]], u: Sequence[float], k: int) -> None:
    """Appends the coefficient of t^k to the series of u⁰, u¹, u² …"""
    for m, product in enumerate(products):
        if m == 0:
            product.append(1.0 if k == 0 else 0.0)
        elif m == 1:
            product.append(u[k])
        else:
            lower = products[m - 1]
            product.append(sum(lower[i] * u[k - i] for i in range(k + 1)))


def series_reach(powers: Sequence[float]) -> float:
    """Seconds for which the series is as good as exact: its last two terms stay below TRUNCATION of the speed."""
    worth = TRUNCATION * max(abs(powers[0]), 1.0)
    reach = inf
    for k in (len(powers) - 2, len(powers) - 1):
        if powers[k]:
            reach = min(reach, (worth / abs(powers[k])) ** (1.0 / k))
    return reach
