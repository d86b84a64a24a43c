"""Profiles whose acceleration changes in sine-squared ramps (SIN2): the jerk has no step, either.

A ramp of the acceleration from a by D within T is, with x = t/T,

    a(t) = a + D·sin²(π·x/2)                          jerk at most π/2·D/T
    v(t) = v + a·t + D/2·(t - T/π·sin(π·x))
    p(t) = p + v·t + a·t²/2 + D/2·(t²/2 - (T/π)²·(1 - cos(π·x)))

At its end v is that of a ramp with constant jerk D/T, p is not; but a ramp up and one down of the same size and time
make up for each other. So a table of constant-jerk segments, planned with 2/π of the jerk, becomes such a profile with
the same velocities, and the same end where its ramps come in such pairs (`reaching` sees to the others).
"""

from __future__ import annotations

from bisect import bisect_right
from itertools import pairwise
from math import cos, pi, sin
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cnc_ptp.motion.limits import Limits
from cnc_ptp.motion.profile import Profile, Segment
from cnc_ptp.motion.ramp import stopping_distance
from cnc_ptp.motion.rest_to_rest import plan_rest_to_rest
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.motion.to_position import plan_to_position
from cnc_ptp.motion.to_velocity import plan_to_velocity

JERK_PART: Final = 2.0 / pi
"""Part of the jerk with which the table is planned: the ramps take up to π/2 of that."""
ROUNDS: Final = 20
CLOSE: Final = 1e-10
"""mm by which a profile may miss its target before its last row is set to it."""
RAMP_DISTANCE: Final = 0.25 - 1.0 / (pi * pi)
"""p of a ramp from rest in D·T²."""


class SineProfile(Profile):
    """A table like that of Profile, whose segments with a jerk are sine-squared ramps of the acceleration."""

    __slots__ = ()

    def state_at(self, t: float) -> MotionState:
        """As Profile.state_at."""
        if t < 0.0:
            t = 0.0
        index = bisect_right(self.starts, t) - 1
        start, p, v, a, j = self.rows[index]
        d = t - start
        if j == 0.0:
            return p + d * (v + d * (0.5 * a)), v + d * a, a, 0.0
        duration = self.starts[index + 1] - start
        size, rate = 0.5 * j * duration, pi / duration
        wave, turn = sin(rate * d), 1.0 - cos(rate * d)
        return (
            p + d * (v + 0.5 * d * (a + size)) - size / (rate * rate) * turn,
            v + d * (a + size) - size / rate * wave,
            a + size * turn,
            size * rate * wave,
        )

    def settled(self, t: float) -> float:
        """The end of the ramp that is active at `t`."""
        if t <= 0.0 or t >= self.duration:
            return t
        index = bisect_right(self.starts, t) - 1
        return self.starts[index + 1] if self.rows[index][4] else t

    def continued(self, t: float, following: Profile) -> SineProfile:
        """This profile up to `t`, then another one."""
        begun = self.rows[: bisect_right(self.starts, t) - 1]
        return SineProfile([*begun, *[(t + row[0], *row[1:]) for row in following.rows]])

    def sample(self, times: ArrayLike) -> NDArray[np.float64]:
        """As Profile.sample."""
        return np.array([self.state_at(t) for t in np.asarray(times, dtype=np.float64).tolist()]).T


def sine_from_rest(start: float, target: float, limits: Limits) -> Profile:
    """Rest to rest."""
    return SineProfile(shaped(plan_rest_to_rest(start, target, softer(limits)), target))


def sine_to_position(p: float, v: float, a: float, target: float, limits: Limits) -> Profile:
    """To rest at the target; an acceleration at the start ends first. Where there is no room for that, with a stop."""
    rows, t, ahead, speed = ended(p, v, a, limits)
    soft = softer(limits)
    following = reaching(ahead, speed, target, soft)
    if following is None:
        rows = list(sine_to_rest(p, v, a, limits).rows)
        t, ahead, _, _, _ = rows.pop()
        following = shaped(plan_rest_to_rest(ahead, target, soft), target)
    return SineProfile([*rows, *[(t + row[0], *row[1:]) for row in following]])


def reaching(p: float, v: float, target: float, soft: Limits) -> list[Segment] | None:
    """Rows to rest at the target; None if none are found.

    Where the path slows down and brakes in one go, its ramps differ, and the table has to aim beside the target.
    """
    aim = target
    for _ in range(ROUNDS):
        if aim - p < stopping_distance(v, 0.0, soft.deceleration, soft.jerk):
            return None
        rows = shaped(plan_to_position(p, v, 0.0, aim, soft))
        miss = rows[-1][1] - target
        if abs(miss) <= CLOSE:
            return [*rows[:-1], (rows[-1][0], target, *rows[-1][2:])]
        aim -= miss
    return None


def sine_to_rest(p: float, v: float, a: float, limits: Limits) -> Profile:
    """To rest as soon as possible."""
    return SineProfile(shaped(plan_to_velocity(p, v, a, 0.0, softer(limits))))


def sine_stopping_distance(v: float, a: float, limits: Limits) -> float:
    """Distance of `sine_to_rest`."""
    return sine_to_rest(0.0, v, a, limits).end[0]


def softer(limits: Limits) -> Limits:
    """Limits for the table."""
    return limits._replace(jerk=JERK_PART * limits.jerk)


def ended(p: float, v: float, a: float, limits: Limits) -> tuple[list[Segment], float, float, float]:
    """The row of the ramp that takes the acceleration to 0, and t, p, v at its end."""
    if a == 0.0:
        return [], 0.0, p, v
    duration = abs(a) / softer(limits).jerk
    if v + 0.5 * a * duration < 0.0 < v:
        duration = -2.0 * v / a  # by rounding alone: a ramp to rest
    row = (0.0, p, v, a, -a / duration)
    return [row], duration, p + v * duration + a * duration**2 * (0.5 - RAMP_DISTANCE), v + 0.5 * a * duration


def shaped(table: Profile, target: float | None = None) -> list[Segment]:
    """Rows of the profile of a table; `target`: its end, if that is to be exact."""
    rows: list[Segment] = []
    segments = divided(table.rows)
    p = segments[0][1]
    for (t, _, v, a, j), following in pairwise(segments):
        d = following[0] - t
        rows.append((t, p, v, a, j))
        p += d * (v + d * (0.5 * a + d * j * RAMP_DISTANCE))
    t, _, v, a, j = segments[-1]
    rows.append((t, p if target is None else target, v, a, j))
    return rows


def divided(rows: tuple[Segment, ...]) -> list[Segment]:
    """Segments in which the acceleration changes its sign become two."""
    found: list[Segment] = []
    for row, following in pairwise(rows):
        t, p, v, a, j = row
        found.append(row)
        d = -a / j if j else 0.0
        if 0.0 < d < following[0] - t and a:
            found.append((t + d, p, v + 0.5 * a * d, 0.0, j))
    found.append(rows[-1])
    return found
