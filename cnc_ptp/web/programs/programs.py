"""The folder of NC programs that pages see: nothing outside it is read or written."""

from __future__ import annotations

import os
import re
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

from cnc_ptp.errors import CncError
from cnc_ptp.machine.program_files import read_file
from cnc_ptp.web.numbers import BAD_PROGRAM_NAME, NO_FOLDER, NO_PROGRAM, PROGRAM_EXISTS, TOO_LARGE

SUFFIXES = (".nc", ".ngc", ".cnc", ".tap", ".mpf", ".spf")
NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+ -]{0,79}")
LARGEST = 32 << 20
"""Bytes of a program."""
NOTHING_WRITTEN = "nothing was written"


class Listed(NamedTuple):
    """A program of the folder; size in bytes."""

    name: str
    size: int


class ProgramFolder:
    """A folder with programs, by their names."""

    def __init__(self, folder: str, *, largest: int = LARGEST) -> None:
        """Raises CncError 26252 where there is no such folder. `largest`: bytes of a program."""
        self._folder = Path(folder).resolve()
        self.largest = largest
        if not self._folder.is_dir():
            raise CncError(NO_FOLDER, f"programs: there is no folder {folder}", "nothing was started")

    def list(self) -> list[dict[str, Any]]:
        """Name and size of all programs, in their order."""
        found = [Listed(file.name, file.stat().st_size) for file in self._folder.iterdir() if self._is_program(file)]
        return [each._asdict() for each in sorted(found)]

    def _is_program(self, file: Path) -> bool:
        return is_name(file.name) and file.is_file() and self._is_inside(file)

    def _is_inside(self, file: Path) -> bool:
        """Whatever a link says."""
        return file.resolve().parent == self._folder

    def path(self, name: str) -> Path:
        """Of a program that is there. Raises CncError 26240, 26242."""
        require_name(name)
        file = self._folder / name
        if not file.is_file() or not self._is_inside(file):
            raise CncError(NO_PROGRAM, f"program '{name}' is not in the program folder", "nothing was read")
        return file

    def place(self, name: str) -> Path:
        """Where a program of this name would be. Raises CncError 26240."""
        require_name(name)
        return self._folder / name

    def text(self, name: str) -> str:
        """Raises CncError 26240, 26242, 26110."""
        return read_file("program", str(self.path(name)))

    def save(self, name: str, content: bytes, *, replace: bool = False) -> Listed:
        """A program that a page has sent; whole or not at all. Raises CncError 26240, 26241, 26257."""
        require_name(name)
        self.require_size(len(content))
        try:
            content.decode()
        except UnicodeDecodeError:
            raise CncError(BAD_PROGRAM_NAME, f"program '{name}' is no text in UTF-8", NOTHING_WRITTEN) from None
        file = self._folder / name
        if file.is_symlink() or (file.exists() and not file.is_file()):
            raise CncError(BAD_PROGRAM_NAME, f"program '{name}' is a link or a folder", NOTHING_WRITTEN)
        if file.exists() and not replace:
            raise CncError(PROGRAM_EXISTS, f"program '{name}' is in the folder already", NOTHING_WRITTEN)
        self._write(file, content)
        return Listed(name, len(content))

    def require_size(self, size: int) -> None:
        """Raises CncError 26241."""
        if size > self.largest:
            text = f"a program of {size} bytes is larger than {self.largest} bytes"
            raise CncError(TOO_LARGE, text, NOTHING_WRITTEN, size=size, limit=self.largest)

    def _write(self, file: Path, content: bytes) -> None:
        number, other = tempfile.mkstemp(dir=self._folder, prefix=".upload-")
        try:
            with os.fdopen(number, "wb") as stream:
                stream.write(content)
            os.chmod(other, 0o644)
            os.replace(other, file)
        except BaseException:
            Path(other).unlink(missing_ok=True)
            raise


def is_name(name: str) -> bool:
    return NAME.fullmatch(name) is not None and name.lower().endswith(SUFFIXES)


def require_name(name: str) -> None:
    """Raises CncError 26240."""
    if not is_name(name):
        form = "up to 80 ASCII letters, digits, blanks and _ . + -, beginning with a letter, digit or _, ending in"
        reason = f"'{name[:80]}' is no name of a program: {form} {', '.join(SUFFIXES)}"
        raise CncError(BAD_PROGRAM_NAME, reason, "nothing was read or written")
