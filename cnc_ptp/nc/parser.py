"""Program text -> blocks: lexical rules, known words, one code of a group and one word of a kind a block, structure.

What words mean together (feed present, arc possible, axis in the machine) is the interpreter's part.

Structure of a file: subroutines `%L name` ... M29 (M17), the main program `%name` ... M30 (M02); the header of the main
program may be missing when it comes first. Names are compared without regard to case.
"""

import re

from cnc_ptp.nc import faults
from cnc_ptp.nc.canonical import Source, number
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.lexer import PLAIN_LINE, PLAIN_WORD, SKIP, Token, bracket_words, column_of, normalise, tokens
from cnc_ptp.nc.program import Block, GCode, MCode, Program, SpindleWords
from cnc_ptp.nc.vocabulary import (
    AXIS_LETTERS,
    BRACKET_WORDS,
    FUNCTION_WORDS,
    G_CODES,
    MAX_SKIP_LEVEL,
    VALUE_WORDS,
    m_code,
)

MAX_BLOCK_NUMBER = 999_999_999

_HEADER = re.compile(r"\s*%(?P<local>L(?=\s))?\s*(?P<name>[^\s(;\"\],#$\[]*)\s*(?P<rest>.*)", re.IGNORECASE)
_PLAIN_VALUES = VALUE_WORDS | AXIS_LETTERS
_G_BY_TEXT = {text: code for number_, code in G_CODES.items() for text in (f"{number_}", f"{number_:02d}")}


def parse_program(text: str, file: str, *, mdi: bool = False) -> Program:
    """Parsed program; raises the first syntax error. With `mdi` no program end is asked for (manual blocks)."""
    program, errors = parse_all(text, file, mdi=mdi)
    if errors:
        raise errors[0]
    return program


def parse_all(text: str, file: str, *, mdi: bool = False) -> tuple[Program, list[ProgramError]]:
    """Parsed program and its syntax errors, one a line in their order; a faulty line becomes a block that raises."""
    reader = _Reader(file, mdi)
    lines = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    for line, content in enumerate(lines, start=1):
        reader.read(line, content)
    return reader.finish()


class _Section:
    """One program of the file while it is read."""

    def __init__(self, kind: str, name: str, source: Source) -> None:
        self.kind, self.name, self.source = kind, name, source
        self.blocks: list[Block] = []

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
        if not text or text.isspace():
            return
        source = self.last = Source(self.file, line, 0, text.rstrip())
        try:
            if text.lstrip().startswith("%"):
                self._header(source)
                return
            block = plain_block(source) or careful_block(source)
        except ProgramError as error:
            self.errors.append(error)
            block = Block(source, (), {}, error=error)
        if block is not None:
            if self.current is None:
                self.current = self._section("main program", "", source)
            self.current.blocks.append(block)

    def _header(self, source: Source) -> None:
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
                    column = column_of(block.source, block.call)
                    error = faults.UNKNOWN_SUBROUTINE.at(block.source, column, name=block.call, known=known)
                    self._mark(section, index, error)

    def _check_returns(self, main: _Section) -> None:
        for index, block in enumerate(main.blocks):
            if block.flow == "return":
                code = next(code for code in block.m if code.flow == "return")
                column = column_of(block.source, "M", code.number)
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


def plain_block(source: Source) -> Block | None:
    """Fast way for a line of nothing but known letters with numbers and G codes; None if it needs a careful look."""
    line = source.text.upper()
    if PLAIN_LINE.fullmatch(line) is None or not line.isascii():
        return None
    codes: tuple[GCode, ...] = ()
    words: dict[str, float] = {}
    functions = False
    for letter, text in PLAIN_WORD.findall(line):
        if letter in _PLAIN_VALUES:
            if letter in words:
                return None
            words[letter] = float(text)
            if letter in FUNCTION_WORDS:
                functions = True
        elif letter == "G":
            code = _G_BY_TEXT.get(text)
            if code is None or (codes and any(code.group == other.group for other in codes)):
                return None
            codes += (code,)
        elif letter == "N" and not codes and not words and source.block_number == 0 and text.isdigit():
            source = Source(source.file, source.line, int(text), source.text)
        else:
            return None
    return Block(source, codes, words, functions=functions)


def careful_block(source: Source) -> Block | None:
    """Any line: comments, M functions, names, brackets, calls; raises with the column. None without words."""
    line = normalise(source)
    skip, begin = _skip_level(line, source)
    found = tokens(line, source, begin)
    if not found:
        return None
    if found[0].kind == "word" and found[0].name == "N":
        source = source._replace(block_number=_integer(found[0], source, MAX_BLOCK_NUMBER))
        found = found[1:]
    words = _BlockWords(source)
    for token in found:
        words.take(token)
    return words.block(skip)


def _skip_level(line: str, source: Source) -> tuple[int, int]:
    match = SKIP.match(line)
    if match is None:
        return 0, 0
    level = int(match[1] or "1") if len(match[1]) < 3 else 0
    if not 1 <= level <= MAX_SKIP_LEVEL:
        raise faults.SKIP_LEVEL.at(source, match.start(1) + 1, level=match[1], limit=MAX_SKIP_LEVEL)
    return 1 << (level - 1), match.end()


def _integer(token: Token, source: Source, limit: int) -> int:
    value = float(token.text)
    if value < 0 or value != int(value) or value > limit:
        raise faults.NOT_AN_INTEGER.at(source, token.column, word=token.name, value=token.text, limit=limit)
    return int(value)


class _BlockWords:
    """The words of one block as the careful way collects them."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.codes: list[GCode] = []
        self.m: list[MCode] = []
        self.words: dict[str, float] = {}
        self.spindles: list[SpindleWords] = []
        self.direct: float | None = None
        self.call = ""

    def take(self, token: Token) -> None:
        """Adds one token."""
        if self.call:
            raise faults.WORDS_AFTER_CALL.at(self.source, token.column, word=token.shown)
        _TAKERS[token.kind](self, token)

    def word(self, token: Token) -> None:
        """A letter with a number."""
        if token.name == "G":
            self._g(token)
        elif token.name == "M":
            self._m(token)
        elif token.name == "N":
            raise faults.BLOCK_NUMBER_PLACE.at(self.source, token.column, word=token.shown)
        elif token.name in _PLAIN_VALUES:
            self._value(token)
        else:
            raise faults.UNKNOWN_WORD.at(self.source, token.column, word=token.shown)

    def _g(self, token: Token) -> None:
        value = float(token.text)
        code = G_CODES.get(int(value)) if value == int(value) else None
        if code is None:
            raise faults.UNKNOWN_G.at(self.source, token.column, word=token.shown)
        rival = next((other for other in self.codes if other.group == code.group), None)
        if rival is not None:
            raise self._same_group(token, rival.name, code.name, code.group)
        self.codes.append(code)

    def _m(self, token: Token) -> None:
        value = float(token.text)
        code = m_code(int(value)) if value == int(value) else None
        if code is None:
            raise faults.UNKNOWN_M.at(self.source, token.column, word=token.shown)
        rival = next((other for other in self.m if other.group == code.group), None)
        if rival is not None:
            raise self._same_group(token, rival.name, code.name, code.group)
        self.m.append(code)

    def _same_group(self, token: Token, first: str, second: str, group: str) -> ProgramError:
        return faults.SAME_GROUP.at(self.source, token.column, first=first, second=second, group=group)

    def _value(self, token: Token) -> None:
        value = float(token.text)
        if token.name in self.words:
            fault = faults.DUPLICATE_AXIS if token.name[0] in AXIS_LETTERS else faults.DUPLICATE_WORD
            first, second = number(self.words[token.name]), number(value)
            raise fault.at(self.source, token.column, word=token.name, first=first, second=second)
        self.words[token.name] = value

    def named(self, token: Token) -> None:
        """A longer name with an equals sign: an axis, or a spindle's speed."""
        if token.name[0] in AXIS_LETTERS:
            self._value(token)
        elif token.name[0] == "S":
            self.spindles.append(SpindleWords(token.name, None, float(token.text)))
        else:
            raise faults.UNKNOWN_WORD.at(self.source, token.column, word=token.shown)

    def bracket(self, token: Token) -> None:
        """A spindle's own words: `S2[M3 REV1000]`."""
        if token.name[0] != "S":
            column = token.column + token.shown.index("[")
            raise faults.UNEXPECTED_CHARACTER.at(self.source, column, character="[")
        m: int | None = None
        speed: float | None = None
        for name, text, column in bracket_words(token, self.source):
            value = float(text)
            if name == "REV" and speed is None:
                speed = value
            elif name == "M" and value in (3, 4, 5):
                if m is not None:
                    spindle = token.name
                    raise faults.SPINDLE_M_TWICE.at(self.source, column, first=m, second=int(value), spindle=spindle)
                m = int(value)
            else:
                known = ", ".join(BRACKET_WORDS)
                raise faults.BRACKET_WORD.at(self.source, column, word=name + text, spindle=token.name, known=known)
        if m is None and speed is None:
            raise faults.BRACKET_EMPTY.at(self.source, token.column, spindle=token.name)
        self.spindles.append(SpindleWords(token.name, m, speed))

    def bare(self, token: Token) -> None:
        """A number without a letter: the time of G04."""
        if self.direct is not None or not any(code.own_words for code in self.codes):
            raise faults.NUMBER_WITHOUT_WORD.at(self.source, token.column, word=token.shown)
        self.direct = float(token.text)

    def subroutine(self, token: Token) -> None:
        """`LL name`."""
        ending = next((code for code in self.m if code.flow in ("end", "return")), None)
        if ending is not None:
            raise faults.CALL_AND_END.at(self.source, token.column, word=ending.name)
        self.call = token.name

    def block(self, skip: int) -> Block:
        """The finished block."""
        functions = bool(self.m or self.spindles or FUNCTION_WORDS & self.words.keys())
        flow = next((code.flow for code in self.m if code.flow), "")
        return Block(
            self.source,
            tuple(self.codes),
            self.words,
            tuple(self.m),
            tuple(self.spindles),
            self.direct,
            self.call,
            flow,
            skip,
            functions,
        )


_TAKERS = {
    "word": _BlockWords.word,
    "named": _BlockWords.named,
    "bracket": _BlockWords.bracket,
    "bare": _BlockWords.bare,
    "call": _BlockWords.subroutine,
}
