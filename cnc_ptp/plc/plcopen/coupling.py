"""Function blocks that couple an axis or spindle to a master."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan
from numbers import Real
from typing import Any

from cnc_ptp.plc.plcopen.execute_block import EndlessBlock, ExecuteBlock
from cnc_ptp.plc.plcopen.faults import CAME_TO_REST, NOT_GRANTED
from cnc_ptp.plc.plcopen.unit_reference import UnitReference
from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.blocks import AxisBlock, SpindleBlock
from cnc_ptp.protocol.commands import BAD_ARGUMENT, is_finite

Master = UnitReference | str
SPEED_BAND = 1e-3
"""Part of the speed of a master by which its slave may differ, as P-AXIS-00217 has it without a value."""


def name_of(master: Master | None) -> str:
    """Empty for what is no unit."""
    return master if isinstance(master, str) else str(getattr(master, "name", ""))


class SlaveBlock(EndlessBlock):
    """A block that makes its unit a slave."""

    def __init__(self, unit: UnitReference) -> None:
        super().__init__(unit)
        self._master = ""
        self._master_unit: UnitReference | None = None
        self._ratio = 1.0

    def _couple(self, command: str, master: Master, **arguments: Any) -> None:
        self._master_unit = None if isinstance(master, str) else master
        self._master = name_of(master)
        if not self._master:
            block = type(self).__name__
            self._fail(BAD_ARGUMENT, f"{self._where}: {block} refused: master is not given; nothing was changed")
            return
        self._start(command, master=self._master, **arguments)

    def _while_active(self) -> None:
        block = self.unit.block
        follows = isinstance(block, AxisBlock) and block.state[-1] == AxisStateCode.SYNCHRONIZED_MOTION
        self._reached = follows and isinstance(block, AxisBlock) and block.master == self._master

    def _follow_unit(self) -> None:
        """The coupling of a spindle is no job: the PLC grants it, and the block of the spindle names its master."""
        block = self.unit.block
        if not isinstance(block, SpindleBlock) or block.master_wanted == self._master:
            return
        if block.master == self._master:
            self.active, self._reached = True, self._turns_along(block)
        elif self.active:
            self._abort()
        else:
            self._fail(NOT_GRANTED, f"{self._where}: {self._master} was not granted as its master")

    def _turns_along(self, block: SpindleBlock) -> bool:
        """The spindle has its speed, which is that of its master times the ratio, as far as that is known here."""
        master = None if self._master_unit is None else self._master_unit.block
        if not (block.speed_reached[-1] and isinstance(master, SpindleBlock)):
            return block.speed_reached[-1]
        wanted = self._ratio * master.set_speed_rpm[-1]
        return abs(block.set_speed_rpm[-1] - wanted) <= SPEED_BAND * abs(wanted)

    def _job_done(self) -> None:
        """The axis could not follow its master, or its coupling has ended."""
        self._fail(CAME_TO_REST, f"{self._where}: its coupling to {self._master} has ended without a command")


class MC_GearIn(SlaveBlock):
    """Couples the unit to a master with a ratio: it moves by numerator / denominator times the way of the master.

    An axis that is the linear slave of this master already takes the new ratio over, in motion too.
    """

    def __init__(self, unit: UnitReference) -> None:
        super().__init__(unit)
        self._coupling_job = 0
        """Of the coupling whose ratio is changed."""

    @property
    def in_gear(self) -> bool:
        return self._reached

    def __call__(
        self, execute: bool, master: Master = "", ratio_numerator: float = 1.0, ratio_denominator: float = 1.0
    ) -> None:
        if not self._rises(execute):
            return
        terms = {"ratio_numerator": ratio_numerator, "ratio_denominator": ratio_denominator}
        wrong = next((name for name, value in terms.items() if not (isinstance(value, Real) and is_finite(value))), "")
        if wrong:
            reason = f"{wrong} = {terms[wrong]!r:.60} is not a finite number"
            self._fail(BAD_ARGUMENT, f"{self._where}: MC_GearIn refused: {reason}; nothing was changed")
            return
        self._ratio = ratio_numerator / ratio_denominator if ratio_denominator else nan
        if self.unit.kind == "spindle":
            self._couple("couple", master, factor_num=ratio_numerator, factor_den=ratio_denominator)
        elif not ratio_denominator:
            reason = f"ratio_denominator = {ratio_denominator} must be different from 0"
            self._fail(BAD_ARGUMENT, f"{self._where}: MC_GearIn refused: {reason}; nothing was changed")
        else:
            self._gear_axis(master, self._ratio)

    def _gear_axis(self, master: Master, factor: float) -> None:
        block, name = self.unit.block, name_of(master)
        engaged = isinstance(block, AxisBlock) and block.state[-1] == AxisStateCode.SYNCHRONIZED_MOTION
        if engaged and isinstance(block, AxisBlock) and block.master == name:
            self._master, self._coupling_job = name, block.job
            self._start("set_coupling_factor", factor=factor)
        else:
            self._couple("couple", master, factor=factor)

    def _follow_unit(self) -> None:
        """A new ratio is no job: the job of the coupling is followed."""
        if self.unit.kind == "spindle":
            super()._follow_unit()
        elif self._coupling_job:
            self._job, self._coupling_job = self._coupling_job, 0
            self._follow_job()


class MC_CamIn(SlaveBlock):
    """Couples an axis to a master by a cam table: points [master, slave], master ascending."""

    @property
    def in_sync(self) -> bool:
        return self._reached

    def __call__(
        self,
        execute: bool,
        master: Master = "",
        cam_table: Sequence[Sequence[float]] = (),
        periodic: bool = True,
        master_offset: float | None = None,
        slave_offset: float | None = None,
        master_scaling: float | None = None,
        slave_scaling: float | None = None,
    ) -> None:
        if not self._rises(execute):
            return
        points = [[float(value) for value in point] for point in cam_table]
        shift = {"master_offset": master_offset, "slave_offset": slave_offset}
        scaling = {"master_scaling": master_scaling, "slave_scaling": slave_scaling}
        self._couple("couple_cam", master, table=points, cyclic=periodic, **shift, **scaling)


class MC_GearOut(ExecuteBlock):
    """Ends the coupling. An axis that moves continues at its velocity until another command."""

    waits_for_job = False

    def __call__(self, execute: bool) -> None:
        if self._rises(execute):
            self._start("decouple")


class MC_CamOut(MC_GearOut):
    """Ends the coupling by a cam table, as MC_GearOut."""
