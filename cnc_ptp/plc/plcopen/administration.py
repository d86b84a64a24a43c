"""Function blocks with `execute` that do not move a unit: reset, position, parameters."""

from __future__ import annotations

from cnc_ptp.plc.plcopen.execute_block import ExecuteBlock


class MC_Reset(ExecuteBlock):
    """Leaves ErrorStop; a unit that moves is stopped."""

    moves = False
    waits_for_job = False

    def __call__(self, execute: bool) -> None:
        if self._rises(execute):
            self._start("reset")


class MC_SetPosition(ExecuteBlock):
    """The present position is called `position`, or (`relative`) is shifted by it; nothing moves."""

    moves = False
    waits_for_job = False

    def __call__(self, execute: bool, position: float = 0.0, relative: bool = False) -> None:
        if self._rises(execute):
            self._start("set_position", position=position, relative=relative)


class MC_WriteParameter(ExecuteBlock):
    """Changes a parameter at run time, in the unit of its list; few can be changed."""

    moves = False
    waits_for_job = False

    def __call__(self, execute: bool, parameter: str = "", value: float = 0.0) -> None:
        if self._rises(execute):
            self._start("write_parameter", parameter=parameter, value=value)
