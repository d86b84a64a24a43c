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
MOST_STATES = 64 * 2**20
"""Bytes of checkpoints."""
OBJECT = 400
"""Bytes of a command or an event that is not compressed, besides its texts."""
BATCH = 256
"""Commands and events that are compressed together …"""
LEVEL = 3
"""… with this level of zstd: an override takes some 15 bytes."""
EVENT, COMMAND = 0, 1
TICK, BLOCK, RAW = "tick", "encoded_block", "raw"
"""Methods of Recording."""
StatesOfUnits = dict[str, bytes]
"""By unit; that of all units together has no name."""


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

    @property
    def oldest(self) -> int:
        """The cycle of the oldest item, 0 without any."""
        return self._items[0].cycle if self._items else 0

    def first_whole(self, units: Iterable[str]) -> int | None:
        """The first cycle of which a block of every unit is kept; None if there is none."""
        first: dict[str, int] = {}
        for item in self._items:
            if item.method == BLOCK:
                first[item.arguments[0]] = min(item.cycle, first.get(item.arguments[0], item.cycle))
        return max(first.values()) if first and set(units) <= set(first) else None

    def begin_of_block(self, cycle: int) -> int:
        """The first cycle of the block in which `cycle` is."""
        return max((first for first in self._first_cycles() if first <= cycle), default=cycle)

    def end_of_block(self, cycle: int, newest: int) -> int:
        """The first block that begins at or after `cycle` begins there; `newest` if none is kept."""
        return min((first for first in self._first_cycles() if first >= cycle), default=newest)

    def _first_cycles(self) -> Iterator[int]:
        """Of the blocks, by their ticks."""
        return (item.cycle for item in self._items if item.method == TICK)

    def between(self, begin: int, end: int) -> list[Item]:
        """In the order in which they came; `end` is excluded."""
        return [item for item in self._items if begin <= item.cycle < end]


class LastStates:
    """Checkpoints of the last seconds, and the newest whole one before them: a replay of these seconds begins there."""

    def __init__(self, units: Iterable[str], most_bytes: int = MOST_STATES) -> None:
        self._units, self._most = frozenset(units), most_bytes
        self._states: dict[int, StatesOfUnits] = {}

    def add(self, cycle: int, unit: str, state: bytes) -> None:
        """The state before `cycle`: of a unit, or of all without a name."""
        self._states.setdefault(cycle, {})[unit] = state

    def forget(self, before: float) -> None:
        """Those that are older, but for the newest whole one; and the oldest when there are too many."""
        begin = self._newest_whole(before)
        self._states = {cycle: of for cycle, of in self._states.items() if cycle >= before or cycle == begin}
        size = sum(len(state) for of in self._states.values() for state in of.values())
        for cycle in sorted(self._states)[:-1]:
            if size > self._most:
                size -= sum(map(len, self._states.pop(cycle).values()))

    def between(self, begin: int, end: int) -> dict[int, StatesOfUnits]:
        """Whole ones: from the newest at or before `begin` to that at `end`, by cycle."""
        first = max(0, self._newest_whole(begin))
        return {cycle: dict(self._states[cycle]) for cycle in self._whole() if first <= cycle <= end}

    def _newest_whole(self, cycle: float) -> int:
        """At or before a cycle; -1 if there is none."""
        return max((each for each in self._whole() if each <= cycle), default=-1)

    def _whole(self) -> list[int]:
        """Cycles with a state of every unit."""
        return sorted(cycle for cycle, of in self._states.items() if "" in of or self._units <= of.keys())


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
