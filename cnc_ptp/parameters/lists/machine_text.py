"""The text of a machine file, one line for each line of a list, and where each of its lines comes from."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from cnc_ptp.parameters.errors import Place
from cnc_ptp.parameters.lists.marks import UNKNOWN, comment_line
from cnc_ptp.parameters.lists.values import yaml_text

INDENT = "    "
HEAD = "#: made by `cnc_ptp lists import`; docs/lists.md says what #: and #? mean"


class Origin(NamedTuple):
    """Where a line of the machine file comes from: the place in a list, and its line there."""

    place: Place
    line: str = ""


class MachineText:
    """Lines are added; `origins` has one entry for each."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.origins: list[Origin | None] = []

    def add(self, line: str, origin: Origin | None = None) -> None:
        self.lines.append(line)
        self.origins.append(origin)

    def section(self, node: str, origin: Origin) -> None:
        """Begins the section of a node."""
        if self.lines:
            self.add("")
        self.add(f"/{node}:", origin)
        self.add("  ros__parameters:", origin)

    def value(self, name: str, value: str, remark: str, origin: Origin) -> None:
        self.add(f"{INDENT}{name}: {value}" + (f"  {comment_line(remark)}" if remark else ""), origin)

    def names(self, name: str, values: Iterable[str], origin: Origin) -> None:
        self.value(name, f"[{', '.join(map(yaml_text, values))}]", "", origin)

    def mark(self, mark: str) -> None:
        self.add(f"{INDENT}{mark}")

    def comment(self, comment: str) -> None:
        self.add(f"{INDENT}{comment_line(comment)}")

    def unknown(self, line: str) -> None:
        self.add(f"{INDENT}{UNKNOWN} {line}")

    @property
    def text(self) -> str:
        return "\n".join([*self.lines, ""])

    def origin(self, line: int, nowhere: Origin) -> Origin:
        """Of a line, counted from 1."""
        return (self.origins[line - 1] if 0 < line <= len(self.origins) else None) or nowhere
