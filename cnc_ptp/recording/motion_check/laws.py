"""What is permitted in each cycle, as columns; and stretches of cycles."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cnc_ptp.recording.motion_check.findings import Cycles, Mask, Numbers
from cnc_ptp.recording.motion_check.inputs import Order

JERK, STEP, FREE = 0, 1, 2
"""The jerk is limited; the acceleration may step within its limit; the velocity may step, only it is limited."""
EXACT = 1e-9
"""Part of a limit by which profiles of axes and spindles may exceed it (docs/ptp.md, Numbers)."""
ON_PATH = 1e-6
"""The same for axes on a path (docs/path.md)."""


@dataclass(slots=True)
class Laws:
    """Columns (n,): which law, limits of growing and of falling |v|, of jerk and velocity, all > 0, inf for none.

    relative   part of a limit by which it may be exceeded
    kinks      a path may pass kinks: velocity steps of at most J·T²/2
    placed     (n-1,) the coordinates of the next row may be others
    """

    law: npt.NDArray[np.int8]
    growth: Numbers
    reduction: Numbers
    jerk: Numbers
    velocity: Numbers
    relative: Numbers
    kinks: Mask
    placed: Mask

    @classmethod
    def of(cls, n: int, *, growth: float, reduction: float, jerk: float, velocity: float, law: int = JERK) -> Laws:
        """The same in all rows."""
        return cls(
            np.full(n, law, dtype=np.int8),
            np.full(n, growth),
            np.full(n, reduction),
            np.full(n, jerk),
            np.full(n, velocity),
            np.full(n, EXACT),
            np.zeros(n, dtype=bool),
            np.zeros(max(0, n - 1), dtype=bool),
        )

    def permit(self, rows: Mask | slice, law: int) -> None:
        """At least this law in these rows."""
        self.law[rows] = np.maximum(self.law[rows], law)


def since(flag: Mask, reset: Mask) -> Mask:
    """Rows in which `flag` is true or was, with no `reset` since."""
    index = np.arange(len(flag))
    last_flag = np.maximum.accumulate(np.where(flag, index, -1))
    last_reset = np.maximum.accumulate(np.where(reset, index, -1))
    return (last_flag >= 0) & ((last_flag > last_reset) | flag)


def and_next(rows: Mask) -> Mask:
    """Rows, and the one behind each: it still has the state from which another motion continues."""
    found = rows.copy()
    found[1:] |= rows[:-1]
    return found


class Stretches:
    """From a command to the end of what it began: the first row at rest behind it."""

    def __init__(self, cycles: Cycles, at_rest: Mask) -> None:
        self._cycles = cycles
        self._rests = np.flatnonzero(at_rest)

    def row(self, cycle: int) -> int:
        """The first row from `cycle` on; one behind the last if there is none."""
        return int(np.searchsorted(self._cycles, cycle))

    def of(self, cycle: int) -> slice:
        """Rows from `cycle` on, up to and with the first one at rest behind it."""
        begin = self.row(cycle)
        place = int(np.searchsorted(self._rests, begin + 1))
        end = int(self._rests[place]) + 1 if place < len(self._rests) else len(self._cycles)
        return slice(begin, end)

    def mask(self, orders: Iterable[Order]) -> Mask:
        """Rows of the stretches of these commands."""
        rows = np.zeros(len(self._cycles), dtype=bool)
        for order in orders:
            rows[self.of(order.cycle)] = True
        return rows
