"""The motion of every recording that a test makes is checked (cnc_ptp.recording.motion_check).

Not checked are files that are longer than LARGEST, and what the checker refuses to read for a reason that tests have:
files that are damaged or cut, those of other programs, and blocks of random numbers without the parameters of a machine.
How many these were, and why, is in the summary of the test run. Any other refusal is a failure.
"""

from __future__ import annotations

import os
import time
from collections import Counter
from pathlib import Path

from cnc_ptp.errors import CncError
from cnc_ptp.recording.motion_check.check import check_recording

RECENT = 6
"""Folders that are looked through after each test."""
LARGEST = 64_000_000
"""Bytes of a recording that is checked: a longer one would take longer than its test."""
REFUSED = frozenset({25001, 25005, 26002, 26003, 26005, 26016, 26017, 26206, 26224, 26262, 26263, 26264})
"""Numbers that tests come to: a machine file that is none (25001, 25005); files that are damaged, foreign, newer or cut
(26002 … 26224); without setpoints (26262), without what is checked against (26263, 26264).
"""
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
        self.folders: list[Path] = []
        """In the order in which tests got them; the last ones are those of the test, and what its module has made."""
        self._known: dict[Path, tuple[int, int]] = {}
        self.checked = 0
        self.refused: Counter[int] = Counter()
        """By error number."""
        self.large = 0
        """Those that were too long to be checked."""

    def new_files(self) -> list[Path]:
        """Recordings of the last folders that were written since the last call."""
        return self._new_files(self.folders[-RECENT:], ended=False)

    def all_new_files(self) -> list[Path]:
        """Those of all folders: at the end nobody writes any more."""
        return self._new_files(self.folders, ended=True)

    def forget(self, known: int) -> None:
        """Nobody looks again at folders that came after the first `known`."""
        del self.folders[known:]

    def _new_files(self, folders: list[Path], *, ended: bool) -> list[Path]:
        files = [path for folder in folders for path in sorted(folder.rglob("*.mcap")) if path.is_file()]
        return [path for path in files if self._is_new(path, ended)]

    def _is_new(self, path: Path, ended: bool) -> bool:
        about = path.stat()
        if not ended and is_being_written(path, about.st_mtime):
            return False
        stamp = about.st_mtime_ns, about.st_size
        if self._known.get(path) == stamp:
            return False
        self._known[path] = stamp
        self.large += about.st_size > LARGEST
        return about.st_size <= LARGEST

    def violations(self, files: list[Path]) -> list[str]:
        """Of these recordings, a text for each one that has some."""
        return [text for text in map(self._of_file, files) if text]

    def _of_file(self, path: Path) -> str:
        try:
            result = check_recording(path)
        except CncError as error:
            self.refused[error.number] += 1
            return "" if error.number in REFUSED else f"{path}: its motion was not checked: {error}"
        self.checked += 1
        return "" if result.clean else result.text()

    def summary(self) -> str:
        """A line for the end of the test run."""
        why = ", ".join(f"{number} x P-ERR-{error}" for error, number in sorted(self.refused.items()))
        large = f"{self.large} above {LARGEST // 1_000_000} MB" if self.large else ""
        unchecked = ", ".join(filter(None, (why, large)))
        return f"motion of {self.checked} recordings checked" + (f"; not of {unchecked}" if unchecked else "")
