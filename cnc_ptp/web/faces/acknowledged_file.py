"""Who has acknowledged the alarms of a run: a server that begins later cannot ask the former one."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path

from cnc_ptp.recording.overwriting import replacing

MOST = 1000
"""Alarms in the file, those that were acknowledged last."""
Acknowledged = tuple[str, int, int, str, str]
"""Source, cycle, number and text of an alarm, and the user: two units may have the same alarm in the same cycle."""
FIELDS = [str, int, int, str, str]


class AcknowledgedFile:
    """Of one run; that of another run is not read, and is replaced."""

    def __init__(self, file: Path, start_ns: int) -> None:
        """`start_ns`: the stamp of cycle 0, which no other run has."""
        self._file = file
        self._start_ns = start_ns

    def read(self) -> list[Acknowledged]:
        """Nothing where the file is missing, damaged or of another run: these alarms are open."""
        try:
            content = json.loads(self._file.read_bytes())
            rows = content["acknowledged"] if content["start_ns"] == self._start_ns else []
            return [(s, c, n, t, u) for s, c, n, t, u in rows if [*map(type, (s, c, n, t, u))] == FIELDS]
        except (OSError, ValueError, LookupError, TypeError, RecursionError):
            return []

    def add(self, acknowledged: Sequence[Acknowledged]) -> str:
        """Why it could not be written; empty when it was."""
        rows = [*self.read(), *acknowledged][-MOST:]
        try:
            self._file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            with replacing(self._file) as part:
                part.touch(mode=0o600)
                part.write_text(json.dumps({"start_ns": self._start_ns, "acknowledged": rows}))
        except OSError as error:
            return f"{self._file} cannot be written: {error.strerror}"
        return ""


def file_of_machine(domain: int, namespace: str) -> Path:
    """Where the user keeps such things; each ROS domain and namespace has a machine of its own."""
    folder = os.environ.get("XDG_STATE_HOME") or os.path.expanduser("~/.local/state")
    return Path(folder, "cnc_ptp", f"acknowledged_{domain}{namespace.rstrip('/').replace('/', '.')}.json")
