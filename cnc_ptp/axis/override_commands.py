"""Override of PTP motion, on the fly. Source: TX1250 2.2."""

from __future__ import annotations

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import BAD_OVERRIDE, BAD_OVERRIDE_TYPE
from cnc_ptp.protocol.axis_states import AxisStateCode as S

OVERRIDE_DECIMALS = 4
"""Of the percentage: 100 % are 1,000,000 steps."""
OVERRIDE_TYPES = (1, 2, 3, 4)


class OverrideCommands:
    """`set_override`, `set_override_type`."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis

    @property
    def highest(self) -> float:
        return min(100.0, self._axis.parameters.max_override_percent)

    def check(self, command: str, percent: float) -> None:
        """Raises 23006 for an override that the axis does not have."""
        if not 0.0 <= percent <= self.highest:
            reason = f"percent = {percent} is not within 0 ... {self.highest:g} (P-AXIS-00109, at most 100)"
            self._axis.refuse(command, BAD_OVERRIDE, reason, percent=percent, limit=self.highest)

    def do_set_override(self, cycle: int, *, percent: float) -> str | None:
        """Override of PTP motion, 0 … 100 % rounded to 0.0001 %, through the filter if there is one."""
        axis = self._axis
        self.check("set_override", percent)
        used = axis.override_filter.take(cycle, round(percent, OVERRIDE_DECIMALS))
        if used is None or axis.set_override(cycle, used) or axis.state not in (S.DISCRETE_MOTION, S.STOPPING):
            return None
        if axis.ptp.job is None and axis.ptp.finished(cycle):
            return None  # only a superimposed motion is left, which has no override
        reason = "the axis stops" if axis.ptp.job is None else "brake phase or level out of reach"
        reason = "a trajectory keeps its times" if axis.ptp.follows else reason
        return f"axis {axis.name}: override {percent} % does not change the active motion ({reason})"

    def do_set_override_type(self, cycle: int, *, type: int) -> None:
        """1 reduced, 2 original, 3 and 4 the same iterated; counts from the next override or start on."""
        if type not in OVERRIDE_TYPES:
            reason = f"type = {type} is not one of 1, 2, 3, 4"
            self._axis.refuse("set_override_type", BAD_OVERRIDE_TYPE, reason, type=type)
        self._axis.ptp.override_type = type
