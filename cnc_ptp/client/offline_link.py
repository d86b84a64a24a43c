"""An offline machine under the hands of a client: it runs only while the client waits, as fast as possible."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from cnc_ptp.axis.external_commands import SETPOINTS
from cnc_ptp.axis.jog_commands import JOG
from cnc_ptp.channel.channel_unit import ChannelUnit
from cnc_ptp.client.faults import GONE
from cnc_ptp.client.link import Link, Reply, reply_of
from cnc_ptp.client.observations import Observations
from cnc_ptp.errors import CncError
from cnc_ptp.interrupt import HeldSignals
from cnc_ptp.machine.command_files import with_program
from cnc_ptp.machine.offline import STUCK_TIME
from cnc_ptp.machine.plc_file import read_plc
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import build_units, unit_kinds
from cnc_ptp.nodes.unit.requests import RUN_OVER
from cnc_ptp.parameters import ParameterError, ParameterSet, machine_text, read_machine
from cnc_ptp.parameters.view.authority import OF_SERVICES, OF_TOPICS
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.protocol.authority import require_axes_open
from cnc_ptp.protocol.blocks import Command, CommandRecord, PlcBlock
from cnc_ptp.protocol.commands import BAD_ARGUMENT, NEEDS_SOMETHING, THROUGH_PLC
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.offline_run import OfflineRun
from cnc_ptp.recording.on_demand import Answer
from cnc_ptp.recording.overwriting import check_recording
from cnc_ptp.recording.recorder_options import FROM_THE_START, RecorderOptions, check_recorder
from cnc_ptp.recording.trigger import Condition

STOP_TIME = 15.0
"""Seconds of machine time for all ramps at the end."""


class OfflineLink(Link):
    """Commands act at the first cycle of the next block, as those of services do; the first block is computed."""

    clock = " of machine time"

    def __init__(
        self,
        machine: str,
        *,
        record: str | None = None,
        recorder: RecorderOptions | None = None,
        scenario: str | None = None,
        plc: str | None = None,
    ) -> None:
        """Raises as Machine.offline."""
        check_recording(record, machine_file=machine, scenario=scenario, PLC_file=plc)
        try:
            self._parameters = read_machine(machine)
        except ParameterError as error:
            raise error.meaning("nothing was started") from None
        self.kinds = unit_kinds(self._parameters)
        self.seen = Observations(self.kinds)
        self.cycle_time = self._parameters.cycle_time_us * 1e-6
        entries = read_entries(self._parameters, program=None, scenario=scenario) if scenario is not None else ()
        plc_file = None if plc is None else read_plc(plc)
        self._units = build_units(self._parameters, scenario=entries, end_when_idle=False, plc_file=plc_file)
        self.has_recorder = recorder is not None or record is not None
        options = replace(recorder or FROM_THE_START, scenario=scenario, plc=plc)
        self._run = self._offline_run(machine, record, options)
        self._tickets = 0
        self._replies: dict[int, Reply] = {}
        self._asked: dict[int, Command] = {}
        """Commands that have gone to the PLC, by ticket."""
        self._moved_at = 0.0
        self._waits = ""
        self._turns: list[asyncio.Future[None]] = []
        self._has_ended = False
        self._step()

    def _offline_run(self, machine: str, record: str | None, recorder: RecorderOptions) -> OfflineRun:
        check_recorder(recorder, record, self.kinds)
        recorder.require_places(None)
        return OfflineRun(
            self._parameters,
            self._units,
            record=record,
            machine_text=machine_text(machine),
            condition=None if recorder.when is None else Condition(recorder.when, self.kinds),
            settings=recorder.settings(),
            snapshots=recorder.snapshots_of(self.kinds) if self.has_recorder else None,
        )

    @property
    def now(self) -> float:
        return self._run.machine.next_cycle * self.cycle_time

    @property
    def stalled(self) -> str | None:
        if self.now - self._moved_at < STUCK_TIME:
            return None
        return f"nothing has moved for {STUCK_TIME:g} s of machine time{self._waits}, and nothing will"

    # commands

    def give(self, unit: str, command: str, arguments: Mapping[str, Any]) -> int:
        self._moved_at = self.now
        self._tickets += 1
        asked = Command(unit, command, dict(arguments))
        if self.kinds[unit] != "axis" or command not in THROUGH_PLC:
            self._replies[self._tickets] = reply_of(self._carried_out(asked))
        elif error := self._run.machine.runner(unit).objection(asked, OF_SERVICES):
            self._replies[self._tickets] = Reply(self._run.machine.next_cycle, error.number, error.message, {}, 0)
        elif command == SETPOINTS:
            self._replies[self._tickets] = self._take_setpoints(asked)
        else:
            self._plc.input(asked)
            self._asked[self._tickets] = asked
        return self._tickets

    def give_recorder(self, command: str, arguments: Mapping[str, Any]) -> int:
        """Everything has come up to now, so that it is carried out at once."""
        self._tickets += 1
        answers: list[Answer] = []
        try:
            self._tell_recorder(command, arguments, answers)
        except CncError as error:
            answers.append(Answer(error=error))
        self._replies[self._tickets] = reply_of_recorder(answers[0])
        return self._tickets

    def _tell_recorder(self, command: str, arguments: Mapping[str, Any], answers: list[Answer]) -> None:
        recorder = self._run.recorder
        assert recorder is not None
        if command == "start":
            answers.append(recorder.start(arguments["file"]))
        elif command == "stop":
            recorder.stop(answers.append)
        else:
            seconds, until = (arguments.get(name, 0.0) for name in ("seconds", "until"))
            recorder.snapshot(arguments["file"], seconds, until, answers.append)
        recorder.settle(self.now)
        self._take_events_of_recorder()

    def answer(self, ticket: int) -> Reply | None:
        return self._replies.pop(ticket, None)

    def parameters_of(self, unit: str) -> ParameterSet:
        return self._parameters.sets["machine" if unit == PLC else unit]

    @property
    def _plc(self) -> PlcUnit:
        plc = self._units[PLC]
        assert isinstance(plc, PlcUnit)
        return plc

    def _carried_out(self, asked: Command) -> CommandRecord:
        """By the unit itself, or refused on the way to it, as a node does."""
        runner = self._run.machine.runner(asked.target)
        if self._has_ended:
            return runner.refuse(asked, CncError(RUN_OVER, "the run has ended"))
        if asked.command in NEEDS_SOMETHING and not asked.arguments:
            reason = f"nothing is given; {NEEDS_SOMETHING[asked.command]}"
            return runner.refuse(asked, CncError(BAD_ARGUMENT, reason))
        try:
            require_axes_open(asked, self._parameters.closed, OF_SERVICES)
            asked = with_program(asked, self._parameters, self._loaded(asked.target))
        except CncError as error:
            return runner.refuse(asked, error)
        return runner.asked(asked, OF_TOPICS if asked.command == JOG else OF_SERVICES)

    def _loaded(self, unit: str) -> dict[str, str]:
        channel = self._units[unit]
        return {unit: channel.program_view.program} if isinstance(channel, ChannelUnit) else {}

    def _take_setpoints(self, asked: Command) -> Reply:
        cycle = self._run.machine.next_cycle
        try:
            self._plc.give_setpoints(asked.target, asked.arguments["setpoints"], cycle)
        except CncError as error:
            return Reply(cycle, error.number, error.message, error.values, 0)
        return Reply(cycle, 0, "", {}, 0)

    # time

    def turn(self, timeout: float) -> None:
        """A block, whatever the time is: blocks are whole."""
        if self._has_ended:
            raise CncError(GONE, "the machine has ended: its run has ended", "its units stand")
        self._step()

    async def turn_async(self, timeout: float) -> None:
        """One block for all that wait at the moment."""
        loop = asyncio.get_running_loop()
        if not self._turns:
            loop.call_soon(self._step_for_all)
        mine: asyncio.Future[None] = loop.create_future()
        self._turns.append(mine)
        await mine

    def _step_for_all(self) -> None:
        waiting, self._turns = self._turns, []
        try:
            self.turn(0.0)
        except Exception as error:  # whatever it is, those that wait get it
            for each in waiting:
                if not each.done():
                    each.set_exception(error)
            return
        for each in waiting:
            if not each.done():
                each.set_result(None)

    def waiting(self) -> HeldSignals:
        return HeldSignals()

    def _step(self) -> None:
        outputs = self._run.step()
        self._take_events_of_recorder()
        for name, output in outputs.items():
            for event in output.events:
                self.seen.take_event(event)
            self.seen.take_block(name, output.block)
            for record in output.records:
                self.seen.take_record(record)
            if self._asked:
                self._take_answers(output.records)
        plc = outputs[PLC].block
        self._has_ended = isinstance(plc, PlcBlock) and plc.run_done
        waits = self._run.machine.waits(outputs)
        if waits is None:
            self._moved_at = self.now
        else:
            self._waits = f" ({'; '.join(waits)})" if waits else ""

    def _take_answers(self, records: list[CommandRecord]) -> None:
        """The records of what has gone to the PLC."""
        for record in records:
            for ticket, asked in [*self._asked.items()]:
                if asked.id and (asked.id, asked.target, asked.command) == (record.id, record.target, record.command):
                    self._replies[ticket] = reply_of(record)
                    del self._asked[ticket]

    # the end

    def close(self) -> None:
        """Everything stops on its ramps; the recording ends with the standstill."""
        try:
            if not self._has_ended:
                self._run.machine.stop()
            end = self.now + STOP_TIME
            while self.now < end and not self._has_ended:
                self._step()
        finally:
            self._run.close()
            self._take_events_of_recorder()
        if self._run.recorder is not None and self._run.recorder.failure is not None:
            raise self._run.recorder.failure

    def _take_events_of_recorder(self) -> None:
        events, self._run.events = self._run.events, []
        for event in events:
            self.seen.take_event(event)


def reply_of_recorder(answer: Answer) -> Reply:
    if answer.error is None:
        return Reply(answer.cycle, 0, answer.warning, {}, 0)
    return Reply(answer.cycle, answer.error.number, answer.error.message, answer.error.values, 0)
