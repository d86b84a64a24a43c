"""The sources that are compiled: all between program text and setpoint."""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path

ROOMS = ("motion", "path", "nc", "axis", "spindle", "control", "channel", "plc", "machine", "protocol")
LEFT_OUT = ("nc/faults.py",)
"""Exceptions: they take the values of their text as keywords, which mypyc mixes up with its own."""

PACKAGE = Path(__file__).parent.parent
LIBRARY = PACKAGE / "compiled" / "library"
"""Folder of what is built: one library, and the state of the sources that it was built from."""
NAME = "cnc_ptp_kernel__mypyc"
"""Module name of the library; the ending is mypyc's."""


def sources() -> dict[str, Path]:
    """Module name -> file. Packages themselves (`__init__`) hold no code and stay as they are."""
    files = [file for room in ROOMS for file in sorted((PACKAGE / room).rglob("*.py")) if file.name != "__init__.py"]
    left_out = [PACKAGE / name for name in LEFT_OUT]
    files = [file for file in files if file not in left_out]
    return {".".join(file.relative_to(PACKAGE.parent).with_suffix("").parts): file for file in files}


def hashes(files: dict[str, Path]) -> dict[str, str]:
    return {name: hashlib.blake2b(file.read_bytes(), digest_size=16).hexdigest() for name, file in files.items()}


def library_state() -> Path:
    """File with the hashes of the sources; one for each version of Python."""
    return LIBRARY / f"{sys.implementation.cache_tag}.json"


def built_hashes() -> dict[str, str] | None:
    """Of the sources that the library was built from; None without a library."""
    try:
        state: dict[str, str] = json.loads(library_state().read_text())
    except (OSError, ValueError):
        return None
    return state
