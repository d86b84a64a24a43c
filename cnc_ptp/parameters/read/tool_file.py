"""A tool table file: text in mm and degrees -> records of the tool list (wz[i], P-TOOL) with their places.

One key for each T number. A tool has one set of compensation data under its own number, or several by D number; what
stands beside `d` is for all of them:

    5: {name: turning tool, type: turning, orientation: 3, offsets: {X: 20.5, Z: 41}, wear: {X: -0.02}}
    6: {type: turning, d: {6: {orientation: 3, offsets: {Z: 40}}, 16: {orientation: 4, offsets: {Z: 37}}}}
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar, Final, NamedTuple

import yaml

from cnc_ptp.errors import nearest_name
from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import Declaration, ParameterValue, catalogue
from cnc_ptp.parameters.errors import Place, Problem
from cnc_ptp.parameters.read.named_files import file_text, given_before
from cnc_ptp.parameters.read.parameter_set import Given, ParameterSet
from cnc_ptp.parameters.read.source import Entry, Reader, Value, is_null, read_events
from cnc_ptp.parameters.read.values import NEEDED, BadValue, as_float, checked_value, described, shown, with_unit

LARGEST_T: Final = 999_999_999


class Field(NamedTuple):
    """A key of a tool: its parameter, and what one of its unit is in the list; 0 is a value without a unit."""

    parameter: str
    scale: float = 0.0
    unit: str = ""


MM, RPM = 10_000.0, 6_000.0
FIELDS: Final = {
    "name": Field(ids.WZ_NAME),
    "type": Field(ids.WZ_TYP),
    "orientation": Field(ids.WZ_SRK_LAGE),
    "length": Field(ids.WZ_LAENGE, MM, "mm"),
    "radius": Field(ids.WZ_RADIUS, MM, "mm"),
    "wear.length": Field(ids.WZ_WEAR_LENGTH, MM, "mm"),
    "wear.radius": Field(ids.WZ_WEAR_RADIUS, MM, "mm"),
    "fixed": Field(ids.WZ_TOOL_FIXED),
    "valid": Field(ids.WZ_GUELTIG),
    "spindle": Field(ids.WZ_LOG_AX_NR_SPDL),
    "min_speed": Field(ids.WZ_VB_MIN, RPM, "rpm"),
    "max_speed": Field(ids.WZ_VB_MAX, RPM, "rpm"),
    "max_acceleration": Field(ids.WZ_A_MAX, 1.0, "°/s²"),
}
BY_AXIS: Final = {"offsets": ids.WZ_AX_VERSATZ, "wear": ids.WZ_WEAR}
"""Keys with a value for each axis, by its name in programs; mm, for rotary axes deg."""
SETS: Final = "d"
TYPES: Final = {"mill": 0, "drill": 0, "turning": 1, "grinding": 2, "wire": 3}


class Record(NamedTuple):
    """Compensation data of one D number as the file gives them; names with a dot: `wear.length`, `offsets.X`."""

    tool: int
    number: int
    place: Place
    entries: Sequence[Entry]

    @property
    def title(self) -> str:
        """As errors show it."""
        return title(self.tool, self.number)


def title(tool: int, number: int) -> str:
    return f"tool T{tool}" if number == tool else f"tool T{tool} D{number}"


def read_tools(text: str, file: str) -> tuple[list[Record], list[Problem]]:
    """The records of a tool table file and the problems of its form; values are not checked here."""
    reader = ToolReader(file)
    read_events(reader, text)
    return reader.records, reader.problems


class ToolReader(Reader):
    """Walks through the events of a tool table file."""

    what: ClassVar[str] = "a tool table"
    content: ClassVar[str] = "T numbers"

    def __init__(self, file: str) -> None:
        super().__init__(file)
        self.records: list[Record] = []
        self.numbers: dict[int, Place] = {}
        """D numbers and where they are."""

    def read_nodes(self, events: Iterator[Any]) -> None:
        tools: dict[int, int] = {}
        for key, event in self.pairs(events):
            tool = self.number(key, "tool number", LARGEST_T)
            if tool in tools:
                self.add(errors.DUPLICATE_KEY, key, f"tool T{tool} is given twice, first in line {tools[tool]}")
                tool = 0
            if not tool:
                self.skip(event, events)
                continue
            tools[tool] = self.place(key).line
            self.read_tool(tool, key, event, events)

    def number(self, key: Any, what: str, limit: int) -> int:
        """0 for a key that is no such number: it is a problem then."""
        text: str = key.value
        number = int(text) if text.isascii() and text.isdecimal() and len(text) < 10 else 0
        if not 1 <= number <= limit:
            self.add(errors.OUT_OF_RANGE, key, f"{what} {shown(text)} must be an integer from 1 to {limit}")
            return 0
        return number

    def read_tool(self, tool: int, key: Any, event: Any, events: Iterator[Any]) -> None:
        own: list[Record] = []
        common = self.entries(title(tool, tool), event, events, tool, own)
        if own:
            for record in own:
                named = {entry.name for entry in record.entries}
                entries = [*(entry for entry in common if entry.name not in named), *record.entries]
                self.take(record._replace(entries=entries))
        elif tool <= catalogue().arrays["wz"].size - 1:
            self.take(Record(tool, tool, self.place(key), common))
        else:
            limit = catalogue().arrays["wz"].size - 1
            text = f"tool T{tool} needs D numbers of its own (d: ...), its number is above {limit}"
            self.add(errors.OUT_OF_RANGE, key, text)

    def take(self, record: Record) -> None:
        before = self.numbers.get(record.number)
        if before is not None:
            text = f"D{record.number} of tool T{record.tool} is given twice, first in line {before.line}"
            self.problems.append(Problem(errors.DUPLICATE_KEY, record.place, text))
            return
        self.numbers[record.number] = record.place
        self.records.append(record)

    def entries(
        self, what: str, event: Any, events: Iterator[Any], tool: int = 0, sets: list[Record] | None = None
    ) -> list[Entry]:
        """The values of a tool or of one of its sets; those under `d` go to `sets`."""
        found: dict[str, Entry] = {}
        if not isinstance(event, yaml.MappingStartEvent):
            if not is_null(event):
                self.expect_mapping(event, events, what)
            return []
        seen: dict[str, int] = {}
        for key, value in self.pairs(events):
            name: str = key.value
            if name in seen:
                self.add(errors.DUPLICATE_KEY, key, f"{what} has {name} twice, first in line {seen[name]}")
                self.skip(value, events)
                continue
            seen[name] = self.place(key).line
            if name == SETS and sets is not None:
                self.read_sets(tool, value, events, sets)
            elif name in BY_AXIS:
                self.by_axis(f"{what}, {name}", name, value, events, found)
            elif name in FIELDS:
                found[name] = Entry(name, self.value(value, events), self.place(value))
            else:
                known = [
                    *(field for field in FIELDS if "." not in field),
                    *BY_AXIS,
                    *([SETS] if sets is not None else []),
                ]
                text = f"{what} has no value {shown(name)}"
                self.add(errors.UNKNOWN_NAME, key, text + similar(name, known))
                self.skip(value, events)
        return list(found.values())

    def read_sets(self, tool: int, event: Any, events: Iterator[Any], sets: list[Record]) -> None:
        if not isinstance(event, yaml.MappingStartEvent):
            self.expect_mapping(event, events, f"tool T{tool}, d")
            return
        for key, value in self.pairs(events):
            number = self.number(key, f"tool T{tool}: D number", catalogue().arrays["wz"].size - 1)
            if not number:
                self.skip(value, events)
                continue
            place = self.place(key)
            sets.append(Record(tool, number, place, self.entries(title(tool, number), value, events)))

    def by_axis(self, what: str, name: str, event: Any, events: Iterator[Any], found: dict[str, Entry]) -> None:
        """`offsets: {X: 1}`, `wear: {length: -0.1, X: -0.05}`."""
        if not isinstance(event, yaml.MappingStartEvent):
            self.expect_mapping(event, events, what)
            return
        for key, value in self.pairs(events):
            full = f"{name}.{key.value}"
            if full in found:
                text = f"{what} has {key.value} twice, first in line {found[full].place.line}"
                self.add(errors.DUPLICATE_KEY, key, text)
                self.skip(value, events)
                continue
            found[full] = Entry(full, self.value(value, events), self.place(value))


def similar(name: str, known: Iterable[str]) -> str:
    names = list(known)
    return nearest_name(name, names) or f"; known are: {', '.join(names)}"


def with_tools(
    channel: ParameterSet,
    axes: Sequence[str],
    rotary: Sequence[bool],
    files: Mapping[str, str],
    problems: list[Problem],
) -> ParameterSet:
    """The channel with the tools of its file; `axes` by their names in programs."""
    file = file_text(channel, ids.WERKZ_DATA, files, problems)
    if file is None:
        return channel
    name, text = file
    records, of_form = read_tools(text, name)
    problems += of_form
    given: dict[str, Given] = {}
    for record in records:
        given |= given_values(channel, record, axes, rotary, problems)
    return replace(channel, given={**channel.given, **given})


def given_values(
    channel: ParameterSet, record: Record, axes: Sequence[str], rotary: Sequence[bool], problems: list[Problem]
) -> dict[str, Given]:
    """The record as values of the channel's list by ROS name; lengths are in mm, so its unit is 0.1 µm."""
    found: dict[str, Given] = {}

    def add(parameter: str, axis: tuple[int, ...], value: ParameterValue, place: Place) -> None:
        declaration, indexes = catalogue().by_id[parameter], (record.number, *axis)
        twice = given_before(channel, declaration, indexes, place)
        if twice is not None:
            problems.append(twice)
        found[declaration.ros_name(indexes)] = Given(value, place)

    add(ids.WZ_T_NUMBER, (), record.tool, record.place)
    add(ids.WZ_MASS_EINHEIT, (), 0, record.place)
    for entry in record.entries:
        try:
            field, axis = field_of(record, entry.name, axes, rotary)
            value = list_value(catalogue().by_id[field.parameter], field, entry.value)
            add(field.parameter, axis, value, entry.place)
        except BadValue as error:
            where = "" if error.error_id == errors.UNKNOWN_NAME else f"{record.title}, {entry.name}: "
            problems.append(Problem(error.error_id, entry.place, where + error.text))
    return found


def field_of(record: Record, name: str, axes: Sequence[str], rotary: Sequence[bool]) -> tuple[Field, tuple[int, ...]]:
    """The field of a key, and the place of the axis that it is for. Raises BadValue for an axis that is not there."""
    if name in FIELDS:
        return FIELDS[name], ()
    kind, _, axis = name.partition(".")
    if axis.upper() not in axes:
        known = [*axes, *(("length", "radius") if kind == "wear" else ())]
        text = f"{record.title} has no {kind} of {shown(axis)}"
        raise BadValue(errors.UNKNOWN_NAME, text + similar(axis, known))
    place = list(axes).index(axis.upper())
    return Field(BY_AXIS[kind], MM, "°" if rotary[place] else "mm"), (place,)


def list_value(declaration: Declaration, field: Field, value: Value) -> ParameterValue:
    """A value of the file in the type and unit of the list. Raises BadValue."""
    if field.parameter == ids.WZ_TYP:
        if value not in TYPES:
            text = f"value {shown(value)} is none of {', '.join(TYPES)}"
            raise BadValue(errors.OUT_OF_RANGE, text)
        return TYPES[str(value)]
    if not field.scale:
        return checked_value(declaration, value, "")
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise BadValue(errors.WRONG_TYPE, f"value {shown(value)} is {described(value)}, {NEEDED['float']} is needed")
    if not math.isfinite(as_float(value)):
        raise BadValue(errors.OUT_OF_RANGE, f"value {shown(value)} is not a finite number")
    for limit in declaration.lower:
        if not isinstance(limit.value, str) and value * field.scale < limit.value:
            least = with_unit(limit.value / field.scale, field.unit)
            raise BadValue(errors.OUT_OF_RANGE, f"value {shown(value)} is below the minimum {least}")
    for limit in declaration.upper:
        if not isinstance(limit.value, str) and value * field.scale > limit.value:
            most = with_unit(limit.value / field.scale, field.unit)
            raise BadValue(errors.OUT_OF_RANGE, f"value {shown(value)} is above the maximum {most}")
    scaled = value * field.scale
    return round(scaled) if declaration.type == "int" else scaled
