"""Jogging: endless motion at a velocity, on a linear axis up to its soft limit, that only a jog may change."""

from __future__ import annotations

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import COMPENSATION_RUNS, NOT_READY
from cnc_ptp.axis.motion_queue import MotionQueue
from cnc_ptp.axis.motions import AtVelocity, refuse_other_source
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

JOG = "jog"


class JogCommands:
    """`jog`. Its job leads to the soft limit, so that the axis comes to rest there at any override and velocity."""

    def __init__(self, axis: Axis, queue: MotionQueue) -> None:
        self._axis = axis
        self._queue = queue

    def do_jog(self, cycle: int, *, velocity: float) -> str | None:
        """Moves at `velocity` (mm/s, deg/s; its sign is the direction) until another one is commanded; 0 ends the jog.

        Refusals: 23003 – 23005, 23011, 23015, 23027, 23040, 120002, 120003. A velocity of 0 is never refused: it halts
        a jog and leaves all other motion alone.
        """
        if velocity == 0.0:
            self._end(cycle)
            return None
        axis = self._axis
        self._check_state()
        limits, warning = axis.checks.rescaled_jerk(JOG, axis.checks.dynamics(JOG, {"velocity": abs(velocity)}))
        motion, start = AtVelocity(JOG, limits, warning, velocity), axis.setpoint(cycle)[0]
        end = motion.goal(axis, start)
        motion.check(axis, start, end, at_rest=axis.state == S.STANDSTILL)
        if axis.ptp.brakes_to(cycle, end - axis.shift(cycle)):
            return f"axis {axis.name}: {JOG} changes nothing: the axis brakes to its soft limit {end} {axis.unit}"
        if axis.added.moving(cycle):
            axis.halt_added(cycle)
        else:
            axis.absorb(cycle)
        self._queue.begin(cycle, motion, end, jog=True)
        return warning

    def _end(self, cycle: int) -> None:
        """A halt of the jog; a new velocity or target is permitted while it brakes."""
        if self._jogs():
            self._axis.stop(cycle, locks=False)
            self._axis.take(T.END_JOG)
            self._axis.has_been_stopped = True

    def _jogs(self) -> bool:
        job = self._axis.ptp.job
        return self._axis.state == S.CONTINUOUS_MOTION and job is not None and job.jog

    def _brakes(self) -> bool:
        """A jog has ended, and the axis is still on its ramp."""
        return self._axis.state == S.DISCRETE_MOTION and self._axis.ptp.halts_jog

    def _check_state(self) -> None:
        axis = self._axis
        refuse_other_source(axis, JOG)
        if axis.state != S.STANDSTILL and not self._jogs() and not self._brakes():
            state = state_name(axis.state)
            axis.refuse(JOG, NOT_READY, f"the axis is in {state}, it must be in Standstill or jogging", state=state)
        if axis.compensation.active and axis.state != S.STANDSTILL:
            axis.refuse(JOG, COMPENSATION_RUNS, "a position compensation is active")
