"""A whole motion as programs say it: a line or an arc."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, cos, pi, sin
from typing import Final, NamedTuple

Point = tuple[float, ...]
Shape = tuple[float, float, float, float]
"""q and its first three derivatives by the path of one axis."""

ON_A_LINE: Final = 8
"""Parts of a line in which an axis is looked for that turns round, once in each."""
IN_A_TURN: Final = 32
"""The same of a circle."""
HALVINGS: Final = 60


class Way(NamedTuple):
    """q(u) = base + u · linear + cosine · cos φ + sine · sin φ with φ = begin + u · sweep, u from 0 to 1.

    Lengths in mm (deg for rotary axes), angles in rad; a line has no cosine and sine.
    """

    base: Point
    linear: Point
    cosine: Point = ()
    sine: Point = ()
    begin: float = 0.0
    sweep: float = 0.0

    @property
    def straight(self) -> bool:
        return not self.cosine

    def shape(self, u: float) -> list[Shape]:
        """q and its derivatives by u of each programmed axis."""
        if self.straight:
            return [(q + u * d, d, 0.0, 0.0) for q, d in zip(self.base, self.linear, strict=True)]
        w, angle = self.sweep, self.begin + u * self.sweep
        x, y = cos(angle), sin(angle)
        return [
            (
                q + u * d + a * x + b * y,
                d + w * (b * x - a * y),
                -w * w * (a * x + b * y),
                w * w * w * (a * y - b * x),
            )
            for q, d, a, b in zip(self.base, self.linear, self.cosine, self.sine, strict=True)
        ]

    def point(self, u: float) -> Point:
        return tuple([q for q, _, _, _ in self.shape(u)])

    def changes(self, slope: Callable[[float], float]) -> list[float]:
        """Places at which a function of u changes its sign, where it does so once in a part of the way."""
        parts = ON_A_LINE if self.straight else max(ON_A_LINE, ceil(abs(self.sweep) / (2.0 * pi) * IN_A_TURN))
        places = [n / parts for n in range(parts + 1)]
        values = [slope(u) for u in places]
        return [
            _root(slope, places[n], places[n + 1], rises=values[n] < 0.0)
            for n in range(parts)
            if values[n] * values[n + 1] < 0.0
        ] + [u for u, value in zip(places[1:-1], values[1:-1], strict=True) if value == 0.0]


def _root(function: Callable[[float], float], low: float, high: float, *, rises: bool) -> float:
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if (function(middle) < 0.0) == rises:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
