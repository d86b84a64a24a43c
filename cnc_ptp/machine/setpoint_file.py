"""Files of external setpoints: CSV with the columns cycle, position, velocity, acceleration, direction."""

from __future__ import annotations

import csv
from collections.abc import Sequence

from cnc_ptp.axis.external import Setpoint
from cnc_ptp.errors import CncError

BAD_SETPOINT_FILE = 25102
COLUMNS = Setpoint._fields

Row = list[float]
"""One setpoint, in the order of COLUMNS."""


def parse_setpoints(text: str, file: str) -> list[Row]:
    """The rows of a file; mm, mm/s, mm/s² (deg). The columns stand in the first line, in any order; others are ignored.

    Raises CncError 25102 with file, line and value.
    """
    lines = csv.reader(text.splitlines(), skipinitialspace=True)
    header = [name.strip() for name in next(lines, [])]
    missing = [name for name in COLUMNS if name not in header]
    if missing:
        raise _fault(file, 1, f"column '{missing[0]}' is missing; the first line must name {', '.join(COLUMNS)}")
    places = [header.index(name) for name in COLUMNS]
    rows: list[Row] = []
    for line in lines:
        if not any(map(str.strip, line)):
            continue
        row = _row(line, places, file, lines.line_num)
        if rows and row[0] <= rows[-1][0]:
            reason = f"cycle {row[0]:g} comes after cycle {rows[-1][0]:g}; cycles must ascend"
            raise _fault(file, lines.line_num, reason)
        rows.append(row)
    return rows


def _row(line: Sequence[str], places: Sequence[int], file: str, number: int) -> Row:
    if len(line) <= max(places):
        raise _fault(file, number, f"{len(line)} values instead of {max(places) + 1}")
    try:
        cycle, *values, direction = (line[place] for place in places)
        return [int(cycle), *map(float, values), int(direction)]
    except ValueError as error:
        raise _fault(file, number, f"{error}") from None


def _fault(file: str, line: int, reason: str) -> CncError:
    return CncError(BAD_SETPOINT_FILE, f"setpoint file {file}:{line}: {reason}; nothing was started")


def placed(rows: Sequence[Row], cycle: int) -> list[Row]:
    """The rows of a file whose command acts at `cycle`: where they begin before it, they count from it on."""
    shift = cycle if rows and rows[0][0] < cycle else 0
    return [[row[0] + shift, *row[1:]] for row in rows]
