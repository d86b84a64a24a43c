"""Coefficients b1 … b3 of an acceleration curve from interpolation points (TF5200 spindle 2.8.4.1).

    polynomial   a = a_konst + b1·Δn + b2·Δn² + b3·Δn³             Δn = n - n_grenz
    hyperbola    a = b1 / (1 + b2·x² + b2·b3·x⁴)                   x = n / n_grenz

Both go through the point at the limit speed. Above it 3 points determine the polynomial, 2 the hyperbola; with more of
them the sum of the squared misses in °/s² is the least. Units: °/s, °/s².
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf

import numpy as np
from scipy.optimize import least_squares

from cnc_ptp.commissioning.curve_points import LARGEST_SPEED, NEEDED_ABOVE, CurvePoint, limit_index, storable
from cnc_ptp.commissioning.faults import (
    BAD_CURVE_RANGE,
    CURVE_NOT_POSITIVE,
    CURVE_POLE,
    CURVE_RISES,
    NO_HYPERBOLA,
)
from cnc_ptp.errors import CncError
from cnc_ptp.motion.polynomials import roots_between, value
from cnc_ptp.parameters import CurveParameters
from cnc_ptp.spindle.acceleration_curves import CurvePiece, raw_pieces

TIGHT = {"ftol": 1e-15, "xtol": 1e-15, "gtol": 1e-15}
Coefficients = tuple[float, float, float]
NEGLIGIBLE = 1e-9
"""Relative; a curve that rises by less is flat, a b1 that is larger by its reciprocal is none."""


@dataclass(frozen=True, slots=True)
class CurveFit:
    """A fitted curve up to `top_speed`; `points` are all that were given, from `limit_index` on they were fitted."""

    parameters: CurveParameters
    points: tuple[CurvePoint, ...]
    limit_index: int
    top_speed: float

    @property
    def exact(self) -> bool:
        """As many points as unknowns."""
        return len(self.points) - self.limit_index - 1 == NEEDED_ABOVE[self.parameters.kind]

    @property
    def law(self) -> CurvePiece:
        """The curve above the limit speed, without floor and without end."""
        return raw_pieces(self.parameters, inf)[1]

    def acceleration(self, speed: float) -> float:
        """The acceleration of the spindle at `speed`, with the floor if there is one."""
        if speed <= self.parameters.limit_speed:
            return self.parameters.constant
        return max(self.law.acceleration(speed), self.parameters.minimum or -inf)

    def misses(self) -> list[float]:
        """Of all points: how far the curve without floor lies above them, °/s²."""
        limit, constant = self.parameters.limit_speed, self.parameters.constant
        return [
            (self.law.acceleration(point.speed) if point.speed > limit else constant) - point.acceleration
            for point in self.points
        ]

    def turns(self) -> list[float]:
        """The limit speed, speeds at which the law turns between falling and rising, and the largest speed."""
        law = self.law
        slope = derivative(law.denominator) if self.parameters.kind == "hyperbola" else derivative(law.numerator)
        inner = roots_between(slope, law.low - law.origin, self.top_speed - law.origin)
        return [law.low, *(root + law.origin for root in inner), self.top_speed]


def fit_curve(
    kind: str,
    points: Sequence[CurvePoint],
    *,
    limit_speed: float | None = None,
    top_speed: float | None = None,
    minimum: float = 0.0,
) -> CurveFit:
    """The curve through or near `points`; `minimum` is the floor a_min.

    Without `limit_speed` the first point is the limit, without `top_speed` the last one the end.
    Raises CncError 27043 … 27047; a curve that a spindle cannot run on is a result, see `curve_fault`.
    """
    index = limit_index(points, kind, limit_speed)
    limit, above = storable(points[index]), points[index + 1 :]
    top = above[-1].speed if top_speed is None else top_speed
    check_range(limit, top, minimum)
    b1, b2, b3 = FITS[kind](limit, above)
    parameters = CurveParameters(kind, minimum, limit.speed, limit.acceleration, b1, b2, b3, 0.0, 0.0, 0.0)
    return CurveFit(parameters, tuple(points), index, top)


def check_range(limit: CurvePoint, top_speed: float, minimum: float) -> None:
    """Raises CncError 27046."""
    if not limit.speed < top_speed <= LARGEST_SPEED:
        reason = f"the largest speed {top_speed:g} °/s is not above the limit speed {limit.speed:g} °/s"
        raise CncError(BAD_CURVE_RANGE, f"{reason} and up to {LARGEST_SPEED:g} °/s", "nothing was fitted")
    if minimum > limit.acceleration:
        reason = f"a_min {minimum:g} °/s² (P-AXIS-00010) is above a_konst {limit.acceleration:g} °/s²"
        raise CncError(BAD_CURVE_RANGE, reason, "nothing was fitted")


def fit_polynomial(limit: CurvePoint, above: Sequence[CurvePoint]) -> Coefficients:
    """b1 in 1/s, b2 in 1/°, b3 in s/°²: linear least squares, with Δn counted in the width of the range."""
    speed, acceleration = np.array(above).T
    width = speed.max() - limit.speed
    part = (speed - limit.speed) / width
    columns = np.column_stack([part, part**2, part**3])
    found = np.linalg.lstsq(columns, acceleration - limit.acceleration, rcond=None)[0]
    b1, b2, b3 = (float(number) for number in found / [width, width**2, width**3])
    return b1, b2, b3


def fit_hyperbola(limit: CurvePoint, above: Sequence[CurvePoint]) -> Coefficients:
    """b1 in °/s², b2, b3. Raises CncError 27047.

    a_konst / a = 1 + d1·(x² - 1) + d2·(x⁴ - 1) is linear in d1, d2 and 1 at the limit speed. With 2 points that is all;
    with more it is the start (weighted as the misses of `a` count), from which the misses themselves are made least.
    """
    speed, acceleration = np.array(above).T
    square, relative = (speed / limit.speed) ** 2, acceleration / limit.acceleration
    columns = np.column_stack([square - 1.0, square**2 - 1.0])
    weight = relative[:, np.newaxis] ** 2
    found = np.linalg.lstsq(columns * weight, (1.0 / relative - 1.0) * weight[:, 0], rcond=None)[0]
    if len(above) > NEEDED_ABOVE["hyperbola"]:
        found = least_squares(lambda d: 1.0 / (1.0 + columns @ d) - relative, found, x_scale="jac", **TIGHT).x
    d1, d2 = (float(number) for number in found)
    d0 = 1.0 - d1 - d2
    if d0 < NEGLIGIBLE or (d1 == 0.0 and d2 != 0.0):
        raise CncError(
            NO_HYPERBOLA,
            f"no hyperbola: the points ask for a_konst/a = {d0:.4g} {d1:+.4g}·x² {d2:+.4g}·x⁴ with x = n/n_grenz, but "
            "the first must be above 0 (b1) and the second not 0 (b2)",
            "nothing was fitted, a polynomial can be",
        )
    return limit.acceleration / d0, d1 / d0, d2 / d1 if d1 else 0.0


FITS: Mapping[str, Callable[[CurvePoint, Sequence[CurvePoint]], Coefficients]] = {
    "polynomial": fit_polynomial,
    "hyperbola": fit_hyperbola,
}


# ---------------------------------------------------------------- whether a spindle can run on it


def curve_fault(fit: CurveFit) -> CncError | None:
    """Why no spindle can run on the curve up to the largest speed; None when it can."""
    return _pole(fit) or _not_positive(fit) or _rise(fit)


def _pole(fit: CurveFit) -> CncError | None:
    """A pole: where the denominator of a hyperbola is 0, the acceleration is infinite."""
    law = fit.law
    low = next((n for n in fit.turns() if value(law.denominator, n - law.origin) <= 0.0), None)
    if low is None:
        return None
    poles = roots_between(law.denominator, law.low - law.origin, low - law.origin)
    at = poles[0] + law.origin if poles else low
    reason = f"the {fit.parameters.kind} has a pole at {at:g} °/s, below the largest speed {fit.top_speed:g} °/s"
    return CncError(CURVE_POLE, reason, NO_LINES)


def _not_positive(fit: CurveFit) -> CncError | None:
    lowest, speed = min((fit.acceleration(speed), speed) for speed in fit.turns())
    if lowest > 0.0:
        return None
    reason = f"the {fit.parameters.kind} falls to {lowest:.6g} °/s² at {speed:g} °/s, acceleration must be above 0"
    return CncError(CURVE_NOT_POSITIVE, f"{reason} (a_min, P-AXIS-00010, is a floor)", NO_LINES)


def _rise(fit: CurveFit) -> CncError | None:
    """Twice the speed with more acceleration is no motor: the fit swings between its points."""
    for speed, following in pairwise(fit.turns()):
        before, after = fit.acceleration(speed), fit.acceleration(following)
        if after > before * (1.0 + NEGLIGIBLE):
            reason = f"the {fit.parameters.kind} rises from {before:.6g} °/s² at {speed:g} °/s"
            return CncError(CURVE_RISES, f"{reason} to {after:.6g} °/s² at {following:g} °/s, it must fall", NO_LINES)
    return None


NO_LINES = "no lines for the machine file were made"


def derivative(coefficients: Sequence[float]) -> list[float]:
    """Of a polynomial with ascending coefficients."""
    return [k * coefficient for k, coefficient in enumerate(coefficients)][1:]
