"""How far the state of a cycle may be from that of the cycle before: closed forms of the bounds.

With T the cycle time and Δ the difference of two neighbouring cycles:

    jerk within ±J            |Δa| <= J·T
                              |Δv - T/2·(a0 + a1)| <= J·T²/4·(1 - (Δa/JT)²)
                              |Δx - T/2·(v0 + v1) + T²/12·Δa| <= J·T³/(18·√3)
    acceleration within ±A    |Δv| <= A·T
                              |Δx - T/2·(v0 + v1)| <= A·T²/4·(1 - (Δv/AT)²)

Each is reached by the bang-bang motion of that limit, so that no smaller bound holds; the third follows from Peano's
kernel (s² - T²/12)/2 of the corrected trapezoidal rule, of which J·∫|kernel| is the largest value. At constant jerk ±J
the first line is an equation, and the second one requires the closed form of constant jerk to the last place.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from cnc_ptp.recording.motion_check.findings import Findings, Mask, Numbers
from cnc_ptp.recording.motion_check.laws import FREE, JERK, STEP, Laws

PLACES = 16
"""Units in the last place by which a number may be off that is computed from others of its size."""
PEANO = 1.0 / (18.0 * sqrt(3.0))


@dataclass(frozen=True, slots=True)
class Setpoints:
    """Columns (n,) of one unit: position, velocity, acceleration, in mm and s or deg and s.

    joined      (n-1,) the next row is the next cycle
    cycle_time  s
    last_time   of the last row, s
    length      mm or deg
    """

    position: Numbers
    velocity: Numbers
    acceleration: Numbers
    joined: Mask
    cycle_time: float
    last_time: float
    length: str


def check_continuity(points: Setpoints, laws: Laws, found: Findings) -> None:
    """Position, velocity and acceleration of all neighbouring cycles; a violation is at the later one."""
    unit = points.length
    with np.errstate(over="ignore", invalid="ignore"):  # of what is no number, or far from every limit
        pairs = _Pairs(points, laws)
        pairs.tell(found, "step of acceleration", pairs.da, *pairs.acceleration_bound(), f"{unit}/s²")
        pairs.tell(found, "step of velocity", *pairs.velocity_step(), f"{unit}/s")
        pairs.tell(found, "step of position", *pairs.position_step(), unit)


class _Pairs:
    """Neighbouring rows. A row of a pair gives the law of the pair if it permits more than that of the other."""

    def __init__(self, points: Setpoints, laws: Laws) -> None:
        self.points, self.laws = points, laws
        self.da, self.dv, self.dx = (np.diff(each) for each in (points.acceleration, points.velocity, points.position))
        self.law = np.maximum(laws.law[:-1], laws.law[1:])
        self.jerk = larger(laws.jerk)
        self.most = np.maximum(larger(laws.growth), larger(laws.reduction))
        self.velocity = larger(laws.velocity)
        self.relative = 1.0 + larger(laws.relative)
        self.kinks = laws.kinks[:-1] & laws.kinks[1:]
        late = PLACES * np.spacing(points.last_time)
        """By how much the time of a row may be off, s."""
        self.blur_v = PLACES * np.spacing(larger(np.abs(points.velocity))) + late * self.finite_most()
        self.blur_x = PLACES * np.spacing(larger(np.abs(points.position))) + late * larger(np.abs(points.velocity))
        self.blur_a = PLACES * np.spacing(self.finite_most()) + late * np.where(np.isfinite(self.jerk), self.jerk, 0.0)

    def finite_most(self) -> Numbers:
        """The largest acceleration of a pair, mm/s² (deg/s²)."""
        recorded = larger(np.abs(self.points.acceleration))
        return np.where(np.isfinite(self.most), np.maximum(self.most, recorded), recorded)

    def tell(self, found: Findings, what: str, off: Numbers, bound: Numbers, checked: Mask, units: str) -> None:
        wrong = self.points.joined & checked & ~(np.abs(off) <= bound)
        found.above(what, of_later(off), of_later(bound), np.concatenate(([False], wrong)), units)

    def acceleration_bound(self) -> tuple[Numbers, Mask]:
        bound = self.jerk * self.points.cycle_time * self.relative + self.blur_a
        return bound, (self.law == JERK) & np.isfinite(self.jerk)

    def velocity_step(self) -> tuple[Numbers, Numbers, Mask]:
        t, jerk = self.points.cycle_time, np.where(np.isfinite(self.jerk), self.jerk, 0.0)
        mean = self.points.acceleration[:-1] + self.points.acceleration[1:]
        by_jerk = self.dv - 0.5 * t * mean
        share = np.minimum(1.0, np.abs(self.da) / np.maximum(jerk * t, 1e-300))
        bound = 0.25 * jerk * t * t * (1.0 - share * share) + np.where(self.kinks, 0.5 * jerk * t * t, 0.0)
        bound += (self.relative - 1.0) * (jerk * t * t + np.abs(self.dv)) + self.blur_v
        uses_jerk = (self.law == JERK) & np.isfinite(self.jerk)
        by_steps = self.most * t * self.relative + self.blur_v
        checked = (self.law < FREE) & (uses_jerk | np.isfinite(self.most))
        return np.where(uses_jerk, by_jerk, self.dv), np.where(uses_jerk, bound, by_steps), checked

    def position_step(self) -> tuple[Numbers, Numbers, Mask]:
        t, jerk = self.points.cycle_time, np.where(np.isfinite(self.jerk), self.jerk, 0.0)
        plain = self.dx - 0.5 * t * (self.points.velocity[:-1] + self.points.velocity[1:])
        by_jerk = plain + t * t / 12.0 * self.da
        slack = (self.relative - 1.0) * (jerk * t**3 + np.abs(self.dx)) + self.blur_x
        bound = jerk * t**3 * (PEANO + np.where(self.kinks, 0.25, 0.0)) + slack
        uses_jerk = (self.law == JERK) & np.isfinite(self.jerk)
        most = np.where(np.isfinite(self.most), self.most, 0.0)
        share = np.minimum(1.0, np.abs(self.dv) / np.maximum(most * t, 1e-300))
        by_steps = 0.25 * most * t * t * (1.0 - share * share) + self.relative_part(most * t * t) + self.blur_x
        far = (self.velocity + larger(np.abs(self.points.velocity))) * t * self.relative + self.blur_x
        uses_steps = ~uses_jerk & (self.law <= STEP) & np.isfinite(self.most)
        off = np.where(uses_jerk, by_jerk, np.where(uses_steps, plain, self.dx))
        checked = (uses_jerk | uses_steps | np.isfinite(self.velocity)) & ~self.laws.placed
        return off, np.where(uses_jerk, bound, np.where(uses_steps, by_steps, far)), checked

    def relative_part(self, scale: Numbers) -> Numbers:
        return (self.relative - 1.0) * (scale + np.abs(self.dx))


def of_later(pairs: Numbers) -> Numbers:
    """What pairs of neighbouring rows have (n-1,), in the later row of each: (n,)."""
    return np.concatenate(([0.0], pairs))


def larger(column: Numbers) -> Numbers:
    """Of each row (n,) and the next one: (n-1,)."""
    return np.maximum(column[:-1], column[1:])
