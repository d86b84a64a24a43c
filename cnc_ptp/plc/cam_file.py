"""Files of cam tables: CSV with the columns master, slave."""

from __future__ import annotations

from math import isfinite

from cnc_ptp.axis.cam import ASCEND, SMALLEST_STEP, CamTable
from cnc_ptp.errors import CncError
from cnc_ptp.plc.csv_table import table_lines

BAD_CAM_FILE = 25103
COLUMNS = ("master", "slave")


def parse_cam(text: str, file: str) -> list[list[float]]:
    """The points of a file, mm (deg). Raises CncError 25103 with file, line and value."""

    def fault(line: int, reason: str) -> CncError:
        return CncError(BAD_CAM_FILE, reason, "nothing was started", where=f"cam file {file}:{line}", line=line)

    points: list[list[float]] = []
    number = 1
    for number, values in table_lines(text, COLUMNS, fault):
        try:
            points.append([float(value) for value in values])
        except ValueError:
            raise fault(number, f"'{values[0]}, {values[1]}' are not two numbers") from None
        if not all(map(isfinite, points[-1])):
            raise fault(number, f"'{values[0]}, {values[1]}' are not two finite numbers")
        if len(points) > 1 and points[-1][0] - points[-2][0] < SMALLEST_STEP:
            reason = f"master position {points[-1][0]:g} comes after {points[-2][0]:g}; {ASCEND}"
            raise fault(number, reason)
    try:
        CamTable(points, cyclic=False)
    except CncError as error:
        raise fault(number, error.reason) from None
    return points
