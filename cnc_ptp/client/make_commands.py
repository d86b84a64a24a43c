"""Makes `made/`: a method for each command of a unit, from protocol/commands.py and command_help.py.

`python -m cnc_ptp.client.make_commands` writes the files; a test compares them with what is made of the tables.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from textwrap import wrap

from cnc_ptp.protocol.command_help import COMMAND_TEXTS, argument_text
from cnc_ptp.protocol.commands import COMMANDS, INTERNAL, OF_CHANNELS, OF_PLC, Argument
from cnc_ptp.protocol.jobs import JOBS

FOLDER = Path(__file__).parent / "made"
WIDTH = 120
WITHOUT_METHOD = INTERNAL | {"overlay", "serve"}
"""Besides internal commands those of the HLI, which come by its topics and have no service."""
HIDDEN = OF_PLC | OF_CHANNELS
"""Arguments that only the PLC and channels give."""
EITHER = {"setpoints": "file", "table": "file"}
"""Arguments that a file may replace."""
DEFAULTS: Mapping[tuple[str, str, str], str] = {
    ("spindle", "start", "direction"): '"cw"',
    ("spindle", "select_gear", "resume"): "True",
    ("axis", "couple_cam", "cyclic"): "True",
}
"""Kind of unit, command, argument: what the client sends where it is left out."""
RELATIVE = re.compile(",? relative to the scenario")
"""What is said of files does not hold for a client: they are relative to its working directory."""
TYPES = {
    "number": "float",
    "integer": "int",
    "switch": "bool",
    "text": "str",
    "rows": "Rows",
    "files": "Mapping[str, str]",
    "source": "str",
}
PROGRAMS = ("start", "mdi")
"""Jobs of a channel that are programs."""
KINDS = {"axis": "an axis", "spindle": "a spindle", "channel": "an NC channel", "plc": "the PLC"}


def commands_of(kind: str) -> list[str]:
    """Those that a client gives."""
    return [command for command in COMMANDS[kind] if command not in WITHOUT_METHOD]


def module(kind: str) -> str:
    """The file of one kind of unit."""
    names = sorted({returned(kind, command) for command in commands_of(kind)})
    lines = [
        f'"""The commands of {KINDS[kind]} as methods. Made by cnc_ptp/client/make_commands.py; do not edit."""',
        "",
        "from __future__ import annotations",
        "",
        *imports(kind),
        f"from cnc_ptp.client.asking import {', '.join(sorted({'Asking', *rows(kind)}))}",
        f"from cnc_ptp.client.job import {', '.join(names)}",
        *aliases(kind),
        "",
        "",
        f"class {kind.capitalize()}Commands(Asking):",
        f'    """What {KINDS[kind]} can be told. A refusal raises the error of the unit; nothing has changed then."""',
    ]
    for command in commands_of(kind):
        lines += ["", *method(kind, command)]
    return "\n".join([*lines, ""])


def imports(kind: str) -> Iterator[str]:
    """Of the standard library."""
    arguments = [argument for command in commands_of(kind) for argument in COMMANDS[kind][command].values()]
    shown = [argument for argument in arguments if argument.kind == "files"]
    chosen = [argument for argument in arguments if argument.choices]
    yield from ["from collections.abc import Mapping"] if shown else []
    yield from ["from typing import Literal"] if chosen else []
    yield from [""] if shown or chosen else []


def rows(kind: str) -> set[str]:
    kinds = {argument.kind for command in commands_of(kind) for argument in COMMANDS[kind][command].values()}
    return {"Rows"} if "rows" in kinds and kind in ("axis", "plc") else set()


def returned(kind: str, command: str) -> str:
    """Type of what a method gives."""
    if command not in JOBS[kind]:
        return "Answer"
    return "ProgramJob" if kind == "channel" and command in PROGRAMS else "Job"


def arguments_of(kind: str, command: str) -> dict[str, Argument]:
    """Those that a client gives: first what must be given, a master before all else."""
    known = {name: argument for name, argument in COMMANDS[kind][command].items() if name not in HIDDEN}
    must = [name for name in known if is_needed(kind, command, name)]
    return {name: known[name] for name in sorted(known, key=lambda name: (name not in must, name != "master"))}


def aliases(kind: str) -> Iterator[str]:
    """Types of arguments with choices that several commands share."""
    shared = {name: argument for name, argument in choices_of(kind) if is_shared(kind, name, argument)}
    yield from [""] if shared else []
    for name, argument in shared.items():
        yield f"{alias(name)} = {literal(argument)}"


def choices_of(kind: str) -> list[tuple[str, Argument]]:
    """Arguments with choices, of all commands."""
    every = [pair for command in commands_of(kind) for pair in COMMANDS[kind][command].items()]
    return [(name, argument) for name, argument in every if argument.choices]


def is_shared(kind: str, name: str, argument: Argument) -> bool:
    return [(each, other.choices) for each, other in choices_of(kind)].count((name, argument.choices)) > 1


def alias(name: str) -> str:
    return name.title().replace("_", "")


def literal(argument: Argument) -> str:
    chosen = ", ".join(f'"{choice}"' for choice in argument.choices)
    return f"Literal[{chosen}]"


def type_of(kind: str, name: str, argument: Argument) -> str:
    if not argument.choices:
        return TYPES[argument.kind]
    return alias(name) if is_shared(kind, name, argument) else literal(argument)


def is_needed(kind: str, command: str, name: str) -> bool:
    """It has no default."""
    has_default = (kind, command, name) in DEFAULTS or name in EITHER
    return COMMANDS[kind][command][name].required and not has_default


def method(kind: str, command: str) -> Iterator[str]:
    arguments = arguments_of(kind, command)
    words = [parameter(kind, command, name) for name in arguments]
    first = [name for name in arguments if is_needed(kind, command, name) or name in EITHER]
    words = ["self", *words[: len(first)], *(["*"] if len(first) < len(words) else []), *words[len(first) :]]
    result = returned(kind, command)
    head = f"    def {command}({', '.join(words)}) -> {result}:"
    if len(head) <= WIDTH:
        yield head
    else:
        yield from [f"    def {command}(", *(f"        {word}," for word in words), f"    ) -> {result}:"]
    yield from docstring(kind, command, list(arguments))
    asks = {"Answer": "_answer", "Job": "_job", "ProgramJob": "_program_job"}[result]
    given = [f'"{command}"', *(f"{name}={name}" for name in arguments)]
    call = f"        return self.{asks}({', '.join(given)})"
    if len(call) <= WIDTH:
        yield call
    else:
        yield from [f"        return self.{asks}(", *(f"            {word}," for word in given), "        )"]


def parameter(kind: str, command: str, name: str) -> str:
    kind_of_value = type_of(kind, name, COMMANDS[kind][command][name])
    if default := DEFAULTS.get((kind, command, name)):
        return f"{name}: {kind_of_value} = {default}"
    return f"{name}: {kind_of_value}" if is_needed(kind, command, name) else f"{name}: {kind_of_value} | None = None"


def docstring(kind: str, command: str, arguments: list[str]) -> Iterator[str]:
    text = COMMAND_TEXTS[kind][command]
    summary = f"{text[0].upper()}{text[1:]}."
    if not arguments:
        yield f'        """{summary}"""'
        return
    yield f'        """{summary}'
    yield ""
    for name in arguments:
        line = argument_line(kind, command, name)
        yield from wrap(line, WIDTH - 8, initial_indent=" " * 8, subsequent_indent=" " * 12)
    yield '        """'


def argument_line(kind: str, command: str, name: str) -> str:
    text = argument_text(kind, command, name)
    unit = f" [{text.unit}]" if text.unit else ""
    left_out = f"; left out: {text.left_out}" if text.left_out and (kind, command, name) not in DEFAULTS else ""
    if name in EITHER:
        left_out = ""
    meaning = RELATIVE.sub("", text.meaning)
    return f"{name}{unit}  {meaning}{left_out}"


def files() -> dict[str, str]:
    """Name of a file in `made/` -> its text."""
    return {f"{kind}_commands.py": module(kind) for kind in COMMANDS}


def main() -> None:
    for name, text in files().items():
        (FOLDER / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
