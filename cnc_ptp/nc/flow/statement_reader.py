"""Reads control statements: `$IF P1 > 3`, `$FOR P1 = 1, 10, 1`, `$GOTO N100`."""

import re
from collections.abc import Callable
from typing import Final

from cnc_ptp.errors import nearest_name
from cnc_ptp.nc.expressions.nodes import Node
from cnc_ptp.nc.expressions.reader import ExpressionReader
from cnc_ptp.nc.flow import flow_faults as faults
from cnc_ptp.nc.flow.lines import Line
from cnc_ptp.nc.flow.statements import (
    Assignment,
    Continue,
    EndDo,
    EndFor,
    EndOfBranch,
    EndWhile,
    For,
    Goto,
    If,
    Mark,
    Return,
    ShortIf,
    Switch,
    While,
)
from cnc_ptp.nc.flow.structures import Control
from cnc_ptp.nc.program import NcBlock

WithWords = Callable[[Line, str, int], NcBlock | None]

WITH_CONDITION: Final = ("$IF", "$ELSEIF", "$CASE", "$WHILE", "$ENDDO", "$UNTIL")
ALONE: Final = (
    *("$ELSE", "$ENDIF", "$ENDSWITCH", "$DEFAULT", "$ENDFOR", "$ENDWHILE"),
    *("$DO", "$REPEAT", "$BREAK", "$CONTINUE", "$RETURN"),
)
KEYWORDS: Final = (*WITH_CONDITION, *ALONE, "$SWITCH", "$FOR", "$GOTO")
_KEYWORD = re.compile(r"\$([A-Z]*)", re.ASCII)
_GOTO = re.compile(r"\s*\$GOTO(?![A-Z])\s*(?:N\s*(\d{1,9})(?![\d.])|\[\s*([A-Z_][A-Z0-9_]*)\s*\])?", re.ASCII)
_ASSIGNS = re.compile(r"\s*=(?!=)", re.ASCII)


def read_statement(line: Line, text: str, begin: int, place: int, read_words: WithWords) -> None:
    """The control statement of a normalised line, from place `begin` on; `place`: that of its $."""
    match = _KEYWORD.match(text, place)
    assert match is not None
    keyword = match[0]
    line.source = line.source._replace(names=(keyword,), columns=(place + 1,))
    if keyword not in KEYWORDS:
        nearest = nearest_name(keyword, list(KEYWORDS))
        raise faults.UNKNOWN_KEYWORD.at(line.source, place + 1, word=keyword, nearest=nearest)
    if keyword == "$GOTO":
        _goto(line, text, begin, place, read_words)
        return
    before = text[begin:place].strip()
    if before:
        column = begin + len(text[begin:]) - len(text[begin:].lstrip()) + 1
        raise faults.WORDS_BEFORE.at(line.source, column, keyword=keyword, word=before)
    line.control = control = Control(keyword, place + 1)
    reader = ExpressionReader(text, line.source, match.end())
    _READERS.get(keyword, _alone)(line, reader, keyword, place + 1)
    if keyword in ("$ELSEIF", "$CASE"):
        control.synchronises = reader.synchronises
        return
    line.synchronises = reader.synchronises


def _alone(line: Line, reader: ExpressionReader, keyword: str, column: int) -> None:
    _require_end(line, reader, keyword)
    if keyword in ("$ELSE", "$BREAK"):
        line.statement = EndOfBranch(column)
    elif keyword == "$ENDWHILE":
        line.statement = EndWhile(column)
    elif keyword == "$ENDFOR":
        line.statement = EndFor(column)
    elif keyword == "$CONTINUE":
        line.statement = Continue(column)
    elif keyword == "$RETURN":
        line.statement = Return(column)
    else:
        line.statement = Mark(column)


def _require_end(line: Line, reader: ExpressionReader, keyword: str) -> None:
    if reader.skip_blanks() >= len(reader.line):
        return
    fault = {"$WHILE": faults.WORDS_AFTER_WHILE, "$BREAK": faults.WORDS_AFTER_BREAK}.get(keyword, faults.WORDS_AFTER)
    if reader.line[reader.at] == "=":
        raise reader.equals(reader.at)
    second = _KEYWORD.match(reader.line, reader.at)
    if second is not None:
        raise fault.at(line.source, reader.at + 1, word=second[0], keyword=keyword)
    raise fault.at(line.source, reader.at + 1, word=reader.word(), keyword=keyword)


def _condition(line: Line, reader: ExpressionReader, keyword: str) -> Node:
    if reader.skip_blanks() >= len(reader.line):
        raise faults.CONDITION_MISSING.at(line.source, reader.at + 1, keyword=keyword)
    return reader.expression()


def _if(line: Line, reader: ExpressionReader, keyword: str, column: int) -> None:
    condition = _condition(line, reader, keyword)
    if _GOTO.match(reader.line, reader.at):
        reader.at = _target(line, reader.line, reader.at)
        _require_end(line, reader, "$GOTO")
        line.control, line.statement = None, ShortIf(column, condition)
        return
    _require_end(line, reader, keyword)
    assert line.control is not None
    line.control.condition, line.statement = condition, If(column)


def _branch(line: Line, reader: ExpressionReader, keyword: str, column: int) -> None:
    """$ELSEIF, $CASE."""
    condition = _condition(line, reader, keyword)
    _require_end(line, reader, keyword)
    assert line.control is not None
    line.control.condition = condition
    line.statement = EndOfBranch(column) if keyword == "$ELSEIF" else Mark(column)


def _while(line: Line, reader: ExpressionReader, keyword: str, column: int) -> None:
    condition = _condition(line, reader, keyword)
    _require_end(line, reader, keyword)
    line.statement = While(column, condition)


def _end_do(line: Line, reader: ExpressionReader, keyword: str, column: int) -> None:
    condition = _condition(line, reader, keyword)
    _require_end(line, reader, keyword)
    line.statement = EndDo(column, condition, until=keyword == "$UNTIL")


def _switch(line: Line, reader: ExpressionReader, keyword: str, column: int) -> None:
    begin = reader.at
    target = reader.target() if reader.word() else None
    assigned: Assignment | None = None
    found = _ASSIGNS.match(reader.line, reader.at) if target is not None else None
    if target is not None and found is not None:
        reader.at = found.end()
        assigned = Assignment(column, target, reader.expression())
        value: Node = target
    else:
        reader.at = begin
        value = _condition(line, reader, keyword)
    _require_end(line, reader, keyword)
    line.statement = Switch(column, value, assigned)


def _for(line: Line, reader: ExpressionReader, keyword: str, column: int) -> None:
    begin = reader.skip_blanks()
    counter = reader.target()
    if counter is None:
        raise faults.COUNTER.at(line.source, begin + 1, word=reader.word())
    if not reader.follows("="):
        raise faults.COUNTER_EQUALS.at(line.source, reader.at + 1)
    values = [reader.expression()]
    for _ in range(2):
        if not reader.follows(","):
            raise faults.COUNTER_COMMA.at(line.source, reader.at + 1)
        values.append(reader.expression())
    _require_end(line, reader, keyword)
    line.statement = For(column, counter, values)


def _target(line: Line, text: str, place: int) -> int:
    """Notes the label of a $GOTO; the place behind it."""
    match = _GOTO.match(text, place)
    assert match is not None
    if match[1] is None and match[2] is None:
        rest = text[match.end() :].strip()
        if not rest:
            raise faults.LABEL_MISSING.at(line.source, match.end() + 1)
        raise faults.LABEL_TARGET.at(line.source, text.index(rest, match.end()) + 1, word=rest.split()[0])
    line.jump = f"N{int(match[1])}" if match[1] is not None else f"[{match[2]}]"
    line.jump_column = match.start(1 if match[1] is not None else 2) + 1
    return match.end()


def _goto(line: Line, text: str, begin: int, place: int, read_words: WithWords) -> None:
    """$GOTO, with other words of the line before and after it."""
    end = _target(line, text, place)
    rest = text[begin:place] + " " * (end - place) + text[end:]
    if "$" in rest:
        second = _KEYWORD.search(text, end)
        assert second is not None
        raise faults.WORDS_AFTER.at(line.source, second.start() + 1, word=second[0], keyword="$GOTO")
    block = read_words(line, text[:begin] + rest, begin)
    line.statement = Goto(place + 1, line.statement, block)


_READERS: Final = {
    "$IF": _if,
    "$ELSEIF": _branch,
    "$CASE": _branch,
    "$WHILE": _while,
    "$ENDDO": _end_do,
    "$UNTIL": _end_do,
    "$SWITCH": _switch,
    "$FOR": _for,
}
