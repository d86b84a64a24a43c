"""Ranges and defaults in words, for the reference and ROS descriptors."""

from collections.abc import Iterable

from cnc_ptp.parameters.declare.declarations import DATA_TYPES, Declaration, Limit, ParameterValue
from cnc_ptp.parameters.list_units import SHOWN_UNITS


def range_text(declaration: Declaration) -> str:
    """'1 ≤ … ≤ P-AXIS-00212', the choices, or the form of a text."""
    if declaration.range:
        return declaration.range
    if declaration.choices:
        text = choices_text(declaration)
    elif declaration.type == "string":
        length = f"at most {declaration.max_length} characters" if declaration.max_length else ""
        text = ", ".join(part for part in (length, declaration.form_text if declaration.form else "") if part)
    else:
        text = limits_text(declaration)
    return text if declaration.unset is None else f"{text}; {default_text(declaration.unset)} not configured"


def choices_text(declaration: Declaration) -> str:
    choices = declaration.choices
    if declaration.flags:
        return "flags " + ", ".join(f"{name} 0x{number:x}" for name, number in choices.items())
    if declaration.type == "string":
        return ", ".join(choices)
    return ", ".join(f"{number} {meaning}" for number, meaning in choices.items())


def limits_text(declaration: Declaration) -> str:
    """'0 < … ≤ 1000'; the end of the data type is left out if there is another limit."""
    return bounds_text(*(written_limits(declaration, limits) for limits in (declaration.lower, declaration.upper)))


def bounds_text(lower: Iterable[Limit], upper: Iterable[Limit]) -> str:
    left = "".join(f"{limit.value} {'≤' if limit.inclusive else '<'} " for limit in lower)
    right = "".join(f" {'≤' if limit.inclusive else '<'} {limit.value}" for limit in upper)
    return f"{left}…{right}" if left or right else ""


def shown_range(declaration: Declaration, axis_type: str) -> tuple[str, str, str]:
    """Unit in which people think of it, range and default in it: (1/s, 0 < … ≤ 42949672.95, 10); empty without one."""
    unit, factor = SHOWN_UNITS.get(declaration.unit_for(axis_type), ("", 1))
    if not unit or isinstance(declaration.default, (str, tuple)) or declaration.choices:
        return "", "", ""
    lower, upper = (
        tuple(limit._replace(value=shown_number(limit.value, factor)) for limit in written_limits(declaration, limits))
        for limits in (declaration.lower, declaration.upper)
    )
    return unit, bounds_text(lower, upper), shown_number(declaration.default, factor)


def shown_number(value: float | str, factor: int) -> str:
    """A number of the list in larger units; an id stays an id."""
    return value if isinstance(value, str) else f"{value / factor:.12g}"


def written_limits(declaration: Declaration, limits: tuple[Limit, ...]) -> list[Limit]:
    ends = DATA_TYPES[declaration.data_type][1:]
    return [limit for limit in limits if len(limits) == 1 or not (limit.inclusive and limit.value in ends)]


def default_text(value: ParameterValue) -> str:
    if isinstance(value, bool):
        return "1" if value else "0"
    if isinstance(value, tuple):
        return "[" + ", ".join(value) + "]"
    return '""' if value == "" else f"{value}"
