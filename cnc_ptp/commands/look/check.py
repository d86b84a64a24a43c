"""`cnc_ptp check`: an NC program's errors with line and column."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

from rich.console import Console

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.channel.program_start import ProgramStart
from cnc_ptp.commands.console import print_error, print_missing_folders
from cnc_ptp.errors import WRONG_INPUT, CncError
from cnc_ptp.machine.program_files import NO_SEARCH, Search, is_longer, read_program, scan_program
from cnc_ptp.machine.run_entries import program_search
from cnc_ptp.nc.awaited import awaits_path, reads_the_run
from cnc_ptp.nc.block_search import StartPoint
from cnc_ptp.nc.canonical import BUSY, CanonicalBlock
from cnc_ptp.nc.canonical_text import format_block
from cnc_ptp.nc.check import check as check_text
from cnc_ptp.nc.expressions import expression_faults
from cnc_ptp.nc.faults import RETURN_IN_MAIN, ProgramError, line_of_program
from cnc_ptp.nc.flow.calls import arguments_read
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.flow.structures import Place
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.parser import parse_all, parse_program
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.program_text import ProgramFile, ProgramText
from cnc_ptp.nc.vocabularies import VOCABULARIES
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.protocol.notes import Note

CHECKED_TEXT = 10_000_000
"""P-CHAN-90005 without a machine: characters."""
WITHOUT_MACHINE = plain_channel(("X", "Y", "Z"))
"""Axes X Y Z and spindle S."""


def check(
    program: str,
    machine: str | None,
    canonical: bool = False,
    dialect: str | None = None,
    begin: StartPoint | None = None,
    as_subroutine: bool = False,
) -> int:
    """Prints the syntax and modal errors, and the warnings of the machine file.

    Without a machine, axes X Y Z and spindle S are taken. `canonical`: prints the blocks that result, too, with `begin`
    those from the start point on. `dialect`: vocabulary of the program; None: that of the machine file, or twincat.
    `begin`: prints what is done when the program starts there. `as_subroutine`: as if a program called the file.
    Raises the errors of ProgramStart.
    """
    parameters = None if machine is None else read_machine(machine)
    search = NO_SEARCH if parameters is None else program_search(parameters)
    checked = None if parameters is None else ProgramCheck.of_first_channel(parameters, program)
    if parameters is not None:
        print_notices(parameters)
        print_missing_folders(parameters)
    limit = CHECKED_TEXT if checked is None else checked.checked_text
    if begin is None and not canonical and not as_subroutine and is_longer(program, limit):
        return check_file(program, checked, search, dialect)
    text, files = read_program(program, search)
    own = VOCABULARIES["twincat"] if checked is None else checked.vocabulary
    vocabulary = own if dialect is None else VOCABULARIES[dialect]
    given: dict[str, Any] = {"files": files, "cycles": search.cycles, "vocabulary": vocabulary}
    name, lines = Path(program).name, len(text.splitlines())
    if as_subroutine:
        subroutine, errors = parse_all(text, program, subroutine=True, **given)
        read = sorted(arguments_read(subroutine, Place(subroutine.main.line, subroutine.main.offset)))
        if errors or read or vocabulary is not VOCABULARIES["twincat"]:
            return print_result(errors, f"{name}: no syntax errors in {lines} lines{without_values(read)}")
        text, program, given["files"] = f"L CYCLE [NAME={name}]\nM30", "call of " + name, {**files, name: text}
    errors = errors_of(text, program, checked, given)
    error: CncError | None = None
    if begin is not None and not errors:
        start = ProgramStart(begin, parse_program(text, program, **given))
        error = print_start(start, parameters, canonical=canonical)
    elif canonical:
        error = print_stream(Stream(parse_all(text, program, **given)[0], parameters).blocks())
    if isinstance(error, ProgramError) and str(error) not in map(str, errors):
        errors.append(error)
    for each in errors:
        search.explain(each, program)
    return print_result(errors, "" if canonical or begin is not None else f"{name}: no errors in {lines} lines")


def check_file(program: str, checked: ProgramCheck | None, search: Search, dialect: str | None) -> int:
    """A program that is too long to be held in memory (P-CHAN-90005): its lines are read as they are needed."""
    own = VOCABULARIES["twincat"] if checked is None else checked.vocabulary
    lines, files = scan_program(program, search)
    given = {"files": files, "cycles": search.cycles, "vocabulary": own if dialect is None else VOCABULARIES[dialect]}
    with Path(program).open("rb") as stream:
        errors = errors_of(ProgramFile(stream), program, checked, given)
    for error in errors:
        search.explain(error, program)
    return print_result(errors, f"{Path(program).name}: no errors in {lines} lines")


def errors_of(
    text: str | ProgramText, program: str, checked: ProgramCheck | None, given: dict[str, Any]
) -> list[ProgramError]:
    """Of a program with its `files`, `cycles` and `vocabulary`."""
    if checked is None:
        channel = WITHOUT_MACHINE._replace(vocabulary=given["vocabulary"])
        return check_text(text, program, channel, files=given["files"], cycles=given["cycles"])
    return checked.errors(text, program, given["files"], given["vocabulary"])


def without_values(arguments: Sequence[str]) -> str:
    """Why a subroutine was not executed."""
    return f"; not executed without values of {', '.join(f'@{name}' for name in arguments)}" if arguments else ""


def print_result(errors: Sequence[ProgramError], good: str) -> int:
    """Prints the errors, or what is to be said without any; the status of the command."""
    for error in errors:
        print_error(error)
        if error.unchecked:
            place = f"line {error.line} of {error.file}"
            print(f"note: behind {place} only the syntax was checked: {error.unchecked}", file=sys.stderr)
        if error.number == RETURN_IN_MAIN.number:
            print("note: --as-subroutine checks a file that other programs call", file=sys.stderr)
    if good and not errors:
        print(good)
    return WRONG_INPUT if errors else 0


class Stream:
    """A program as it would run from the start positions of a machine, or from 0 without one."""

    def __init__(self, program: Program, machine: MachineParameters | None) -> None:
        self._program = program
        self._check = None if machine is None else ProgramCheck.of_first_channel(machine, program.file)
        self.axes = WITHOUT_MACHINE.axes if self._check is None else self._check.axis_names
        self.start = (0.0,) * len(self.axes) if self._check is None else self._check.start

    def blocks(self, begin: ProgramStart | None = None) -> Iterator[CanonicalBlock]:
        """Its blocks, also BUSY."""
        if self._check is not None:
            return self._check.running(self._program, self.start, self._check.state({}, {}, {}), (), begin)
        state, search = ModalState(), None if begin is None else begin.search
        stream = interpret(self._program, self.start, WITHOUT_MACHINE, state=state, runs=True, search=search)
        if begin is None:
            return stream
        return begin.blocks(stream, self.start, self.axes, state, lambda target, source: None)


def print_start(begin: ProgramStart, machine: MachineParameters | None, *, canonical: bool) -> CncError | None:
    """What is done at the start, step by step; `canonical`: then the blocks, up to the error that it returns."""
    stream = Stream(begin.program, machine)
    blocks = stream.blocks(begin)
    first = next((block for block in blocks if block is not BUSY), None)
    for number, step in enumerate(begin.lines(stream.axes, stream.start), 1):
        print(f"{number}. {step}")
    return print_stream(chain([first], blocks)) if canonical and first is not None else None


def print_stream(blocks: Iterator[CanonicalBlock]) -> CncError | None:
    """The canonical blocks up to the first error, which it returns, or to a line that reads what only the run knows.

    Behind a block that moves axes to where only the run knows, they are taken to be where the program names them.
    """
    assumed = False
    try:
        for block in blocks:
            if block is BUSY:
                continue
            print(format_block(block))
            if reads_the_run(block):
                print_unknown(block, ENDS_THERE)
                return None
            if awaits_path(block) and not assumed:
                assumed = True
                print_unknown(block, GOES_ON)
    except CncError as error:
        return error
    return None


ENDS_THERE = "what follows is known only while the program runs; the stream ends here"
GOES_ON = "where axes are behind it is known only while the program runs; the stream continues with the named positions"


def print_unknown(block: CanonicalBlock, what: str) -> None:
    """The warning of a block behind which the stream is not what the run will have."""
    text = f"{line_of_program(block.source, block.calls)}: {what}"
    print_notes([Note(expression_faults.ONLY_WHILE_RUNNING.number, text)])


def print_notices(machine: MachineParameters) -> None:
    """Prints the warnings of a machine file."""
    print_notes([Note(notice.error_id, str(notice)) for notice in machine.warnings])


def print_notes(notes: Iterable[Note]) -> None:
    """On standard error."""
    console = Console(stderr=True, highlight=False, soft_wrap=True)
    for note in notes:
        console.print(str(note), style="yellow", markup=False)
