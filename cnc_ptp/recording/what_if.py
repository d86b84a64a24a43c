"""A recorded run computed again with something changed: parameters, overrides, the program, further commands.

Up to the time of the change all is as recorded, from the newest checkpoint on; from then on the change counts. Commands
of the recording come at their cycles, whatever the changed run does.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, NamedTuple

from cnc_ptp.errors import CncError
from cnc_ptp.machine.offline import OfflineMachine, Outputs
from cnc_ptp.parameters import load_machine
from cnc_ptp.parameters.changed import BAD_CHANGE, changed_text, read_changes
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import ChannelBlock, Command, CommandRecord, CycleBlock
from cnc_ptp.protocol.channel_states import IN_PROGRAM, ChannelStateCode
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.checkpoints import state_before
from cnc_ptp.recording.computed_again import commands_by_cycle, computed_again, fresh_machine, refused_again
from cnc_ptp.recording.recorded_answers import DelayedAnswers, RecordedAnswers
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.recording.selection import NOT_RECORDED
from cnc_ptp.state.other_parameters import change_parameters

TIME_OUTSIDE: Final = 26154
NO_LOAD: Final = 26157
NOTHING: Final = "nothing was computed"


@dataclass(frozen=True)
class Change:
    """What is to be different from `begin` (s) on; the run is followed to `end` (s), None: as long as it was recorded.

    parameters  unit.parameter=value
    override    of all channels, percent; recorded ones no longer count
    program     arguments of the command `load`: in place of the program of one channel, see WhatIf.replaced
    commands    further ones, at their times
    """

    begin: float = 0.0
    end: float | None = None
    parameters: Sequence[str] = ()
    override: float | None = None
    program: Mapping[str, Any] | None = None
    commands: Sequence[Entry] = field(default=())


class WhatIf:
    """The changed run. `note` says from where it was computed; `machine_text` and `machine` have the parameters."""

    def __init__(self, recorded: RunInputs, change: Change) -> None:
        """`recorded` stays open as long as it runs. Raises ParameterError, CncError 26011, 26153 to 26155, 26157."""
        self._recorded, self._change = recorded, change
        self._old = recorded.required_machine()
        self.machine_text = recorded.machine_yaml
        self.machine = self._old
        if change.parameters:
            changes = read_changes(change.parameters, self._old)
            self.machine_text = changed_text(recorded.machine_yaml, changes)
            self.machine = load_machine(recorded.machine_yaml, f"{recorded.path}:machine.yaml", changes=changes)
        self._check_override()
        self._cycle_time = self._old.cycle_time_us * 1e-6
        if change.end is None and not recorded.end:
            reason = f"recording {recorded.path}: holds no states"
            raise CncError(NOT_RECORDED, reason, f"{NOTHING}; --to says until when")
        self.begin = self._block_at(change.begin)
        self.end = recorded.end if change.end is None else self._end_at(change.end)
        self._commands = commands_by_cycle(recorded.commands, self._old)
        self._loads = self._loads_to_replace()
        self.replaced = ""
        """The channel that gets the other program: whose program runs at `begin`, or is loaded or started next."""
        self.not_replaced = ""
        """Why the other program has not come in; empty if it has, if it was refused, or if there is none."""
        self.note = ""
        self.running: list[str] = []
        """Channels whose program has not ended so far."""
        self.refused_of_change: list[CommandRecord] = []
        """Commands of the change that were refused."""
        self.refused_of_recording: list[CommandRecord] = []
        """Other commands that were refused and had not been in the recorded run."""
        self._refused_before = {content_of(record) for record in recorded.commands if not record.accepted}
        self._answers = RecordedAnswers(recorded, self.begin)

    def run(self) -> Iterator[Outputs]:
        """All blocks from `begin` on.

        Raises CncError 26018 where nothing is a beginning, 26156 for parameters that make other parts of a unit.
        """
        machine = self._at_begin()
        if self.machine is not self._old:
            runners, blocks = machine.parts
            change_parameters(runners, self._old, self.machine)
            changed = fresh_machine(self.machine)
            changed.go_on_from(machine.next_cycle, runners, blocks)
            machine = changed
        self.replaced = self._channel_to_replace(machine.parts[1])
        replacement = self._replacement(machine.parts[1])
        replacing = next(replacement)
        while machine.next_cycle < self.end:
            given = [*self._recorded_commands(machine)]
            given += [Given(command) for command in [*self._own_commands(machine.next_cycle), *replacing]]
            records = [machine.runner(each.command.target).command(each.command) for each in given]
            outputs = machine.tick()
            self._note_refused(given, records, outputs)
            replacing = replacement.send(outputs)
            self.running = [name for name, output in outputs.items() if is_in_program(output.block)]
            yield outputs

    def _check_override(self) -> None:
        """Raises CncError 26153 for one that a channel refuses."""
        percent = self._change.override
        if percent is None:
            return
        for name, channel in self.machine.channels.items():
            limit = channel.max_override_percent
            if not 0.0 <= percent <= limit:
                reason = f"--override {percent:g} is not within 0 ... {limit:g} of {name} (P-CHAN-00056)"
                raise CncError(BAD_CHANGE, reason, NOTHING, value=percent, limit=limit)

    def _end_at(self, seconds: float) -> int:
        """It may be later than what is recorded. Raises CncError 26154."""
        if seconds < self._change.begin:
            reason = f"--to {seconds:g} is before --from {self._change.begin:g}"
            raise CncError(TIME_OUTSIDE, reason, NOTHING, value=seconds, limit=self._change.begin)
        return round(seconds / self._cycle_time)

    def _block_at(self, seconds: float) -> int:
        """The first cycle of the block in which a time lies. Raises CncError 26154.

        Before the first block that is recorded nobody knows which commands were those of channels.
        """
        begin, duration = self._recorded.begin * self._cycle_time, self._recorded.end * self._cycle_time
        if seconds > duration == 0.0:
            reason = f"--from {seconds:g} is not possible: the recording holds no states, the run begins at 0"
            raise CncError(TIME_OUTSIDE, reason, NOTHING, value=seconds, limit=0.0)
        if not begin <= seconds <= duration:
            reason = f"--from {seconds:g} is not within the recorded time {begin:g} ... {duration:g} s"
            raise CncError(TIME_OUTSIDE, reason, NOTHING, value=seconds, limit=duration)
        count = self._old.block_cycles
        return round(seconds / self._cycle_time) // count * count

    def _loads_to_replace(self) -> list[CommandRecord]:
        """The recorded loads, for `--program`. Raises CncError 26157 without any."""
        if self._change.program is None:
            return []
        loads = self._taken("load")
        if not loads:
            raise CncError(NO_LOAD, "--program takes the place of a program, and none is loaded", NOTHING)
        return loads

    def _channel_to_replace(self, blocks: Mapping[str, CycleBlock]) -> str:
        """`blocks`: the newest of all units. Empty without `--program`."""
        before = [record.target for record in self._loads if record.cycle < self.begin]
        running = [name for name in before if not is_at_rest(blocks[name])]
        next_ones = sorted([*self._loads, *self._taken("start")], key=lambda record: record.cycle)
        later = [record.target for record in next_ones if record.cycle >= self.begin]
        return next(iter([*running, *later, *before]), "") if self._loads else ""

    def _taken(self, command: str) -> list[CommandRecord]:
        """The recorded commands of this name that were not refused."""
        records = [record for records in self._commands.values() for record in records]
        return [record for record in records if record.command == command and record.accepted]

    def _replacement(self, blocks: Mapping[str, CycleBlock]) -> Generator[list[Command], Outputs, None]:
        """Reset, when the path stands load, and start if that was taken: the commands of each block, without an end.

        Nothing where the channel is loaded later on: that is another load then. A channel at rest that is started later
        on is only loaded. `blocks`: the newest of all units; then the outputs are sent.
        """
        channel = self.replaced
        if channel and not self._comes(channel, "load"):
            runs = not is_at_rest(blocks[channel])
            if runs:
                outputs = yield [Command(channel, "reset")]
                while not is_at_rest(block := outputs[channel].block):
                    self.not_replaced = f"the program is not loaded: {channel} is in state {state_of(block).name}"
                    outputs = yield []
            self.not_replaced = ""
            outputs = yield [Command(channel, "load", dict(self._change.program or {}))]
            loaded = all(record.accepted for record in outputs[channel].records if record.command == "load")
            if loaded and (runs or not self._comes(channel, "start")):
                yield [Command(channel, "start")]
        while True:
            yield []

    def _comes(self, channel: str, command: str) -> bool:
        """From `begin` on, in the recording."""
        return any(each.target == channel and each.cycle >= self.begin for each in self._taken(command))

    def _at_begin(self) -> OfflineMachine:
        """The machine as it was recorded before `begin`, with a PLC that answers as the recorded one did."""
        machine = fresh_machine(self._old)
        # at 0 there is nothing to be restored
        state, why = state_before(self._recorded, self._old, self.begin) if self.begin else (None, "")
        if state is not None:
            machine.go_on_from(*state)
            self.note = f"computed from the checkpoint at {state.next_cycle * self._cycle_time:g} s"
        elif not self._recorded.from_0:
            raise self._recorded.no_beginning(self.begin, why)
        elif self.begin:
            self.note = f"computed from 0 s: {why}"
        deque(computed_again(machine, self._commands, self.begin), maxlen=0)
        self._answers.take(machine.parts[1])
        plc = machine.runner(PLC).unit
        assert isinstance(plc, PlcUnit)
        plc.do_auto_acknowledge(self.begin, enabled=False)
        plc.outside.append(DelayedAnswers(self._answers))
        return machine

    def _recorded_commands(self, machine: OfflineMachine) -> Iterator[Given]:
        for record in refused_again(machine, self._commands.get(machine.next_cycle, ())):
            if self._is_other_load(record):
                program = dict(self._change.program or {})
                yield Given(Command(record.target, "load", program, record.id), None if record.accepted else record)
            elif not (self._answers.gives(record) or self._is_other_override(record)):
                yield Given(Command.from_record(record), record)

    def _own_commands(self, cycle: int) -> list[Command]:
        """Override and further commands of the change in the block that begins with `cycle`."""
        given = []
        if cycle == self.begin and self._change.override is not None:
            given += [Command(name, "set_override", {"percent": self._change.override}) for name in self._old.channels]
        end = cycle + self._old.block_cycles
        for entry in self._change.commands:
            if max(cycle, self.begin) <= round(entry.at / self._cycle_time) < end:
                given.append(entry.command)
        return given

    def _is_other_load(self, record: CommandRecord) -> bool:
        return record.command == "load" and record.target == self.replaced

    def _is_other_override(self, record: CommandRecord) -> bool:
        change = self._change.override
        return change is not None and record.command == "set_override" and record.target in self._old.channels

    def _note_refused(self, given: Sequence[Given], records: Sequence[CommandRecord], outputs: Outputs) -> None:
        """`records`: of what was given in a block. The others of its outputs are of commands that units have given."""
        for each, record in zip(given, records, strict=True):
            if not record.accepted and each.recorded is None:
                self.refused_of_change.append(record)
            elif not record.accepted and each.recorded is not None and each.recorded.accepted:
                self.refused_of_recording.append(record)
        known = {id(record) for record in records}
        of_units = (record for output in outputs.values() for record in output.records if id(record) not in known)
        refused = (record for record in of_units if not record.accepted)
        self.refused_of_recording += [record for record in refused if content_of(record) not in self._refused_before]


class Given(NamedTuple):
    """A command from outside, and its record in the recording; None where the change has given it."""

    command: Command
    recorded: CommandRecord | None = None


def content_of(record: CommandRecord) -> tuple[int, str, str, str]:
    """What makes a command of one unit to another the same one."""
    return record.cycle, record.target, record.command, record.arguments_json


def state_of(block: CycleBlock) -> ChannelStateCode:
    """Of a channel, at the end of its block."""
    assert isinstance(block, ChannelBlock)
    return ChannelStateCode(block.state[-1])


def is_at_rest(block: CycleBlock) -> bool:
    """A channel that takes another program."""
    return state_of(block) in (ChannelStateCode.IDLE, ChannelStateCode.READY)


def is_in_program(block: CycleBlock) -> bool:
    """A channel whose program has not ended."""
    return isinstance(block, ChannelBlock) and state_of(block) in IN_PROGRAM
