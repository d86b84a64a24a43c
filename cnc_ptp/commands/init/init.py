"""`cnc_ptp init mill`: a commented machine file that runs."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import yaml

import cnc_ptp
from cnc_ptp import yaml_text
from cnc_ptp.commands.output_file import check_output, write_output
from cnc_ptp.commissioning.faults import BAD_OUTPUT
from cnc_ptp.errors import CncError
from cnc_ptp.parameters.declare.declarations import Declaration, catalogue, dotted, split_indexes
from cnc_ptp.parameters.declare.ranges import shown_number
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM, SHOWN_UNITS

SCHEMA = Path("tools") / "machine.schema.json"
TEXT_COLUMN = 42
"""Where comments begin, if the value leaves room."""


def init(kind: str, output: str | None) -> int:
    """Writes the machine file; never over another one. Raises CncError 27030."""
    file = output or f"{kind}.yaml"
    if Path(file).exists():
        effect = "nothing was written, -o FILE names another one"
        raise CncError(BAD_OUTPUT, f"{file} exists already and is not overwritten", effect)
    check_output(file)
    write_output(file, machine_file(kind, file), remains="there is no machine file")
    print(f"{file}: {machines()[kind]['text']} Try: cnc_ptp params check {file}")
    return 0


@cache
def machines() -> Mapping[str, Any]:
    """machines.yaml."""
    loaded: Mapping[str, Any] = yaml_text.load(Path(__file__).with_name("machines.yaml").read_text(encoding="utf-8"))
    return loaded


def machine_file(kind: str, file: str) -> str:
    """Text of the machine file of one kind."""
    return "\n".join(lines(machines()[kind], file)) + "\n"


def lines(machine: Mapping[str, Any], file: str) -> Iterator[str]:
    schema = schema_file()
    if schema is not None:
        yield f"# yaml-language-server: $schema={schema.as_uri()}"
    yield f"# {machine['text']}"
    yield "# All values are those of a simulated machine. `cnc_ptp params NAME` explains each parameter,"
    yield f"# `cnc_ptp params check {file}` finds what is wrong."
    for node, parameters in machine["nodes"].items():
        yield ""
        yield f"/{node}:"
        yield "  ros__parameters:"
        yield from node_lines(kind_of(node, machine), parameters)


def schema_file() -> Path | None:
    """The schema of machine files, in the checkout or where it was installed; None where it is not."""
    places = (Path(cnc_ptp.__file__).parents[1], Path(sys.prefix) / "share" / "cnc_ptp")
    return next((place / SCHEMA for place in places if (place / SCHEMA).is_file()), None)


def kind_of(node: str, machine: Mapping[str, Any]) -> str:
    """What /machine lists the node as."""
    listed = machine["nodes"]["machine"]
    kinds = {"channel": listed.get("channels", ()), "axis": listed["axes"], "spindle": listed.get("spindles", ())}
    return next((kind for kind, names in kinds.items() if node in names), "machine")


def node_lines(kind: str, parameters: Mapping[str, Any]) -> Iterator[str]:
    """One line a parameter, nested as its name is; parameters of one group stand together."""
    letter = {"ACHSTYP_ROTATOR": "R", "ACHSTYP_SPINDEL": "S"}.get(parameters.get("kenngr.achs_typ", ""), "T")
    before: list[str] = []
    for path, value, entry in sorted_parameters(kind, parameters):
        *groups, last = path
        shared = 0
        while shared < min(len(groups), len(before)) and groups[shared] == before[shared]:
            shared += 1
        for depth, group in enumerate(groups[shared:], shared):
            yield f"{'  ' * (depth + 2)}{key(group)}:"
        before = groups
        yield with_comment(f"{'  ' * (len(groups) + 2)}{key(last)}: {written(value)}", comment(entry, value, letter))


def sorted_parameters(kind: str, parameters: Mapping[str, Any]) -> Iterator[tuple[list[str], Any, Declaration]]:
    """Names in parts, values and declarations; groups in the order of their first parameter."""
    paths = {tuple(dotted(name).split(".")): value for name, value in parameters.items()}
    order: dict[tuple[str, ...], int] = {}
    for path in paths:
        for length in range(1, len(path) + 1):
            order.setdefault(path[:length], len(order))
    ranked = sorted(paths, key=lambda path: [order[path[:length]] for length in range(1, len(path) + 1)])
    for path in ranked:
        known = catalogue().by_key[kind][split_indexes(".".join(path))[0]]
        yield list(path), paths[path], known


def key(segment: str) -> str:
    return f'"{segment}"' if segment.isdecimal() else segment


def written(value: Any) -> str:
    """As YAML; texts that ROS would read as a boolean are quoted."""
    if isinstance(value, list):
        return f"[{', '.join(map(written, value))}]"
    if isinstance(value, str) and value.lower() in ("y", "n"):
        return f'"{value}"'
    text: str = yaml.safe_dump(value, allow_unicode=True, width=1000)
    return text.partition("\n")[0]


def comment(entry: Declaration, value: Any, letter: str) -> str:
    """P number, the value in the unit of people, and the beginning of the text."""
    unit = entry.unit_for(letter)
    shown, factor = SHOWN_UNITS.get(unit, (unit, 1))
    if letter == "S" and shown == "°/s":
        shown, factor = "rpm", round(factor * DEG_S_PER_RPM)
    amount = f", {shown_number(value, factor)} {shown}" if shown and isinstance(value, int | float) else ""
    chosen = entry.choices.get(value, "") if entry.type == "int" else ""
    return f"{entry.id}{amount}{f', {chosen}' if chosen else ''}: {first_sentence(entry.text)}"


def first_sentence(text: str) -> str:
    """Up to its first full stop, semicolon or colon that ends a part."""
    ends = [at for at in (text.find(mark) for mark in (". ", "; ", ": ")) if at > 0]
    return text[: min(ends, default=len(text))].rstrip(".")


def with_comment(line: str, text: str) -> str:
    return f"{line:<{TEXT_COLUMN}}  # {text}"
