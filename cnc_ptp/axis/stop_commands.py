"""Stop, halt and emergency stop of an axis. Source: TX1250 2.2."""

from __future__ import annotations

from math import inf, nan

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import EMERGENCY_CORRECTED, IN_BRAKE_PHASE, NOT_READY, SLAVE_LOCKED
from cnc_ptp.axis.transitions import STOPPABLE
from cnc_ptp.errors import joined_warnings, warning_text
from cnc_ptp.motion import Limits
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.notes import without_effect


class StopCommands:
    """A stop has priority over all other functions; it ends compensation and external setpoints too."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis

    def do_stop(self, cycle: int) -> str | None:
        """Stops on the ramp of the start. New targets wait until the axis is at a standstill (state Stopping)."""
        return self._stop("stop", cycle, locks=True)

    def do_halt(self, cycle: int) -> str | None:
        """Stops on the ramp of the start, but another motion or target acts immediately (state DiscreteMotion).

        External setpoints and a homing are stopped as by `stop`.
        """
        axis = self._axis
        external = axis.state == S.CONTINUOUS_MOTION and axis.external.mode is not None
        return self._stop("halt", cycle, locks=external or axis.state == S.HOMING)

    def _stop(self, command: str, cycle: int, *, locks: bool) -> str | None:
        axis = self._axis
        self.refuse_synchronous(command)
        cancelled = self._cancel_target(command, cycle)
        if cancelled is not None:
            return cancelled
        if axis.state not in STOPPABLE:
            return without_effect(axis.name, command, axis.state)
        axis.stop(cycle, locks=locks)
        self._stopped(locks)
        return None

    def _cancel_target(self, command: str, cycle: int) -> str | None:
        """Cancels a new target that waits for the end of a stop; the warning says so."""
        axis = self._axis
        if axis.state != S.STOPPING or not axis.ptp.drop_suspended():
            return None
        axis.drop_waiting(cycle)
        return f"axis {axis.name}: {command} cancels the waiting new target; the axis stops"

    def refuse_synchronous(self, command: str) -> None:
        """An axis that follows a channel or a master is stopped there."""
        axis = self._axis
        if axis.coupled and axis.coupling is not None:
            master = axis.coupling.master
            reason = f"the axis is a slave of {master}; stop {master} or decouple the axis"
            axis.refuse(command, SLAVE_LOCKED, reason, master=master)
        if axis.on_path:
            reason = "the channel path moves the axis; use feed_hold or reset of the channel"
            axis.refuse(command, NOT_READY, reason)

    def _stopped(self, locks: bool) -> None:
        if locks:
            self._axis.take(T.STOP)
        elif self._axis.state == S.CONTINUOUS_MOTION:
            self._axis.take(T.HALT)
        self._axis.has_been_stopped = True

    def do_emergency_stop(self, cycle: int, *, deceleration: object = None, jerk: object = None) -> str | None:
        """Stops with a deceleration (mm/s²) and a jerk (mm/s³), which are at least those of the start.

        No value keeps the axis from stopping; warning 23016 says what was corrected. The ramp of a stop or halt
        becomes at least as strong. Refusals: 23005, 23017 (natural brake phase with nothing superimposed), 23040 (a
        slave, also one that follows as a flying saw on a path).
        """
        axis, command = self._axis, "emergency_stop"
        self.refuse_synchronous(command)
        if axis.state not in STOPPABLE and axis.state != S.STOPPING:
            return without_effect(axis.name, command, axis.state)
        if self._brakes_naturally(cycle):
            axis.refuse(command, IN_BRAKE_PHASE, "the axis is in its brake phase")
        if axis.lead.active:
            return self._stop_drive(cycle, deceleration, jerk)
        ramp, warning = self._emergency_ramp(command, deceleration, jerk)
        cancelled = self._cancel_target(command, cycle)
        axis.absorb(cycle)
        axis.ptp.stop(cycle, ramp, at_least=True)
        self._stopped(locks=True)
        return joined_warnings(warning, cancelled)

    def _stop_drive(self, cycle: int, deceleration: object, jerk: object) -> str | None:
        """A drive that homes the axis has its own ramp."""
        axis = self._axis
        axis.stop(cycle)
        self._stopped(locks=True)
        if deceleration is None and jerk is None:
            return None
        ramp = "the drive stops on its own ramp (S-0-0042, S-0-0349); deceleration and jerk have no effect"
        return warning_text(EMERGENCY_CORRECTED, f"axis {axis.name}: emergency_stop: {ramp}")

    def do_set_emergency_stop(self, cycle: int, *, enabled: bool) -> None:
        """The emergency stop of the machine or of the HLI: to ErrorStop on the emergency ramp (P-AXIS-00003).

        It acts in every state and whoever moves the axis. When it is released nothing moves: the axis wants a reset.
        """
        if enabled:
            self._axis.stop_in_emergency(cycle)

    def _brakes_naturally(self, cycle: int) -> bool:
        """In the natural brake phase, with no superimposed motion and no external setpoints enabled."""
        axis = self._axis
        brakes = axis.state == S.DISCRETE_MOTION and axis.ptp.job is not None and axis.ptp.braking(cycle)
        return brakes and axis.external.mode is None and not axis.superposition_moves(cycle)

    def _emergency_ramp(self, command: str, deceleration: object, jerk: object) -> tuple[Limits, str | None]:
        """The ramp that comes nearest to the two values without being weaker than the start, and what was corrected."""
        axis = self._axis
        start = axis.own_limits if axis.ptp.job is None else axis.ptp.job.limits
        a, weak = self._at_least(start.deceleration, "deceleration", deceleration, "s²")
        j, slow = self._at_least(start.jerk, "jerk", jerk, "s³")
        most, strong = axis.checks.most_deceleration, ""
        if a > most:
            limit = f"the maximum {most} {axis.unit}/s² (P-AXIS-00008, P-AXIS-00003)"
            a, strong = most, f"deceleration {deceleration} {axis.unit}/s² is above {limit}, which is used"
        ramp, rescaled = axis.checks.rescaled_jerk(command, Limits(start.velocity, a, a, j))
        corrected = "; ".join(filter(None, (weak, strong, slow)))
        text = f"axis {axis.name}: {command}: {corrected}"
        warning = warning_text(EMERGENCY_CORRECTED, text) if corrected else None
        return ramp, joined_warnings(warning, rescaled)

    def _at_least(self, least: float, name: str, given: object, seconds: str) -> tuple[float, str]:
        """The value given, or that of the start if it is invalid or less, and the text for that."""
        value = number(given)
        if value >= least:
            return value, ""
        unit = f"{self._axis.unit}/{seconds}"
        if given is None:
            return least, f"{name} is not given; {least} {unit} of the start is used"
        if not value > 0.0:
            return least, f"{name} = {given} must be greater than 0; {least} {unit} of the start is used"
        return least, f"{name} {given} {unit} is less than {least} {unit} of the start, which is used"


def number(value: object) -> float:
    """`value` as a number, NaN if it is none (what is recorded has NaN and infinity as text)."""
    try:
        return float(value)  # type: ignore[arg-type]
    except OverflowError:
        return inf
    except (TypeError, ValueError):
        return nan
