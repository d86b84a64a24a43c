"""The last setpoints of an axis, which feedforward, friction compensation and the delay line look back at."""

from __future__ import annotations

from typing import Final

from cnc_ptp.motion.setpoints import MotionState

HISTORY: Final = 16
"""Number of setpoints kept: 4 cycles of lead, 6 of delay, and their neighbours."""


class SetpointHistory:
    """A ring of setpoints; 0 is the newest, `back` counts cycles into the past. Empty, or full."""

    __slots__ = ("_accelerations", "_jerks", "_newest", "_positions", "_velocities", "filled")

    def __init__(self) -> None:
        self._positions = [0.0] * HISTORY
        self._velocities = [0.0] * HISTORY
        self._accelerations = [0.0] * HISTORY
        self._jerks = [0.0] * HISTORY
        self._newest = 0
        self.filled = False

    def clear(self) -> None:
        self.filled = False

    def take(self, position: float, velocity: float, acceleration: float, jerk: float) -> None:
        """The setpoint of the next cycle. Before the first one the axis counts as having been in the same state."""
        if not self.filled:
            self._positions = [position] * HISTORY
            self._velocities = [velocity] * HISTORY
            self._accelerations = [acceleration] * HISTORY
            self._jerks = [jerk] * HISTORY
            self.filled = True
            return
        newest = self._newest = (self._newest - 1) % HISTORY
        self._positions[newest] = position
        self._velocities[newest] = velocity
        self._accelerations[newest] = acceleration
        self._jerks[newest] = jerk

    def shift(self, distance: float) -> None:
        """All positions grow by `distance`."""
        self._positions = [position + distance for position in self._positions]

    def position(self, back: int) -> float:
        return self._positions[(self._newest + back) % HISTORY]

    def velocity(self, back: int) -> float:
        return self._velocities[(self._newest + back) % HISTORY]

    def acceleration(self, back: int) -> float:
        return self._accelerations[(self._newest + back) % HISTORY]

    def jerk(self, back: int) -> float:
        return self._jerks[(self._newest + back) % HISTORY]

    def at(self, back: int) -> MotionState:
        return self.position(back), self.velocity(back), self.acceleration(back), self.jerk(back)
