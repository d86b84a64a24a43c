"""Motion of a flying saw added to the path of a channel: machining on a moving workpiece (TX1250 2.6)."""

from __future__ import annotations

from collections.abc import Sequence

from cnc_ptp.motion.profile import MotionState


class CarriedMotion:
    """The motion of the slave relative to its path, in blocks of cycles; it counts from where the path was before.

    Between the end of a block and the next one it continues with its acceleration, for commands and faults.
    """

    def __init__(self, cycle: int, *, cycle_time: float) -> None:
        """Nothing is added at `cycle`; `cycle_time` in s."""
        self._cycle_time = cycle_time
        self._first_cycle = cycle
        self._states: Sequence[MotionState] = [(0.0, 0.0, 0.0, 0.0)]

    def take(self, first_cycle: int, states: Sequence[MotionState]) -> None:
        """The cycles of a block."""
        self._first_cycle, self._states = first_cycle, states

    def state(self, cycle: int) -> MotionState:
        """What is added at `cycle`."""
        number = cycle - self._first_cycle
        if number < len(self._states):
            return self._states[number]
        d = (number - len(self._states) + 1) * self._cycle_time
        p, v, a, _ = self._states[-1]
        return p + d * (v + 0.5 * d * a), v + d * a, a, 0.0
