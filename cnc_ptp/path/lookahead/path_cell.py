"""Cells of the path, for each of which its velocity is planned with what the axes permit there.

Along the path, u is its parameter (mm; the path length on lines and arcs), y = u'² the squared velocity and b = dy/du
twice the acceleration, c = d²y/du². An axis with the derivatives q1, q2, q3 by u has

    velocity      q1·√y
    acceleration  q1·b/2 + q2·y
    jerk          √y·(q1·c/2 + 3/2·q2·b + q3·y)

so that its limits are linear in y, b and c but for the factor √y of the jerk.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import Final

from cnc_ptp.path.geometry import AxisLimits

THIRD_SHARE: Final = 0.9
"""Largest part of an axis's jerk that q3·v³ may take."""
CROSS_SHARE: Final = 0.8
"""Largest part of an axis's jerk that 3·q2·v·a may take while the path accelerates as hard as it can."""
USED_PART: Final = 0.999
"""Part of what a curve leaves of the jerk that is used, because y and b are not quite known before."""
LEAST_SHARE: Final = 0.05
"""Part of an axis's jerk that a change of the acceleration may always take; what that breaks is planned again."""


class AxisLoad:
    """What the path asks of one axis in a cell, and the limits of that axis; q1, q2, q3 with the sign of q1.

    least, first    smallest and largest q1
    second, third   largest |q2|, |q3|
    bend, twist     q2 and q3 in the middle: above 0 the axis is being accelerated
    spread, wring   largest difference of q2 and q3 from these
    """

    __slots__ = (
        "acceleration", "bend", "first", "jerk", "least", "second", "spread", "third", "twist", "velocity", "wring",
    )  # fmt: skip

    def __init__(
        self,
        least: float,
        first: float,
        second: float,
        third: float,
        bend: float,
        spread: float,
        twist: float,
        wring: float,
        limits: AxisLimits,
    ) -> None:
        self.least, self.first, self.second, self.third = least, first, second, third
        self.bend, self.spread = bend, spread
        self.twist, self.wring = twist, wring
        self.velocity, self.jerk = limits.velocity, limits.jerk
        self.acceleration = min(limits.acceleration, limits.deceleration)

    def pull(self, lowest: float, highest: float, slope: float, rising: bool) -> float:
        """Largest 3/2·q2·b + q3·y in the cell at b = `slope`, in the direction of a rising or a falling b."""
        sign = 1.0 if rising else -1.0
        along = 1.5 * sign * self.bend * slope + 1.5 * self.spread * abs(slope) + self.wring * highest
        twist = sign * self.twist
        return along + twist * (highest if twist > 0.0 else lowest)


class PathCell:
    """The path from u = `begin` to `end`; `middle` of the two, `length` in between.

    limit      largest y that the axes permit
    feed       y of the programmed feed at override 1; the limit in rapid traverse
    up, down   largest acceleration and deceleration of a straight path
    jerk       of a straight path
    loads      of the axes where the path is curved, else empty
    planned    y of the last plan, 0 without: what the axes are known to bear
    """

    __slots__ = ("begin", "down", "end", "feed", "jerk", "length", "limit", "loads", "middle", "planned", "up")

    def __init__(
        self,
        begin: float,
        end: float,
        limit: float,
        feed: float,
        up: float,
        down: float,
        jerk: float,
        loads: list[AxisLoad] | None = None,
    ) -> None:
        self.begin, self.end = begin, end
        self.middle, self.length = 0.5 * (begin + end), end - begin
        self.limit, self.feed = limit, feed
        self.up, self.down, self.jerk = up, down, jerk
        self.loads: list[AxisLoad] = loads or []
        self.planned = 0.0

    def part(self, begin: float, end: float) -> PathCell:
        """A part of the cell, or (without length) a knot in it."""
        return PathCell(begin, end, self.limit, self.feed, self.up, self.down, self.jerk, self.loads)

    def acceleration(self, lowest: float, highest: float, braking: bool) -> float:
        """Largest acceleration, or deceleration, along the path while y is within `lowest` … `highest`; at least 0.

        Where the curve pulls an axis the same way, it can brake the harder the faster it is.
        """
        if not self.loads:
            return self.down if braking else self.up
        least = inf
        speed = sqrt(highest) if highest > 0.0 else 0.0
        for load in self.loads:
            if load.first > 0.0:
                pull = (load.bend if braking else -load.bend) - load.spread
                least = min(least, (load.acceleration + pull * (lowest if pull > 0.0 else highest)) / load.first)
            if load.second > 0.0 and speed > 0.0:
                least = min(least, CROSS_SHARE * load.jerk / (3.0 * load.second * speed))
        return max(least, 0.0)

    def bending(self, lowest: float, highest: float, slopes: tuple[float, float], rising: bool) -> float:
        """Largest |c| with which b rises or falls; y is within `lowest` … `highest` and b between two `slopes`."""
        speed = sqrt(max(highest, SMALLEST_SQUARE))
        if not self.loads:
            return 2.0 * self.jerk / speed
        least = inf
        one, other = slopes
        for load in self.loads:
            if load.first > 0.0:
                whole = load.jerk / speed
                pull = max(load.pull(lowest, highest, one, rising), load.pull(lowest, highest, other, rising))
                least = min(least, 2.0 * max(whole - pull, LEAST_SHARE * whole) / load.first)
        return USED_PART * least

    def excess(self, square: float, slope: float, bend: float) -> float:
        """The largest part of a limit that y, b and c take; above 1 one of them is exceeded."""
        speed = sqrt(square) if square > 0.0 else 0.0
        if not self.loads:
            along = 0.5 * slope / self.up if slope > 0.0 else -0.5 * slope / self.down
            return max(along, 0.5 * speed * abs(bend) / self.jerk)
        most = 0.0
        for load in self.loads:
            along, curve = load.bend * square, 1.5 * load.bend * slope + load.twist * square
            acceleration = max(abs(0.5 * load.first * slope + along), abs(0.5 * load.least * slope + along))
            jerk = max(abs(0.5 * load.first * bend + curve), abs(0.5 * load.least * bend + curve))
            acceleration += load.spread * square
            jerk += 1.5 * load.spread * abs(slope) + load.wring * square
            most = max(most, load.first * speed / load.velocity)
            most = max(most, acceleration / load.acceleration)
            most = max(most, speed * jerk / load.jerk)
        return most


SMALLEST_SQUARE: Final = 1e-12
"""y of a path that is practically at rest."""


def largest_square(loads: list[AxisLoad]) -> float:
    """Largest y on a curve at which no axis exceeds its limits while the velocity is constant."""
    square = inf
    for load in loads:
        if load.first > 0.0:
            square = min(square, (load.velocity / load.first) ** 2)
        if load.second > 0.0:
            square = min(square, load.acceleration / load.second)
        if load.third > 0.0:
            square = min(square, (THIRD_SHARE * load.jerk / load.third) ** (2.0 / 3.0))
    return square
