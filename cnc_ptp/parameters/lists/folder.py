"""The lists of a folder, each with its kind: by the start-up list, by an option, by its name, by what is in it."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Final, NamedTuple

from cnc_ptp.errors import did_you_mean, nearest
from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import catalogue
from cnc_ptp.parameters.errors import Place
from cnc_ptp.parameters.lists.kinds import COUNTS, ENTRIES, STARTUP, WORDS, Kind, by_file_name, kind_of
from cnc_ptp.parameters.lists.lines import Line, LineReader
from cnc_ptp.parameters.lists.names import look_up
from cnc_ptp.parameters.lists.problems import ListProblem
from cnc_ptp.parameters.lists.report import IGNORED, Report
from cnc_ptp.parameters.lists.text import Unreadable, decoded, foreign_characters, split_lines
from cnc_ptp.parameters.lists.values import BadLine, split_value, unquoted

SUFFIX: Final = ".lis"
_ENTRY: Final = re.compile(r"(\w+)(?:\[(\d{0,9})\])?", re.ASCII)


class ListFile(NamedTuple):
    """A list. `hint`: what its name says of its unit; `number`: its index in the start-up list, or that of its name."""

    name: str
    kind: Kind
    lines: tuple[Line, ...]
    path: str
    hint: str = ""
    number: int | None = None
    encoding: str = ""

    @property
    def place(self) -> Place:
        return Place(self.path, 1, 1)


class Named(NamedTuple):
    """A file that the start-up list names."""

    file: str
    kind: Kind
    number: int
    line: Line


class Folder:
    """Reads the files of a folder by name; what is wrong goes to `problems`."""

    def __init__(self, folder: str, files: Mapping[str, bytes], chosen: Mapping[str, Kind], report: Report) -> None:
        self.folder, self.files, self.chosen, self.report = folder, files, chosen, report
        self.problems: list[ListProblem] = []
        self.lines: dict[str, tuple[Line, ...]] = {}
        self.encodings: dict[str, str] = {}
        self.startup: ListFile | None = None
        self.named: dict[str, Named] = {}

    def read(self) -> list[ListFile]:
        """The lists except the start-up list."""
        own = sorted(name for name in self.files if name.lower().endswith(SUFFIX) or name in self.chosen)
        self.require_chosen()
        self.find_startup(own)
        names = [name for name in dict.fromkeys([*own, *self.named]) if not self.is_startup(name)]
        if not names and not self.problems:
            text = f"no list is here (a file *{SUFFIX})"
            self.add(errors.LIST_FOLDER, Place(self.folder, 1, 1), f"{text}; name the folder with the lists")
        for name in sorted(self.files.keys() - {*own, *self.named}):
            self.report.add(IGNORED, self.place(name), f"no list, its name does not end in {SUFFIX}")
        found = [entry for name in names if (entry := self.list_of(name)) is not None]
        return sorted(found, key=lambda entry: (entry.number is None, entry.number or 0, entry.name))

    def require_chosen(self) -> None:
        for name in self.chosen:
            if name not in self.files:
                close = did_you_mean(nearest(name, self.files))
                self.add(errors.UNREADABLE, Place(self.folder, 1, 1), f"--as: the folder has no file {name}{close}")

    def is_startup(self, name: str) -> bool:
        return self.startup is not None and self.startup.name == name

    def place(self, name: str, line: int = 1) -> Place:
        return Place(self.path(name), line, 1)

    def path(self, name: str) -> str:
        return f"{self.folder}/{name}" if self.folder not in ("", ".") else name

    def add(self, error_id: int, place: Place, text: str, line: str = "") -> None:
        self.problems.append(ListProblem(error_id, place, text, line))

    def lines_of(self, name: str) -> tuple[Line, ...]:
        """The lines of a file; none, and a problem, if it is no text."""
        if name in self.lines:
            return self.lines[name]
        self.lines[name] = ()
        try:
            text, self.encodings[name] = decoded(self.files[name])
        except Unreadable as reason:
            self.add(errors.LIST_TEXT, self.place(name), f"the list cannot be read, {reason}")
            return ()
        lines = split_lines(text)
        foreign = list(foreign_characters(lines, self.path(name)))
        self.problems += foreign
        if not foreign:
            reader = LineReader(self.path(name))
            self.lines[name] = tuple(reader.read(lines))
            self.problems += reader.problems
        return self.lines[name]

    def find_startup(self, names: list[str]) -> None:
        """The start-up list, if there is one, and the files that it names."""
        wanted = [name for name in names if self.said_kind(name) is STARTUP]
        if not wanted:
            unsaid = [name for name in names if self.said_kind(name) is None]
            wanted = [name for name in unsaid if best(counts(self.lines_of(name))) is STARTUP]
        for name in wanted[1:]:
            text = f"{wanted[0]} is a start-up list, too; a folder has one, delete or rename the other"
            self.add(errors.LIST_KIND, self.place(name), text)
        if wanted:
            name = wanted[0]
            lines = self.lines_of(name)
            self.startup = ListFile(name, STARTUP, lines, self.path(name), encoding=self.encodings.get(name, ""))
            for line in lines:
                self.read_entry(line)

    def read_entry(self, line: Line) -> None:
        """A line of the start-up list, if it names a file."""
        found = entry_of(line)
        if found is None:
            return
        kind, number = found
        try:
            path = unquoted(split_value(catalogue().by_id[ids.WERKZ_DATA], line.rest).value)
        except BadLine as reason:
            self.add(errors.LIST_LINE, line.value_place, f"{line.name}: {reason}", line.text)
            return
        name = path.replace("\\", "/").rpartition("/")[2]
        known = {file.lower(): file for file in self.files}
        file = name if name in self.files else known.get(name.lower(), "")
        if not file:
            text = f"{line.name}: file {name} is not in {self.folder}{did_you_mean(nearest(name, self.files))}"
            remedy = "copy it there, or delete the line"
            self.add(errors.UNREADABLE, line.value_place, f"{text}; {remedy}", line.text)
        elif file in self.named:
            before = self.named[file].line.place.line
            text = f"{line.name}: file {file} is named twice, first in line {before}; delete one of the lines"
            self.add(errors.DUPLICATE_KEY, line.value_place, text, line.text)
        else:
            self.named[file] = Named(file, kind, number, line)

    def said_kind(self, name: str) -> Kind | None:
        """The kind that an option, the start-up list or the name says."""
        if name in self.chosen:
            return self.chosen[name]
        return self.named[name].kind if name in self.named else by_file_name(name)[0]

    def list_of(self, name: str) -> ListFile | None:
        """A list with its kind; None, with a problem or a note, if it is none or not meant."""
        lines = self.lines_of(name)
        said, seen = self.said_kind(name), counts(lines)
        kind = said or best(seen)
        if kind is None:
            if lines:
                text = "neither its name nor its parameters tell what list it is; add it to the start-up list"
                self.add(errors.LIST_KIND, self.place(name), f"{text} or say it with --as {name}=axis")
            return None
        if name not in self.named and name not in self.chosen and kind in {entry.kind for entry in self.named.values()}:
            assert self.startup is not None
            self.report.add(IGNORED, self.place(name), f"{self.startup.name} names the {kind.title}s, but not this one")
            return None
        if self.is_wrong(name, kind, lines, seen):
            return None
        number = self.named[name].number if name in self.named else None
        hint = by_file_name(name)[1]
        return ListFile(name, kind, lines, self.path(name), hint, number, self.encodings.get(name, ""))

    def is_wrong(self, name: str, kind: Kind, lines: tuple[Line, ...], seen: Counter[str]) -> bool:
        """Whether a list looks like another kind; that is a problem."""
        other = best(seen)
        if other is None or other is kind or (seen[kind.name] and other.node == kind.node):
            return False
        named = [line for line in lines if line.name and not is_header(line)]
        if seen[other.name] * 2 <= len(named):
            return False
        line = next(line for line in lines if kinds_of(line) == {other.name})
        word = next(word for word, entry in WORDS.items() if entry is other)
        remedy = f"put it in the start-up list under {other.entry}" if other.entry else "rename it to hochlauf.lis"
        wanted, found = article(kind.title), article(other.title)
        text = (
            f"this should be {wanted}, but looks like {found}: {seen[other.name]} of its "
            f"{len(named)} lines are of that; {remedy} or say --as {name}={word}"
        )
        self.add(errors.LIST_KIND, line.place, text, line.text)
        return True


def article(title: str) -> str:
    return f"{'an' if title[0] in 'aeiou' else 'a'} {title}"


def entry_of(line: Line) -> tuple[Kind, int] | None:
    """Kind and index of a line of the start-up list that names a file."""
    found = _ENTRY.fullmatch(line.name)
    kind = ENTRIES.get(catalogue().aliases.get(found[1], found[1])) if found else None
    return (kind, int(found[2] or 0)) if found and kind else None


def is_count(line: Line) -> bool:
    """Whether a line of the start-up list counts the files of a kind."""
    return line.name in COUNTS


def counts(lines: Iterable[Line]) -> Counter[str]:
    """How many lines are of which kind of list; those that may be of several count for none."""
    found: Counter[str] = Counter()
    for line in lines:
        if len(kinds := kinds_of(line)) == 1:
            found.update(kinds)
    return found


def is_header(line: Line) -> bool:
    """Whether a line has the axis number, which lists of several kinds have."""
    return line.name.rpartition(".")[2] == "achs_nr"


def kinds_of(line: Line) -> set[str]:
    """The kinds of lists that a line may be of."""
    if not line.name or is_header(line):
        return set()
    if entry_of(line) or is_count(line):
        return {STARTUP.name}
    pattern = re.sub(r"\[[^\]]*\]", "[]", line.name)
    matches = [look_up(node, pattern) for node in ("axis", "channel", "machine")]
    found = [match.declaration for match in matches if match.declaration is not None]
    return {kind_of(entry).name for entry in found}


def best(seen: Counter[str]) -> Kind | None:
    """The kind of most lines; None without any."""
    return next((kind for kind in WORDS.values() for name, _ in seen.most_common(1) if kind.name == name), None)
