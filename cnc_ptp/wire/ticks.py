"""Ticks of the clock as messages (CDR) and back."""

from __future__ import annotations

import struct
from functools import cache
from typing import Any, NamedTuple

from cnc_ptp.wire.layout import ENCAPSULATION
from cnc_ptp.wire.schemas import decoder_of, load_schema
from cnc_ptp.wire.unreadable import unreadable

_TICK = struct.Struct("<4siIIs3xQI4xq")
"""Encapsulation, stamp, empty frame_id, first cycle, count, scheduled time: a CycleTick message."""
_HEAD = struct.Struct("<4siII")
"""Encapsulation, stamp, length of the frame_id."""


class Tick(NamedTuple):
    """A tick with what only its message holds (CycleTick.msg)."""

    first_cycle: int
    count: int  # type: ignore[assignment]  # tuple.count is not wanted here
    scheduled_monotonic_ns: int
    stamp_ns: int


def encode_tick(first_cycle: int, count: int, scheduled_monotonic_ns: int, stamp_ns: int) -> bytes:
    seconds, nanoseconds = divmod(stamp_ns, 1_000_000_000)
    return _TICK.pack(ENCAPSULATION, seconds, nanoseconds, 1, b"\0", first_cycle, count, scheduled_monotonic_ns)


def decode_tick(data: bytes) -> Tick:
    """Of any clock; headers of ours have no frame_id. Raises CncError 26184 for bytes that are no tick."""
    try:
        return _decoded(data)
    except Exception as error:  # whatever the generated decoder raises
        raise unreadable("CycleTick", data, error) from error


def _decoded(data: bytes) -> Tick:
    _, seconds, nanoseconds, text_size = _HEAD.unpack_from(data)
    if text_size == 1:
        _, _, _, _, _, first_cycle, count, scheduled = _TICK.unpack_from(data)
    else:
        message = _decoder()(data)
        first_cycle, count, scheduled = message.first_cycle, message.count, message.scheduled_monotonic_ns
    return Tick(first_cycle, count, scheduled, seconds * 1_000_000_000 + nanoseconds)


@cache
def _decoder() -> Any:
    return decoder_of(load_schema("cnc_ptp/msg/CycleTick"))
