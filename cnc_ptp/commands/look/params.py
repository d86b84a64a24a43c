"""`cnc_ptp params`: the parameter reference on the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from rich.console import Console

from cnc_ptp.parameters.declare.declarations import Declaration, catalogue
from cnc_ptp.parameters.declare.reference import HEADLINES, entry_text, find

PLAIN_WIDTH = 120
"""Characters of a line that goes to a file or a pipe."""
HINT = "cnc_ptp params WORD: part of a name or id (frict, P-AXIS), number (99), word (following)"


def params(wanted: str) -> int:
    """Prints the parameters found: one in full, several in one line each; without a word all groups.

    Raises CncError 25018 when nothing is found.
    """
    console = Console()
    width = console.width if console.is_terminal else PLAIN_WIDTH
    found = find(wanted) if wanted else []
    if len(found) == 1:
        print(entry_text(found[0]))
    elif found:
        print(*hit_lines(found, width), sep="\n")
    else:
        print(*group_lines(catalogue().by_id.values(), width), "", HINT, sep="\n")
    return 0


def hit_lines(found: Iterable[Declaration], width: int) -> Iterator[str]:
    """A line each: id, name, text."""
    rows = [(entry.id, entry.name, entry.text) for entry in found]
    return table_lines(("id", "name", "meaning"), rows, width)


def group_lines(declarations: Iterable[Declaration], width: int) -> Iterator[str]:
    """Lists and their sections, with the number of parameters and the first names of each."""
    groups: dict[tuple[str, str], list[Declaration]] = {}
    for entry in sorted(declarations, key=lambda entry: list(HEADLINES).index(entry.list_name)):
        groups.setdefault((entry.id.rpartition("-")[0], section_of(entry)), []).append(entry)
    rows = [
        (list_id, section, f"{len(entries):2}", ", ".join(entry.name.rpartition(".")[2] for entry in entries))
        for (list_id, section), entries in groups.items()
    ]
    return table_lines(("list", "section", "", "parameters"), rows, width)


def table_lines(headings: Sequence[str], rows: Sequence[Sequence[str]], width: int) -> Iterator[str]:
    """One line per row, at most `width` characters long: the last column is cut to the rest."""
    lines = [headings, *rows]
    widths = [max(len(line[column]) for line in lines) for column in range(len(headings) - 1)]
    for line in lines:
        text = "  ".join([*(cell.ljust(size) for cell, size in zip(line, widths, strict=False)), line[-1]])
        yield text if len(text) <= width else text[: width - 1] + "…"


def section_of(entry: Declaration) -> str:
    """First part of its name; empty for a name of one part."""
    first, point, _ = entry.name.partition(".")
    return first.partition("[")[0] if point else ""
