"""The runtime table: a list of constant-jerk segments that never changes, evaluated purely at a time.

Within a segment that starts at t0 with p, v, a and jerk j, with d = t - t0:

    p(t) = p + d·(v + d·(a/2 + d·j/6))      v(t) = v + d·(a + d·j/2)      a(t) = a + d·j

The last row of a table is the end state with a = j = 0: after its end a motion continues with its end velocity.
`Profile.state_at` and `Profile.sample` run the same operations in the same order, so they agree to the bit.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cnc_ptp.motion.setpoints import MotionState, Setpoints

Segment = tuple[float, float, float, float, float]
"""Segment start time, position, velocity, acceleration, jerk."""

Piece = tuple[float, float, float]
"""Segment duration, acceleration at its start, jerk: a segment before position and velocity are known."""


class Profile:
    """A table of constant-jerk segments. Nobody changes one.

    rows       (t, p, v, a, j) at the start of each segment; the last row is the end state with a = j = 0
    starts     the start times alone
    duration   seconds from the first to the last row
    end        (p, v, a) after the last segment
    """

    __slots__ = ("_columns", "duration", "end", "rows", "starts")

    def __init__(self, rows: Iterable[Segment]) -> None:
        table = tuple(rows)
        last = table[-1]
        self.rows = table
        self.starts = tuple([row[0] for row in table])
        self.duration = last[0]
        self.end = (last[1], last[2], last[3])
        self._columns: NDArray[np.float64] | None = None

    def state_at(self, t: float) -> MotionState:
        """(p, v, a, j) at t seconds after the start; before the start as at 0, after the end with the end velocity."""
        if t < 0.0:
            t = 0.0
        start, p, v, a, j = self.rows[bisect_right(self.starts, t) - 1]
        d = t - start
        return p + d * (v + d * (0.5 * a + d * (j / 6.0))), v + d * (a + d * (0.5 * j)), a + d * j, j

    def settled(self, t: float) -> float:
        """From when on another profile may continue: `t`, but for profiles whose ramps must not be broken off."""
        return t

    def setpoints(self, first: int, count: int, cycle_time: float) -> Setpoints:
        """`state_at` for `count` times from first · cycle_time on, in s."""
        setpoints = Setpoints([], [], [], [])
        for cycle in range(first, first + count):
            p, v, a, j = self.state_at(cycle * cycle_time)
            setpoints.add(p, v, a, j)
        return setpoints

    def sample(self, times: ArrayLike) -> NDArray[np.float64]:
        """States at many times: times (n,) in seconds -> array (4, n) of p, v, a, j; equals state_at to the bit.

        The rows of each time are gathered once; p, v, a then grow in place from their highest coefficients.
        """
        t = np.maximum(times, 0.0)
        columns = self._columns
        if columns is None:
            start, p, v, a, j = np.array(self.rows, dtype=np.float64).T
            columns = np.array((j / 6.0, 0.5 * j, j, j, 0.5 * a, a, a, v, v, p, start))
            self._columns = columns
        out = columns.take(columns[-1, 1:].searchsorted(t, side="right"), axis=1)
        d = t - out[10]
        for state, following in ((out[:3], out[4:7]), (out[:2], out[7:9]), (out[0], out[9])):
            state *= d
            state += following
        return out[:4]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Profile) and self.rows == other.rows

    def __hash__(self) -> int:
        return hash(self.rows)

    def __repr__(self) -> str:
        return f"Profile({len(self.rows) - 1} segments, {self.duration!r} s, end {self.end!r})"


def integrate(
    t: float, p: float, v: float, pieces: list[Piece], place: float = 0.0, s: float = 1.0
) -> tuple[list[Segment], float, float, float]:
    """String pieces together from time t, position p and velocity v: the rows, and t, p, v after the last piece.

    Pieces without duration leave no row. The rows are seen from `place` in direction `s` (1 or -1).
    """
    rows: list[Segment] = []
    for d, a, j in pieces:
        if d > 0.0:
            rows.append((t, place + s * p, s * v, s * a, s * j))
            t += d
            p += d * (v + d * (0.5 * a + d * (j / 6.0)))
            v += d * (a + d * (0.5 * j))
    return rows, t, p, v


def integrate_back(t: float, pieces: list[Piece], place: float = 0.0, s: float = 1.0) -> tuple[list[Segment], float]:
    """String pieces together from time t so that they end at rest at `place`: the rows, and t after the last piece.

    Pieces without duration leave no row. The rows are seen in direction `s` (1 or -1).
    """
    starts: list[float] = []
    for d, _, _ in pieces:
        starts.append(t)
        if d > 0.0:
            t += d
    rows: list[Segment] = []
    p = v = 0.0
    for index in range(len(pieces) - 1, -1, -1):
        d, a, j = pieces[index]
        if d > 0.0:
            v -= d * (a + d * (0.5 * j))
            p -= d * (v + d * (0.5 * a + d * (j / 6.0)))
            rows.append((starts[index], place + s * p, s * v, s * a, s * j))
    rows.reverse()
    return rows, t
