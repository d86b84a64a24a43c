"""The retract of a tool from a thread that is broken off: one axis moves out, beside what the thread gives it."""

from __future__ import annotations

from typing import Final, NamedTuple

from cnc_ptp.motion import Limits, plan_rest_to_rest
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.path.geometry import AxisLimits
from cnc_ptp.path.shape import AxisState

RETRACT_SHARE: Final = 0.4
"""Of the acceleration and jerk of the retract axis, if it also takes part in the thread."""


class Retract(NamedTuple):
    """How the tool leaves a thread that is broken off: place and name of the axis, its way in mm, signed."""

    axis: int
    name: str
    way: float


class RetractMotion:
    """A retract that has been started; it is added to the motion of its axis."""

    def __init__(self, retract: Retract, limits: AxisLimits, velocity: float, cycle: int, cycle_time: float) -> None:
        """It starts at `cycle`; `velocity`: mm/s that the thread needs of the axis."""
        part = RETRACT_SHARE if velocity else 1.0
        left = max(limits.velocity - velocity, RETRACT_SHARE * limits.velocity)
        bounds = Limits(left, part * limits.acceleration, part * limits.deceleration, part * limits.jerk)
        self._retract, self._cycle, self._cycle_time = retract, cycle, cycle_time
        self._profile = plan_rest_to_rest(0.0, retract.way, bounds)

    def done(self, cycle: int) -> bool:
        """The tool is out."""
        return (cycle - self._cycle) * self._cycle_time >= self._profile.duration

    def _added(self, cycle: int) -> MotionState:
        if self.done(cycle):
            return self._retract.way, 0.0, 0.0, 0.0
        return self._profile.state_at((cycle - self._cycle) * self._cycle_time)

    def applied(self, states: tuple[AxisState, ...], cycle: int) -> tuple[AxisState, ...]:
        """The states of the axes with the retract."""
        axis = self._retract.axis
        q, v, a, j = states[axis]
        way, velocity, acceleration, jerk = self._added(cycle)
        return (*states[:axis], (q + way, v + velocity, a + acceleration, j + jerk), *states[axis + 1 :])
