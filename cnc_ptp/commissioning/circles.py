"""Circles through measured points: least squares, and the narrowest ring (minimum zone)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

from cnc_ptp.commissioning.trace import Array

CLOSE = 1e-12
"""Relative to the radius: a centre that moves less has been found."""
MOST_ROUNDS = 50
FIRST_POINTS = 64


@dataclass(frozen=True, slots=True)
class Circle:
    """Centre (2,) and radius, mm."""

    centre: tuple[float, float]
    radius: float


@dataclass(frozen=True, slots=True)
class Zone:
    """The narrowest ring that holds all points, mm."""

    centre: tuple[float, float]
    inner: float
    outer: float

    @property
    def width(self) -> float:
        return self.outer - self.inner


def least_squares_circle(points: Array) -> Circle:
    """The circle with the smallest sum of squared radial distances to `points` (n, 2), n > 2 and not in a line.

    Gauss-Newton on r_i = |p_i - c|: dr_i = -u_i·dc, from the algebraic fit |p|² = 2·c·p + const.
    """
    system = np.column_stack([2.0 * points, np.ones(len(points))])
    solution = np.linalg.lstsq(system, np.sum(points**2, axis=1), rcond=None)[0]
    centre = solution[:2]
    for _ in range(MOST_ROUNDS):
        directions, radii = _polar(points, centre)
        step = np.linalg.lstsq(np.column_stack([directions, np.ones(len(points))]), radii, rcond=None)[0]
        centre = centre + step[:2]
        if np.hypot(*step[:2]) <= CLOSE * step[2]:
            break
    return Circle((float(centre[0]), float(centre[1])), float(np.mean(_polar(points, centre)[1])))


def minimum_zone(points: Array) -> Zone:
    """The two concentric circles closest to each other with all `points` (n, 2) between them.

    Minimises outer - inner over centre, inner and outer radius. About a centre c the distances are r_i - u_i·dc in
    first order, so each round is a linear program, and c moves until it converges. Of many points only those are
    used that were outside the ring in some round.
    """
    centre = np.array(least_squares_circle(points).centre)
    chosen = np.unique(np.linspace(0, len(points) - 1, min(len(points), FIRST_POINTS)).astype(int))
    for _ in range(MOST_ROUNDS):
        directions, radii = _polar(points, centre)
        step, inner, outer = _narrowest(directions[chosen], radii[chosen])
        centre = centre + step
        radii = _polar(points, centre)[1]
        tolerance = CLOSE * outer
        extremes = np.array([int(np.argmin(radii)), int(np.argmax(radii))])
        outside = extremes[(radii[extremes] < inner - tolerance) | (radii[extremes] > outer + tolerance)]
        if len(outside) == 0 and np.hypot(*step) <= tolerance:
            break
        chosen = np.union1d(chosen, outside)
    return Zone((float(centre[0]), float(centre[1])), float(radii.min()), float(radii.max()))


def _polar(points: Array, centre: Array) -> tuple[Array, Array]:
    """Unit vectors (n, 2) from the centre to the points, and distances (n,)."""
    offsets = points - centre
    radii = np.hypot(offsets[:, 0], offsets[:, 1])
    return offsets / radii[:, None], radii


def _narrowest(directions: Array, radii: Array) -> tuple[Array, float, float]:
    """Step of the centre, inner and outer radius: least outer - inner with inner <= r - u·step <= outer.

    Distances are counted from their mean in units of their spread, so that the solver's tolerances do not matter.
    """
    mean, spread = float(np.mean(radii)), float(np.ptp(radii))
    if spread == 0.0:
        return np.zeros(2), mean, mean
    relative, ones = (radii - mean) / spread, np.ones((len(radii), 1))
    none = np.zeros_like(ones)
    below = np.hstack([directions, ones, none])
    above = np.hstack([-directions, none, -ones])
    solution = linprog(
        [0.0, 0.0, -1.0, 1.0],
        A_ub=np.vstack([below, above]),
        b_ub=np.concatenate([relative, -relative]),
        bounds=[(None, None)] * 4,
        method="highs",
    ).x
    return solution[:2] * spread, mean + float(solution[2]) * spread, mean + float(solution[3]) * spread
