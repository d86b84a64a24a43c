"""Text of a ROS parameters file -> sections with flat parameter names, values and places.

Works on the events of the YAML parser, so that every value keeps its line and column, duplicates are found, and
any input, however deep or odd, gives at most a Problem. Anchors and aliases are refused, as ROS refuses them, and so
are tags (!!str, !!python/…), which would say what the declarations say.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar, NamedTuple

import yaml

from cnc_ptp import yaml_text
from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare.declarations import dotted
from cnc_ptp.parameters.errors import Place, Problem

Scalar = bool | int | float | str | None
Value = Scalar | tuple[Scalar, ...]

MAX_DEPTH = 20
TOO_DEEP = f"nested deeper than {MAX_DEPTH} levels"
INTEGER = re.compile(r"[-+]?[0-9]+|0x[0-9a-fA-F]+")
NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
BOOLEANS = {"true": True, "yes": True, "on": True, "false": False, "no": False, "off": False}
NULLS = ("", "~", "null", "Null", "NULL")


class Entry(NamedTuple):
    """One value of a section; `name` is dotted: getriebe.0.kv."""

    name: str
    value: Value
    place: Place


@dataclass
class Section:
    """The entries of a file for one node; `node` is its name without the slash."""

    node: str
    place: Place
    entries: list[Entry] = field(default_factory=list)


class Refused(Exception):
    """Reading cannot continue; carries the problem."""


def read_sections(text: str, file: str) -> tuple[list[Section], list[Problem]]:
    """The sections of a ROS parameters file and the problems of its form; names and values are not checked here."""
    reader = Reader(file)
    read_events(reader, text)
    return reader.sections, reader.problems


def read_events(reader: "Reader", text: str) -> None:
    """Reads a whole text, or up to what cannot be read."""
    file = reader.file
    try:
        reader.read_file(reader.without_tags(yaml.parse(text, Loader=yaml_text.PARSER)))
    except Refused as refusal:
        reader.problems.append(refusal.args[0])
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = Place(file, mark.line + 1, mark.column + 1) if mark else Place(file, 1, 1)
        reader.problems.append(Problem(errors.SYNTAX, place, f"YAML syntax error, {error.problem}"))
    except (yaml.YAMLError, ValueError) as error:
        reason = str(getattr(error, "reason", error)).splitlines()[0]
        reader.problems.append(Problem(errors.SYNTAX, Place(file, 1, 1), f"YAML cannot be read, {reason}"))


class Reader:
    """Walks through the events of one file."""

    what: ClassVar[str] = "a machine file"
    content: ClassVar[str] = "node names"

    def __init__(self, file: str) -> None:
        self.file = file
        self.sections: list[Section] = []
        self.problems: list[Problem] = []

    def without_tags(self, events: Iterator[Any]) -> Iterator[Any]:
        """The events; a tag is refused."""
        for event in events:
            tag = getattr(event, "tag", None)
            if tag is not None:
                shown = tag.replace("tag:yaml.org,2002:", "!!")
                raise self.refusal(event, f"tags are not supported: {shown}")
            yield event

    def read_file(self, events: Iterator[Any]) -> None:
        for event in events:
            if isinstance(event, (yaml.StreamStartEvent, yaml.StreamEndEvent, yaml.DocumentStartEvent)):
                continue
            if isinstance(event, yaml.DocumentEndEvent):
                self.refuse_second_document(events)
            elif isinstance(event, yaml.MappingStartEvent):
                self.read_nodes(events)
            elif not (isinstance(event, yaml.ScalarEvent) and event.value in NULLS):
                raise self.refusal(event, f"{self.what} is a mapping of {self.content}")

    def refuse_second_document(self, events: Iterator[Any]) -> None:
        event = next(events)
        if isinstance(event, yaml.DocumentStartEvent):
            raise self.refusal(event, f"{self.what} has one YAML document only")

    def read_nodes(self, events: Iterator[Any]) -> None:
        for key, event in self.pairs(events):
            section = Section(key.value.lstrip("/"), self.place(key))
            for other in self.sections:
                if other.node == section.node:
                    text = f"section /{section.node} is given twice, first in line {other.place.line}"
                    self.add(errors.DUPLICATE_KEY, key, text)
            self.sections.append(section)
            if isinstance(event, yaml.MappingStartEvent):
                self.read_section(section, events)
            elif not is_null(event):
                self.expect_mapping(event, events, f"section /{section.node}")

    def read_section(self, section: Section, events: Iterator[Any]) -> None:
        first = 0
        for key, event in self.pairs(events):
            if key.value != "ros__parameters":
                text = f"section /{section.node} has {key.value} where ros__parameters is expected"
                self.add(errors.SYNTAX, key, text)
                self.skip(event, events)
                continue
            if first:
                text = f"/{section.node} has ros__parameters twice, first in line {first}"
                self.add(errors.DUPLICATE_KEY, key, text)
            first = first or self.place(key).line
            if isinstance(event, yaml.MappingStartEvent):
                self.read_parameters(section, events)
            elif not is_null(event):
                self.expect_mapping(event, events, f"ros__parameters of /{section.node}")

    def read_parameters(self, section: Section, events: Iterator[Any]) -> None:
        """Flattens nested mappings; iterates over its own stack of prefixes."""
        seen: dict[str, int] = {}
        prefixes = [""]
        while prefixes:
            key = self.next_key(events)
            if key is None:
                prefixes.pop()
                continue
            name = prefixes[-1] + dotted(key.value)
            event = next(events)
            if isinstance(event, yaml.MappingStartEvent):
                prefixes.append(name + ".")
                if len(prefixes) > MAX_DEPTH:
                    raise self.refusal(event, TOO_DEEP)
                continue
            value = self.value(event, events)
            if name in seen:
                self.add(errors.DUPLICATE_KEY, key, f"/{section.node} has {name} twice, first in line {seen[name]}")
                continue
            seen[name] = key.start_mark.line + 1
            section.entries.append(Entry(name, value, self.place(event)))

    def value(self, event: Any, events: Iterator[Any]) -> Value:
        if isinstance(event, yaml.ScalarEvent):
            return scalar(event)
        if not isinstance(event, yaml.SequenceStartEvent):
            raise self.refusal(event, "anchors and aliases are not supported")
        items: list[Scalar] = []
        for item in events:
            if isinstance(item, yaml.SequenceEndEvent):
                break
            if not isinstance(item, yaml.ScalarEvent):
                raise self.refusal(item, "a list holds plain values only")
            items.append(scalar(item))
        return tuple(items)

    def pairs(self, events: Iterator[Any]) -> Iterator[tuple[Any, Any]]:
        while (key := self.next_key(events)) is not None:
            yield key, next(events)

    def next_key(self, events: Iterator[Any]) -> Any:
        """The next key of a mapping, None at its end."""
        event = next(events)
        if isinstance(event, yaml.MappingEndEvent):
            return None
        if not isinstance(event, yaml.ScalarEvent):
            raise self.refusal(event, "a name must be plain text")
        return event

    def expect_mapping(self, event: Any, events: Iterator[Any], what: str) -> None:
        self.add(errors.SYNTAX, event, f"{what} must be a mapping")
        self.skip(event, events)

    def skip(self, event: Any, events: Iterator[Any]) -> None:
        """Skips the value that begins with `event`."""
        depth = 0
        while True:
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if depth == 0:
                return
            if depth > MAX_DEPTH:
                raise self.refusal(event, TOO_DEEP)
            event = next(events)

    def place(self, event: Any) -> Place:
        return Place(self.file, event.start_mark.line + 1, event.start_mark.column + 1)

    def add(self, error_id: int, event: Any, text: str) -> None:
        self.problems.append(Problem(error_id, self.place(event), text))

    def refusal(self, event: Any, text: str) -> Refused:
        return Refused(Problem(errors.SYNTAX, self.place(event), text))


def is_null(event: Any) -> bool:
    return isinstance(event, yaml.ScalarEvent) and not event.style and event.value in NULLS


def scalar(event: Any) -> Scalar:
    """Value of a scalar. Only decimal and 0x numbers are numbers: 010, 1_000, 1:30 stay text and are refused later."""
    text: str = event.value
    if event.style in ("'", '"', "|", ">"):
        return text
    if text in NULLS:
        return None
    if text.lower() in BOOLEANS:
        return BOOLEANS[text.lower()]
    if INTEGER.fullmatch(text):
        return integer(text)
    if NUMBER.fullmatch(text):
        return float(text.lower().replace(".inf", "inf").replace(".nan", "nan"))
    return text


def integer(text: str) -> Scalar:
    digits = text.lstrip("+-")
    octal = len(digits) > 1 and digits.startswith("0") and not digits.startswith("0x")
    return text if octal or len(digits) > 1000 else int(text, 16 if digits.startswith("0x") else 10)
