"""When a commanded motion begins: from a standstill, by aborting another one, or behind it (PLCopen buffer modes).

| buffer mode | from Standstill | while the axis moves |
|---|---|---|
| left out | immediately | refused |
| aborting | immediately | immediately, from the state of that cycle |
| buffered | immediately | in the cycle in which the active motion ends |
| blending_… | immediately | when the axis passes the target of the active positioning at a velocity |

One motion waits at most. A stop, a halt, an aborting motion, an error and the loss of the enable drop it.
Source: PLCopen Motion Control part 1, 2.4.2.
"""

from __future__ import annotations

from collections.abc import Callable
from math import copysign

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis, Report
from cnc_ptp.axis.faults import BELOW_INCREMENT, COMPENSATION_RUNS, MOTION_WAITS, NOT_READY
from cnc_ptp.axis.job import Job
from cnc_ptp.axis.motions import AtRest, Motion, ToModulo, ToTarget, refuse_beside_trajectory, refuse_other_source
from cnc_ptp.errors import CncError, warning_text
from cnc_ptp.motion import Limits, stopping_distance
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

ABORTING, BUFFERED = "aborting", "buffered"
TRANSITION_VELOCITY: dict[str, Callable[[float, float], float]] = {
    "blending_low": lambda previous, following: min(previous, following),
    "blending_previous": lambda previous, following: previous,
    "blending_next": lambda previous, following: following,
    "blending_high": lambda previous, following: max(previous, following),
}
"""Buffer mode -> velocity in the target of the previous motion, from the velocities of both."""
HALVINGS = 50
"""Steps of the bisection for a velocity from which the next motion can still stop at its target."""


class MotionQueue:
    """Begins the motions of one axis, and keeps the one that waits."""

    def __init__(self, axis: Axis, *, cycle_time: float, report_warning: Report) -> None:
        """`cycle_time` in s."""
        self._axis = axis
        self._cycle_time = cycle_time
        self._report_warning = report_warning
        self._waiting: Motion | None = None
        self._mode = BUFFERED
        self._job = 0
        """Number of the job of the motion that waits; it is void when the axis no longer waits for it."""

    # commands

    def start(self, cycle: int, motion: Motion, buffer_mode: str) -> str | None:
        """Begins `motion`, or lets it wait. Raises 23005, 23015, 23027, 23040, 23063, 120002, 120003."""
        axis = self._axis
        self._check_state(motion.command, buffer_mode)
        if axis.state == S.STANDSTILL:
            return self._from_rest(cycle, motion)
        if buffer_mode == ABORTING:
            self._abort(cycle, motion)
        else:
            self._wait(cycle, motion, buffer_mode)
        return motion.warning

    def _check_state(self, command: str, buffer_mode: str) -> None:
        axis = self._axis
        refuse_other_source(axis, command)
        if axis.state == S.STANDSTILL:
            return
        if not buffer_mode or axis.state not in (S.DISCRETE_MOTION, S.CONTINUOUS_MOTION):
            state = state_name(axis.state)
            permitted = "Standstill, DiscreteMotion or ContinuousMotion" if buffer_mode else "Standstill"
            axis.refuse(command, NOT_READY, f"the axis is in {state}, it must be in {permitted}", state=state)
        if buffer_mode == ABORTING:
            if axis.compensation.active:
                axis.refuse(command, COMPENSATION_RUNS, "a position compensation is active")
            return
        refuse_beside_trajectory(axis, command)
        if axis.waiting_job:
            reason = f"job {axis.waiting_job} waits already, no other can"
            axis.refuse(command, MOTION_WAITS, reason, job=axis.waiting_job)

    def _from_rest(self, cycle: int, motion: Motion) -> str | None:
        axis = self._axis
        position, start = axis.setpoint(cycle)[0], motion.start(axis, cycle)
        goal = self._goal(motion, start, at_rest=True)
        distance, increment = abs(goal - position), axis.parameters.encoder_increment
        if not motion.endless and (distance < increment or distance == 0.0):
            axis.has_been_stopped = False
            axis.last_target = goal
            move = f"axis {axis.name}: {motion.command} over"
            if distance == 0.0:
                text = f"{move} 0 {axis.unit}: the axis is at its target already; the axis does not move"
                return warning_text(BELOW_INCREMENT, text)
            size = f"{distance:g} {axis.unit} is below one encoder increment ({increment} {axis.unit})"
            return warning_text(
                BELOW_INCREMENT, f"{move} {size}; the axis does not move", distance=distance, limit=increment
            )
        axis.absorb(cycle)
        self.begin(cycle, motion, goal)
        return motion.warning

    def _abort(self, cycle: int, motion: Motion) -> None:
        """The active motion ends here; a superimposed one comes to rest on its ramp."""
        goal = self._goal(motion, motion.start(self._axis, cycle), at_rest=False)
        self._axis.halt_added(cycle)
        self.begin(cycle, motion, goal)

    def begin(self, cycle: int, motion: Motion, goal: float, *, jog: bool = False) -> None:
        """Leads the axis to `goal`."""
        axis = self._axis
        axis.leave_trajectory(cycle)
        target, from_rest = goal - axis.shift(cycle), axis.state == S.STANDSTILL
        if isinstance(motion, AtRest):
            axis.ptp.come_to_rest(cycle, motion.limits, motion.room(axis, cycle))
        elif from_rest and not motion.endless:
            axis.ptp.start(cycle, target, motion.limits)
        else:
            axis.ptp.continue_to(cycle, target, motion.limits, jog=jog)
        axis.target_window.watch()
        axis.has_been_stopped = False
        if motion.endless:
            axis.take(T.JOG if jog else T.RUN)
        else:
            axis.take(T.START if from_rest else T.NEXT)
            axis.last_target = goal

    def _goal(self, motion: Motion, start: float, *, at_rest: bool) -> float:
        """Where `motion` ends if it begins at `start`; raises 120002, 120003, 23002."""
        goal = motion.goal(self._axis, start)
        motion.check(self._axis, start, goal, at_rest=at_rest)
        return goal

    # behind the active motion

    def _wait(self, cycle: int, motion: Motion, buffer_mode: str) -> None:
        """Lets `motion` wait; what is known of the end of the active one is checked already."""
        axis = self._axis
        if axis.state == S.DISCRETE_MOTION:
            goal = self._goal(motion, axis.ptp.rest + axis.shift(cycle), at_rest=buffer_mode == BUFFERED)
            if isinstance(motion, ToModulo):
                motion = ToTarget(motion.command, motion.limits, motion.warning, goal)
        elif isinstance(motion, ToTarget):
            self._goal(motion, 0.0, at_rest=False)
        self._waiting, self._mode = motion, buffer_mode
        self._job = axis.waiting_job = axis.jobs.newest + 1
        self._blend(cycle)

    def check_addition(self, cycle: int, distance: float) -> None:
        """Raises 120002 and 120003 when the motion that waits would lead too far with `distance` in addition."""
        axis, motion = self._axis, self._waiting
        if self.waits and motion is not None and axis.state == S.DISCRETE_MOTION:
            self._goal(motion, axis.ptp.rest + axis.shift(cycle) + distance, at_rest=False)

    def adapt(self, cycle: int) -> None:
        """What is added to the basic motion has changed: the target may have to be passed at another velocity."""
        if self.waits:
            self._blend(cycle)

    def _blend(self, cycle: int) -> None:
        """Passes the target of the active positioning on the way to that of the motion that waits.

        Where it must reverse, or is stopping, it ends there.
        """
        axis, ptp, job, motion = self._axis, self._axis.ptp, self._axis.ptp.job, self._waiting
        if self._mode == BUFFERED or motion is None or job is None or axis.state != S.DISCRETE_MOTION:
            return
        end = job.target + axis.shift(cycle)
        distance, following = job.target - ptp.state(cycle)[0], motion.goal(axis, end) - end
        velocity = TRANSITION_VELOCITY[self._mode](job.limits.velocity, motion.limits.velocity)
        velocity = self._stoppable(velocity, abs(following), motion.limits)
        if distance * following <= 0.0 or not ptp.steady(cycle, job):
            velocity = 0.0
        if velocity or job.through:
            ptp.pass_through(cycle, copysign(velocity, following))

    def _stoppable(self, velocity: float, distance: float, limits: Limits) -> float:
        """The largest velocity up to `velocity` from which `limits` stop within `distance`, a cycle later at most."""

        def fits(v: float) -> bool:
            return stopping_distance(v, 0.0, limits.deceleration, limits.jerk) + v * self._cycle_time <= distance

        low, high = 0.0, velocity
        if fits(velocity):
            return velocity
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if fits(middle) else (low, middle)
        return low

    @property
    def waits(self) -> bool:
        """A motion waits for the end of the active one."""
        if self._waiting is not None and self._axis.waiting_job != self._job:
            self._waiting = None
        return self._waiting is not None

    def shift(self, distance: float) -> None:
        """All coordinates of the axis grow by `distance`."""
        if self._waiting is not None:
            self._waiting.shift(distance)

    # cycles

    def cycles(self, cycle: int, count: int) -> int:
        """How many cycles from `cycle` on, `count` at most, pass before the turn of the motion that waits."""
        if not self.waits:
            return count
        turn = self._turn(cycle + 1)
        return count if turn is None else max(1, min(count, turn - cycle))

    def _turn(self, cycle: int) -> int | None:
        """The first cycle from `cycle` on in which the active motion is at its end, or has its velocity."""
        axis = self._axis
        return axis.ptp.handover(cycle, in_velocity=axis.state == S.CONTINUOUS_MOTION)

    def advance(self, cycle: int) -> None:
        """Begins the motion that waits, if `cycle` is its turn."""
        if not self.waits or self._turn(cycle) != cycle:
            return
        axis, motion = self._axis, self._waiting
        assert motion is not None
        axis.setpoint(cycle)  # brings a compensation up to this cycle
        axis.compensation.end()
        if axis.compensation.moving:
            return
        self._waiting = None
        job = axis.ptp.job
        passed = job if job is not None and job.through else None
        start = axis.shift(cycle) + (axis.ptp.state(cycle)[0] if passed is None else passed.target)
        try:
            refuse_other_source(axis, motion.command)
            goal = self._goal(motion, start, at_rest=axis.ptp.state(cycle)[1] == 0.0)
        except CncError as error:
            self._turn_down(cycle, error, passed)
            return
        axis.next_job(cycle)
        self.begin(cycle, motion, goal)

    def _turn_down(self, cycle: int, error: CncError, passed: Job | None) -> None:
        """The motion is refused at its turn; an axis that has passed the former target halts."""
        axis = self._axis
        number, axis.waiting_job = axis.waiting_job, 0
        if passed is not None:
            axis.next_job(cycle)
            axis.ptp.stop(cycle, axis.own_limits, locks=False)
            axis.has_been_stopped = True
        axis.jobs.drop(cycle, number, error.number)
        self._report_warning(cycle, error.number, error.message, error.values)
