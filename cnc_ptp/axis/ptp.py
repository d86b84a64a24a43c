"""PTP setpoint generator: start, override, stop, new target, new velocity on immutable runtime tables (TX1250, 2)."""

from __future__ import annotations

import sys
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import replace
from math import ceil, copysign, inf, isinf

from cnc_ptp.axis.job import Activation, Job, Start, leads_too_fast, planned, stronger
from cnc_ptp.axis.tables import constant_spans, last_leg, peak_velocity, reaches, standing
from cnc_ptp.axis.two_stage import Request, Stage, velocity_stage
from cnc_ptp.motion import (
    Limits,
    Profile,
    plan_rest_to_rest,
    plan_to_velocity,
)
from cnc_ptp.motion.limits import SMALLEST_LIMIT, check_limit, check_limits, check_state, rounding
from cnc_ptp.motion.profile import Segment
from cnc_ptp.motion.setpoints import MotionState, Setpoints
from cnc_ptp.motion.to_position import leads_past

NEGLIGIBLE = 1e-9
"""mm, mm/s (deg, deg/s): smaller values have no direction."""

SMALLEST_OVERRIDE = 1e-6
"""One step of the override (TX1250 2.2); a smaller one is 0."""

INSTANT = 1e-9
"""s; a stop that misses the target by what the axis moves in this time, or by rounding, ends at the target."""

REDUCTIONS = 8
"""Steps of the bisection that brings an unreachable new velocity nearer to the old one (TX1250 2.4)."""


class PtpGenerator:
    """Generates the setpoints of one axis from runtime tables.

    Time is the cycle number: a table made for cycle c has its start state at c. A command given for cycle c
    plans from the state that the old table has at c, so that no change steps the velocity or the acceleration.
    What happens later without a command (a new velocity at its activation position, a request that waits for the end of
    a stop) is due at a cycle known beforehand: `setpoints` gives cycles up to it, `advance` carries it out.
    """

    def __init__(self, *, position: float, cycle_time: float, override_type: int) -> None:
        """`position` in mm or deg, `cycle_time` in s; override types 1 to 4 as in TX1250 2.2."""
        self._cycle_time = cycle_time
        self._origin = 0
        self._profile = standing(position)
        self._ramp_limits: Limits | None = None
        self._stopped_job: Job | None = None
        self._stop_locks = False
        self._suspended: Request | None = None
        self._activation: Activation | None = None
        self._due: int | None = None
        self.override_type = override_type
        self.job: Job | None = None
        self.follows = False
        """The table is a trajectory; neither override nor feed release change it."""
        self.override = 1.0
        self._forward = self._backward = True
        self._waits_for_release = False
        self.ceiling = inf
        """Largest velocity (mm/s, deg/s) of a job while something is superimposed."""

    # feed releases

    @property
    def restricted(self) -> bool:
        """A direction is not released."""
        return not (self._forward and self._backward)

    @property
    def withheld(self) -> bool:
        """The active job waits, or comes to rest, until its direction is released."""
        return self.job is not None and self._waits_for_release

    def withholds(self, direction: float) -> bool:
        """True for a velocity or a distance in a direction that is not released; rounding has none."""
        released = self._forward if direction > 0.0 else self._backward
        return abs(direction) > NEGLIGIBLE and not released

    def release(self, cycle: int, *, forward: bool, backward: bool) -> None:
        """Releases each direction or withholds it; a job that goes in a withheld one stops on its ramp and waits."""
        self._forward, self._backward = forward, backward
        job = self.job
        if job is None or self._in_brake_phase(cycle, job):
            return
        if self._must_wait(cycle, job) != self._waits_for_release:
            self._lead(cycle, job, *self._table(cycle, job))

    def _must_wait(self, cycle: int, job: Job) -> bool:
        """True if a stop would bring the axis to rest where the target is in a withheld direction."""
        if not self.restricted or job.stands:
            return False
        if job.through:
            return self.withholds(job.through)
        stop = plan_to_velocity(*self.state(cycle)[:3], 0.0, self._braking(cycle, job))
        return self.withholds(job.target - stop.end[0])

    def _braking(self, cycle: int, job: Job) -> Limits:
        """The limits with whose A- and J the active job brakes at `cycle`."""
        return job.limits if job.ramp is None else planned(self.state(cycle)[:3], job.target, job.limits, job.ramp)[1]

    def _lead(self, cycle: int, job: Job, table: Profile, limits: Limits) -> None:
        """Sets the table of the active job, or the ramp to standstill if it must wait."""
        self._waits_for_release = self._must_wait(cycle, job)
        if self._waits_for_release:
            limits = self._braking(cycle, job)
            table = plan_to_velocity(*self.state(cycle)[:3], 0.0, limits)
        self._set(cycle, table, limits)

    # setpoints

    def state(self, cycle: int) -> MotionState:
        """Setpoint at `cycle`: position, velocity, acceleration, jerk."""
        return self._profile.state_at((cycle - self._origin) * self._cycle_time)

    def setpoints(self, first_cycle: int, count: int) -> Setpoints:
        """Setpoints of `count` cycles, fewer (but one at least) when something comes due among them."""
        if self._due is not None:
            count = max(1, min(count, self._due - first_cycle))
        p, v, a, j = self.state(first_cycle)
        if v == a == j == 0.0 and self.finished(first_cycle):
            return Setpoints([p] * count, [0.0] * count, [0.0] * count, [0.0] * count)
        return self._profile.setpoints(first_cycle - self._origin, count, self._cycle_time)

    def finished(self, cycle: int) -> bool:
        """True when the active table has ended at `cycle`."""
        return (cycle - self._origin) * self._cycle_time >= self._profile.duration

    def arrived(self, cycle: int) -> bool:
        """True when the table has finished and nothing is left to do (a job held by override 0 is left)."""
        return self.finished(cycle) and self._suspended is None and (self.job is None or self._ends_at(self.job))

    def braking(self, cycle: int) -> bool:
        """True in the brake phase: the last ramp down of a job, or that of a stop."""
        if self.job is None:
            return True
        _, velocity, acceleration, _ = self.state(cycle)
        return velocity * acceleration <= 0.0 and self._in_brake_phase(cycle, self.job)

    @property
    def target_velocity(self) -> float:
        """Velocity (mm/s, deg/s) of the active job at 100 % override; 0.0 without one."""
        return 0.0 if self.job is None or self.job.stands else self._full_velocity(self.job)

    @property
    def rest(self) -> float:
        """Where the active positioning, or the ramp of a stop, ends."""
        return self._profile.end[0] if self.job is None else self.job.target

    @property
    def can_redirect(self) -> bool:
        """True while there is a positioning, or a stop of one, that can be given a new target."""
        return self.job is not None or self._stopped_job is not None

    def handover(self, cycle: int, *, in_velocity: bool) -> int | None:
        """The first cycle from `cycle` on in which another motion may follow; None while the axis is held.

        `in_velocity`: already when the job has its velocity, otherwise only at its end.
        """
        job = self.job
        if job is None:
            return max(cycle, self._end_cycle())
        if job.through:
            return self._crossing(cycle, Activation(job.target, copysign(1.0, job.through), 0.0))
        if isinf(job.target):
            return max(cycle, self._end_cycle()) if self._profile.end[1] or job.stands else None
        constant = self._constant_from(cycle, self._level(job).velocity) if in_velocity else None
        if constant is None and self._ends_at(job):
            return max(cycle, self._end_cycle())
        return constant

    def _constant_from(self, cycle: int, velocity: float) -> int | None:
        """The first cycle from `cycle` on that has this constant speed; None if none has."""
        for begin, end in constant_spans(self._profile, velocity):
            first = max(cycle, self._origin + ceil(begin / self._cycle_time))
            if (first - self._origin) * self._cycle_time < end:
                return first
        return None

    def brakes_to(self, cycle: int, target: float) -> bool:
        """True in the brake phase of a job to `target`, in which nothing can be changed."""
        return self.job is not None and self.job.target == target and self._in_brake_phase(cycle, self.job)

    @property
    def halts_jog(self) -> bool:
        """True while the axis is on the ramp that has ended a jog."""
        return self.job is None and self._stopped_job is not None and self._stopped_job.jog

    def highest_velocity(self, cycle: int) -> float:
        """The largest |v| (mm/s) that the active positioning may still reach, including a pending new velocity."""
        limits = [] if self.job is None else [self.job.reduced_velocity, abs(self.job.through)]
        coming = [] if self._activation is None else [self._activation.velocity]
        return max([abs(self.state(cycle)[1]), *limits, *coming])

    # commands

    def start(self, cycle: int, target: float, limits: Limits) -> None:
        """Starts from standstill towards `target` (mm or deg); with override 0 the job waits.

        Raises CncError 23001 and 23002 for limits and targets that no table can be made for; then nothing is changed.
        """
        check_limits(limits)
        job = self._job_from_rest(self.state(cycle)[0], target, limits)
        self._begin(cycle, job, *self._table(cycle, job))

    def continue_at(self, cycle: int, full_velocity: float, limits: Limits) -> None:
        """Continues endlessly with the velocity left when the acceleration is taken out; 0 ends at a standstill.

        `full_velocity` (mm/s, deg/s) is the velocity at 100 % override when that changes. Source: TX1250 3.2.3.
        """
        position, velocity, acceleration, jerk = self.state(cycle)
        left = velocity + acceleration * abs(acceleration) / (2.0 * limits.jerk)
        if left * velocity <= 0.0 or (acceleration != 0.0 and abs(left) <= self._blur(jerk, limits.jerk)):
            self.finish()
            self._set(cycle, plan_to_velocity(position, velocity, acceleration, 0.0, limits), limits)
            return
        job = Job(copysign(inf, left), limits._replace(velocity=full_velocity), full_velocity)
        self._begin(cycle, job, plan_to_velocity(position, velocity, acceleration, left, limits), job.limits)

    def _blur(self, jerk: float, own_jerk: float) -> float:
        """Velocity (mm/s) that a master's last ramp seems to leave because it ends within a cycle, not at its start."""
        most = max(abs(jerk), own_jerk)
        return 0.5 * most * self._cycle_time**2 * (1.0 + most / own_jerk)

    def continue_to(self, cycle: int, target: float, limits: Limits, *, jog: bool = False) -> None:
        """Another job for an axis in motion: to `target`, endless for ±infinity; a `jog` only another one may change.

        If its limits would lead past the target, or too fast, A- and J of the motion until now count where these are
        larger. Raises CncError 23001 and 23002 for limits and targets that no table can be made for; then nothing is
        changed.
        """
        check_limits(limits)
        start = self._start(cycle)
        past = not isinf(target) and leads_past(*start, target, limits)
        ramp = stronger(limits, self._ramp_limits) if past or leads_too_fast(start, limits) else None
        job = replace(self._job_in_motion(cycle, target, limits, ramp), jog=jog)
        self._activation = self._due = None
        self._begin(cycle, job, *self._table(cycle, job))

    def come_to_rest(self, cycle: int, limits: Limits, room: tuple[float, float]) -> None:
        """An endless job at velocity 0, on the ramp of `limits`.

        Where that would lead out of `room` (lowest and highest position), A- and J of the motion until now count where
        these are larger. Raises CncError 23001; then nothing is changed.
        """
        check_limits(limits)
        end = plan_to_velocity(*self._start(cycle), 0.0, limits).end[0]
        if not room[0] <= end <= room[1]:
            limits = stronger(limits, self._ramp_limits) or limits
        self._activation = self._due = None
        job = Job(inf, limits, 0.0, stands=True)
        self._begin(cycle, job, *self._table(cycle, job))

    @property
    def stands(self) -> bool:
        """The active job is at velocity 0."""
        return self.job is not None and self.job.stands

    def pass_through(self, cycle: int, velocity: float) -> None:
        """The active positioning passes its target with the signed `velocity` (mm/s), as far as it can reach that.

        What comes then is up to `continue_to` in the cycle `handover`.
        """
        assert self.job is not None
        job = replace(self.job, through=velocity)
        self._begin(cycle, job, *self._table(cycle, job))

    def steady(self, cycle: int, job: Job) -> bool:
        """The active job keeps within its own limits, and can still stop in its target."""
        return self.passes_by(cycle, job) <= 0.0 and self._braking(cycle, job) == job.limits

    def lift_ceiling(self, cycle: int) -> None:
        """Nothing is superimposed from now on: the job has its own velocity again."""
        limited = self.ceiling < inf
        self.ceiling = inf
        job = self.job
        if limited and job is not None and not self._in_brake_phase(cycle, job):
            self._lead(cycle, job, *self._table(cycle, job))

    def shift(self, distance: float) -> None:
        """All coordinates grow by `distance`; the motion is the same."""
        self._profile = Profile([(t, p + distance, v, a, j) for t, p, v, a, j in self._profile.rows])
        self.job = None if self.job is None else self.job.shifted(distance)
        self._stopped_job = None if self._stopped_job is None else self._stopped_job.shifted(distance)
        if self._suspended is not None:
            target, velocity, activation = self._suspended
            self._suspended = Request(target + distance, velocity, activation + distance)
        if self._activation is not None:
            self._activation = replace(self._activation, position=self._activation.position + distance)

    def set_override(self, cycle: int, ratio: float) -> bool:
        """Takes over an override of 0.0 to 1.0; False when it only counts for the next start.

        It acts immediately unless a stop is active or the brake phase is reached. Types 1 and 2 keep the old table when
        the new velocity level cannot be reached; types 3 and 4 take the highest level that can, which is that of the
        old table when the axis is faster than the new level.
        """
        self.override = ratio if ratio >= SMALLEST_OVERRIDE else 0.0
        job = self.job
        if job is None or self._in_brake_phase(cycle, job):
            return False
        table, limits = self._table(cycle, job)
        if self._level_is_missed(cycle, job, table):
            return False
        self._lead(cycle, job, table, limits)
        return True

    def stop(self, cycle: int, limits: Limits, *, at_least: bool = False, locks: bool = True) -> None:
        """Ends the job and ramps down with A- and J of the active motion, or of `limits` if there is none.

        `at_least`: the ramp is not weaker than `limits` either. Otherwise a brake phase continues. `locks`: new targets
        wait until the axis is at a standstill (a stop); without it they act immediately (a halt).
        """
        ramp = self._ramp_limits or limits
        if self.job is not None and self.job.ramp is not None:
            ramp = self._braking(cycle, self.job)
        if at_least:
            ramp = Limits(*map(max, ramp, limits))
        brakes = self._is_stop_ramp() if self.job is None else self._in_brake_phase(cycle, self.job)
        self._stopped_job, self.job = self.job or self._stopped_job, None
        self._suspended = self._activation = self._due = None
        self._stop_locks = locks
        if at_least or not brakes:
            self._set(cycle, plan_to_velocity(*self._start(cycle), 0.0, ramp), ramp)

    def redirect(self, cycle: int, request: Request) -> None:
        """New target, with or without a new velocity, for the active positioning (TX1250 2.3, 2.4).

        A pending activation is deleted. During a stop the request waits until the axis is at a standstill.
        Raises CncError 23001 and 23002 for a velocity or target that no table can be made for; then nothing is changed.
        """
        check_state(target=request.target)
        if request.velocity is not None:
            check_limit("velocity", request.velocity)
        if self.job is None and self._stop_locks:
            self._suspended = request
            self._due = self._end_cycle()
        else:
            self._carry_out(cycle, request)

    def drop_suspended(self) -> bool:
        """Cancels a request that waits for the end of a stop; False when there is none."""
        waiting = self._suspended is not None
        if waiting:
            self._suspended = self._due = None
        return waiting

    def advance(self, cycle: int) -> None:
        """Carries out what is due at `cycle`."""
        if self._due is None or cycle < self._due:
            return
        self._due = None
        if self._suspended is not None:
            request, self._suspended = self._suspended, None
            self._carry_out(cycle, request)
        elif self._activation is not None and self.job is not None:
            activation, self._activation = self._activation, None
            self._change_velocity(cycle, self.job, activation.velocity)

    def follow(self, cycle: int, trajectory: Profile) -> None:
        """Follows a trajectory from a standstill on."""
        self.finish()
        self._set(cycle, trajectory, None)
        self.follows = True

    def finish(self) -> None:
        """The table has finished: job, stop and trajectory have ended."""
        self.follows = False
        self.job = self._stopped_job = None
        self._ramp_limits = None
        self._suspended = self._activation = self._due = None

    def take_over(self, cycle: int, position: float, velocity: float, acceleration: float, jerk: float = 0.0) -> None:
        """Continues from the state of another setpoint source at `cycle`; if that moves, a stop must follow."""
        ramp = self._ramp_limits
        self.finish()
        self._set(cycle, Profile([(0.0, position, velocity, acceleration, jerk)]), ramp)

    def run_out(self, cycle: int, profile: Profile) -> None:
        """Ends the job; the stop ramp is `profile`, which begins at `cycle`."""
        self.finish()
        self._stop_locks = True
        self._set(cycle, profile, None)

    # tables

    def _begin(self, cycle: int, job: Job, table: Profile, limits: Limits) -> None:
        self.job, self._stopped_job = job, None
        self._lead(cycle, job, table, limits)

    def _set(self, cycle: int, profile: Profile, limits: Limits | None) -> None:
        self._origin = cycle
        self._profile = profile
        self._ramp_limits = limits
        self.follows = False
        if self._activation is not None:
            self._due = self._crossing(cycle, self._activation)

    def _end_cycle(self) -> int:
        """The first cycle at which the active table has finished."""
        cycle = self._origin + ceil(self._profile.duration / self._cycle_time)
        return cycle if self.finished(cycle) else cycle + 1

    def _ends_at(self, job: Job) -> bool:
        """The active table leads to the target; that of override 0 does not."""
        return bool(self._profile.end[0] == job.target)

    def _is_stop_ramp(self) -> bool:
        """For a table without a job: it comes to rest; one that was taken over in motion does not."""
        return self._profile.end[1:] == (0.0, 0.0)

    def _start(self, cycle: int) -> Start:
        """Position, velocity and acceleration from which a new table starts.

        In the last jerk phase before standstill the velocity is exactly the one that this phase takes out, so that no
        rounding makes the axis miss its standstill.
        """
        position, velocity, acceleration, jerk = self.state(cycle)
        starts = self._profile.starts
        last_phase = len(starts) > 1 and (cycle - self._origin) * self._cycle_time >= starts[-2]
        if last_phase and self._is_stop_ramp() and acceleration * jerk < 0.0:
            velocity = acceleration * acceleration / (2.0 * jerk)
        return position, velocity, acceleration

    def passes_by(self, cycle: int, job: Job) -> float:
        """How far (mm, deg) a stop would end beyond the target of `job`, in the direction of motion; < 0: before it."""
        position, velocity, acceleration, _ = self.state(cycle)
        ahead = plan_to_velocity(position, velocity, acceleration, 0.0, self._braking(cycle, job)).end[0]
        behind = copysign(1.0, velocity) * (ahead - job.target)
        return 0.0 if abs(behind) <= abs(velocity) * INSTANT + rounding(position, job.target) else behind

    def _in_brake_phase(self, cycle: int, job: Job) -> bool:
        """True when the table leads to the target and a stop would do the same: nothing can be changed.

        Without a segment of constant velocity this begins before the velocity falls, as soon as the acceleration does.
        """
        if job.through or not self._ends_at(job):
            return False
        position, velocity, acceleration, _ = self.state(cycle)
        if velocity == 0.0 and acceleration == 0.0:
            return bool(position == job.target)
        return self.passes_by(cycle, job) == 0.0

    def _job_from_rest(self, position: float, target: float, limits: Limits) -> Job:
        return self._job_of(target, limits, plan_rest_to_rest(position, target, limits).rows)

    def _job_in_motion(self, cycle: int, target: float, limits: Limits, ramp: Limits | None = None) -> Job:
        """The job to `target` for an axis in motion; if it stops and returns, its return counts."""
        if isinf(target):
            return Job(target, limits, limits.velocity, ramp)
        leg = last_leg(planned(self._start(cycle), target, limits, ramp)[0])
        if leg[0][2] == 0.0 and leg[0][3] == 0.0:
            return replace(self._job_from_rest(leg[0][1], target, limits), ramp=ramp)
        return replace(self._job_of(target, limits, leg), ramp=ramp)

    def _job_of(self, target: float, limits: Limits, leg: Sequence[Segment]) -> Job:
        return Job(target, limits, min(limits.velocity, peak_velocity(leg)))

    def _level(self, job: Job) -> Limits:
        """Limits with the velocity of the override; at least the smallest for which tables can be made."""
        velocity = min(self._full_velocity(job) * self.override, self.ceiling)
        return job.limits._replace(velocity=max(velocity, SMALLEST_LIMIT))

    def _full_velocity(self, job: Job) -> float:
        return job.limits.velocity if self.override_type in (2, 4) else job.reduced_velocity

    def _table(self, cycle: int, job: Job) -> tuple[Profile, Limits]:
        """The table to the target at the velocity of the override, and the limits of its first part.

        With override 0, and at velocity 0, it leads to standstill.
        """
        start, level = self._start(cycle), self._level(job)
        if self.override == 0.0 or job.stands:
            limits = self._braking(cycle, job)
            return plan_to_velocity(*start, 0.0, limits), limits
        return job.table(start, level, min(abs(job.through) * self.override, self.ceiling))

    def _level_is_missed(self, cycle: int, job: Job, table: Profile) -> bool:
        """The active table leads to the target, and the new one does not reach its level.

        Override types 3 and 4 take what can be reached instead, unless the axis would have to slow down to the level:
        it would brake for the level and then for the target, later and harder than with the table that it has.
        """
        if self.override == 0.0 or job.through or not self._ends_at(job):
            return False
        _, velocity, acceleration, _ = self.state(cycle)
        if (velocity == 0.0 and acceleration == 0.0) or reaches(table, self._level(job).velocity):
            return False
        left = velocity + acceleration * abs(acceleration) / (2.0 * job.limits.jerk)
        return self.override_type in (1, 2) or abs(left) > self._level(job).velocity

    # new target, new velocity

    def _carry_out(self, cycle: int, request: Request) -> None:
        """Leads to the new target; the new velocity becomes active now, later or never.

        If the axis has passed the target, or cannot stop before it, it stops and returns, with the old velocity; if
        that cannot be reached during the return but the new one can, with the new one.
        """
        before = self.job or self._stopped_job
        if before is None:
            return
        position, velocity, _, _ = self.state(cycle)
        goal = request.target if self.job is None else self.job.target
        direction = copysign(1.0, velocity or goal - position)
        self._activation = self._due = None
        job = self._job_in_motion(cycle, request.target, before.limits, before.ramp)
        leg = last_leg(planned(self._start(cycle), request.target, before.limits, before.ramp)[0])
        returns = velocity != 0.0 and leg[0][2] == 0.0
        if returns and request.velocity is not None and request.velocity <= job.reduced_velocity < job.limits.velocity:
            job = replace(job, limits=job.limits._replace(velocity=request.velocity), reduced_velocity=request.velocity)
        self._begin(cycle, job, *self._table(cycle, job))
        if request.velocity is not None and not returns:
            self._stage_velocity(cycle, job, velocity_stage(direction, position, request), direction, request)

    def _stage_velocity(self, cycle: int, job: Job, stage: Stage, direction: float, request: Request) -> None:
        assert request.velocity is not None
        if stage is Stage.NOW:
            self._change_velocity(cycle, job, request.velocity)
        elif stage is Stage.LATER:
            self._activation = Activation(request.activation_position, direction, request.velocity)
            self._due = self._crossing(cycle, self._activation)

    def _change_velocity(self, cycle: int, job: Job, velocity: float) -> None:
        """Takes the new velocity, or the nearest one that the distance to go permits; else the old table is kept."""
        reached = self._nearest_reached(cycle, job, velocity)
        if reached is not None:
            reduced = self._job_in_motion(cycle, job.target, job.limits._replace(velocity=reached), job.ramp)
            reduced = replace(reduced, through=job.through)
            wanted = replace(reduced, limits=job.limits._replace(velocity=velocity))
            self._begin(cycle, wanted, *self._table(cycle, reduced))

    def _nearest_reached(self, cycle: int, job: Job, velocity: float) -> float | None:
        """`velocity` if the distance to go has a segment at it, else by bisection towards the old one; None if none."""
        best, low, high, candidate = None, job.limits.velocity, velocity, velocity
        for _ in range(1 + REDUCTIONS):
            if self._can_reach(cycle, job, candidate):
                best = low = candidate
                if candidate == velocity:
                    break
            else:
                high = candidate
            candidate = 0.5 * (low + high)
        return best

    def _can_reach(self, cycle: int, job: Job, velocity: float) -> bool:
        """True when the distance to go has a segment at `velocity`, scaled by the override."""
        if isinf(job.target):
            return True
        level = velocity * (self.override or 1.0)
        limits = job.limits._replace(velocity=max(level, SMALLEST_LIMIT))
        return reaches(planned(self._start(cycle), job.target, limits, job.ramp)[0], limits.velocity)

    def _crossing(self, cycle: int, activation: Activation) -> int | None:
        """The first cycle at which the active table is at or past the activation position, None when it never is."""
        end = max(cycle, min(self._end_cycle(), cycle + sys.maxsize))

        def passed(at: int) -> bool:
            return activation.direction * (self.state(at)[0] - activation.position) >= 0.0

        return cycle + bisect_left(range(cycle, end), True, key=passed) if passed(end) else None
