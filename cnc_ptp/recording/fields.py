"""Fields of a recording by name: `x/set_velocity`, or `set_velocity` of all units that move."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from cnc_ptp.errors import CncError
from cnc_ptp.recording.reader import SPINDLE_STATE, Recorded
from cnc_ptp.recording.rows import ACTUAL, OTHER, SET, USUAL, Line, PlotRow, axis_label, standing, time_rows
from cnc_ptp.recording.selection import NOT_RECORDED, nearest
from cnc_ptp.recording.units import unit_of, without_role, without_unit
from cnc_ptp.wire.layout import Records

BY_PREFIX = {"set_": SET, "actual_": ACTUAL}


def usual_rows(recorded: Recorded, units: Mapping[str, str]) -> list[PlotRow]:
    """Of each axis that moves position, velocity, acceleration and following error, of each spindle the speed."""
    spindles = recorded.of_type(SPINDLE_STATE)
    return [
        row
        for row in time_rows(recorded, units, {})
        if row.title in USUAL and (row.unit not in spindles or row.title == "speed")
    ]


def chosen_rows(
    recorded: Recorded, words: Sequence[str], units: Mapping[str, str], torques: Mapping[str, str]
) -> list[PlotRow]:
    """A row for each quantity, with the fields of all units that were named. Raises CncError 26011."""
    rows = _rows_by_quantity(recorded, words, units, torques)
    return [_of_one_unit(row) for row in rows]


def _of_one_unit(row: PlotRow) -> PlotRow:
    """If all lines are of one unit, its name is before the quantity and not at each line."""
    units = {line.name.rpartition(" ")[0] if line.role else line.name for line in row.lines}
    if len(units) > 1:
        return row
    lines = [replace(line, name=line.role or row.title) for line in row.lines]
    return replace(row, unit=units.pop(), lines=lines, legend=len(lines) > 1)


def _rows_by_quantity(
    recorded: Recorded, words: Sequence[str], units: Mapping[str, str], torques: Mapping[str, str]
) -> list[PlotRow]:
    states = _rows_of_units(recorded)
    rows: dict[tuple[str, str], PlotRow] = {}
    for word in words:
        for unit, field in _fields(recorded, word):
            title, role = quantity(field)
            measure = unit_of(field, units.get(unit, "mm"), torques.get(unit, "Nm or N"))
            row = rows.setdefault((title, measure), PlotRow("", title.replace("_", " "), measure, legend=True))
            name = " ".join(filter(None, [axis_label(unit), role]))
            row.lines.append(Line(name, states[unit], field, role))
    return list(rows.values())


def quantity(field: str) -> tuple[str, str]:
    """`set_speed_rpm` is `speed`, a set value."""
    role = next((role for prefix, role in BY_PREFIX.items() if field.startswith(prefix)), OTHER)
    return without_role(without_unit(field)), role


def _fields(recorded: Recorded, word: str) -> Iterator[tuple[str, str]]:
    """Unit and field of a word."""
    units = _rows_of_units(recorded)
    unit, _, field = word.strip("/").rpartition("/")
    unit = unit.removesuffix("/state")
    if unit:
        yield unit, _field_of_unit(recorded, units, unit, field)
        return
    having = {name: found for name, rows in units.items() if (found := _field_named(rows, field))}
    if field in units:
        example = f"{field}/{names_of(units[field])[0]}"
        raise _unnamed(recorded, f"'{field}' as a unit, not as a field; give one of its fields, {example}")
    if not having:
        raise _unknown(recorded, f"no field '{field}'", field, _all_names(units))
    still = standing(recorded)
    yield from {name: found for name, found in having.items() if name not in still}.items() or having.items()


def _rows_of_units(recorded: Recorded) -> dict[str, Records]:
    """States by unit; the threads of a channel are `channel/thread`."""
    units = {topic.removeprefix("/").removesuffix("/state"): rows for topic, rows in recorded.states.items()}
    return {**units, **{f"{name}/thread": rows for name, rows in recorded.threads.items()}}


def _field_of_unit(recorded: Recorded, units: Mapping[str, Records], unit: str, field: str) -> str:
    if unit not in units:
        raise _unknown(recorded, f"no unit '{unit}' with states", unit, list(units))
    if not (found := _field_named(units[unit], field)):
        raise _unknown(recorded, f"no field '{field}' of '{unit}'", field, names_of(units[unit]))
    return found


def _field_named(rows: Records, word: str) -> str:
    """The field of this name, with or without its unit: `following_error` of a spindle is `following_error_deg`."""
    return next((name for name in names_of(rows) if word in (name, without_unit(name))), "")


def names_of(rows: Records) -> list[str]:
    """Fields of a state that can be drawn."""
    return [name for name in rows.dtype.names or () if not name.startswith("header.") and name != "cycle"]


def _all_names(units: Mapping[str, Records]) -> list[str]:
    return list(dict.fromkeys(name for rows in units.values() for name in names_of(rows)))


def _unknown(recorded: Recorded, what: str, word: str, known: Sequence[str]) -> CncError:
    return _unnamed(recorded, f"{what}{nearest(word, known)}")


def _unnamed(recorded: Recorded, what: str) -> CncError:
    return CncError(NOT_RECORDED, f"recording {recorded.path}: holds {what}", "nothing was drawn")
