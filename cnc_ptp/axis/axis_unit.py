"""Axis unit: chooses its setpoint source (PTP generator, path, master), closes the position loop, keeps its state."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any, ClassVar

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.axis_sources import MasterSource, PathSource
from cnc_ptp.axis.compensation_commands import CompensationCommands
from cnc_ptp.axis.coordinate_commands import CoordinateCommands
from cnc_ptp.axis.coupling_commands import CouplingCommands
from cnc_ptp.axis.decoupling_commands import DecouplingCommands
from cnc_ptp.axis.drive_homing import DriveHoming
from cnc_ptp.axis.drive_lead import DriveLead
from cnc_ptp.axis.drive_parameter_commands import DriveParameterCommands
from cnc_ptp.axis.external_commands import ExternalCommands
from cnc_ptp.axis.feed_release_commands import FeedReleaseCommands
from cnc_ptp.axis.homing import Homing
from cnc_ptp.axis.homing_commands import HomingCommands
from cnc_ptp.axis.jog_commands import JogCommands
from cnc_ptp.axis.monitoring import MOVING_ALONE, Monitoring
from cnc_ptp.axis.motion_queue import MotionQueue
from cnc_ptp.axis.override_commands import OverrideCommands
from cnc_ptp.axis.parameter_commands import ParameterCommands
from cnc_ptp.axis.power_commands import PowerCommands
from cnc_ptp.axis.probe import Probe
from cnc_ptp.axis.ptp_commands import PtpCommands
from cnc_ptp.axis.stop_commands import StopCommands
from cnc_ptp.axis.superimposed_commands import SuperimposedCommands
from cnc_ptp.axis.trajectory_commands import TrajectoryCommands
from cnc_ptp.axis.trajectory_watch import TrajectoryWatch
from cnc_ptp.control.commands import FEEDFORWARD_WAITS, ControlCommands, feedforward_warning
from cnc_ptp.control.control_loop import ControlColumns, ControlLoop
from cnc_ptp.control.drives import Drive, make_drive
from cnc_ptp.control.drives.sercos import idns
from cnc_ptp.control.faults import FOLLOWING_ERROR
from cnc_ptp.control.feedforward import CouplingLimits
from cnc_ptp.errors import Value
from cnc_ptp.motion.setpoints import MotionState, Setpoints
from cnc_ptp.parameters import AxisParameters, SpindleParameters
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.blocks import AxisBlock, Command, CycleBlock, CycleTick, Severity
from cnc_ptp.protocol.jobs import SUPERIMPOSED, JobStatus
from cnc_ptp.protocol.unit import CLOCK, PLC, UPSTREAM_LOST, Handler, Unit

ADDITIONS = ("external_enable", "external_disable")
"""Commands whose motion may be added to another one."""


class AxisUnit(Unit):
    """One axis with its functions (cnc_ptp.axis), position controller and drive.

    States (PLCopen): Disabled, Standstill, DiscreteMotion (PTP), ContinuousMotion (jogging, external setpoints, a slave
    that was decoupled in motion), SynchronizedMotion (channel path, master axis), Stopping, ErrorStop.
    The position loop is closed while powered or on a ramp.
    """

    kind: ClassVar[str] = "axis"

    def __init__(
        self,
        parameters: AxisParameters,
        *,
        cycle_time: float,
        drive: Drive | None = None,
        axes: Mapping[str, AxisParameters] | None = None,
        spindles: Mapping[str, SpindleParameters] | None = None,
    ) -> None:
        """`cycle_time` in s; without `drive` the simulated one of the parameters is used.

        `axes` and `spindles` of the machine.
        """
        super().__init__(parameters.name)
        self._axis = Axis(
            parameters,
            cycle_time=cycle_time,
            jobs=self.jobs,
            report_error=self._report_error,
            report_warning=self._report_warning,
        )
        self.length_unit = self._axis.unit
        self._queue = MotionQueue(self._axis, cycle_time=cycle_time, report_warning=self._report_warning)
        self._monitoring = Monitoring(self._axis, cycle_time=cycle_time, report_warning=self._report_warning)
        self._trajectory = TrajectoryWatch(self._axis, cycle_time=cycle_time, report_warning=self._report_warning)
        self._loop = ControlLoop(
            parameters.control,
            cycle_time=cycle_time,
            limits=CouplingLimits(parameters.max_velocity, parameters.max_acceleration, parameters.jerk),
            drive=drive or make_drive(parameters.control, cycle_time),
        )
        if not parameters.referenced_at_start:
            self._loop.count_from(parameters.start_position)
        self._axis.lead = DriveLead(self._loop.drive.service)
        self._homing = Homing(self._axis, self._loop)
        self._drive_homing = DriveHoming(self._axis, self._loop, cycle_time=cycle_time, report=self._report_phase)
        self._probe = Probe(parameters.probe)
        begin, length = self._axis.modulo_range
        self._make_block = partial(
            AxisBlock, modulo_begin=begin, modulo_length=length, torque_digits=self._loop.torque_digits
        )
        known = axes or {parameters.name: parameters}
        self._path = PathSource(self._axis, axes=known, spindles=spindles or {})
        self._master = MasterSource(self._axis, axes=known, cycle_time=cycle_time)
        self._override = OverrideCommands(self._axis)
        self.check_override = self._override.check
        self.overlay.full_override = self._override.highest
        self.overlay.begin("controller_enable", float(parameters.powered_at_start))
        self._stops = StopCommands(self._axis)
        self._control = ControlCommands(self._loop, f"axis {parameters.name}")
        self._commands = (
            self,
            PowerCommands(self._axis, self._loop),
            FeedReleaseCommands(self._axis),
            PtpCommands(self._axis, self._queue),
            self._override,
            self._stops,
            JogCommands(self._axis, self._queue),
            SuperimposedCommands(self._axis, self._queue),
            TrajectoryCommands(self._axis, self._trajectory, cycle_time=cycle_time),
            CoordinateCommands(self._axis, self._loop, self._queue, self._monitoring),
            HomingCommands(self._axis, self._homing, self._drive_homing),
            DriveParameterCommands(self._axis, self._drive_homing),
            CompensationCommands(self._axis),
            ExternalCommands(self._axis),
            CouplingCommands(self._axis, axes=known, cycle_time=cycle_time),
            DecouplingCommands(self._axis),
            ParameterCommands(self._axis, self._loop, cycle_time=cycle_time, reselect=self._control.reselect),
            self._control,
        )
        self._last_block: AxisBlock | None = None

    def _report_error(self, cycle: int, error_id: int, text: str, values: Mapping[str, Value]) -> None:
        self.report(cycle, Severity.ERROR, error_id, text, values)

    def _report_warning(self, cycle: int, error_id: int, text: str, values: Mapping[str, Value]) -> None:
        self.report(cycle, Severity.WARNING, error_id, text, values)

    def _report_phase(self, cycle: int, error_id: int, text: str) -> None:
        self.event(cycle, Severity.INFO, error_id, text)

    @property
    def master(self) -> str | None:
        """See Unit."""
        return self._axis.coupling.master if self._axis.coupled and self._axis.coupling is not None else None

    @property
    def led(self) -> bool:
        """See Unit."""
        return self._last_block is not None and self._last_block.state[-1] == S.SYNCHRONIZED_MOTION

    def waits_for(self) -> str:
        """See Unit: only commands end the motion of a slave that was decoupled in motion, and what S-0-0148 began."""
        block = self._last_block
        if self._drive_homing.waits_for_plc:
            return f"axis {self.name} waits for S-0-0148 = 0"
        if block is None or block.state[-1] != S.CONTINUOUS_MOTION:
            return ""
        endless = block.status_bits[-1] & StatusBit.HAS_JOB and block.set_velocity[-1] != 0.0
        return f"axis {self.name} moves endlessly" if endless else ""

    # commands

    def handler(self, command: str) -> Handler:
        """The handler of a command, from the group that has it."""
        group = next(group for group in self._commands if hasattr(group, f"do_{command}"))
        handler: Handler = getattr(group, f"do_{command}")
        return handler

    def begin_job(self, command: Command, cycle: int) -> int:
        """See Unit: the end of a jog where there is none, and what is added to another motion, begin no job."""
        axis, jobs, state = self._axis, self.jobs, self._axis.state
        if axis.waiting_job == jobs.newest + 1:
            return jobs.accept()
        if command.command in SUPERIMPOSED:
            number = jobs.begin_superimposed(cycle)
            if not axis.added.moving(cycle):
                jobs.end_superimposed(cycle, JobStatus.DONE)
            return number
        ends_no_jog = command.command == "jog" and not command.arguments["velocity"] and not self._axis.has_been_stopped
        added = command.command in ADDITIONS and state in (S.DISCRETE_MOTION, S.SYNCHRONIZED_MOTION)
        if ends_no_jog or added:
            return 0
        axis.drop_waiting(cycle)
        return jobs.begin(cycle)

    def is_held_off(self, command: str, arguments: Mapping[str, Any]) -> bool:
        """See Unit; the end of a jog is no motion, and a drive that homes on its own is one."""
        if command == "write_drive_parameter":
            return bool(arguments["idn"] == idns.HOMING)
        return super().is_held_off(command, arguments) and not (command == "jog" and not arguments["velocity"])

    def do_hold_stop(self, cycle: int, *, enabled: bool) -> None:
        """See Unit; an axis that follows a channel or a master is stopped there (23005, 23040)."""
        if enabled:
            self._stops.refuse_synchronous("hold_stop")
        super().do_hold_stop(cycle, enabled=enabled)

    def do_upstream_lost(self, cycle: int, *, source: str) -> str | None:
        """The watchdog: `source` has sent nothing in time; without its channel only an axis on the path stops."""
        axis = self._axis
        if axis.state in (S.ERROR_STOP, S.DISABLED):
            return None
        leads = axis.on_path or (axis.coupling is not None and axis.coupling.master == source)
        if source not in (PLC, CLOCK) and not leads:
            return None
        in_step = self._path.stop(cycle)
        if source == PLC and in_step is None and self._path.stop_with_path(source):
            text = (
                f"axis {self.name}: no block of '{source}' came within the watchdog time; the axis stops with its path"
            )
            self.event(cycle, Severity.ERROR, UPSTREAM_LOST, text)
        else:
            reason = f"no block of '{source}' came within the watchdog time"
            axis.fault(cycle, UPSTREAM_LOST, reason, path_stop=in_step)
        return None

    def remaining_distance(self, cycle: int) -> float:
        """Distance to go of the active positioning at `cycle`, mm (deg), with its sign."""
        job = self._axis.ptp.job
        return 0.0 if job is None else job.target - self._axis.ptp.state(cycle)[0]

    def lag_share(self, block: CycleBlock) -> float:
        """See Unit."""
        if not isinstance(block, AxisBlock) or block.state[-1] in (S.DISABLED, S.ERROR_STOP):
            return 0.0
        return self._loop.lag_share(block.set_position, block.set_velocity, block.actual_position[-1])

    # one block

    def step(self, tick: CycleTick, inputs: Mapping[str, CycleBlock]) -> AxisBlock:
        """Computes one block; follows its master, or the path of the channel among `inputs` that has the axis."""
        first_cycle, count = tick
        axis = self._axis
        block = self._make_block(first_cycle, count)
        control = ControlColumns()
        self._advance(first_cycle)
        setpoints = self._led(first_cycle, inputs)
        if setpoints is not None:
            self._follow(first_cycle, setpoints, block, control)
        while (done := len(block.state)) < count:
            cycle = first_cycle + done
            self._advance(cycle)
            most = self._queue.cycles(cycle, count - done)
            self._follow(cycle, axis.basic_motion(cycle, most), block, control)
        take_columns(block, control)
        self._probe.watch(block, self._loop.offset)
        warning = feedforward_warning(self._loop.feedforward, block.set_velocity[-1], axis.unit)
        if warning is not None:
            text, values = warning
            self._report_warning(first_cycle + count - 1, FEEDFORWARD_WAITS, f"axis {self.name}: {text}", values)
        block.master = axis.coupling.master if axis.coupling is not None else ""
        block.target_velocity, block.couples_actual = axis.target_velocity(), axis.couples_actual()
        self._last_block = block
        return block

    def _advance(self, cycle: int) -> None:
        """Carries out what is due at `cycle`."""
        self._axis.advance(cycle)
        self._queue.advance(cycle)

    def _led(self, first_cycle: int, inputs: Mapping[str, CycleBlock]) -> Setpoints | None:
        """Setpoints of a master or of a channel, None if its own generator moves the axis."""
        axis, axis.stop_held = self._axis, self.stop_held
        if axis.carried is not None:
            self._path.put_down(first_cycle, inputs)
        if axis.coupled and not axis.on_path:
            self._path.forbid(first_cycle, inputs)
        if axis.coupled:
            setpoints = self._master.setpoints(first_cycle, inputs)
            if not axis.on_path:
                return setpoints
        return self._path.setpoints(first_cycle, inputs)

    def _follow(self, first_cycle: int, setpoints: Setpoints, block: AxisBlock, control: ControlColumns) -> None:
        """Adds the cycles of `setpoints`; fewer when a fault puts the axis on its own ramp."""
        axis = self._axis
        done = 0
        if not self._master.gantry.watches:
            if axis.state in MOVING_ALONE:
                axis.advance_state(first_cycle)
            if self._monitoring.undisturbed(first_cycle, setpoints):
                done = self._undisturbed_cycles(first_cycle, setpoints, block, control)
        error_id = axis.error_id
        for index in range(done, len(setpoints)):
            self._cycle(first_cycle + index, setpoints.at(index), block, control)
            if axis.error_id != error_id and not axis.coupled:
                break

    def _undisturbed_cycles(
        self, first_cycle: int, setpoints: Setpoints, block: AxisBlock, control: ControlColumns
    ) -> int:
        """The same as `_cycle` for cycles in which the axis only follows; up to an excessive following error.

        Returns their number.
        """
        axis, loop = self._axis, self._loop
        closed = axis.powered or axis.moving(first_cycle + len(setpoints) - 1)
        first = len(control.actual_position)
        n = loop.follow(setpoints, closed, control, watched=closed and loop.monitor.on)
        if n == 0:
            return 0
        block.set_position += setpoints.positions[:n]
        block.set_velocity += setpoints.velocities[:n]
        block.set_acceleration += setpoints.accelerations[:n]
        block.set_jerk += setpoints.jerks[:n]
        block.override_percent += [axis.override_percent] * n
        block.state += [axis.state] * n
        common = axis.common_bits(0) | self._control_bits
        for index in range(n):
            bits = axis.motion_bits(setpoints.at(index), control.actual_position[first + index])
            block.status_bits.append(common | bits)
        block.error_id += [0] * n
        return n

    @property
    def _control_bits(self) -> int:
        return int(StatusBit.FRICTION_COMPENSATION) if self._loop.friction.on else 0

    def _cycle(self, cycle: int, base: MotionState, block: AxisBlock, control: ControlColumns) -> None:
        """Adds one cycle, in which anything can happen."""
        axis, loop = self._axis, self._loop
        axis.end_added(cycle)
        setpoint = axis.superimposed(cycle, base)
        if axis.lead.active:
            setpoint = self._drive_homing.watch(cycle)
        elif axis.state == S.HOMING:
            setpoint = self._homing.watch(cycle, setpoint)
        actual_position = loop.position
        if axis.state in MOVING_ALONE:
            axis.advance_state(cycle)
        self._path.watch(cycle, base[1])
        setpoint = self._monitoring.watch(cycle, setpoint)
        self._master.gantry.watch(cycle, setpoint, actual_position)
        self._monitoring.watch_target(cycle, setpoint, actual_position)
        self._trajectory.watch(cycle, setpoint, actual_position)
        closed = not axis.lead.active and (axis.powered or axis.moving(cycle))
        if closed and axis.error_id == 0 and loop.too_far(setpoint):
            reason = loop.why_too_far(setpoint, axis.unit)
            axis.fault(cycle, FOLLOWING_ERROR, reason, setpoint, values=loop.lag_values(setpoint))
        loop.cycle(setpoint, closed, control)
        position, velocity, acceleration, jerk = setpoint
        block.set_position.append(position)
        block.set_velocity.append(velocity)
        block.set_acceleration.append(acceleration)
        block.set_jerk.append(jerk)
        block.override_percent.append(axis.override_percent)
        block.state.append(axis.state)
        block.status_bits.append(axis.status_bits(cycle, setpoint, control.actual_position[-1]) | self._control_bits)
        block.error_id.append(axis.error_id)


def take_columns(block: AxisBlock, control: ControlColumns) -> None:
    """The block has the columns of the control loop, which have the same names."""
    block.actual_position = control.actual_position
    block.actual_velocity = control.actual_velocity
    block.following_error = control.following_error
    block.command_velocity = control.command_velocity
    block.feedforward_velocity = control.feedforward_velocity
    block.additive_velocity = control.additive_velocity
    block.additive_torque = control.additive_torque
    block.friction_current = control.friction_current
    block.actual_torque = control.actual_torque
    block.feedforward_percent = control.feedforward_percent
