"""The motion of move_superimposed: a distance with its own limits in addition to the basic motion (PLCopen).

It has a profile of its own and does not depend on the basic motion; the two are added, cycle by cycle. What it has
covered stays as an offset between the axis and its basic motion.
"""

from __future__ import annotations

from math import ceil

from cnc_ptp.axis.job import stronger
from cnc_ptp.axis.tables import peak_velocity, standing
from cnc_ptp.motion import (
    Limits,
    Profile,
    plan_rest_to_rest,
    plan_to_velocity,
    plan_with_ramp,
    stopping_distance,
)
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
        """Starts at `cycle` over `distance` (mm, deg); one that moves is replaced.

        Where `limits` would lead past the new end, A- and J of the motion until now count where these are larger: it
        never goes further than that one would have done.
        """
        self.halting = False
        if self.moving(cycle):
            profile, self._limits = self._from_motion(cycle, distance, limits)
        else:
            begin = self._profile.end[0]
            profile, self._limits = plan_rest_to_rest(begin, begin + distance, limits), limits
        self._take(cycle, profile)

    def _from_motion(self, cycle: int, distance: float, limits: Limits) -> tuple[Profile, Limits]:
        position, velocity, acceleration, _ = self.state(cycle)
        target, ramp = position + distance, self._ramp(limits)
        return plan_with_ramp(position, velocity, acceleration, target, limits, ramp)

    def _ramp(self, limits: Limits) -> Limits:
        """`limits` with A- and J of the motion until now where these are larger."""
        return stronger(limits, self._limits) or limits

    def growth(self, cycle: int, distance: float) -> float:
        """By how much its end moves when it starts over `distance` at `cycle`."""
        return self.state(cycle)[0] + distance - self.offset if self.moving(cycle) else distance

    def ahead(self, cycle: int, distance: float, limits: Limits) -> float:
        """What would be left of `distance` if it came to rest first; the sign is the direction in which it goes."""
        _, velocity, acceleration, _ = self.state(cycle)
        ramp = self._ramp(limits)
        return distance - stopping_distance(velocity, acceleration, ramp.deceleration, ramp.jerk)

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
