"""How recordings are written: compression, parts, files that go along."""

from __future__ import annotations

import re
import zlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import lz4.frame
import zstandard

from cnc_ptp.errors import CncError

BAD_SPLIT = 26019
COMPRESSIONS = ("zstd", "lz4", "none")
SIZES = {"KB": 1e3, "MB": 1e6, "GB": 1e9, "KiB": 2**10, "MiB": 2**20, "GiB": 2**30}
"""Unit of a size -> bytes."""
TIMES = {"s": 1.0, "min": 60.0, "h": 3600.0}
FORM = re.compile(r"(?P<number>\d+(?:\.\d+)?) ?(?P<unit>[A-Za-z]+)")
EXAMPLES = "500MB or 10min"


@dataclass(frozen=True, slots=True)
class Split:
    """When a recording continues in another file: after so many bytes or seconds of the machine; 0: not for that."""

    size: float = 0.0
    seconds: float = 0.0


def read_split(text: str) -> Split:
    """`500MB`, `10min`. Raises CncError 26019."""
    found = FORM.fullmatch(text.strip())
    unit = found["unit"] if found else ""
    if found is None or unit not in (*SIZES, *TIMES):
        known = ", ".join((*SIZES, *TIMES))
        raise _refusal(text, f"it is not a number with one of the units {known}, as {EXAMPLES}")
    number = float(found["number"])
    if number == 0.0:
        raise _refusal(text, f"a part must hold something, as {EXAMPLES}")
    return Split(size=number * SIZES[unit]) if unit in SIZES else Split(seconds=number * TIMES[unit])


def _refusal(text: str, reason: str) -> CncError:
    return CncError(BAD_SPLIT, reason, "nothing was started", where=f"--split '{text}'")


@dataclass(frozen=True, slots=True)
class Settings:
    """`files`: name -> text, kept in the recording beside the machine file."""

    compression: str = "zstd"
    split: Split | None = None
    files: Mapping[str, str] = field(default_factory=dict)


def compressor(compression: str, level: int) -> Callable[[list[Any], int], tuple[bytes, int]]:
    """A function: parts of a chunk and their size -> compressed bytes and the CRC of the parts, which are given free.

    `level`: of zstd.
    """
    zstd = zstandard.ZstdCompressor(level=level)

    def compress(parts: list[Any], size: int) -> tuple[bytes, int]:
        crc, compressed = 0, []
        stream: Any = zstd.compressobj(size=size) if compression == "zstd" else lz4.frame.LZ4FrameCompressor()
        if compression == "lz4":
            compressed.append(stream.begin(size))
        for part in emptied(parts):
            compressed.append(bytes(part) if compression == "none" else stream.compress(part))
            crc = zlib.crc32(part, crc)
        compressed.append(b"" if compression == "none" else stream.flush())
        return b"".join(compressed), crc

    return compress


def emptied(parts: list[Any]) -> Iterable[Any]:
    """The parts one by one; nobody else keeps them."""
    parts.reverse()
    while parts:
        yield parts.pop()
