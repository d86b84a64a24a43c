"""Function blocks of a setpoint generator of the PLC's own (TX1250 2.6, 4.1)."""

from __future__ import annotations

from cnc_ptp.axis.external import ABSOLUTE
from cnc_ptp.plc.plcopen.execute_block import ExecuteBlock
from cnc_ptp.plc.plcopen.unit_reference import UnitReference
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.blocks import AxisBlock

ExternalState = tuple[float, float, float, int]
"""Position, velocity, acceleration and direction in a cycle."""


class SwitchBlock(ExecuteBlock):
    """Switches the external setpoints of an axis."""

    waits_for_job = False

    @property
    def enabled(self) -> bool:
        """External setpoints are enabled, as the axis reports."""
        block = self.unit.block
        return isinstance(block, AxisBlock) and bool(block.status_bits[-1] & StatusBit.EXT_SETPOINT)


class MC_ExtSetPointGenEnable(SwitchBlock):
    """External setpoints move the axis from now on; `position` is where they end, if it is to be monitored."""

    def __call__(self, execute: bool, mode: str = ABSOLUTE, position: float | None = None) -> None:
        if self._rises(execute):
            self._start("external_enable", mode=mode, target=position)


class MC_ExtSetPointGenDisable(SwitchBlock):
    """External setpoints end; an axis that still moves comes to rest on its own ramp."""

    moves = False

    def __call__(self, execute: bool) -> None:
        if self._rises(execute):
            self._start("external_disable")


class MC_ExtSetPointGenFeed:
    """Gives the setpoints of the next cycle block; called in each PLC cycle in which there are some."""

    def __init__(self, unit: UnitReference) -> None:
        self.unit = unit
        self.error = False
        self.error_id = 0
        self.error_text = ""
        self._ticket = 0

    def __call__(self, *setpoints: ExternalState) -> None:
        """Position, velocity, acceleration, direction of the cycles that come next, one for each or fewer.

        Between two of them, and after the last one, the axis continues at velocity and acceleration. Direction 0 ends
        the motion.
        """
        self._look()
        if setpoints:
            first = next_cycle(self.unit)
            rows = [[first + index, *setpoint] for index, setpoint in enumerate(setpoints)]
            self._ticket = self.unit.give("external_setpoints", setpoints=rows)

    def _look(self) -> None:
        """An error is that of the setpoints of the call before."""
        answer = self.unit.answer(self._ticket) if self._ticket else None
        self.error_id = answer.error_id if answer is not None else 0
        self.error_text = answer.message if answer is not None and answer.error_id else ""
        self.error = self.error_id != 0


def next_cycle(unit: UnitReference) -> int:
    """The first cycle of the block that comes next."""
    block = unit.block
    return 0 if block is None else block.first_cycle + block.count
