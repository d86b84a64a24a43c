"""The units of a folder of lists: which axes, spindles and channels there are, their names as nodes, their lists."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import catalogue
from cnc_ptp.parameters.errors import Place
from cnc_ptp.parameters.lists.folder import ListFile
from cnc_ptp.parameters.lists.kinds import AXIS, CHANNEL, COMPENSATION
from cnc_ptp.parameters.lists.lines import Line
from cnc_ptp.parameters.lists.names import BadIndex, UnknownName, resolve
from cnc_ptp.parameters.lists.problems import ListProblem
from cnc_ptp.parameters.lists.values import BadLine, plain_number, split_value, unquoted
from cnc_ptp.parameters.read.machine_sections import name_trouble
from cnc_ptp.parameters.read.parameter_set import AXIS_TYPES
from cnc_ptp.parameters.read.values import shown

_AXIS_NAME = re.compile(r"gruppe\.\d+\.achse\.\d+|spindel\.\d+")
UNIT_LISTS: Final = {"channels": "channel", "axes": "axis", "spindles": "spindle"}
"""Parameters of the start-up list with the names of nodes, and the kind of these."""


@dataclass
class Unit:
    """A node of the machine file with its lists; `number`: its logical axis number, if its list gives one."""

    kind: str
    lists: list[ListFile]
    number: int | None = None
    letter: str = ""
    """T, R or S of an axis or spindle."""
    name: str = ""

    @property
    def own(self) -> ListFile:
        """Its axis list or channel list."""
        return self.lists[0]


@dataclass
class Units:
    """All units, in the order of /machine."""

    channels: list[Unit] = field(default_factory=list)
    axes: list[Unit] = field(default_factory=list)
    """Axes and spindles."""

    def of(self, kind: str) -> list[Unit]:
        return [unit for unit in (*self.channels, *self.axes) if unit.kind == kind]

    def __iter__(self) -> Iterator[Unit]:
        yield from (*self.channels, *self.of("axis"), *self.of("spindle"))


def values_of(node: str, lines: Sequence[Line]) -> dict[str, str]:
    """The values of a list as they are written, by ROS name; of lines that can be read."""
    found: dict[str, str] = {}
    for line in lines:
        if not line.name:
            continue
        try:
            declaration, indexes, _ = resolve(node, line.name)
            found.setdefault(declaration.ros_name(indexes), unquoted(split_value(declaration, line.rest).value))
        except (UnknownName, BadIndex, BadLine):
            continue
    return found


def number_in(values: Mapping[str, str], name: str) -> int | None:
    """A number that a list gives; None for another value, or without one."""
    text = plain_number(values.get(name, ""))
    return int(text, 0) if re.fullmatch("0x[0-9a-f]{1,8}|[0-9]{1,9}", text.lower()) else None


def axis_letter(values: Mapping[str, str]) -> str:
    """T, R or S of an axis list; T without a type that can be read."""
    numbers = {value: AXIS_TYPES[text] for text, value in catalogue().by_id[ids.KENNGR_ACHS_TYP].choices.items()}
    text = values.get("kenngr.achs_typ", "")
    return AXIS_TYPES.get(text) or numbers.get(number_in(values, "kenngr.achs_typ"), "T")


def find_units(lists: Sequence[ListFile], startup: ListFile | None, problems: list[ListProblem]) -> Units:
    """The units of the lists, with the names that the start-up list gives.

    If a list is missing, as `problems` has it, what follows from that is not said again.
    """
    found: list[ListProblem] = []
    units = units_of(lists, startup, found)
    missing = any(problem.error_id in (errors.UNREADABLE, errors.LIST_KIND, errors.LIST_TEXT) for problem in problems)
    problems += [problem for problem in found if not (missing and problem.error_id in (errors.COUNT, errors.LIST_UNIT))]
    return units


def units_of(lists: Sequence[ListFile], startup: ListFile | None, problems: list[ListProblem]) -> Units:
    units = Units()
    channel_values = {}
    for entry in lists:
        if entry.kind is AXIS:
            values = values_of("axis", entry.lines)
            letter = axis_letter(values)
            kind = "spindle" if letter == "S" else "axis"
            units.axes.append(Unit(kind, [entry], number_in(values, "kopf.achs_nr"), letter))
        elif entry.kind is CHANNEL:
            channel_values[entry.name] = values_of("channel", entry.lines)
            units.channels.append(Unit("channel", [entry]))
    if any(unit.own.number is None for unit in units.axes):
        units.axes.sort(key=lambda unit: (unit.number is None, unit.number or 0))
    name_units(units, startup, axis_names(channel_values.values()), problems)
    for entry in lists:
        if entry.kind not in (AXIS, CHANNEL):
            add_to_unit(entry, units.axes if entry.kind is COMPENSATION else units.channels, problems)
    return units


def axis_names(channels: Iterable[Mapping[str, str]]) -> dict[int, str]:
    """The names of axes and spindles in channels, by logical axis number."""
    names: dict[int, str] = {}
    for values in channels:
        for name, text in values.items():
            prefix, _, last = name.rpartition(".")
            if last == "bezeichnung" and _AXIS_NAME.fullmatch(prefix):
                number = number_in(values, f"{prefix}.log_achs_nr")
                if number is not None:
                    names.setdefault(number, text)
    return names


def name_units(
    units: Units, startup: ListFile | None, by_number: Mapping[int, str], problems: list[ListProblem]
) -> None:
    """Gives each unit its name as a node: from the start-up list, else from its file, its channel, its number."""
    taken: dict[str, str] = {}
    for kind, line, names in names_in_startup(startup):
        of_kind = units.of(kind)
        if len(names) != len(of_kind):
            text = f"{line.name} names {len(names)}, the folder has the lists of {len(of_kind)}; name each, or none"
            problems.append(ListProblem(errors.COUNT, line.value_place, text, line.text))
            continue
        for unit, name in zip(of_kind, names, strict=True):
            if trouble := name_trouble(name, taken):
                text = f"{line.name}: {shown(name)} {trouble}; write another name"
                problems.append(ListProblem(errors.UNIT_NAME, line.value_place, text, line.text))
            else:
                unit.name = name
                taken[name] = kind
    for unit in units:
        if not unit.name:
            unit.name = free_name(unit, by_number, len(units.channels), taken)
            taken[unit.name] = unit.kind


def free_name(unit: Unit, by_number: Mapping[int, str], channels: int, taken: Mapping[str, str]) -> str:
    hint = unit.own.hint.lower()
    number = str(unit.number) if unit.number is not None else hint if hint.isdecimal() else ""
    candidates = [hint, by_number.get(unit.number or 0, "").lower()]
    if unit.kind == "channel" and channels == 1:
        candidates.append("channel")
    candidates += [f"{unit.kind}{number}", *(f"{unit.kind}_{index}" for index in range(1, len(taken) + 2))]
    return next(name for name in candidates if name and not name_trouble(name, taken))


def add_to_unit(entry: ListFile, units: Sequence[Unit], problems: list[ListProblem]) -> None:
    """Gives a list to the unit that it is for: by its header, by its name, by its place in the start-up list."""
    number = header_number(entry) if entry.kind is COMPENSATION else None
    numbered = [unit for unit in units if number is not None and unit.number == number]
    unit = numbered[0] if len(numbered) == 1 else by_hint(entry, units) or by_place(entry, units)
    if unit is None and numbered:  # two axes with one number, which is said elsewhere
        unit = next((each for each in numbered if entry.kind not in [other.kind for other in each.lists]), None)
    unit = unit or (units[0] if len(units) == 1 else None)
    what = "axis" if entry.kind is COMPENSATION else "channel"
    if unit is None:
        remedy = "write kopf.achs_nr into it" if entry.kind is COMPENSATION else "give it an index in the start-up list"
        name = f"{entry.kind.entry}_NAME.lis"
        text = f"the {what} of this {entry.kind.title} cannot be told; {remedy}, or call it {name}"
        problems.append(ListProblem(errors.LIST_UNIT, entry.place, text))
        return
    for other in unit.lists:
        if other.kind is entry.kind:
            text = f"{other.name} is the {entry.kind.title} of {what} {unit.name} already; merge them, or delete one"
            problems.append(ListProblem(errors.LIST_UNIT, entry.place, text))
            return
    unit.lists.append(entry)


def header_number(entry: ListFile) -> int | None:
    """The number of its axis in the header of a compensation list."""
    return number_in(values_of("axis", entry.lines), "kopf.achs_nr")


def by_hint(entry: ListFile, units: Sequence[Unit]) -> Unit | None:
    hint = entry.hint.lower()
    return next((unit for unit in units if hint and hint in (unit.name, unit.own.hint.lower())), None)


def by_place(entry: ListFile, units: Sequence[Unit]) -> Unit | None:
    return next((unit for unit in units if entry.number is not None and unit.own.number == entry.number), None)


def names_in_startup(startup: ListFile | None) -> Iterator[tuple[str, Line, tuple[str, ...]]]:
    """The nodes that a start-up list names: kind, line, names. Such lines are our own, an export writes them."""
    for line in startup.lines if startup else ():
        if kind := UNIT_LISTS.get(line.name):
            declaration = catalogue().by_key["machine"][line.name]
            try:
                value = split_value(declaration, line.rest).value
            except BadLine:
                continue
            yield kind, line, tuple(unquoted(item.strip()) for item in value.split(",")) if value != "[]" else ()


def place_of(startup: ListFile | None, folder: str) -> Place:
    return startup.place if startup else Place(folder, 1, 1)
