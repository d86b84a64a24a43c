"""Runs one unit in any harness: applies the commands of a block, watches the PLC's life sign, computes the block."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cnc_ptp.errors import CncError
from cnc_ptp.machine.silence import Silence
from cnc_ptp.parameters.view.authority import OF_CHANNELS, OF_PLC
from cnc_ptp.protocol.authority import closed_to
from cnc_ptp.protocol.axis_states import AxisStateCode, state_name
from cnc_ptp.protocol.blocks import (
    ChannelBlock,
    Command,
    CommandAnswer,
    CommandRecord,
    CycleBlock,
    CycleTick,
    PlcBlock,
    Severity,
)
from cnc_ptp.protocol.channel_states import ChannelStateCode
from cnc_ptp.protocol.unit import CLOCK, PLC, Unit


class UnitRunner:
    """A unit with the cycle number at which the next command would act."""

    def __init__(self, unit: Unit, *, watchdog_cycles: int, closed: tuple[str, ...] = ()) -> None:
        """`watchdog_cycles`: a life sign of the PLC that does not change for that long is lost. `closed`: sources
        (parameters/view/authority.py) that do not command the unit."""
        self.unit = unit
        self._closed = closed
        self.next_cycle = 0
        self._answers: list[CommandAnswer] = []
        self._life_sign = -1
        self._silence = Silence(watchdog_cycles - 1)
        self._state: int | None = None

    def command(self, command: Command) -> CommandRecord:
        """A command from a service or a watchdog; acts at the first cycle of the next block."""
        return self.unit.command(command, self.next_cycle)

    def asked(self, command: Command, source: str) -> CommandRecord:
        """As `command`, if `source` may command the unit."""
        error = self.objection(command, source)
        return self.command(command) if error is None else self.refuse(command, error)

    def objection(self, command: Command, source: str) -> CncError | None:
        """Why the unit does not take a command from `source`; None if it does."""
        unit = self.unit
        return closed_to(unit.kind, unit.name, command.command, command.arguments, source=source, closed=self._closed)

    def refuse_again(self, record: CommandRecord) -> None:
        """A command of a recording that did not reach the unit, and does not now."""
        self.unit.records.append(record)
        self.unit.report(record.cycle, Severity.WARNING, record.error_id, record.message, record.values)

    def refuse(self, command: Command, error: CncError) -> CommandRecord:
        """The record of a command that does not reach the unit, for the reason of `error`; recorded like all others."""
        unit, cycle = self.unit, self.next_cycle
        text = f"{unit.kind} {unit.name}: {command.command} refused: {error.reason}; nothing was changed"
        record = CommandRecord(
            cycle,
            unit.name,
            command.command,
            command.arguments_json,
            False,
            error.number,
            text,
            id=command.id,
            values=error.values,
        )
        unit.records.append(record)
        unit.report(cycle, Severity.WARNING, error.number, text, error.values)
        return record

    def run(self, tick: CycleTick, inputs: Mapping[str, CycleBlock]) -> CycleBlock:
        """Applies the commands that `inputs` carry to this unit, then computes the block."""
        self.apply(tick, inputs)
        return self.compute(tick, inputs)

    @property
    def master(self) -> str | None:
        """The axis or spindle whose block of the same tick `compute` needs besides; known after the commands."""
        return None if self.unit.master in self.unit.lost else self.unit.master

    def apply(self, tick: CycleTick, inputs: Mapping[str, CycleBlock]) -> None:
        """Applies the commands that `inputs` carry for this unit."""
        self.next_cycle = tick.first_cycle
        for sender, command in commands_for(self.unit.name, inputs):
            record = self.asked(command, OF_PLC if sender == PLC else OF_CHANNELS)
            if sender == PLC:
                answer = (command.id, record.error_id, record.job, record.message, record.values_json)
                self._answers.append(CommandAnswer(*answer))
        self._watch_life_sign(tick, inputs)

    def compute(self, tick: CycleTick, inputs: Mapping[str, CycleBlock]) -> CycleBlock:
        """Computes the block; all commands for it have been given.

        Lost sources stay lost; a unit without a clock is alone.
        """
        if self.unit.lost:
            alone = CLOCK in self.unit.lost
            inputs = {name: block for name, block in inputs.items() if not alone and name not in self.unit.lost}
        block = self.unit.step(tick, inputs)
        self.next_cycle = tick.first_cycle + tick.count
        self._tell_plc(block)
        self._note_state(block)
        return block

    def _tell_plc(self, block: CycleBlock) -> None:
        """Answers to the commands of the PLC, and what has become of jobs."""
        if isinstance(block, PlcBlock):
            return
        self.unit.note_jobs(block)
        self.unit.show_held(block)
        block.job, block.job_events = self.unit.jobs.active, self.unit.jobs.take_events()
        block.answers, self._answers = self._answers, []
        block.control_units = self.unit.overlay.news()

    def _note_state(self, block: CycleBlock) -> None:
        """An event when the unit ends the block in another state than the previous block."""
        if isinstance(block, PlcBlock) or block.state[-1] == self._state:
            return
        codes = ChannelStateCode if isinstance(block, ChannelBlock) else AxisStateCode
        before, self._state = self._state, block.state[-1]
        if before is None:
            return
        index = next(index for index, state in enumerate(block.state) if state == self._state)
        text = f"{self.unit.name}: {state_name(codes(before))} -> {state_name(codes(self._state))}"
        line = block.line[index] if isinstance(block, ChannelBlock) else 0
        self.unit.event(block.first_cycle + index, Severity.INFO, 0, text, line)

    def _watch_life_sign(self, tick: CycleTick, inputs: Mapping[str, CycleBlock]) -> None:
        plc = inputs.get(PLC)
        if not isinstance(plc, PlcBlock):
            return
        if plc.life_sign != self._life_sign:
            self._life_sign = plc.life_sign
            self._silence.heard(PLC, tick.first_cycle)
        elif self._silence.fallen_silent(tick.first_cycle):
            self.unit.command(Command(self.unit.name, "upstream_lost", {"source": PLC}), tick.first_cycle)


def commands_for(name: str, inputs: Mapping[str, CycleBlock]) -> Iterator[tuple[str, Command]]:
    """Sender and command for unit `name` that travel in the blocks of this tick, in the order of sender and sending."""
    for sender, block in inputs.items():
        if isinstance(block, (PlcBlock, ChannelBlock)):
            for command in block.commands:
                if command.target == name:
                    yield sender, command
