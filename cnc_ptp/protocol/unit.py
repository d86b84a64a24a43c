"""The base of all units: commands are checked, carried out or refused as a whole, and recorded; events collected."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any, ClassVar, NamedTuple

from cnc_ptp.errors import CncError, Value
from cnc_ptp.protocol.blocks import Command, CommandRecord, CycleBlock, CycleTick, Event, EventValue, Severity, json_of
from cnc_ptp.protocol.commands import OF_PLC, check_command, current_names, with_floats
from cnc_ptp.protocol.jobs import JOBS, Jobs


class Answer(NamedTuple):
    """What a command was to find out, as text and by name."""

    text: str
    values: Mapping[str, Value]


Handler = Callable[..., str | Answer | None]

PLC = "plc"
"""Name of the PLC, as a unit and as the source of commands."""
UPSTREAM_LOST = 26101
"""A unit that is needed has sent nothing within the watchdog time."""


class Unit(ABC):
    """A channel, axis, spindle or the PLC: changed by commands only, advanced by `step` block by block.

    A handler `do_<command>(cycle, **arguments)` validates first and raises CncError to refuse; a text that it returns
    is a warning that goes into the record, an Answer is what it was to find out. Nothing here knows processes, topics
    or clocks.
    """

    kind: ClassVar[str]

    def __init__(self, name: str) -> None:
        self.name = name
        self.events: list[Event] = []
        """Events since the last block; the harness takes them away."""
        self.records: list[CommandRecord] = []
        """Commands carried out or refused since the last block; the harness takes them away."""
        self.jobs = Jobs()
        """Its motions and programs, by number."""
        self.sources: Collection[str] = ()
        """Who may command a spindle; without them every name is accepted."""
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
            self._dispatch(command.command, command.arguments, cycle)
            if command.command in JOBS[self.kind]:
                job = self.begin_job(command, cycle)
        except CncError as error:
            refusal = error
            self.event(cycle, Severity.WARNING, error.number, error.full_message)
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
        )
        self.records.append(record)
        return record

    _warning = ""
    _values: Mapping[str, Value] = {}

    def begin_job(self, command: Command, cycle: int) -> int:
        """A command that is a job was carried out: the number of the job, 0 if there was nothing to do."""
        return self.jobs.begin(cycle)

    def note_jobs(self, block: CycleBlock) -> None:
        """Ends the active job when its unit has come to rest in a new block."""
        self.jobs.watch(block)

    def _dispatch(self, command: str, arguments: Mapping[str, Any], cycle: int) -> None:
        self._warning, self._values = "", {}
        arguments = current_names(self.kind, command, arguments)
        check_command(self.kind, self.name, command, arguments, self.sources)
        answer = self.handler(command)(cycle, **with_floats(self.kind, command, arguments))
        if isinstance(answer, Answer):
            self._warning, self._values = answer
        else:
            self._warning = answer or ""
        if command == "upstream_lost":
            self.lost.add(arguments["source"])

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

    def take_events(self) -> list[Event]:
        events, self.events = self.events, []
        return events

    def take_records(self) -> list[CommandRecord]:
        records, self.records = self.records, []
        return records

    def __repr__(self) -> str:
        return f"<{self.kind} {self.name}>"
