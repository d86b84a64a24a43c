"""One line of text -> one block: known words, at most one code of a group and one word of a kind per block.

Two methods with the same result: a fast one for lines of letters with numbers only, a careful one for everything
else, which also finds the column of an error.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise
from typing import Final

from cnc_ptp.nc import faults
from cnc_ptp.nc.block_words import BlockWords
from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.expressions.nodes import Node
from cnc_ptp.nc.expressions.values import Values
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow import flow_faults
from cnc_ptp.nc.flow.calls import call_of
from cnc_ptp.nc.flow.lines import Flow, Line, Statement
from cnc_ptp.nc.flow.statement_reader import read_statement
from cnc_ptp.nc.flow.statements import Assignment, Assignments
from cnc_ptp.nc.hash_commands import hash_line
from cnc_ptp.nc.iso.lines import iso_line
from cnc_ptp.nc.iso.vocabulary import ISO
from cnc_ptp.nc.lexer import SKIP, Token, TokenReader, normalise, places, plain_words
from cnc_ptp.nc.program import GCode, MCode, NcBlock, Vocabulary
from cnc_ptp.nc.program_text import ProgramText
from cnc_ptp.nc.vocabulary import MAX_SKIP_LEVEL, TWINCAT

LONGEST_BLOCK: Final = 4000
"""Characters of a block, as the vendor has it."""
SHOWN: Final = 60
"""Characters of a longer one that its error shows."""

_TEXT = re.compile(r'"[^"]*"?')
_LABEL_NUMBER = re.compile(r"\s*N\s*(\d{1,9})\s*:", re.ASCII)
_BLOCK_NUMBER = re.compile(r"\s*N\s*(\d{1,9})(?![\d.])", re.ASCII)
_LABEL_NAME = re.compile(r"\s*\[\s*([A-Z_][A-Z0-9_]*)\s*\]", re.ASCII)


def plain_block(file: str, line: int, text: str, vocabulary: Vocabulary) -> NcBlock | None:
    """The fast method, for known letters with numbers and G codes only; None if the line needs the careful one."""
    names, values, columns = plain_words(text)
    if not names:
        return None
    plain, function_words = vocabulary.plain_words, vocabulary.function_words
    plain_codes, plain_names = vocabulary.plain_codes, vocabulary.plain_names
    codes: tuple[GCode, ...] = ()
    words: dict[str, float] = {}
    functions = False
    block_number = 0
    for index in range(len(names)):
        letter, value = names[index], values[index]
        if letter in plain:
            if letter in words:
                return None
            words[letter] = value
            if letter in function_words:
                functions = True
        elif letter == "G":
            code = plain_codes.get(value)
            if code is None or (codes and any(code.group == other.group for other in codes)):
                return None
            codes += (code,)
            names[index] = plain_names[value]
        elif letter == "N" and index == 0 and value >= 0.0 and value == int(value):
            block_number = int(value)
        else:
            return None
    source = Source(file, line, block_number, text, tuple(names), tuple(columns))
    return NcBlock(source, codes, words, (), (), None, "", functions)


def read_line(file: str, text: ProgramText, number: int, offset: int, vocabulary: Vocabulary) -> Line:
    """The line that begins at `offset`; a syntax error is kept in it."""
    content, next_offset = text.line_at(offset)
    content = content.rstrip()
    next_number = number + 1
    is_iso = vocabulary is ISO
    plain = len(content) <= LONGEST_BLOCK and not (is_iso and "=" in content)
    block = plain_block(file, number, content, vocabulary) if plain else None
    if block is not None:
        line = Line(number, block.source, next_number, next_offset)
        line.block = block
        return line
    while not is_iso and continues(content) and next_offset >= 0 and len(content) <= LONGEST_BLOCK:
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
        if is_iso:
            iso_line(line)
        elif content.lstrip().startswith("%"):
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
            code = TWINCAT.m_code(int(float(token.text)))
            if code is not None and code.flow in ("end", "return"):
                return code
    return None


def _fixed_block(line: Line, found: Sequence[Token]) -> NcBlock | None:
    if not found:
        return None
    words = BlockWords(line.source, TWINCAT)
    for token in found:
        words.take(token)
    return words.block()


def _assignment(token: Token) -> Assignment:
    assert token.target is not None and token.value is not None
    return Assignment(token.column, token.target, token.value)


class ComputedWords(Statement):
    """Words with expressions, and assignments among them, in their order."""

    def __init__(self, column: int, tokens_: Sequence[Token]) -> None:
        super().__init__(column, independent=all(token.target is None for token in tokens_))
        self.tokens = tokens_

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        values = execution.values
        words = BlockWords(line.source, TWINCAT)
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
