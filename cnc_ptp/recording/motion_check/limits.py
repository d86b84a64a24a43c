"""Checks of single rows: limits of velocity and acceleration, numbers, motion without power."""

from __future__ import annotations

import numpy as np

from cnc_ptp.recording.motion_check.continuity import PLACES, Setpoints
from cnc_ptp.recording.motion_check.findings import Findings, Mask, Numbers
from cnc_ptp.recording.motion_check.laws import Laws


def check_limits(points: Setpoints, laws: Laws, found: Findings, told: Mask) -> None:
    """|v| and |a| of each row; a larger |a| that falls is on its way to the limit. `told`: rows of an abrupt stop."""
    v, a, unit = np.abs(points.velocity), np.abs(points.acceleration), points.length
    allowed = laws.velocity * (1.0 + laws.relative) + PLACES * np.spacing(v)
    found.above("velocity", points.velocity, laws.velocity, ~(v <= allowed), f"{unit}/s")
    bound = _bound(points, laws)
    over = ~(a <= bound * (1.0 + laws.relative) + PLACES * np.spacing(a))
    found.above("acceleration", points.acceleration, bound, over & ~told, f"{unit}/s²")
    found.above("acceleration of an abrupt stop", points.acceleration, bound, over & told, f"{unit}/s²", told=True)


def _bound(points: Setpoints, laws: Laws) -> Numbers:
    """A+ where |v| grows, A- where it falls; the larger one near v = 0 and where |a| comes down to the smaller."""
    v, a = points.velocity, points.acceleration
    grows = v * a > 0.0
    own = np.where(grows, laws.growth, laws.reduction)
    most = np.maximum(laws.growth, laws.reduction)
    falls = np.concatenate(([True], points.joined & (np.abs(a[1:]) < np.abs(a[:-1]))))
    slow = np.abs(v) <= np.abs(a) * points.cycle_time
    return np.where(falls | slow, most, own)


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
    found.above(f"set velocity {what}", points.velocity, zero, at_rest & ~(points.velocity == 0.0), f"{unit}/s")
    found.above(
        f"set acceleration {what}", points.acceleration, zero, at_rest & ~(points.acceleration == 0.0), f"{unit}/s²"
    )
    moved = at_rest[1:] & at_rest[:-1] & points.joined & ~placed & ~(np.diff(points.position) == 0.0)
    distance = np.concatenate(([0.0], np.diff(points.position)))
    found.above(f"set position changes {what}", distance, zero, np.concatenate(([False], moved)), unit)
