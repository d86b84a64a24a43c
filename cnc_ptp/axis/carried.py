"""Motion of a flying saw added to the path of a channel: machining on a moving workpiece (TX1250 2.6)."""

from __future__ import annotations

from cnc_ptp.motion.setpoints import MotionState, Setpoints


class CarriedMotion:
    """The motion of the slave relative to its path, in blocks of cycles; it counts from where the path was before.

    Between the end of a block and the next one it continues with its acceleration, for commands and faults.
    """

    def __init__(self, cycle: int, *, cycle_time: float) -> None:
        """Nothing is added at `cycle`; `cycle_time` in s."""
        self._cycle_time = cycle_time
        self._first_cycle = cycle
        self._setpoints = Setpoints([0.0], [0.0], [0.0], [0.0])

    def take(self, first_cycle: int, setpoints: Setpoints) -> None:
        """The cycles of a block."""
        self._first_cycle, self._setpoints = first_cycle, setpoints

    def state(self, cycle: int) -> MotionState:
        """What is added at `cycle`."""
        number = cycle - self._first_cycle
        last = len(self._setpoints) - 1
        if number <= last:
            return self._setpoints.at(number)
        d = (number - last) * self._cycle_time
        p, v, a, _ = self._setpoints.at(last)
        return p + d * (v + 0.5 * d * a), v + d * a, a, 0.0
