"""The exception type of the kernel: P-ERR number, place, reason, effect, and the values of the text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from typing import Final

Value = float | int | str
NO_VALUES: Final[Mapping[str, Value]] = {}
"""Of a text without numbers."""
WRONG_INPUT = 2
"""Exit status after wrong usage or input; nothing was started."""


class CncError(Exception):
    """A refused command, program, parameter or run-time fault.

    `number` also goes into block, event and command messages, there as `error_id`. Ranges: 21000 NC program, 22000
    channel, 23000 axis, 24000 spindle, 25000 parameters and scenarios, 26000 graph, recording and command line, 27000
    commissioning; numbers that a manual names are kept.
    """

    def __init__(self, number: int, reason: str, effect: str = "", /, *, where: str = "", **values: Value) -> None:
        """`where`: unit and command, or place in a file. `values` of the text by name, in its units."""
        super().__init__(number, reason, effect)
        self.number = number
        self.where = where
        self.reason = reason
        self.effect = effect
        self.values: Mapping[str, Value] = values

    @property
    def message(self) -> str:
        """The whole text without the number: "where: reason; effect"."""
        place = f"{self.where}: " if self.where else ""
        effect = f"; {self.effect}" if self.effect else ""
        return f"{place}{self.reason}{effect}"

    @property
    def full_message(self) -> str:
        """`message`, and of a program from where the line was called."""
        return self.message

    def meaning(self, _effect: str) -> CncError:
        """The same error, told by a command that knows what does not happen now; most errors know it themselves."""
        return self

    def __str__(self) -> str:
        return f"P-ERR-{self.number} {self.message}"


LONGEST_WORD = 100
"""Characters of a misspelled word that are compared."""


def nearest(word: str, known: Iterable[str], *, most: int = 1, cutoff: float = 0.6) -> list[str]:
    """The names that may have been meant, the most similar one first."""
    return get_close_matches(word[:LONGEST_WORD], list(known), n=most, cutoff=cutoff)


def did_you_mean(names: Sequence[str]) -> str:
    """The end of an error's text: the names that may have been meant; empty without any."""
    return f"; did you mean {' or '.join(names)}?" if names else ""


def nearest_name(word: str, known: Iterable[str]) -> str:
    """The end of an error's text: the name that may have been meant."""
    return did_you_mean(nearest(word, known))


class WarningText(str):
    """A warning as the record of a command that was carried out shows it, with what it is made of."""

    number: int
    values: Mapping[str, Value]

    def __new__(cls, shown: str, number: int, values: Mapping[str, Value]) -> WarningText:
        warning = super().__new__(cls, shown)
        warning.number, warning.values = number, values
        return warning


def warning_text(number: int, text: str, /, **values: Value) -> WarningText:
    """ "P-WARN-<number> <text>"; only the text for `number` 0. `values` of the text by name."""
    return WarningText(f"P-WARN-{number} {text}" if number else text, number, values)


def joined_warnings(*warnings: str | None) -> WarningText | None:
    """Several warnings of one command, as one with the number and the values of the first that has a number."""
    given = [warning for warning in warnings if warning]
    numbered = [warning for warning in given if isinstance(warning, WarningText) and warning.number]
    if not given:
        return None
    first = numbered[0] if numbered else warning_text(0, "")
    return WarningText("; ".join(given), first.number, first.values)


def plain_text(number: int, shown: str) -> str:
    """The text of a warning without the number in front of it."""
    return shown.removeprefix(f"P-WARN-{number} ")
