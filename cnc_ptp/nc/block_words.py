"""The words of one block: at most one code of a group and one word of a kind; known ones only."""

from __future__ import annotations

from collections.abc import Sequence

from cnc_ptp.nc import faults, feedforward, friction_switch
from cnc_ptp.nc.canonical import CompensationSwitch, Source, SpindleFeedforward, number
from cnc_ptp.nc.gears import GEAR_M
from cnc_ptp.nc.lexer import Token
from cnc_ptp.nc.program import GCode, MCode, NcBlock, SpindleWords, Vocabulary
from cnc_ptp.nc.spindle_words import spindle_bracket

MAX_BLOCK_NUMBER = 999_999_999


def integer(token: Token, source: Source, limit: int) -> int:
    """The value of a word from 0 to `limit`. Raises ProgramError 21010."""
    value = float(token.text)
    if value < 0 or value != int(value) or value > limit:
        raise faults.NOT_AN_INTEGER.at(source, token.column, word=token.name, value=token.text, limit=limit)
    return int(value)


class BlockWords:
    """The words of one block as the careful method collects them."""

    def __init__(self, source: Source, vocabulary: Vocabulary) -> None:
        self.source, self.vocabulary = source, vocabulary
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
            integer(token, self.source, MAX_BLOCK_NUMBER)
            raise faults.BLOCK_NUMBER_PLACE.at(self.source, token.column, word=token.shown)
        elif token.name in self.vocabulary.words:
            self._value(token)
        else:
            raise faults.UNKNOWN_WORD.at(self.source, token.column, word=token.shown)

    def _g(self, token: Token) -> None:
        value = float(token.text)
        code = self.vocabulary.g_codes.get(value)
        if code is None:
            raise faults.UNKNOWN_G.at(self.source, token.column, word=token.shown)
        if code.later:
            raise faults.LATER.at(self.source, token.column, g=code.name, what=code.later)
        if code.valued and not code.bare:
            raise faults.CODE_VALUE.at(self.source, token.column, g=code.name)
        self._check_group(token, code, self.codes)
        self.codes.append(code)

    def _m(self, token: Token) -> None:
        value = float(token.text)
        code = self.vocabulary.m_code(int(value)) if value == int(value) else None
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
            fault = faults.DUPLICATE_AXIS if token.name[0] in self.vocabulary.axis_letters else faults.DUPLICATE_WORD
            first, second = number(self.words[token.name]), number(value)
            raise fault.at(self.source, token.column, word=token.name, first=first, second=second)
        self.words[token.name] = value

    def named(self, token: Token) -> None:
        """A longer name with an equals sign: an axis, or a spindle's speed."""
        if token.name[0] in self.vocabulary.axis_letters:
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
        code = self.vocabulary.g_codes.get(float(token.name[1:]))
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
        if code.name == "M" and (int(code.text) in self.vocabulary.m_codes or int(code.text) in GEAR_M):
            raise faults.CODE_NO_VALUE.at(self.source, token.column, code=token.name)
        if value != int(value):
            raise faults.CODE_INTEGER.at(self.source, token.column, code=token.name, value=number(value))
        self.word(code)
        self.values[token.name] = value

    def position(self, token: Token) -> None:
        """The position of M19: `S.POS=90`."""
        name = token.name.removesuffix(".POS")
        self.spindles.append(SpindleWords(name, None, None, float(token.text), din=True))

    def offset(self, token: Token) -> None:
        """Where a thread begins: `S.OFFSET=180`."""
        if token.name in self.values:
            first, second = number(self.values[token.name]), number(float(token.text))
            raise faults.DUPLICATE_WORD.at(self.source, token.column, word=token.name, first=first, second=second)
        self.values[token.name] = float(token.text)

    def bracket(self, token: Token) -> None:
        """A spindle's own words: `S2[M3 REV1000]`, `S[G135 G136=80]`; an axis': `X[COMP ON FRICT]`."""
        if token.name[0] in self.vocabulary.axis_letters:
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
        functions = bool(self.m or self.spindles or not self.vocabulary.function_words.isdisjoint(self.words))
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
    "offset": BlockWords.offset,
    "bracket": BlockWords.bracket,
    "bare": BlockWords.bare,
    "valued": BlockWords.valued,
}
