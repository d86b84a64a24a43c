"""A recorded run computed again with something changed: parameters, overrides, the program, further commands.

Up to the time of the change all is as recorded, from the newest checkpoint on; from then on the change counts. Commands
of the recording come at their cycles, whatever the changed run does.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from cnc_ptp.errors import CncError
from cnc_ptp.machine.offline import OfflineMachine, Outputs
from cnc_ptp.parameters import load_machine
from cnc_ptp.parameters.changed import changed_text, read_changes
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import ChannelBlock, Command, CommandRecord, CycleBlock
from cnc_ptp.protocol.channel_states import IN_PROGRAM, ChannelStateCode
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.checkpoints import state_before
from cnc_ptp.recording.computed_again import by_unit, commands_by_cycle, computed_again, fresh_machine, refused_again
from cnc_ptp.recording.recorded_answers import DelayedAnswers, RecordedAnswers
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.state.other_parameters import change_parameters

TIME_OUTSIDE: Final = 26154
NO_LOAD: Final = 26157
NOTHING: Final = "nothing was computed"


@dataclass(frozen=True)
class Change:
    """What is to be different from `begin` (s) on; the run is followed to `end` (s), None: as long as it was recorded.

    parameters  unit.parameter=value
    override    of all channels, percent; recorded ones no longer count
    program     arguments of the command `load`: in place of the recorded ones, or of the program that runs at `begin`
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
        """`recorded` stays open as long as it runs. Raises ParameterError, CncError 26153, 26154, 26155, 26157."""
        self._recorded, self._change = recorded, change
        self._old = recorded.required_machine()
        self.machine_text = recorded.machine_yaml
        self.machine = self._old
        if change.parameters:
            changes = read_changes(change.parameters, self._old)
            self.machine_text = changed_text(recorded.machine_yaml, changes)
            self.machine = load_machine(recorded.machine_yaml, f"{recorded.path}:machine.yaml", changes=changes)
        self._cycle_time = self._old.cycle_time_us * 1e-6
        self.begin = self._block_at(change.begin)
        self.end = recorded.end if change.end is None else self._end_at(change.end)
        self._commands = commands_by_cycle(recorded.commands, self._old)
        self._to_replace = self._channels_to_replace()
        self.not_replaced = ""
        """Why the other program has not come in; empty if it has, if it was refused, or if there is none."""
        self.note = ""
        self.running: list[str] = []
        """Channels whose program has not ended so far."""
        self.given: set[tuple[int, str, str]] = set()
        """Cycle, unit and name of the commands that the change has given."""
        self._answers = RecordedAnswers(recorded, self.begin, self._old.block_cycles)

    def run(self) -> Iterator[Outputs]:
        """All blocks from `begin` on. Raises CncError 26156 for parameters that make other parts of a unit."""
        machine = self._at_begin()
        if self.machine is not self._old:
            runners, blocks = machine.parts
            change_parameters(runners, self._old, self.machine)
            changed = fresh_machine(self.machine)
            changed.go_on_from(machine.next_cycle, runners, blocks)
            machine = changed
        replacement = self._replacement(machine.parts[1])
        replacing = next(replacement)
        while machine.next_cycle < self.end:
            own = [*self._own_commands(machine.next_cycle), *replacing]
            self.given |= {(machine.next_cycle, command.target, command.command) for command in own}
            outputs = machine.changed_tick(by_unit([*self._recorded_commands(machine), *own]))
            replacing = replacement.send(outputs)
            self.running = [name for name, output in outputs.items() if is_in_program(output.block)]
            yield outputs

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
        if not begin <= seconds <= duration:
            reason = f"--from {seconds:g} is not within the recorded time {begin:g} ... {duration:g} s"
            raise CncError(TIME_OUTSIDE, reason, NOTHING, value=seconds, limit=duration)
        count = self._old.block_cycles
        return round(seconds / self._cycle_time) // count * count

    def _channels_to_replace(self) -> list[str]:
        """Those for which a program was loaded, where none is loaded after `begin`. Raises CncError 26157."""
        if self._change.program is None:
            return []
        loads = self._taken("load")
        if not loads:
            raise CncError(NO_LOAD, "--program takes the place of a program, and none is loaded", NOTHING)
        late = any(record.cycle >= self.begin for record in loads)
        return [] if late else [*dict.fromkeys(record.target for record in loads)]

    def _taken(self, command: str) -> list[CommandRecord]:
        """The recorded commands of this name that were not refused."""
        records = [record for records in self._commands.values() for record in records]
        return [record for record in records if record.command == command and record.accepted]

    def _replacement(self, blocks: Mapping[str, CycleBlock]) -> Generator[list[Command], Outputs, None]:
        """Reset, when the path stands load, and start if that was taken: the commands of each block, without an end.

        The first channel that is not at rest gets the program, or the first one; of a channel at rest that is started
        by the recording later on it is only loaded. `blocks`: the newest of all units; then the outputs are sent.
        """
        if self._to_replace:
            active = [name for name in self._to_replace if name in blocks and not is_at_rest(blocks[name])]
            channel = [*active, *self._to_replace][0]
            if active:
                outputs = yield [Command(channel, "reset")]
                while not is_at_rest(block := outputs[channel].block):
                    self.not_replaced = f"the program is not loaded: {channel} is in state {state_of(block).name}"
                    outputs = yield []
            self.not_replaced = ""
            outputs = yield [Command(channel, "load", dict(self._change.program or {}))]
            loaded = all(record.accepted for record in outputs[channel].records if record.command == "load")
            is_started_later = any(each.target == channel and each.cycle >= self.begin for each in self._taken("start"))
            if loaded and (active or not is_started_later):
                yield [Command(channel, "start")]
        while True:
            yield []

    def _at_begin(self) -> OfflineMachine:
        """The machine as it was recorded before `begin`, with a PLC that answers as the recorded one did."""
        machine = fresh_machine(self._old)
        if self.begin:  # at 0 there is nothing to be restored
            state, why = state_before(self._recorded, self._old, self.begin)
            if state is None:
                self.note = f"computed from 0 s: {why}"
            else:
                machine.go_on_from(*state)
                self.note = f"computed from the checkpoint at {state.next_cycle * self._cycle_time:g} s"
        deque(computed_again(machine, self._commands, self.begin), maxlen=0)
        plc = machine.runner(PLC).unit
        assert isinstance(plc, PlcUnit)
        plc.do_auto_acknowledge(self.begin, enabled=False)
        plc.outside.append(DelayedAnswers(self._answers))
        return machine

    def _recorded_commands(self, machine: OfflineMachine) -> list[Command]:
        records = refused_again(machine, self._commands.get(machine.next_cycle, ()))
        return [command for record in records if (command := self._changed(record)) is not None]

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

    def _changed(self, record: CommandRecord) -> Command | None:
        change, command = self._change, Command.from_record(record)
        if self._answers.gives(record):
            return None
        if change.override is not None and command.command == "set_override" and command.target in self._old.channels:
            return None
        if change.program is not None and command.command == "load":
            if record.accepted:
                self.given.add((record.cycle, command.target, "load"))
            return Command(command.target, "load", dict(change.program), command.id)
        return command


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
