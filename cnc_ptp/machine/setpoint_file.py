"""Files of external setpoints: CSV with the columns cycle, position, velocity, acceleration, direction."""

from __future__ import annotations

import csv
from collections.abc import Sequence

from cnc_ptp.axis.external import Setpoint, read_setpoint
from cnc_ptp.errors import CncError

BAD_SETPOINT_FILE = 25102
COLUMNS = Setpoint._fields
BYTE_ORDER_MARK = "\ufeff"

Row = list[float]
"""One setpoint, in the order of COLUMNS."""


def parse_setpoints(text: str, file: str) -> list[Row]:
    """The rows of a file; mm, mm/s, mm/s² (deg). The columns stand in the first line, in any order; others are ignored.

    Raises CncError 25102 with file, line and value.
    """
    lines = csv.reader(text.removeprefix(BYTE_ORDER_MARK).splitlines(), skipinitialspace=True)
    try:
        places = _places(next(lines, []), file)
        rows: list[Row] = []
        for line in lines:
            if any(map(str.strip, line)):
                rows.append(_row(line, places, rows, file, lines.line_num))
    except csv.Error as error:
        raise _fault(file, lines.line_num, f"{error}") from None
    if not rows:
        raise _fault(file, 1, "no setpoint follows the first line")
    return rows


def _places(header: Sequence[str], file: str) -> list[int]:
    """Where in a line the columns stand."""
    names = [name.strip() for name in header]
    for column in COLUMNS:
        if names.count(column) != 1:
            fault = "stands twice" if column in names else "is missing"
            reason = f"column '{column}' {fault}; the first line must name {', '.join(COLUMNS)}"
            raise _fault(file, 1, reason)
    return [names.index(column) for column in COLUMNS]


def _row(line: Sequence[str], places: Sequence[int], before: Sequence[Row], file: str, number: int) -> Row:
    if len(line) <= max(places):
        raise _fault(file, number, f"{len(line)} values instead of {max(places) + 1}")
    try:
        cycle, *values, direction = (line[place] for place in places)
        row = [int(cycle), *map(float, values), int(direction)]
        read_setpoint(row)
    except ValueError as error:
        raise _fault(file, number, f"{error}") from None
    if before and row[0] <= before[-1][0]:
        reason = f"cycle {row[0]} comes after cycle {before[-1][0]}; cycles must ascend"
        raise _fault(file, number, reason)
    return row


def _fault(file: str, line: int, reason: str) -> CncError:
    return CncError(BAD_SETPOINT_FILE, f"setpoint file {file}:{line}: {reason}; nothing was started")


def placed(rows: Sequence[Row], cycle: int) -> list[Row]:
    """The rows of a file whose command acts at `cycle`: where they begin before it, they count from it on."""
    shift = cycle if rows and rows[0][0] < cycle else 0
    return [[row[0] + shift, *row[1:]] for row in rows]
