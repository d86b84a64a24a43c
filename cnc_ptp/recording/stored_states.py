"""States that stay in the files of a recording: an hour of them needs the memory of some chunks.

A first pass notes where they lie, as stretches of cycles that follow each other. A cycle number may be wrong anywhere,
so that a state is found again by its cycle, however far from its neighbours it lies.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from mcap.opcode import Opcode

from cnc_ptp.recording.long_recording import picked
from cnc_ptp.recording.mcap_chunks import MessageRun, RawRecord, RecordReader
from cnc_ptp.recording.mcap_file import RECORD_PREFIX
from cnc_ptp.recording.reader import (
    STATE_TYPES,
    THREAD_STATE,
    TICK,
    Names,
    Reader,
    Recorded,
    TopicInfo,
    read_with,
    require_messages,
)
from cnc_ptp.wire.layout import Bytes, Layout, Records

Cycles = npt.NDArray[np.uint64]
Interval = tuple[int, int]
"""First and last cycle."""
KEPT = 16
"""Chunks that are in memory after they were read."""


class Stretch(NamedTuple):
    """Cycles that follow each other in a piece, from its state `place` on."""

    first: int
    last: int
    piece: int
    place: int


class StoredStates:
    """The states of a topic by their cycles, in pieces that are read when they are asked for."""

    def __init__(self, dtype: np.dtype[Any]) -> None:
        self.dtype = dtype
        self._count = 0
        self._pieces: list[Callable[[], Records]] = []
        self._stretches: list[Stretch] = []
        self._sorted: tuple[Cycles, Cycles] | None = None

    @classmethod
    def of_rows(cls, rows: Records) -> StoredStates:
        """Of states (n,) that are in memory."""
        states = cls(rows.dtype)
        states.add(rows["cycle"], lambda: rows)
        return states

    def add(self, cycles: Cycles, read: Callable[[], Records]) -> None:
        """A further piece: the cycles (n,) of its states in their order, and how to read them."""
        if not len(cycles):
            return
        place = 0
        for first, last in intervals_of(cycles):
            self._stretches.append(Stretch(first, last, len(self._pieces), place))
            place += last - first + 1
        self._pieces.append(read)
        self._count += len(cycles)
        self._sorted = None

    def __len__(self) -> int:
        return self._count

    @property
    def first(self) -> int:
        """The lowest cycle."""
        return min(stretch.first for stretch in self._stretches)

    @property
    def last(self) -> int:
        """The highest cycle."""
        return max(stretch.last for stretch in self._stretches)

    def rows(self, first: int, last: int) -> Records:
        """The states of the cycles `first` to `last` in their order; of one cycle in the order of the file."""
        self._sort()
        assert self._sorted is not None
        begins, reach = self._sorted
        places = range(
            int(np.searchsorted(reach, np.uint64(first))), int(np.searchsorted(begins, np.uint64(last), "right"))
        )
        chosen = sorted(
            (stretch.piece, stretch.place, stretch)
            for stretch in map(self._stretches.__getitem__, places)
            if stretch.last >= first
        )
        parts = [self._read(stretch, first, last) for _, _, stretch in chosen]
        found: Records = np.concatenate(parts) if parts else np.empty(0, dtype=self.dtype)
        return found[np.argsort(found["cycle"], kind="stable")] if len(parts) > 1 else found

    def intervals(self) -> Iterator[Interval]:
        """The cycles of which there is a state, in their order."""
        self._sort()
        return joined_intervals((stretch.first, stretch.last) for stretch in self._stretches)

    def repeated(self) -> Iterator[Interval]:
        """The cycles of which there is more than one state, in their order."""
        self._sort()
        return joined_intervals(overlaps((stretch.first, stretch.last) for stretch in self._stretches))

    def _read(self, stretch: Stretch, first: int, last: int) -> Records:
        begin, end = max(first, stretch.first) - stretch.first, min(last, stretch.last) - stretch.first + 1
        rows: Records = self._pieces[stretch.piece]()[stretch.place + begin : stretch.place + end]
        return rows

    def _sort(self) -> None:
        """By first cycle; and how far those before each reach."""
        if self._sorted is None:
            self._stretches.sort()
            begins, ends = (
                np.array([stretch[place] for stretch in self._stretches], dtype=np.uint64) for place in (0, 1)
            )
            self._sorted = begins, np.maximum.accumulate(ends)


def intervals_of(cycles: Cycles) -> list[Interval]:
    """Cycles (n,) as stretches that count up by one, in the order that they have."""
    follows = (cycles[1:] > cycles[:-1]) & (cycles[1:] - cycles[:-1] == 1)
    begins = [0, *(np.flatnonzero(~follows) + 1).tolist()] if len(cycles) else []
    ends = [*begins[1:], len(cycles)]
    return [(int(cycles[begin]), int(cycles[end - 1])) for begin, end in zip(begins, ends[: len(begins)], strict=True)]


def joined_intervals(intervals: Iterable[Interval]) -> Iterator[Interval]:
    """Of intervals in the order of their begins: those that touch each other as one."""
    known: Interval | None = None
    for first, last in intervals:
        if known is None:
            known = first, last
        elif first <= known[1] + 1:
            known = known[0], max(known[1], last)
        else:
            yield known
            known = first, last
    if known is not None:
        yield known


def overlaps(intervals: Iterable[Interval]) -> Iterator[Interval]:
    """Of intervals in the order of their begins: what each has in common with one before it."""
    reach = -1
    for first, last in intervals:
        if first <= reach:
            yield first, min(reach, last)
        reach = max(reach, last)


def without(intervals: Iterable[Interval], others: Sequence[Interval]) -> Iterator[Interval]:
    """Of intervals that do not touch each other, in their order, what is in none of `others`, which are such, too."""
    place = 0
    for first, last in intervals:
        while place < len(others) and others[place][1] < first:
            place += 1
        at = place
        while at < len(others) and others[at][0] <= last:
            if first < others[at][0]:
                yield first, others[at][0] - 1
            first = others[at][1] + 1
            at += 1
        if first <= last:
            yield first, last


def cycles_of(intervals: Iterable[Interval]) -> list[int]:
    """Each of them."""
    return [*chain.from_iterable(range(first, last + 1) for first, last in intervals)]


@dataclass
class StoredRecording(Recorded):
    """A recording whose states stay in its files: `stored` and `stored_threads` instead of `states` and `threads`.

    Events, diagnostics and offsets are not kept either.
    """

    stored: dict[str, StoredStates] = field(default_factory=dict)
    stored_threads: dict[str, StoredStates] = field(default_factory=dict)

    @property
    def last_cycle(self) -> int:
        return max((states.last for states in self.stored.values()), default=-1)

    @property
    def longest(self) -> int:
        return max((len(states) for states in self.stored.values()), default=0)


def read_stored(path: str | Path) -> StoredRecording:
    """Looks through everything that is whole in a file, or in the parts of a folder.

    Same errors as read_recording, and CncError 26224 where nothing is left.
    """
    recorded = read_with(_StoredReader(Path(path)))
    assert isinstance(recorded, StoredRecording)
    require_messages(recorded)
    return recorded


def read_columns(path: str | Path, topic: str, fields: Sequence[str]) -> Recorded:
    """The recording with the cycles and some fields of one topic's states alone. Same errors as read_stored."""
    recorded = read_with(_ColumnsReader(Path(path), topic, fields))
    require_messages(recorded)
    return recorded


class _SparseReader(Reader):
    """Reads everything, for the same errors, and keeps no events, diagnostics, offsets and stops of drives."""

    def take(self, record: RawRecord) -> None:
        super().take(record)
        of = self.recorded
        for kept in (of.events, of.diagnostics, of.coordinates, of.drive_stops):
            kept.clear()


class _StoredReader(_SparseReader):
    """Notes where the states lie."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self._stored = StoredRecording(path)
        self.recorded = self._stored
        self._in_chunk: dict[str, tuple[TopicInfo, Layout, list[Cycles]]] = {}
        self._read_chunk = lru_cache(maxsize=KEPT)(states_in_chunk)

    def take(self, record: RawRecord) -> None:
        super().take(record)
        found, self._in_chunk = self._in_chunk, {}
        chunk = partial(self._read_chunk, self.records, self.names, record.offset)
        for topic, (info, layout, cycles) in found.items():
            of_kind = self._stored.stored_threads if info.type_name == THREAD_STATE else self._stored.stored
            states = of_kind.setdefault(topic, StoredStates(layout.dtype))
            states.add(np.concatenate(cycles), partial(states_of, chunk, topic, layout))

    def keep(self, info: TopicInfo, layout: Layout, contents: Bytes) -> None:
        if info.type_name == TICK:
            super().keep(info, layout, contents)
            return
        cycles = layout.read(contents.reshape(-1))["cycle"].copy()
        self._in_chunk.setdefault(info.topic, (info, layout, []))[2].append(cycles)


class _ColumnsReader(_SparseReader):
    """Keeps some fields of one topic."""

    def __init__(self, path: Path, topic: str, fields: Sequence[str]) -> None:
        super().__init__(path)
        self._topic, self._fields = topic, ("cycle", *fields)
        self._parts: list[Records] = []

    def keep(self, info: TopicInfo, layout: Layout, contents: Bytes) -> None:
        if info.topic == self._topic:
            self._parts.append(picked(layout.read(contents.reshape(-1)), self._fields))

    def finish(self) -> Recorded:
        recorded = super().finish()
        if self._parts:
            recorded.states[self._topic] = np.concatenate(self._parts)
        return recorded


def states_in_chunk(records: RecordReader, names: Names, offset: int) -> dict[str, Bytes]:
    """The messages (n, size) of each topic with states in the chunk at an offset."""
    record = record_at(records, offset)
    found: dict[str, list[Bytes]] = {}
    for item in records.in_chunk(record):
        if isinstance(item, MessageRun):
            info = names.topic(item, record)
            if info.type_name in (*STATE_TYPES, THREAD_STATE):
                found.setdefault(info.topic, []).append(item.contents)
    return {topic: np.concatenate(parts) for topic, parts in found.items()}


def states_of(chunk: Callable[[], Mapping[str, Bytes]], topic: str, layout: Layout) -> Records:
    """The states of a topic in a chunk."""
    return layout.read(chunk()[topic].reshape(-1))


def record_at(records: RecordReader, offset: int) -> RawRecord:
    """Reads a record again. Raises CncError 26001 and 26003 where the file was changed meanwhile."""
    try:
        with records.path.open("rb") as file:
            file.seek(offset)
            head = file.read(RECORD_PREFIX.size)
            opcode, length = RECORD_PREFIX.unpack(head) if len(head) == RECORD_PREFIX.size else (0, 0)
            body = file.read(length)
    except OSError as error:
        raise records.unreadable(error) from error
    if opcode != Opcode.CHUNK or len(body) < length:
        raise records.corrupt(offset, "the chunk that was there is gone, the file was changed meanwhile")
    return RawRecord(offset, opcode, memoryview(body))
