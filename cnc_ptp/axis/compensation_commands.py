"""Start and stop of a position compensation. Source: TX1250 2.5."""

from __future__ import annotations

from math import copysign, inf, isfinite

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.compensation import plan_compensation
from cnc_ptp.axis.faults import (
    BAD_COMPENSATION,
    COMPENSATION_CUT,
    COMPENSATION_IN_STOP,
    COMPENSATION_LOCKED,
    NOTHING_TO_COMPENSATE,
    SUPERIMPOSED_RUNS,
    VELOCITY_TOO_HIGH,
    VIRTUAL_AXIS,
)
from cnc_ptp.axis.job import Job
from cnc_ptp.axis.motions import refuse_beside_trajectory
from cnc_ptp.errors import warning_text
from cnc_ptp.motion import Profile
from cnc_ptp.motion.limits import LARGEST_LIMIT, SMALLEST_LIMIT
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

START = "compensation_start"


class CompensationCommands:
    """`compensation_start` and `compensation_stop`."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis

    def do_compensation_start(
        self,
        cycle: int,
        *,
        length: float,
        difference: float,
        process_velocity: float,
        velocity_increase: float,
        acceleration: float | None = None,
        deceleration: float | None = None,
    ) -> str | None:
        """Compensates `difference` D over `length` L; AK+ and AK- that are left out come from the axis.

        Refusals: 23004, 23013, 23018 – 23022, 120002, 120003. If L is longer than the distance to go, that is used; if
        D cannot be reached, as much of it as possible is compensated, and the answer says so.
        """
        axis = self._axis
        axis.setpoint(cycle)  # a compensation may end in this cycle
        self._check_state(cycle)
        rise = axis.parameters.acceleration if acceleration is None else acceleration
        fall = axis.parameters.deceleration if deceleration is None else deceleration
        self._check_values(
            difference,
            length=length,
            process_velocity=process_velocity,
            velocity_increase=velocity_increase,
            acceleration=rise,
            deceleration=fall,
        )
        base, job = self._basic_motion(cycle)
        remaining = job.target - base[0]
        used = min(length, abs(remaining))
        table = plan_compensation(used, difference, process_velocity, velocity_increase, rise, fall)
        direction = copysign(1.0, base[1] or remaining)
        self._check_velocity(max(axis.ptp.highest_velocity(cycle), job.reduced_velocity), table)
        if isfinite(job.target):
            axis.checks.soft_limits(START, job.target + axis.shift(cycle) + direction * table.end[0])
        axis.superposed = True
        axis.compensation.start(cycle, base, direction=direction, process_velocity=process_velocity, profile=table)
        return self._cut_warning(difference, length, table.end[0], used)

    def _check_state(self, cycle: int) -> None:
        axis = self._axis
        if axis.parameters.virtual:
            axis.refuse(START, VIRTUAL_AXIS, "a virtual axis cannot compensate (P-AXIS-00020)")
        refuse_beside_trajectory(axis, START)
        if axis.compensation.active:
            axis.refuse(START, COMPENSATION_LOCKED, "a position compensation is active; it cannot be started again")
        if axis.added.moving(cycle):
            axis.refuse(START, SUPERIMPOSED_RUNS, "a superimposed motion is active")
        if axis.coupled and not axis.on_path:
            return
        moves = axis.state in (S.DISCRETE_MOTION, S.STOPPING) or (axis.ptp.job is not None and not axis.ptp.stands)
        if not moves or axis.state == S.HOMING:
            state = state_name(axis.state)
            reason = f"no basic motion is active (the axis is in {state})"
            axis.refuse(START, NOTHING_TO_COMPENSATE, reason, state=state)
        if axis.ptp.braking(cycle):
            axis.refuse(START, COMPENSATION_IN_STOP, "the axis is stopping or in its brake phase")

    def _basic_motion(self, cycle: int) -> tuple[MotionState, Job]:
        """State and job of the basic motion; refused while it stops beyond its target in order to return.

        The basic motion of a slave has no target of its own; it must move, so that there is a direction.
        """
        axis = self._axis
        base, job = axis.ptp.state(cycle), axis.ptp.job
        if job is None:
            if base[1] == 0.0:
                axis.refuse(START, NOTHING_TO_COMPENSATE, "the basic motion of the slave is at a standstill")
            velocity = axis.target_velocity()
            return base, Job(copysign(inf, base[1]), axis.own_limits._replace(velocity=velocity), velocity)
        if base[1] != 0.0 and axis.ptp.passes_by(cycle, job) > 0.0:
            axis.refuse(START, COMPENSATION_IN_STOP, "the axis stops in order to return to its target")
        return base, job

    def _check_values(self, difference: float, **positive: float) -> None:
        for name, value in positive.items():
            if not value > 0.0:
                reason = f"{name} = {value} must be greater than 0"
                self._axis.refuse(START, BAD_COMPENSATION, reason, argument=name, value=value)
            if not SMALLEST_LIMIT <= value <= LARGEST_LIMIT:
                low, high = SMALLEST_LIMIT, LARGEST_LIMIT
                reason = f"{name} = {value} must be between {low:g} and {high:g}"
                self._axis.refuse(START, BAD_COMPENSATION, reason, argument=name, value=value, low=low, high=high)
        if difference == 0.0:
            reason = "difference = 0 must be different from 0"
            self._axis.refuse(START, BAD_COMPENSATION, reason, argument="difference", value=difference)
        for name in ("acceleration", "deceleration"):
            self._axis.checks.acceleration(START, name, positive[name])

    def _check_velocity(self, velocity: float, table: Profile) -> None:
        """The axis must keep its velocity limit, also backwards: there the peak counts, over a basic motion at rest."""
        axis = self._axis
        forwards = velocity + max(row[2] for row in table.rows)
        peak = max(forwards, max(-row[2] for row in table.rows))
        highest = axis.parameters.max_velocity
        unit = f"{axis.unit}/s"
        if peak > highest:
            reason = f"the axis would get up to {peak:g} {unit}, above the maximum {highest} {unit} (P-AXIS-00212)"
            axis.refuse(START, VELOCITY_TOO_HIGH, reason, velocity=peak, limit=highest)

    def _cut_warning(self, difference: float, length: float, reached: float, used: float) -> str | None:
        axis, unit = self._axis, self._axis.unit
        cuts = []
        if used < length:
            cuts.append(f"length {length:g} {unit} is more than the distance to go; {used:g} {unit} is used")
        if reached != difference:
            cuts.append(
                f"difference {difference:g} {unit} cannot be reached over {used:g} {unit}; {reached:g} {unit} is used"
            )
        return warning_text(COMPENSATION_CUT, f"axis {axis.name}: {START}: {'; '.join(cuts)}") if cuts else None

    def do_compensation_stop(self, cycle: int) -> str | None:
        """Ramps the compensation down; D becomes what has been compensated by then. No effect in its last ramp."""
        axis = self._axis
        if not axis.compensation.active:
            return f"axis {axis.name}: compensation_stop without effect: no compensation is active"
        axis.setpoint(cycle)  # brings the compensation up to this cycle
        if not axis.compensation.stop():
            return f"axis {axis.name}: compensation_stop without effect: the compensation is in its brake phase"
        return None
