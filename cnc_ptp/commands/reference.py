"""The command reference docs/commands.md: `python -m cnc_ptp.commands.reference > docs/commands.md`."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from cnc_ptp.protocol.command_help import COMMAND_TEXTS, argument_text
from cnc_ptp.protocol.commands import COMMANDS, INTERNAL, OF_CHANNELS, OF_PLC, Argument

INTRODUCTION = """\
# Commands

Made by `python -m cnc_ptp.commands.reference` from `cnc_ptp/protocol/commands.py`; do not edit.

A command changes the state of a unit at the first cycle of its next cycle block. It comes from

| source | example |
|---|---|
| a scenario, timed | `- {at: 4.0, to: channel, do: set_override, percent: 60}` |
| the command line ([cli.md](cli.md)) | `cnc_ptp do channel set_override 60` |
| a service ([interfaces.md](interfaces.md#services)) | `/channel/set_override` |
| a Python program ([client.md](client.md)) | `m.channel.set_override(60)` |

In a scenario, `at` is in seconds; the command acts at the first cycle block that starts at or after it. `to` is the
name of a unit (axes, spindles and channels of the machine file, and `plc`), `do` the command. Times need not ascend.
Answers and refusals are recorded. A refused command changes nothing.

Switches are `on` and `off` (or `true` and `false`). Optional arguments are in brackets; the table of arguments says
what happens when they are left out. Files are relative to the scenario.
"""
HEADLINES = {"axis": "Axis", "spindle": "Spindle", "channel": "Channel", "plc": "PLC"}
TYPES = {
    "number": "number",
    "integer": "whole number",
    "switch": "switch",
    "text": "text",
    "rows": "list",
    "files": "texts by name",
    "source": "name",
}
HIDDEN = OF_PLC | OF_CHANNELS
EITHER = {"setpoints": "file", "table": "file"}
"""Arguments that a file may replace."""


def reference_markdown() -> str:
    """docs/commands.md."""
    return "\n".join([INTRODUCTION, *(line for kind in COMMANDS for line in unit_lines(kind))])


def unit_lines(kind: str) -> Iterator[str]:
    """The section of one kind of unit: its commands, then their arguments."""
    yield f"## {HEADLINES[kind]}\n"
    yield "| command | arguments | does |"
    yield "|---|---|---|"
    for command, text in commands(kind).items():
        yield f"| `{command}` | {argument_list(kind, command)} | {text} |"
    yield ""
    yield "| argument | of | type | unit | meaning | if left out |"
    yield "|---|---|---|---|---|---|"
    yield from argument_lines(kind)
    yield ""


def commands(kind: str) -> dict[str, str]:
    """Commands that a scenario may give, with their texts."""
    return {name: COMMAND_TEXTS[kind][name] for name in COMMANDS[kind] if name not in INTERNAL}


def arguments(kind: str, command: str) -> dict[str, Argument]:
    """Arguments that a scenario may give."""
    return {name: argument for name, argument in COMMANDS[kind][command].items() if name not in HIDDEN}


def argument_list(kind: str, command: str) -> str:
    """`target`, [`velocity`]; `table` or `file`."""
    known = arguments(kind, command)
    shown = []
    for name, argument in known.items():
        if name == "file" and known.keys() & EITHER.keys():
            continue
        other = EITHER.get(name)
        mark = f"`{name}` or `{other}`" if other else f"`{name}`"
        shown.append(mark if argument.required else f"[{mark}]")
    return ", ".join(shown)


def argument_lines(kind: str) -> Iterator[str]:
    """One row for each argument with one meaning in all commands named."""
    rows: dict[tuple[str, ...], list[str]] = {}
    for command in commands(kind):
        for name, argument in arguments(kind, command).items():
            text = argument_text(kind, command, name)
            optional = not argument.required
            cells = (name, type_text(argument), text.unit, text.meaning, text.left_out if optional else "")
            rows.setdefault(cells, []).append(command)
    for row, used in sorted(rows.items(), key=lambda item: item[0][0]):
        yield f"| `{row[0]}` | {', '.join(f'`{command}`' for command in used)} | {' | '.join(row[1:])} |"


def type_text(argument: Argument) -> str:
    """Type and choices of an argument."""
    if argument.choices:
        return ", ".join(f"`{choice}`" for choice in argument.choices)
    return TYPES[argument.kind] + (" > 0" if argument.positive else "")


if __name__ == "__main__":
    sys.stdout.write(reference_markdown())
