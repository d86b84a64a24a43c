"""The generator of a drive that moves its axis on its own."""

from __future__ import annotations

from cnc_ptp.motion import Limits, Profile, plan_to_position, plan_to_velocity


class OwnMotion:
    """Set position, velocity and acceleration of a drive, cycle by cycle, from one profile after the other."""

    __slots__ = ("_cycle_time", "_cycles", "_profile", "acceleration", "position", "velocity")

    def __init__(self, *, cycle_time: float) -> None:
        """`cycle_time` in s; at a standstill at 0 until `begin`."""
        self._cycle_time = cycle_time
        self.begin(0.0)

    def begin(self, position: float) -> None:
        """At a standstill at `position`."""
        self._follow(Profile([(0.0, position, 0.0, 0.0, 0.0)]))
        self.position, self.velocity, self.acceleration = position, 0.0, 0.0

    def to_velocity(self, velocity: float, limits: Limits) -> None:
        self._follow(plan_to_velocity(self.position, self.velocity, self.acceleration, velocity, limits))

    def to_position(self, target: float, limits: Limits) -> None:
        """Comes to rest at `target`; if that is too near, it stops and returns."""
        self._follow(plan_to_position(self.position, self.velocity, self.acceleration, target, limits))

    def _follow(self, profile: Profile) -> None:
        self._profile, self._cycles = profile, 0

    @property
    def rests(self) -> bool:
        """The profile has ended at a standstill."""
        return self.velocity == 0.0 == self.acceleration and self._cycles * self._cycle_time >= self._profile.duration

    def advance(self) -> None:
        """The next cycle."""
        self._cycles += 1
        self.position, self.velocity, self.acceleration, _ = self._profile.state_at(self._cycles * self._cycle_time)
