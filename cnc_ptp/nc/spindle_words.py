"""Words in the brackets of a spindle, `S2[M3 REV1000]` -> SpindleWords, with the check of their combination."""

from cnc_ptp.nc import faults, spindle_faults
from cnc_ptp.nc.canonical import Source, number
from cnc_ptp.nc.lexer import Token, bracket_words
from cnc_ptp.nc.program import MAX_M, SpindleWords

DEFAULT_DYNAMICS = ("DEFAULT_DYNAMIC_DATA", "DEFAULT_DYNAMIK_DATA", "DEFAUL_DYNAMIK_DATA")
"""The last spelling is that of TF5200 spindle p.83."""

KNOWN = "M3, M4, M5, M19, REV, POS, G74, G167, G135, G136, G137, DEFAULT_DYNAMIC_DATA, free M functions"
FLOW_M = (0, 1, 2, 17, 29, 30)


def spindle_bracket(token: Token, source: Source) -> SpindleWords:
    """The words of one spindle. Raises ProgramError for unknown ones and those that do not go together."""
    words = _Bracket(token.name, source)
    for name, text, column in bracket_words(token, source):
        words.take(name, text, column)
    return words.finish(token.column)


class _Bracket:
    """The words of a bracket as they are collected."""

    def __init__(self, spindle: str, source: Source) -> None:
        self.spindle, self.source = spindle, source
        self.words = SpindleWords(spindle, None, None)
        self.shown: list[tuple[str, int]] = []

    def take(self, name: str, text: str, column: int) -> None:
        """Adds one word."""
        self._require_once(name, text, column)
        taken = self._take_number(name, float(text), column) if text else self._take_name(name)
        if not taken:
            raise faults.BRACKET_WORD.at(self.source, column, word=name + text, spindle=self.spindle, known=KNOWN)
        self.shown.append((name + text, column))

    def _require_once(self, name: str, text: str, column: int) -> None:
        """REV, POS, G74, G167 and DEFAULT_DYNAMIC_DATA; M functions have rules of their own."""
        value = {"REV": self.words.speed_rpm, "POS": self.words.position_deg}.get(name)
        if text and value is not None:
            first, second = number(value), number(float(text))
            raise faults.DUPLICATE_WORD.at(self.source, column, word=name, first=first, second=second)
        if name != "M" and any(word == name + text for word, _ in self.shown):
            raise faults.TWICE.at(self.source, column, word=name + text)

    def _take_name(self, name: str) -> bool:
        if name not in DEFAULT_DYNAMICS or self.words.default_dynamics:
            return False
        self.words = self.words._replace(default_dynamics=True)
        return True

    def _take_number(self, name: str, value: float, column: int) -> bool:
        words = self.words
        if name == "REV" and words.speed_rpm is None:
            self.words = words._replace(speed_rpm=value)
        elif name == "POS" and words.position_deg is None:
            self.words = words._replace(position_deg=value)
        elif name == "G" and value == 74 and not words.homing:
            self.words = words._replace(homing=True)
        elif name == "G" and value == 167 and not words.full_override:
            self.words = words._replace(full_override=True)
        elif name == "M" and value == int(value) and 0 <= value <= MAX_M:
            self._take_m(int(value), column)
        else:
            return False
        return True

    def _take_m(self, m: int, column: int) -> None:
        words = self.words
        if m in FLOW_M:
            raise spindle_faults.FREE_M_IN_BRACKET.at(self.source, column, number=m, spindle=self.spindle)
        if m in (3, 4, 5):
            first = words.m if words.m is not None else 19 if words.positioning and m == 5 else None
            self._require_one(first, m, column)
            self.words = words._replace(m=m)
        elif m == 19:
            self._require_one(19 if words.positioning else words.m if words.m == 5 else None, 19, column)
            self.words = words._replace(positioning=True)
        else:
            self._require_one(m if m in words.functions else None, m, column)
            self.words = words._replace(functions=(*words.functions, m))

    def _require_one(self, first: int | None, second: int, column: int) -> None:
        if first is not None:
            spindle = self.spindle
            raise faults.SPINDLE_M_TWICE.at(self.source, column, first=first, second=second, spindle=spindle)

    def finish(self, column: int) -> SpindleWords:
        """All words, when they go together."""
        words, shown = self.words, self.shown
        if not shown:
            raise faults.BRACKET_EMPTY.at(self.source, column, spindle=self.spindle)
        if words.position_deg is not None and not words.positioning:
            place = next(at for word, at in shown if word.startswith("POS"))
            raise spindle_faults.POSITION_ALONE.at(self.source, place, spindle=self.spindle)
        if len(shown) > 1 and (words.homing or words.default_dynamics):
            fault = spindle_faults.HOMING_NOT_ALONE if words.homing else spindle_faults.DYNAMICS_NOT_ALONE
            alone = ("G74",) if words.homing else DEFAULT_DYNAMICS
            other, place = next((word, at) for word, at in shown if word not in alone)
            raise fault.at(self.source, place, word=other, spindle=self.spindle)
        return words
