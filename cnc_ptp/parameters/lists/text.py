"""The bytes of a list as text. Lists are UTF-8; others are read where their encoding is certain, and that is said."""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator
from typing import Final, NamedTuple

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.errors import Place
from cnc_ptp.parameters.lists.problems import ListProblem

MARKS: Final = (
    (codecs.BOM_UTF8, "utf-8", ""),
    (codecs.BOM_UTF32_LE, "utf-32-le", "UTF-32"),
    (codecs.BOM_UTF32_BE, "utf-32-be", "UTF-32"),
    (codecs.BOM_UTF16_LE, "utf-16-le", "UTF-16"),
    (codecs.BOM_UTF16_BE, "utf-16-be", "UTF-16"),
)
"""Byte order marks with their encodings and what the report says; those of UTF-32 begin like those of UTF-16."""
FOREIGN: Final = re.compile(r"[^\t\x20-\x7e\xa0-\u2027\u202a-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]")
"""Characters that a list cannot hold: control characters, and ends of lines that are none in a list."""


class ListText(NamedTuple):
    """The text of a list; `encoding`: the one that it was read in, if not UTF-8."""

    text: str
    encoding: str = ""


class Unreadable(Exception):
    """Bytes that are no text of a list; carries the reason."""


def decoded(data: bytes) -> ListText:
    """Raises Unreadable."""
    for mark, encoding, name in MARKS:
        if data.startswith(mark):
            return ListText(_decode(data[len(mark) :], encoding, name or "UTF-8"), name)
    if b"\0" in data:
        reason = "it has bytes of zero as UTF-16 has, but no byte order mark; save it as UTF-8, or with the mark"
        raise Unreadable(reason)
    try:
        return ListText(data.decode("utf-8"))
    except UnicodeDecodeError:
        return ListText(_decode(data, "cp1252", "UTF-8 or Latin-1"), "Latin-1 (Windows-1252)")


def _decode(data: bytes, encoding: str, name: str) -> str:
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        raise Unreadable(f"it is not {name} text at byte {error.start}; save it as UTF-8") from None


def split_lines(text: str) -> list[str]:
    """Ends of lines are those of Windows, Unix and old Macs, and no others."""
    return re.split(r"\r\n|\n|\r", text)


def foreign_characters(lines: list[str], file: str) -> Iterator[ListProblem]:
    """The first one of each line that a list cannot hold."""
    for number, line in enumerate(lines, 1):
        if found := FOREIGN.search(line):
            text = f"character U+{ord(found[0]):04X} cannot stand in a list; delete it"
            yield ListProblem(errors.LIST_TEXT, Place(file, number, found.start() + 1), text)
