"""Ticks of the clock as messages (CDR) and back."""

from __future__ import annotations

import struct
from typing import NamedTuple

from cnc_ptp.wire.layout import ENCAPSULATION

_TICK = struct.Struct("<4siIIs3xQI4xq")
"""Encapsulation, stamp, empty frame_id, first cycle, count, scheduled time: a CycleTick message."""


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
    """Of a clock of ours, whose headers have no frame_id."""
    _, seconds, nanoseconds, _, _, first_cycle, count, scheduled = _TICK.unpack(data)
    return Tick(first_cycle, count, scheduled, seconds * 1_000_000_000 + nanoseconds)
