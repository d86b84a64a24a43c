"""What programs can read of axes, spindles and channel: V.A., V.G., V.SPDL_PROG.; a new name is a new row here.

Sources: the vendor's programming manual, V.A., V.G. and V.SPDL_PROG. variables. Lengths are in mm, or in inch with G70.
"""

from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

from cnc_ptp.nc.expressions import expression_faults as faults
from cnc_ptp.nc.expressions.values import Scalar, Values

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


def spindle_of(values: Values, unit: Scalar, column: int) -> str:
    """Key of a spindle by its present name."""
    spindles = values.channel.table.spindles
    main = values.state.spindle.main or (spindles[0].key if spindles else "")
    for spindle in spindles:
        name = values.channel.table.main_name if spindle.key == main else spindle.own_name
        if name == unit:
            return spindle.key
    known = ", ".join(spindle.own_name for spindle in spindles) or "none"
    shown = unit if isinstance(unit, str) else f"{unit:g}"
    raise values.fault(faults.UNIT_UNKNOWN, column, kind="spindle", unit=shown, known=known)


def absolute(values: Values, units: Units, column: int) -> Scalar:
    return values.state.position[axis_of(values, units[0], column)]


def actual(values: Values, units: Units, column: int) -> Scalar:
    return values.actual[axis_of(values, units[0], column)]


def spindle_speed(values: Values, units: Units, column: int) -> Scalar:
    return values.state.speeds.get(spindle_of(values, units[0], column), 0.0)


def spindle_turning(values: Values, units: Units, column: int) -> Scalar:
    return float(values.state.spindle.turning.get(spindle_of(values, units[0], column), 5))


def spindle_position(values: Values, units: Units, column: int) -> Scalar:
    return values.state.spindle.positions.get(spindle_of(values, units[0], column), 0.0)


def argument_given(values: Values, units: Units, column: int) -> Scalar:
    number = units[0]
    return 1.0 if isinstance(number, float) and f"P{number:.0f}" in values.arguments else 0.0


READABLE: Final[dict[str, tuple[tuple[tuple[str, ...], Reading], ...]]] = {
    "V.A.ABS": ((("*",), Reading("end point of the previous block, with all offsets", absolute)),),
    "V.A.ACT_POS": ((("*",), Reading("actual position at the instant", actual, synchronises=True)),),
    "V.G.BLOCK_NR": (((), Reading("last N word", lambda values, u, c: float(values.block_number))),),
    "V.G.FEEDRATE": (((), Reading("last F word, mm/min", lambda values, u, c: values.state.feed * 60.0)),),
    "V.G.PROG_ABS": (((), Reading("TRUE with G90", lambda values, u, c: 1.0 if values.state.absolute else 0.0)),),
    "V.G.PROG_LEVEL": (((), Reading("1 in the main program", lambda values, u, c: float(values.level))),),
    "V.G.R": (((), Reading("last radius of an arc", lambda values, u, c: values.state.radius)),),
    "V.G.@P": ((("*", "VALID"), Reading("TRUE if the call gave @P of this number", argument_given)),),
    "V.SPDL_PROG.SPEED": ((("*",), Reading("programmed speed, rpm", spindle_speed)),),
    "V.SPDL_PROG.MOVE_CMD": ((("*",), Reading("3, 4 or 5", spindle_turning)),),
    "V.SPDL_PROG.POSITION": ((("*",), Reading("programmed position, deg", spindle_position)),),
}


def forms(name: str) -> str:
    """How a readable name is written, with a placeholder for its axis, spindle or index."""
    placeholder = {"V.A": ".<axis>", "V.S": ".<spindle>"}.get(name[:3], "[<index>]")
    written = [[placeholder if part == "*" else f".{part}" for part in pattern] for pattern, _ in READABLE[name]]
    return " or ".join(name + "".join(parts) for parts in written)


def all_names() -> list[str]:
    """For errors: as they are written, without their axis or index."""
    return [
        ".".join([name, *(part for part in pattern if part != "*")])
        for name, rows in READABLE.items()
        for pattern, _ in rows
    ]
