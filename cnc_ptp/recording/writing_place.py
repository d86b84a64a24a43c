"""Whether a recording can be written somewhere, before anything is done for it."""

from __future__ import annotations

import os
from pathlib import Path

from cnc_ptp.errors import CncError
from cnc_ptp.recording.overwriting import why_not_made

NOT_WRITABLE = 26113
EXISTS = 26192


def require_writable(path: str, *, where: str = "", effect: str = "nothing was started") -> None:
    """Raises CncError 26113 when no file can be made at `path`; an existing file is unchanged until the first tick."""
    file = Path(os.path.realpath(path))  # a link is kept too
    try:
        exists = file.exists()
        with file.open("ab"):
            pass
        if not exists:
            file.unlink()
    except OSError as error:
        raise CncError(
            NOT_WRITABLE, f"recording {path} cannot be written: {why_not_made(error, path)}", effect, where=where
        ) from None


def require_folder(path: str) -> None:
    """The same for a folder in which files will be written; one that does not exist yet is made then.

    Raises CncError 26113.
    """
    folder = Path(path)
    if folder.exists() and not folder.is_dir():
        raise CncError(NOT_WRITABLE, f"recording {path} cannot be written: it is no folder", "nothing was started")
    require_writable(str(folder / ".recorder" if folder.is_dir() else folder))


def require_new(path: str, *, where: str) -> None:
    """Raises CncError 26113, and 26192 for a file that exists: nothing is overwritten while a machine runs."""
    if os.path.lexists(path):
        raise CncError(EXISTS, f"{path} exists", "nothing was changed, choose another name", where=where)
    require_writable(path, where=where, effect="nothing was changed")
