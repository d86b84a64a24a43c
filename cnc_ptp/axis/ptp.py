"""PTP setpoint generator: start, override and stop on immutable runtime tables (TX1250, 2.1 and 2.2)."""

from __future__ import annotations

from dataclasses import dataclass

from cnc_ptp.motion import (
    Limits,
    Profile,
    plan_rest_to_rest,
    plan_to_position,
    plan_to_velocity,
    reachable_velocity,
)

State = tuple[float, float, float, float]
"""Position mm, velocity mm/s, acceleration mm/s², jerk mm/s³ (deg for rotary axes)."""


@dataclass(frozen=True, slots=True)
class Job:
    """A positioning that was started: where to, with which limits, and the velocity that 100 percent override means."""

    target: float
    limits: Limits
    full_velocity: float


class PtpGenerator:
    """Generates the setpoints of one axis from runtime tables.

    Time is the cycle number: a table that was made for cycle c gives its start state at c. A command given for cycle c
    plans from the state that the old table has at c, so that no change steps the velocity or the acceleration.
    """

    def __init__(self, *, position: float, cycle_time: float, override_type: int) -> None:
        """`position` in mm or deg, `cycle_time` in s; override types 1 to 4 as in TX1250 2.2."""
        self._cycle_time = cycle_time
        self._override_type = override_type
        self._origin = 0
        self._profile = standing(position)
        self._stopping = False
        self.job: Job | None = None
        self.override = 1.0

    def state(self, cycle: int) -> State:
        """Setpoint at `cycle`: position, velocity, acceleration, jerk."""
        return self._profile.state_at((cycle - self._origin) * self._cycle_time)

    def finished(self, cycle: int) -> bool:
        """True when the table in work has come to its end at `cycle`."""
        return (cycle - self._origin) * self._cycle_time >= self._profile.duration

    def arrived(self, cycle: int) -> bool:
        """True when the axis stands at `cycle` and has nothing left to do (a job held by override 0 is something left)."""
        return self.finished(cycle) and (self.job is None or self.state(cycle)[0] == self.job.target)

    def start(self, cycle: int, target: float, limits: Limits) -> None:
        """Starts from standstill towards `target` (mm or deg); with override 0 the job waits."""
        position = self.state(cycle)[0]
        self.job = Job(target, limits, self._full_velocity(target - position, limits))
        self._stopping = False
        self._set(cycle, self._from_rest(position))

    def set_override(self, cycle: int, ratio: float) -> bool:
        """Takes over an override of 0.0 to 1.0; False when it only counts for the next start.

        It acts at once unless a stop runs or the brake phase is reached. Types 1 and 2 keep the old table when the new
        velocity level cannot be reached; types 3 and 4 take the highest level that can.
        """
        previous, self.override = self.override, ratio
        if self.job is None or self._stopping or (previous > 0.0 and self.in_brake_phase(cycle)):
            return False
        profile = self._at_level(cycle, self.job)
        if profile is not None:
            self._set(cycle, profile)
        return profile is not None

    def in_brake_phase(self, cycle: int) -> bool:
        """True when nothing but the ramp down to the target is left (also when the axis stands)."""
        if self.job is None:
            return True
        position, velocity, acceleration, _ = self.state(cycle)
        if velocity == 0.0 and acceleration == 0.0:
            return bool(position == self.job.target)
        ahead = plan_to_velocity(position, velocity, acceleration, 0.0, self.job.limits).end[0]
        tolerance = 1e-9 * max(1.0, abs(self.job.target), abs(position))
        return abs(ahead - self.job.target) <= tolerance

    def stop(self, cycle: int, limits: Limits) -> None:
        """Ends the job and ramps down with A- and J of `limits` (or of the job, if one runs)."""
        ramp_limits = self.job.limits if self.job else limits
        position, velocity, acceleration, _ = self.state(cycle)
        self.job = None
        self._stopping = True
        self._set(cycle, plan_to_velocity(position, velocity, acceleration, 0.0, ramp_limits))

    def finish(self) -> None:
        """The table is through: job and stop are done."""
        self.job = None
        self._stopping = False

    def take_over(self, cycle: int, position: float, velocity: float, acceleration: float) -> None:
        """Continues from a state that another setpoint source has at `cycle` (it must be stopped next unless it stands)."""
        self.job = None
        self._stopping = False
        self._set(cycle, Profile([(0.0, position, velocity, acceleration, 0.0)]))

    def _set(self, cycle: int, profile: Profile) -> None:
        self._origin = cycle
        self._profile = profile

    def _full_velocity(self, distance: float, limits: Limits) -> float:
        if self._override_type in (2, 4):
            return limits.velocity
        symmetric = min(limits.acceleration, limits.deceleration)
        return min(limits.velocity, reachable_velocity(abs(distance), symmetric, limits.jerk))

    def _level(self, job: Job) -> Limits:
        return job.limits._replace(velocity=job.full_velocity * self.override)

    def _from_rest(self, position: float) -> Profile:
        if self.job is None or self.override == 0.0:
            return standing(position)
        return plan_rest_to_rest(position, self.job.target, self._level(self.job))

    def _at_level(self, cycle: int, job: Job) -> Profile | None:
        """The table for the override as it is now; None when the old one is to be kept."""
        position, velocity, acceleration, _ = self.state(cycle)
        if self.override == 0.0:
            return plan_to_velocity(position, velocity, acceleration, 0.0, job.limits)
        if velocity == 0.0 and acceleration == 0.0:
            return self._from_rest(position)
        level = self._level(job)
        profile = plan_to_position(position, velocity, acceleration, job.target, level)
        if self._override_type in (1, 2) and not reaches(profile, level.velocity):
            return None
        return profile


def standing(position: float) -> Profile:
    """The table of an axis that stands at `position`."""
    return Profile([(0.0, position, 0.0, 0.0, 0.0)])


def reaches(profile: Profile, velocity: float) -> bool:
    """True when the table holds a stretch at `velocity` (mm/s, either direction) without acceleration."""
    return any(
        abs(abs(v) - velocity) <= 1e-9 * velocity and abs(a) <= 1e-9 * abs(v) + 1e-12 for _, _, v, a, _ in profile.rows
    )
