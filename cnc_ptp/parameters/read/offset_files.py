"""Files with zero offsets and clamp positions, in mm and °, as parameters of a channel.

G54: {name: left vice, X: 100, Y: 50.5, Z: -20}
G159=7: {X: 12.5, inactive: [X]}
default: G54
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar, NamedTuple

import yaml

from cnc_ptp.errors import did_you_mean, nearest
from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import ParameterValue, catalogue
from cnc_ptp.parameters.errors import Place, Problem
from cnc_ptp.parameters.list_units import LARGEST_POSITION
from cnc_ptp.parameters.read.named_files import file_text, given_before
from cnc_ptp.parameters.read.parameter_set import Given, ParameterSet
from cnc_ptp.parameters.read.source import Entry, Reader, Scalar, Value, is_null, read_events
from cnc_ptp.parameters.read.values import BadValue, checked_value, described, shown

DIVISOR = 10_000
"""0.1 µm in a mm, 0.0001° in a degree."""
FIRST_OFFSET_CODE = 53
_INDEX = re.compile(r"(?:G159\s*=\s*)?([0-9]{1,9})")
_CODE = re.compile(r"G(5[3-9])")


class Kind(NamedTuple):
    """A kind of file: its parameter, what a record is called, the parameters of a value and of a name, the indices."""

    file: str
    record: str
    value: str
    name: str
    last: int
    names: str


ZERO_OFFSETS = Kind(
    ids.NULLP_DATA, "zero offset", ids.ACHSE_VERSCH, ids.NP_GRP_BEZEICHNUNG, 96, "G53 to G59 or G159=0 to G159=96"
)
CLAMP_POSITIONS = Kind(ids.PZV_DATA, "clamp position", ids.ACHSE_VERSATZ, ids.PZV_GRP_BEZEICHNUNG, 149, "0 to 149")
KINDS = (ZERO_OFFSETS, CLAMP_POSITIONS)


class Record(NamedTuple):
    """What a file says of one zero offset or clamp position; or, without `entries`, the value of another key."""

    key: str
    place: Place
    entries: tuple[Entry, ...]
    value: Value = None


class OffsetReader(Reader):
    """Reads the records of a file."""

    what: ClassVar[str] = "an offset file"
    content: ClassVar[str] = "offsets"

    def __init__(self, file: str) -> None:
        super().__init__(file)
        self.records: list[Record] = []

    def read_nodes(self, events: Iterator[Any]) -> None:
        for key, event in self.pairs(events):
            place = self.place(key)
            if isinstance(event, yaml.MappingStartEvent):
                self.records.append(Record(key.value, place, tuple(self.read_record(key.value, events))))
            elif not is_null(event):
                self.records.append(Record(key.value, place, (), self.value(event, events)))

    def read_record(self, record: str, events: Iterator[Any]) -> Iterator[Entry]:
        seen: dict[str, int] = {}
        for key, event in self.pairs(events):
            if isinstance(event, yaml.MappingStartEvent):
                self.add(errors.SYNTAX, key, f"{record}, {key.value}: a value is expected")
                self.skip(event, events)
                continue
            value, line = self.value(event, events), key.start_mark.line + 1
            if seen.setdefault(key.value, line) != line:
                text = f"{record} has {key.value} twice, first in line {seen[key.value]}"
                self.add(errors.DUPLICATE_KEY, key, text)
            yield Entry(key.value, value, self.place(event))


def with_offsets(
    channel: ParameterSet, axes: Sequence[str], files: Mapping[str, str], problems: list[Problem]
) -> ParameterSet:
    """The channel with the offsets of its files; `axes` by their names in programs."""
    given: dict[str, Given] = {}
    for kind in KINDS:
        file = file_text(channel, kind.file, files, problems)
        if file is None:
            continue
        name, text = file
        reader = OffsetReader(name)
        read_events(reader, text)
        problems += reader.problems
        given |= Offsets(kind, channel, axes, problems).read(reader.records)
    return replace(channel, given={**channel.given, **given}) if given else channel


class Offsets:
    """The records of one file as parameters of a channel; what is wrong goes to `problems`."""

    def __init__(self, kind: Kind, channel: ParameterSet, axes: Sequence[str], problems: list[Problem]) -> None:
        self.kind, self.channel, self.axes, self.problems = kind, channel, axes, problems
        self.given: dict[str, Given] = {}

    def read(self, records: Sequence[Record]) -> dict[str, Given]:
        """The parameters by ROS name."""
        first: dict[int, Record] = {}
        for record in records:
            if record.key == "default" and self.kind is ZERO_OFFSETS:
                self.add_default(record)
                continue
            index = self.index_of(record.key, record.place)
            if index is None:
                continue
            other = first.setdefault(index, record)
            if other is not record:
                text = f"{self.kind.record} {record.key} is given twice, first in line {other.place.line}"
                self.add_problem(errors.DUPLICATE_KEY, record.place, text)
            elif not record.entries and record.value is not None:
                text = f"{self.kind.record} {record.key}: axes with values are expected"
                self.add_problem(errors.SYNTAX, record.place, text)
            else:
                self.add_record(index, record)
        return self.given

    def index_of(self, key: str, place: Place) -> int | None:
        """Of the key of a record; None, with a problem, if it is none."""
        zero = self.kind is ZERO_OFFSETS
        code = _CODE.fullmatch(key) if zero else None
        number = _INDEX.fullmatch(key)
        if code:
            return int(code[1]) - FIRST_OFFSET_CODE
        if number and (zero or "G" not in key):
            if int(number[1]) <= self.kind.last:
                return int(number[1])
            text = f"{self.kind.record} {key} is outside 0 to {self.kind.last}"
            self.add_problem(errors.INDEX, place, text)
            return None
        code_meant = _CODE.fullmatch(key.upper())
        known = [code_meant[0] if code_meant else "default"] if zero else []
        text = f"{shown(key)} is no {self.kind.record}, {self.kind.names} are{similar(key, known)}"
        self.add_problem(errors.UNKNOWN_NAME, place, text)
        return None

    def add_default(self, record: Record) -> None:
        index = self.index_of(str(record.value), record.place)
        if index is not None:
            self.add(ids.DEFAULT_INDEX, (), index, record.place)

    def add_record(self, index: int, record: Record) -> None:
        if index == 0 and self.kind is ZERO_OFFSETS:
            self.given["g53_verfuegbar"] = Given(True, record.place)
        for entry in record.entries:
            if entry.name == "name":
                self.add(self.kind.name, (index,), entry.value, entry.place)
            elif entry.name == "inactive" and self.kind is ZERO_OFFSETS:
                for axis in entry.value if isinstance(entry.value, tuple) else (entry.value,):
                    if self.has_axis(record, str(axis), entry.place):
                        self.add(ids.ACHSE_INAKTIV, (index, self.axes.index(str(axis))), True, entry.place)
            elif self.has_axis(record, entry.name, entry.place):
                value = self.length(f"{self.kind.record} {record.key}, axis {entry.name}", entry)
                if value is not None:
                    self.add(self.kind.value, (index, self.axes.index(entry.name)), value, entry.place)

    def has_axis(self, record: Record, axis: str, place: Place) -> bool:
        """Whether the channel has an axis of this name; a problem, if not."""
        if axis in self.axes:
            return True
        words = [*self.axes, "name", *(["inactive"] if self.kind is ZERO_OFFSETS else [])]
        text = f"{self.kind.record} {record.key}: {shown(axis)} is no axis of /{self.channel.node}"
        self.add_problem(errors.UNKNOWN_NAME, place, f"{text} ({', '.join(self.axes)}){similar(axis, words)}")
        return False

    def length(self, where: str, entry: Entry) -> int | None:
        """A value of the file in units of the list; None, with a problem, if it is none."""
        value = entry.value
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            text = f"{where}: value {shown(value)} is {described(value)}, a number is needed"
            self.add_problem(errors.WRONG_TYPE, entry.place, text)
            return None
        if not -LARGEST_POSITION <= value <= LARGEST_POSITION or math.isnan(value):
            limits = f"-{LARGEST_POSITION} to {LARGEST_POSITION}"
            self.add_problem(errors.OUT_OF_RANGE, entry.place, f"{where}: value {shown(value)} is outside {limits}")
            return None
        counted = round(value * DIVISOR)
        if abs(value * DIVISOR - counted) > 1e-4:
            text = f"{where}: value {shown(value)} has more than four decimals"
            self.add_problem(errors.OUT_OF_RANGE, entry.place, text)
            return None
        return counted

    def add(self, parameter: str, indexes: tuple[int, ...], value: Value, place: Place) -> None:
        """A parameter of the list, unless the machine file gives it, too."""
        declaration = catalogue().by_id[parameter]
        name, where = declaration.ros_name(indexes), declaration.subject(indexes, self.channel.node)
        twice = given_before(self.channel, declaration, indexes, place)
        if twice is not None:
            self.problems.append(twice)
            return
        try:
            checked: ParameterValue = checked_value(declaration, value, declaration.unit_for(""))
        except BadValue as error:
            self.add_problem(error.error_id, place, f"{where}: {error.text}")
            return
        self.given[name] = Given(checked, place)

    def add_problem(self, error_id: int, place: Place, text: str) -> None:
        self.problems.append(Problem(error_id, place, text))


def similar(name: Scalar, known: Sequence[str]) -> str:
    return did_you_mean(nearest(str(name), known, cutoff=0.5))
