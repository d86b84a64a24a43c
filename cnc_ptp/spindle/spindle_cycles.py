"""The cycles of a spindle's block: setpoint, actual values, monitoring, command to the drive."""

from __future__ import annotations

from math import inf

from cnc_ptp.control.faults import FOLLOWING_ERROR
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import SpindleBlock
from cnc_ptp.protocol.spindle_states import SpindleBit
from cnc_ptp.spindle import transitions as T
from cnc_ptp.spindle.command_queue import CommandQueue
from cnc_ptp.spindle.faults import SPEED_NOT_REACHED
from cnc_ptp.spindle.procedures import Procedures
from cnc_ptp.spindle.rotation_commands import RotationCommands
from cnc_ptp.spindle.spindle import Spindle

SETTLED = (S.STANDSTILL, S.CONTINUOUS_MOTION, S.DISABLED, S.ERROR_STOP)
"""States that do not end without a command."""
(
    POSITION_CONTROL,
    VELOCITY_CONTROL,
    MONITORING_ACTIVE,
    MONITORING_INVALID,
    OVERRIDE_SUPPRESSED,
    STOP_AT_PROGRAM_END,
    TOOL_LIMITS,
    JOB_ERROR,
    ORDERS_WAIT,
    ON_PATH,
    FEED_HOLD,
) = map(int, SpindleBit)
"""As plain numbers: operations on members of an IntEnum take microseconds."""


class SpindleCycles:
    """Computes the cycles of one spindle; blocks in which nothing can happen are computed faster."""

    def __init__(
        self, spindle: Spindle, procedures: Procedures, queue: CommandQueue, rotation: RotationCommands
    ) -> None:
        self._spindle = spindle
        self._procedures = procedures
        self._queue = queue
        self._rotation = rotation
        self._patience = spindle.parameters.speed_time / spindle.cycle_time
        """P-MACH-00050 in cycles, 0: no monitoring."""
        self._position_patience = spindle.parameters.target_time / spindle.cycle_time
        """P-MACH-00014 in cycles, 0: no monitoring."""

    def block(self, first_cycle: int, count: int) -> SpindleBlock:
        """A block with all values per cycle."""
        long = not any(0.0 < patience < count for patience in (self._patience, self._position_patience))
        if long and self._undisturbed(first_cycle, first_cycle + count - 1):
            block = self._undisturbed_cycles(first_cycle, count)
        else:
            block = SpindleBlock(first_cycle, count)
        for cycle in range(first_cycle + len(block.state), first_cycle + count):
            self._cycle(cycle, block)
        return block

    # any cycle

    def _cycle(self, cycle: int, block: SpindleBlock) -> None:
        """Adds one cycle, in which anything can happen."""
        spindle = self._spindle
        loop = spindle.loop
        spindle.watch_loop(cycle, spindle.motion(cycle)[1])
        position, speed, acceleration = spindle.motion(cycle)
        actual_speed = loop.actual_speed(speed)
        if spindle.work.procedure is not None:
            self._procedures.advance(cycle, actual_speed)
            position, speed, acceleration = spindle.motion(cycle)
        elif speed == 0.0 and spindle.state == S.STOPPING:
            spindle.take(T.FINISH)
        if speed == 0.0 and spindle.state == S.STANDSTILL:
            acceleration = 0.0  # its ramp may end by a rounding error later
        actual = loop.actual_position(position, speed)
        setpoint = position, speed, acceleration, spindle.jerk(cycle)
        self._watch_following_error(cycle, setpoint)
        travel = spindle.travel
        reached = self._speed_reached(actual_speed if travel is None else actual_speed - travel.at(cycle)[1])
        self._watch_speed(cycle, reached)
        self._procedures.hold(cycle, actual, actual_speed)
        target = position if spindle.target is None else spindle.target
        loop.command(setpoint, on=spindle.state != S.DISABLED)
        self._queue.watch()
        self._note_settled(cycle)
        block.set_speed_rpm.append(speed / DEG_S_PER_RPM)
        block.actual_speed_rpm.append(actual_speed / DEG_S_PER_RPM)
        block.programmed_speed_rpm.append(spindle.programmed_speed / DEG_S_PER_RPM)
        block.set_acceleration_deg_s2.append(acceleration)
        block.set_position_deg.append(position)
        block.actual_position_deg.append(actual)
        block.target_position_deg.append(target)
        block.distance_to_go_deg.append(target - position)
        block.following_error_deg.append(position - actual)
        block.override_percent.append(spindle.override_percent)
        block.feedforward_percent.append(loop.feedforward_percent)
        block.drive_output.append(loop.drive_output)
        block.mode.append(spindle.mode)
        block.gear.append(spindle.gear.stage)
        block.speed_reached.append(reached)
        block.speed_zero.append(abs(actual_speed) <= spindle.gear.zero_speed)
        block.in_position.append(spindle.holds_position and spindle.exact_stop.reached)
        block.referenced.append(spindle.referenced)
        block.gear_change_active.append(spindle.work.changes_gear)
        block.status_bits.append(self._bits())
        block.state.append(spindle.state)
        block.error_id.append(spindle.error_id)

    def _watch_following_error(self, cycle: int, setpoint: MotionState) -> None:
        spindle, control = self._spindle, self._spindle.loop.control
        if self._watched() and control.too_far(setpoint):
            spindle.fault(cycle, FOLLOWING_ERROR, control.why_too_far(setpoint, "deg"), control.lag_values(setpoint))

    def _watched(self) -> bool:
        spindle = self._spindle
        return not spindle.error_id and spindle.loop.watches(on=spindle.state != S.DISABLED)

    def _speed_reached(self, actual_speed: float) -> bool:
        """P-AXIS-00217: within the tolerance band around the commanded speed; for speed 0 the zero limit P-AXIS-00216.

        A spindle that override 0 holds has not reached its speed.
        """
        spindle = self._spindle
        wanted = spindle.wanted_speed
        if wanted == 0.0:
            held = spindle.state == S.CONTINUOUS_MOTION and spindle.programmed_speed != 0.0
            return not held and abs(actual_speed) <= spindle.gear.zero_speed
        return abs(actual_speed - wanted) <= spindle.parameters.speed_reached_band * abs(wanted)

    @property
    def _awaits_speed(self) -> bool:
        """The speed of the rotation, or 0 after a stop, is monitored."""
        spindle = self._spindle
        return not spindle.speed_was_reached and spindle.state in (S.CONTINUOUS_MOTION, S.STANDSTILL)

    def _watch_speed(self, cycle: int, reached: bool) -> None:
        """Time monitoring: an error when the speed is not reached, or not reached again (P-MACH-00050)."""
        spindle = self._spindle
        spindle.note_speed(cycle, reached)
        if not self._awaits_speed:
            return
        patience = self._patience
        held = spindle.wanted_speed == 0.0 and spindle.programmed_speed != 0.0
        if held or not patience or spindle.cycles_without_speed(cycle) < patience:
            return
        wanted = spindle.wanted_speed / DEG_S_PER_RPM
        seconds = spindle.parameters.speed_time
        missing = f"was not reached {seconds:g} s after the setpoint"
        if spindle.speed_lost_at > -inf:
            missing = f"was lost and has not come back for {seconds:g} s"
        limit = ids.KENNGR_VB_PROZENT if wanted else ids.GETRIEBE_VB_MIN_NULL
        reason = f"speed {wanted:g} rpm {missing} ({limit}, P-MACH-00050)"
        spindle.fault(cycle, SPEED_NOT_REACHED, reason, {"expected_speed": wanted, "patience": seconds})

    def _bits(self) -> int:
        spindle = self._spindle
        loop = spindle.loop
        bits = POSITION_CONTROL if loop.closed and spindle.state != S.DISABLED else 0
        if spindle.state == S.CONTINUOUS_MOTION:
            bits |= MONITORING_ACTIVE
        if loop.velocity_control:
            bits |= VELOCITY_CONTROL
        if not loop.measures_speed:
            bits |= MONITORING_INVALID
        if spindle.override_suppressed:
            bits |= OVERRIDE_SUPPRESSED
        if self._rotation.stops_at_program_end:
            bits |= STOP_AT_PROGRAM_END
        if spindle.has_tool_limits:
            bits |= TOOL_LIMITS
        if spindle.job_error:
            bits |= JOB_ERROR
        if self._queue.waiting:
            bits |= ORDERS_WAIT
        if spindle.travel is not None:
            bits |= ON_PATH
        if spindle.feed_held:
            bits |= FEED_HOLD
        return bits

    def _note_settled(self, cycle: int) -> None:
        """True if only commands and the following error can change anything from the next cycle on."""
        spindle = self._spindle
        spindle.unsettled = not (
            spindle.state in SETTLED
            and spindle.work.procedure is None
            and spindle.finished(cycle)
            and not self._awaits_speed
            and (spindle.exact_stop.reached or not spindle.holds_position)
            and not self._queue.source
            and not self._queue.waiting
            and not spindle.loop.waits_to_close(spindle.motion(cycle)[1], spindle.wanted_speed)
        )

    # cycles in which the spindle only continues

    def _undisturbed(self, first_cycle: int, last_cycle: int) -> bool:
        """True when only the following error can change state, mode or loop in these cycles."""
        spindle = self._spindle
        if spindle.travel is not None:
            return False
        if not spindle.unsettled:
            return True
        if spindle.work.procedure is not None or self._queue.waiting:
            return False
        if spindle.state not in SETTLED and (spindle.state != S.STOPPING or self._stands(last_cycle)):
            return False
        if self._patience_ends(last_cycle):
            return False
        limit = spindle.loop.undisturbed_speed
        return limit == inf or all(abs(spindle.motion(cycle)[1]) <= limit for cycle in (first_cycle, last_cycle))

    def _stands(self, cycle: int) -> bool:
        """The ramp has come to its end, or by a rounding error nearly so."""
        return self._spindle.finished(cycle) or self._spindle.motion(cycle)[1] == 0.0

    def _patience_ends(self, last_cycle: int) -> bool:
        """The time for a missing speed (P-MACH-00050) or position (P-MACH-00014) ends by `last_cycle`."""
        spindle = self._spindle
        late = bool(self._patience) and spindle.cycles_without_speed(last_cycle) >= self._patience
        away_for = last_cycle - spindle.exact_stop.left_at
        lost = 0.0 < self._position_patience <= away_for and spindle.holds_position
        return (late and self._awaits_speed) or lost

    def _undisturbed_cycles(self, first_cycle: int, count: int) -> SpindleBlock:
        """A block of such cycles, the same as `_cycle` makes; up to an excessive following error."""
        spindle = self._spindle
        gear, state = spindle.gear, spindle.state
        motions = spindle.motions(first_cycle, count)
        actuals, actual_speeds, errors, outputs, percents = spindle.loop.cycles(
            motions, on=state != S.DISABLED, watched=self._watched()
        )
        n = len(actuals)
        positions, speeds = motions.positions[:n], motions.velocities[:n]
        target = spindle.target
        reached = self._speeds_reached(actual_speeds)
        block = SpindleBlock(
            first_cycle,
            count,
            set_speed_rpm=[speed / DEG_S_PER_RPM for speed in speeds],
            actual_speed_rpm=[speed / DEG_S_PER_RPM for speed in actual_speeds],
            programmed_speed_rpm=[spindle.programmed_speed / DEG_S_PER_RPM] * n,
            set_acceleration_deg_s2=motions.accelerations[:n],
            set_position_deg=positions,
            actual_position_deg=actuals,
            target_position_deg=[*positions] if target is None else [target] * n,
            distance_to_go_deg=[0.0] * n if target is None else [target - position for position in positions],
            following_error_deg=errors,
            override_percent=[spindle.override_percent] * n,
            feedforward_percent=percents,
            drive_output=outputs,
            mode=[spindle.mode] * n,
            gear=[gear.stage] * n,
            speed_reached=reached,
            speed_zero=[abs(speed) <= gear.zero_speed for speed in actual_speeds],
            in_position=self._positions_reached(first_cycle, actuals, actual_speeds),
            referenced=[spindle.referenced] * n,
            gear_change_active=[False] * n,
            status_bits=[self._bits()] * n,
            state=[state] * n,
            error_id=[spindle.error_id] * n,
        )
        if not all(reached) or not spindle.speed_was_reached:
            for cycle, there in enumerate(reached, first_cycle):
                spindle.note_speed(cycle, there)
        if spindle.unsettled and n:
            self._settle(first_cycle + n - 1)
        return block

    def _speeds_reached(self, actual_speeds: list[float]) -> list[bool]:
        """`_speed_reached` of many cycles with the same commanded speed."""
        wanted = self._spindle.wanted_speed
        if wanted == 0.0:
            return [self._speed_reached(speed) for speed in actual_speeds]
        band = self._spindle.parameters.speed_reached_band * abs(wanted)
        return [abs(speed - wanted) <= band for speed in actual_speeds]

    def _positions_reached(self, first_cycle: int, actuals: list[float], actual_speeds: list[float]) -> list[bool]:
        """Exact stop after a positioning, cycle by cycle; a position that is left is monitored."""
        spindle, target = self._spindle, self._spindle.target
        if target is None or not spindle.holds_position:
            return [False] * len(actuals)
        motion = zip(actuals, actual_speeds, strict=True)
        reached = [
            spindle.note_position(cycle, target - actual, speed)
            for cycle, (actual, speed) in enumerate(motion, first_cycle)
        ]
        spindle.unsettled |= not all(reached)
        return reached

    def _settle(self, last_cycle: int) -> None:
        self._queue.watch()
        self._note_settled(last_cycle)
