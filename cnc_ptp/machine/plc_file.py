"""Reads a PLC file: Python text with a class Plc that has the method cycle(io)."""

from __future__ import annotations

import inspect
import linecache
import sys
from pathlib import Path
from types import ModuleType
from typing import Any, Final

from cnc_ptp.errors import CncError
from cnc_ptp.machine.program_files import read_file
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc.program.faults import BAD_PLC_FILE, fault_of
from cnc_ptp.plc.program.plc_io import PlcIo
from cnc_ptp.plc.program.plc_program import PlcFile
from cnc_ptp.protocol.unit import PLC

CLASS: Final = "Plc"
METHOD: Final = "cycle"


def read_plc(path: str) -> PlcFile:
    """The class of a file; the modules beside the file can be imported by it.

    Raises CncError 26110 (file) and 25104 (not Python, it raises, no class Plc, no method cycle).
    """
    text = read_file("PLC file", path)
    file = str(Path(path).absolute())
    linecache.checkcache(file)
    folder = str(Path(file).parent)
    if folder not in sys.path:
        sys.path.append(folder)
    module = ModuleType(f"plc_file_{Path(file).stem}")
    module.__file__ = file
    sys.modules[module.__name__] = module
    try:
        exec(compile(text, file, "exec"), module.__dict__)
    except (Exception, SystemExit) as error:
        fault = fault_of(error, file)
        raise refusal(path, fault.reason, fault.line) from None
    plc_class = module.__dict__.get(CLASS)
    if not isinstance(plc_class, type):
        raise refusal(path, f"it has no class {CLASS}")
    if not callable(getattr(plc_class, METHOD, None)):
        raise refusal(path, f"class {CLASS} has no method {METHOD}(self, io)")
    return PlcFile(file, Maker(plc_class))


def check_plc(machine: MachineParameters, path: str | None) -> None:
    """Reads a PLC file, if there is one, and makes its object, as the run will do. Raises as read_plc."""
    if path is not None:
        build_unit(machine, PLC, plc_file=read_plc(path))


class Maker:
    """Makes the object, with `io` where its class takes it."""

    def __init__(self, plc_class: type) -> None:
        self._class: Any = plc_class
        self._takes_io = bool(inspect.signature(plc_class).parameters)

    def __call__(self, io: PlcIo) -> Any:
        return self._class(io) if self._takes_io else self._class()


def refusal(path: str, reason: str, line: int = 0) -> CncError:
    return CncError(BAD_PLC_FILE, reason, "nothing was started", where=f"PLC file {path}", line=line)
