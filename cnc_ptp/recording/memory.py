"""What a recorder keeps in memory: the last seconds of a machine, and what a run can be computed again from."""

from __future__ import annotations

import marshal
from collections import deque
from collections.abc import Collection, Iterable, Iterator
from itertools import chain
from typing import Any, NamedTuple

import zstandard

from cnc_ptp.protocol.blocks import CommandRecord, Event, EventValue
from cnc_ptp.recording.writer import Recording

MOST_BYTES = 256 * 2**20
"""Of the last seconds; the oldest are forgotten before more are kept."""
MOST_COMMANDS = 64 * 2**20
"""Bytes of commands and events since the start of a run."""
OBJECT = 400
"""Bytes of a command or an event that is not compressed, besides its texts."""
BATCH = 256
"""Commands and events that are compressed together …"""
LEVEL = 3
"""… with this level of zstd: an override takes some 15 bytes."""
EVENT, COMMAND = 0, 1
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
    """Commands and events since the start of a run: whoever has them all and the machine file can compute it again.

    They are kept compressed: a PLC that changes four values in each block commands 1.4 million times per hour.
    """

    def __init__(self, most_bytes: int = MOST_COMMANDS) -> None:
        self._most = most_bytes
        self._batches: deque[_Batch] = deque()
        self._newest: deque[CommandRecord | Event] = deque()
        """Not compressed yet."""
        self._size = 0
        self.forgotten = -1
        """Cycle of the last one that was dropped."""

    def add(self, record: CommandRecord | Event) -> None:
        self._newest.append(record)
        self._size += _size(record)
        if len(self._newest) == BATCH:
            self._compress()
        while self._size > self._most:
            self._forget()

    def before(self, end: int) -> list[CommandRecord | Event]:
        kept = (record for batch in self._batches for record in batch.records())
        return [record for record in chain(kept, self._newest) if record.cycle < end]

    def _compress(self) -> None:
        batch = _Batch.of(self._newest)
        self._size += len(batch.packed) - sum(_size(record) for record in self._newest)
        self._batches.append(batch)
        self._newest.clear()

    def _forget(self) -> None:
        """The oldest batch, or the oldest one of all."""
        if self._batches:
            batch = self._batches.popleft()
            self._size -= len(batch.packed)
            self.forgotten = batch.last_cycle
        else:
            oldest = self._newest.popleft()
            self._size -= _size(oldest)
            self.forgotten = oldest.cycle


class _Batch(NamedTuple):
    """Commands and events, compressed."""

    last_cycle: int
    packed: bytes

    @classmethod
    def of(cls, records: Collection[CommandRecord | Event]) -> _Batch:
        rows = [_event_row(each) if isinstance(each, Event) else _command_row(each) for each in records]
        return cls(max(each.cycle for each in records), zstandard.compress(marshal.dumps(rows), LEVEL))

    def records(self) -> Iterator[CommandRecord | Event]:
        for of, *fields in marshal.loads(zstandard.decompress(self.packed)):
            yield _event_of(*fields) if of == EVENT else CommandRecord(*fields)


def _command_row(record: CommandRecord) -> tuple[Any, ...]:
    head = COMMAND, record.cycle, record.target, record.command, record.arguments_json
    answer = record.accepted, record.error_id, record.message, record.id, {**record.values}
    return *head, *answer, record.job, record.warning_id


def _event_row(event: Event) -> tuple[Any, ...]:
    head = EVENT, event.cycle, event.source, int(event.severity), event.error_id, event.text, event.line
    return *head, [tuple(value) for value in event.values]


def _event_of(cycle: int, source: str, severity: int, error_id: int, text: str, line: int, values: list[Any]) -> Event:
    return Event(cycle, source, severity, error_id, text, line, [EventValue(*value) for value in values])


def write_record(recording: Recording, record: CommandRecord | Event) -> None:
    if isinstance(record, Event):
        recording.event(record)
    else:
        recording.command(record)


def _size(record: CommandRecord | Event) -> int:
    text = record.text if isinstance(record, Event) else record.arguments_json + record.message
    return OBJECT + len(text)
