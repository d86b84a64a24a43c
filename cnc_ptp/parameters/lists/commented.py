"""A machine file with its comments: sections of values, comments and marks in the order of the file.

The places of YAML's events say where each line of the file has its last value; a # behind that begins a comment.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Final, NamedTuple

import yaml

from cnc_ptp.parameters.errors import ParameterError
from cnc_ptp.parameters.lists.lines import comment_text
from cnc_ptp.parameters.read.source import Reader, Value, read_events

_COMMENT: Final = re.compile(r"[\s,:\[\]{}?-]*(#.*)")


class Item(NamedTuple):
    """A value with the comment behind it, or a whole line: `name` is empty for a comment (its # is in `comment`).

    `raw`: a value as it is written.
    """

    line: int
    name: str = ""
    raw: str = ""
    comment: str = ""

    @property
    def is_blank(self) -> bool:
        return not self.name and not self.comment


@dataclass
class CommentedSection:
    """The items of a node's section; `line`: that of its name."""

    node: str
    line: int
    items: list[Item] = field(default_factory=list)


class CommentReader(Reader):
    """Reads a machine file and notes where its values are."""

    def __init__(self, file: str) -> None:
        super().__init__(file)
        self.ends: dict[int, int] = {}
        """The column behind the last value of each line, lines from 0."""
        self.raw: dict[tuple[int, int], str] = {}
        """Plain numbers and words as they are written, by line and column from 1."""

    def without_tags(self, events: Iterator[Any]) -> Iterator[Any]:
        for event in super().without_tags(events):
            start, end = event.start_mark, event.end_mark
            for mark in (start, end):
                self.ends[mark.line] = max(self.ends.get(mark.line, 0), mark.column)
            for line in range(start.line, end.line):
                self.ends[line] = 1 << 30  # inside a text of several lines nothing is a comment
            yield event

    def value(self, event: Any, events: Iterator[Any]) -> Value:
        if isinstance(event, yaml.ScalarEvent) and not event.style:
            place = self.place(event)
            self.raw[place.line, place.column] = event.value
        return super().value(event, events)


def read_commented(text: str, file: str) -> list[CommentedSection]:
    """The sections of a machine file. Raises ParameterError for what is no machine file."""
    reader = CommentReader(file)
    read_events(reader, text)
    if reader.problems:
        raise ParameterError(reader.problems)
    sections = [CommentedSection(section.node, section.place.line) for section in reader.sections]
    comments = dict(comments_of(text, reader.ends))
    for section, read in zip(sections, reader.sections, strict=True):
        for entry in sorted(read.entries, key=lambda entry: entry.place):
            raw = reader.raw.get((entry.place.line, entry.place.column), "")
            section.items.append(Item(entry.place.line, entry.name, raw))
    for section in sections:
        give_comments(section, comments)
    place_lines(sections, comments)
    return sections


def comments_of(text: str, ends: dict[int, int]) -> Iterator[tuple[int, str]]:
    """The comments by line, each with its #, and blank lines as empty ones; lines from 1."""
    for number, line in enumerate(re.split(r"\r\n|[\n\r\x85\u2028\u2029]", text)):
        rest = line[ends.get(number, 0) :]
        if found := _COMMENT.fullmatch(rest):
            yield number + 1, found[1].rstrip()
        elif not line.strip():
            yield number + 1, ""


def give_comments(section: CommentedSection, comments: dict[int, str]) -> None:
    """Gives each comment to the last value of its line; it is none of its own then."""
    for index in reversed(range(len(section.items))):
        item = section.items[index]
        if comments.get(item.line):
            section.items[index] = item._replace(comment=comment_text(comments.pop(item.line)))


def place_lines(sections: list[CommentedSection], comments: dict[int, str]) -> None:
    """Puts whole lines of comment among the values; one that stands directly above a section belongs to it."""
    begins = [begin_of(section, comments) for section in sections]
    for line, comment in comments.items():
        owner = max((index for index, begin in enumerate(begins) if begin <= line), default=0)
        if sections:
            sections[owner].items.append(Item(line, comment=comment))
    for section in sections:
        section.items.sort(key=lambda item: item.line)


def begin_of(section: CommentedSection, comments: dict[int, str]) -> int:
    line = section.line
    while comments.get(line - 1):
        line -= 1
    return line
