"""The numbers of an event: what each of them is (limit, actual, faulty, expected, corrected), and its unit.

Whoever raises an error or warning gives the numbers of its text by name (`CncError.values`); the names say the rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, NamedTuple

from cnc_ptp.errors import Value
from cnc_ptp.protocol.blocks import EventValue

LIMIT, ACTUAL, FAULTY, EXPECTED, CORRECTED = "limit", "actual", "faulty", "expected", "corrected"
ROLES: Final = (LIMIT, ACTUAL, FAULTY, EXPECTED, CORRECTED)
"""The fields of Event.msg, each with the first value of its kind."""
OF_AXES: Final = ("u", "u/s", "u/s²", "u/s³")
"""Units in which u is mm or deg, by the axis."""
SAME: Final = "="
"""The unit of the argument, or of the first value that has one."""


class Meaning(NamedTuple):
    """What a name stands for."""

    role: str
    unit: str


MEANINGS: Final[Mapping[str, Meaning]] = {
    "limit": Meaning(LIMIT, SAME),
    "low": Meaning("", SAME),
    "high": Meaning("", SAME),
    "velocity_limit": Meaning(LIMIT, "u/s"),
    "tolerance": Meaning(LIMIT, "mm"),
    "range": Meaning(LIMIT, "u"),
    "soft_limit": Meaning(LIMIT, "u"),
    "patience": Meaning(LIMIT, "s"),
    "timeout": Meaning(LIMIT, "ms"),
    "actual": Meaning(ACTUAL, SAME),
    "actual_position": Meaning(ACTUAL, "u"),
    "actual_speed": Meaning(ACTUAL, "rpm"),
    "distance": Meaning(ACTUAL, "u"),
    "deviation": Meaning(ACTUAL, "u"),
    "difference": Meaning(ACTUAL, "u"),
    "following_error": Meaning(ACTUAL, "u"),
    "distance_to_go": Meaning(ACTUAL, "mm"),
    "miss": Meaning(ACTUAL, "mm"),
    "missing": Meaning(ACTUAL, "mm"),
    "known": Meaning(ACTUAL, "mm"),
    "value": Meaning(FAULTY, SAME),
    "velocity": Meaning(FAULTY, "u/s"),
    "acceleration": Meaning(FAULTY, "u/s²"),
    "deceleration": Meaning(FAULTY, "u/s²"),
    "jerk": Meaning(FAULTY, "u/s³"),
    "position": Meaning(FAULTY, "u"),
    "target": Meaning(FAULTY, "u"),
    "angle": Meaning(FAULTY, "deg"),
    "end": Meaning(FAULTY, "mm"),
    "way": Meaning(FAULTY, "mm"),
    "speed": Meaning(FAULTY, "rpm"),
    "feed": Meaning(FAULTY, "mm/s"),
    "percent": Meaning(FAULTY, "%"),
    "weight_percent": Meaning(FAULTY, "%"),
    "override": Meaning(FAULTY, "%"),
    "seconds": Meaning(FAULTY, "s"),
    "radius": Meaning("", "mm"),
    "sweep_deg": Meaning(FAULTY, "deg"),
    "factor": Meaning(FAULTY, ""),
    "ratio": Meaning(FAULTY, ""),
    "index": Meaning(FAULTY, ""),
    "level": Meaning(FAULTY, ""),
    "type": Meaning(FAULTY, ""),
    "expected": Meaning(EXPECTED, SAME),
    "start": Meaning(EXPECTED, "u"),
    "place": Meaning(EXPECTED, "u"),
    "goal": Meaning(EXPECTED, "u"),
    "expected_speed": Meaning(EXPECTED, "rpm"),
    "corrected": Meaning(CORRECTED, SAME),
    "time": Meaning("", "s"),
    "stroke": Meaning(LIMIT, "u"),
    "duration": Meaning("", "s"),
    "at_speed": Meaning("", "rpm"),
    "lead": Meaning("", "mm"),
    "change": Meaning("", "mm"),
    "length": Meaning(LIMIT, "mm"),
    "retract": Meaning("", "mm"),
    "points": Meaning(FAULTY, ""),
    "before": Meaning("", ""),
    "code": Meaning(FAULTY, ""),
    "scaling": Meaning(FAULTY, ""),
    "part": Meaning(ACTUAL, ""),
    "run_up": Meaning("", "u"),
    "run_out": Meaning("", "u"),
}
"""Names of numbers; one that is not here is a number without a unit and has no field of its own."""
UNKNOWN: Final = Meaning("", "")


def event_values(values: Mapping[str, Value], axis_unit: str) -> list[EventValue]:
    """The numbers among `values`, each with its unit and what it is; `axis_unit`: mm or deg."""
    unit = common_unit(values)
    found = []
    for name, value in values.items():
        if isinstance(value, str):
            continue
        meaning = MEANINGS.get(name, UNKNOWN)
        own = unit if meaning.unit == SAME else meaning.unit
        if own in OF_AXES:
            own = axis_unit + own[1:]
        found.append(EventValue(name, float(value), own, meaning.role))
    return found


def role_of(name: str) -> str:
    """Of a value of a notice about a machine file; a parameter itself is the faulty value."""
    return FAULTY if name.startswith(PARAMETER) else MEANINGS.get(name, UNKNOWN).role


PARAMETER: Final = "P-"
"""How the number of a parameter begins."""


def common_unit(values: Mapping[str, Value]) -> str:
    """That of the argument which a command names, or of the first value that has a unit and a role of its own."""
    argument = values.get("argument")
    names = [argument] if isinstance(argument, str) else list(values)
    known = [MEANINGS[name] for name in names if name in MEANINGS]
    units = [meaning.unit for meaning in known if meaning.unit != SAME and meaning.role]
    return units[0] if units else ""


def read_event_values(message: Any) -> list[EventValue]:
    """Of an event's message; those of older recordings have no roles, or no values."""
    roles = {getattr(message, role).name: role for role in ROLES if hasattr(message, role)}
    return [
        EventValue(value.name, value.value, value.unit, roles.get(value.name, ""))
        for value in getattr(message, "values", ())
    ]
