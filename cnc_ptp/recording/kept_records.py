"""Records that are needed when a file is closed: older ones wait in a file without a name on the same disk."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO

PIECE = 1 << 13
"""Bytes in memory from which on they are put away: a recording of a day has 150 MB of them."""


class KeptRecords:
    """Bytes that grow. They stay in memory where the folder takes no file."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._newest = bytearray()
        self._older: IO[bytes] | None = None
        self._size = 0
        """Bytes of the older ones."""

    def __len__(self) -> int:
        return self._size + len(self._newest)

    def add(self, records: bytes | bytearray) -> None:
        self._newest += records
        if len(self._newest) >= PIECE:
            with suppress(OSError):
                self._put_away()

    def _put_away(self) -> None:
        """Raises OSError; then they are all in memory as before."""
        if self._older is None:
            self._older = TemporaryFile(dir=self._folder, buffering=0)  # noqa: SIM115
        self._older.seek(self._size)
        written = self._older.write(self._newest)
        self._size += written
        del self._newest[:written]

    def contents(self) -> bytes:
        """All of them. Raises OSError."""
        if self._older is None:
            return bytes(self._newest)
        self._older.seek(0)
        return self._older.read(self._size) + self._newest

    def close(self) -> None:
        if self._older is not None:
            self._older.close()
