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
from cnc_ptp.motion.limits import SMALLEST_LIMIT, check_limits

State = tuple[float, float, float, float]
"""Position mm, velocity mm/s, acceleration mm/s², jerk mm/s³ (deg for rotary axes)."""


STANDING = (0.0, 0.0, 0.0)
"""Velocity, acceleration and jerk of an axis at rest."""

SMALLEST_OVERRIDE = 1e-6
"""One step of the override (TX1250 2.2); a smaller one is 0."""


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
        self._ramp_limits: Limits | None = None
        self.job: Job | None = None
        self.override = 1.0

    def state(self, cycle: int) -> State:
        """Setpoint at `cycle`: position, velocity, acceleration, jerk."""
        return self._profile.state_at((cycle - self._origin) * self._cycle_time)

    def states(self, first_cycle: int, count: int) -> list[State]:
        """Setpoints of `count` cycles."""
        state = self.state(first_cycle)
        if state[1:] == STANDING and self.finished(first_cycle):
            return [state] * count
        state_at, origin, cycle_time = self._profile.state_at, self._origin, self._cycle_time
        return [state_at((cycle - origin) * cycle_time) for cycle in range(first_cycle, first_cycle + count)]

    def finished(self, cycle: int) -> bool:
        """True when the table in work has come to its end at `cycle`."""
        return (cycle - self._origin) * self._cycle_time >= self._profile.duration

    def arrived(self, cycle: int) -> bool:
        """True when the table is through and leaves nothing to do (a job held by override 0 is something left)."""
        return self.finished(cycle) and (self.job is None or self._ends_at(self.job))

    def start(self, cycle: int, target: float, limits: Limits) -> None:
        """Starts from standstill towards `target` (mm or deg); with override 0 the job waits.

        Raises CncError 23001 and 23002 for limits and targets that no table can be made for; then nothing is changed.
        """
        check_limits(limits)
        position = self.state(cycle)[0]
        job = Job(target, limits, self._full_velocity(target - position, limits))
        profile = self._from_rest(position, job)
        self.job = job
        self._set(cycle, profile, limits)

    def set_override(self, cycle: int, ratio: float) -> bool:
        """Takes over an override of 0.0 to 1.0; False when it only counts for the next start.

        It acts at once unless a stop runs or the brake phase is reached. Types 1 and 2 keep the old table when the new
        velocity level cannot be reached; types 3 and 4 take the highest level that can.
        """
        self.override = ratio if ratio >= SMALLEST_OVERRIDE else 0.0
        if self.job is None or self._braking(cycle, self.job):
            return False
        profile = self._at_level(cycle, self.job)
        if profile is not None:
            self._set(cycle, profile, self.job.limits)
        return profile is not None

    def stop(self, cycle: int, limits: Limits, *, at_least: bool = False) -> None:
        """Ends the job and ramps down with A- and J of the motion in work, or of `limits` if none is.

        `at_least`: the ramp is not weaker than `limits` either. A brake phase runs on otherwise.
        """
        ramp = self._ramp_limits or limits
        if at_least:
            ramp = Limits(*map(max, ramp, limits))
        elif self.job is not None and self._braking(cycle, self.job):
            self.job = None
            return
        position, velocity, acceleration, _ = self.state(cycle)
        self._set(cycle, plan_to_velocity(position, velocity, acceleration, 0.0, ramp), ramp)
        self.job = None

    def finish(self) -> None:
        """The table is through: job and stop are done."""
        self.job = None
        self._ramp_limits = None

    def take_over(self, cycle: int, position: float, velocity: float, acceleration: float) -> None:
        """Continues from a state that another setpoint source has at `cycle`; unless it stands, a stop must follow."""
        self.job = None
        self._set(cycle, Profile([(0.0, position, velocity, acceleration, 0.0)]), None)

    def _set(self, cycle: int, profile: Profile, limits: Limits | None) -> None:
        self._origin = cycle
        self._profile = profile
        self._ramp_limits = limits

    def _ends_at(self, job: Job) -> bool:
        """The table in work leads to the target; the one of override 0 does not."""
        return bool(self._profile.end[0] == job.target)

    def _braking(self, cycle: int, job: Job) -> bool:
        """True when the table leads to the target and nothing but its last ramp down is left."""
        if not self._ends_at(job):
            return False
        position, velocity, acceleration, _ = self.state(cycle)
        if velocity == 0.0 and acceleration == 0.0:
            return bool(position == job.target)
        ahead = plan_to_velocity(position, velocity, acceleration, 0.0, job.limits).end[0]
        tolerance = 1e-9 * max(1.0, abs(job.target), abs(position))
        return abs(ahead - job.target) <= tolerance

    def _full_velocity(self, distance: float, limits: Limits) -> float:
        if self._override_type in (2, 4):
            return limits.velocity
        symmetric = min(limits.acceleration, limits.deceleration)
        return min(limits.velocity, reachable_velocity(abs(distance), symmetric, limits.jerk))

    def _level(self, job: Job) -> Limits:
        """Limits with the velocity of the override; below what tables can be made for, the smallest of these."""
        return job.limits._replace(velocity=max(job.full_velocity * self.override, SMALLEST_LIMIT))

    def _from_rest(self, position: float, job: Job) -> Profile:
        if self.override == 0.0:
            return standing(position)
        return plan_rest_to_rest(position, job.target, self._level(job))

    def _at_level(self, cycle: int, job: Job) -> Profile | None:
        """The table for the override as it is now; None when the old one is to be kept."""
        position, velocity, acceleration, _ = self.state(cycle)
        if self.override == 0.0:
            return plan_to_velocity(position, velocity, acceleration, 0.0, job.limits)
        if velocity == 0.0 and acceleration == 0.0:
            return self._from_rest(position, job)
        level = self._level(job)
        profile = plan_to_position(position, velocity, acceleration, job.target, level)
        if self._override_type in (1, 2) and self._ends_at(job) and not reaches(profile, level.velocity):
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
