"""`cnc_ptp.recording.open`: topics of a recording as columns, as a table of pandas, or piece by piece.

Columns come straight from the chunks that hold them: no object is made of a message whose numbers lie at fixed places.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from importlib import import_module
from itertools import chain
from math import nan
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from cnc_ptp.errors import CncError
from cnc_ptp.recording.mcap_file import METADATA, MISSING
from cnc_ptp.recording.mcap_index import ChunkPlace, McapIndex, require_chunks
from cnc_ptp.recording.message_fields import Column, MessageFields
from cnc_ptp.recording.origin import notes_of
from cnc_ptp.recording.parts import files_of
from cnc_ptp.recording.reader import STATE_TYPES
from cnc_ptp.recording.selection import NOT_RECORDED, asked_time, nearest
from cnc_ptp.wire.schemas import full_name

if TYPE_CHECKING:
    import pandas

NO_PACKAGE = 26013
BAD_SCHEMA = 26005
TIME, LOG_TIME = "time", "log_time"
"""Columns that every topic has: s of the recording; ns as the file has it."""
HEADER = "header."
NOTHING = "nothing was read"
WORKERS = min(4, os.cpu_count() or 1)
AHEAD = 4 * WORKERS
"""Pieces that are read before they are asked for."""
NEAR_NS = 1000
"""A time in s may be off by rounding."""

Item = TypeVar("Item")
Result = TypeVar("Result")
Columns = dict[str, Column]


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic of a recording; `fields` are the names of its columns."""

    name: str
    type_name: str
    count: int
    fields: tuple[str, ...]


class _Piece(NamedTuple):
    """Chunks of a topic that are of the same time."""

    chunks: list[tuple[McapIndex, ChunkPlace]]


class LazyColumns(Mapping[str, Column]):
    """Columns of a topic: each is read when it is asked for, those that were named together in one pass."""

    def __init__(self, read: Callable[[Sequence[str]], Columns], together: Sequence[str], names: Sequence[str]) -> None:
        self._read = read
        self._together = together
        self._names = names
        self._known: Columns = {}

    def __getitem__(self, name: str) -> Column:
        if name not in self._known:
            self._known |= self._read(self._together if name in self._together else [name])
        return self._known[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


class OpenRecording:
    """A recording, or a folder of rosbag2 with several files, that is read as far as it is asked.

    Raises CncError 26001 to 26003 and 26005 (see McapIndex, schemas); 26224 where nothing is left; 26011 for topics,
    fields and times that it does not hold; 26013 where a package is not installed.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._files = [McapIndex(file) for file in files_of(self.path)]
        records = chain.from_iterable(file.metadata for file in self._files)
        self.metadata = notes_of(self.path, (record.metadata for record in records if record.name == METADATA))
        self.missing = missing_of(self.metadata, self._files)
        require_chunks(self.path, self.missing, self._files)
        first = min((chunk.first_ns for file in self._files for chunk in file.chunks), default=0)
        self.start_ns = int(self.metadata.get("start_ns", first))
        """Log time of time 0."""
        self._readers: dict[str, MessageFields] = {}
        self._chunks: dict[str, list[tuple[McapIndex, ChunkPlace]]] = {}
        """Of the topics that were asked for, in the order of time."""
        self.topics: dict[str, Topic] = {}
        self.unreadable: list[str] = []
        """Topics whose messages are none of ROS 2, or whose schema is damaged."""
        for file in self._files:
            for channel in file.channels.values():
                self._add_topic(file, channel.id)
        self._workers = ThreadPoolExecutor(max_workers=WORKERS, thread_name_prefix="columns")

    def columns(
        self, topic: str, *fields: str, start: float | None = None, end: float | None = None
    ) -> Mapping[str, Column]:
        """Columns by name, from `start` to `end` in s: those of `fields` are read at once, without any each alone."""
        names = self._names(topic, fields)
        self._require_pieces(topic, start, end)

        def read(wanted: Sequence[str]) -> Columns:
            parts = [*self._parts(topic, self._names(topic, wanted), start, end)]
            return {name: joined([part[name] for part in parts]) for name in wanted}

        return LazyColumns(read, names if fields else (), names)

    def frame(self, topic: str, *fields: str, start: float | None = None, end: float | None = None) -> pandas.DataFrame:
        """The table of a topic, one row a message, its index the time in s; without `fields` all but its header.

        Elements of a sequence are columns of their own: `name[0]`, `name[1]`, ….
        """
        pandas = package("pandas")
        names = [name for name in self._names(topic, fields) if name not in (TIME, LOG_TIME)]
        columns = self.columns(topic, TIME, *names, start=start, end=end)
        flat = dict(chain.from_iterable(_flat(name, columns[name]) for name in names))
        return pandas.DataFrame(flat, index=pandas.Index(columns[TIME], name=TIME))

    def parts(
        self, topic: str, *fields: str, start: float | None = None, end: float | None = None
    ) -> Iterator[Columns]:
        """The same columns piece by piece, in the order of time."""
        names = self._names(topic, fields)
        self._require_pieces(topic, start, end)
        return (part for part in self._parts(topic, names, start, end) if len(part[names[0]]))

    @property
    def attachments(self) -> set[str]:
        """Their names."""
        return {name for file in self._files for name in file.attachments}

    def attached(self, name: str) -> str:
        """The text of an attachment, `machine.yaml`. Raises CncError 26011 where there is none of this name."""
        for file in self._files:
            if name in file.attachments:
                return file.attached(name).decode(errors="replace")
        raise self._missing(f"holds no attachment '{name}'")

    def span(self, topic: str) -> tuple[float, float]:
        """First and last time of a topic that it holds, s."""
        first, last = ((time - self.start_ns) * 1e-9 for time in self._span(topic))
        return first, last

    @property
    def is_closed(self) -> bool:
        """All of its files have an index."""
        return all(file.indexed for file in self._files)

    @property
    def state_topics(self) -> list[str]:
        return [topic for topic, info in self.topics.items() if info.type_name in STATE_TYPES]

    def recorded_span(self) -> tuple[float, float]:
        """First and last time of the states of all units, s; of all topics where there are none. NaN without any."""
        spans = [self.span(topic) for topic in self.state_topics or self.topics]
        return min((first for first, _ in spans), default=nan), max((last for _, last in spans), default=nan)

    def close(self) -> None:
        self._workers.shutdown()
        for file in self._files:
            file.close()

    def __enter__(self) -> OpenRecording:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _add_topic(self, file: McapIndex, channel_id: int) -> None:
        channel = file.channels[channel_id]
        schema = file.schemas.get(channel.schema_id)
        if schema is None:
            return
        count = file.counts.get(channel_id, 0)
        known = self.topics.get(channel.topic)
        if known is not None:
            self.topics[channel.topic] = replace(known, count=known.count + count)
        elif count:
            try:
                reader = self._readers[channel.topic] = MessageFields(schema)
            except Exception:  # a schema of another program, or a damaged one: others of the file can be read
                self.unreadable.append(channel.topic)
                return
            self.topics[channel.topic] = Topic(channel.topic, full_name(schema.name), count, reader.names)

    def _names(self, topic: str, fields: Sequence[str]) -> list[str]:
        """Raises CncError 26011 for what the topic does not have."""
        if topic in self.unreadable:
            raise CncError(BAD_SCHEMA, f"recording {self.path}: the schema of {topic} is none of ROS 2", NOTHING)
        if topic not in self.topics:
            raise self._missing(f"holds no topic '{topic}'{nearest(topic, self.topics)}")
        known = self.topics[topic].fields
        for field in fields:
            if field not in (*known, TIME, LOG_TIME):
                raise self._missing(f"holds no field '{field}' of {topic}{nearest(field, known)}")
        return [*fields] or [TIME, *(name for name in known if not name.startswith(HEADER))]

    def _missing(self, what: str) -> CncError:
        return CncError(NOT_RECORDED, f"recording {self.path}: {what}", NOTHING)

    def _bounds(self, start: float | None, end: float | None) -> tuple[int, int]:
        """Log times in ns."""
        low = 0 if start is None else self.start_ns + round(start * 1e9) - NEAR_NS
        high = 2**63 if end is None else self.start_ns + round(end * 1e9) + NEAR_NS
        return max(0, low), max(0, high)

    def _require_pieces(self, topic: str, start: float | None, end: float | None) -> None:
        if not self._pieces(topic, 0, 2**64):
            raise self._missing(f"holds nothing of {topic}")
        if not self._pieces(topic, *self._bounds(start, end)):
            first, last = self.span(topic)
            asked = asked_time(start, end)
            raise self._missing(f"holds nothing of {topic} from {asked}, it covers {first:g} s to {last:g} s")

    def _span(self, topic: str) -> tuple[int, int]:
        chunks = [chunk for piece in self._pieces(topic, 0, 2**64) for _, chunk in piece.chunks]
        return min(chunk.first_ns for chunk in chunks), max(chunk.last_ns for chunk in chunks)

    def _pieces(self, topic: str, low: int, high: int) -> list[_Piece]:
        """The chunks that may hold messages of a topic in that time; those that overlap are one piece."""
        pieces: list[_Piece] = []
        end = -1
        for file, chunk in self._chunks_of(topic):
            if chunk.first_ns > high or chunk.last_ns < low:
                continue
            if chunk.first_ns > end or not pieces:
                pieces.append(_Piece([]))
            pieces[-1].chunks.append((file, chunk))
            end = max(end, chunk.last_ns)
        return pieces

    def _chunks_of(self, topic: str) -> list[tuple[McapIndex, ChunkPlace]]:
        if topic not in self._chunks:
            found = [
                (file, chunk)
                for file in self._files
                if (ids := file.ids_of(topic))
                for chunk in file.chunks
                if chunk.may_hold(ids)
            ]
            self._chunks[topic] = sorted(found, key=lambda place: place[1].first_ns)
        return self._chunks[topic]

    def _parts(self, topic: str, names: Sequence[str], start: float | None, end: float | None) -> Iterator[Columns]:
        low, high = self._bounds(start, end)

        def read(piece: _Piece) -> Columns:
            return self._read(topic, piece, names, low, high)

        return ahead(self._workers, read, self._pieces(topic, low, high))

    def _read(self, topic: str, piece: _Piece, names: Sequence[str], low: int, high: int) -> Columns:
        """The columns of a piece, in the order of time."""
        reader = self._readers[topic]
        own = [name for name in names if name not in (TIME, LOG_TIME)]
        times: list[Column] = [np.empty(0, dtype=np.uint64)]
        found: dict[str, list[Column]] = {name: [] for name in own}
        for file, chunk in piece.chunks:
            for run in file.runs(chunk, file.ids_of(topic)):
                log_times = run.head["log_time"]
                inside = (log_times >= low) & (log_times <= high)
                try:
                    columns = reader.read(run.contents if inside.all() else run.contents[inside], own)
                except Exception as error:  # whatever the generated decoder raises on bytes that are no such message
                    reason = f"a message of {topic} is not a {self.topics[topic].type_name}: {error!r}"
                    raise file.corrupt(chunk.offset, reason) from error
                times.append(log_times[inside])
                for name in own:
                    found[name].append(columns[name])
        log_time = np.concatenate(times)
        result = {name: joined(parts) for name, parts in found.items()}
        result[LOG_TIME] = log_time
        result[TIME] = (log_time.astype(np.int64) - self.start_ns) * 1e-9
        if (log_time[1:] < log_time[:-1]).any():
            order = np.argsort(log_time, kind="stable")
            result = {name: column[order] for name, column in result.items()}
        return {name: result[name] for name in names}


def missing_of(notes: Mapping[str, str], files: Iterable[McapIndex]) -> str:
    """What a recording lacks, as it says itself and as its files end; empty for one that is whole."""
    return "; ".join(filter(None, [notes.get(MISSING), *(file.missing for file in files)]))


def package(name: str, effect: str = "") -> Any:
    """A package that not all commands need. Raises CncError 26013, with the `effect`, where it is not installed."""
    try:
        return import_module(name)
    except ImportError:
        remedy = effect if effect else f"{NOTHING}, install it with: pip install {name}"
        raise CncError(NO_PACKAGE, f"{name} is not installed", remedy) from None


def ahead(workers: ThreadPoolExecutor, call: Callable[[Item], Result], items: Iterable[Item]) -> Iterator[Result]:
    """Results in the order of the items; a few are computed before they are asked for."""
    waiting: deque[Future[Result]] = deque()
    for item in items:
        waiting.append(workers.submit(call, item))
        if len(waiting) >= AHEAD:
            yield waiting.popleft().result()
    while waiting:
        yield waiting.popleft().result()


def joined(parts: Sequence[Column]) -> Column:
    """One column; of sequences with different lengths objects."""
    parts = [part for part in parts if len(part)] or [*parts[:1]] or [np.empty(0)]
    if len({part.shape[1:] for part in parts}) == 1:
        return np.concatenate(parts)
    whole = np.empty(sum(map(len, parts)), dtype=object)
    for place, row in enumerate(chain.from_iterable(parts)):
        whole[place] = row
    return whole


def _flat(name: str, column: Column) -> Iterator[tuple[str, Column]]:
    if column.ndim == 1:
        yield name, column
    else:
        yield from ((f"{name}[{place}]", column[:, place]) for place in range(column.shape[1]))
