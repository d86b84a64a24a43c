"""Acceleration curves written down once more from the manual, and ramps along them integrated by SciPy."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from cnc_ptp.parameters import CurveParameters

TOP = 48_000.0
HYPERBOLA = CurveParameters(
    "hyperbola", 1400.0, 12_000.0, 16_000.0, 2.285714e4, 4.166666e-1, 2.857142e-2, 0.0, 0.0, 0.0
)
POLYNOMIAL = CurveParameters(
    "polynomial", 2000.0, 12_000.0, 16_000.0, -0.88888888, 2.08333333e-5, -1.92901234e-10, 0.0, 0.0, 0.0
)
ASYNCHRONOUS = CurveParameters("asynchronous", 4000.0, 0.0, 0.0, 0.0, 0.0, 0.0, 16_000.0, 10_000.0, 20_000.0)
CURVES = {"hyperbola": HYPERBOLA, "polynomial": POLYNOMIAL, "asynchronous": ASYNCHRONOUS}


def law(curve: CurveParameters, speed: float) -> float:
    """a(n) of pages 42 and 48, without the floor."""
    n = abs(speed)
    if curve.kind == "asynchronous":
        if n < curve.n1:
            return curve.maximum
        return curve.maximum * curve.n1 / n * (1.0 if n < curve.n2 else curve.n2 / n)
    if n < curve.limit_speed:
        return curve.constant
    d, x = n - curve.limit_speed, n / curve.limit_speed
    if curve.kind == "polynomial":
        return curve.b3 * d**3 + curve.b2 * d**2 + curve.b1 * d + curve.constant
    return curve.b1 / (1.0 + curve.b2 * x**2 * (1.0 + curve.b3 * x**2))


def acceleration(curve: CurveParameters, speed: float, most: float = np.inf) -> float:
    return min(max(law(curve, speed), curve.minimum), most)


def kinks(curve: CurveParameters, most: float = np.inf) -> list[float]:
    """Speeds at which a(n) is not smooth: ends of the laws, floor and cap (found on a grid and refined)."""
    found = [0.0, curve.n1, curve.n2, curve.limit_speed]
    grid = np.linspace(1.0, TOP, 20_001)
    for level in (curve.minimum, most):
        values = np.array([law(curve, n) - level for n in grid])
        for k in np.nonzero(values[:-1] * values[1:] < 0.0)[0]:
            low, high = grid[k], grid[k + 1]
            if not any(low <= kink <= high for kink in found):
                found.append(
                    float(brentq(lambda n, level=level: law(curve, n) - level, low, high, xtol=1e-12, rtol=1e-15))
                )
    return sorted(found)


def integrated(
    curve: CurveParameters, speed: float, target: float, times: NDArray[np.float64], most: float = np.inf
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Speeds and distances at `times` of dn/dt = ±a(n) from `speed` to `target`, and the time that it takes.

    Time is integrated over the speed from kink to kink, so that no step crosses one; then n(t) by a second integration.
    """
    sign = 1.0 if target > speed else -1.0
    inner = {s * kink for kink in kinks(curve, most) for s in (-1.0, 1.0)}
    borders = [
        speed,
        *sorted((n for n in inner if min(speed, target) < n < max(speed, target)), reverse=sign < 0.0),
        target,
    ]
    speeds, ways = np.full(len(times), np.nan), np.full(len(times), np.nan)
    t = way = 0.0
    for begin, end in pairwise(borders):
        middle = 0.5 * (begin + end)
        side = 1.0 if middle > 0.0 else -1.0

        def rate(n: float, begin: float = begin, end: float = end, side: float = side) -> float:
            inside = min(max(n * side, min(begin * side, end * side) + 1e-9), max(begin * side, end * side) - 1e-9)
            return sign * acceleration(curve, inside, most)

        over = solve_ivp(
            lambda n, y: [1.0 / rate(n), n / rate(n)], (begin, end), [0.0, 0.0], method="DOP853", rtol=1e-13, atol=1e-13
        )
        duration, stretch = over.y[0][-1], over.y[1][-1]
        inside = (times >= t) & (times < t + duration)
        if inside.any():
            run = solve_ivp(
                lambda _, y: [rate(y[0]), y[0]],
                (0.0, duration),
                [begin, 0.0],
                method="DOP853",
                rtol=1e-13,
                atol=1e-10,
                t_eval=times[inside] - t,
            )
            speeds[inside], ways[inside] = run.y[0], way + run.y[1]
        t, way = t + duration, way + stretch
    after = times >= t
    speeds[after], ways[after] = target, way + target * (times[after] - t)
    return speeds, ways, t
