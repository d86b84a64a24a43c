"""Stop, halt and emergency stop of an axis. Source: TX1250 2.2."""

from __future__ import annotations

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import EMERGENCY_TOO_WEAK, IN_BRAKE_PHASE, NOT_READY, SLAVE_LOCKED
from cnc_ptp.axis.states import AxisStateCode as S
from cnc_ptp.axis.states import state_name
from cnc_ptp.motion import Limits

MOVING = (S.DISCRETE_MOTION, S.CONTINUOUS_MOTION)


class StopCommands:
    """A stop has priority over all other functions; it ends compensation and external setpoints too."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis

    def do_stop(self, cycle: int) -> str | None:
        """Stops on the ramp of the start. New targets wait until the axis stands (state Stopping)."""
        return self._stop("stop", cycle, locks=True)

    def do_halt(self, cycle: int) -> str | None:
        """Stops on the ramp of the start, but a new target leads the axis on at once (state DiscreteMotion)."""
        return self._stop("halt", cycle, locks=self._axis.state == S.CONTINUOUS_MOTION)

    def _stop(self, command: str, cycle: int, *, locks: bool) -> str | None:
        axis = self._axis
        self._refuse_synchronous(command)
        if axis.state == S.STOPPING and axis.ptp.drop_suspended():
            return f"axis {axis.name}: {command} takes the new target back; the axis stops"
        if axis.state not in MOVING:
            return f"axis {axis.name}: {command} without effect in {state_name(axis.state)}"
        axis.stop(cycle, locks=locks)
        self._stopped(locks)
        return None

    def _refuse_synchronous(self, command: str) -> None:
        """What follows a channel or a master is stopped there."""
        axis = self._axis
        if axis.coupled and axis.coupling is not None:
            master = axis.coupling.master
            axis.refuse(command, SLAVE_LOCKED, f"the axis is a slave of {master}; stop {master} or decouple the axis")
        if axis.on_path:
            reason = "the channel path moves the axis; use feed_hold or reset of the channel"
            axis.refuse(command, NOT_READY, reason)

    def _stopped(self, locks: bool) -> None:
        if locks:
            self._axis.state = S.STOPPING
        self._axis.has_been_stopped = True

    def do_emergency_stop(self, cycle: int, *, deceleration: float, jerk: float) -> str | None:
        """Stops with a deceleration (mm/s²) and a jerk (mm/s³) that are both larger than those of the start.

        Refusals: 23003, 23005, 23013, 23016 (not larger), 23017 (brake phase, natural or by a stop).
        """
        axis, command = self._axis, "emergency_stop"
        self._refuse_synchronous(command)
        if axis.state not in (*MOVING, S.STOPPING):
            return f"axis {axis.name}: {command} without effect in {state_name(axis.state)}"
        if axis.state == S.STOPPING and axis.ptp.drop_suspended():
            return f"axis {axis.name}: {command} takes the new target back; the axis stops"
        if axis.state == S.STOPPING or (axis.state == S.DISCRETE_MOTION and axis.ptp.braking(cycle)):
            axis.refuse(command, IN_BRAKE_PHASE, "the axis is in its brake phase")
        axis.checks.positive(command, {"deceleration": deceleration, "jerk": jerk})
        axis.checks.emergency_deceleration(command, deceleration)
        start = axis.own_limits if axis.ptp.job is None else axis.ptp.job.limits
        self._require_stronger(start, deceleration, jerk)
        emergency = Limits(start.velocity, deceleration, deceleration, jerk)
        ramp, warning = axis.checks.rescaled_jerk(command, emergency)
        axis.absorb(cycle)
        axis.ptp.stop(cycle, ramp, at_least=True)
        self._stopped(locks=True)
        return warning

    def _require_stronger(self, start: Limits, deceleration: float, jerk: float) -> None:
        axis = self._axis
        for name, value, limit, unit in (
            ("deceleration", deceleration, start.deceleration, "s²"),
            ("jerk", jerk, start.jerk, "s³"),
        ):
            if value <= limit:
                reason = f"{name} {value} {axis.unit}/{unit} is not larger than {limit} {axis.unit}/{unit} of the start"
                axis.refuse("emergency_stop", EMERGENCY_TOO_WEAK, f"{reason}; use stop")
