"""Files of external setpoints: CSV with the columns cycle, position, velocity, acceleration, direction."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from cnc_ptp.axis.external import Setpoint, read_setpoint, read_setpoints
from cnc_ptp.axis.external_commands import SETPOINTS
from cnc_ptp.errors import CncError
from cnc_ptp.plc.csv_table import table_lines
from cnc_ptp.protocol.commands import BAD_ARGUMENT

BAD_SETPOINT_FILE = 25102
COLUMNS = Setpoint._fields

SetpointRow = list[Any]
"""One setpoint, in the order of COLUMNS."""


def parse_setpoints(text: str, file: str) -> list[SetpointRow]:
    """The rows of a file; mm, mm/s, mm/s² (deg). The first line names the columns, in any order; others are ignored.

    Raises CncError 25102 with file, line and value.
    """
    rows: list[SetpointRow] = []
    for number, values in table_lines(text, COLUMNS, partial(_fault, file)):
        try:
            row = _row(values)
        except ValueError as error:
            raise _fault(file, number, f"{error}") from None
        if rows and row[0] <= rows[-1][0]:
            reason = f"cycle {row[0]} comes after cycle {rows[-1][0]}; cycles must ascend"
            raise _fault(file, number, reason)
        rows.append(row)
    if not rows:
        raise _fault(file, 1, "no setpoint follows the first line")
    return rows


def _row(values: Sequence[str]) -> SetpointRow:
    """Raises ValueError if the values are not a setpoint."""
    cycle, position, velocity, acceleration, direction = values
    row: SetpointRow = [int(cycle), float(position), float(velocity), float(acceleration), int(direction)]
    read_setpoint(row)
    return row


def _fault(file: str, line: int, reason: str) -> CncError:
    return CncError(BAD_SETPOINT_FILE, reason, "nothing was started", where=f"setpoint file {file}:{line}", line=line)


def check_setpoints(axis: str, rows: Sequence[object]) -> None:
    """Raises CncError 22001 for rows that are no series of setpoints."""
    try:
        read_setpoints(rows)
    except ValueError as error:
        where = f"axis {axis}: {SETPOINTS} refused"
        raise CncError(BAD_ARGUMENT, str(error), "nothing was changed", where=where) from None


def placed(rows: Sequence[SetpointRow], cycle: int) -> list[SetpointRow]:
    """The rows of a file whose command acts at `cycle`: if they start before it, they count from it."""
    shift = cycle if rows and rows[0][0] < cycle else 0
    return [[row[0] + shift, *row[1:]] for row in rows]
