"""What an import did with each line."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final, NamedTuple

from cnc_ptp.parameters.errors import Place

READ: Final = "read"
CORRECTED: Final = "corrected"
UNKNOWN: Final = "unknown"
DEFAULTED: Final = "default"
NOTICE: Final = "notice"
IGNORED: Final = "not read"
IN_FULL_ONLY: Final = (READ, DEFAULTED)
"""What is only counted unless a full report is asked for."""


class Note(NamedTuple):
    """What became of a line; `kind` is one of the words above."""

    kind: str
    place: Place
    text: str

    def __str__(self) -> str:
        return f"{self.place}: {self.kind}: {self.text}"


class ListCount(NamedTuple):
    """A list with the node that it is for, and its numbers of notes by kind."""

    file: str
    title: str
    node: str
    encoding: str


@dataclass
class Report:
    """The lists of an import, and notes in the order of lists and lines."""

    lists: list[ListCount] = field(default_factory=list)
    notes: list[Note] = field(default_factory=list)

    def add(self, kind: str, place: Place, text: str) -> None:
        self.notes.append(Note(kind, place, text))

    def of(self, kind: str) -> list[Note]:
        return [note for note in self.notes if note.kind == kind]

    def lines(self, *, full: bool = False) -> Iterator[str]:
        """A line for each list, one for each note, and a sum; read lines and defaults one by one only if `full`."""
        counts: dict[tuple[str, str], int] = {}
        for note in self.notes:
            counts[note.place.file, note.kind] = counts.get((note.place.file, note.kind), 0) + 1
        for entry in self.lists:
            numbers = ", ".join(
                f"{counts[entry.file, kind]} {word}" for kind, word in WORDS.items() if (entry.file, kind) in counts
            )
            encoding = f", in {entry.encoding}" if entry.encoding else ""
            yield f"{entry.file}: {entry.title} of /{entry.node}{encoding}: {numbers or 'empty'}"
        for note in sorted(self.notes, key=lambda note: (note.place.file, note.kind == DEFAULTED, note.place)):
            if full or note.kind not in IN_FULL_ONLY:
                yield str(note)
        yield self.summary

    @property
    def summary(self) -> str:
        numbers = ", ".join(f"{len(self.of(kind))} {word}" for kind, word in WORDS.items())
        return f"{len(self.lists)} lists: {numbers}"


WORDS: Final = {
    READ: "lines read",
    CORRECTED: "corrected",
    UNKNOWN: "unknown",
    DEFAULTED: "defaults",
    NOTICE: "notices",
}
