"""Checks of single rows: limits of velocity and acceleration, numbers, motion without power."""

from __future__ import annotations

import numpy as np

from cnc_ptp.recording.motion_check.continuity import PLACES, Setpoints
from cnc_ptp.recording.motion_check.findings import Findings, Mask, Numbers
from cnc_ptp.recording.motion_check.laws import Laws


def check_limits(points: Setpoints, laws: Laws, found: Findings, calm: Numbers | None = None) -> None:
    """|v| and |a| of each row; a larger |a| that falls is on its way to the limit.

    `calm`: what would be the limits of falling |v| without an abrupt stop; what exceeds only these was told.
    """
    v, a, unit = np.abs(points.velocity), np.abs(points.acceleration), points.length
    allowed = laws.velocity * (1.0 + laws.relative) + PLACES * np.spacing(v)
    found.above("velocity", points.velocity, laws.velocity, ~(v <= allowed), f"{unit}/s")
    bound = _bound(points, laws.growth, laws.reduction)
    slack = 1.0 + laws.relative
    over = ~(a <= bound * slack + PLACES * np.spacing(a))
    found.above("acceleration", points.acceleration, bound, over, f"{unit}/s²")
    if calm is not None:
        usual = np.minimum(bound, np.maximum(calm, laws.growth))
        told = ~over & ~(a <= usual * slack + PLACES * np.spacing(a))
        found.above("deceleration of an abrupt stop", points.acceleration, usual, told, f"{unit}/s²", told=True)


def _bound(points: Setpoints, growth: Numbers, reduction: Numbers) -> Numbers:
    """A+ where |v| grows, A- where it falls; the larger one near v = 0 and where |a| comes down to the smaller."""
    v, a = points.velocity, points.acceleration
    own = np.where(v * a > 0.0, growth, reduction)
    falls = np.concatenate(([True], points.joined & (np.abs(a[1:]) < np.abs(a[:-1]))))
    slow = np.abs(v) <= np.abs(a) * points.cycle_time
    return np.where(falls | slow, np.maximum(growth, reduction), own)


def check_numbers(points: Setpoints, found: Findings) -> None:
    """No NaN, no infinity."""
    for what, column in (
        ("position is no number", points.position),
        ("velocity is no number", points.velocity),
        ("acceleration is no number", points.acceleration),
    ):
        found.above(what, column, np.zeros(len(column)), ~np.isfinite(column), "")


def check_rest(points: Setpoints, at_rest: Mask, placed: Mask, found: Findings, what: str) -> None:
    """In rows that are `at_rest` velocity and acceleration are 0 and the position stays."""
    zero, unit = np.zeros(len(at_rest)), points.length
    for name, column, units in (("velocity", points.velocity, "/s"), ("acceleration", points.acceleration, "/s²")):
        found.above(f"set {name} {what}", column, zero, at_rest & ~(column == 0.0), unit + units)
    step = np.diff(points.position)
    rounding = PLACES * np.spacing(np.abs(points.position[1:]))
    moved = at_rest[1:] & at_rest[:-1] & points.joined & ~placed & ~(np.abs(step) <= rounding)
    shown, wrong = np.concatenate(([0.0], step)), np.concatenate(([False], moved))
    found.above(f"set position changes {what}", shown, zero, wrong, unit)


def check_actual(velocity: Numbers, disabled: Mask, blur: float, found: Findings, unit: str) -> None:
    """Without power the actual velocity grows no more; `blur` of it is resolution of the encoder."""
    index = np.arange(len(velocity))
    begins = disabled & ~np.concatenate(([False], disabled[:-1]))
    begin = np.maximum.accumulate(np.where(begins, index, 0))
    limit = np.maximum(np.abs(velocity[begin]), np.abs(velocity[np.maximum(begin - 1, 0)])) + blur
    wrong = disabled & ~(np.abs(velocity) <= limit + PLACES * np.spacing(limit))
    found.above("actual velocity without power", velocity, limit, wrong, f"{unit}/s")
