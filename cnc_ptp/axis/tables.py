"""Properties of a runtime table that the PTP functions need."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import inf

from cnc_ptp.motion import Profile
from cnc_ptp.motion.profile import Segment


def standing(position: float) -> Profile:
    """The table of an axis at a standstill at `position`."""
    return Profile([(0.0, position, 0.0, 0.0, 0.0)])


def reaches(profile: Profile, velocity: float) -> bool:
    """True when the table holds `velocity` (mm/s, either direction) without acceleration, even for an instant."""
    return any(abs(level - velocity) <= 1e-9 * velocity for level in _levels(profile.rows))


def constant_spans(profile: Profile, velocity: float) -> Iterator[tuple[float, float]]:
    """Begin and end, in s from the start of the table, of each segment with this constant speed (mm/s)."""
    ends = [*profile.starts[1:], inf]
    for (t, _, v, a, j), end in zip(profile.rows, ends, strict=True):
        if a == j == 0.0 and abs(abs(v) - velocity) <= 1e-9 * velocity:
            yield t, end


def last_leg(profile: Profile) -> Sequence[Segment]:
    """The rows from the last standstill within the table on: the return if it stops and returns, else all."""
    rows = profile.rows
    for index in range(len(rows) - 2, 0, -1):
        if rows[index][2] == 0.0 and rows[index][3] == 0.0:
            return rows[index:]
    return rows


def peak_velocity(rows: Sequence[Segment]) -> float:
    """Largest |v| (mm/s) of these rows."""
    return max(max(abs(row[2]) for row in rows), *_levels(rows), 0.0)


def _levels(rows: Sequence[Segment]) -> Iterator[float]:
    """|v| wherever the acceleration is zero: at the start of a row, or within it, where v - a²/(2j)."""
    for (t, _, v, a, j), following in pairwise((*rows, rows[-1])):
        if abs(a) <= 1e-9 * abs(v) + 1e-12:
            yield abs(v)
        elif a * j < 0.0 and -a / j < following[0] - t:
            yield abs(v - 0.5 * a * a / j)
