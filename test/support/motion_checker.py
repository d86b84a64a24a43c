"""An independent checker of thousands of runtime tables at once: integrated again with long doubles, piece by piece.

Arrays are (n, m): n motions of at most m rows, shorter ones filled with their last row. Tolerances are 1e-9 of the
largest value of the motion, for positions of the distance it covers, plus what the rounding of the numbers themselves
moves: eight units in the last place of the position, two of the time (a by J·ulp, v by a·ulp, p by v·ulp).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from motion_problems import Problem

from cnc_ptp.motion import Profile
from cnc_ptp.motion.limits import NEGLIGIBLE_DISTANCE

RELATIVE = 1e-9
Array = Any


class Motions:
    """Tables t, p, v, a, j (n, m), start states p0, v0, a0 and limits V, A+, A-, J (n, 1)."""

    def __init__(self, tables: Array, starts: Array, limits: Array) -> None:
        self.t, self.p, self.v, self.a, self.j = tables
        self.p0, self.v0, self.a0 = starts[:, :, None]
        self.velocity, self.growth, self.reduction, self.jerk = limits[:, :, None]
        self.d = np.diff(self.t, axis=1)
        self.time_ulp = 2.0 * np.spacing(self.t[:, -1:])

    @classmethod
    def of(cls, problems: Sequence[Problem], profiles: Sequence[Profile]) -> Motions:
        starts = np.array([problem[:3] for problem in problems]).T
        return cls(tables(profiles), starts, np.array([problem.limits for problem in problems]).T)


def tables(profiles: Sequence[Profile]) -> Array:
    """(5, n, m): the rows of all profiles, filled with their last row."""
    counts = np.array([len(profile.rows) for profile in profiles])
    rows = np.array([row for profile in profiles for row in profile.rows])
    first = np.concatenate(([0], np.cumsum(counts)[:-1]))
    index = first[:, None] + np.minimum(np.arange(counts.max()), counts[:, None] - 1)
    return rows[index].transpose(2, 0, 1)


def steps(motions: Motions) -> Array:
    """(3, n): the largest step of position, velocity and acceleration at a row border, in tolerances."""
    long = [each[:, :-1].astype(np.longdouble) for each in (motions.p, motions.v, motions.a, motions.j)]
    p, v, a, j = long
    d = motions.d.astype(np.longdouble)
    reached = (p + d * (v + d * (a / 2 + d * j / 6)), v + d * (a + d * j / 2), a + d * j)
    most_v, most_a = (np.abs(each).max(axis=1, keepdims=True) for each in (motions.v, motions.a))
    way = np.abs(motions.p - motions.p0).max(axis=1, keepdims=True)
    ulp = motions.time_ulp
    allowed = (
        RELATIVE * way + 8.0 * np.spacing(np.abs(motions.p).max(axis=1, keepdims=True)) + ulp * most_v,
        RELATIVE * most_v + ulp * most_a,
        RELATIVE * most_a + ulp * motions.jerk,
    )
    found = [
        (np.abs(end - begin[:, 1:]) / (most + NEGLIGIBLE_DISTANCE)).max(axis=1)
        for end, begin, most in zip(reached, (motions.p, motions.v, motions.a), allowed, strict=True)
    ]
    return np.array(found, dtype=float)


def over_velocity(motions: Motions) -> Array:
    """(n,): largest |v| over what is allowed: V, and until the fastest ramp to V is over the speed it cannot avoid."""
    d, v, a, j = motions.d, motions.v[:, :-1], motions.a[:, :-1], motions.j[:, :-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = np.where(j == 0.0, 0.0, np.clip(-a / j, 0.0, d))
    fastest = time_above_velocity(motions)
    last = np.maximum((motions.t[:, :-1] <= fastest).sum(axis=1, keepdims=True) - 1, 0)
    since = fastest - np.take_along_axis(motions.t, last, axis=1)
    v1, a1, j1 = (np.take_along_axis(each, last, axis=1) for each in (motions.v, motions.a, motions.j))
    then = v1 + since * (a1 + since * j1 / 2)
    speeds = np.abs(np.concatenate((motions.v, v + turn * (a + turn * j / 2), then), axis=1))
    times = np.concatenate((motions.t, motions.t[:, :-1] + turn, fastest), axis=1)
    unavoidable = np.maximum(
        np.abs(motions.v0), np.abs(motions.v0 + motions.a0 * np.abs(motions.a0) / 2 / motions.jerk)
    )
    leaving = times < fastest * (1.0 - 1e-13)
    allowed = np.where(leaving, np.maximum(unavoidable, motions.velocity), motions.velocity)
    rounding = (
        RELATIVE * allowed + 1e-15 * unavoidable + motions.time_ulp * np.abs(motions.a).max(axis=1, keepdims=True)
    )
    return ((speeds - allowed) / rounding).max(axis=1)


def time_above_velocity(motions: Motions) -> Array:
    """(n, 1): time of the fastest ramp from above V to (V, 0).

    Jerk -J to the peak -√(J(v - V) + a²/2), or to -A-, held until +J ends at V; from a < -A- jerk +J comes first.
    A start whose acceleration alone leads within V is there after |a|/J, one that does not leave V at once.
    """
    j, bound = motions.jerk, motions.reduction
    s = np.copysign(1.0, motions.v0 + motions.a0 * np.abs(motions.a0) / 2 / j)
    v, a = s * motions.v0, s * motions.a0
    above = v + a * np.abs(a) / 2 / j - motions.velocity
    peak = np.sqrt(np.maximum(0.0, j * (v - motions.velocity) + a * a / 2))
    late = (np.abs(a + bound) + bound) / j
    by_peak = np.where(peak <= bound, (a + 2 * peak) / j, late + (peak * peak - bound * bound) / j / bound)
    alone = np.where(np.abs(v) > motions.velocity, np.abs(a) / j, 0.0)
    return np.where(above > 0.0, np.where(a < -bound, late + above / bound, by_peak), alone)


def over_acceleration(motions: Motions) -> Array:
    """(n,): largest |a| over its bound in tolerances: A+ where |v| grows, A- where it falls.

    Segments are cut where v = 0. An |a0| above its bound may last as long as full jerk needs. A velocity that is
    rounding beside those of the motion has no direction.
    """
    d, v, a, j = motions.d, motions.v[:, :-1], motions.a[:, :-1], motions.j[:, :-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(a * a - 2 * j * v)
        zeros = [np.where(j == 0.0, -v / a, (-a + sign * root) / j) for sign in (-1.0, 1.0)]
    cuts = np.sort([np.zeros_like(d), d, *(np.clip(np.nan_to_num(zero, nan=0.0), 0.0, d) for zero in zeros)], axis=0)
    still = 16.0 * np.spacing(np.abs(motions.v).max(axis=1, keepdims=True))
    worst = np.full(len(d), -np.inf)
    for begin, end in pairwise(cuts):
        middle = (begin + end) / 2
        direction = v + middle * (a + middle * j / 2)
        for moment in (begin, end):
            here = a + moment * j
            bound = np.where(here * direction > 0.0, motions.growth, motions.reduction)
            bound = np.where(np.abs(direction) < still, np.maximum(motions.growth, motions.reduction), bound)
            falling = np.abs(motions.a0) - motions.jerk * (motions.t[:, :-1] + moment)
            bound = np.maximum(bound, np.where(here * motions.a0 > 0.0, falling, 0.0))
            rounding = RELATIVE * bound + motions.jerk * motions.time_ulp
            over = np.where(end > begin, (np.abs(here) - bound) / rounding, -np.inf)
            worst = np.maximum(worst, over.max(axis=1, initial=-np.inf))
    return worst


def assert_motions(problems: Sequence[Problem], profiles: Sequence[Profile]) -> None:
    """Exact start and end, ascending times, jerks 0 or ±J, no step at any border, limits kept."""
    motions = Motions.of(problems, profiles)
    for problem, profile in zip(problems, profiles, strict=True):
        assert profile.end == (problem.target, 0.0, 0.0), problem
        assert profile.rows[0][:4] == (0.0, *problem[:3]) or len(profile.rows) == 1, problem
    assert (motions.d >= 0.0).all()
    assert np.isin(np.abs(motions.j) / motions.jerk, (0.0, 1.0)).all()
    for name, found in zip(("position step", "velocity step", "acceleration step"), steps(motions), strict=True):
        assert_all(found, name, problems)
    assert_all(over_velocity(motions), "velocity above V", problems)
    assert_all(over_acceleration(motions), "acceleration above A+ or A-", problems)


def assert_all(found: Array, name: str, problems: Sequence[object]) -> None:
    """No value above 1 tolerance; the worst problem is named."""
    worst = int(np.argmax(found))
    assert found[worst] <= 1.0, (
        f"{name}: {found[worst]:.3g} tolerances in {(found > 1).sum()} problems, {problems[worst]}"
    )
