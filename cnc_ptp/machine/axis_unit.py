"""The axis: chooses its setpoint source (PTP generator or channel path), closes the position loop, keeps its state."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.compensation_commands import CompensationCommands
from cnc_ptp.axis.external_commands import ExternalCommands
from cnc_ptp.axis.faults import FOLLOWING_ERROR, PATH_NOT_ACCEPTED
from cnc_ptp.axis.power_commands import PowerCommands
from cnc_ptp.axis.ptp import State
from cnc_ptp.axis.ptp_commands import PtpCommands
from cnc_ptp.axis.states import AxisStateCode as S
from cnc_ptp.axis.states import state_name
from cnc_ptp.axis.stop_commands import StopCommands
from cnc_ptp.control.drive import Drive, SimulatedDrive
from cnc_ptp.control.position_controller import PositionController
from cnc_ptp.machine.blocks import AxisBlock, Block, ChannelBlock, CycleTick, Severity
from cnc_ptp.machine.unit import UPSTREAM_LOST, Handler, Unit
from cnc_ptp.parameters import AxisParameters

PATH_TOLERANCE = 1e-9
"""Largest distance (mm, deg) between an axis and the begin of the path that takes it over."""

MOVING_ALONE = (S.DISCRETE_MOTION, S.STOPPING, S.CONTINUOUS_MOTION)
"""States that can end by themselves."""

Row = tuple[float | int, ...]
"""One cycle: the fields of AxisBlock after `count`."""


class AxisUnit(Unit):
    """One axis with its functions (cnc_ptp.axis), position controller and drive.

    States (PLCopen): Disabled, Standstill, DiscreteMotion (PTP), SynchronizedMotion (channel path), Stopping,
    ErrorStop. The position loop is closed while powered or on a ramp.
    """

    kind: ClassVar[str] = "axis"

    def __init__(self, parameters: AxisParameters, *, cycle_time: float, drive: Drive | None = None) -> None:
        """`cycle_time` in s; without `drive` the simulated one of the parameters is used."""
        super().__init__(parameters.name)
        self._axis = Axis(
            parameters, cycle_time=cycle_time, report_error=self._report_error, report_warning=self._report_warning
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
        self._commands = (
            self,
            PowerCommands(self._axis, actual_position=lambda: self._drive.position),
            PtpCommands(self._axis),
            StopCommands(self._axis),
            CompensationCommands(self._axis),
            ExternalCommands(self._axis),
        )

    def _report_error(self, cycle: int, error_id: int, text: str) -> None:
        self.event(cycle, Severity.ERROR, error_id, text)

    def _report_warning(self, cycle: int, error_id: int, text: str) -> None:
        self.event(cycle, Severity.WARNING, error_id, text)

    # commands

    def handler(self, command: str) -> Handler:
        """From the group of commands that has it."""
        group = next(group for group in self._commands if hasattr(group, f"do_{command}"))
        handler: Handler = getattr(group, f"do_{command}")
        return handler

    def do_upstream_lost(self, cycle: int, *, source: str) -> str | None:
        """The watchdog: `source` has sent nothing in time; without its channel only an axis on the path stops."""
        axis = self._axis
        if axis.state in (S.ERROR_STOP, S.DISABLED):
            return None
        if source in ("plc", "clock") or axis.state == S.SYNCHRONIZED_MOTION:
            axis.fault(cycle, UPSTREAM_LOST, f"no block of '{source}' came within the watchdog time")
        return None

    def remaining_distance(self, cycle: int) -> float:
        """What is left of the positioning in work at `cycle`, mm (deg), with its sign."""
        job = self._axis.ptp.job
        return 0.0 if job is None else job.target - self._axis.ptp.state(cycle)[0]

    # one block

    def step(self, tick: CycleTick, inputs: Mapping[str, Block]) -> AxisBlock:
        """Computes one block; follows the path of the channel among `inputs` that has the axis."""
        first_cycle, count = tick
        axis = self._axis
        axis.advance(first_cycle)
        rows = self._follow(first_cycle, self._path_setpoints(first_cycle, self._owning_channel(inputs)))
        while len(rows) < count:
            cycle = first_cycle + len(rows)
            axis.advance(cycle)
            rows += self._follow(cycle, axis.basic_motion(cycle, count - len(rows)))
        return AxisBlock(first_cycle, count, *map(list, zip(*rows, strict=True)))

    def _follow(self, first_cycle: int, setpoints: list[State]) -> list[Row]:
        """The cycles of `setpoints`; fewer when a fault puts the axis on its own ramp."""
        rows: list[Row] = []
        error_id = self._axis.error_id
        for cycle, setpoint in enumerate(setpoints, first_cycle):
            rows.append(self._cycle(cycle, setpoint))
            if self._axis.error_id != error_id:
                break
        return rows

    def _cycle(self, cycle: int, base: State) -> Row:
        axis, drive = self._axis, self._drive
        setpoint = axis.superimposed(cycle, base)
        position, velocity, acceleration, jerk = setpoint
        following_error = position - drive.position
        if axis.state in MOVING_ALONE:
            axis.advance_state(cycle)
        if axis.superposed:
            axis.watch_superposition(cycle, setpoint)
        axis.watch_target(cycle, setpoint, drive.position)
        command = 0.0
        if axis.powered or axis.moving(cycle):
            if axis.error_id == 0 and self._controller.exceeds_limit(following_error):
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
            axis.override_percent,
            axis.state,
            axis.status_bits(setpoint, drive.position),
            axis.error_id,
        )
        drive.step(command)
        return row

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
        if self._axis.state != S.SYNCHRONIZED_MOTION:
            return []
        self._axis.ptp.take_over(first_cycle + channel.count - 1, *setpoints[-1][:3])
        return setpoints

    def _enter_path(self, cycle: int, begin: float) -> None:
        """The channel moves the axis from now on; a fault unless it stands at `begin`, the path's first setpoint."""
        axis = self._axis
        if axis.state in (S.SYNCHRONIZED_MOTION, S.ERROR_STOP):
            return
        position = axis.setpoint(cycle)[0]
        if axis.state == S.STANDSTILL:
            axis.absorb(cycle)
        if axis.state != S.STANDSTILL:
            reason = f"the channel moves the path while the axis is in {state_name(axis.state)}"
            axis.fault(cycle, PATH_NOT_ACCEPTED, reason)
        elif abs(begin - position) > PATH_TOLERANCE:
            reason = f"the path of the channel begins at {begin} {axis.unit}, the axis stands at {position} {axis.unit}"
            axis.fault(cycle, PATH_NOT_ACCEPTED, reason)
        else:
            axis.state = S.SYNCHRONIZED_MOTION

    def _leave_path(self, cycle: int) -> None:
        axis = self._axis
        if axis.state != S.SYNCHRONIZED_MOTION:
            return
        axis.state = S.STANDSTILL
        if axis.setpoint(cycle)[1] != 0.0:
            axis.fault(cycle, PATH_NOT_ACCEPTED, "the channel let the axis go while it moved")

    def _following_error_fault(self, cycle: int, setpoint: State, following_error: float) -> None:
        axis = self._axis
        if axis.state == S.SYNCHRONIZED_MOTION:
            axis.ptp.take_over(cycle, *setpoint[:3])
        limit = axis.parameters.following_error_limit
        axis.fault(
            cycle,
            FOLLOWING_ERROR,
            f"following error {following_error:.4f} {axis.unit} exceeds {limit} {axis.unit} (P-AXIS-00168)",
        )
