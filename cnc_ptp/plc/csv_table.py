"""Tables in CSV files: the columns are named in the first line, in any order; others are ignored."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from cnc_ptp.errors import CncError

BYTE_ORDER_MARK = "\ufeff"

Fault = Callable[[int, str], CncError]
"""Makes the error of a table from line and reason."""


def table_lines(text: str, columns: Sequence[str], fault: Fault) -> Iterator[tuple[int, list[str]]]:
    """Number and values, in the order of `columns`, of each line that is not empty. Raises what `fault` makes."""
    lines = _reader(text)
    try:
        places = _places(next(lines, []), columns, fault)
        for line in lines:
            if any(map(str.strip, line)):
                if len(line) <= max(places):
                    shown = ",".join(line)
                    raise fault(lines.line_num, f"'{shown}' has {len(line)} values instead of {max(places) + 1}")
                yield lines.line_num, [line[place] for place in places]
    except csv.Error as error:
        raise fault(lines.line_num, f"{error}") from None


def table_names(text: str, fault: Fault) -> list[str]:
    """The columns that the first line names. Raises what `fault` makes."""
    try:
        return _names(next(_reader(text), []))
    except csv.Error as error:
        raise fault(1, f"{error}") from None


def _reader(text: str) -> Any:
    return csv.reader(text.removeprefix(BYTE_ORDER_MARK).splitlines(), skipinitialspace=True)


def _names(header: Sequence[str]) -> list[str]:
    return [name.strip() for name in header]


def _places(header: Sequence[str], columns: Sequence[str], fault: Fault) -> list[int]:
    """Index of each column in a line."""
    names = _names(header)
    for column in columns:
        if names.count(column) != 1:
            what = "occurs twice" if column in names else "is missing"
            raise fault(1, f"column '{column}' {what}; the first line must name {', '.join(columns)}")
    return [names.index(column) for column in columns]
