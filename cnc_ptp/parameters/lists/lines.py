"""The text of a list as lines: `getriebe[0].kv 1000 # remark`, comments, sections `beg NAME` … `end`.

A line is a name, a value, and behind it anything as a remark. What stands between `beg NAME` and `end` has NAME before
its own name. (Sections are not printed in the manuals; this is how they are read here.)
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final, NamedTuple

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.errors import Place
from cnc_ptp.parameters.lists.problems import ListProblem

_WORD = r"[A-Za-z_]\w*(?:\[[^\]\s#]*\])*"
_NAME: Final = re.compile(rf"({_WORD}(?:\.{_WORD})*)(?=\s|#|$)", re.ASCII)
_SECTION: Final = re.compile(rf"(beg|begin|end)(?:\s+({_WORD}(?:\.{_WORD})*))?\s*(?:#(.*))?$", re.ASCII | re.IGNORECASE)
_COMMENT: Final = re.compile(r"[#(;]")
_ORNAMENT: Final = re.compile(r"[:.*=_+/<>~\-\s]+")

MAX_DEPTH: Final = 20


class Line(NamedTuple):
    """One line. A comment has no `name`; neither has one that is not understood, which has a `rest`."""

    place: Place
    text: str
    """The line without blanks around it."""
    name: str = ""
    """With the names of the sections around it."""
    rest: str = ""
    """What stands behind the name."""
    column: int = 0
    """Where `rest` begins."""
    comment: str | None = None

    @property
    def is_blank(self) -> bool:
        return not self.text

    @property
    def value_place(self) -> Place:
        return self.place._replace(column=self.column)

    @property
    def kept(self) -> str:
        """As it is kept when nobody understands it: its whole name, so that it means the same without its section."""
        return f"{self.name} {self.rest}".strip() if self.name else self.text


def comment_text(comment: str) -> str:
    """Without its # and one blank behind it."""
    return comment.strip().removeprefix("#").removeprefix(" ").rstrip()


def titled(section: str) -> str:
    return f"section {section}" if section else "the section"


class LineReader:
    """Reads the lines of one list; what is wrong with its sections goes to `problems`."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.sections: list[tuple[str, Place]] = []
        self.problems: list[ListProblem] = []

    def read(self, lines: list[str]) -> Iterator[Line]:
        for number, line in enumerate(lines, 1):
            text = line.strip()
            place = Place(self.file, number, len(line) - len(line.lstrip()) + 1)
            if section := _SECTION.match(text):
                self.section(section, place, text)
                if section[3]:
                    yield Line(place, text, comment=comment_text(section[3]))
            else:
                yield self.line(place, text)
        for name, place in self.sections:
            self.add(place, f"{titled(name)} has no end; write `end` behind its last line")

    def section(self, found: re.Match[str], place: Place, text: str) -> None:
        """Begins or ends a section."""
        name = found[2] or ""
        if found[1].lower() != "end":
            if len(self.sections) == MAX_DEPTH:
                self.add(place, f"sections are nested deeper than {MAX_DEPTH} levels; write whole names", text)
            self.sections.append((name if len(self.sections) < MAX_DEPTH else "", place))
        elif not self.sections:
            self.add(place, "`end` without `beg`; delete it, or write `beg NAME` before the first line", text)
        elif name and name != self.sections[-1][0]:
            begun, where = self.sections[-1]
            self.add(place, f"`end` of {name}, but {titled(begun)} of line {where.line} is open; end that first", text)
        else:
            self.sections.pop()

    def line(self, place: Place, text: str) -> Line:
        if not text or _COMMENT.match(text) or _ORNAMENT.fullmatch(text):
            return Line(place, text, comment=comment_text(text))
        found = _NAME.match(text)
        if found is None:
            return Line(place, text, rest=text, column=place.column)
        rest = text[found.end() :].lstrip()
        prefix = "".join(f"{name}." for name, _ in self.sections if name)
        return Line(place, text, prefix + found[1], rest, place.column + len(text) - len(rest))

    def add(self, place: Place, text: str, line: str = "") -> None:
        self.problems.append(ListProblem(errors.LIST_LINE, place, text, line))
