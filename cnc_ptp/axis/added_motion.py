"""The motion of move_superimposed: a distance with its own limits in addition to the basic motion (PLCopen).

It has a profile of its own and does not depend on the basic motion; the two are added, cycle by cycle. What it has
covered stays as an offset between the axis and its basic motion.
"""

from __future__ import annotations

from math import ceil

from cnc_ptp.axis.tables import peak_velocity, standing
from cnc_ptp.motion import Limits, Profile, plan_rest_to_rest, plan_to_velocity
from cnc_ptp.motion.setpoints import MotionState


class AddedMotion:
    """Position, velocity, acceleration and jerk that are added to the basic motion of one axis."""

    def __init__(self, *, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self._cycle_time = cycle_time
        self._profile = standing(0.0)
        self._limits: Limits | None = None
        self._origin = 0
        self.end_cycle = 0
        """The first cycle in which it is at rest."""
        self.halting = False
        """It ends before its distance is covered."""

    def start(self, cycle: int, distance: float, limits: Limits) -> None:
        """Starts at `cycle`, at which it must be at rest, over `distance` (mm, deg)."""
        begin = self._profile.end[0]
        self._limits, self.halting = limits, False
        self._take(cycle, plan_rest_to_rest(begin, begin + distance, limits))

    def halt(self, cycle: int) -> None:
        """Ends on the ramp of its start; what it has covered until then stays."""
        if self._limits is not None and self.moving(cycle) and not self.halting:
            self.halting = True
            self._take(cycle, plan_to_velocity(*self.state(cycle)[:3], 0.0, self._limits))

    def reset(self) -> None:
        """The basic motion has taken over what was added."""
        self.halting = False
        self._take(0, standing(0.0))

    def _take(self, cycle: int, profile: Profile) -> None:
        self._origin, self._profile = cycle, profile
        self.end_cycle = cycle + ceil(profile.duration / self._cycle_time)
        if (self.end_cycle - cycle) * self._cycle_time < profile.duration:
            self.end_cycle += 1

    @property
    def active(self) -> bool:
        """Something is added, in motion or as an offset."""
        return self.end_cycle > 0

    @property
    def offset(self) -> float:
        """What is added when it has ended, mm (deg)."""
        return self._profile.end[0]

    @property
    def peak(self) -> float:
        """Its largest speed, mm/s (deg/s)."""
        return peak_velocity(self._profile.rows)

    def moving(self, cycle: int) -> bool:
        return cycle < self.end_cycle

    def state(self, cycle: int) -> MotionState:
        """What is added at `cycle`."""
        return self._profile.state_at((cycle - self._origin) * self._cycle_time)
