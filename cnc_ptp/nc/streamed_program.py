"""A program that is read while it is executed, because its text is too long to be read before it starts.

It is read as far as its execution needs it: to the line that is next; to the end of a condition or loop before its
first line; to the end of the section before a $GOTO; to a subroutine before its call. A fault counts as soon as it has
been read. What is not read is not checked.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from cnc_ptp.nc import faults
from cnc_ptp.nc.blocks import read_line
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow.lines import Line
from cnc_ptp.nc.flow.sections import KEPT_LATER, Program, Section
from cnc_ptp.nc.parser import NO_FILES, ProgramReader, parse_program
from cnc_ptp.nc.program import Vocabulary
from cnc_ptp.nc.program_text import ProgramText
from cnc_ptp.nc.vocabulary import TWINCAT

LINES_AT_ONCE: Final = 500
"""Lines that are read ahead before the caller has its turn again."""
MOST_STRUCTURES: Final = 10_000
"""Lines of conditions and loops that are known before those that have been executed are forgotten."""
AT_END: Final = faults.END_MISSING.number
"""The fault that counts when all lines have been executed."""


class StreamedProgram(Program):
    """A program of which nothing but the beginning is known."""

    streamed = True

    def __init__(self, file: str, text: ProgramText, vocabulary: Vocabulary) -> None:
        super().__init__(file, text, read_line, vocabulary)
        self._reached = 0
        """Characters of the text up to the line furthest behind that was executed."""
        self._reader = ProgramReader(self, mdi=False, called=False)
        self._complete = False
        """The text has been read to its end."""
        self._leads: dict[int, Line] = {}
        """Lines with a $GOTO or a call, by number, while it is not known where it leads to."""
        self._seen = 0
        """Errors of the reader that have counted."""
        self._labelled = False
        """There is a label, so that a $GOTO may lead back."""
        self._forget_at = MOST_STRUCTURES
        """Lines of structures at which it is looked for some to be forgotten."""

    @property
    def size(self) -> int:
        return self.text.size

    def place(self) -> int:
        return self._reached

    def go_to(self, place: int) -> None:
        """`place` of a program of the same text."""
        self._reached = place

    def begin(self) -> None:
        """Reads to the main program. Raises the first ProgramError that is found before it."""
        reader = self._reader
        while not self._complete and not any(section.kind == "main program" for section in reader.sections):
            self._step()
        if reader.errors:
            raise reader.errors[0]

    def keep(self, line: Line) -> None:
        """Lines that were read last."""
        if len(self._later) >= KEPT_LATER:
            self._later.clear()
        self._later[line.number] = line
        self._labelled = self._labelled or bool(line.label)
        if line.jump or (line.call is not None and line.call.local):
            self._leads[line.number] = line

    def line(self, number: int, offset: int) -> Line:
        """As Program; it is executed now."""
        found = super().line(number, offset)
        self._reached = max(self._reached, found.next_offset)
        return found

    def ready(self, number: int) -> bool:
        """As Program: the line was read, the whole structure that it begins, and where its $GOTO or call leads to."""
        if len(self.structure_of) > self._forget_at:
            self._forget_structures(number)
        end = self._reader.number + LINES_AT_ONCE
        while self._inside(number):
            if self._reader.number >= end:
                return False
            self._step()
        self._raise_new()
        while self._leads_on(number):
            if self._reader.number >= end:
                return False
            self._step()
        return True

    def _forget_structures(self, number: int) -> None:
        """Those of the main program that end before line `number`, which is next: nothing leads back to them."""
        section = max((one for one in self._reader.sections if one.line <= number), key=line_of_section, default=None)
        if section is not None and section.kind == "main program" and not self._labelled:
            for line, structure in list(self.structure_of.items()):
                if section.line <= line and 0 < structure.outermost.end.line < number:
                    del self.structure_of[line]
        self._forget_at = len(self.structure_of) + MOST_STRUCTURES

    def require_end(self) -> None:
        for error in self._reader.errors:
            if error.number == AT_END:
                raise error

    def _inside(self, number: int) -> bool:
        """The line, or the end of the structure in which it is, is still to be read."""
        reader = self._reader
        structures = reader.opened is not None or reader.structures.open is not None
        return (structures or reader.number <= number) and not self._complete

    def _raise_new(self) -> None:
        """The first of the faults that were read since the last time. Raises ProgramError."""
        new, self._seen = self._reader.errors[self._seen :], len(self._reader.errors)
        first = min((error for error in new if error.number != AT_END), key=line_of, default=None)
        if first is not None:
            raise first

    def _leads_on(self, number: int) -> bool:
        """Where the $GOTO or the call of the line leads to is still to be read."""
        line = self._leads.get(number)
        if line is None or self._complete:
            return False
        if line.call is not None and line.call.local and not self._has(line.call.name.upper()):
            return True
        if line.jump and number not in self.targets:
            return True
        del self._leads[number]
        return False

    def _has(self, name: str) -> bool:
        """The subroutine has been read to its end."""
        return name in self.subroutines and self.subroutines[name] is not self._reader.sections[-1]

    def _step(self) -> None:
        reader = self._reader
        if reader.goes_on:
            reader.step()
        if not reader.goes_on:
            self._complete = True
            reader.finish()


def line_of(error: ProgramError) -> int:
    """Its line."""
    return error.line


def line_of_section(section: Section) -> int:
    """Its first line."""
    return section.line


def stream_program(
    text: str,
    file: str,
    *,
    files: Mapping[str, str] = NO_FILES,
    cycles: Mapping[str, str] = NO_FILES,
    vocabulary: Vocabulary = TWINCAT,
) -> StreamedProgram:
    """As parse_program. The programs that it calls are read at once, of its own text the lines before its main program.

    Raises their first error.
    """
    program = StreamedProgram(file, ProgramText(text), vocabulary)
    program.library = parse_program("M30", file, files=files, cycles=cycles, vocabulary=vocabulary).library
    program.cycles = cycles
    program.begin()
    return program
