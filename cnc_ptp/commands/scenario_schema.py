"""JSON schema of scenarios for editors: `python -m cnc_ptp.commands.scenario_schema > tools/scenario.schema.json`.

An entry is a time, a unit and a command with its arguments. Which kind of unit has the name is known to the machine
file only: a command that several kinds have may have the arguments of any of them.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

from cnc_ptp.commands.machine_schema import DIALECT, Schema, schema_json
from cnc_ptp.protocol.command_help import COMMAND_TEXTS, argument_text
from cnc_ptp.protocol.commands import (
    COMMANDS,
    FILE_CONTENTS,
    FORMER_NAMES,
    INTERNAL,
    OF_CHANNELS,
    OF_PLC,
    Argument,
    Arguments,
)
from cnc_ptp.protocol.run_time import LONGEST_RUN

ON_OFF = {"enum": [True, False, "on", "off"]}
TYPES: dict[str, Schema] = {
    "number": {"type": "number"},
    "integer": {"type": "integer"},
    "switch": ON_OFF,
    "text": {"type": "string"},
    "rows": {"type": "array"},
    "files": {"type": "object"},
    "source": {"type": "string"},
}
HEAD: dict[str, Schema] = {
    "at": {
        "type": "number",
        "minimum": 0,
        "maximum": LONGEST_RUN,
        "description": "Seconds; the command acts at the first cycle block that starts at or after it.",
    },
    "to": {"type": "string", "description": "Name of an axis, spindle or channel of the machine file, or plc."},
}


def scenario_schema() -> Schema:
    """Of a whole scenario: a list of entries."""
    commands = {name: kinds_of(name) for name in command_names()}
    do = {
        "enum": list(commands),
        "enumDescriptions": [texts_of(name, kinds) for name, kinds in commands.items()],
        "description": "The command.",
    }
    entry: Schema = {
        "type": "object",
        "properties": {**HEAD, "do": do},
        "required": ["at", "to", "do"],
        "allOf": [condition(name, kinds) for name, kinds in commands.items()],
    }
    return {
        "$schema": DIALECT,
        "title": "Scenario of cnc_ptp",
        "description": "Timed PLC commands. Made by `make docs`; do not edit.",
        "type": ["array", "null"],
        "items": entry,
    }


def command_names() -> list[str]:
    """Those that a scenario may give, in the order of the reference."""
    return [name for name in dict.fromkeys(name for kind in COMMANDS.values() for name in kind) if name not in INTERNAL]


def kinds_of(command: str) -> list[str]:
    return [kind for kind, commands in COMMANDS.items() if command in commands]


def texts_of(command: str, kinds: list[str]) -> str:
    """What it does, for each kind of unit that has it."""
    texts = dict.fromkeys(COMMAND_TEXTS[kind][command] for kind in kinds)
    return "; ".join(texts)


def condition(command: str, kinds: list[str]) -> Schema:
    """The arguments of a command, those of one kind of unit."""
    variants = {str(schema): schema for schema in (arguments_of(kind, command) for kind in kinds)}
    then = next(iter(variants.values())) if len(variants) == 1 else {"anyOf": list(variants.values())}
    return {"if": {"properties": {"do": {"const": command}}, "required": ["do"]}, "then": then}


def arguments_of(kind: str, command: str) -> Schema:
    known = shown_arguments(COMMANDS[kind][command])
    properties = {name: argument_schema(kind, command, name, argument) for name, argument in known.items()}
    properties |= {former: properties[name] for former, name in FORMER_NAMES.items() if name in properties}
    groups = [spellings(name, known) for name, argument in known.items() if argument.required]
    either = [{"anyOf": [{"required": [name]} for name in group]} for group in groups if len(group) > 1]
    return {
        "properties": {**dict.fromkeys((*HEAD, "do"), True), **properties},
        "required": [name for name, *others in groups if not others],
        "additionalProperties": False,
        **({"allOf": either} if either else {}),
    }


def spellings(name: str, known: Mapping[str, Argument]) -> list[str]:
    """An argument, its former name, and the file that may replace it."""
    former = [old for old, new in FORMER_NAMES.items() if new == name]
    return [name, *former, *(["file"] if name in FILE_CONTENTS and "file" in known else [])]


def shown_arguments(arguments: Arguments) -> dict[str, Argument]:
    """Without those that the PLC fills in or only channels give."""
    return {name: argument for name, argument in arguments.items() if name not in OF_PLC | OF_CHANNELS}


def argument_schema(kind: str, command: str, name: str, argument: Argument) -> Schema:
    unit, meaning, left_out = argument_text(kind, command, name)
    told = [meaning, f"in {unit}" if unit else "", f"left out: {left_out}" if left_out else ""]
    schema: dict[str, Any] = {"description": "; ".join(part for part in told if part)}
    if argument.lenient:
        return schema
    if argument.choices:
        return {**schema, "enum": list(argument.choices)}
    return {**schema, **TYPES[argument.kind]}


if __name__ == "__main__":
    sys.stdout.write(schema_json(scenario_schema()))
