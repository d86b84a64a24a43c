"""Messages and errors that a program orders: `#MSG ["depth %f", P1]`, `#ERROR [ID=455 RC=2 PV1=P1]`.

They go out when the path reaches their block, whatever the mode says.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from cnc_ptp.nc.canonical import Function, Message, OrderedError, number
from cnc_ptp.nc.expressions import expression_faults
from cnc_ptp.nc.expressions.functions import rounded
from cnc_ptp.nc.expressions.nodes import Node, Text
from cnc_ptp.nc.expressions.values import Values, in_words
from cnc_ptp.nc.flow import flow_faults as faults
from cnc_ptp.nc.flow.command_words import Words
from cnc_ptp.nc.flow.lines import Flow, Line, Statement
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel, HashCommand, NcBlock

MODES: Final = ("SYN", "SYN_ACK", "ACK")
RECEIVERS: Final = ("HMI", "PLC", "DIAG", "ISG_DIAG_BED", "EVENT_LOGGER")
SYNTAX: Final = '#MSG ["text %d %f %s", value, value, text], before it SYN and a receiver'
ERROR_SYNTAX: Final = "#ERROR [ID=455 RC=2 PV1=5]"
LARGEST_ID: Final = 1000
REACTIONS: Final = (0, 2, 7)
"""RC: warning, error, fatal error."""
VALUES: Final = tuple(f"PV{n}" for n in range(1, 6))
KEYS: Final = ("ID", "RC", "MID", *VALUES, *(f"PM{n}" for n in range(1, 6)), *(f"PIV{n}" for n in range(1, 5)))
_FORMAT = re.compile(r"%(.?)", re.ASCII)


class MessageStatement(Statement):
    """#MSG."""

    def __init__(self, column: int, parts: Sequence[str], values: Sequence[Node], kinds: str) -> None:
        """`parts`: the text around the values; `kinds` of these: d, f, s."""
        super().__init__(column, independent=True)
        self.parts, self.values, self.kinds = parts, values, kinds

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        text = self.parts[0]
        for part, node, kind in zip(self.parts[1:], self.values, self.kinds, strict=True):
            text += formatted(node, kind, execution.values) + part
        return NcBlock(line.source, (), {}, command=HashCommand("MSG", (text,), self.column, message))


def message(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    assert command.arguments is not None
    return (Message(command.arguments[0]),)


def formatted(node: Node, kind: str, values: Values) -> str:
    """One value of a message. Raises ProgramError for a number where a text is needed, and the reverse."""
    if kind == "s":
        text = node.scalar(values)
        if not isinstance(text, str):
            raise values.fault(expression_faults.TEXT_EXPECTED, node.column)
        return text
    value = node.value(values)
    return number(rounded(value)) if kind == "d" else f"{value:f}"


class ErrorStatement(Statement):
    """#ERROR."""

    def __init__(self, column: int, options: dict[str, Node]) -> None:
        super().__init__(column, independent=True)
        self.options = options

    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        values = execution.values
        identity = self.options["ID"].integer(values, "ID")
        if not 1 <= identity <= LARGEST_ID:
            column = self.options["ID"].column
            raise faults.ERROR_ID.at(line.source, column, value=identity, limit=LARGEST_ID)
        reaction = self.options["RC"].integer(values, "RC") if "RC" in self.options else 2
        if reaction not in REACTIONS:
            raise faults.ERROR_REACTION.at(line.source, self.options["RC"].column, value=reaction)
        others = {name: node.scalar(values) for name, node in self.options.items() if name not in ("ID", "RC")}
        shown = [f"{name} = {value if isinstance(value, str) else number(value)}" for name, value in others.items()]
        arguments = (str(identity), str(reaction), ", ".join(shown))
        return NcBlock(line.source, (), {}, command=HashCommand("ERROR", arguments, self.column, ordered_error))


def ordered_error(channel: Channel, state: ModalState, block: NcBlock, command: HashCommand) -> tuple[Function, ...]:
    assert command.arguments is not None
    identity, reaction, values = command.arguments
    text = f"#ERROR {identity} of the program{f': {values}' if values else ''}"
    return (OrderedError(int(identity), reaction != "0", text),)


def read_message(line: Line, text: str, end: int, column: int) -> None:
    words = Words(line, text, end, "#MSG", SYNTAX)
    mode = words.takes(*MODES)
    if mode.endswith("ACK"):
        raise faults.MESSAGE_MODE.at(line.source, column, mode=mode)
    words.takes(*RECEIVERS)
    if not words.reader.follows("["):
        raise words.stray() if not words.at_end else words.missing("a text in brackets")
    (first, *values) = words.reader.items()
    words.require_end()
    if not isinstance(first, Text):
        raise expression_faults.TEXT_EXPECTED.at(line.source, first.column)
    parts, kinds = split_format(line, first)
    if len(kinds) != len(values):
        place = first.column
        raise faults.MESSAGE_VALUES.at(line.source, place, wanted=in_words(len(kinds), "value"), given=len(values))
    line.statement = MessageStatement(column, parts, values, kinds)
    line.synchronises = words.reader.synchronises


def split_format(line: Line, text: Text) -> tuple[list[str], str]:
    """The parts of a text around its %d, %f and %s, and these as letters; %% is a percent sign."""
    parts, kinds, at = [""], "", 0
    for found in _FORMAT.finditer(text.constant):
        parts[-1] += text.constant[at : found.start()]
        at = found.end()
        if found[1] == "%":
            parts[-1] += "%"
        elif found[1].lower() in ("d", "f", "s") and found[1]:
            kinds += found[1].lower()
            parts.append("")
        else:
            place = text.column + found.start() + 1
            raise faults.MESSAGE_FORMAT.at(line.source, place, word=found[0])
    parts[-1] += text.constant[at:]
    return parts, kinds


def read_error(line: Line, text: str, end: int, column: int) -> None:
    words = Words(line, text, end, "#ERROR", ERROR_SYNTAX)
    options = words.options(*KEYS)
    words.require_end()
    if "ID" not in options:
        raise words.missing("ID")
    line.statement = ErrorStatement(column, options)
    line.synchronises = words.reader.synchronises
