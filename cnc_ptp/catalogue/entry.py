"""What the catalogue says of a number."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

CLASSES: Mapping[str, str] = {
    "program": "a fault in an NC program",
    "refusal": "a command that is not carried out",
    "fault": "something that stops a unit while it runs",
    "warning": "something that its user should know; the unit continues",
    "message": "plain information",
    "machine file": "a machine file that no node accepts",
    "correction": "a value of a machine file that is corrected or doubtful",
    "recording": "a recording that cannot be written or read",
    "usage": "wrong use of a command, or a file that is not possible",
    "client": "an exception of cnc_ptp.client",
    "analysis": "an analysis of recorded motions that is not possible",
}
SEVERITIES = ("info", "warning", "error")
"""As in Event.msg, in its order."""


class Reaction(NamedTuple):
    """What happens when the number comes."""

    key: str
    stop: str
    """Which stop: none, own ramp, emergency ramp …"""
    axes: str
    """What stops."""
    text: str


class Value(NamedTuple):
    """A placeholder of a text."""

    name: str
    is_number: bool
    unit: str = ""
    """Of a number; u is mm or deg, by the axis."""

    def __str__(self) -> str:
        kind = f"number {self.unit}".strip() if self.is_number else "text"
        return f"{self.name}: {kind}"


class Text(NamedTuple):
    """One wording: `{name}` stands for each of `values`."""

    template: str
    values: tuple[Value, ...]

    def shown(self, mark: str = "<{}>") -> str:
        """As a reader sees it; `mark` stands for a value, the unit of an axis is written out: mm/s (deg/s)."""
        text = self.template
        for value in self.values:
            if value.is_number and value.unit.startswith("u"):
                unit = f"mm{value.unit[1:]} (deg{value.unit[1:]})"
                for name in ("unit", "per"):
                    text = text.replace(f"{{{value.name}}} {{{name}}}", f"{mark.format(value.name)} {unit}")
        for value in self.values:
            text = text.replace(f"{{{value.name}}}", mark.format(value.name))
        return text


class Entry(NamedTuple):
    """One number."""

    number: int
    name: str
    title: str
    """The group that it belongs to."""
    error_class: str
    """Key of CLASSES."""
    severity: str
    """One of SEVERITIES."""
    reactions: tuple[Reaction, ...]
    """More than one where it comes in different cases."""
    texts: tuple[Text, ...]
    cause: str
    remedy: str
    page: str
    """The page of docs/ about what it belongs to."""
    manual: str
    """Where the vendor's manual has it; empty for a number of our own."""

    @property
    def is_error(self) -> bool:
        """It is reported as P-ERR, else as P-WARN."""
        return self.error_class not in ("warning", "message", "correction")
