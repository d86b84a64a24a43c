"""Program text -> program: its main part and subroutines, the structures of its lines, all syntax errors.

Structure of a file: subroutines `%L name` ... M29 (M17), the main program `%name` ... M30 (M02); the header of the main
program may be missing when it comes first. Names are not case-sensitive. The meaning of words together (feed
present, arc possible, axis in the machine) is checked by the interpreter.
"""

import re
from collections.abc import Mapping
from typing import Final

from cnc_ptp.garbage import paused_collector
from cnc_ptp.nc import faults
from cnc_ptp.nc.blocks import read_line
from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow import flow_faults
from cnc_ptp.nc.flow.declarations import declaration_of
from cnc_ptp.nc.flow.lines import Call, Line
from cnc_ptp.nc.flow.sections import Program, Section
from cnc_ptp.nc.flow.statements import Declarations
from cnc_ptp.nc.flow.structures import CLOSING, DIVIDES, OPENED, Place, StructureReader
from cnc_ptp.nc.iso.lines import program_name
from cnc_ptp.nc.iso.vocabulary import ISO
from cnc_ptp.nc.lexer import normalise
from cnc_ptp.nc.program import Vocabulary
from cnc_ptp.nc.program_text import ProgramText
from cnc_ptp.nc.vocabulary import TWINCAT

MOST_ERRORS: Final = 1000
"""Errors of a file that are kept; the rest is not looked for."""

RETURNS: Final = ("M17", "M29", "M99")
_NUMBER = r"\s*(?:/\d*\s*)?(?:N\s*\d+\s*)?#\s*"
_END_OF_VARIABLES = re.compile(_NUMBER + r"ENDVAR(?![A-Z])", re.ASCII | re.IGNORECASE)
_END_OF_COMMENT = re.compile(_NUMBER + r"COMMENT\s+END(?![A-Z])", re.ASCII | re.IGNORECASE)
_HEADER = re.compile(r"\s*%(?P<local>L(?=\s|$))?\s*(?P<name>[^\s(;\"\],#$\[]*)\s*(?P<rest>.*)", re.IGNORECASE)


NO_FILES: Final[Mapping[str, str]] = {}


def parse_program(
    text: str,
    file: str,
    *,
    mdi: bool = False,
    files: Mapping[str, str] = NO_FILES,
    cycles: Mapping[str, str] = NO_FILES,
    library: Mapping[str, Program] | None = None,
    vocabulary: Vocabulary = TWINCAT,
) -> Program:
    """Parsed program; raises the first syntax error. With `mdi` no program end is required (manual blocks).

    `files`: the texts of the programs that it may call, by name; `library`: such programs that have been read already;
    `cycles`: which of them G80 … G89 call (P-CHAN-00160 …), where it is not g80.nc … g89.nc.
    """
    program, errors = parse_text(
        ProgramText(text), file, mdi=mdi, files=files, cycles=cycles, library=library, vocabulary=vocabulary
    )
    if errors:
        raise errors[0]
    return program


def parse_all(
    text: str | ProgramText,
    file: str,
    *,
    mdi: bool = False,
    files: Mapping[str, str] = NO_FILES,
    cycles: Mapping[str, str] = NO_FILES,
    vocabulary: Vocabulary = TWINCAT,
    subroutine: bool = False,
) -> tuple[Program, list[ProgramError]]:
    """Parsed program and its syntax errors, one per line in their order; a faulty line raises when it is reached.

    `subroutine`: other programs call this one, so that it ends with M17, M29 or M99.
    """
    lines = ProgramText(text) if isinstance(text, str) else text
    return parse_text(lines, file, mdi=mdi, files=files, cycles=cycles, vocabulary=vocabulary, subroutine=subroutine)


def parse_text(
    text: ProgramText,
    file: str,
    *,
    mdi: bool = False,
    files: Mapping[str, str] = NO_FILES,
    cycles: Mapping[str, str] = NO_FILES,
    library: Mapping[str, Program] | None = None,
    vocabulary: Vocabulary = TWINCAT,
    subroutine: bool = False,
) -> tuple[Program, list[ProgramError]]:
    """As parse_all, from memory or from a file."""
    texts = files if vocabulary is TWINCAT else NO_FILES
    called = {name.upper(): Program(name, ProgramText(text_), read_line, vocabulary) for name, text_ in texts.items()}
    known = {**(library or {}), **called}
    program = Program(file, text, read_line, vocabulary)
    errors: list[ProgramError] = []
    with paused_collector():
        for each in (program, *called.values()):
            each.library, each.cycles = known, cycles
            errors += ProgramReader(each, mdi=mdi, called=subroutine or each is not program).read()
    return program, errors


class ProgramReader:
    """Reads all lines once, one after the other: errors, sections, labels, structures."""

    def __init__(self, program: Program, *, mdi: bool, called: bool) -> None:
        """`called`: its main part is a subroutine of other programs."""
        self.program, self.mdi, self.called = program, mdi, called
        self.errors: list[ProgramError] = []
        self.sections: list[Section] = []
        self.structures = StructureReader("the program")
        self.ended = True
        """The present section has its M30 or M29."""
        self.is_iso = program.vocabulary is ISO
        self.percent = self.closed = False
        """Of the vocabulary iso: the file has begun with %; a second % has closed it."""
        self.last = Source(program.file, 1, 0, "")
        self.calls: list[tuple[Call, Source]] = []
        self.declarations: Declarations | None = None
        self.opened: Line | None = None
        """Line of #VAR or #COMMENT BEGIN until its end."""
        self.number, self.offset = 1, 0
        """Of the next line."""

    def read(self) -> list[ProgramError]:
        """All errors of the file, one per line."""
        while self.goes_on:
            self.step()
        return self.finish()

    @property
    def goes_on(self) -> bool:
        """There is a next line."""
        return self.offset >= 0 and len(self.errors) < MOST_ERRORS and not self.closed

    def step(self) -> None:
        """Reads the next line."""
        program, number, offset = self.program, self.number, self.offset
        line = read_line(program.file, program.text, number, offset, program.vocabulary)
        self.number, self.offset = line.next_number, line.next_offset
        if self.opened is None:
            self._line(line, offset)
        else:
            self._inside(line)
        program.lines = number

    def _line(self, line: Line, offset: int) -> None:
        program = self.program
        program.keep(line)
        if line.error is not None:
            self.errors.append(line.error)
        if line.header and self.is_iso:
            self._program_number(line)
        elif line.header:
            self._header(line)
        elif self.structures.awaits_case and line.control is None and line.does_something:
            word = line.source.text.split()[0]
            self._mark(line, flow_faults.BEFORE_CASE.at(line.source, line.source.text.index(word) + 1, word=word))
        elif line.block is not None and line.statement is None and not line.label:
            self._require_section(line, offset)
            self._note_end(line)
        elif line.does_something or line.label:
            self._require_section(line, offset)
            self._structure(line, offset)
        elif line.error is not None:
            self._require_section(line, offset)
            if line.control is not None:
                self._structure(line, offset)
        if line.call is not None:
            self._note_call(line.call, line.source)
        if line.source.text:
            self.last = line.source

    def _note_call(self, call: Call, source: Source) -> None:
        """Subroutines may follow later in the file; of a name that is called again and again, one call is enough."""
        if len(self.calls) < MOST_ERRORS or all(call.name != noted.name for noted, _ in self.calls):
            self.calls.append((call, source))

    def _require_section(self, line: Line, offset: int) -> None:
        if not self.sections:
            self._begin("main program", "", line.source, line.number, offset)

    def _note_end(self, line: Line) -> None:
        """M30, M02, M29, M17."""
        flow = line.flow or (line.block.flow if line.block is not None else "")
        if flow not in ("end", "return"):
            return
        section = self.sections[-1]
        is_main = section.kind == "main program" and not self.called
        if flow == "return" and is_main and self.is_iso and section.name and not line.skip:
            self._is_subroutine()
        elif flow == "return" and is_main:
            word = next(name for name in line.source.names if name in RETURNS)
            self._mark(line, faults.RETURN_IN_MAIN.at(line.source, line.source.column(word), word=word))
        elif not line.skip:
            self.ended = True

    # sections

    def _header(self, line: Line) -> None:
        """`%name` or `%L name`: starts a section."""
        try:
            normalise(line.source)
            match = _HEADER.match(line.source.text)
            assert match is not None
            local, name, rest = bool(match["local"]), match["name"], match["rest"]
            kind = "subroutine" if local else "main program"
            self._begin(kind, name, line.source, line.next_number, line.next_offset)
            if rest and rest[0] not in "(;":
                raise faults.PROGRAM_NAME.at(line.source, match.start("rest") + 1, word=rest)
            if local and not name:
                raise faults.PROGRAM_NAME.at(line.source, match.end("local") + 1, word=line.source.text.strip())
        except ProgramError as error:
            self.errors.append(error)

    def _program_number(self, line: Line) -> None:
        """Vocabulary iso: % at both ends, O1234 begins a program; those behind the main program are subroutines."""
        try:
            name = program_name(line.source)
            if name:
                has_main = any(section.kind == "main program" for section in self.sections)
                kind = "subroutine" if has_main else "main program"
                self._begin(kind, name, line.source, line.next_number, line.next_offset)
            else:
                self.closed = self.percent or bool(self.sections)
                self.percent = True
        except ProgramError as error:
            self.errors.append(error)

    def _is_subroutine(self) -> None:
        """M99 shows that the program before the main one is a subroutine."""
        section = self.sections.pop()._replace(kind="subroutine")
        twin = next((other for other in self.sections if other.name.upper() == section.name.upper()), None)
        if twin is not None:
            fault = faults.SECOND_PROGRAM
            self.errors.append(fault.at(section.source, program=section.title, line=twin.source.line))
        self.sections.append(section)
        self.program.subroutines[section.name] = section
        self.ended = True

    def _begin(self, kind: str, name: str, source: Source, number: int, offset: int) -> None:
        self._end_section()
        section = Section(kind, name, source, number, offset)
        twin = next((other for other in self.sections if _same(other, section)), None)
        if twin is not None:
            self.errors.append(faults.SECOND_PROGRAM.at(source, program=section.title, line=twin.source.line))
        elif kind == "main program":
            self.program.main = section
        else:
            self.program.subroutines[name.upper()] = section
        self.sections.append(section)
        self.ended = False
        self.structures = StructureReader(section.title)

    def _end_section(self) -> None:
        """Structures that are open and a missing M30 are errors; a comment that is not closed holds the M30."""
        self.program.targets.update(self.structures.finish(self.errors))
        if self.ended or self.mdi or self.opened is not None:
            return
        section = self.sections[-1]
        is_main = section.kind == "main program" and not self.called
        end = "M30 or M02" if is_main else "M99" if self.is_iso else "M29 or M17"
        self.errors.append(faults.END_MISSING.at(self.last, program=section.title, end=end))

    # structures

    def _structure(self, line: Line, offset: int) -> None:
        """Labels, jumps and control statements."""
        begin, behind = Place(line.number, offset), Place(line.next_number, line.next_offset)
        try:
            if line.label:
                self.structures.label(line.label, begin, line.source, line.label_column)
            if line.control is not None:
                self._control(line, begin, behind)
            if line.jump:
                self.structures.jump(line.jump, line.number, line.source, line.jump_column)
            if isinstance(line.statement, Declarations):
                self.declarations, self.opened = line.statement, line
            elif line.comment:
                self.opened = line
        except ProgramError as error:
            self._mark(line, error)
        self._note_end(line)

    def _mark(self, line: Line, error: ProgramError) -> None:
        """An error that the line alone does not show: the line is kept with it."""
        self.errors.append(error)
        line.error = line.error or error
        self.program.special[line.number] = line

    def _control(self, line: Line, begin: Place, behind: Place) -> None:
        control = line.control
        assert control is not None
        keyword, structures = control.keyword, self.structures
        if keyword in CLOSING:
            structure = structures.opens(control, begin, behind, line.source)
            structure.statement = line.statement
        elif keyword in DIVIDES:
            structure = structures.divides(control, begin, behind, line.source)
        elif keyword in OPENED:
            structure = structures.closes(keyword, begin, behind, line.source, control.column)
        elif keyword == "$RETURN":
            if not line.skip and (self.called or self.sections[-1].kind != "main program"):
                self.ended = self.ended or structures.open is None
            return
        else:
            structure = structures.leaves(keyword, line.source, control.column)
        self.program.structure_of[line.number] = structure
        if control.synchronises or (keyword == "$FOR" and line.synchronises):
            structure.synchronises = True

    def _inside(self, line: Line) -> None:
        """A line between #VAR and #ENDVAR, or of a comment over several lines."""
        opened = self.opened
        assert opened is not None
        closing = _END_OF_COMMENT if opened.comment else _END_OF_VARIABLES
        if closing.match(line.source.text):
            opened.next_number, opened.next_offset = line.next_number, line.next_offset
            self.program.special[opened.number] = opened
            self.opened = self.declarations = None
        elif self.declarations is not None:
            try:
                declared = declaration_of(line)
                if declared is not None:
                    self.declarations.lines.append((line, declared))
                    opened.synchronises = opened.synchronises or line.synchronises
            except ProgramError as error:
                self.errors.append(error)
                opened.error = opened.error or error
        if line.source.text:
            self.last = line.source

    # end

    def finish(self) -> list[ProgramError]:
        """All errors; those of the structure are added."""
        if self.opened is not None:
            begin, end = ("#COMMENT BEGIN", "#COMMENT END") if self.opened.comment else ("#VAR", "#ENDVAR")
            source, line = self.opened.source, self.opened.number
            self.errors.append(flow_faults.SECTION_OPEN.at(source, begin=begin, end=end, line=line))
        self._end_section()
        if not any(section.kind == "main program" for section in self.sections):
            self.errors.append(faults.NO_MAIN_PROGRAM.at(self.last))
        for call, source in self.calls:
            try:
                self.program.called(call, source)
            except ProgramError as error:
                self.errors.append(error)
        return _one_a_line(self.errors)


def _same(a: Section, b: Section) -> bool:
    return a.kind == b.kind and (a.kind == "main program" or a.name.upper() == b.name.upper())


def _one_a_line(errors: list[ProgramError]) -> list[ProgramError]:
    first: dict[int, ProgramError] = {}
    for error in errors:
        first.setdefault(error.line, error)
    return [first[line] for line in sorted(first)]
