"""A readable name of programs, and what the functions behind all of them need: axes, lengths in the active unit."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from cnc_ptp.nc.expressions import expression_faults as faults
from cnc_ptp.nc.expressions.values import Scalar, Values
from cnc_ptp.parameters.list_units import LARGEST_POSITION

Units = Sequence[Scalar]
"""The axis, spindle or index of a name, in its order."""


class Reading(NamedTuple):
    """A readable name. `synchronises`: only the run knows the value, so the program waits until the path stands."""

    text: str
    read: Callable[[Values, Units, int], Scalar]
    write: Callable[[Values, Units, Scalar, int], None] | None = None
    synchronises: bool = False


def axis_of(values: Values, unit: Scalar, column: int) -> int:
    """Place of an axis among those of the channel, by its name or index."""
    names = values.channel.axes
    if isinstance(unit, float) and unit == int(unit) and 0.0 <= unit < len(names):
        return int(unit)
    if isinstance(unit, str) and unit in names:
        return names.index(unit)
    shown = unit if isinstance(unit, str) else f"{unit:g}"
    known = ", ".join(names)
    raise values.fault(faults.UNIT_UNKNOWN, column, kind="axis", unit=shown, known=known)


def length(values: Values, axis: int, value: float) -> float:
    """As programs name it: in inch with G70, unless the axis is rotary."""
    return value if values.channel.axes[axis] in values.channel.rotary else value / values.state.coordinates.unit


def in_mm(values: Values, axis: int, value: Scalar, column: int, what: str = "an offset") -> float:
    """The opposite of `length`. Raises ProgramError for a text and for a length beyond the range of positions."""
    if isinstance(value, str):
        raise values.fault(faults.NUMBER_EXPECTED, column, what=f"the value of {what}")
    if not -LARGEST_POSITION <= value <= LARGEST_POSITION:
        words = {"value": f"{value:g}", "limit": f"{LARGEST_POSITION:g}"}
        raise values.fault(faults.VALUE_RANGE, column, word=f"the {what.partition(' ')[2]}", **words)
    return value if values.channel.axes[axis] in values.channel.rotary else value * values.state.coordinates.unit
