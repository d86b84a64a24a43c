"""Program text -> program: lines become blocks, blocks become the main program and its subroutines.

Structure of a file: subroutines `%L name` ... M29 (M17), the main program `%name` ... M30 (M02); the header of the main
program may be missing when it comes first. Names are not case-sensitive. The meaning of words together (feed
present, arc possible, axis in the machine) is checked by the interpreter.
"""

import re

from cnc_ptp.nc import faults
from cnc_ptp.nc.blocks import careful_block, plain_block
from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.collector import paused_collector
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.lexer import normalise
from cnc_ptp.nc.program import NcBlock, Program

_HEADER = re.compile(r"\s*%(?P<local>L(?=\s|$))?\s*(?P<name>[^\s(;\"\],#$\[]*)\s*(?P<rest>.*)", re.IGNORECASE)


def parse_program(text: str, file: str, *, mdi: bool = False) -> Program:
    """Parsed program; raises the first syntax error. With `mdi` no program end is required (manual blocks)."""
    program, errors = parse_all(text, file, mdi=mdi)
    if errors:
        raise errors[0]
    return program


def parse_all(text: str, file: str, *, mdi: bool = False) -> tuple[Program, list[ProgramError]]:
    """Parsed program and its syntax errors, one per line in their order; a faulty line becomes a block that raises."""
    reader = _Reader(file, mdi)
    lines = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    with paused_collector():
        for line, content in enumerate(lines, start=1):
            reader.read(line, content)
        return reader.finish()


class _Section:
    """One program of the file while it is read."""

    def __init__(self, kind: str, name: str, source: Source) -> None:
        self.kind, self.name, self.source = kind, name, source
        self.blocks: list[NcBlock] = []

    def end_error(self) -> ProgramError | None:
        """Error if no block ends this program (skippable blocks do not count)."""
        wanted = ("end",) if self.kind == "main program" else ("end", "return")
        if any(block.flow in wanted and not block.skip for block in self.blocks if block.flow):
            return None
        last = self.blocks[-1].source if self.blocks else self.source
        end = "M30 or M02" if self.kind == "main program" else "M29 or M17"
        return faults.END_MISSING.at(last, program=self.title, end=end)

    @property
    def title(self) -> str:
        """Kind and name, for errors."""
        return f"{self.kind} {self.name}".rstrip()


class _Reader:
    """Collects blocks and errors line by line and sorts the blocks into main program and subroutines."""

    def __init__(self, file: str, mdi: bool) -> None:
        self.file, self.mdi = file, mdi
        self.sections: list[_Section] = []
        self.errors: list[ProgramError] = []
        self.current: _Section | None = None
        self.last = Source(file, 1, 0, "")

    def read(self, line: int, text: str) -> None:
        """Parses one line into the current section."""
        block = plain_block(self.file, line, text.rstrip())
        if block is None and text and not text.isspace():
            source = self.last = Source(self.file, line, 0, text.rstrip())
            try:
                if text.lstrip().startswith("%"):
                    self._header(source)
                else:
                    block = careful_block(source)
            except ProgramError as error:
                self.errors.append(error)
                block = NcBlock(source, (), {}, error=error)
        if block is not None:
            if self.current is None:
                self.current = self._section("main program", "", block.source)
            self.current.blocks.append(block)

    def _header(self, source: Source) -> None:
        """`%name` or `%L name`: starts a section."""
        normalise(source)
        match = _HEADER.match(source.text)
        assert match is not None
        local, name, rest = bool(match["local"]), match["name"], match["rest"]
        kind = "subroutine" if local else "main program"
        self.current = self._section(kind, name, source)
        if rest and rest[0] not in "(;":
            raise faults.PROGRAM_NAME.at(source, match.start("rest") + 1, word=rest)
        if local and not name:
            raise faults.PROGRAM_NAME.at(source, match.end("local") + 1, word=source.text.strip())

    def _section(self, kind: str, name: str, source: Source) -> _Section:
        section = _Section(kind, name, source)
        twin = next((other for other in self.sections if _same(other, section)), None)
        self.sections.append(section)
        if twin is not None:
            self.errors.append(faults.SECOND_PROGRAM.at(source, program=section.title, line=twin.source.line))
        return section

    def finish(self) -> tuple[Program, list[ProgramError]]:
        """The program; errors of structure are added."""
        main = next((section for section in self.sections if section.kind == "main program"), None)
        if main is None:
            self.errors.append(faults.NO_MAIN_PROGRAM.at(self.last))
            main = _Section("main program", "", self.last)
        local = {section.name.upper(): section for section in self.sections if section.kind == "subroutine"}
        self._check_ends()
        self._check_calls(list(local))
        self._check_returns(main)
        subroutines = {name: tuple(section.blocks) for name, section in local.items()}
        program = Program(self.file, main.name, tuple(main.blocks), subroutines)
        return program, _one_a_line(self.errors)

    def _check_ends(self) -> None:
        if not self.mdi:
            missing = (section.end_error() for section in self.sections)
            self.errors += [error for error in missing if error is not None]

    def _check_calls(self, subroutines: list[str]) -> None:
        known = ", ".join(subroutines) or "none"
        for section in self.sections:
            for index, block in enumerate(section.blocks):
                if block.call and block.call not in subroutines:
                    column = block.source.column(block.call)
                    error = faults.UNKNOWN_SUBROUTINE.at(block.source, column, name=block.call, known=known)
                    self._mark(section, index, error)

    def _check_returns(self, main: _Section) -> None:
        for index, block in enumerate(main.blocks):
            if block.flow == "return":
                code = next(code for code in block.m if code.flow == "return")
                column = block.source.column(code.name)
                self._mark(main, index, faults.RETURN_IN_MAIN.at(block.source, column, word=code.name))

    def _mark(self, section: _Section, index: int, error: ProgramError) -> None:
        """Notes an error and makes its block raise it when it is reached."""
        self.errors.append(error)
        section.blocks[index] = section.blocks[index]._replace(error=error)


def _same(a: _Section, b: _Section) -> bool:
    return a.kind == b.kind and (a.kind == "main program" or a.name.upper() == b.name.upper())


def _one_a_line(errors: list[ProgramError]) -> list[ProgramError]:
    first: dict[int, ProgramError] = {}
    for error in errors:
        first.setdefault(error.line, error)
    return [first[line] for line in sorted(first)]
