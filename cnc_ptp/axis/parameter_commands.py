"""Parameters of an axis that may change at run time (PLCopen MC_WriteParameter)."""

from __future__ import annotations

from dataclasses import replace

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import BAD_PARAMETER_VALUE, NOT_WRITABLE
from cnc_ptp.parameters import catalogue, list_units
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import Declaration, ParameterValue
from cnc_ptp.parameters.read.values import BadValue, checked_value

WRITE = "write_parameter"
WRITABLE = (ids.GETRIEBE_WINDOW, ids.PTP_TARGET_TIME_MS)
"""Those that only the axis itself reads, between its motions."""


class ParameterCommands:
    """`write_parameter`."""

    def __init__(self, axis: Axis, *, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self._axis = axis
        self._cycle_time = cycle_time

    def do_write_parameter(self, cycle: int, *, parameter: str, value: float) -> None:
        """A new value in the unit of the list, until the end of the run. Refusals: 23095, 23096."""
        if parameter not in WRITABLE:
            known = catalogue().by_id.get(parameter)
            what = f"'{parameter}' is no number of a parameter" if known is None else f"{parameter} ({known.name})"
            reason = what if known is None else f"{what} cannot be written at run time"
            text = f"{reason}; {' and '.join(WRITABLE)} can be written"
            self._axis.refuse(WRITE, NOT_WRITABLE, text, parameter=parameter)
        declaration = catalogue().by_id[parameter]
        unit = declaration.unit_for("R" if self._axis.parameters.rotary else "T")
        checked = self._checked(declaration, value, unit)
        self._take(parameter, list_units.to_kernel(checked, unit))

    def _checked(self, declaration: Declaration, value: float, unit: str) -> float:
        given: ParameterValue = int(value) if value.is_integer() else value
        try:
            return float(checked_value(declaration, given, unit))  # type: ignore[arg-type]
        except BadValue as error:
            text = f"{declaration.id} {declaration.name}: {error.text}"
            self._axis.refuse(WRITE, BAD_PARAMETER_VALUE, text, parameter=declaration.id, value=value)

    def _take(self, parameter: str, value: float) -> None:
        axis = self._axis
        if parameter == ids.GETRIEBE_WINDOW:
            axis.parameters = replace(axis.parameters, position_window=value)
        else:
            axis.parameters = replace(axis.parameters, target_time=value)
        window, seconds = axis.parameters.position_window, axis.parameters.target_time
        axis.target_window.set(window=window, cycles=round(seconds / self._cycle_time))
