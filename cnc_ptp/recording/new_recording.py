"""A recording that takes the place of a file when it is whole: until then the former one is unchanged."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from errno import EISDIR
from pathlib import Path
from tempfile import TemporaryDirectory

from cnc_ptp.errors import CncError
from cnc_ptp.recording.mcap_file import NOT_WRITTEN
from cnc_ptp.recording.overwriting import why_not_made

NOTHING_WRITTEN = "nothing was written"


@contextmanager
def in_place_of(output: Path) -> Iterator[Path]:
    """Where to write the recording `output`: in a folder beside it. A device is written itself.

    Raises CncError 26007 of `output` where it cannot be written.
    """
    target = Path(os.path.realpath(output))  # a link is kept
    if target.is_dir():
        raise not_written(output, os.strerror(EISDIR))
    if target.exists() and not target.is_file():
        yield target
        return
    with ExitStack() as stack:
        with said_of(output):
            part = stack.enter_context(folder_beside(output))
        yield part
        with said_of(output):
            os.replace(part, target)


@contextmanager
def said_of(output: Path) -> Iterator[None]:
    """Raises CncError 26007 of `output` instead of an OSError."""
    try:
        yield
    except OSError as error:
        raise not_written(output, why_not_made(error, output)) from error


@contextmanager
def folder_beside(output: Path) -> Iterator[Path]:
    """The name of `output` in a folder beside it, which is removed at the end: what is written there has to be moved.

    Raises CncError 26007 of `output` where there is no room for it, OSError where there can be no folder.
    """
    target = Path(os.path.realpath(output))
    with TemporaryDirectory(prefix=".part.", dir=target.parent) as folder:
        try:
            yield Path(folder) / target.name
        except CncError as error:
            if error.number != NOT_WRITTEN:
                raise
            raise not_written(output, error.reason.rpartition(": ")[2]) from error


def not_written(output: Path, why: str) -> CncError:
    return CncError(NOT_WRITTEN, f"recording {output} cannot be written: {why}", NOTHING_WRITTEN)
