"""Lexical rules: one line of program text -> tokens with their columns.

A word is a letter with a number (`X10`, `G01`, `X=10`), with or without blanks around it. A longer name needs an equals
sign (`Y_ACHSE=5`, `X1=10`), a spindle takes a bracket (`S2[M3 REV1000]`) and a position (`S.POS=90`), `LL name` calls
a subroutine, a bare number belongs to G04.
`( )` comments nest and end at the line's end at the latest, `;` starts a comment up to the line's end.
"""

import re
from collections.abc import Sequence
from typing import Final, NamedTuple

from cnc_ptp.nc import faults
from cnc_ptp.nc.canonical import CODES, Source, code_name

MAX_DIGITS: Final = 9
NUMBER = r"[+-]?(?:\d{1,9}+(?:\.\d*+)?+|\.\d++)"
_NAME = r"[A-Z_][A-Z0-9_]*+"

MAX_EXACT_DIGITS: Final = 15
"""Digits of a number and of a power of ten up to which their quotient is the nearest number, as `float` finds it."""
POWERS_OF_TEN: Final = [10.0**power for power in range(MAX_EXACT_DIGITS + 1)]
BLANK: Final = 32
TAB: Final = 9
PLUS: Final = 43
MINUS: Final = 45
POINT: Final = 46
EQUALS: Final = 61
ZERO: Final = 48
NINE: Final = 57
UPPER_A: Final = 65
UPPER_Z: Final = 90
TO_LOWER: Final = 32
"""Characters as numbers, which the compiler compares at once."""

_TOKEN = re.compile(
    rf"""\s*(?:
      (?P<call> LL\s+ (?P<callee>[^\s"\],#$\[]+) )
    | (?P<position> (?P<positioned>{_NAME}) \s*\.\s* POS \s*=?\s* (?P<angle>{NUMBER}) (?![\d.]) )
    | (?P<word> (?P<letter>[A-Z]) \s*=?\s* (?P<number>{NUMBER}) (?!\s*[=\[]|[\d.]) )
    | (?P<named> (?P<name>{_NAME}) \s*=\s* (?P<value>{NUMBER}) (?![\d.]) )
    | (?P<bracket> (?P<owner>{_NAME}) \s*\[ (?P<inside>[^\[\]]*) \] )
    | (?P<bare> {NUMBER} (?![\d.]) )
    )""",
    re.ASCII | re.VERBOSE,
)
_KINDS = ("call", "position", "word", "named", "bracket", "bare")
_BRACKET_WORD = re.compile(rf"\s*([A-Z_]+)\s*=?\s*({NUMBER})(?![\d.])", re.ASCII)
_BRACKET_CODE = re.compile(r"\b([GM])\s*=?\s*(\d{1,9})(?![\d.])", re.ASCII)
_BRACKET_NAME = re.compile(r"\s*([A-Z_]{2,}+)()(?=\s|$)", re.ASCII)
_UNREADABLE = re.compile(r"[A-Z]{2,}|[A-Z]\s*=?\s*[^\sA-Z(\[]*|[#$]\s*\w*|[\d.+-]+|.", re.ASCII | re.DOTALL)


SKIP = re.compile(r"\s*/(\d*)", re.ASCII)
"""Block skip at the start of a line, with its level."""


class Token(NamedTuple):
    """`kind`: call, position, word, named, bracket, bare; `column` from 1.

    `name`: letter or name (S.POS for a position), `text`: number or content.
    """

    kind: str
    name: str
    text: str
    column: int
    shown: str


def plain_words(line: str) -> tuple[list[str], list[float], list[int]]:
    """Letters, numbers and columns (from 1) of a line that has nothing else; empty for any other line."""
    letters: list[str] = []
    values: list[float] = []
    columns: list[int] = []
    at, end = 0, len(line)
    while at < end:
        character = ord(line[at])
        if character in (BLANK, TAB):
            at += 1
            continue
        if character > UPPER_Z:
            character -= TO_LOWER
        if not UPPER_A <= character <= UPPER_Z:
            return [], [], []
        letters.append(chr(character))
        at += 1
        columns.append(at)
        at, value = plain_number(line, at, end)
        if at < 0:
            return [], [], []
        values.append(value)
    return letters, values, columns


def plain_number(line: str, at: int, end: int) -> tuple[int, float]:
    """The place behind the number at `at`, which an equals sign may precede, and its value; -1 if there is none."""
    signs = 0
    while at < end:
        character = ord(line[at])
        if character == EQUALS:
            signs += 1
        elif character != BLANK and character != TAB:
            break
        at += 1
    if at == end or signs > 1:
        return -1, 0.0
    negative = ord(line[at]) == MINUS
    if negative or ord(line[at]) == PLUS:
        at += 1
    all_digits, digits, decimals = 0, 0, -1
    while at < end:
        character = ord(line[at])
        if ZERO <= character <= NINE:
            all_digits = 10 * all_digits + character - ZERO
            digits += 1
            decimals += decimals >= 0
        elif character == POINT and decimals < 0:
            decimals = 0
        else:
            break
        at += 1
    if not 0 < digits <= MAX_EXACT_DIGITS or digits - max(0, decimals) > MAX_DIGITS:
        return -1, 0.0
    value = float(all_digits)
    if decimals > 0:
        value /= POWERS_OF_TEN[decimals]
    return at, -value if negative else value


def normalise(source: Source) -> str:
    """The line in upper case with blanks in place of comments, so that columns stay; error on a ')' without '('."""
    text = source.text
    if "(" in text or ";" in text or ")" in text:
        text = _blank_comments(source)
    if text.isascii():
        return text.upper()
    column = next(index for index, character in enumerate(text) if not character.isascii())
    raise faults.UNEXPECTED_CHARACTER.at(source, column + 1, character=text[column])


def _blank_comments(source: Source) -> str:
    depth = 0
    kept: list[str] = []
    for column, character in enumerate(source.text, start=1):
        if depth == 0 and character == ";":
            break
        if character == ")" and depth == 0:
            raise faults.COMMENT_NOT_OPEN.at(source, column)
        depth += (character == "(") - (character == ")")
        kept.append(" " if depth or character == ")" else character)
    return "".join(kept)


def tokens(line: str, source: Source, begin: int = 0) -> list[Token]:
    """All tokens of a normalised line from index `begin` on; the first unreadable place raises."""
    found: list[Token] = []
    position, length = begin, len(line.rstrip())
    while position < length:
        match = _TOKEN.match(line, position)
        if match is None:
            raise _unreadable(line, source, position)
        found.append(_token(match))
        position = match.end()
    return found


def _token(match: "re.Match[str]") -> Token:
    part = match.groupdict()
    kind = next(kind for kind in _KINDS if part[kind] is not None)
    if kind == "position":
        return Token(kind, f"{part['positioned']}.POS", part["angle"], match.start(kind) + 1, part[kind])
    name = part["callee"] or part["letter"] or part["name"] or part["owner"] or ""
    text = part["number"] or part["value"] or part["inside"] or part["bare"] or ""
    return Token(kind, name, text, match.start(kind) + 1, part[kind])


def bracket_words(token: Token, source: Source) -> list[tuple[str, str, int]]:
    """Words inside the bracket of a token: (name, number text, column); no number behind a longer name."""
    words: list[tuple[str, str, int]] = []
    begin = token.column + token.shown.index("[")
    position, length = 0, len(token.text.rstrip())
    while position < length:
        match = _BRACKET_WORD.match(token.text, position) or _BRACKET_NAME.match(token.text, position)
        if match is None:
            blank = len(token.text[position:]) - len(token.text[position:].lstrip())
            rest = token.text[position:].split()[0]
            raise faults.BAD_NUMBER.at(source, begin + position + blank + 1, word=rest)
        words.append((match[1], match[2], begin + match.start(1) + 1))
        position = match.end()
    return words


def places(found: Sequence[Token]) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """Names and columns of words and codes, also of codes in brackets, for `Source.column`."""
    names: list[str] = []
    columns: list[int] = []
    for token in found:
        is_code = token.kind == "word" and token.name in CODES and float(token.text) >= 0.0
        names.append(code_name(token.name, int(float(token.text))) if is_code else token.name)
        columns.append(token.column)
        if token.kind == "bracket":
            begin = token.column + token.shown.index("[") + 1
            for code in _BRACKET_CODE.finditer(token.text):
                names.append(code_name(code[1], int(code[2])))
                columns.append(begin + code.start())
    return tuple(names), tuple(columns)


def _unreadable(line: str, source: Source, position: int) -> faults.ProgramError:
    while line[position].isspace():
        position += 1
    match = _UNREADABLE.match(line, position)
    shown = match[0].strip() if match else line[position]
    return _fault_of(shown, line, position).at(
        source, position + 1, word=shown, character=line[position], limit=MAX_DIGITS
    )


def _fault_of(shown: str, line: str, position: int) -> faults.Fault:
    if shown[0] in "#$":
        return faults.COMMAND_UNKNOWN
    if "[" in line[position:] and re.match(rf"{_NAME}\s*\[", line[position:], re.ASCII):
        return faults.BRACKET_OPEN
    if re.search(rf"(?<![.\d])\d{{{MAX_DIGITS + 1}}}", shown):
        return faults.NUMBER_TOO_LONG
    if len(shown) > 1 and shown.isalpha():
        return faults.UNKNOWN_WORD
    return faults.BAD_NUMBER if shown[0].isalnum() or shown[0] in "+-." else faults.UNEXPECTED_CHARACTER
