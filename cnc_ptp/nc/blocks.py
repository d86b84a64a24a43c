"""One line of text -> one block: known words, at most one code of a group and one word of a kind per block.

Two methods with the same result: a fast one for lines of letters with numbers only, a careful one for everything
else, which also finds the column of an error.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise
from typing import Final

from cnc_ptp.nc import faults, feedforward, friction_switch
from cnc_ptp.nc.canonical import CompensationSwitch, Source, SpindleFeedforward, number
from cnc_ptp.nc.expressions.nodes import Node
from cnc_ptp.nc.expressions.values import Values
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow import flow_faults
from cnc_ptp.nc.flow.calls import call_of
from cnc_ptp.nc.flow.lines import Flow, Line, Statement
from cnc_ptp.nc.flow.statement_reader import read_statement
from cnc_ptp.nc.flow.statements import Assignment, Assignments
from cnc_ptp.nc.gears import GEAR_M
from cnc_ptp.nc.hash_commands import hash_line
from cnc_ptp.nc.lexer import SKIP, Token, TokenReader, normalise, places, plain_words
from cnc_ptp.nc.program import GCode, MCode, NcBlock, SpindleWords
from cnc_ptp.nc.program_text import ProgramText
from cnc_ptp.nc.spindle_words import spindle_bracket
from cnc_ptp.nc.vocabulary import (
    AXIS_LETTERS,
    FUNCTION_WORDS,
    G_CODES,
    M_CODES,
    MAX_SKIP_LEVEL,
    VALUE_WORDS,
    m_code,
)

MAX_BLOCK_NUMBER = 999_999_999
LONGEST_BLOCK: Final = 4000
"""Characters of a block, as the vendor has it."""
SHOWN: Final = 60
"""Characters of a longer one that its error shows."""

_TEXT = re.compile(r'"[^"]*"?')
_LABEL_NUMBER = re.compile(r"\s*N\s*(\d{1,9})\s*:", re.ASCII)
_BLOCK_NUMBER = re.compile(r"\s*N\s*(\d{1,9})(?![\d.])", re.ASCII)
_LABEL_NAME = re.compile(r"\s*\[\s*([A-Z_][A-Z0-9_]*)\s*\]", re.ASCII)


def is_plain(code: GCode) -> bool:
    """A code whose line the fast method may read."""
    return not (code.spindle or code.valued or code.later)


_PLAIN_VALUES = VALUE_WORDS | AXIS_LETTERS
_PLAIN_CODES = {float(number_): code for number_, code in G_CODES.items() if is_plain(code)}
_PLAIN_NAMES = {code.number: code.name for code in G_CODES.values()}


def plain_block(file: str, line: int, text: str) -> NcBlock | None:
    """The fast method, for known letters with numbers and G codes only; None if the line needs the careful one."""
    names, values, columns = plain_words(text)
    if not names:
        return None
    codes: tuple[GCode, ...] = ()
    words: dict[str, float] = {}
    functions = False
    block_number = 0
    for index in range(len(names)):
        letter, value = names[index], values[index]
        if letter in _PLAIN_VALUES:
            if letter in words:
                return None
            words[letter] = value
            if letter in FUNCTION_WORDS:
                functions = True
        elif letter == "G":
            code = _PLAIN_CODES.get(value)
            if code is None or (codes and any(code.group == other.group for other in codes)):
                return None
            codes += (code,)
            names[index] = _PLAIN_NAMES[code.number]
        elif letter == "N" and index == 0 and value >= 0.0 and value == int(value):
            block_number = int(value)
        else:
            return None
    source = Source(file, line, block_number, text, tuple(names), tuple(columns))
    return NcBlock(source, codes, words, (), (), None, "", functions)


def read_line(file: str, text: ProgramText, number: int, offset: int) -> Line:
    """The line that begins at `offset`; a syntax error is kept in it."""
    content, next_offset = text.line_at(offset)
    content = content.rstrip()
    next_number = number + 1
    block = plain_block(file, number, content) if len(content) <= LONGEST_BLOCK else None
    if block is not None:
        line = Line(number, block.source, next_number, next_offset)
        line.block = block
        return line
    while continues(content) and next_offset >= 0 and len(content) <= LONGEST_BLOCK:
        more, next_offset = text.line_at(next_offset)
        content = content[:-1] + " " + more.rstrip()
        next_number += 1
    source = Source(file, number, 0, content[:LONGEST_BLOCK])
    line = Line(number, source, next_number, next_offset)
    if not content:
        return line
    try:
        if len(content) > LONGEST_BLOCK:
            shown = source._replace(text=content[:SHOWN])
            raise flow_faults.LINE_TOO_LONG.at(shown, LONGEST_BLOCK + 1, length=len(content), limit=LONGEST_BLOCK)
        if content.lstrip().startswith("%"):
            line.header = True
        else:
            careful_line(line)
    except ProgramError as error:
        line.error = error
    return line


def continues(content: str) -> bool:
    """A backslash at the end that is not in a comment: the next line belongs to this one."""
    return content.endswith("\\") and ";" not in content and content.rfind("(") <= content.rfind(")")


def careful_line(line: Line) -> None:
    """Any line: comments, M functions, names, brackets, expressions, statements, calls; raises with the column."""
    text = normalise(line.source)
    line.skip, begin = _skip_level(text, line.source)
    begin = _take_labels(line, text, begin)
    outside = _TEXT.sub(lambda found: " " * len(found[0]), text) if '"' in text else text
    if "$" in outside:
        read_statement(line, text, begin, outside.index("$"), read_words)
    elif "#" in outside and hash_line(line, text, begin, outside):
        return
    else:
        line.block = read_words(line, text, begin)


def _take_labels(line: Line, text: str, begin: int) -> int:
    """Block number and label at the start of a line; the place behind them."""
    numbered = False
    while True:
        label, block_number = _LABEL_NUMBER.match(text, begin), _BLOCK_NUMBER.match(text, begin)
        name = _LABEL_NAME.match(text, begin)
        if label is not None or block_number is not None:
            found = label or block_number
            assert found is not None
            place = found.end() - len(found[0].lstrip()) + 1
            if numbered:
                raise faults.BLOCK_NUMBER_TWICE.at(line.source, place, word=found[0].strip())
            numbered = True
            line.source = line.source._replace(block_number=int(found[1]), names=("N",), columns=(place,))
            if label is not None:
                line.label, line.label_column = f"N{int(found[1])}", place
        elif name is not None and not line.label:
            found = name
            line.label, line.label_column = f"[{name[1]}]", name.start(1)
        else:
            return begin
        begin = found.end()


def read_words(line: Line, text: str, begin: int) -> NcBlock | None:
    """The words from a place on: a block of numbers, or in `line.statement` what has to be evaluated first."""
    reader = TokenReader(text, line.source)
    found = reader.tokens(begin)
    if not found:
        return None
    line.synchronises = reader.synchronises
    names, columns = places(found)
    before = line.source
    line.source = before._replace(names=(*before.names, *names), columns=(*before.columns, *columns))
    ending = ending_of(found)
    line.flow = "" if ending is None else ending.flow
    for token, after in pairwise(found):
        if token.kind == "call":
            raise faults.WORDS_AFTER_CALL.at(line.source, after.column, word=after.shown)
    if found[-1].kind == "call":
        line.call = call_of(found.pop(), line.source)
        line.call.synchronises = reader.call_synchronises
        if ending is not None:
            raise faults.CALL_AND_END.at(line.source, line.call.column, word=ending.name)
    if not any(token.dynamic or token.target is not None for token in found):
        return _fixed_block(line, found)
    if all(token.target is not None for token in found):
        parts = [_assignment(token) for token in found]
        line.statement = parts[0] if len(parts) == 1 else Assignments(parts[0].column, parts)
        return None
    line.statement = ComputedWords(found[0].column, found)
    return None


def ending_of(found: Sequence[Token]) -> MCode | None:
    """The M function of a line that ends the program or the subroutine."""
    for token in found:
        if token.kind == "word" and token.name == "M" and token.value is None:
            code = m_code(int(float(token.text)))
            if code is not None and code.flow in ("end", "return"):
                return code
    return None


def _fixed_block(line: Line, found: Sequence[Token]) -> NcBlock | None:
    if not found:
        return None
    words = BlockWords(line.source)
    for token in found:
        words.take(token)
    return words.block()


def _assignment(token: Token) -> Assignment:
    assert token.target is not None and token.value is not None
    return Assignment(token.column, token.target, token.value)


class ComputedWords(Statement):
    """Words with expressions, and assignments among them, in their order."""

    def __init__(self, column: int, tokens_: Sequence[Token]) -> None:
        super().__init__(column)
        self.tokens = tokens_

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        values = execution.values
        words = BlockWords(line.source)
        for token in self.tokens:
            if token.target is not None:
                _assignment(token).assign(values)
            elif token.value is not None:
                words.take(token._replace(text=repr(bounded(token, token.value.value(values), values))))
            elif token.parts:
                words.take(token._replace(text="".join(_part(part, token, values) for part in token.parts)))
            else:
                words.take(token)
        return words.block()


def bounded(token: Token, value: float, values: Values) -> float:
    """The value of a word, which may be as large as one that is written with its digits. Raises ProgramError."""
    return values.bounded(value, token.column, token.name or "G04")


def _part(part: str | Node, token: Token, values: Values) -> str:
    """Text of a bracket with the number in place of an expression."""
    return part if isinstance(part, str) else f"{bounded(token, part.value(values), values):.12f}"


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


class BlockWords:
    """The words of one block as the careful method collects them."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.codes: list[GCode] = []
        self.m: list[MCode] = []
        self.words: dict[str, float] = {}
        self.spindles: list[SpindleWords] = []
        self.controls: list[SpindleFeedforward | CompensationSwitch] = []
        self.direct: float | None = None
        self.values: dict[str, float] = {}

    def take(self, token: Token) -> None:
        """Adds one token."""
        _TAKERS[token.kind](self, token)

    def word(self, token: Token) -> None:
        """A letter with a number."""
        if token.name == "G":
            self._g(token)
        elif token.name == "M":
            self._m(token)
        elif token.name == "N":
            _integer(token, self.source, MAX_BLOCK_NUMBER)
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
        if code.later:
            raise faults.LATER.at(self.source, token.column, g=code.name, what=code.later)
        if code.valued:
            raise faults.CODE_VALUE.at(self.source, token.column, g=code.name)
        self._check_group(token, code, self.codes)
        self.codes.append(code)

    def _m(self, token: Token) -> None:
        value = float(token.text)
        code = m_code(int(value)) if value == int(value) else None
        if code is None:
            raise faults.UNKNOWN_M.at(self.source, token.column, word=token.shown)
        self._check_group(token, code, self.m)
        self.m.append(code)

    def _check_group(self, token: Token, code: GCode | MCode, before: Sequence[GCode | MCode]) -> None:
        rival = next((other for other in before if other.group == code.group), None)
        if rival is None:
            return
        if rival.number == code.number:
            raise faults.TWICE.at(self.source, token.column, word=code.name)
        names = {"first": rival.name, "second": code.name, "group": code.group}
        raise faults.SAME_GROUP.at(self.source, token.column, **names)

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
            self.spindles.append(SpindleWords(token.name, None, float(token.text), din=True))
        else:
            raise faults.UNKNOWN_WORD.at(self.source, token.column, word=token.shown)

    def valued(self, token: Token) -> None:
        """A code with a value: G159=2; M and H functions pass theirs to the PLC: M52=-345."""
        if token.name[0] != "G":
            self._function_value(token)
            return
        number_ = int(token.name[1:])
        code = G_CODES.get(number_)
        if code is None:
            raise faults.UNKNOWN_G.at(self.source, token.column, word=token.shown)
        if not code.valued:
            raise faults.CODE_NO_VALUE.at(self.source, token.column, code=token.name)
        self._check_group(token, code, self.codes)
        self.codes.append(code)
        self.values[code.name] = float(token.text)

    def _function_value(self, token: Token) -> None:
        """An integer for a free function; those of spindles, gears and the program flow take none."""
        code, value = token._replace(name=token.name[0], text=token.name[1:]), float(token.text)
        if code.name == "M" and (int(code.text) in M_CODES or int(code.text) in GEAR_M):
            raise faults.CODE_NO_VALUE.at(self.source, token.column, code=token.name)
        if value != int(value):
            raise faults.CODE_INTEGER.at(self.source, token.column, code=token.name, value=number(value))
        self.word(code)
        self.values[token.name] = value

    def position(self, token: Token) -> None:
        """The position of M19: `S.POS=90`."""
        name = token.name.removesuffix(".POS")
        self.spindles.append(SpindleWords(name, None, None, float(token.text), din=True))

    def bracket(self, token: Token) -> None:
        """A spindle's own words: `S2[M3 REV1000]`, `S[G135 G136=80]`; an axis': `X[COMP ON FRICT]`."""
        if token.name[0] in AXIS_LETTERS:
            self.controls.append(friction_switch.bracket(token, self.source))
            return
        if token.name[0] == "S" and feedforward.is_in(token):
            self.controls.append(feedforward.bracket(token, self.source))
            return
        if token.name[0] != "S":
            column = token.column + token.shown.index("[")
            raise faults.UNEXPECTED_CHARACTER.at(self.source, column, character="[")
        self.spindles.append(spindle_bracket(token, self.source))

    def bare(self, token: Token) -> None:
        """A number without a letter: the time of G04."""
        if self.direct is not None or not any(code.own_words for code in self.codes):
            raise faults.NUMBER_WITHOUT_WORD.at(self.source, token.column, word=token.shown)
        self.direct = float(token.text)

    def block(self) -> NcBlock:
        """The finished block."""
        functions = bool(self.m or self.spindles or not FUNCTION_WORDS.isdisjoint(self.words))
        functions = functions or any(code.spindle for code in self.codes)
        flow = next((code.flow for code in self.m if code.flow), "")
        return NcBlock(
            self.source,
            tuple(self.codes),
            self.words,
            tuple(self.m),
            tuple(self.spindles),
            self.direct,
            flow,
            functions,
            controls=tuple(self.controls),
            values=self.values or None,
        )


_TAKERS = {
    "word": BlockWords.word,
    "named": BlockWords.named,
    "position": BlockWords.position,
    "bracket": BlockWords.bracket,
    "bare": BlockWords.bare,
    "valued": BlockWords.valued,
}
