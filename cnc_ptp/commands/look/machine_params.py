"""Parameters of machine files: `cnc_ptp params --changed`, `params diff`, `params check`."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import NamedTuple

from rich.console import Console

from cnc_ptp.commands.look.table import table_lines
from cnc_ptp.errors import WRONG_INPUT
from cnc_ptp.parameters import ParameterSet, examine_machine, machine_text, read_machine
from cnc_ptp.parameters.declare.declarations import Declaration, ParameterValue
from cnc_ptp.parameters.declare.ranges import default_text
from cnc_ptp.parameters.read.parameter_set import Parameter

DIFFERENT = 1
"""Exit status when two machine files differ."""
ABSENT = "-"
WIDEST = 1000
"""Characters of a line in which nothing is cut off."""


class Value(NamedTuple):
    """A parameter of a node with its value."""

    declaration: Declaration
    name: str
    value: ParameterValue
    unit: str

    @property
    def number(self) -> str:
        return self.declaration.id

    @property
    def text(self) -> str:
        return default_text(self.value)


def changed_lines(machine: str, wanted: Collection[str], width: int) -> Iterator[str]:
    """The parameters of a machine file that differ from their defaults, of those that are `wanted` by id."""
    rows = [
        (f"/{node}", entry.number, entry.name, entry.text, default_text(entry.declaration.default), entry.unit)
        for node, own in read_machine(machine).sets.items()
        for entry in given(own)
        if entry.number in wanted and entry.value != entry.declaration.default
    ]
    if not rows:
        return iter(["nothing differs from the defaults"])
    return table_lines(("node", "id", "name", "value", "default", "unit"), rows, width)


def diff(first: str, second: str) -> int:
    """Prints in which parameters two machines differ, whether given or by default. Raises ParameterError."""
    before, after = read_machine(first).sets, read_machine(second).sets
    rows = [row for node in dict.fromkeys([*before, *after]) for row in differences(node, before, after)]
    if not rows:
        print("no parameter differs")
        return 0
    print(*table_lines(("node", "id", "name", "first", "second", "unit"), rows, WIDEST), sep="\n")
    return DIFFERENT


def differences(
    node: str, before: Mapping[str, ParameterSet], after: Mapping[str, ParameterSet]
) -> Iterator[tuple[str, ...]]:
    """Rows of the parameters of a node that are not the same; one row for a node that only one machine has."""
    if node not in before or node not in after:
        kinds = [machine[node].kind if node in machine else ABSENT for machine in (before, after)]
        yield f"/{node}", ABSENT, "the node itself", *kinds, ""
        return
    old, new = values(before[node]), values(after[node])
    for name in dict.fromkeys([*old, *new]):
        shown = [side[name].text if name in side else ABSENT for side in (old, new)]
        if shown[0] != shown[1]:
            entry = old.get(name) or new[name]
            yield f"/{node}", entry.number, name, *shown, entry.unit


def check(machine: str) -> int:
    """Prints all problems and notices of a machine file, in the order of its lines. Raises ParameterError."""
    problems, notices = examine_machine(machine_text(machine), machine)
    console = Console(highlight=False, soft_wrap=True, emoji=False)
    lines = [(each.place, f"{each.place}: error {each.error_id}: {each.text}", "red") for each in problems]
    for each in notices:
        text = f"{each.place}: warning {each.error_id}: {each.parameter}: {each.text}"
        lines.append((each.place, text, "yellow"))
    for _, text, style in sorted(lines):
        console.print(text, style=style, markup=False)
    verdict = "the machine does not start" if problems else "the machine starts"
    console.print(f"{counted(len(problems), 'error')}, {counted(len(notices), 'warning')}: {verdict}", markup=False)
    return WRONG_INPUT if problems else 0


def counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def values(own: ParameterSet) -> dict[str, Value]:
    """The parameters of a node by their names in the lists."""
    return {value.name: value for value in (value_of(own, entry) for entry in own.parameters())}


def given(own: ParameterSet) -> Iterator[Value]:
    """What the file gives, in its order."""
    return (value_of(own, own.find(name)) for name in own.given)


def value_of(own: ParameterSet, entry: Parameter) -> Value:
    declaration, indexes, value = entry
    unit = declaration.unit_for(own.axis_type or "T")
    return Value(declaration, declaration.list_style_name(indexes), value, unit)
