"""What a sweep has finished, line by line beside its table, so that an interrupted one continues where it was."""

from __future__ import annotations

import fcntl
import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any

from cnc_ptp.commissioning.faults import BAD_OUTPUT
from cnc_ptp.errors import CncError
from cnc_ptp.sweep.faults import NOTHING, OTHER_SWEEP
from cnc_ptp.sweep.results import Row

Description = Mapping[str, Any]
"""What decides all results, by what it is called in messages."""
ENDING = ".journal"
SWEEP = "cnc_ptp sweep"


class Journal:
    """The file `path`: a line with the description, then a line for each row; one process writes it.

    Raises CncError 27030 where it cannot be written, 26182 where it is that of another sweep or one that runs.
    """

    def __init__(self, path: Path, description: Description) -> None:
        self.path = path
        self.rows: dict[int, Row] = {}
        """What was finished before."""
        self._empty = True
        try:
            self._file = path.open("a+", encoding="utf-8")
        except OSError as error:
            raise CncError(BAD_OUTPUT, f"{path} cannot be written: {error.strerror}", NOTHING) from None
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self._file.close()
            raise CncError(OTHER_SWEEP, f"{path} is being written by another sweep", NOTHING) from None
        try:
            self._read(description)
        except CncError:
            self._file.close()
            raise

    def _read(self, description: Description) -> None:
        """Takes over what is whole; a last line that was cut off goes."""
        self._file.seek(0)
        try:
            text = self._file.read()
        except UnicodeDecodeError:
            require_same(str(self.path), None, description)
        begin = json.dumps({SWEEP: ""})[:-3]
        if text[: len(begin)] != begin[: len(text)]:
            require_same(str(self.path), None, description)
        whole = text[: text.rfind("\n") + 1]
        first, *lines = whole.splitlines() or [""]
        if whole:
            require_same(str(self.path), description_of(first), description)
            self.rows = {row.number: row for line in lines if (row := row_of(line)) is not None}
            self._empty = not self.rows
        if len(whole) < len(text):
            self._file.truncate(len(whole.encode()))
        if not whole:
            self._write({SWEEP: description})

    def add(self, row: Row) -> None:
        """Raises CncError 27030 where the disk is full; what was written before stays."""
        self._write({"variant": row})
        self._empty = False

    def _write(self, content: Mapping[str, Any]) -> None:
        try:
            self._file.write(json.dumps(content, ensure_ascii=False) + "\n")
            self._file.flush()
        except OSError as error:
            kept = "what is finished is kept, the same command continues"
            raise CncError(BAD_OUTPUT, f"{self.path} cannot be written: {error.strerror}", kept) from None

    def remove(self) -> None:
        """The table has everything."""
        self.path.unlink(missing_ok=True)

    def __enter__(self) -> Journal:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._empty:
            self.remove()
        with suppress(OSError):  # a disk that is full, which `add` has said
            self._file.close()


def description_of(line: str) -> Description | None:
    """Of the first line of a journal, or of the metadata of a table; None if it is none."""
    try:
        description = json.loads(line)[SWEEP]
    except (ValueError, KeyError, TypeError):
        return None
    return description if isinstance(description, dict) else None


def row_of(line: str) -> Row | None:
    """Of a line of a journal; None for one that is damaged, which is computed again."""
    try:
        number, values, goals, error, message = json.loads(line)["variant"]
        return Row(number, tuple(values), tuple(goals), error, message)
    except (ValueError, KeyError, TypeError):
        return None


def require_same(file: str, found: Description | None, wanted: Description) -> None:
    """Raises CncError 26182 for the file of another sweep, with all that differs."""
    if found is None:
        raise CncError(OTHER_SWEEP, f"{file} is no journal of a sweep", f"{NOTHING}, give another name")
    other = [name for name in {**wanted, **found} if found.get(name) != wanted.get(name)]
    if other:
        differences = ", ".join(difference(name, found.get(name), wanted.get(name)) for name in other)
        raise CncError(OTHER_SWEEP, f"{file} is of another sweep: {differences}", f"{NOTHING}, give another name")


def difference(name: str, before: Any, now: Any) -> str:
    """How a part of two descriptions differs; files are known by the hash of their content."""
    if name.endswith("file"):
        return f"the {name} has another content"
    return f"{name} was {shown(before)}, is {shown(now)}"


def shown(value: Any) -> str:
    if isinstance(value, list):
        return " ".join(map(str, value))
    return "not given" if value is None else str(value)
