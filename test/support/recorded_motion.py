"""The motion of every recording that a test makes is checked (cnc_ptp.recording.motion_check).

Not checked is what the checker refuses to read: files that are damaged or cut, those of other programs, and blocks of
random numbers without the parameters of a machine. How many were refused, and why, is in the summary of the test run.
"""

from __future__ import annotations

import os
import time
from collections import Counter, deque
from pathlib import Path

from cnc_ptp.errors import CncError
from cnc_ptp.recording.motion_check.check import check_recording

RECENT = 6
"""Folders that are looked through after each test."""
LARGEST = 64_000_000
"""Bytes of a recording that is checked: a longer one would take longer than its test."""
MAGIC = b"\x89MCAP0\r\n"
"""The last bytes of a recording that is whole."""
SETTLED = 2.0
"""Seconds."""


def is_being_written(path: Path, modified: float) -> bool:
    """A machine that serves many tests still records: its file is checked at its end. One that is cut has settled."""
    with path.open("rb") as stream:
        stream.seek(max(0, stream.seek(0, os.SEEK_END) - len(MAGIC)))
        return stream.read() != MAGIC and time.time() - modified < SETTLED


class RecordedMotion:
    """Looks through the folders that tests get for recordings that are new or were written again."""

    def __init__(self) -> None:
        self.folders: deque[Path] = deque(maxlen=RECENT)
        """The last ones: of the test, and those that its module has made before."""
        self._known: dict[Path, tuple[int, int]] = {}
        self.checked = 0
        self.refused: Counter[int] = Counter()
        """By error number."""

    def new_files(self) -> list[Path]:
        """Recordings of the last folders that were written since the last call."""
        files = [path for folder in self.folders for path in sorted(folder.rglob("*.mcap")) if path.is_file()]
        return [path for path in files if self._is_new(path)]

    def _is_new(self, path: Path) -> bool:
        about = path.stat()
        if is_being_written(path, about.st_mtime):
            return False
        stamp = about.st_mtime_ns, about.st_size
        is_new = self._known.get(path) != stamp
        self._known[path] = stamp
        return is_new and about.st_size <= LARGEST

    def violations(self, files: list[Path]) -> list[str]:
        """Of these recordings, a text for each one that has some."""
        return [text for text in map(self._of_file, files) if text]

    def _of_file(self, path: Path) -> str:
        try:
            result = check_recording(path)
        except CncError as error:
            self.refused[error.number] += 1
            return ""
        self.checked += 1
        return "" if result.clean else result.text()

    def summary(self) -> str:
        """A line for the end of the test run."""
        why = ", ".join(f"{number} x P-ERR-{error}" for error, number in sorted(self.refused.items()))
        return f"motion of {self.checked} recordings checked" + (f"; not of {why}" if why else "")
