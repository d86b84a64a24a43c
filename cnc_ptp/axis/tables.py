"""Questions that the PTP functions ask of a runtime table."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from cnc_ptp.motion import Profile
from cnc_ptp.motion.profile import Row


def standing(position: float) -> Profile:
    """The table of an axis that stands at `position`."""
    return Profile([(0.0, position, 0.0, 0.0, 0.0)])


def reaches(profile: Profile, velocity: float) -> bool:
    """True when the table holds a stretch at `velocity` (mm/s, either direction) without acceleration."""
    return any(
        abs(abs(v) - velocity) <= 1e-9 * velocity and abs(a) <= 1e-9 * abs(v) + 1e-12 for _, _, v, a, _ in profile.rows
    )


def last_leg(profile: Profile) -> Sequence[Row]:
    """The rows from the last standstill within the table on: the way back where it stops and returns, else all."""
    rows = profile.rows
    for index in range(len(rows) - 2, 0, -1):
        if rows[index][2] == 0.0 and rows[index][3] == 0.0:
            return rows[index:]
    return rows


def peak_velocity(rows: Sequence[Row]) -> float:
    """Largest |v| (mm/s) of these rows; within a row it lies where the acceleration passes zero, v - a²/(2j)."""
    peak = max(abs(row[2]) for row in rows)
    for (t, _, v, a, j), following in pairwise(rows):
        if a * j < 0.0 and -a / j < following[0] - t:
            peak = max(peak, abs(v - 0.5 * a * a / j))
    return peak
