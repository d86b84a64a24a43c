"""Rows of a recording over time, one above the other, each with its lines.

Reports and pictures draw the same rows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from cnc_ptp.recording.reader import AXIS_STATE, CHANNEL_STATE, SPINDLE_STATE, Recorded
from cnc_ptp.recording.units import unit_of
from cnc_ptp.wire.layout import Records

SET, ACTUAL, OTHER = "set", "actual", ""
USUAL = ("position", "velocity", "acceleration", "following error", "speed")
"""Titles of the rows that a picture shows by default."""

FEEDFORWARD = ("feedforward_velocity", "additive_velocity", "additive_torque")
"""Fields of the feedforward of an axis."""


@dataclass(frozen=True, slots=True)
class Line:
    """A field of a unit's states; `role`: set value, actual value, or something else; `colour`: "" that of its role."""

    name: str
    rows: Records
    field: str
    role: str = OTHER
    factor: float = 1.0
    colour: str = ""


@dataclass(frozen=True, slots=True)
class PlotRow:
    """One plot: of which unit (empty: of several), what, in which unit of measurement."""

    unit: str
    title: str
    measure: str
    lines: list[Line] = field(default_factory=list)
    legend: bool = False
    """The lines have names of their own."""

    @property
    def heading(self) -> str:
        """`X: position in mm`; rows of no unit have none before the colon."""
        text = f"{self.title} in {self.measure}" if self.measure else self.title
        return f"{self.unit}: {text}" if self.unit else text[:1].upper() + text[1:]


def axis_label(name: str) -> str:
    """As people write axes: `x` is X, longer names stay."""
    return name.upper() if len(name) == 1 else name


def moves(rows: Records) -> bool:
    """True for an axis or spindle whose position changes or that has a speed at any time."""
    names = rows.dtype.names or ()
    places = [name for name in ("set_position", "actual_position", "set_position_deg") if name in names]
    speeds = [name for name in ("set_velocity", "set_speed_rpm", "actual_speed_rpm") if name in names]
    return any(np.ptp(rows[name]) != 0.0 for name in places) or any(np.any(rows[name]) for name in speeds)


def standing(recorded: Recorded) -> list[str]:
    """Axes and spindles that never move."""
    units = {**recorded.of_type(SPINDLE_STATE), **recorded.of_type(AXIS_STATE)}
    return [name for name, rows in units.items() if not moves(rows)]


def time_rows(recorded: Recorded, units: Mapping[str, str], torque_units: Mapping[str, str]) -> Iterator[PlotRow]:
    """All rows with content: without axes and spindles that never move, without lines that are 0 throughout."""
    channels = recorded.of_type(CHANNEL_STATE)
    still = standing(recorded)
    axes = {name: rows for name, rows in recorded.of_type(AXIS_STATE).items() if name not in still}
    spindles = {name: rows for name, rows in recorded.of_type(SPINDLE_STATE).items() if name not in still}
    for name, rows in channels.items():
        feed = [Line("set", rows, "programmed_feed", SET, 60.0), Line("actual", rows, "path_velocity", ACTUAL, 60.0)]
        yield PlotRow(name, "feed", "mm/min", feed)
    yield from _shared_row("override", "override_percent", {**channels, **axes, **spindles})
    fed_forward = {name: rows for name, rows in {**axes, **spindles}.items() if _is_fed_forward(rows)}
    for row in _shared_row("feedforward weight", "feedforward_percent", fed_forward):
        yield from _used(row)
    for name, rows in channels.items():
        yield _row(name, "program line", [Line("line", rows, "line")])
    for name, rows in spindles.items():
        yield from _spindle_rows(name, rows)
    for name, rows in axes.items():
        yield from _axis_rows(name, rows, units.get(name, "mm"))
        yield from _control_rows(name, rows, units.get(name, "mm"), torque_units.get(name, "Nm or N"))


def _row(
    name: str, title: str, lines: list[Line], distance: str = "", torque: str = "", *, legend: bool = False
) -> PlotRow:
    """In the unit of measurement of its fields; `distance`: mm or deg, `torque`: Nm or N."""
    return PlotRow(name, title, unit_of(lines[0].field, distance, torque), lines, legend)


def _shared_row(title: str, field: str, units: Mapping[str, Records]) -> Iterator[PlotRow]:
    """One row with a line of each unit, if there are any."""
    if units:
        yield _row("", title, [Line(name, rows, field) for name, rows in units.items()], legend=True)


def _is_fed_forward(rows: Records) -> bool:
    """Whether the feedforward of an axis is ever other than 0; the states of a spindle have only its weight."""
    outputs = [name for name in FEEDFORWARD if name in (rows.dtype.names or ())]
    return not outputs or any(np.any(rows[name]) for name in outputs)


def _spindle_rows(name: str, rows: Records) -> Iterator[PlotRow]:
    yield _row(name, "speed", _set_and_actual(rows, "set_speed_rpm", "actual_speed_rpm"))
    angle = _set_and_actual(rows, "set_position_deg", "actual_position_deg")
    if np.any(rows["target_position_deg"] != rows["set_position_deg"]):
        angle.append(Line("target", rows, "target_position_deg"))
    if any(np.any(rows[line.field]) for line in angle):
        yield _row(name, "angle", angle, legend=len(angle) > 2)
    yield from _used(_row(name, "following error", [Line("following error", rows, "following_error_deg")]))


def _axis_rows(name: str, rows: Records, distance: str) -> Iterator[PlotRow]:
    label = axis_label(name)
    yield _row(label, "position", _set_and_actual(rows, "set_position", "actual_position"), distance)
    yield _row(label, "velocity", _set_and_actual(rows, "set_velocity", "actual_velocity"), distance)
    yield _row(label, "acceleration", [Line("set", rows, "set_acceleration", SET)], distance)
    yield _row(label, "jerk", [Line("set", rows, "set_jerk", SET)], distance)
    yield _row(label, "following error", [Line("following error", rows, "following_error")], distance)


def _control_rows(name: str, rows: Records, distance: str, torque_unit: str) -> Iterator[PlotRow]:
    """Rows of what goes to the drive besides the command of the position controller."""
    label = axis_label(name)
    feedforward = [
        Line("to the position controller", rows, "feedforward_velocity", SET),
        Line("to the drive", rows, "additive_velocity", ACTUAL),
    ]
    torque = [Line("additive", rows, "additive_torque", SET), Line("drive", rows, "actual_torque", ACTUAL)]
    friction = [Line("friction compensation", rows, "friction_current")]
    yield from _used(_row(label, "feedforward", feedforward, distance, legend=True))
    yield from _used(_row(label, "torque", torque, torque=torque_unit, legend=True))
    yield from _used(_row(label, "friction compensation, current", friction))


def _set_and_actual(rows: Records, set_field: str, actual_field: str) -> list[Line]:
    return [Line("set", rows, set_field, SET), Line("actual", rows, actual_field, ACTUAL)]


def _used(row: PlotRow) -> Iterator[PlotRow]:
    """The row with the lines that the recording has and that are not 0 throughout, if there are any."""
    lines = [
        line for line in row.lines if line.field in (line.rows.dtype.names or ()) and np.any(line.rows[line.field])
    ]
    if lines:
        yield PlotRow(row.unit, row.title, row.measure, lines, row.legend)
