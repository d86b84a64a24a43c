"""One line of text -> one block: known words, at most one code of a group and one word of a kind per block.

Two methods with the same result: a fast one for lines of letters with numbers only, a careful one for everything
else, which also finds the column of an error.
"""

from collections.abc import Sequence

from cnc_ptp.nc import faults, feedforward, friction_switch
from cnc_ptp.nc.canonical import CompensationSwitch, Source, SpindleFeedforward, number
from cnc_ptp.nc.hash_commands import hash_block
from cnc_ptp.nc.lexer import SKIP, Token, normalise, places, plain_words, tokens
from cnc_ptp.nc.program import GCode, MCode, NcBlock, SpindleWords
from cnc_ptp.nc.spindle_words import spindle_bracket
from cnc_ptp.nc.vocabulary import (
    AXIS_LETTERS,
    FUNCTION_WORDS,
    G_CODES,
    MAX_SKIP_LEVEL,
    VALUE_WORDS,
    m_code,
)

MAX_BLOCK_NUMBER = 999_999_999

_PLAIN_VALUES = VALUE_WORDS | AXIS_LETTERS
_PLAIN_CODES = {float(number_): code for number_, code in G_CODES.items() if not code.spindle}
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
    return NcBlock(source, codes, words, (), (), None, "", "", 0, functions)


def careful_block(source: Source) -> NcBlock | None:
    """Any line: comments, M functions, names, brackets, calls; raises with the column. None without words."""
    line = normalise(source)
    skip, begin = _skip_level(line, source)
    if "#" in line:
        command = hash_block(line, source, begin, skip)
        if command is not None:
            return command
    found = tokens(line, source, begin)
    if not found:
        return None
    names, columns = places(found)
    source = source._replace(names=names, columns=columns)
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
    """The words of one block as the careful method collects them."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.codes: list[GCode] = []
        self.m: list[MCode] = []
        self.words: dict[str, float] = {}
        self.spindles: list[SpindleWords] = []
        self.controls: list[SpindleFeedforward | CompensationSwitch] = []
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

    def subroutine(self, token: Token) -> None:
        """`LL name`."""
        ending = next((code for code in self.m if code.flow in ("end", "return")), None)
        if ending is not None:
            raise faults.CALL_AND_END.at(self.source, token.column, word=ending.name)
        self.call = token.name

    def block(self, skip: int) -> NcBlock:
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
            self.call,
            flow,
            skip,
            functions,
            controls=tuple(self.controls),
        )


_TAKERS = {
    "word": _BlockWords.word,
    "named": _BlockWords.named,
    "position": _BlockWords.position,
    "bracket": _BlockWords.bracket,
    "bare": _BlockWords.bare,
    "call": _BlockWords.subroutine,
}
