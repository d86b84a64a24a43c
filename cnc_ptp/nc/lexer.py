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
from cnc_ptp.nc.expressions import expression_faults
from cnc_ptp.nc.expressions.nodes import (
    Add,
    Divide,
    Multiply,
    Node,
    Subtract,
)
from cnc_ptp.nc.expressions.reader import CONTINUES, CONTINUES_BEHIND_EQUALS, FILLS, OPENS, Assignable, ExpressionReader
from cnc_ptp.nc.flow import flow_faults

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
      (?P<call> (?P<scope>LL?)\s+ (?P<callee>[^\s"\],#$\[]+) )
    | (?P<position> (?P<positioned>{_NAME}) \s*\.\s* POS \s*=?\s* (?P<angle>{NUMBER}) (?![\d.]) )
    | (?P<offset> (?P<shifted>{_NAME}) \s*\.\s* OFFSET \s*=?\s* (?P<shift>{NUMBER}) (?![\d.]) )
    | (?P<word> (?P<letter>[A-Z]) \s*=?\s* (?P<number>{NUMBER}) (?!\s*[=\[]|[\d.]) )
    | (?P<named> (?P<name>{_NAME}) \s*=\s* (?P<value>{NUMBER}) (?![\d.]) )
    | (?P<bracket> (?P<owner>{_NAME}) \s*\[ (?P<inside>(?:[^\[\]\"]++|\[[^\[\]]*+\])*+) \] )
    | (?P<bare> {NUMBER} (?![\d.]) )
    )""",
    re.ASCII | re.VERBOSE,
)
_KINDS = ("call", "position", "offset", "word", "named", "bracket", "bare")
_BRACKET_WORD = re.compile(rf"\s*([A-Z_]+)\s*=?\s*({NUMBER})(?![\d.])", re.ASCII)
_BRACKET_CODE = re.compile(r"\b([GM])\s*=?\s*(\d{1,9})(?![\d.])", re.ASCII)
_BRACKET_NAME = re.compile(r"\s*([A-Z_]{2,}+)()(?=\s|$)", re.ASCII)
_UNREADABLE = re.compile(r"\"[^\"]*\"?|[A-Z]{2,}|[A-Z]\s*=?\s*[^\sA-Z(\[]*|[#$]\s*\w*|[\d.+-]+|.", re.ASCII | re.DOTALL)


SKIP = re.compile(r"\s*/(\d*)", re.ASCII)
"""Block skip at the start of a line, with its level."""


class Token(NamedTuple):
    """`kind`: call, position, offset, word, named, valued, bracket, bare, assignment; `column` from 1.

    `name`: letter or name (S.POS for a position, G159 for a code with a value), `text`: number or content. `value`: in
    place of the number an expression; `parts`: the content of a bracket with expressions; `target`: what is assigned.
    """

    kind: str
    name: str
    text: str
    column: int
    shown: str
    value: Node | None = None
    parts: Sequence[str | Node] = ()
    target: Assignable | None = None
    arguments: Sequence[tuple[str, Node]] = ()

    @property
    def dynamic(self) -> bool:
        """It has to be evaluated before it is a word."""
        return self.value is not None or bool(self.parts)


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
    """The line in upper case with blanks in place of comments, so that columns stay; texts in quotation marks stay.

    Raises ProgramError for a ')' without '(' and for a character that is not ASCII.
    """
    text = source.text
    if "(" in text or ";" in text or ")" in text:
        text = _blank_comments(source)
    if '"' in text:
        return _upper_outside_quotes(text, source)
    if text.isascii():
        return text.upper()
    raise _not_ascii(text, source, 0)


def _not_ascii(text: str, source: Source, begin: int) -> faults.ProgramError:
    column = begin + next(index for index, character in enumerate(text) if not character.isascii())
    return faults.UNEXPECTED_CHARACTER.at(source, column + 1, character=source.text[column])


def _upper_outside_quotes(text: str, source: Source) -> str:
    parts = text.split('"')
    begin = 0
    for index, part in enumerate(parts):
        if index % 2 == 0:
            if not part.isascii():
                raise _not_ascii(part, source, begin)
            parts[index] = part.upper()
        begin += len(part) + 1
    return '"'.join(parts)


def _blank_comments(source: Source) -> str:
    depth = 0
    quoted = False
    kept: list[str] = []
    for column, character in enumerate(source.text, start=1):
        if character == '"' and depth == 0:
            quoted = not quoted
        if quoted:
            kept.append(character)
            continue
        if depth == 0 and character == ";":
            break
        if character == ")" and depth == 0:
            raise faults.COMMENT_NOT_OPEN.at(source, column)
        depth += (character == "(") - (character == ")")
        kept.append(" " if depth or character == ")" else character)
    return "".join(kept)


class TokenReader:
    """Reads the tokens of a normalised line."""

    def __init__(self, line: str, source: Source) -> None:
        self.line, self.source = line, source
        self.length = len(line.rstrip())
        self.synchronises = False
        """One of them reads what only the run knows."""
        self.call_synchronises = False
        """The same for the arguments of a call, which are read later."""

    def tokens(self, begin: int) -> list[Token]:
        """All tokens from index `begin` on; the first unreadable place raises."""
        found: list[Token] = []
        position = begin
        while position < self.length:
            try:
                token, position = self.next(position)
            except faults.ProgramError:
                bare = next((each for each in found if each.kind == "bare" and "G" not in self.line), None)
                if bare is None:
                    raise
                raise faults.NUMBER_WITHOUT_WORD.at(self.source, bare.column, word=bare.shown) from None
            found.append(token)
        return found

    def next(self, position: int) -> tuple[Token, int]:
        """The token at a place, and where it ends."""
        if _TARGET.match(self.line, position):
            return self._assignment(position)
        cycle, code = _CYCLE.match(self.line, position), _CYCLE_CODE.match(self.line, position)
        if cycle is not None or code is not None:
            before, self.synchronises = self.synchronises, False
            call = self._cycle(cycle) if cycle is not None else self._cycle_code(code) if code is not None else None
            assert call is not None
            self.call_synchronises, self.synchronises = self.synchronises, before
            return call
        match = _TOKEN.match(self.line, position)
        if match is None or _VALUED.match(self.line, position):
            return self._computed(position)
        kind = match.lastgroup or ""
        if kind == "bracket" and FILLS.match(self.line, self.line.index("[", match.start("bracket"))):
            return self._computed(position)
        continues = CONTINUES_BEHIND_EQUALS if "=" in match[0] else CONTINUES
        if kind in _NUMBERED and continues.match(self.line, match.end()):
            return self._computed(position)
        token = _token(match)
        if kind == "call" and (bracket := _BARE.match(self.line, match.end())):
            raise flow_faults.CALL_BRACKET.at(self.source, bracket.end(), scope=token.text, name=token.name)
        if kind == "bracket" and _COMPUTED_INSIDE.search(token.text):
            return self._bracket(token), match.end()
        return token, match.end()

    def _reader(self, at: int) -> ExpressionReader:
        return ExpressionReader(self.line, self.source, at)

    def _read(self, at: int) -> tuple[Node, int]:
        reader = self._reader(at)
        value = reader.expression()
        self.synchronises = self.synchronises or reader.synchronises
        return value, reader.at

    def _assignment(self, position: int) -> tuple[Token, int]:
        """P1 = 5, V.P.DEPTH += 2."""
        reader = self._reader(position)
        begin = reader.skip_blanks()
        target = reader.target()
        self.synchronises = self.synchronises or reader.synchronises
        if target is None:
            raise reader.operand_missing(begin)
        end = reader.at
        operator = _ASSIGNS.match(self.line, end)
        shown = self.line[begin:end].rstrip()
        if operator is None and _DWELL.search(self.line, 0, begin):
            return self._bare(position)
        if operator is None:
            hint = _EXTENDED.search(self.line, 0, begin)
            wanted = f"; zero offsets by number are written G159={shown[1:]}" if hint and shown[1:].isdigit() else ""
            raise flow_faults.VALUE_MISSING.at(self.source, begin + 1, target=shown, hint=wanted)
        value, after = self._read(operator.end())
        combined = _COMBINED.get(operator[1])
        if combined is not None:
            value = combined(operator.start(1) + 1, target, value)
        return Token("assignment", shown, "", begin + 1, self.line[begin:after], value, (), target), after

    def _cycle(self, begin: "re.Match[str]") -> tuple[Token, int]:
        """L CYCLE [NAME=DRILL.NC @P1=-10 MODAL_MOVE]."""
        name, modal = "", ""
        arguments: list[tuple[str, Node]] = []
        at = begin.end()
        while True:
            word = _CYCLE_WORD.match(self.line, at)
            if word is None:
                rest = self.line[at:].split()
                if not rest:
                    raise expression_faults.PARENTHESIS_OPEN.at(self.source, begin.end(), bracket="[")
                raise flow_faults.CYCLE_WORD.at(self.source, self.line.index(rest[0], at) + 1, word=rest[0])
            at = word.end()
            if word["end"]:
                break
            if word["name"]:
                name = word["name"]
            elif word["modal"]:
                modal = {"MODAL": "MODAL_MOVE"}.get(word["modal"], word["modal"])
            else:
                value, at = self._read(at)
                arguments.append((word["argument"], value))
        column = begin.start(1) + 1
        if not name:
            raise flow_faults.CYCLE_NAME.at(self.source, column)
        shown = self.line[begin.start(1) : at]
        scope = f"{begin[1]} CYCLE {modal}".rstrip()
        return Token("call", name, scope, column, shown, arguments=arguments), at

    def _cycle_code(self, begin: "re.Match[str]") -> tuple[Token, int]:
        """G81[-10, 2]: calls the program of this code with @P1, @P2 ...; gaps leave a parameter out."""
        at = begin.end()
        arguments: list[tuple[str, Node]] = []
        if begin[2]:
            reader = self._reader(at)
            for count in range(1, MOST_ARGUMENTS + 1):
                if not reader.line.startswith((",", "]"), reader.skip_blanks()):
                    arguments.append((f"P{count}", reader.expression()))
                if not reader.follows(","):
                    break
            reader.close(begin.end() - 1)
            at = reader.at
            self.synchronises = self.synchronises or reader.synchronises
        shown = self.line[begin.start(1) : at]
        return Token("call", "".join(begin[1].split()), CODE_CALL, begin.start(1) + 1, shown, arguments=arguments), at

    def _computed(self, position: int) -> tuple[Token, int]:
        """A word whose number is an expression."""
        for pattern, kind in _COMPUTED:
            match = pattern.match(self.line, position)
            if match is None:
                continue
            name = match[1]
            if kind == "valued":
                name = code_name(name, int(match[2]))
            elif kind in _SUFFIXES:
                name = f"{name}.{_SUFFIXES[kind]}"
            begin = match.start(1)
            numeric = kind == "word" and _NUMBER_NEXT.match(self.line, match.end())
            if kind == "valued" or "=" in match[0] or numeric or self._opens(match.end()):
                value, end = self._read(match.end())
                return Token(kind, name, "", begin + 1, self.line[begin:end].rstrip(), value), end
        if _BARE.match(self.line, position):
            return self._bare(position)
        raise _unreadable(self.line, self.source, position)

    def _bare(self, position: int) -> tuple[Token, int]:
        """The time of G04 as an expression."""
        value, end = self._read(position)
        begin = value.column - 1
        return Token("bare", "", "", begin + 1, self.line[begin:end].rstrip(), value), end

    def _computes(self, at: int) -> bool:
        """Whether an expression that is more than a number begins there."""
        number_ = _NUMBER_NEXT.match(self.line, at)
        return (OPENS if number_ is None else CONTINUES).match(
            self.line, at if number_ is None else number_.end()
        ) is not None

    def _opens(self, at: int) -> bool:
        """Whether an expression begins there; the bracket of a spindle or an axis is none."""
        if self.line.startswith("[", at):
            return FILLS.match(self.line, at) is not None
        return OPENS.match(self.line, at) is not None

    def _bracket(self, token: Token) -> Token:
        """The words of a bracket with expressions for some of their numbers."""
        at = token.column - 1 + token.shown.index("[") + 1
        end = token.column - 1 + len(token.shown) - 1
        parts: list[str | Node] = []
        while at < end:
            match = _INSIDE_WORD.match(self.line, at)
            if match is not None and self._computes(match.end()):
                value, after = self._read(match.end())
                parts += [f"{match[1]}=", value, " "]
                at = after
            else:
                step = _INSIDE_REST.match(self.line, at)
                assert step is not None
                if step.end() == at:
                    raise faults.UNEXPECTED_CHARACTER.at(self.source, at + 1, character=self.line[at])
                parts.append(self.line[at : min(step.end(), end)])
                at = min(step.end(), end)
        return token._replace(parts=parts)


_CYCLE_CODE = re.compile(r"\s*(G\s*8\d)(?![\d.])\s*(\[)?", re.ASCII)
"""G80 to G89."""
CODE_CALL: Final = "G CYCLE"
"""Text of the token of such a code; L CYCLE is that of a call by name."""
MOST_ARGUMENTS: Final = 50
_CYCLE = re.compile(r"\s*(LL?)\s+CYCLE\s*\[", re.ASCII)
_CYCLE_WORD = re.compile(
    r"""[\s,]*(?: NAME\s*=\s*"?(?P<name>[^\s"\],#$\[]+)"? | (?P<modal>MODAL(?:_MOVE|_BLOCK)?)(?![A-Z_])
    | @\s*(?P<argument>[A-Z]\w*)\s*= | (?P<end>\]) )""",
    re.ASCII | re.VERBOSE,
)
_TARGET = re.compile(r"\s*(?:P\s*[\d\[P]|V\s*\.)", re.ASCII)
_ASSIGNS = re.compile(r"\s*([-+*/]?=)(?!=)", re.ASCII)
_COMBINED: Final = {"+=": Add, "-=": Subtract, "*=": Multiply, "/=": Divide}
_COMPUTED_POSITION = re.compile(rf"\s*({_NAME})\s*\.\s*POS\s*=?", re.ASCII)
_COMPUTED_OFFSET = re.compile(rf"\s*({_NAME})\s*\.\s*OFFSET\s*=?", re.ASCII)
_SUFFIXES: Final = {"position": "POS", "offset": "OFFSET"}
_VALUED = re.compile(r"\s*([GHM])\s*(\d{1,3})\s*=(?!=)", re.ASCII)
_COMPUTED_WORD = re.compile(r"\s*([A-Z])\s*=?", re.ASCII)
_COMPUTED_NAME = re.compile(rf"\s*(?![A-Z]\s*=)({_NAME})\s*=(?!=)", re.ASCII)
_COMPUTED: Final = (
    (_COMPUTED_POSITION, "position"),
    (_COMPUTED_OFFSET, "offset"),
    (_VALUED, "valued"),
    (_COMPUTED_NAME, "named"),
    (_COMPUTED_WORD, "word"),
)
_EXTENDED = re.compile(r"G\s*0*5[4-9](?![\d.])", re.ASCII)
"""Controls with other languages write G54 P2, G54.1 P2."""
_DWELL = re.compile(r"G\s*0*4(?!\d)", re.ASCII)
_BARE = re.compile(r"\s*\[", re.ASCII)
_NUMBER_NEXT = re.compile(rf"\s*{NUMBER}(?![\d.])", re.ASCII)
_NUMBERED = ("word", "named", "position", "offset")
_COMPUTED_INSIDE = re.compile(r"[A-Z]\s*=?\s*[-+]*\s*(?:\[|P\s*[\d\[]|V\s*\.|@)|[\d.][-+*/]", re.ASCII)
_INSIDE_WORD = re.compile(r"\s*([A-Z_]+)\s*=?", re.ASCII)
_INSIDE_REST = re.compile(r"\s*[A-Z_]*\s*=?\s*[^A-Z\]]*", re.ASCII)


def _token(match: "re.Match[str]") -> Token:
    part = match.groupdict()
    kind = next(kind for kind in _KINDS if part[kind] is not None)
    if kind == "position":
        return Token(kind, f"{part['positioned']}.POS", part["angle"], match.start(kind) + 1, part[kind])
    if kind == "offset":
        return Token(kind, f"{part['shifted']}.OFFSET", part["shift"], match.start(kind) + 1, part[kind])
    name = part["callee"] or part["letter"] or part["name"] or part["owner"] or ""
    text = part["scope"] or part["number"] or part["value"] or part["inside"] or part["bare"] or ""
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
        is_code = token.kind == "word" and token.name in CODES and token.value is None and float(token.text) >= 0.0
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
    if shown[0] == '"':
        return faults.MACROS
    if "[" in line[position:] and re.match(rf"{_NAME}\s*\[", line[position:], re.ASCII):
        return faults.BRACKET_OPEN
    if re.search(rf"(?<![.\d])\d{{{MAX_DIGITS + 1}}}", shown):
        return faults.NUMBER_TOO_LONG
    if len(shown) > 1 and shown.isalpha():
        return faults.UNKNOWN_WORD
    return faults.BAD_NUMBER if shown[0].isalnum() or shown[0] in "+-." else faults.UNEXPECTED_CHARACTER
