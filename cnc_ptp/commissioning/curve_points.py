"""Interpolation points of an acceleration curve, as the data sheet of a motor or a measurement gives them.

The point at the limit speed is n_grenz and a_konst themselves; b1 … b3 follow from those above it (TF5200 spindle
2.8.4.1).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from itertools import pairwise
from math import isclose
from typing import NamedTuple

from cnc_ptp.commissioning.faults import (
    BAD_CURVE_FILE,
    BAD_CURVE_POINT,
    BAD_CURVE_RANGE,
    NO_LIMIT_POINT,
    NOT_ASCENDING,
    TOO_FEW_POINTS,
)
from cnc_ptp.errors import CncError
from cnc_ptp.plc.csv_table import Fault, table_lines, table_names

SPEED_UNITS: Mapping[str, float] = {"deg/s": 1.0, "rpm": 6.0}
"""°/s."""
SPEED_COLUMNS = {"deg/s": "speed_deg_s", "rpm": "speed_rpm"}
ACCELERATION_COLUMN = "acceleration_deg_s2"
LARGEST_SPEED, LARGEST_ACCELERATION = 2e6, 1e8
"""°/s (P-AXIS-00212), °/s² (P-AXIS-00008)."""
STEPS_PER_DEG_S = 1000
"""P-AXIS-00130 counts 0.001 °/s."""
SAME = 1e-9
"""Relative; a speed in rpm is the same in °/s up to this."""
NEEDED_ABOVE = {"polynomial": 3, "hyperbola": 2}
"""Points above the limit speed that determine the curve; with more of them it is a least squares fit."""


class CurvePoint(NamedTuple):
    """°/s, °/s²."""

    speed: float
    acceleration: float

    def __str__(self) -> str:
        return f"{self.speed:g}:{self.acceleration:g}"


def parse_point(text: str, unit: str) -> CurvePoint:
    """A point "SPEED:ACCELERATION" with the speed in `unit`. Raises CncError 27041."""
    speed, _, acceleration = text.partition(":")
    try:
        return _point(speed, acceleration, unit, "it is not SPEED:ACCELERATION, two numbers")
    except ValueError as error:
        raise CncError(BAD_CURVE_POINT, f"point '{text}': {error}", "nothing was fitted") from None


def parse_point_file(text: str, file: str) -> list[CurvePoint]:
    """The points of a CSV file, whose first line names acceleration_deg_s2 and speed_deg_s or speed_rpm.

    Raises CncError 27042 and 27043 with file and line.
    """
    fault = partial(_file_fault, file)
    unit = _speed_unit(table_names(text, fault), fault)
    points: list[CurvePoint] = []
    for line, (speed, acceleration) in table_lines(text, (SPEED_COLUMNS[unit], ACCELERATION_COLUMN), fault):
        reason = f"{SPEED_COLUMNS[unit]} '{speed}' and {ACCELERATION_COLUMN} '{acceleration}' are not two numbers"
        try:
            points.append(_point(speed, acceleration, unit, reason))
        except ValueError as error:
            raise fault(line, f"{error}") from None
        _require_ascending(points[-2:], f"point file {file}:{line}: ")
    return points


def _speed_unit(names: Sequence[str], fault: Fault) -> str:
    """Of the column that the first line names. Raises what `fault` makes."""
    units = [unit for unit, column in SPEED_COLUMNS.items() for name in names if name == column]
    if len(units) != 1 or names.count(ACCELERATION_COLUMN) != 1:
        wanted = f"{ACCELERATION_COLUMN} and one of {', '.join(SPEED_COLUMNS.values())}"
        raise fault(1, f"the first line must name {wanted}, separated by commas; it is '{', '.join(names):.100}'")
    return units[0]


def _point(speed: str, acceleration: str, unit: str, no_numbers: str) -> CurvePoint:
    """Raises ValueError unless it is a point, with the text `no_numbers` unless both are numbers."""
    try:
        given, point_acceleration = float(speed), float(acceleration)
    except ValueError:
        raise ValueError(no_numbers) from None
    point = CurvePoint(given * SPEED_UNITS[unit], point_acceleration)
    if not 0.0 <= point.speed <= LARGEST_SPEED:
        raise ValueError(f"speed {given:g} {unit} is not within 0 ... {LARGEST_SPEED / SPEED_UNITS[unit]:g} {unit}")
    if not 0.0 < point.acceleration <= LARGEST_ACCELERATION:
        raise ValueError(f"acceleration {point_acceleration:g} °/s² is not above 0 and up to {LARGEST_ACCELERATION:g}")
    return point


def _require_ascending(points: Sequence[CurvePoint], where: str = "") -> None:
    """Raises CncError 27043 unless the speeds ascend."""
    for before, point in pairwise(points):
        if not point.speed > before.speed:
            reason = f"{where}point {point} comes after {before} (°/s:°/s²), speeds must ascend"
            raise CncError(NOT_ASCENDING, reason, "nothing was fitted")


def _file_fault(file: str, line: int, reason: str) -> CncError:
    return CncError(BAD_CURVE_FILE, f"point file {file}:{line}: {reason}", "nothing was fitted")


def limit_index(points: Sequence[CurvePoint], kind: str, limit_speed: float | None) -> int:
    """Index of the point at the limit of the constant range: the one at `limit_speed` (°/s), else the first.

    Raises CncError 27043 unless the speeds ascend, 27045 without a point at the limit, 27044 with too few above it.
    """
    _require_ascending(points)
    index = _limit_place([point.speed for point in points], limit_speed) if points else 0
    above, needed = max(len(points) - index - 1, 0), NEEDED_ABOVE[kind]
    if above < needed:
        reason = f"the {kind} needs a point at the limit speed and {needed} above it, {above} above it given"
        raise CncError(TOO_FEW_POINTS, reason, "nothing was fitted")
    return index


def _limit_place(speeds: Sequence[float], limit_speed: float | None) -> int:
    wanted = speeds[0] if limit_speed is None else limit_speed
    places = [place for place, speed in enumerate(speeds) if isclose(speed, wanted, rel_tol=SAME)]
    if not places:
        known = ", ".join(f"{speed:g}" for speed in speeds)
        reason = f"no point lies at the limit speed {wanted:g} °/s, which gives a_konst (P-AXIS-00007)"
        raise CncError(NO_LIMIT_POINT, reason, f"nothing was fitted. Points at {known} °/s")
    if round(wanted * STEPS_PER_DEG_S) == 0:
        reason = f"the limit speed {wanted:g} °/s (P-AXIS-00130) must be above 0"
        raise CncError(NO_LIMIT_POINT, reason, "nothing was fitted. It is the first point, or --limit")
    return places[0]


def storable(limit: CurvePoint) -> CurvePoint:
    """The limit point as P-AXIS-00130 and 00007 hold it: whole 0.001 °/s and °/s². Raises CncError 27046."""
    point = CurvePoint(round(limit.speed * STEPS_PER_DEG_S) / STEPS_PER_DEG_S, float(round(limit.acceleration)))
    if point.acceleration == 0.0:
        reason = f"a_konst {limit.acceleration:g} °/s² is 0 in whole °/s² (P-AXIS-00007)"
        raise CncError(BAD_CURVE_RANGE, reason, "nothing was fitted")
    return point
