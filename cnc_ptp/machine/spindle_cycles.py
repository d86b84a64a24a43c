"""The cycles of a spindle's block: setpoint, actual values, monitoring, command to the drive."""

from __future__ import annotations

from typing import Any

from cnc_ptp.axis.states import AxisStateCode as S
from cnc_ptp.spindle.faults import FOLLOWING_ERROR, SPEED_NOT_REACHED
from cnc_ptp.spindle.orders import Orders
from cnc_ptp.spindle.rotation_commands import RotationCommands
from cnc_ptp.spindle.spindle import DEG_S_PER_RPM, Spindle
from cnc_ptp.spindle.states import SpindleBit

SETTLED = (S.STANDSTILL, S.CONTINUOUS_MOTION, S.DISABLED, S.ERROR_STOP)
"""States that do not end by themselves."""
FIELDS = 21
Columns = list[Any]
"""The fields of SpindleBlock with a value per cycle, in their order."""


class SpindleCycles:
    """Computes the cycles of one spindle; blocks in which nothing can happen take a shorter way."""

    def __init__(self, spindle: Spindle, orders: Orders, rotation: RotationCommands) -> None:
        self._spindle = spindle
        self._orders = orders
        self._rotation = rotation

    def block(self, first_cycle: int, count: int) -> Columns:
        """All columns of a block."""
        spindle = self._spindle
        if not spindle.unsettled:
            columns = self._steady_cycles(first_cycle, count)
            done = len(columns[0])
            if done == count:
                return columns
        else:
            columns, done = [[] for _ in range(FIELDS)], 0
        rows = [self._cycle(cycle) for cycle in range(first_cycle + done, first_cycle + count)]
        for column, values in zip(columns, zip(*rows, strict=True), strict=True):
            column += values
        return columns

    # any cycle

    def _cycle(self, cycle: int) -> tuple[Any, ...]:
        spindle = self._spindle
        loop = spindle.loop
        spindle.watch_loop(cycle, spindle.motion(cycle)[1])
        position, speed, acceleration = spindle.motion(cycle)
        actual_speed = loop.actual_speed(speed)
        if spindle.jobs.job is not None:
            spindle.jobs.advance(cycle, actual_speed)
            position, speed, acceleration = spindle.motion(cycle)
        elif speed == 0.0 and spindle.state == S.STOPPING:
            spindle.state = S.STANDSTILL
        actual = loop.actual_position(position, speed)
        following_error = position - actual
        self._watch_following_error(cycle, following_error)
        reached = self._speed_reached(actual_speed)
        self._watch_speed(cycle, reached)
        target = position if spindle.target is None else spindle.target
        loop.command(following_error, speed, acceleration, on=spindle.state != S.DISABLED)
        self._orders.watch()
        self._note_settled(cycle)
        return (
            speed / DEG_S_PER_RPM,
            actual_speed / DEG_S_PER_RPM,
            spindle.programmed_speed / DEG_S_PER_RPM,
            acceleration,
            position,
            actual,
            target,
            target - position,
            following_error,
            spindle.override_percent,
            loop.drive_output,
            spindle.mode,
            spindle.gear.stage,
            reached,
            abs(actual_speed) <= spindle.gear.zero_speed,
            self._in_position(actual),
            spindle.referenced,
            spindle.jobs.changes_gear,
            self._bits(),
            spindle.state,
            spindle.error_id,
        )

    def _watch_following_error(self, cycle: int, following_error: float) -> None:
        spindle = self._spindle
        gear = spindle.gear
        if not gear.following_error_monitoring or spindle.error_id or not spindle.loop.closed:
            return
        if abs(following_error) > gear.following_error_limit and spindle.state != S.DISABLED:
            limit = gear.following_error_limit
            reason = f"following error {following_error:.3f} deg exceeds {limit} deg (P-AXIS-00168)"
            spindle.fault(cycle, FOLLOWING_ERROR, reason)

    def _speed_reached(self, actual_speed: float) -> bool:
        """P-AXIS-00217: within the tolerance band around the wanted speed; for speed 0 the zero limit P-AXIS-00216.

        A spindle that override 0 holds has not reached its speed.
        """
        spindle = self._spindle
        wanted = spindle.wanted_speed
        if wanted == 0.0:
            held = spindle.state == S.CONTINUOUS_MOTION and spindle.programmed_speed != 0.0
            return not held and abs(actual_speed) <= spindle.gear.zero_speed
        return abs(actual_speed - wanted) <= spindle.parameters.speed_reached_band * abs(wanted)

    def _watch_speed(self, cycle: int, reached: bool) -> None:
        """Time monitoring: an error when the speed does not come (P-MACH-00050)."""
        spindle = self._spindle
        if spindle.state != S.CONTINUOUS_MOTION or spindle.speed_was_reached:
            return
        spindle.speed_was_reached = reached
        patience = spindle.parameters.speed_time / spindle.cycle_time
        held = spindle.wanted_speed == 0.0 and spindle.programmed_speed != 0.0
        if reached or held or not patience or spindle.cycles_since_end(cycle) < patience:
            return
        wanted = spindle.wanted_speed / DEG_S_PER_RPM
        reason = (
            f"speed {wanted:g} rpm was not reached {spindle.parameters.speed_time:g} s after the setpoint got there"
        )
        spindle.fault(cycle, SPEED_NOT_REACHED, f"{reason} (P-AXIS-00217, P-MACH-00050)")

    def _in_position(self, actual: float) -> bool:
        spindle = self._spindle
        if not spindle.jobs.done or spindle.target is None or spindle.state != S.STANDSTILL:
            return False
        return abs(spindle.target - actual) <= spindle.gear.position_window

    def _bits(self) -> int:
        spindle = self._spindle
        loop = spindle.loop
        bits = SpindleBit.POSITION_CONTROL if loop.closed and spindle.state != S.DISABLED else 0
        if spindle.state == S.CONTINUOUS_MOTION:
            bits |= SpindleBit.MONITORING_ACTIVE
        for on, bit in (
            (loop.velocity_control, SpindleBit.VELOCITY_CONTROL),
            (not loop.measures_speed, SpindleBit.MONITORING_INVALID),
            (spindle.override_suppressed, SpindleBit.OVERRIDE_SUPPRESSED),
            (self._rotation.stops_at_program_end, SpindleBit.STOP_AT_PROGRAM_END),
            (not spindle.tool.none, SpindleBit.TOOL_LIMITS),
            (spindle.job_error, SpindleBit.JOB_ERROR),
        ):
            if on:
                bits |= bit
        return int(bits)

    def _note_settled(self, cycle: int) -> None:
        """Whether only commands and the following error can change anything from the next cycle on."""
        spindle = self._spindle
        spindle.unsettled = not (
            spindle.state in SETTLED
            and spindle.jobs.job is None
            and spindle.finished(cycle)
            and (spindle.state != S.CONTINUOUS_MOTION or spindle.speed_was_reached)
            and not self._orders.source
            and not self._orders.waiting
            and not spindle.loop.waits_to_close(spindle.motion(cycle)[1], spindle.wanted_speed)
        )

    # cycles in which the spindle does nothing but go on

    def _steady_cycles(self, first_cycle: int, count: int) -> Columns:
        """The same as `_cycle` for settled cycles; up to a following error too large."""
        spindle = self._spindle
        loop, gear, state = spindle.loop, spindle.gear, spindle.state
        speed = spindle.motion(first_cycle)[1]
        watched = gear.following_error_monitoring and not spindle.error_id and loop.closed and state != S.DISABLED
        limit = gear.following_error_limit
        on = state != S.DISABLED
        positions, actuals, speeds, errors, outputs = [], [], [], [], []
        for cycle in range(first_cycle, first_cycle + count):
            position = spindle.motion(cycle)[0]
            actual = loop.actual_position(position, speed)
            error = position - actual
            if watched and not -limit <= error <= limit:
                break
            speeds.append(loop.actual_speed(speed))
            positions.append(position)
            actuals.append(actual)
            errors.append(error)
            loop.command(error, speed, 0.0, on=on)
            outputs.append(loop.drive_output)
        n = len(positions)
        target = spindle.target
        targets = positions if target is None else [target] * n
        zero = gear.zero_speed
        return [
            [speed / DEG_S_PER_RPM] * n,
            [actual / DEG_S_PER_RPM for actual in speeds],
            [spindle.programmed_speed / DEG_S_PER_RPM] * n,
            [0.0] * n,
            positions,
            actuals,
            list(targets),
            [target - position for target, position in zip(targets, positions, strict=True)],
            errors,
            [spindle.override_percent] * n,
            outputs,
            [spindle.mode] * n,
            [gear.stage] * n,
            [self._speed_reached(actual) for actual in speeds],
            [abs(actual) <= zero for actual in speeds],
            [self._in_position(actual) for actual in actuals],
            [spindle.referenced] * n,
            [False] * n,
            [self._bits()] * n,
            [state] * n,
            [spindle.error_id] * n,
        ]
