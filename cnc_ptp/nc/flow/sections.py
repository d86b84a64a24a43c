"""A program: its main part and its subroutines, and every line by its place."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final, NamedTuple

from cnc_ptp.errors import nearest_name
from cnc_ptp.nc import faults
from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow import flow_faults
from cnc_ptp.nc.flow.cycle_files import cycle_file, cycle_parameter
from cnc_ptp.nc.flow.lines import Call, Line
from cnc_ptp.nc.flow.structures import Place, Structure
from cnc_ptp.nc.program import Vocabulary
from cnc_ptp.nc.program_text import ProgramText

KEPT_LATER: Final = 10_000
"""Lines of loops and subroutines that are kept behind those that a text lets keep (ProgramText.kept)."""


ReadLine = Callable[[str, ProgramText, int, int, Vocabulary], Line]


class Section(NamedTuple):
    """Main program or subroutine: its name and the place of its first line."""

    kind: str
    name: str
    source: Source
    line: int
    offset: int

    @property
    def title(self) -> str:
        """Kind and name, for errors."""
        return f"{self.kind} {self.name}".rstrip()


class Program:
    """A parsed file.

    vocabulary      the language in which its lines are read
    main            main program
    subroutines     by upper-case name
    structure_of    by number of the line that opens, divides, closes or leaves a structure
    targets         where the $GOTO of a line leads to, or why it leads nowhere
    library         the other files that it may call, by upper-case name
    cycles          files of G80 to G89 by code, where they are not g80.nc to g89.nc
    lines           number of its last line
    streamed        it is read while it is executed (StreamedProgram)
    """

    streamed = False

    def __init__(self, file: str, text: ProgramText, read_line: ReadLine, vocabulary: Vocabulary) -> None:
        self.file, self.text, self.vocabulary = file, text, vocabulary
        self.lines = 0
        self.main = Section("main program", "", Source(file, 1, 0, ""), 1, 0)
        self.subroutines: dict[str, Section] = {}
        self.structure_of: dict[int, Structure] = {}
        self.targets: dict[int, Place | ProgramError] = {}
        self.kept: list[Line | None] = [None]
        self.library: Mapping[str, Program] = {}
        self.cycles: Mapping[str, str] = {}
        self.origin: object = None
        """What a channel has read it from (program_origin.Origin)."""
        self.special: dict[int, Line] = {}
        """Lines that hold more than their text says: declarations, comments of several lines."""
        self.arguments_read: dict[int, frozenset[str]] = {}
        """Names of the @ parameters that a section reads, by number of its first line; found at its first call."""
        self._later: dict[int, Line] = {}
        self._read_line = read_line

    @property
    def name(self) -> str:
        return self.main.name

    @property
    def size(self) -> int:
        """Of which its progress is a share: lines, or characters if it is read while it is executed."""
        return self.lines

    def place(self) -> int:
        """How much of it has been executed, in parts of `size`; 0 if it does not count that."""
        return 0

    def ready(self, number: int) -> bool:
        """Whether all is known that line `number` needs to be executed; else ask again. Raises ProgramError."""
        return True

    def require_end(self) -> None:
        """The main program has come to its last line. Raises ProgramError if M30 is missing."""

    def keep(self, line: Line) -> None:
        """Notes a line, as long as there is room for it."""
        if line.number > self.text.kept:
            return
        while len(self.kept) < line.number:
            self.kept.append(None)
        self.kept.append(line)

    def line(self, number: int, offset: int) -> Line:
        """The line of this number, which begins at this offset."""
        if number < len(self.kept):
            kept = self.kept[number]
            if kept is not None:
                return kept
        special = self.special.get(number)
        if special is not None:
            return special
        found = self._later.get(number)
        if found is None:
            found = self._read_line(self.file, self.text, number, offset, self.vocabulary)
            if len(self._later) >= KEPT_LATER:
                self._later.clear()
            self._later[number] = found
        return found

    def called(self, call: Call, source: Source) -> tuple[Program, Place]:
        """The program and the place of its first line. Raises ProgramError when it is not there."""
        name = cycle_file(call.name, self.cycles).upper() if call.by_code else call.name.upper()
        if call.local:
            section = self.subroutines.get(name)
            if section is None:
                known = ", ".join(self.subroutines) or "none"
                raise faults.UNKNOWN_SUBROUTINE.at(source, call.column, name=call.name, known=known)
            return self, Place(section.line, section.offset)
        program = self.library.get(name)
        if program is None and call.by_code:
            file, parameter = cycle_file(call.name, self.cycles), cycle_parameter(call.name)
            raise flow_faults.CYCLE_FILE.at(source, call.column, g=call.name, file=file, parameter=parameter)
        if program is None:
            nearest = nearest_name(name, list(self.library))
            raise flow_faults.FILE_UNKNOWN.at(source, call.column, name=call.name, nearest=nearest)
        return program, Place(program.main.line, program.main.offset)
