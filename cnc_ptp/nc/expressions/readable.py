"""What programs can read of axes, spindles and channel: V.A., V.G., V.SPDL_PROG.; a new name is a new row here.

Sources: the vendor's programming manual, V.A., V.G. and V.SPDL_PROG. variables; V.RTG. of its real-time
cycles. Lengths are in mm, or in inch with G70.
"""

from collections.abc import Callable
from typing import Final

from cnc_ptp.nc.coordinates.codes import LAST_OFFSET, default_offset, has_offset, offset_values
from cnc_ptp.nc.coordinates.coordinate_faults import NO_OFFSET_OF_G53
from cnc_ptp.nc.coordinates.placement import refresh
from cnc_ptp.nc.expressions import expression_faults as faults
from cnc_ptp.nc.expressions.reading import Reading, Units, axis_of, in_mm, length
from cnc_ptp.nc.expressions.values import Scalar, Values
from cnc_ptp.nc.feeds import PER_TURN
from cnc_ptp.nc.measuring import NOT_MEASURED, Measured
from cnc_ptp.nc.tools.readings import TOOL_READINGS
from cnc_ptp.nc.turning import as_programmed
from cnc_ptp.parameters.list_units import LARGEST_POSITION

LAST_TIMER: Final = 127
"""#TIMER has the timers 0 to 127."""


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


def programmed(values: Values, units: Units, column: int) -> Scalar:
    axis = axis_of(values, units[0], column)
    return length(values, axis, as_programmed(values.state, axis, values.state.programmed[axis]))


def last_feed(values: Values) -> float:
    """mm/min, with G95 mm per turn."""
    state = values.state
    return state.turning.feed if state.feed_mode == PER_TURN else state.feed * 60.0


def reference_offset(values: Values, units: Units, column: int) -> Scalar:
    axis, added = axis_of(values, units[0], column), values.state.coordinates.own.added
    return length(values, axis, added[axis]) if added else 0.0


def table_index(values: Values, unit: Scalar, column: int) -> int:
    if isinstance(unit, str) or unit != int(unit) or not 0 <= unit <= LAST_OFFSET:
        shown = unit if isinstance(unit, str) else f"{unit:g}"
        known = f"0 to {LAST_OFFSET}"
        raise values.fault(faults.UNIT_UNKNOWN, column, kind="zero offset", unit=shown, known=known)
    return int(unit)


def require_offset(values: Values, index: int, word: str, column: int) -> None:
    """Raises ProgramError 21622 for values of index 0 on a machine without an offset of G53."""
    if not has_offset(values.channel, index):
        raise values.fault(NO_OFFSET_OF_G53, column, word=word)


def zero_offset(values: Values, units: Units, column: int) -> Scalar:
    """V.G.NP[j].V.X."""
    index, axis = table_index(values, units[0], column), axis_of(values, units[1], column)
    offset = offset_values(values.channel, values.state.coordinates.changes, index)[axis]
    return length(values, axis, offset / values.channel.turning.offset_factor(axis))


def set_zero_offset(values: Values, units: Units, value: Scalar, column: int) -> None:
    """It acts when the offset is selected next, as the vendor has it."""
    index, axis = table_index(values, units[0], column), axis_of(values, units[1], column)
    require_offset(values, index, "V.G.NP[0]", column)
    table = list(offset_values(values.channel, values.state.coordinates.changes, index))
    table[axis] = in_mm(values, axis, value, column) * values.channel.turning.offset_factor(axis)
    changes = values.state.coordinates.changes
    values.state.coordinates.changes = changes._replace(values={**changes.values, index: tuple(table)})


def active_offset(values: Values, units: Units, column: int) -> Scalar:
    """V.G.NP_AKT.V.X."""
    axis, zero = axis_of(values, units[0], column), values.state.coordinates.own.zero
    return length(values, axis, zero[axis] / values.channel.turning.offset_factor(axis)) if zero else 0.0


def set_active_offset(values: Values, units: Units, value: Scalar, column: int) -> None:
    """Lost when a zero offset is selected next."""
    axis, own = axis_of(values, units[0], column), values.state.coordinates.own
    require_offset(values, own.zero_index, "V.G.NP_AKT", column)
    zero = list(own.zero or (0.0,) * len(values.channel.axes))
    zero[axis] = in_mm(values, axis, value, column) * values.channel.turning.offset_factor(axis)
    values.state.coordinates.own = own._replace(zero=tuple(zero))
    refresh(values.channel, values.state)


def software_limit(values: Values, unit: Scalar, column: int, place: int) -> float:
    """That of G98 (place 0) or G99, within that of the axis list."""
    axis, configured = axis_of(values, unit, column), configured_limit(values, unit, column, place)
    programmed = (values.state.coordinates.limits or {}).get(axis)
    if programmed is None:
        return configured
    own = length(values, axis, programmed[place])
    return min(configured, own) if place else max(configured, own)


def configured_limit(values: Values, unit: Scalar, column: int, place: int) -> float:
    """P-AXIS-00177 (place 0), P-AXIS-00178; the largest position without one."""
    axis, limits = axis_of(values, unit, column), values.channel.soft_limits
    position = limits[axis][place] if limits else (-LARGEST_POSITION, LARGEST_POSITION)[place]
    return length(values, axis, max(-LARGEST_POSITION, min(LARGEST_POSITION, position)))


def clamp_offset(values: Values, units: Units, column: int) -> Scalar:
    axis, clamp = axis_of(values, units[0], column), values.state.coordinates.clamp
    return length(values, axis, clamp[axis]) if clamp else 0.0


def default_index(values: Values, units: Units, column: int) -> Scalar:
    return float(default_offset(values.channel, values.state.coordinates.changes))


def set_default_index(values: Values, units: Units, value: Scalar, column: int) -> None:
    """For the programs that are started later."""
    index = table_index(values, value, column)
    coordinates = values.state.coordinates
    coordinates.changes = coordinates.changes._replace(default=index)


def systems(values: Values, command: str) -> float:
    return float(sum(system.command == command for system in values.state.coordinates.systems))


def feed(values: Values) -> float:
    return values.state.feed * 60.0 / values.state.coordinates.unit


def radius(values: Values) -> float:
    return values.state.radius / values.state.coordinates.unit


def zero_index(values: Values) -> float:
    return float(values.state.coordinates.own.zero_index)


def turned(values: Values) -> bool:
    return values.state.coordinates.turn is not None


def turn_angle(values: Values) -> float:
    turn = values.state.coordinates.turn
    return 0.0 if turn is None else turn[0]


def absolute(values: Values, units: Units, column: int) -> Scalar:
    axis = axis_of(values, units[0], column)
    return length(values, axis, values.state.position[axis])


def actual(values: Values, units: Units, column: int) -> Scalar:
    axis = axis_of(values, units[0], column)
    return length(values, axis, values.actual[axis])


def measured(text: str, of: Callable[[Measured], float]) -> Reading:
    """A result of the last measuring run of an axis (Measured), 0 before the first one."""

    def read(values: Values, units: Units, column: int) -> Scalar:
        axis = axis_of(values, units[0], column)
        return length(values, axis, of(values.measured.get(axis, NOT_MEASURED)))

    return Reading(text, read, synchronises=True)


def reached(values: Values, units: Units, column: int) -> Scalar:
    return float(values.measured.get(axis_of(values, units[0], column), NOT_MEASURED).reached)


def spindle_speed(values: Values, units: Units, column: int) -> Scalar:
    return values.state.speeds.get(spindle_of(values, units[0], column), 0.0)


def spindle_turning(values: Values, units: Units, column: int) -> Scalar:
    return float(values.state.spindle.turning.get(spindle_of(values, units[0], column), 5))


def spindle_position(values: Values, units: Units, column: int) -> Scalar:
    return values.state.spindle.positions.get(spindle_of(values, units[0], column), 0.0)


def timer(values: Values, units: Units, column: int) -> Scalar:
    """0 for one that was never read."""
    unit = units[0]
    if isinstance(unit, str) or unit != int(unit) or not 0 <= unit <= LAST_TIMER:
        shown = unit if isinstance(unit, str) else f"{unit:g}"
        known = f"0 to {LAST_TIMER}"
        raise values.fault(faults.UNIT_UNKNOWN, column, kind="timer", unit=shown, known=known)
    return values.timers.get(int(unit), 0.0)


def argument_given(values: Values, units: Units, column: int) -> Scalar:
    number = units[0]
    return 1.0 if isinstance(number, float) and f"P{number:.0f}" in values.arguments else 0.0


def limit(text: str, read: Callable[[Values, Scalar, int, int], float], place: int) -> Reading:
    """The row of a software limit: negative (place 0) or positive."""
    return Reading(text, lambda values, units, column: read(values, units[0], column, place))


READABLE: Final[dict[str, tuple[tuple[tuple[str, ...], Reading], ...]]] = {
    "V.A.ABS": ((("*",), Reading("end point of the previous block, with all offsets", absolute)),),
    "V.A.PROG": ((("*",), Reading("end point of the previous block as it was programmed", programmed)),),
    "V.A.BZP": ((("*",), Reading("offset of G92", reference_offset)),),
    "V.A.PZV": ((("*",), Reading("offset of the clamp position", clamp_offset)),),
    "V.A.-SWE": ((("*",), limit("software limit, also of G98", software_limit, 0)),),
    "V.A.+SWE": ((("*",), limit("software limit, also of G99", software_limit, 1)),),
    "V.A.-SWE_MDS": ((("*",), limit("software limit P-AXIS-00177", configured_limit, 0)),),
    "V.A.+SWE_MDS": ((("*",), limit("software limit P-AXIS-00178", configured_limit, 1)),),
    "V.G.NP_DEFAULT": (((), Reading("index of the zero offset at program start", default_index, set_default_index)),),
    "V.G.NP": ((("*", "V", "*"), Reading("zero offset of an index and an axis", zero_offset, set_zero_offset)),),
    "V.G.NP_AKT": (
        (("V", "*"), Reading("active zero offset of an axis", active_offset, set_active_offset)),
        (("IDX",), Reading("index of the active zero offset", lambda values, u, c: zero_index(values))),
    ),
    "V.G.ROT_ACTIVE": (((), Reading("TRUE with #ROTATION ON", lambda values, u, c: float(turned(values)))),),
    "V.G.ROT_ANGLE": (((), Reading("angle of #ROTATION, deg", lambda values, u, c: turn_angle(values))),),
    "V.G.CS_ACTIVE": (((), Reading("TRUE with #CS ON", lambda values, u, c: min(1.0, systems(values, "#CS")))),),
    "V.G.CS_COUNT": (((), Reading("number of #CS that are on", lambda values, u, c: systems(values, "#CS"))),),
    "V.G.ACS_ACTIVE": (((), Reading("TRUE with #ACS ON", lambda values, u, c: min(1.0, systems(values, "#ACS")))),),
    "V.G.ACS_COUNT": (((), Reading("number of #ACS that are on", lambda values, u, c: systems(values, "#ACS"))),),
    "V.A.ACT_POS": ((("*",), Reading("actual position at the instant", actual, synchronises=True)),),
    "V.A.MESS": ((("*",), measured("measured position, with all offsets", lambda axis: axis.machine)),),
    "V.A.MERF": ((("*",), Reading("1 if the probe has switched in the measuring run", reached, synchronises=True)),),
    "V.A.MOFFS": (
        (("*",), measured("from the end of the measuring run to the measured position", lambda axis: axis.offset)),
    ),
    "V.A.MEAS": (
        (("ACS", "VALUE", "*"), measured("measured position, with all offsets", lambda axis: axis.machine)),
        (
            ("PCS", "VALUE", "*"),
            measured("the same without offsets, as programs name it", lambda axis: axis.programmed),
        ),
    ),
    "V.G.BLOCK_NR": (((), Reading("last N word", lambda values, u, c: float(values.block_number))),),
    "V.G.FEEDRATE": (
        (
            (),
            Reading(
                "last F word, mm/min (inch/min), with G95 mm (inch) per turn",
                lambda values, u, c: last_feed(values) / values.state.coordinates.unit,
            ),
        ),
    ),
    "V.G.FEEDRATE_MODE": (((), Reading("93, 94 or 95", lambda values, u, c: float(values.state.feed_mode))),),
    "V.G.MASS_MM": (
        ((), Reading("0 with G71, 1 with G70", lambda values, u, c: float(values.state.coordinates.unit != 1.0))),
    ),
    "V.G.PLANE": (((), Reading("17, 18 or 19 (a name of our own)", lambda values, u, c: float(values.state.plane))),),
    "V.G.PROG_ABS": (((), Reading("TRUE with G90", lambda values, u, c: 1.0 if values.state.absolute else 0.0)),),
    "V.G.PROG_LEVEL": (((), Reading("1 in the main program", lambda values, u, c: float(values.level))),),
    "V.G.R": (
        (
            (),
            Reading("last radius of an arc", lambda values, u, c: radius(values)),
        ),
    ),
    "V.G.@P": ((("*", "VALID"), Reading("TRUE if the call gave @P of this number", argument_given)),),
    "V.G.TIMER": ((("*",), Reading("what #TIMER READ has found, ms", timer)),),
    "V.RTG.OVERRIDE": (
        (
            ("VEL", "TOTAL"),
            Reading(
                "override of the path at the instant, percent; 0 with a feed hold",
                lambda values, u, c: values.override,
                synchronises=True,
            ),
        ),
    ),
    **TOOL_READINGS,
    "V.SPDL_PROG.SPEED": ((("*",), Reading("programmed speed, rpm", spindle_speed)),),
    "V.SPDL_PROG.MOVE_CMD": ((("*",), Reading("3, 4 or 5", spindle_turning)),),
    "V.SPDL_PROG.POSITION": ((("*",), Reading("programmed position, deg", spindle_position)),),
}


def forms(name: str) -> str:
    """How a readable name is written, with a placeholder for its axis, spindle or index."""
    first = {"V.A": ".<axis>", "V.S": ".<spindle>"}.get(name[:3], "[<index>]")
    written = []
    for pattern, _ in READABLE[name]:
        shown = name
        for place, part in enumerate(pattern):
            if part != "*":
                shown += f".{part}"
            elif place == 0:
                shown += first
            else:
                shown += "[<index>]" if pattern[place - 1] == "P" else ".<axis>"
        written.append(shown)
    return " or ".join(written)


def all_names() -> list[str]:
    """For errors: as they are written, without their axis or index."""
    return [
        ".".join([name, *(part for part in pattern if part != "*")])
        for name, rows in READABLE.items()
        for pattern, _ in rows
    ]
