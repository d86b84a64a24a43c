"""Common output of the commands: refusals, faults; and the exit statuses."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING

from rich.console import Console

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.notes import Note

if TYPE_CHECKING:
    from cnc_ptp.parameters import MachineParameters

RUN_FAILED = 1
"""The run ended in an error, or a recording differs."""


class WarningLine(str):
    """A line of output that warns: its text after "warning: ", printed in yellow."""

    __slots__ = ()

    def __new__(cls, text: str) -> WarningLine:
        return super().__new__(cls, f"warning: {text}")


def print_lines(console: Console, lines: Iterable[str]) -> None:
    """Prints the lines of a report, those that warn in yellow."""
    for line in lines:
        console.print(line, markup=False, style="yellow" if isinstance(line, WarningLine) else None)


def print_error(error: CncError) -> None:
    """The text of a refusal on standard error; of a program its line, a mark below the column, and its callers."""
    console = Console(stderr=True, highlight=False, soft_wrap=True, emoji=False)
    console.print(str(error), style="red", markup=False)
    if getattr(error, "text", "").strip():  # of a program without a line there is nothing to mark
        console.print(getattr(error, "caret", ""), markup=False)
    for place in getattr(error, "calls", ()):
        console.print(f"called in {place}", markup=False)
    if getattr(error, "note", ""):
        console.print(f"note: {getattr(error, 'note', '')}", markup=False)


def print_note_of_idle_run(*job: object, options: str = "--program, --scenario, --plc or --duration") -> None:
    """A note that there was nothing to do, because none of the `options` was given."""
    if all(part is None for part in job):
        text = f"note: there was nothing to do, give {options}"
        Console(highlight=False, soft_wrap=True).print(text, style="yellow")


def print_faults(
    console: Console, errors: list[str], notes: Iterable[Note], *, stopped: bool, refused: int = 0
) -> None:
    """Errors of a run, on standard error; commands that were refused, with their number, or carried out with a warning.

    `stopped`: everything was stopped; that some axes were at a standstill already is not worth a note.
    """
    console_of_errors = Console(stderr=True, highlight=False, soft_wrap=True, emoji=False)
    for text in errors:
        console_of_errors.print(f"error: {text}", style="red", markup=False)
    for note in notes:
        if not (stopped and note.idle_stop):
            console.print(str(note), style="yellow" if note.message_at is None else "", markup=False)
    if refused:
        console.print(f"{refused} {'command was' if refused == 1 else 'commands were'} refused", style="yellow")


def print_missing_folders(machine: MachineParameters) -> None:
    """Warns of search folders for programs (P-CHAN-90004) that are not there, on standard error."""
    from cnc_ptp.machine.run_entries import program_search  # `cnc_ptp --help` does not wait for it

    folders = {folder: None for channel in machine.channels for folder in program_search(machine, channel).missing}
    for folder in folders:
        print(f"warning: search folder {folder} (P-CHAN-90004) does not exist", file=sys.stderr)
