"""Tables on the terminal, one line a row."""

from __future__ import annotations

from collections.abc import Iterator, Sequence


def table_lines(headings: Sequence[str], rows: Sequence[Sequence[str]], width: int) -> Iterator[str]:
    """One line per row, at most `width` characters long: the last column is cut to the rest."""
    lines = [headings, *rows]
    widths = [max(len(line[column]) for line in lines) for column in range(len(headings) - 1)]
    for line in lines:
        text = "  ".join([*(cell.ljust(size) for cell, size in zip(line, widths, strict=False)), line[-1]]).rstrip()
        yield text if len(text) <= width else text[: width - 1] + "…"
