"""#TOOL DATA [5, 0, 0], #TOOL PREP [5]: the D and the T word with the parts of a tool number (programming manual)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from cnc_ptp.nc.canonical import number
from cnc_ptp.nc.expressions.nodes import Node
from cnc_ptp.nc.flow import flow_faults
from cnc_ptp.nc.flow.command_words import Words
from cnc_ptp.nc.flow.lines import Flow, Line, Statement
from cnc_ptp.nc.functions import MAX_TOOL
from cnc_ptp.nc.program import NcBlock
from cnc_ptp.nc.tools import tool_faults as faults

PARTS: Final = 3
"""Basic tool, sister tool, variant."""


class ToolCommand(Statement):
    """A block with `letter` and the number of the basic tool; the tool table has no sister tools and variants."""

    def __init__(self, column: int, command: str, letter: str, parts: Sequence[Node | None]) -> None:
        super().__init__(column, independent=True)
        self.command, self.letter, self.parts = command, letter, parts

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        given = [0.0 if part is None else part.value(execution.values) for part in self.parts]
        for part, value in zip(self.parts, given, strict=True):
            if part is not None and (value < 0.0 or value > MAX_TOOL or value != int(value)):
                shown = number(value)
                raise faults.TOOL_NUMBER.at(line.source, part.column, command=self.command, value=shown, limit=MAX_TOOL)
        basic, *others = given
        if any(others):
            tool = ", ".join(map(number, given))
            raise faults.NO_SISTER.at(line.source, self.column, command=self.command, tool=tool)
        source = line.source._replace(names=(self.letter,), columns=(self.column,))
        return NcBlock(source, (), {self.letter: basic}, functions=True)


def read_tool_data(line: Line, text: str, end: int, column: int) -> None:
    """#TOOL DATA [basic, sister, variant]."""
    _read(line, text, end, column, "#TOOL DATA", "D")


def read_tool_preparation(line: Line, text: str, end: int, column: int) -> None:
    """#TOOL PREP [basic, sister, variant]."""
    _read(line, text, end, column, "#TOOL PREP", "T")


def _read(line: Line, text: str, end: int, column: int, command: str, letter: str) -> None:
    words = Words(line, text, end, command, f"{command} [basic, sister, variant], of which one to three are given")
    at = words.reader.skip_blanks()
    if not words.reader.line.startswith("[", at):
        raise words.stray() if not words.at_end else words.missing("a tool number in brackets")
    parts = words.items()
    words.require_end()
    if parts[0] is None:
        raise words.missing("the number of the basic tool")
    if len(parts) > PARTS:
        at = column if parts[PARTS] is None else parts[PARTS].column
        word = text[at - 1 :].rstrip(" ]")
        raise flow_faults.COMMAND_SYNTAX.at(line.source, at, word=word, command=command, syntax=words.syntax)
    line.statement = ToolCommand(column, command, letter, parts)
    line.synchronises = words.reader.synchronises
