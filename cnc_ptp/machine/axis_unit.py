"""The axis: chooses its setpoint source (PTP generator or channel path), closes the position loop, keeps its state."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, NoReturn

from cnc_ptp.axis.ptp import PtpGenerator, State
from cnc_ptp.control.drive import Drive, SimulatedDrive
from cnc_ptp.control.position_controller import PositionController
from cnc_ptp.errors import CncError
from cnc_ptp.machine.blocks import AxisBlock, AxisStateCode, Block, ChannelBlock, CycleTick, Severity, StatusBit
from cnc_ptp.machine.unit import UPSTREAM_LOST, Unit, state_name
from cnc_ptp.motion import Limits
from cnc_ptp.parameters import AxisParameters

BAD_DYNAMICS = 23003
VELOCITY_TOO_HIGH = 23004
NOT_READY = 23005
BAD_OVERRIDE = 23006
BELOW_INCREMENT = 23007
STILL_MOVING = 23008
PATH_NOT_ACCEPTED = 23009
ENABLE_REMOVED = 23010
ABOVE_REFERENCE_VELOCITY = 23011
JERK_RESCALED = 23012
ACCELERATION_TOO_HIGH = 23013
SOFT_LIMIT_NEGATIVE = 120003
SOFT_LIMIT_POSITIVE = 120002
FOLLOWING_ERROR = 0x4550

PATH_TOLERANCE = 1e-9
"""Largest distance (mm, deg) between an axis and the begin of the path that takes it over."""

S = AxisStateCode

MOVING_ALONE = (S.DISCRETE_MOTION, S.STOPPING)
"""States that end by themselves."""

Row = tuple[float | int, ...]
"""One cycle: the fields of AxisBlock after `count`."""


class AxisUnit(Unit):
    """One axis with PTP functions, position controller and drive.

    States (PLCopen): Disabled, Standstill, DiscreteMotion (PTP), SynchronizedMotion (channel path), Stopping,
    ErrorStop. Every fault ends in ErrorStop on the axis' own ramp (P-AXIS-00002 and the ramp time P-AXIS-00196), or on
    that of the motion in work where this is stronger. The position loop is closed while powered or on a ramp.
    """

    kind: ClassVar[str] = "axis"

    def __init__(self, parameters: AxisParameters, *, cycle_time: float, drive: Drive | None = None) -> None:
        """`cycle_time` in s; without `drive` the simulated one of the parameters is used."""
        super().__init__(parameters.name)
        self._parameters = parameters
        self._cycle_time = cycle_time
        self._unit = "deg" if parameters.rotary else "mm"
        self._own_limits = Limits(
            min(parameters.max_velocity, parameters.reference_velocity),
            parameters.acceleration,
            parameters.deceleration,
            parameters.jerk,
        )
        self._ptp = PtpGenerator(
            position=parameters.start_position, cycle_time=cycle_time, override_type=parameters.override_type
        )
        self._controller = PositionController(
            kv=parameters.kv,
            following_error_limit=parameters.following_error_limit,
            monitoring=parameters.following_error_monitoring,
        )
        self._drive: Drive = drive or SimulatedDrive(
            cycle_time=cycle_time,
            time_constant=parameters.drive_time_constant,
            encoder_increment=parameters.encoder_increment,
            start_position=parameters.start_position,
        )
        self._powered = parameters.powered_at_start
        self._state = S.STANDSTILL if self._powered else S.DISABLED
        self._error_id = 0
        self._has_been_stopped = False
        self._override_percent = 100.0

    # commands

    def do_power(self, cycle: int, *, on: bool) -> str | None:
        """Enables or disables the axis; a moving axis is stopped on its ramp first.

        Where the position loop was open it is closed at the actual position, so that the enable moves nothing.
        """
        if on == self._powered:
            return f"axis {self.name}: power is {'on' if on else 'off'} already"
        if on:
            self._power_on(cycle)
        else:
            self._power_off(cycle)
        return None

    def _power_on(self, cycle: int) -> None:
        if not self._loop_closed(cycle):
            self._ptp.take_over(cycle, self._drive.position, 0.0, 0.0)
        self._powered = True
        if self._state == S.DISABLED:
            self._state = S.STANDSTILL

    def _power_off(self, cycle: int) -> None:
        self._powered = False
        if self._state == S.STANDSTILL:
            self._state = S.DISABLED
        elif self._state == S.SYNCHRONIZED_MOTION:
            self._fault(cycle, ENABLE_REMOVED, "the enable was removed during path motion")
        elif self._state == S.DISCRETE_MOTION:
            self._ptp.stop(cycle, self._own_limits)
            self._state = S.STOPPING

    def do_reset(self, cycle: int) -> None:
        """Leaves ErrorStop; refused while the axis moves (23008)."""
        if self._state != S.ERROR_STOP:
            return
        if not self._ptp.finished(cycle):
            self._refuse("reset", STILL_MOVING, "the axis still moves on its error ramp; wait for standstill")
        self._error_id = 0
        self._ptp.finish()
        self._state = S.STANDSTILL if self._powered else S.DISABLED

    def do_move_absolute(self, cycle: int, *, target: float, **dynamics: float) -> str | None:
        """Starts to `target` (mm, deg). Source: TX1250 2.1. Refusals: 23003–23005, 120002, 120003."""
        return self._start("move_absolute", cycle, float(target), dynamics)

    def do_move_relative(self, cycle: int, *, distance: float, **dynamics: float) -> str | None:
        """Starts by `distance` (mm, deg) from the set position."""
        return self._start("move_relative", cycle, self._ptp.state(cycle)[0] + distance, dynamics)

    def do_stop(self, cycle: int) -> str | None:
        """Stops PTP motion on the ramp of its start. Source: TX1250 2.2."""
        if self._state == S.SYNCHRONIZED_MOTION:
            self._refuse("stop", NOT_READY, "the channel path moves the axis; use feed_hold or reset of the channel")
        if self._state != S.DISCRETE_MOTION:
            return f"axis {self.name}: stop without effect in {state_name(self._state)}"
        self._ptp.stop(cycle, self._own_limits)
        self._state = S.STOPPING
        self._has_been_stopped = True
        return None

    def do_set_override(self, cycle: int, *, percent: float) -> str | None:
        """Override of PTP motion, 0 … 100 % in steps of 0.0001 % (less is 0). Source: TX1250 2.2."""
        highest = min(100.0, self._parameters.max_override_percent)
        if not 0.0 <= percent <= highest:
            reason = f"percent = {percent} is not within 0 ... {highest:g} (P-AXIS-00109, at most 100)"
            self._refuse("set_override", BAD_OVERRIDE, reason)
        acts = self._ptp.set_override(cycle, percent / 100.0)
        self._override_percent = float(percent) if self._ptp.override else 0.0
        if acts or self._state != S.DISCRETE_MOTION:
            return None
        reason = "brake phase or level out of reach"
        return f"axis {self.name}: override {percent} % does not change the motion in work ({reason})"

    def do_upstream_lost(self, cycle: int, *, source: str) -> str | None:
        """The watchdog: `source` has sent nothing in time; without its channel only an axis on the path stops."""
        if self._state in (S.ERROR_STOP, S.DISABLED):
            return None
        if source in ("plc", "clock") or self._state == S.SYNCHRONIZED_MOTION:
            self._fault(cycle, UPSTREAM_LOST, f"no block of '{source}' came within the watchdog time")
        return None

    # one block

    def step(self, tick: CycleTick, inputs: Mapping[str, Block]) -> AxisBlock:
        """Computes one block; follows the path of the channel among `inputs` that has the axis."""
        first_cycle, count = tick
        rows = self._follow(first_cycle, self._path_setpoints(first_cycle, self._owning_channel(inputs)))
        while len(rows) < count:
            cycle, missing = first_cycle + len(rows), count - len(rows)
            rows += self._follow(cycle, self._ptp.states(cycle, missing))
        return AxisBlock(first_cycle, count, *map(list, zip(*rows, strict=True)))

    def _follow(self, first_cycle: int, setpoints: list[State]) -> list[Row]:
        """The cycles of `setpoints`; fewer when a fault puts the axis on its own ramp."""
        rows: list[Row] = []
        error_id = self._error_id
        for cycle, setpoint in enumerate(setpoints, first_cycle):
            rows.append(self._cycle(cycle, setpoint))
            if self._error_id != error_id:
                break
        return rows

    def _cycle(self, cycle: int, setpoint: State) -> Row:
        position, velocity, acceleration, jerk = setpoint
        drive = self._drive
        following_error = position - drive.position
        if self._state in MOVING_ALONE:
            self._advance_state(cycle)
        command = 0.0
        if self._loop_closed(cycle):
            if self._error_id == 0 and self._controller.exceeds_limit(following_error):
                self._following_error_fault(cycle, setpoint, following_error)
            command = self._controller.command_velocity(following_error)
        row = (
            position,
            velocity,
            acceleration,
            jerk,
            drive.position,
            drive.velocity,
            following_error,
            command,
            0.0,
            0.0,
            0.0,
            0.0,
            self._override_percent,
            self._state,
            self._status_bits(velocity, acceleration),
            self._error_id,
        )
        drive.step(command)
        return row

    def _loop_closed(self, cycle: int) -> bool:
        """The position controller acts: the axis is powered, or on a ramp after the enable was removed."""
        return self._powered or not self._ptp.finished(cycle)

    def _advance_state(self, cycle: int) -> None:
        """Ends a motion whose table is through."""
        if self._state == S.DISCRETE_MOTION and self._ptp.arrived(cycle):
            self._ptp.finish()
            self._state = S.STANDSTILL
        elif self._state == S.STOPPING and self._ptp.finished(cycle):
            self._ptp.finish()
            self._state = S.STANDSTILL if self._powered else S.DISABLED

    def _status_bits(self, velocity: float, acceleration: float) -> int:
        bits = 0
        if self._ptp.job is not None:
            bits |= StatusBit.HAS_JOB
        if self._has_been_stopped:
            bits |= StatusBit.HAS_BEEN_STOPPED
        if velocity != 0.0 and acceleration == 0.0:
            bits |= StatusBit.CONSTANT_VELOCITY
        if self._error_id:
            bits |= StatusBit.ERROR
        return bits

    # path of the channel

    def _owning_channel(self, inputs: Mapping[str, Block]) -> ChannelBlock | None:
        for block in inputs.values():
            if isinstance(block, ChannelBlock) and block.path_active and self.name in block.axes:
                return block
        return None

    def _path_setpoints(self, first_cycle: int, channel: ChannelBlock | None) -> list[State]:
        """The setpoints of the channel that moves the axis, none if no one does; switches the setpoint source."""
        if channel is None:
            self._leave_path(first_cycle)
            return []
        start = channel.axes.index(self.name) * channel.count
        part = slice(start, start + channel.count)
        setpoints = list(
            zip(
                channel.set_position[part],
                channel.set_velocity[part],
                channel.set_acceleration[part],
                channel.set_jerk[part],
                strict=True,
            )
        )
        self._enter_path(first_cycle, setpoints[0][0])
        if self._state != S.SYNCHRONIZED_MOTION:
            return []
        self._ptp.take_over(first_cycle + channel.count - 1, *setpoints[-1][:3])
        return setpoints

    def _enter_path(self, cycle: int, begin: float) -> None:
        """The channel moves the axis from now on; a fault unless it stands at `begin`, the path's first setpoint."""
        if self._state in (S.SYNCHRONIZED_MOTION, S.ERROR_STOP):
            return
        position = self._ptp.state(cycle)[0]
        if self._state != S.STANDSTILL:
            reason = f"the channel moves the path while the axis is in {state_name(self._state)}"
            self._fault(cycle, PATH_NOT_ACCEPTED, reason)
        elif abs(begin - position) > PATH_TOLERANCE:
            reason = (
                f"the path of the channel begins at {begin} {self._unit}, the axis stands at {position} {self._unit}"
            )
            self._fault(cycle, PATH_NOT_ACCEPTED, reason)
        else:
            self._state = S.SYNCHRONIZED_MOTION

    def _leave_path(self, cycle: int) -> None:
        if self._state != S.SYNCHRONIZED_MOTION:
            return
        self._state = S.STANDSTILL
        if self._ptp.state(cycle)[1] != 0.0:
            self._fault(cycle, PATH_NOT_ACCEPTED, "the channel let the axis go while it moved")

    # starts, stops and faults

    def _start(self, command: str, cycle: int, target: float, dynamics: dict[str, float]) -> str | None:
        if self._state != S.STANDSTILL:
            self._refuse(command, NOT_READY, f"the axis is in {state_name(self._state)}, it must be in Standstill")
        limits = self._start_limits(command, dynamics)
        limits, warning = self._rescale_jerk(command, limits)
        self._check_soft_limits(command, target)
        distance = abs(target - self._ptp.state(cycle)[0])
        if distance < self._parameters.encoder_increment or distance == 0.0:
            self._has_been_stopped = False
            return (
                f"P-WARN-{BELOW_INCREMENT} axis {self.name}: {command} over {distance:g} {self._unit} is below one "
                f"encoder increment ({self._parameters.encoder_increment} {self._unit}); the axis does not move"
            )
        self._ptp.start(cycle, target, limits)
        self._has_been_stopped = False
        self._state = S.DISCRETE_MOTION
        return warning

    def _start_limits(self, command: str, dynamics: dict[str, float]) -> Limits:
        for name, value in dynamics.items():
            if not value > 0.0:
                self._refuse(command, BAD_DYNAMICS, f"{name} = {value} must be greater than 0")
        limits = self._own_limits._replace(**{name: float(value) for name, value in dynamics.items()})
        highest, reference = self._parameters.max_velocity, self._parameters.reference_velocity
        unit = f"{self._unit}/s"
        if limits.velocity > highest:
            reason = f"velocity {limits.velocity} {unit} is above the maximum {highest} {unit} (P-AXIS-00212)"
            self._refuse(command, VELOCITY_TOO_HIGH, reason)
        if limits.velocity > reference:
            reason = (
                f"velocity {limits.velocity} {unit} is above the reference velocity {reference} {unit} (P-MACH-00008)"
            )
            self._refuse(command, ABOVE_REFERENCE_VELOCITY, reason)
        most = self._parameters.max_acceleration
        for name, value in (("acceleration", limits.acceleration), ("deceleration", limits.deceleration)):
            if value > most:
                reason = f"{name} {value} {unit}² is above the maximum {most} {unit}² (P-AXIS-00008)"
                self._refuse(command, ACCELERATION_TOO_HIGH, reason)
        return limits

    def _rescale_jerk(self, command: str, limits: Limits) -> tuple[Limits, str | None]:
        """A jerk that brings an acceleration up within less than a cycle is reduced to A/T (TX1250 2.1)."""
        highest = min(limits.acceleration, limits.deceleration) / self._cycle_time
        if limits.jerk <= highest:
            return limits, None
        warning = (
            f"P-WARN-{JERK_RESCALED} axis {self.name}: {command}: jerk {limits.jerk} {self._unit}/s³ is above A/T, "
            f"the acceleration over one cycle; {highest} {self._unit}/s³ is used"
        )
        return limits._replace(jerk=highest), warning

    def _check_soft_limits(self, command: str, target: float) -> None:
        low, high = self._parameters.soft_limit_negative, self._parameters.soft_limit_positive
        if target > high:
            text = (
                f"target {target} {self._unit} lies beyond the positive soft limit {high} {self._unit} (P-AXIS-00178)"
            )
            self._refuse(command, SOFT_LIMIT_POSITIVE, text)
        if target < low:
            text = f"target {target} {self._unit} lies beyond the negative soft limit {low} {self._unit} (P-AXIS-00177)"
            self._refuse(command, SOFT_LIMIT_NEGATIVE, text)

    def _refuse(self, command: str, error_id: int, reason: str) -> NoReturn:
        raise CncError(error_id, f"axis {self.name}: {command} refused: {reason}; nothing was changed")

    def _fault(self, cycle: int, error_id: int, reason: str) -> None:
        """Error reaction: own ramp from the setpoint of `cycle`, state ErrorStop."""
        self._error_id = error_id
        self._ptp.stop(cycle, self._own_limits, at_least=True)
        self._state = S.ERROR_STOP
        self.event(
            cycle, Severity.ERROR, error_id, f"axis {self.name}: {reason}; the axis stops on its own ramp (ErrorStop)"
        )

    def _following_error_fault(self, cycle: int, setpoint: State, following_error: float) -> None:
        if self._state == S.SYNCHRONIZED_MOTION:
            self._ptp.take_over(cycle, *setpoint[:3])
        limit = self._parameters.following_error_limit
        self._fault(
            cycle,
            FOLLOWING_ERROR,
            f"following error {following_error:.4f} {self._unit} exceeds {limit} {self._unit} (P-AXIS-00168)",
        )
