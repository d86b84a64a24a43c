"""A recording for a report: whole if it is short, a part of one that may be long, or reduced to extremes.

Of a long recording each unit keeps about STATES states. Two of them are the smallest and largest values of all cycles
up to the next two, so that a line through them has the outline of the line through all. Nothing needs the memory of
more than some seconds of the file.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, field
from math import inf, isnan
from pathlib import Path

import numpy as np
from mcap.opcode import Opcode

from cnc_ptp.protocol.channel_states import IN_PROGRAM
from cnc_ptp.recording.mcap_chunks import MessageRun, RawRecord
from cnc_ptp.recording.mcap_index import ChunkPlace, McapIndex
from cnc_ptp.recording.opened import WORKERS, ahead
from cnc_ptp.recording.origin import require_own
from cnc_ptp.recording.parts import files_of
from cnc_ptp.recording.reader import (
    AXIS_STATE,
    CHANNEL_STATE,
    COMMAND,
    DIAGNOSTICS,
    EVENT,
    OFFSETS,
    SPINDLE_STATE,
    STATE_TYPES,
    THREAD_STATE,
    TICK,
    Reader,
    Recorded,
    Reduced,
    is_kept,
    read_recording,
    require_messages,
)
from cnc_ptp.recording.selection import NEAR_CYCLES
from cnc_ptp.recording.statistics import largest_error
from cnc_ptp.wire.layout import Bytes, Layout, Records, fixed_layout
from cnc_ptp.wire.schemas import full_name, recorded_schema

Window = tuple[float, float]
"""Log times in ns."""
SMALL = 20_000_000
"""Bytes of a recording that is read without a look at its index."""
MOST_STATES = 1_500_000
"""Of all units, in a report with every cycle: 5 minutes of 5 units."""
STATES, PLACES = 20_000, 200_000
"""Of a unit; of an axis for its path."""
BATCH = 40
"""Chunks of a unit that are reduced at once."""
SPARSE = (EVENT, COMMAND, DIAGNOSTICS, OFFSETS, TICK)
PATH_FIELDS = ("cycle", "set_position", "actual_position", "actual_velocity", "following_error")
FIELDS = {
    AXIS_STATE: [
        "set_position",
        "set_velocity",
        "set_acceleration",
        "set_jerk",
        "actual_position",
        "actual_velocity",
        "following_error",
        "feedforward_velocity",
        "additive_velocity",
        "additive_torque",
        "friction_current",
        "actual_torque",
        "override_percent",
        "feedforward_percent",
        "state",
    ],
    SPINDLE_STATE: [
        "set_speed_rpm",
        "actual_speed_rpm",
        "set_position_deg",
        "actual_position_deg",
        "target_position_deg",
        "following_error_deg",
        "override_percent",
        "feedforward_percent",
        "state",
    ],
    CHANNEL_STATE: ["line", "path_velocity", "programmed_feed", "override_percent", "state"],
}
"""What a report draws of them over time."""


def read_for_report(
    path: str | Path, begin: float | None = None, end: float | None = None, *, most_states: int | float = MOST_STATES
) -> Recorded:
    """The states from `begin` to `end` in s: every cycle of at most `most_states` states, otherwise reduced.

    Of a file or of the parts of a folder. Events, commands and attachments are those of the whole recording.
    Raises CncError 26001 to 26005, 26014, 26016 and 26224 (nothing is left).
    """
    recorded = _read_all(path, begin, end, most_states)
    require_messages(recorded)
    return recorded


def read_own(path: str | Path, begin: float | None, end: float | None) -> Recorded:
    """The same. Raises besides CncError 26017 for a recording of another program."""
    recorded = read_for_report(path, begin, end)
    require_own(recorded.path, recorded.metadata, recorded.states)
    return recorded


def _read_all(path: str | Path, begin: float | None, end: float | None, most_states: int | float) -> Recorded:
    files = files_of(Path(path))
    if most_states >= MOST_STATES and sum(file.stat().st_size for file in files if file.is_file()) < SMALL:
        return read_recording(path)
    with ExitStack() as opened:
        parts: list[McapIndex] = []
        for file in files:
            parts.append(McapIndex(file))
            opened.callback(parts[-1].close)
        return _read(Path(path), parts, begin, end, most_states)


def _read(
    path: Path, parts: Sequence[McapIndex], begin: float | None, end: float | None, most_states: int | float
) -> Recorded:
    reader = Reader(path)
    for index in parts:
        _announce(reader, index)
        for metadata in index.metadata:
            reader.metadata(metadata)
        for name in filter(is_kept, index.attachments):
            reader.attachment(name, index.attached(name))
        _feed(reader, index, _ids(index, SPARSE), index.chunks)
        reader.end_of_file(index.missing)
    window = _window(reader.recorded, begin, end)
    few = _number_of_states(parts, window) <= most_states
    if few:
        for index in parts:
            _announce(reader, index)
            _feed(reader, index, _ids(index, (*STATE_TYPES, THREAD_STATE)), _inside_of(index, window))
    recorded = reader.finish()
    _count_topics(reader, parts)
    if not few:
        _reduce(recorded, parts, window)
    return recorded


def _announce(reader: Reader, index: McapIndex) -> None:
    """The messages that follow are those of this file."""
    reader.begin(index)
    for schema in index.schemas.values():
        reader.names.add(schema)
    for channel in index.channels.values():
        reader.names.add(channel)


def _window(recorded: Recorded, begin: float | None, end: float | None) -> Window:
    near = NEAR_CYCLES * recorded.cycle_time_ns
    low = -np.inf if begin is None else recorded.start_ns + begin * 1e9 - near
    high = np.inf if end is None else recorded.start_ns + end * 1e9 + near
    return low, high


def _inside_of(index: McapIndex, window: Window) -> list[ChunkPlace]:
    """The chunks that may hold messages of that time."""
    return [chunk for chunk in index.chunks if chunk.last_ns >= window[0] and chunk.first_ns <= window[1]]


def _number_of_states(parts: Sequence[McapIndex], window: Window) -> float:
    """About: those of a file are evenly spread."""
    return sum(_share(index, window) * _count(index, _ids(index, STATE_TYPES)) for index in parts)


def _share(index: McapIndex, window: Window) -> float:
    """Of the chunks of a file, how many may hold messages of that time."""
    return len(_inside_of(index, window)) / max(1, len(index.chunks))


def _count(index: McapIndex, ids: Collection[int]) -> int:
    return sum(index.counts.get(id, 0) for id in ids)


def _ids(index: McapIndex, types: Collection[str]) -> set[int]:
    schemas = {id for id, schema in index.schemas.items() if full_name(schema.name) in types}
    return {id for id, channel in index.channels.items() if channel.schema_id in schemas}


def _with(ids: set[int], chunks: Collection[ChunkPlace]) -> list[ChunkPlace]:
    """The chunks that may hold messages of them."""
    return [chunk for chunk in chunks if chunk.may_hold(ids)]


def _feed(reader: Reader, index: McapIndex, ids: set[int], chunks: Collection[ChunkPlace]) -> None:
    for chunk in _with(ids, chunks):
        record = RawRecord(chunk.offset, Opcode.CHUNK, memoryview(b""))
        for run in index.runs(chunk, ids):
            reader.messages(run, record)


def _count_topics(reader: Reader, parts: Sequence[McapIndex]) -> None:
    """Messages of all topics, also of those that were not read."""
    for info in reader.names.by_name.values():
        counted = [
            (_count(index, ids), _with(ids, index.chunks)) for index in parts if (ids := index.ids_of(info.topic))
        ]
        chunks = [chunk for _, found in counted for chunk in found]
        info.count = sum(count for count, _ in counted)
        if info.count and chunks:
            info.first_ns, info.last_ns = chunks[0].first_ns, max(chunk.last_ns for chunk in chunks)
            reader.recorded.topics[info.topic] = info


def _reduce(recorded: Recorded, parts: Sequence[McapIndex], window: Window) -> None:
    """Fills in the states."""
    topics = sorted({index.channels[id].topic for index in parts for id in _ids(index, STATE_TYPES)})
    longest = max(_states_of(parts, topic, window) for topic in topics)
    stride, path_stride = (max(1, round(longest / count)) for count in (STATES, PLACES))
    units: dict[str, _Unit] = {}
    for topic in topics:
        layout = _layout_of(parts, topic)
        unit = _Unit(recorded.topics[topic].type_name, layout, stride, path_stride, recorded.block_cycles)
        for contents in _batches(parts, topic, layout.dtype.itemsize, window):
            unit.add(contents)
        if unit.last_cycle >= 0:
            unit.finish()
            units[topic] = unit
    recorded.states = {topic: np.concatenate(unit.states) for topic, unit in units.items()}
    names = {topic: topic.removeprefix("/").removesuffix("/state") for topic in units}
    axes = {names[topic]: unit for topic, unit in units.items() if unit.type_name == AXIS_STATE}
    recorded.reduced = Reduced(
        stride=stride,
        last_cycle=max((unit.last_cycle for unit in units.values()), default=-1),
        path_stride=path_stride,
        paths={name: np.concatenate(unit.places) for name, unit in axes.items()},
        largest={name: unit.largest for name, unit in axes.items()},
        in_program={names[topic]: unit.in_program for topic, unit in units.items()},
        missing=sum(unit.missing for unit in units.values()),
    )


def _states_of(parts: Sequence[McapIndex], topic: str, window: Window) -> float:
    return sum(_share(index, window) * _count(index, index.ids_of(topic)) for index in parts)


def _layout_of(parts: Sequence[McapIndex], topic: str) -> Layout:
    """As the first file that has the topic says."""
    index, id = next((index, id) for index in parts for id in index.ids_of(topic))
    schema = index.schemas[index.channels[id].schema_id]
    return fixed_layout(recorded_schema(full_name(schema.name), schema.data))


def _batches(parts: Sequence[McapIndex], topic: str, size: int, window: Window) -> Iterator[list[Bytes]]:
    """The states of a unit in the order of the files; chunks are uncompressed while others are reduced."""

    def read(place: tuple[McapIndex, ChunkPlace]) -> list[Bytes]:
        index, chunk = place
        runs = [_inside(run, window) for run in index.runs(chunk, index.ids_of(topic))]
        for run in runs:
            if run.shape[1] != size:
                reason = f"a message of {topic} has {run.shape[1]} bytes instead of {size}"
                raise index.corrupt(chunk.offset, reason)
        return [run for run in runs if len(run)]

    places = [(index, chunk) for index in parts for chunk in _with(index.ids_of(topic), _inside_of(index, window))]
    with ThreadPoolExecutor(max_workers=WORKERS) as workers:
        found: list[Bytes] = []
        for count, runs in enumerate(ahead(workers, read, places), start=1):
            found += runs
            if found and count % BATCH == 0:
                yield found
                found = []
        if found:
            yield found


def _inside(run: MessageRun, window: Window) -> Bytes:
    times = run.head["log_time"]
    inside = (times >= window[0]) & (times <= window[1])
    return run.contents if inside.all() else run.contents[inside]


@dataclass(slots=True)
class _Unit:
    """Reduces the states of a unit, batch by batch."""

    type_name: str
    layout: Layout
    stride: int
    path_stride: int
    block_cycles: int
    states: list[Records] = field(default_factory=list)
    places: list[Records] = field(default_factory=list)
    largest: tuple[float, int] = (0.0, 0)
    in_program: int = 0
    missing: int = 0
    last_cycle: int = -1
    _rest: list[Bytes] = field(default_factory=list)
    """Too few for a pair."""
    _seen: int = 0

    def add(self, contents: list[Bytes]) -> None:
        whole = np.concatenate([*self._rest, *contents])
        rows = self.layout.read(whole.reshape(-1))
        before = sum(map(len, self._rest))
        self._count(rows[before:])
        used = len(rows) // (2 * self.stride) * 2 * self.stride
        self._rest = [whole[used:].copy()]
        if used:
            self.states.append(extremes(rows[:used], FIELDS[self.type_name], self.stride))

    def finish(self) -> None:
        """What is left over is a pair of its own."""
        rest = self.layout.read(np.concatenate(self._rest).reshape(-1))
        if len(rest):
            self.states.append(extremes(rest, FIELDS[self.type_name], (len(rest) + 1) // 2))

    def _count(self, rows: Records) -> None:
        """What is kept of every cycle, and places of the path."""
        cycles = rows["cycle"].astype(np.int64)
        before = cycles[0] - 1 if self.last_cycle < 0 else self.last_cycle
        gaps = np.maximum(np.diff(cycles, prepend=before) - 1, 0)
        self.missing += int(np.ceil(gaps / self.block_cycles).sum())
        self.last_cycle = int(cycles.max())
        if self.type_name == AXIS_STATE:
            found = largest_error(rows)
            self.largest = max(self.largest, found, key=lambda each: inf if isnan(each[0]) else abs(each[0]))
            chosen = rows[-self._seen % self.path_stride :: self.path_stride]
            self.places.append(picked(chosen, PATH_FIELDS))
        elif self.type_name == CHANNEL_STATE:
            self.in_program += int(np.isin(rows["state"], IN_PROGRAM).sum())
        self._seen += len(rows)


def picked(rows: Records, fields: Collection[str]) -> Records:
    """Those fields that the states have, without what lies between them."""
    known = [name for name in fields if name in (rows.dtype.names or ())]
    result: Records = np.zeros(len(rows), dtype=[(name, rows.dtype[name]) for name in known])
    for name in known:
        result[name] = rows[name]
    return result


def extremes(rows: Records, fields: Collection[str], stride: int) -> Records:
    """Two states for each 2 · `stride` of `rows` (of what is left over, too): smallest and largest value.

    The larger one comes last if the part ends above its begin.
    """
    pairs = max(1, len(rows) // (2 * stride))
    result = picked(np.repeat(rows[:: -(-len(rows) // pairs)], 2), ("cycle", *fields))
    cycles = rows["cycle"].reshape(pairs, -1)
    result["cycle"][1::2] = cycles[:, min(stride, cycles.shape[1] - 1)]
    for name in result.dtype.fields or ():
        if name == "cycle":
            continue
        values = np.array(rows[name]).reshape(pairs, -1)
        low, high = values.min(axis=1), values.max(axis=1)
        rises = values[:, -1] >= values[:, 0]
        result[name][::2] = np.where(rises, low, high)
        result[name][1::2] = np.where(rises, high, low)
    return result
