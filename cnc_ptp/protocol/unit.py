"""The base of all units: commands are checked, carried out or refused as a whole, and recorded; events collected."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any, ClassVar, NamedTuple

from cnc_ptp.errors import CncError, Value, WarningText, joined_warnings, nearest_name, warning_text
from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.blocks import (
    AxisBlock,
    Command,
    CommandRecord,
    CycleBlock,
    CycleTick,
    Event,
    EventValue,
    Severity,
    SpindleBlock,
    json_of,
)
from cnc_ptp.protocol.commands import BAD_ARGUMENT, HELD_OFF, OF_PLC, check_command, current_names, with_floats
from cnc_ptp.protocol.control_units import PERCENT, ControlUnit
from cnc_ptp.protocol.event_values import event_values
from cnc_ptp.protocol.jobs import JOBS, Jobs
from cnc_ptp.protocol.overlay import HELD_BY_PLC, SERVED_BY_PLC, TAKEN_FROM_PLC, Overlay


class Answer(NamedTuple):
    """What a command was to find out, as text and by name."""

    text: str
    values: Mapping[str, Value]


Handler = Callable[..., str | Answer | None]

PLC = "plc"
"""Name of the PLC, as a unit and as the source of commands."""
CLOCK = "clock"
"""Name of what sends the ticks."""
UPSTREAM_LOST = 26101
"""A unit that is needed has sent nothing within the watchdog time."""
EMERGENCY_STOP = 26168
"""Error of a unit in an emergency stop."""
EMERGENCY_HOLDS = 26169
"""Refusal: the emergency stop has to be released first."""
STOP_HOLDS = 22165
"""Refusal: MC_Stop holds the unit while its execute is true."""
THE_PLC, A_CLIENT = "the PLC", "a client"
"""Who may hold a stop: what commands in blocks, and by services."""


class Unit(ABC):
    """A channel, axis, spindle or the PLC: changed by commands only, advanced by `step` block by block.

    A handler `do_<command>(cycle, **arguments)` validates first and raises CncError to refuse; a text that it returns
    is a warning that goes into the record, an Answer is what it was to find out. Nothing here knows processes, topics
    or clocks.
    """

    kind: ClassVar[str]
    length_unit = "mm"
    """Of its positions: mm or deg."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.events: list[Event] = []
        """Events since the last block; the harness takes them away."""
        self.records: list[CommandRecord] = []
        """Commands carried out or refused since the last block; the harness takes them away."""
        self.jobs = Jobs()
        """Its motions and programs, by number."""
        self.overlay = Overlay(self.kind)
        """Its control units of the HLI."""
        self.check_override: Callable[[str, float], None] = any_override
        """Raises CncError for an override (percent) that the unit does not have; the command that asks for it."""
        self.sources: Collection[str] = ()
        """Who may command a spindle; without them every name is accepted."""
        self._stop_holders: set[str] = set()
        self._given_by = A_CLIENT
        """Who gives the command that is carried out now."""
        self.lost: set[str] = set()
        """Sources that a watchdog has found lost; their blocks no longer count, even if they come."""

    @abstractmethod
    def step(self, tick: CycleTick, inputs: Mapping[str, CycleBlock]) -> CycleBlock:
        """Computes the cycles of `tick`.

        `inputs`: by unit name, blocks of the same cycles from upstream units and of the cycles before from units that
        only report back; a unit that is lost or has not computed yet is missing.
        """

    def command(self, command: Command, cycle: int) -> CommandRecord:
        """Carries out or refuses a command that takes effect at `cycle`, the first cycle of the next block."""
        refusal, job = None, 0
        try:
            carried_out = self._dispatch(command, cycle)
            if carried_out.command in JOBS[self.kind]:
                job = self.begin_job(carried_out, cycle)
        except CncError as error:
            refusal = error
            self.report(cycle, Severity.WARNING, error.number, error.full_message, error.values)
        shown = {name: value for name, value in command.arguments.items() if name not in OF_PLC}
        record = CommandRecord(
            cycle,
            self.name,
            command.command,
            shown if "text" in shown else json_of(shown),
            accepted=refusal is None,
            error_id=refusal.number if refusal else 0,
            message=refusal.full_message if refusal else self._warning,
            id=command.id,
            values=refusal.values if refusal else self._values,
            job=job,
            warning_id=0 if refusal else self._warning_id,
        )
        self.records.append(record)
        return record

    _warning = ""
    _warning_id = 0
    _values: Mapping[str, Value] = {}

    def begin_job(self, command: Command, cycle: int) -> int:
        """A command that is a job was carried out: the number of the job, 0 if there was nothing to do."""
        return self.jobs.begin(cycle)

    def note_jobs(self, block: CycleBlock) -> None:
        """Ends the active job when its unit has come to rest in a new block."""
        self.jobs.watch(block)

    def _dispatch(self, command: Command, cycle: int) -> Command:
        """Returns the command that was carried out: an edge of the PLC stands for another one."""
        self._warning, self._warning_id, self._values, name = "", 0, {}, command.command
        arguments = current_names(self.kind, name, command.arguments)
        check_command(self.kind, self.name, name, arguments, self.sources)
        arguments = with_floats(self.kind, name, arguments)
        if name == "overlay":
            return self._do_overlay(command, cycle, **arguments)
        self._given_by = THE_PLC if command.id else A_CLIENT
        self._refuse_held(name, arguments)
        self._refuse_edge(name, by_client=not command.id)
        requests = self.requested(name, arguments)
        self._note(self._ask(name, requests, cycle) if requests else self.handler(name)(cycle, **arguments))
        self._release_clients(name)
        if name == "upstream_lost":
            self.lost.add(arguments["source"])
            if arguments["source"] == PLC:
                self._stop_holders.discard(THE_PLC)
        return command

    def _note(self, answer: str | Answer | None) -> None:
        """What a handler has returned goes into the record."""
        if isinstance(answer, Answer):
            self._warning, self._values = answer
            return
        self._warning = str(answer or "")
        if isinstance(answer, WarningText):
            self._warning_id, self._values = answer.number, answer.values

    # a stop that is held

    @property
    def stop_held(self) -> bool:
        """Nothing moves the unit until `hold_stop` is off (PLCopen: Stopping until Done and not Execute)."""
        return bool(self._stop_holders)

    def do_hold_stop(self, cycle: int, *, enabled: bool) -> None:
        """Holds the unit at its standstill, or no longer: the PLC and clients each their own hold."""
        (self._stop_holders.add if enabled else self._stop_holders.discard)(self._given_by)

    def _release_clients(self, command: str) -> None:
        """A reset, whoever gives it, ends the hold of clients: one that was killed cannot end its own."""
        if command == "reset" and A_CLIENT in self._stop_holders:
            self._stop_holders.discard(A_CLIENT)
            text = f"{self.kind} {self.name}: reset ends MC_Stop of {A_CLIENT} (hold_stop)"
            self._warning = "; ".join(filter(None, [self._warning, text]))

    def is_held_off(self, command: str, arguments: Mapping[str, Any]) -> bool:
        """The command would move the unit, which a held stop does not permit."""
        return command in HELD_OFF[self.kind]

    def _refuse_held(self, command: str, arguments: Mapping[str, Any]) -> None:
        if self._stop_holders and self.is_held_off(command, arguments):
            holders = " and ".join(sorted(self._stop_holders, reverse=True))
            reason = f"MC_Stop of {holders} holds the {self.kind} while its execute is true (hold_stop)"
            raise self._refusal(command, STOP_HOLDS, reason)

    def show_held(self, block: CycleBlock) -> None:
        """A unit that is held at its standstill reports Stopping; called when its jobs have been noted."""
        if self._stop_holders and isinstance(block, (AxisBlock, SpindleBlock)):
            rest, stopping = int(AxisStateCode.STANDSTILL), int(AxisStateCode.STOPPING)
            block.state = [stopping if state == rest else state for state in block.state]

    # control units of the HLI

    def requested(self, command: str, arguments: Mapping[str, Any]) -> dict[str, float]:
        """The control units that a command of others concerns, with the values it asks for; checked (CncError)."""
        requests = self.overlay.asked(command, arguments)
        if "override" in requests:
            self.check_override(command, requests["override"])
        return requests

    def carry_out(self, command: str, cycle: int) -> str | None:
        """What acts now of the control units that a command is made of; the warning, if any."""
        answer = self.handler(command)(cycle, **self.overlay.arguments(command))
        return answer.text if isinstance(answer, Answer) else answer

    def _ask(self, command: str, requests: Mapping[str, float], cycle: int) -> str | None:
        """A command of others: it acts where the PLC serves nothing of it, and is remembered elsewhere.

        What a PLC that has fallen silent had served is taken back from it.
        """
        overlay = self.overlay
        taken = [(name, overlay.give_back(name)) for name in overlay.taken_back(requests)]
        before = overlay.ask(requests)
        held = [name for name in requests if overlay.holder(name) is not None and not overlay[name].either]
        message: str | None = None
        if len(held) < len(requests):
            try:
                message = self.carry_out(overlay[next(iter(requests))].command, cycle)
            except CncError:
                overlay.ask(before)
                for name, kept in taken:
                    overlay.restore(name, kept)
                raise
        notes = [*(self._takes(command, name, *kept) for name, kept in taken), *(self._waits(command, n) for n in held)]
        return joined_warnings(message, *notes)

    def _takes(self, command: str, name: str, value: float | None, holder: str, silent: bool) -> str:
        reason = f"the PLC '{holder}', which had commanded {value:g} and is silent"
        text = f"{self.kind} {self.name}: {command} takes {name} back from {reason}"
        return warning_text(TAKEN_FROM_PLC, text, value=value or 0.0)

    def _waits(self, command: str, name: str) -> str:
        served = f"the PLC '{self.overlay.holder(name)}' serves {name} and commands {self.overlay.value(name):g}"
        until = f"when it gives {name} back"
        if self.overlay.is_silent(name):
            until += ", or another PLC serves it: it is silent, and only a PLC takes back what holds back"
        text = f"{self.kind} {self.name}: {command} waits: {served}; what is asked for acts {until}"
        return warning_text(HELD_BY_PLC, text, value=self.overlay.value(name) or 0.0)

    def _refuse_edge(self, command: str, *, by_client: bool) -> None:
        """Only the PLC carries out an edge that it serves; and nothing is reset before an emergency stop is released.

        What comes in blocks is not refused: the machine's own PLC stops everything at the end, by a reset.
        """
        served = self.overlay.served_edge(command) if by_client else None
        if served is not None:
            self.overlay.note_request(command)
            holder = self.overlay.holder(command)
            reason = f"the PLC '{holder}' serves {command}; it is shown what was asked for"
            raise self._refusal(command, SERVED_BY_PLC, reason)
        self._refuse_in_emergency(command)

    def _refuse_in_emergency(self, command: str) -> None:
        if command == "reset" and self.overlay.value("emergency_stop"):
            raise self._refusal(command, EMERGENCY_HOLDS, "the emergency stop holds; release it first")

    def _refusal(
        self, command: str, number: int, reason: str, effect: str = "nothing was changed", /, **values: Value
    ) -> CncError:
        return CncError(number, reason, effect, where=f"{self.kind} {self.name}: {command} refused", **values)

    def _do_overlay(
        self,
        command: Command,
        cycle: int,
        *,
        control_unit: str,
        enabled: bool,
        value: float | None = None,
        holder: str = "",
        silent: bool = False,
    ) -> Command:
        """The PLC serves a control unit with a value, or gives it back; an edge with the value 1 is carried out."""
        if control_unit not in self.overlay:
            near = nearest_name(control_unit, self.overlay.names)
            effect = f"nothing was changed. Known: {', '.join(self.overlay.names)}"
            raise self._refusal("overlay", BAD_ARGUMENT, f"unknown control unit '{control_unit}'{near}", effect)
        unit = self.overlay[control_unit]
        if enabled:
            value = self._checked(unit, value)
        if unit.edge:
            return self._edge(unit, command, cycle, enabled=enabled, rises=bool(enabled and value), holder=holder)
        before = self.overlay.arguments(unit.command)
        if enabled:
            kept = self.overlay.serve(unit.name, value or 0.0, holder, silent=silent)
        else:
            kept = self.overlay.give_back(unit.name)
        if self.overlay.arguments(unit.command) != before:
            try:
                self._note(self.carry_out(unit.command, cycle))
            except CncError:
                self.overlay.restore(unit.name, kept)
                raise
        return command

    def _checked(self, unit: ControlUnit, value: float | None) -> float:
        """The value that the PLC commands. Raises 22001, and what the unit refuses it with."""
        if value is None:
            raise self._refusal("overlay", BAD_ARGUMENT, "argument 'value' is missing")
        if unit.value == PERCENT:
            self.check_override("overlay", value)
        elif not (0.0 <= value <= unit.largest and value == value // 1.0):
            whole = f"value = {value:g} of {unit.name} is not a whole number within 0 ... {unit.largest:g}"
            raise self._refusal("overlay", BAD_ARGUMENT, whole, value=value, limit=unit.largest)
        return value

    def _edge(
        self, unit: ControlUnit, command: Command, cycle: int, *, enabled: bool, rises: bool, holder: str
    ) -> Command:
        if rises:
            self._refuse_in_emergency(unit.command)
            self._note(self.handler(unit.command)(cycle))
            self._release_clients(unit.command)
            self.overlay.carried_out(unit.name)
            command = Command(self.name, unit.command)
        if enabled:
            self.overlay.serve(unit.name, 0.0, holder)
        else:
            self.overlay.give_back(unit.name)
        return command

    @property
    def master(self) -> str | None:
        """The unit whose block of the same cycles `step` needs too; known after the commands for these cycles."""
        return None

    @property
    def led(self) -> bool:
        """A channel or a master moves this unit and knows what there is to wait for."""
        return False

    def waits_for(self) -> str:
        """What the unit waits for that does not come with time alone; empty while it continues or has nothing to do."""
        return ""

    def lag_share(self, block: CycleBlock) -> float:
        """Following error at the end of a block just computed as a part of its limit; 0 while nothing limits it."""
        return 0.0

    def handler(self, command: str) -> Handler:
        """What carries out a command that this kind of unit knows."""
        handler: Handler = getattr(self, f"do_{command}")
        return handler

    def event(
        self, cycle: int, severity: int, error_id: int, text: str, line: int = 0, values: Iterable[EventValue] = ()
    ) -> None:
        self.events.append(Event(cycle, self.name, severity, error_id, text, line, list(values)))

    def report(
        self, cycle: int, severity: int, error_id: int, text: str, values: Mapping[str, Value], line: int = 0
    ) -> None:
        """An event with the numbers of its text by name (protocol/event_values.py)."""
        self.event(cycle, severity, error_id, text, line, event_values(values, self.length_unit))

    def take_events(self) -> list[Event]:
        events, self.events = self.events, []
        return events

    def take_records(self) -> list[CommandRecord]:
        records, self.records = self.records, []
        return records

    def __repr__(self) -> str:
        return f"<{self.kind} {self.name}>"


def any_override(command: str, percent: float) -> None:
    """A unit without an override refuses none."""
