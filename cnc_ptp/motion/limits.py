"""Dynamic limits of a motion, and the checks of all arguments of a planner."""

from __future__ import annotations

from math import ulp
from typing import NamedTuple

from cnc_ptp.errors import CncError

BAD_LIMIT = 23001
OUT_OF_RANGE = 23002
SMALLEST_LIMIT = 1e-9
LARGEST_LIMIT = 1e12
LARGEST_STATE = 1e12
NEGLIGIBLE_DISTANCE = 1e-30
"""mm; a smaller distance is 0 (its powers would leave the range of the numbers)."""


PLACES = 8
"""Units in the last place of a position that count as rounding."""


def rounding(*positions: float) -> float:
    """How far apart (mm, deg) positions of this size may be by rounding alone."""
    return PLACES * ulp(max(map(abs, positions)))


class Limits(NamedTuple):
    """Velocity V, acceleration A+, deceleration A- and jerk J of a motion along one path; all > 0.

    Units: mm/s, mm/s², mm/s², mm/s³ (deg instead of mm for rotary axes). A+ bounds the growth of |v|, A- its reduction.
    Source: TX1250 2.1, table 1.
    """

    velocity: float
    acceleration: float
    deceleration: float
    jerk: float


def check_limits(limits: Limits) -> None:
    """Refuse limits that are NaN, infinite, zero, negative or absurd.

    Raises CncError 23001 naming the first bad limit, its value and the permitted range.
    """
    velocity, acceleration, deceleration, jerk = limits
    if (
        SMALLEST_LIMIT <= velocity <= LARGEST_LIMIT
        and SMALLEST_LIMIT <= acceleration <= LARGEST_LIMIT
        and SMALLEST_LIMIT <= deceleration <= LARGEST_LIMIT
        and SMALLEST_LIMIT <= jerk <= LARGEST_LIMIT
    ):
        return
    for name, value in zip(Limits._fields, limits, strict=True):
        check_limit(name, value)


def check_limit(name: str, value: float) -> None:
    """Refuse one limit that is outside 1e-9 … 1e12 (NaN included). Raises CncError 23001."""
    if not SMALLEST_LIMIT <= value <= LARGEST_LIMIT:
        raise CncError(
            BAD_LIMIT,
            f"motion limit {name} = {value!r} must be between {SMALLEST_LIMIT:g} and {LARGEST_LIMIT:g}",
            "the motion is refused",
            name=name,
            value=value,
            low=SMALLEST_LIMIT,
            high=LARGEST_LIMIT,
        )


def usual(p: float, v: float, a: float, end: float) -> bool:
    """True when all are numbers far within the range of `check_state`, which takes longer."""
    return abs(p) + abs(v) + abs(a) + abs(end) <= LARGEST_STATE


def check_state(**values: float) -> None:
    """Refuse a start state, a target or a time that is NaN, infinite or beyond ±1e12. Raises CncError 23002."""
    for name, value in values.items():
        if not -LARGEST_STATE <= value <= LARGEST_STATE:
            raise CncError(
                OUT_OF_RANGE,
                f"motion value {name} = {value!r} must be between {-LARGEST_STATE:g} and {LARGEST_STATE:g}",
                "the motion is refused",
                name=name,
                value=value,
                limit=LARGEST_STATE,
            )
