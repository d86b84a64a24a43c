"""Faults of a PLC in a file: which, at which line, and its text there."""

from __future__ import annotations

import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

BAD_PLC_FILE = 25104
"""It cannot be used; nothing was started."""
PLC_RAISED = 22161
PLC_TOO_LONG = 22162
PLC_BEHIND = 22163


class CycleTooLong(BaseException):
    """Raised within a PLC cycle by the node that watches its time; `except Exception` of the PLC does not catch it."""


class CyclesBehind(BaseException):
    """Raised behind a PLC cycle by that node: many cycles have lasted longer than their blocks."""


class PlcFault(NamedTuple):
    """What has ended a PLC in a file."""

    number: int
    reason: str
    line: int


def fault_of(error: BaseException, file: str) -> PlcFault:
    """The fault that an exception out of the file is: its last line there, and what it says."""
    frames: Sequence[traceback.FrameSummary] = traceback.extract_tb(error.__traceback__)
    if isinstance(error, SyntaxError) and error.filename == file:
        return PlcFault(
            PLC_RAISED, f"{place(file, error.lineno or 0, error.text or '')}: {error.msg}", error.lineno or 0
        )
    own = [frame for frame in frames if frame.filename == file]
    line, text = (own[-1].lineno or 0, own[-1].line or "") if own else (0, "")
    where = place(file, line, text)
    if isinstance(error, CycleTooLong):
        return PlcFault(PLC_TOO_LONG, f"{where}: {error}", line)
    if isinstance(error, CyclesBehind):
        return PlcFault(PLC_BEHIND, f"{place(file, 0, '')}: {error}", 0)
    said = f": {error}" if str(error) else ""
    return PlcFault(PLC_RAISED, f"{where}: {type(error).__name__}{said}", line)


def place(file: str, line: int, text: str) -> str:
    """plc.py:12 'x = 1 / 0'"""
    name = Path(file).name
    return f"{name}:{line} '{text.strip()}'" if line else name
