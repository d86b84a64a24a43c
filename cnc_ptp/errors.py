"""The exception type of the kernel: P-ERR number, place, reason, effect, and the values of the text."""

from __future__ import annotations

import re
from collections.abc import Mapping

Value = float | int | str
WRONG_INPUT = 2
"""Exit status after wrong usage or input; nothing was started."""
_WARNING = re.compile(r"P-WARN-(\d+) ")


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

    def __str__(self) -> str:
        return f"P-ERR-{self.number} {self.message}"


def warning_text(number: int, text: str) -> str:
    """A warning as the record of a command that was carried out holds it; `number` 0 where it has none."""
    return f"P-WARN-{number} {text}" if number else text


def read_warning(message: str) -> tuple[int, str]:
    """Number and text of a `warning_text`."""
    found = _WARNING.match(message)
    return (int(found[1]), message[found.end() :]) if found else (0, message)
