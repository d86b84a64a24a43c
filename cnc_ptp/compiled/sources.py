"""The sources that are compiled: all between program text and setpoint."""

from __future__ import annotations

import hashlib
import json
import os
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

ROOMS = ("motion", "path", "kinematics", "nc", "axis", "spindle", "control", "channel", "plc", "machine", "protocol")
LEFT_OUT = ("nc/faults.py", "plc/plcopen")
"""Exceptions take the values of their text as keywords, which mypyc mixes up with its own; function blocks are called
with arguments of their own each, which it does not permit where one overrides another."""

PACKAGE = Path(__file__).parent.parent
LIBRARY = PACKAGE / "compiled" / "library"
"""Folder of what is built: the library, and the state of the sources that it was built from."""
NAME = "cnc_ptp_kernel__mypyc"
"""Module name of the library; the ending is mypyc's."""
FAILURE = "failure"


def sources() -> dict[str, Path]:
    """Module name -> file. Packages themselves (`__init__`) hold no code and are not among them."""
    left_out = tuple(PACKAGE / name for name in LEFT_OUT)
    files = [file for room in ROOMS for file in sorted((PACKAGE / room).rglob("*.py"))]
    compiled = (file for file in files if not any(file.is_relative_to(place) for place in left_out))
    chosen = [file for file in compiled if file.name != "__init__.py"]
    return {".".join(file.relative_to(PACKAGE.parent).with_suffix("").parts): file for file in chosen}


def recipe() -> dict[str, Path]:
    """What decides how they are compiled."""
    return {f"cnc_ptp.compiled.{name}": PACKAGE / "compiled" / f"{name}.py" for name in ("build", "sources")}


def hashes(files: dict[str, Path]) -> dict[str, str]:
    return {name: hashlib.blake2b(file.read_bytes(), digest_size=16).hexdigest() for name, file in files.items()}


def library_file(folder: Path) -> Path:
    """One for each version of Python and kind of computer."""
    return folder / f"{NAME}{EXTENSION_SUFFIXES[0]}"


def state_file(folder: Path) -> Path:
    """Beside the library."""
    return library_file(folder).with_suffix(".json")


def read_state(folder: Path) -> dict[str, str]:
    """Hashes of the sources that a library was built from, by module; or why it could not be, as FAILURE."""
    try:
        state: dict[str, str] = json.loads(state_file(folder).read_text())
    except (OSError, ValueError):
        return {}
    return state


def write_state(folder: Path, state: dict[str, str]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    file = state_file(folder)
    beside = file.with_suffix(f".{os.getpid()}")
    beside.write_text(json.dumps(state, indent=1))
    os.replace(beside, file)  # whoever reads it has the old or the new one
