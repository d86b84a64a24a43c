"""A file that is written must not be one of those that are read for it."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from mcap.writer import MCAP0_MAGIC

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import machine_files

OVERWRITES = 26117
MACHINE_FILE = "machine_file"
"""The input whose own files must not be overwritten either."""


def check_recording(record: str | None, **inputs: str | None) -> None:
    """Raises CncError 26117 when the recording of a run is one of its inputs, each by its kind: machine_file="…".

    As well when it would take the place of a file that is no recording.
    """
    if record is None:
        return
    if Path(record).exists() and (what := overwritten(record, inputs)):
        raise CncError(OVERWRITES, f"recording {record} would overwrite the {what}", "nothing was started")
    require_recording(record, "nothing was started")


def require_recording(output: str | Path, effect: str) -> None:
    """Raises CncError 26117 where `output` is a file with contents that is no recording."""
    with suppress(OSError):  # writing it says why
        if Path(output).is_file() and first_bytes(Path(output)) not in (b"", MCAP0_MAGIC):
            raise CncError(OVERWRITES, f"recording {output} would overwrite a file that is no recording", effect)


def first_bytes(file: Path) -> bytes:
    """As many as the mark of a recording has. Raises OSError."""
    with file.open("rb") as opened:
        return opened.read(len(MCAP0_MAGIC))


def overwritten(output: str, inputs: Mapping[str, str | None]) -> str:
    """The input that is the same file as `output`, `machine file mill.yaml`; empty if none is."""
    for what, path in inputs.items():
        if path is None:
            continue
        if _same(Path(output), Path(path)):
            return f"{what.replace('_', ' ')} {path}"
        for named in machine_files(path) if what == MACHINE_FILE else ():
            if _same(Path(output), named):
                return f"file {named} of the machine file {path}"
    return ""


@contextmanager
def replacing(output: str | Path) -> Iterator[Path]:
    """A file beside `output` that takes its place when it is whole; after an error the former one is unchanged.

    A device is written itself.
    """
    file = Path(os.path.realpath(output))  # a link is kept
    if file.exists() and not file.is_file():
        yield file
        return
    part = file.with_name(f".part.{file.name}")
    try:
        yield part
        part.replace(file)
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def no_folder(output: str | Path) -> str:
    """Why a file or a folder cannot be made where its own folder is missing."""
    return f"there is no folder {Path(os.path.realpath(output)).parent}, make it or give another name"


def why_not_made(error: OSError, output: str | Path) -> str:
    """Why `output` cannot be made."""
    missing = isinstance(error, FileNotFoundError) and not Path(os.path.realpath(output)).parent.exists()
    return no_folder(output) if missing else str(error.strerror)


def why_not_written(error: OSError) -> str:
    """Why a file cannot be written: other libraries name the temporary file in their texts."""
    return os.strerror(error.errno) if error.errno else str(error)


def _same(one: Path, other: Path) -> bool:
    """Whether both are one file, or would be: links of either kind count, and files that do not exist yet."""
    return one.resolve() == other.resolve() or (one.exists() and other.exists() and one.samefile(other))
