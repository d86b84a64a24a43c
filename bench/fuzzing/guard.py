"""What an input makes a function open, write or start is looked at by an audit hook (PEP 578), which forbids it."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
ON_FILES = {
    **dict.fromkeys(("os.remove", "os.mkdir", "os.rmdir", "os.truncate", "os.chmod", "os.chown", "os.utime"), 1),
    **dict.fromkeys(("os.rename", "os.link", "os.symlink"), 2),
}
"""Event -> how many of its arguments are paths."""
STARTS = ("subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "os.fork", "os.forkpty", "os.startfile")
HARMLESS = ("/dev/null", "/dev/tty")

_folder: list[str] = []
"""Of the input that is tried now."""
_outside: list[str] = []
_hooked: list[bool] = []


@contextmanager
def guarded(folder: Path) -> Iterator[list[str]]:
    """What was tried outside of the folder meanwhile; it is refused with an OSError. Temporary files are within."""
    if not _hooked:
        sys.addaudithook(_look)  # for good: a hook cannot be taken away
        _hooked.append(True)
    _outside.clear()
    _folder.append(f"{folder.resolve()}{os.sep}")
    temporary, tempfile.tempdir = tempfile.tempdir, str(folder.resolve())
    bytecode, sys.dont_write_bytecode = sys.dont_write_bytecode, True  # of modules that an input imports
    try:
        yield _outside
    finally:
        tempfile.tempdir, sys.dont_write_bytecode = temporary, bytecode
        _folder.pop()


def _look(event: str, arguments: tuple[Any, ...]) -> None:
    if not _folder:
        return
    if event == "open":
        path, _mode, flags = arguments
        if isinstance(flags, int) and flags & WRITES:
            _require_inside(event, path)
    elif event in ON_FILES:
        paths = arguments[: ON_FILES[event]]
        folders = [each for each in arguments[ON_FILES[event] :] if isinstance(each, int)][-len(paths) :]
        for place, path in enumerate(paths):
            _require_inside(event, path, folders[place] if place < len(folders) else -1)
    elif event in STARTS:
        _refuse(f"{event} {arguments[:2]!r}")


def _require_inside(event: str, path: Any, folder: int = -1) -> None:
    """`folder`: descriptor of the folder that the path is relative to; -1: the working directory."""
    if isinstance(path, int):
        return  # a descriptor that was opened before
    begin = os.readlink(f"/proc/self/fd/{folder}") if folder >= 0 else os.getcwd()
    name = os.path.abspath(os.path.join(begin, os.fsdecode(path)))
    if event == "open":
        found = os.path.realpath(name)  # where links lead; other events concern the link itself
    else:
        found = os.path.join(os.path.realpath(os.path.dirname(name)), os.path.basename(name))
    within = _folder[-1:]  # none if the input of another thread has ended meanwhile
    if within and not f"{found}{os.sep}".startswith(within[0]) and name not in HARMLESS:
        _refuse(f"{event} {name}")


def _refuse(what: str) -> None:
    _outside.append(what)
    raise PermissionError(1, f"outside of the folder of the inputs: {what}")
