"""Notes of a run for its user: refused commands and warnings, each once; and its errors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from cnc_ptp.errors import WarningText, plain_text, warning_text
from cnc_ptp.protocol.axis_states import AxisStateCode, state_name
from cnc_ptp.protocol.blocks import Severity
from cnc_ptp.protocol.commands import READING

PROGRAM_MESSAGE = 22028
"""Event of #MSG."""
PLC_MESSAGE = 22054
"""Event of a PLC in a file (`io.event`)."""
START_STEP = 22045
"""Event: what is done at the start of a program that does not begin at its beginning."""
MEASURED = 22050
"""Event: what a measuring run has measured."""
MESSAGES = (PROGRAM_MESSAGE, START_STEP, MEASURED, PLC_MESSAGE)
ORDERED_ERROR = 22029
"""Warning or error of #ERROR."""
NOTHING_TO_STOP = 23073
"""Warning of a stop, halt or emergency stop of an axis that does not move."""


@dataclass(frozen=True, slots=True)
class Note:
    """A refused command, a message of a program or PLC, or a warning: an event, or of a command carried out."""

    number: int
    text: str
    refused: bool = False
    idle_stop: bool = False
    """A stop of an axis that is at a standstill already."""
    message_at: int | None = None
    """Cycle of a message: each one counts."""

    def __str__(self) -> str:
        if self.message_at is not None:
            return f"message: {self.text}"
        if self.refused:
            return f"refused: P-ERR-{self.number} {self.text}"
        return f"warning: {warning_text(self.number, self.text)}"

    @classmethod
    def of_command(cls, record: Any) -> Note | None:
        """`record`: a CommandRecord or its message; None for a command that was carried out without a warning."""
        if not record.accepted:
            return cls(record.error_id, record.message, refused=True)
        if not record.message or record.command in READING:
            return None
        number = record.warning_id
        idle = number == NOTHING_TO_STOP and record.command == "stop"
        return cls(number, plain_text(number, record.message), idle_stop=idle)

    @classmethod
    def of_event(cls, event: Any) -> Note | None:
        """`event`: an Event or its message; None for one that is neither a warning nor a message."""
        if event.severity == Severity.INFO and event.error_id in MESSAGES:
            return cls(event.error_id, event.text, message_at=event.cycle)
        return cls(event.error_id, event.text) if event.severity == Severity.WARNING else None


class Notes:
    """Notes in the order in which they came, each once.

    A refused command is an event too: it is noted as refused, in whatever order the two come.
    """

    def __init__(self) -> None:
        self._notes: dict[tuple[int, str, int | None], Note] = {}
        self._new: list[Note] = []

    def add(self, note: Note | None) -> None:
        if note is None:
            return
        key = note.number, note.text, note.message_at
        known = self._notes.get(key)
        if known is None or (note.refused and not known.refused):
            self._notes.pop(key, None)
            self._notes[key] = note
        if known is None:
            self._new.append(note)

    def take_new(self) -> list[Note]:
        """Those that have come since the last call, as they came first."""
        new, self._new = self._new, []
        return new

    def __iter__(self) -> Iterator[Note]:
        return iter(self._notes.values())


def without_effect(axis: str, command: str, state: AxisStateCode) -> WarningText:
    """The warning that there was nothing to stop."""
    return warning_text(NOTHING_TO_STOP, f"axis {axis}: {command} without effect in {state_name(state)}")


def error_text(event: Any) -> str:
    """`event`: an error (Event or its message), with its cycle, and the line of the program if there is one."""
    where = f"cycle {event.cycle}, line {event.line}" if event.line else f"cycle {event.cycle}"
    return f"P-ERR-{event.error_id} {event.text} ({where})"
