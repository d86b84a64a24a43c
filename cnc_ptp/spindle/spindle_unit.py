"""Spindle unit: takes commands in their order, closes the position loop, computes cycle blocks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, ClassVar

from cnc_ptp.control.commands import FEEDFORWARD_WAITS, FeedforwardCommands, feedforward_warning
from cnc_ptp.control.drives import Drive, make_drive
from cnc_ptp.errors import NO_VALUES, CncError, Value, joined_warnings, warning_text
from cnc_ptp.parameters import AxisParameters, GearParameters, SpindleParameters
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import Command, CommandRecord, CycleBlock, CycleTick, Refusal, Severity, SpindleBlock
from cnc_ptp.protocol.jobs import JOBS, JobStatus
from cnc_ptp.protocol.spindle_states import held_by_override
from cnc_ptp.protocol.unit import PLC, UPSTREAM_LOST, Handler, Unit
from cnc_ptp.spindle.command_queue import MOTION, CommandQueue, QueuedCommand
from cnc_ptp.spindle.coupling_commands import PASSED_ON, CouplingCommands, can_follow
from cnc_ptp.spindle.faults import COMMAND_WAITS, GEAR_CHANGE_OVERTAKEN, HOMING_LOST, MASTER_IN_ERROR, SLAVE_CANNOT
from cnc_ptp.spindle.gear_commands import GearCommands
from cnc_ptp.spindle.path_commands import PathCommands
from cnc_ptp.spindle.position_commands import PositionCommands
from cnc_ptp.spindle.power_commands import PowerCommands
from cnc_ptp.spindle.procedures import Procedures
from cnc_ptp.spindle.rotation_commands import RotationCommands
from cnc_ptp.spindle.spindle import Spindle
from cnc_ptp.spindle.spindle_cycles import SpindleCycles


class SpindleUnit(Unit):
    """One spindle with its functions (cnc_ptp.spindle), position loop and drive.

    States (PLCopen): Disabled, Standstill, ContinuousMotion (M03, M04), Stopping (M05), DiscreteMotion (M19, motion to
    the change position), Homing (G74, automatic homing), ErrorStop. Speeds inside are °/s, + = M03.
    """

    kind: ClassVar[str] = "spindle"
    length_unit = "deg"

    def __init__(
        self,
        parameters: SpindleParameters,
        *,
        cycle_time: float,
        drive: Drive | None = None,
        spindles: tuple[str, ...] = (),
        axes: Mapping[str, AxisParameters] | None = None,
    ) -> None:
        """`cycle_time` in s; without `drive` the simulated one of the parameters is used.

        `spindles` and `axes` of the machine.
        """
        super().__init__(parameters.name)
        self._given_drive = drive
        self._cycle_time = cycle_time
        self.spindle = Spindle(
            parameters,
            drive=self._make_drive(parameters.gears[parameters.gear], parameters.start_position),
            make_drive=self._make_drive,
            cycle_time=cycle_time,
            report_error=partial(self._report, Severity.ERROR),
            report_warning=partial(self._report, Severity.WARNING),
        )
        procedures = Procedures(self.spindle)
        self._queue = CommandQueue(self.spindle)
        self._coupling = CouplingCommands(self.spindle, spindles or (parameters.name,))
        self._rotation = RotationCommands(self.spindle, procedures)
        self._power = PowerCommands(self.spindle)
        self._path = PathCommands(self.spindle, axes or {})
        self._groups = (
            self,
            self._rotation,
            PositionCommands(self.spindle, procedures),
            GearCommands(self.spindle, procedures),
            self._power,
            self._coupling,
            self._path,
            FeedforwardCommands(self.spindle.loop, f"spindle {parameters.name}"),
        )
        self.check_override = self._rotation.check_override
        self.overlay.full_override = min(100.0, parameters.max_override_percent)
        self.overlay.begin("override", self.spindle.override_percent)
        self.overlay.begin("controller_enable", float(parameters.powered_at_start))
        self._cycles = SpindleCycles(self.spindle, procedures, self._queue, self._rotation)
        self.next_number = 1
        """Number of the next motion command."""
        self._waiting_jobs: set[int] = set()
        self._job_given = 0
        """Number for the job of the command that is carried out now, 0 if it is none."""
        self._turned_down: tuple[int, CncError | None] = 0, None
        self._passed_on: list[Command] = []
        self._refused: list[Refusal] = []
        self._last_block: SpindleBlock | None = None

    def _make_drive(self, gear: GearParameters, position: float) -> Drive:
        plant = replace(gear.control.plant, start_position=position)
        return self._given_drive or make_drive(replace(gear.control, plant=plant), self._cycle_time)

    def _report(
        self, severity: Severity, cycle: int, error_id: int, text: str, values: Mapping[str, Value] = NO_VALUES
    ) -> None:
        self.report(cycle, severity, error_id, text, values)

    @property
    def master(self) -> str | None:
        """See Unit."""
        return self._coupling.master or None

    def waits_for(self) -> str:
        """See Unit: the PLC, an override above 0, or a speed that is not reached."""
        block = self._last_block
        if block is None:
            return ""
        if block.gear_request:
            return f"spindle {self.name} waits for the PLC to change to gear {block.gear_request}"
        reason, pending = why_it_stays(block), block.plc_commands - block.plc_acknowledged
        if reason and pending:
            return f"spindle {self.name} still has {pending} of the PLC's commands to carry out: {reason}"
        held = reason and block.state[-1] == S.DISCRETE_MOTION
        return f"spindle {self.name} is held by override 0" if held else ""

    # commands

    def command(self, command: Command, cycle: int) -> CommandRecord:
        """See Unit; the source of a refused command finds the refusal in the next block."""
        record = super().command(command, cycle)
        source = command.arguments.get("source") or command.arguments.get("owner")
        if record.accepted or not source or not isinstance(source, str) or command.command == "upstream_lost":
            return record
        if not self.sources or source in self.sources:
            self._refused.append(Refusal(source, record.error_id, record.message))
        return record

    def handler(self, command: str) -> Handler:
        """Motion commands act in the order that `CommandQueue` gives them; all others act immediately."""
        handler = self._group_handler(command)
        return partial(self._in_turn, command) if command in MOTION else handler

    def _group_handler(self, command: str) -> Callable[..., str | None]:
        group = next(group for group in self._groups if hasattr(group, f"do_{command}"))
        handler: Callable[..., str | None] = getattr(group, f"do_{command}")
        return handler

    def _in_turn(
        self, command: str, cycle: int, *, source: str = "", own: bool = False, **arguments: Any
    ) -> str | None:
        """`own`: a stop that counts only while nobody else has commanded the spindle since."""
        self._job_given = 0
        self._path.check(command)
        commander = self._queue.commander
        if own and commander and commander != source:
            self._queue.forget(source)
            return (
                f"spindle {self.name}: stop of '{source}' without effect, '{commander}' has commanded the spindle since"
            )
        self._queue.check(command, source, self._coupling.master)
        job = self.jobs.newest + 1 if command in JOBS[self.kind] else 0
        queued = QueuedCommand(command, arguments, source, self.next_number, job)
        self.next_number += 1
        if self._queue.must_wait(command, source):
            self.spindle.require_ready(command)
            message = self._waiting(queued)
            self._queue.add(queued)
            self._waiting_jobs.add(job)
        else:
            left = self._leave_master_by(command, source, cycle)
            message = joined_warnings(left, self._carry_out(cycle, queued))
        self._queue.taken += source == PLC
        self._job_given = job
        return message

    def _leave_master_by(self, command: str, source: str, cycle: int) -> str | None:
        """A stop of PLC or people ends a coupling, so that the next command of the master does not turn the slave."""
        master = self._coupling.master or self._coupling.wanted
        if command != "stop" or source not in ("", PLC) or not master:
            return None
        self.do_decouple(cycle)
        return f"spindle {self.name}: stop ends the coupling to {master}"

    def begin_job(self, command: Command, cycle: int) -> int:
        """See Unit: a job that waits for its turn becomes active then; a stop without effect is none."""
        if command.command not in MOTION:
            return super().begin_job(command, cycle)
        return self.jobs.accept() if self._job_given else 0

    def note_jobs(self, block: CycleBlock) -> None:
        """See Unit: between the steps of a job the spindle may be at rest; jobs that no longer wait are aborted."""
        if self.spindle.work.procedure is None:
            self.jobs.watch(block)
        waiting = {command.job for command in self._queue.waiting}
        for job in sorted(self._waiting_jobs - waiting - {0}):
            self.jobs.drop(block.first_cycle, job)
        self._waiting_jobs &= waiting

    def _waiting(self, command: QueuedCommand) -> str | None:
        """The warning that tells PLC and users what their command waits for; a program waits without one."""
        if command.source not in ("", PLC):
            return None
        text = f"spindle {self.name}: {command.name} waits until {self._queue.awaited()}"
        return warning_text(COMMAND_WAITS, text)

    def _carry_out(self, cycle: int, command: QueuedCommand) -> str | None:
        work = self.spindle.work
        if command.name == "stop":
            self._report_lost_homings(cycle, "stop")
            if command.source != self._queue.source:
                self._report_overtaken(cycle, "stop")
        before, turned = work.procedure, self.spindle.state == S.CONTINUOUS_MOTION
        answer = self._group_handler(command.name)(cycle, **command.arguments)
        if work.procedure is not None and work.procedure is not before:
            work.procedure.number = command.number
        if command.job:
            self._waiting_jobs.discard(command.job)
            self.jobs.activate(cycle, command.job)
        if command.name == "stop":
            self._queue.clear()
        if self._has_effect(command.name, new_procedure=work.procedure is not before, turned=turned):
            self._queue.begin(command.source)
        if command.name in PASSED_ON:
            source = {"source": command.source} if command.source else {}
            self._passed_on.append(Command(self.name, command.name, {**command.arguments, **source}))
        return answer if isinstance(answer, str) else None

    def _report_overtaken(self, cycle: int, by: str) -> None:
        """Notifies the source of the gear change that the rotation does not resume afterwards."""
        source = self._queue.source
        if not source or not self.spindle.work.gear_request:
            return
        text = f"spindle {self.name}: {by} while the PLC changes the gear for '{source}'; the spindle stays at rest"
        self._report(Severity.WARNING, cycle, GEAR_CHANGE_OVERTAKEN, text)
        self._refused.append(Refusal(source, GEAR_CHANGE_OVERTAKEN, text))

    def _report_lost_homings(self, cycle: int, by: str) -> None:
        """Reports a homing without zero pulse so far, and waiting ones, as aborted: nobody waits for them."""
        spindle, procedure = self.spindle, self.spindle.work.procedure
        numbers = [procedure.number] if procedure is not None and procedure.homes else []
        numbers += [command.number for command in self._queue.waiting if command.name == "home"]
        reference = (
            "the previous reference point remains valid" if spindle.referenced else "there is no reference point"
        )
        for number in numbers:
            text = f"{by} before the zero pulse, homing (command {number}) is aborted; {reference}"
            self._report(Severity.WARNING, cycle, HOMING_LOST, f"spindle {spindle.name}: {text}")

    @staticmethod
    def _has_effect(command: str, *, new_procedure: bool, turned: bool) -> bool:
        """False for the gear in use and a speed at a standstill: they take the spindle from no source."""
        if command == "select_gear":
            return new_procedure
        return command != "set_speed" or turned

    def _take_turns(self, cycle: int) -> None:
        """Commands whose turn has come act at the first cycle of a block, like all others."""
        while (command := self._queue.next()) is not None:
            if command.master_source is not None:
                self._act_as_slave(cycle, command)
                continue
            try:
                self._carry_out(cycle, command)
            except CncError as error:
                self._turned_down = command.number, error
                self._waiting_jobs.discard(command.job)
                if command.job:
                    self.jobs.drop(cycle, command.job, error.number)
                self.report(cycle, Severity.WARNING, error.number, error.message, error.values)
                if command.source:
                    self._refused.append(Refusal(command.source, error.number, error.message))

    def outcome(self, number: int) -> bool | None:
        """Outcome of a positioning or homing: None while it waits or is active, then whether it finished."""
        procedure = self.spindle.work.procedure
        active = procedure is not None and procedure.number == number
        if active or any(command.number == number for command in self._queue.waiting):
            return None
        return self.spindle.work.last_done == number

    def refusal(self, number: int) -> CncError | None:
        """The reason why this command was refused at its turn, if it was the last one so refused."""
        refused, error = self._turned_down
        return error if refused == number else None

    def do_power(self, cycle: int, *, enabled: bool) -> str | None:
        """See PowerCommands.do_power; without power nothing waits; slaves of a spindle in a gear change stop too."""
        if not enabled:
            self._report_overtaken(cycle, "power off")
            self._queue.clear()
            if self.spindle.work.gear_request:
                self._passed_on.append(Command(self.name, "stop", {"homes": False}))
        return self._power.do_power(cycle, enabled=enabled)

    def do_reset(self, cycle: int) -> None:
        """See PowerCommands.do_reset; waiting commands are dropped, and slaves stop too."""
        if self.spindle.state != S.ERROR_STOP:
            self._path.check("reset")
        self._report_lost_homings(cycle, "reset")
        self._power.do_reset(cycle)
        self.jobs.end(cycle, JobStatus.ABORTED)
        self._queue.clear()
        self._passed_on.append(Command(self.name, "stop", {"homes": False}))

    def do_hold_stop(self, cycle: int, *, enabled: bool) -> None:
        """See Unit; a slave that follows its master, or a spindle on a path, is not held (24022, 24031)."""
        if enabled:
            self._path.check("hold_stop")
            self._queue.check("hold_stop", "", self._coupling.master)
        super().do_hold_stop(cycle, enabled=enabled)

    def do_decouple(self, cycle: int, *, owner: str = "") -> str | None:
        """See CouplingCommands.do_decouple; waiting commands that came through the master are dropped."""
        message = self._coupling.do_decouple(cycle, owner=owner)
        if message is None:
            self._queue.leave_master(self._coupling.owner)
        return message

    def do_upstream_lost(self, cycle: int, *, source: str) -> None:
        """The watchdog: `source` (channel, PLC, clock or master) has sent nothing in time; the spindle stops."""
        self._path.lose(cycle, source)
        if can_follow(self.spindle):
            self.spindle.fault(cycle, UPSTREAM_LOST, f"no block of '{source}' came within the watchdog time")

    def lag_share(self, block: CycleBlock) -> float:
        """See Unit."""
        loop = self.spindle.loop
        if not isinstance(block, SpindleBlock) or not loop.watches(on=self.spindle.powered) or block.error_id[-1]:
            return 0.0
        set_values = block.set_position_deg, block.set_speed_rpm
        return loop.control.lag_share(*set_values, block.actual_position_deg[-1], unit=DEG_S_PER_RPM)

    # one block

    def step(self, tick: CycleTick, inputs: Mapping[str, CycleBlock]) -> SpindleBlock:
        """Computes one block; a slave first carries out the commands of its master for this block."""
        first_cycle, count = tick
        master = inputs.get(self._coupling.master)
        if isinstance(master, SpindleBlock):
            self._follow(first_cycle, master)
        if self.spindle.travel is not None:
            self._path.take_setpoints(first_cycle, inputs.get(self.spindle.travel.channel))
        self._take_turns(first_cycle)
        block = self._cycles.block(first_cycle, count)
        warning = feedforward_warning(self.spindle.loop.feedforward, block.set_speed_rpm[-1] * DEG_S_PER_RPM, "deg")
        if warning is not None:
            text, values = warning
            text = f"spindle {self.name}: {text}"
            self.report(first_cycle + count - 1, Severity.WARNING, FEEDFORWARD_WAITS, text, values)
        block.gear_request = self.spindle.work.gear_request
        block.master, block.master_wanted = self._coupling.master, self._coupling.wanted
        block.source = self._queue.source
        block.plc_commands, block.plc_acknowledged = self._queue.taken, self._queue.acknowledged
        block.refused, self._refused = self._refused, []
        block.commands, self._passed_on = self._passed_on, []
        self._last_block = block
        return block

    def _follow(self, cycle: int, master: SpindleBlock) -> None:
        """Carries out the commands of the master; after an error of the master and without its power nothing waits."""
        spindle = self.spindle
        for command in master.commands:
            if can_follow(spindle):
                self._do_as_master(cycle, command)
            elif spindle.state == S.DISABLED and command.command != "stop":
                self._stays_behind(cycle, command)
        if master.error_id[0] or master.state[0] == S.DISABLED:
            self._queue.forget_master()
            spindle.work.forget_rotation()
        if master.error_id[0] and spindle.state in (S.CONTINUOUS_MOTION, S.DISCRETE_MOTION, S.HOMING):
            reason = f"its master {self._coupling.master} is in error P-ERR-{master.error_id[0]}"
            spindle.fault(cycle, MASTER_IN_ERROR, reason)

    def _stays_behind(self, cycle: int, command: Command) -> None:
        """A slave without power: whoever has commanded its master is notified."""
        reason = f"cannot carry out '{command.command}' of its master {self._coupling.master}"
        text = f"spindle {self.name}: {reason}: the spindle is in Disabled; power it on; nothing was changed"
        self._report(Severity.ERROR, cycle, SLAVE_CANNOT, text)
        if "source" in command.arguments:
            self._refused.append(Refusal(command.arguments["source"], SLAVE_CANNOT, text))

    def _do_as_master(self, cycle: int, command: Command) -> None:
        """During a gear change of the slave the command waits; a stop drops what waits."""
        name, arguments = command.command, self._coupling.of_slave(command.arguments)
        source = arguments.pop("source", "")
        queued = QueuedCommand(name, arguments, "", master_source=source)
        if self._queue.must_wait(name, ""):
            self._queue.add(queued)
            return
        if name == "stop":
            self._report_lost_homings(cycle, "stop")
            self._queue.clear()
        self._act_as_slave(cycle, queued)

    def _act_as_slave(self, cycle: int, command: QueuedCommand) -> None:
        """A command that the slave cannot carry out is an error."""
        self._queue.obey(command)
        try:
            self._group_handler(command.name)(cycle, **command.arguments)
        except CncError as error:
            if can_follow(self.spindle):
                reason = f"cannot carry out '{command.name}' of its master {self._coupling.master}: {error.reason}"
                self.spindle.fault(cycle, SLAVE_CANNOT, reason, error.values)


def why_it_stays(block: SpindleBlock) -> str:
    """The reason why a commanded spindle cannot finish without help; empty while it can."""
    if held_by_override(block):
        return "it is held by override 0"
    steady = block.state[-1] == S.CONTINUOUS_MOTION and block.set_acceleration_deg_s2[-1] == 0.0
    return "its speed is not reached" if steady and not block.speed_reached[-1] else ""
