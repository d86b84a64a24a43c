"""declarations.yaml as objects: name, range and meaning of each parameter. Read once per process, at first use."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from cnc_ptp import yaml_text

Number = int | float
ParameterValue = bool | int | float | str | tuple[str, ...]

DATA_TYPES: dict[str, tuple[str, int | None, int | None]] = {
    "UNS08": ("int", 0, 2**8 - 1),
    "UNS16": ("int", 0, 2**16 - 1),
    "UNS32": ("int", 0, 2**32 - 1),
    "SGN08": ("int", -(2**7), 2**7 - 1),
    "SGN16": ("int", -(2**15), 2**15 - 1),
    "SGN32": ("int", -(2**31), 2**31 - 1),
    "REAL64": ("float", None, None),
    "BOOLEAN": ("bool", None, None),
    "STRING": ("string", None, None),
    "STRINGS": ("strings", None, None),
}
"""Data type of the lists -> (type of the value, natural minimum, natural maximum)."""

LISTS = ("axis", "channel", "startup", "zero", "clamp", "compensation", "tool", "simulation", "machine")
OF_CHANNELS = ("channel", "startup", "zero", "clamp", "tool")
NODE_KINDS = ("machine", "channel", "axis", "spindle")
AXIS_LETTERS = {"T": "linear axes", "R": "rotary axes", "S": "spindles"}
DRIVE_NUMBERS = {
    "conventional": 1,
    "SERCOS": 2,
    "PROFIDRIVE": 3,
    "simulation": 4,
    "Lightbus": 5,
    "terminal": 6,
    "CANopen": 8,
}
"""Drive types as `drives` names them -> P-AXIS-00020."""


LONGEST_INDEX = 1000
"""Digits; Python reads no integer of more than 4300."""


class Limit(NamedTuple):
    """A lower or upper limit: a number, or the id of the parameter that is the limit."""

    value: Number | str
    inclusive: bool


@dataclass(frozen=True, slots=True)
class Declaration:
    """One parameter of one list. `name` has an `i`, `j` for each array index; `unit` is (linear axes, others)."""

    id: str
    list_name: str
    name: str
    data_type: str
    default: ParameterValue
    text: str
    source: str
    axes: str
    unit: tuple[str, str]
    lower: tuple[Limit, ...]
    upper: tuple[Limit, ...]
    unset: ParameterValue | None
    choices: Mapping[Any, Any]
    flags: bool
    form: str
    form_text: str
    max_length: int
    effective: bool | str
    """False: nothing reads it; letters: in effect for these axis types only."""
    read_only: bool
    range: str
    """Shown instead of the limits, if a separate check with its own error number handles them."""
    drives: str
    """Drive types for which the manual lists it; empty: all."""
    since: str
    """Version of the CNC that brought it; empty where the manual says nothing."""
    topic: str
    """What it is about: one of a few words for each list."""
    change: str
    """When a new value takes effect in a running machine: now, standstill; start: at start-up only, as the manual has
    it; empty: at start-up only in this version. Axis types behind it: for these only."""
    names: Mapping[str, int]
    """Constants for the bits of a number; the lists may use them, joined by |."""
    misprints: tuple[str, ...]
    """Misprinted names in the manual; not accepted, but the message gives the right one."""

    @property
    def type(self) -> str:
        """int, float, bool, string or strings."""
        return DATA_TYPES[self.data_type][0]

    @property
    def drive_types(self) -> tuple[int, ...]:
        """Values of P-AXIS-00020 for which the manual lists it; empty: all."""
        return tuple(DRIVE_NUMBERS[name] for name in self.drives.split(", ") if name)

    @property
    def key(self) -> str:
        """Dotted name with * for each index: getriebe.*.kv."""
        return self.name.replace("[i]", ".*").replace("[j]", ".*")

    @property
    def index_count(self) -> int:
        return self.key.count("*")

    def ros_name(self, indexes: tuple[int, ...]) -> str:
        """Name as a ROS parameter: getriebe.0.kv."""
        name = self.key
        for index in indexes:
            name = name.replace("*", str(index), 1)
        return name

    def list_style_name(self, indexes: tuple[int, ...]) -> str:
        """Name as the lists write it: getriebe[0].kv."""
        name = self.name
        for letter, index in zip("ij", indexes, strict=False):
            name = name.replace(f"[{letter}]", f"[{index}]")
        return name

    def subject(self, indexes: tuple[int, ...], node: str) -> str:
        """What a problem is about: 'axis list, P-AXIS-00099 getriebe[0].kv of /x'."""
        return f"{self.list_name} list, {self.id} {self.list_style_name(indexes)} of /{node}"

    def belongs_to(self, node_kind: str) -> bool:
        """Whether such nodes have it: axes and spindles those with axis types, channels their own lists."""
        if self.axes:
            return node_kind in ("axis", "spindle")
        return node_kind == ("channel" if self.list_name in OF_CHANNELS else "machine")

    def effective_for(self, axis_type: str) -> bool:
        """Whether it has an effect on an axis of type T, R or S, or on a node without axis type."""
        return axis_type in self.effective if isinstance(self.effective, str) else self.effective

    def change_for(self, axis_type: str) -> str:
        """`change` for an axis of type T, R or S, or for a node without axis type."""
        when, _, letters = self.change.partition(" ")
        return "" if letters and axis_type not in letters else when

    def unit_for(self, axis_type: str) -> str:
        """Unit for an axis of type T, R or S."""
        return self.unit[0 if axis_type == "T" else 1]


class Array(NamedTuple):
    """Number of elements that an array may have, and how many a node always has."""

    size: int
    always: int


@dataclass(frozen=True)
class Catalogue:
    """All declarations."""

    by_id: Mapping[str, Declaration]
    arrays: Mapping[str, Array]
    by_key: Mapping[str, Mapping[str, Declaration]]
    """Node kind -> key -> declaration."""
    aliases: Mapping[str, str] = field(default_factory=dict)
    """Old spellings of a part of a name, which lists may use -> the part in the declarations."""

    def of_node(self, node_kind: str) -> Iterator[Declaration]:
        return iter(self.by_key[node_kind].values())

    def sizes(self, declaration: Declaration) -> tuple[Array, ...]:
        """The arrays of a parameter, outermost first."""
        segments = declaration.key.split(".")
        return tuple(self.arrays[name] for name, index in pairwise(segments) if index == "*")


def dotted(name: str) -> str:
    """getriebe[0].kv -> getriebe.0.kv; dotted names stay unchanged."""
    return re.sub(r"\[([0-9]+)\]", r".\1", name)


def split_indexes(ros_name: str) -> tuple[str, tuple[int, ...]]:
    """getriebe.0.kv -> (getriebe.*.kv, (0,)). More than LONGEST_INDEX digits are no index."""
    segments = ros_name.split(".")
    numbers = [segment.isdecimal() and segment.isascii() and len(segment) <= LONGEST_INDEX for segment in segments]
    key = ".".join("*" if number else segment for segment, number in zip(segments, numbers, strict=True))
    return key, tuple(int(segment) for segment, number in zip(segments, numbers, strict=True) if number)


@cache
def catalogue() -> Catalogue:
    """The declarations of declarations.yaml."""
    text = Path(__file__).with_name("declarations.yaml").read_text(encoding="utf-8")
    return make_catalogue(yaml_text.load(text))


def make_catalogue(data: Mapping[str, Any]) -> Catalogue:
    declarations = [make_declaration(number, entry) for number, entry in data["parameters"].items()]
    arrays = {name: Array(array["size"], array.get("always", 0)) for name, array in data["arrays"].items()}
    by_key: dict[str, dict[str, Declaration]] = {kind: {} for kind in NODE_KINDS}
    for declaration in declarations:
        for kind in NODE_KINDS:
            if declaration.belongs_to(kind):
                by_key[kind][declaration.key] = declaration
    by_id = {declaration.id: declaration for declaration in declarations}
    return Catalogue(by_id, arrays, by_key, data.get("aliases", {}))


def make_declaration(number: str, entry: Mapping[str, Any]) -> Declaration:
    kind, natural_minimum, natural_maximum = DATA_TYPES[entry["type"]]
    unit = entry.get("unit", "")
    return Declaration(
        id=number,
        list_name=entry["list"],
        name=entry["name"],
        data_type=entry["type"],
        default=make_default(kind, entry["default"]),
        text=entry["text"],
        source=entry["source"],
        axes=entry.get("axes", ""),
        unit=(unit, unit) if isinstance(unit, str) else (unit[0], unit[1]),
        lower=make_limits(entry, "min", "above", natural_minimum),
        upper=make_limits(entry, "max", "below", natural_maximum),
        unset=entry.get("unset"),
        choices=entry.get("choices", {}),
        flags=entry.get("flags", False),
        form=entry.get("form", ""),
        form_text=entry.get("form_text", ""),
        max_length=entry.get("max_length", 0),
        effective=entry.get("effective", True),
        read_only=entry.get("read_only", True),
        range=entry.get("range", ""),
        drives=entry.get("drives", ""),
        since=entry.get("since", ""),
        topic=entry["topic"],
        change=entry.get("change", ""),
        names=entry.get("names", {}),
        misprints=tuple(entry.get("misprints", ())),
    )


def make_default(kind: str, value: Any) -> ParameterValue:
    converters: dict[str, Any] = {"int": int, "float": float, "bool": bool, "string": str, "strings": tuple}
    default: ParameterValue = converters[kind](value)
    return default


def make_limits(entry: Mapping[str, Any], inclusive: str, exclusive: str, natural: int | None) -> tuple[Limit, ...]:
    limits = [Limit(entry[key], key == inclusive) for key in (inclusive, exclusive) if key in entry]
    if natural is not None and all(isinstance(limit.value, str) for limit in limits):
        limits.append(Limit(natural, True))
    return tuple(limits)
