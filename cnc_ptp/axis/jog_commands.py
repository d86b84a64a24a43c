"""Jogging: endless motion at a velocity, on a linear axis up to its soft limit (PLCopen MC_MoveVelocity)."""

from __future__ import annotations

from math import copysign

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import COMPENSATION_RUNS, NOT_READY
from cnc_ptp.axis.ptp import Job
from cnc_ptp.axis.ptp_commands import refuse_other_source
from cnc_ptp.motion.limits import rounding
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

JOG = "jog"


class JogCommands:
    """`jog`. Its job leads to the soft limit, so that the axis comes to rest there at any override and velocity."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis
        self._job: Job | None = None

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
        end = axis.checks.soft_limit(velocity).position
        self._check_room(cycle, velocity)
        if axis.ptp.brakes_to(cycle, end):
            return f"axis {axis.name}: {JOG} changes nothing: the axis brakes to its soft limit {end} {axis.unit}"
        axis.absorb(cycle)
        axis.ptp.continue_to(cycle, end, limits)
        self._job = axis.ptp.job
        axis.target_window.watch()
        axis.has_been_stopped = False
        axis.take(T.JOG)
        return warning

    def _end(self, cycle: int) -> None:
        """A halt of the jog; a new velocity or target is permitted while it brakes."""
        if self._jogs():
            self._axis.stop(cycle, locks=False)
            self._axis.take(T.END_JOG)
            self._axis.has_been_stopped = True

    def _jogs(self) -> bool:
        return self._axis.state == S.CONTINUOUS_MOTION and self._job is not None and self._axis.ptp.job is self._job

    def _brakes(self) -> bool:
        """A jog has ended, and the axis is still on its ramp."""
        return self._axis.state == S.DISCRETE_MOTION and self._axis.ptp.halts(self._job)

    def _check_state(self) -> None:
        axis = self._axis
        refuse_other_source(axis, JOG)
        if axis.state != S.STANDSTILL and not self._jogs() and not self._brakes():
            state = state_name(axis.state)
            axis.refuse(JOG, NOT_READY, f"the axis is in {state}, it must be in Standstill or jogging", state=state)
        if axis.compensation.active and axis.state != S.STANDSTILL:
            axis.refuse(JOG, COMPENSATION_RUNS, "a position compensation is active")

    def _check_room(self, cycle: int, velocity: float) -> None:
        """Raises 120002 and 120003 outwards from the soft limit at which, or beyond which, the axis is."""
        axis, limit = self._axis, self._axis.checks.soft_limit(velocity)
        position = axis.setpoint(cycle)[0]
        room = copysign(1.0, velocity) * (limit.position - position)
        if room < -rounding(limit.position, position):
            reason = f"the axis is at {position} {axis.unit}, beyond its {limit.text}"
            axis.refuse(JOG, limit.number, reason, position=position, limit=limit.position)
        if room <= axis.parameters.encoder_increment and axis.state == S.STANDSTILL:
            axis.refuse(JOG, limit.number, f"the axis is at its {limit.text}", limit=limit.position)
