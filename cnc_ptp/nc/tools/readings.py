"""What programs read and write of tools: V.G.T_AKT, V.G.D_AKT, V.G.WZ_AKT and V.G.WZ[n].

Source: the vendor's manual of the external tool management. What is written to V.G.WZ_AKT acts at once, until data are
selected again; what is written to V.G.WZ[n] acts when they are selected next. Wear can be read only.
"""

from collections.abc import Callable
from typing import Final

from cnc_ptp.nc.expressions import expression_faults
from cnc_ptp.nc.expressions.reading import Reading, Units, axis_of, in_mm, length
from cnc_ptp.nc.expressions.values import Scalar, Values
from cnc_ptp.nc.radius.changes import require_same_radius
from cnc_ptp.nc.tools import tool_faults as faults
from cnc_ptp.nc.tools.compensation import apply, data_of
from cnc_ptp.parameters import Tool

LAST_VALUE: Final = 59
"""P-TOOL-00007: param[0] to param[59]."""

Get = Callable[[Values, Tool, Units, int], float]
Set = Callable[[Values, Tool, Units, Scalar, int], Tool]


def by_axis(values: Values, of_axes: tuple[float, ...], units: Units, column: int) -> float:
    axis = axis_of(values, units[0], column)
    return length(values, axis, of_axes[axis]) if of_axes else 0.0


def linear(values: Values, value: float) -> float:
    """A length as programs name it."""
    return value / values.state.coordinates.unit


def in_linear(values: Values, value: Scalar, column: int, what: str) -> float:
    """A length of the program in mm: that of an axis which is not rotary."""
    names = values.channel.axes
    axis = next((place for place, name in enumerate(names) if name not in values.channel.rotary), 0)
    return in_mm(values, axis, value, column, what)


def value_index(values: Values, unit: Scalar, column: int) -> int:
    if isinstance(unit, str) or unit != int(unit) or not 0 <= unit <= LAST_VALUE:
        shown = unit if isinstance(unit, str) else f"{unit:g}"
        raise values.fault(faults.VALUE_INDEX, column, index=shown, limit=str(LAST_VALUE))
    return int(unit)


def free_value(values: Values, tool: Tool, units: Units, column: int) -> float:
    place = value_index(values, units[0], column)
    return tool.values[place] if place < len(tool.values) else 0.0


def set_length(values: Values, tool: Tool, units: Units, value: Scalar, column: int) -> Tool:
    return tool._replace(length=in_linear(values, value, column, "a tool length"))


def set_radius(values: Values, tool: Tool, units: Units, value: Scalar, column: int) -> Tool:
    return tool._replace(radius=in_linear(values, value, column, "a tool radius"))


def set_offset(values: Values, tool: Tool, units: Units, value: Scalar, column: int) -> Tool:
    axis = axis_of(values, units[0], column)
    offsets = list(tool.offsets or (0.0,) * len(values.channel.axes))
    offsets[axis] = in_mm(values, axis, value, column, "a tool offset")
    return tool._replace(offsets=tuple(offsets))


def set_free_value(values: Values, tool: Tool, units: Units, value: Scalar, column: int) -> Tool:
    place = value_index(values, units[0], column)
    if isinstance(value, str):
        raise values.fault(expression_faults.NUMBER_EXPECTED, column, what="the value of a tool")
    changed = list(tool.values) + [0.0] * (place + 1 - len(tool.values))
    changed[place] = value
    return tool._replace(values=tuple(changed))


ROWS: Final[tuple[tuple[tuple[str, ...], str, Get, Set | None], ...]] = (
    (("R",), "radius of the tool", lambda values, tool, u, c: linear(values, tool.radius), set_radius),
    (("L",), "length of the tool", lambda values, tool, u, c: linear(values, tool.length), set_length),
    (
        ("V", "*"),
        "offset of the tool in an axis",
        lambda values, tool, u, c: by_axis(values, tool.offsets, u, c),
        set_offset,
    ),
    (("P", "*"), "value of the tool for programs", free_value, set_free_value),
    (("OK",), "1 if the data are there and valid", lambda values, tool, u, c: 1.0 if tool.valid else 0.0, None),
    (("ME",), "unit, always 0 (mm)", lambda values, tool, u, c: 0.0, None),
    (("TYPE",), "0 milling, 1 turning, 2 grinding, 3 wire", lambda values, tool, u, c: float(tool.type), None),
    (("SRK_ID",), "position of the cutter, 1 to 9", lambda values, tool, u, c: float(tool.orientation), None),
    (("TOOL_FIXED",), "1 if offsets do not turn with #CS", lambda values, tool, u, c: float(tool.fixed), None),
    (("SPDL_AX_NR",), "spindle that gets its limits", lambda values, tool, u, c: float(tool.spindle), None),
    (("WEAR_LENGTH",), "wear of the length", lambda values, tool, u, c: linear(values, tool.wear_length), None),
    (("WEAR_RADIUS",), "wear of the radius", lambda values, tool, u, c: linear(values, tool.wear_radius), None),
    (("WEAR", "*"), "wear in an axis", lambda values, tool, u, c: by_axis(values, tool.wear, u, c), None),
)
"""Name behind V.G.WZ_AKT and V.G.WZ[n], meaning, value of the data, the data with another value."""


def active(get: Get) -> Callable[[Values, Units, int], Scalar]:
    return lambda values, units, column: get(values, values.state.tool.data, units, column)


def set_active(name: str, change: Set) -> Callable[[Values, Units, Scalar, int], None]:
    def write(values: Values, units: Units, value: Scalar, column: int) -> None:
        state = values.state
        data = change(values, state.tool.data, units, value, column)
        require_same_radius(state, data, values.source, column, name)
        state.tool.data = data
        state.tool.written = (name, values.source.file, values.source.line)
        apply(values.channel, state, values.source, column)

    return write


def index_of(values: Values, unit: Scalar, column: int) -> int:
    """D number of data that are there. Raises ProgramError 21435."""
    number = int(unit) if isinstance(unit, float) and unit == int(unit) else -1
    if number < 0 or data_of(values.channel, values.state, number) is None:
        shown = unit if isinstance(unit, str) else f"{unit:g}"
        known = ", ".join(f"D{each}" for each in sorted(values.channel.tools.tools)) or "none"
        raise values.fault(
            expression_faults.UNIT_UNKNOWN, column, kind="compensation data", unit=f"D{shown}", known=known
        )
    return number


def listed(get: Get) -> Callable[[Values, Units, int], Scalar]:
    def read(values: Values, units: Units, column: int) -> Scalar:
        data = data_of(values.channel, values.state, index_of(values, units[0], column))
        assert data is not None
        return get(values, data, units[1:], column)

    return read


def set_listed(change: Set) -> Callable[[Values, Units, Scalar, int], None]:
    def write(values: Values, units: Units, value: Scalar, column: int) -> None:
        tool, number = values.state.tool, index_of(values, units[0], column)
        data = data_of(values.channel, values.state, number)
        assert data is not None
        if number:
            tool.changed = {**(tool.changed or {}), number: change(values, data, units[1:], value, column)}

    return write


def there(values: Values, units: Units, column: int) -> Scalar:
    """V.G.WZ[n].OK asks for data that need not be there."""
    unit = units[0]
    whole = isinstance(unit, float) and unit == int(unit) and unit >= 0.0
    data = data_of(values.channel, values.state, int(unit)) if whole else None
    return 1.0 if data is not None and data.valid else 0.0


TOOL_READINGS: Final[dict[str, tuple[tuple[tuple[str, ...], Reading], ...]]] = {
    "V.G.T_AKT": (((), Reading("last T word", lambda values, u, c: float(values.state.tool.t))),),
    "V.G.D_AKT": (((), Reading("active compensation data", lambda values, u, c: float(values.state.tool.d))),),
    "V.G.WZ_AKT": tuple(
        (
            pattern,
            Reading(
                text,
                active(get),
                None if change is None else set_active(f"V.G.WZ_AKT.{pattern[0]}", change),
            ),
        )
        for pattern, text, get, change in ROWS
    ),
    "V.G.WZ": tuple(
        (
            ("*", *pattern),
            Reading(
                text,
                there if pattern == ("OK",) else listed(get),
                None if change is None else set_listed(change),
            ),
        )
        for pattern, text, get, change in ROWS
    ),
}
