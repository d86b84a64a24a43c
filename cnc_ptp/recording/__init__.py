"""Recordings: written, read, compared. `cnc_ptp.recording.open(path)` gives what is in one as columns and tables."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cnc_ptp.recording.opened import OpenRecording


def open(path: str | Path) -> OpenRecording:
    """A recording, or a folder with its files, to read from: see OpenRecording."""
    from cnc_ptp.recording.opened import OpenRecording  # later: every module of this folder imports this one

    return OpenRecording(path)
