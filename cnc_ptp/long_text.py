"""Texts of any length, in memory once. Not compiled: compiled, a text that grows is copied with each part."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Final

PART: Final = 1 << 20
"""Characters of a file that are read at once."""


def read_text(path: Path) -> str:
    """The text of a file in UTF-8. Raises OSError and UnicodeDecodeError."""
    with path.open(encoding="utf-8") as stream:
        text = ""
        for part in iter(partial(stream.read, PART), ""):
            text += part  # it grows in its place
    return text
