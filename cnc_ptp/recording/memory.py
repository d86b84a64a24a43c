"""What a recorder keeps in memory: the last seconds of a machine, and what a run can be computed again from."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from typing import Any, NamedTuple

from cnc_ptp.protocol.blocks import CommandRecord, Event
from cnc_ptp.recording.writer import Recording

MOST_BYTES = 256 * 2**20
"""Of the last seconds; the oldest are forgotten before more are kept."""
MOST_COMMANDS = 64 * 2**20
"""Bytes of commands and events since the start of a run."""
OBJECT = 400
"""Bytes of a command or an event in memory, besides its texts."""
TICK, BLOCK, RAW = "tick", "encoded_block", "raw"
"""Methods of Recording."""


class Item(NamedTuple):
    """A call of a method of Recording."""

    cycle: int
    size: int
    method: str
    arguments: tuple[Any, ...]

    def write(self, recording: Recording) -> None:
        getattr(recording, self.method)(*self.arguments)


class LastSeconds:
    """Ticks, blocks and other messages of the last cycles."""

    def __init__(self, cycles: int, most_bytes: int = MOST_BYTES) -> None:
        self._cycles, self._most = cycles, most_bytes
        self._items: deque[Item] = deque()
        self._size = 0

    def add(self, cycle: int, size: int, method: str, *arguments: Any) -> None:
        self._items.append(Item(cycle, size, method, arguments))
        self._size += size
        oldest = cycle - self._cycles
        while self._items and (self._items[0].cycle < oldest or self._size > self._most):
            self._size -= self._items.popleft().size

    def first_whole(self, units: Iterable[str]) -> int | None:
        """The first cycle of which a block of every unit is kept; None if there is none."""
        first: dict[str, int] = {}
        for item in self._items:
            if item.method == BLOCK:
                first[item.arguments[0]] = min(item.cycle, first.get(item.arguments[0], item.cycle))
        return max(first.values()) if first and set(units) <= set(first) else None

    def begin_of_block(self, cycle: int) -> int:
        """The first cycle of the block in which `cycle` is."""
        return max((item.cycle for item in self._items if item.method == TICK and item.cycle <= cycle), default=cycle)

    def between(self, begin: int, end: int) -> list[Item]:
        """In the order in which they came; `end` is excluded."""
        return [item for item in self._items if begin <= item.cycle < end]


class History:
    """Commands and events since the start of a run: whoever has them all and the machine file can compute it again."""

    def __init__(self, most_bytes: int = MOST_COMMANDS) -> None:
        self._most = most_bytes
        self._records: deque[CommandRecord | Event] = deque()
        self._size = 0
        self.forgotten = -1
        """Cycle of the last one that was dropped."""

    def add(self, record: CommandRecord | Event) -> None:
        self._records.append(record)
        self._size += _size(record)
        while self._size > self._most:
            oldest = self._records.popleft()
            self._size -= _size(oldest)
            self.forgotten = oldest.cycle

    def before(self, end: int) -> list[CommandRecord | Event]:
        return [record for record in self._records if record.cycle < end]


def write_record(recording: Recording, record: CommandRecord | Event) -> None:
    if isinstance(record, Event):
        recording.event(record)
    else:
        recording.command(record)


def _size(record: CommandRecord | Event) -> int:
    text = record.text if isinstance(record, Event) else record.arguments_json + record.message
    return OBJECT + len(text)
