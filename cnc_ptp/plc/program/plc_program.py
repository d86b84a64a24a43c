"""Runs a PLC in a file: makes its object, calls it once in each block, and catches what goes wrong in it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext
from typing import Any, NamedTuple

from cnc_ptp.errors import CncError
from cnc_ptp.plc.program.faults import BAD_PLC_FILE, PlcFault, fault_of
from cnc_ptp.plc.program.plc_io import PlcIo
from cnc_ptp.protocol.blocks import CycleBlock, CycleTick


class PlcFile(NamedTuple):
    """The class Plc of a file (machine/plc_file.py reads it)."""

    path: str
    make: Callable[[PlcIo], Any]
    """Gives an object with the method `cycle`."""


class PlcProgram:
    """The object of a PLC file, and the machine as it sees it.

    Raises CncError 25104 when the object cannot be made.
    """

    def __init__(self, file: PlcFile, io: PlcIo) -> None:
        self.io = io
        self.runs = True
        """It is called with each block; not after a fault, or when everything has been stopped."""
        self.guard: AbstractContextManager[object] = nullcontext()
        """Entered for each call; a node measures its time there."""
        self._path = file.path
        try:
            self.plc = file.make(io)
        except BaseException as error:
            if isinstance(error, CncError) and error.number == BAD_PLC_FILE:
                raise
            fault = fault_of(error, file.path)
            raise CncError(
                BAD_PLC_FILE, fault.reason, "nothing was started", where=f"PLC file {file.path}", line=fault.line
            ) from None

    def run(self, tick: CycleTick, blocks: Mapping[str, CycleBlock], lost: Iterable[str]) -> PlcFault | None:
        """One PLC cycle; its commands are in `io`. After a fault it commands nothing, and is not called again."""
        self.io.begin(tick, blocks, lost)
        try:
            with self.guard:
                self.plc.cycle(self.io)
        except BaseException as error:
            self.runs = False
            self.io.take_commands()
            return fault_of(error, self._path)
        return None
