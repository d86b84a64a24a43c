"""The reference of the HLI: `python -m cnc_ptp.commands.hli_reference > docs/hli_objects.md`."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from typing import NamedTuple

from cnc_ptp.commands.hli_origins import UNIT_TEXTS, Origin, origin
from cnc_ptp.protocol.control_units import CONTROL_UNITS, NUMBER, PERCENT, SWITCH, ControlUnit
from cnc_ptp.wire.schemas import message_file

INTRODUCTION = """\
# Objects of the HLI

Made by `python -m cnc_ptp.commands.hli_reference` from `cnc_ptp/protocol/control_units.py`,
`cnc_ptp/commands/hli_origins.py` and the `.msg` files; do not edit. What the columns mean: [plc_hli.md](plc_hli.md).

A value is a switch or a number; *HLI unit* counts where a message says `units` = HLI. *Manual*: pages of TF5200
(spindle), chapters of TX1250. *TwinCAT*: names below `gpAx[i]^` and `gpCh[i]^` (`StateBahn_Data` in older versions),
those of the cyclic interface of an NC axis (`PlcToNc`, `NcToPlc`), or words; – where no public document names one.
"""
HEADLINES = {"axis": "Axis", "spindle": "Spindle", "channel": "Channel"}
VALUES = {SWITCH: "switch", PERCENT: "number", NUMBER: "number"}
COLUMNS = {SWITCH: ("", ""), PERCENT: ("%", "0.1 %"), NUMBER: ("", "")}
"""Unit, and that of the HLI (`units` = HLI)."""
FIELD = re.compile(r"^(?P<type>[\w/]+(\[\d*\])?)\s+(?P<name>\w+)\s*(#\s*(?P<comment>.*))?$")


class MessageField(NamedTuple):
    """A line of a .msg file."""

    type: str
    name: str
    comment: str


def fields_of(message: str) -> list[MessageField]:
    """The fields of a message with their comments, its header left out."""
    lines = message_file(f"cnc_ptp/msg/{message}").read_text(encoding="utf-8").splitlines()
    matches = [match for line in lines if (match := FIELD.match(line))]
    fields = [MessageField(match["type"], match["name"], match["comment"] or "") for match in matches]
    return [field for field in fields if field.name != "header"]


def hli_markdown() -> str:
    """docs/hli_objects.md."""
    return "\n".join([INTRODUCTION, *(line for kind in HEADLINES for line in object_lines(kind))])


def object_lines(kind: str) -> Iterator[str]:
    """The section of one kind of object: control units, the rest of its control message, its status."""
    title = HEADLINES[kind]
    yield f"## {title}\n"
    yield f"Control units, `/<{kind}>/hli/control` ({title}HliControl) and `/<{kind}>/hli/status` ({title}HliStatus):\n"
    names = "control unit | acts by | value | unit | HLI unit | at the start | others ask by | does | TwinCAT | manual"
    yield f"| {names} |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for unit in CONTROL_UNITS[kind]:
        yield unit_row(kind, unit)
    yield ""
    for message, direction in ((f"{title}HliControl", "PLC → machine"), (f"{title}HliStatus", "machine → PLC")):
        yield f"The other fields of {message}, {direction}:\n"
        yield "| field | type | meaning | TwinCAT | manual |"
        yield "|---|---|---|---|---|"
        yield from other_rows(kind, message)
        yield ""


def unit_row(kind: str, unit: ControlUnit) -> str:
    text = UNIT_TEXTS[kind][unit.name]
    si, hli = COLUMNS[unit.value]
    start = "" if unit.edge else f"{unit.initial:g}" if unit.value != SWITCH else "on" if unit.initial else "off"
    asked = f"`{unit.asked_by.partition('.')[0]}`" if unit.asked_by and unit.name != "emergency_stop" else ""
    if unit.name == "emergency_stop":
        asked = "`/emergency_stop`"
    acts = "edge" if unit.edge else "level"
    cells = (f"`{unit.name}`", acts, VALUES[unit.value], si, hli, start, asked, text.meaning, *shown(text.origin))
    return f"| {' | '.join(cells)} |"


def other_rows(kind: str, message: str) -> Iterator[str]:
    """What is no control unit; the parts of an external command and of acknowledgements one by one."""
    names = {unit.name for unit in CONTROL_UNITS[kind]}
    for field in fields_of(message):
        if field.name in names:
            continue
        source = shown(origin(kind, field.name))
        part = field.type.removeprefix("cnc_ptp/")
        if part.startswith("Hli"):
            for inner in fields_of(part):
                yield f"| `{field.name}.{inner.name}` | {inner.type} | {inner.comment} | {' | '.join(source)} |"
        else:
            yield f"| `{field.name}` | {part} | {field.comment} | {' | '.join(source)} |"


def shown(source: Origin) -> tuple[str, str]:
    manual = f"TF5200 {source.manual}" if source.manual.startswith("p.") else source.manual
    return source.twincat or "–", manual or "–"


if __name__ == "__main__":
    sys.stdout.write(hli_markdown())
