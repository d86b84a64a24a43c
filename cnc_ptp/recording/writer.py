"""Writes the recording of a run: per-cycle states, blocks, events and commands as an MCAP file.

There is no clock here: the log time of a message is the stamp of its cycle, and the caller says when wall time has
passed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import groupby
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol

import numpy as np

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import ChannelBlock, CommandRecord, CycleBlock, CycleTick, Event, PlcBlock
from cnc_ptp.recording.bag import QOS, TYPE_HASH, write_beside
from cnc_ptp.recording.blocks import StateKind, block_rows, fill_states, kind_of, kinds_in
from cnc_ptp.recording.mcap_file import HEAD_SIZE, METADATA, MISSING, McapFile
from cnc_ptp.recording.origin import FORMAT, FORMAT_VERSION, PART
from cnc_ptp.recording.parts import PartsFolder
from cnc_ptp.recording.qos import offered, profiles_text
from cnc_ptp.recording.settings import Settings, Split
from cnc_ptp.wire.block_codec import codec_of, head_of, with_plain_header
from cnc_ptp.wire.layout import Bytes, Layout, encode, repeat
from cnc_ptp.wire.schemas import full_name, load_schema, type_hash
from cnc_ptp.wire.stamps import Stamps, Times
from cnc_ptp.wire.ticks import encode_tick

TWO_TYPES = 26008
CLOSED = 26009
ROOM = bytes(HEAD_SIZE)  # for the record head in front of each message
MACHINE_FILE = "machine.yaml"
PLC_FILE = "plc/"
"""Attachment with the PLC in a file that served the run; its name ends with that of the file."""
CHECKPOINT = "checkpoint/"
"""Attachments with states of the units: their names end with the first cycle behind it."""
CHECKPOINT_TEXT = "checkpoint_text/"
"""Attachments with long texts of the states: their names end with the digest."""
AS_USUAL = Settings()
NO_NOTES: Mapping[str, str] = {}
BEFORE_ALL = -1  # end of the chunk before the first block


class _Encoder(Protocol):
    """Turns the items of a topic into messages: rows (n, HEAD_SIZE + size) and times (n,) for each size."""

    def messages(self, collected: list[Any], stamps: Stamps) -> list[tuple[Bytes, Times]]: ...


class _States:
    """Messages of blocks of one layout -> state messages, one per cycle."""

    def __init__(self, kind: StateKind, layout: Layout) -> None:
        self.kind = kind
        self.layout = layout

    def messages(self, collected: list[bytes], stamps: Stamps) -> list[tuple[Bytes, Times]]:
        states = self.kind.layout
        rows = block_rows(collected, self.layout)
        cycles = self.kind.cycles(rows)
        times = stamps.at_all(cycles)
        raw = repeat(ROOM + states.template, len(cycles))
        fill_states(self.kind, raw[:, HEAD_SIZE:].view(states.dtype)[:, 0], rows, cycles, times)
        return [(raw, times)]


class _Ready:
    """(time, CDR) pairs -> messages."""

    def messages(self, collected: list[tuple[int, bytes]], _stamps: Stamps) -> list[tuple[Bytes, Times]]:
        result: list[tuple[Bytes, Times]] = []
        for _, group in groupby(collected, key=lambda message: len(message[1])):
            times, contents = zip(*group, strict=True)
            joined = bytearray()
            for content in contents:
                joined += ROOM
                joined += content
            rows = np.frombuffer(joined, dtype=np.uint8).reshape(len(contents), -1)
            result.append((rows, np.array(times, dtype=np.uint64)))
        return result


READY = _Ready()


class _Topic:
    """A topic of the file and its items since the last chunk: runs of items for one encoder each."""

    def __init__(self, channel_id: int, type_name: str) -> None:
        self.channel_id = channel_id
        self.type_names = (type_name, full_name(type_name))
        self.runs: list[tuple[_Encoder, list[Any]]] = []
        self.has_states = self.has_blocks = False
        self._encoder: _Encoder | None = None
        self._items: list[Any] = []

    def add(self, encoder: _Encoder, item: Any) -> None:
        if encoder is not self._encoder:
            self._encoder = encoder
            self._items = []
            self.runs.append((encoder, self._items))
        self._items.append(item)

    def take(self) -> list[tuple[_Encoder, list[Any]]]:
        runs, self.runs, self._encoder, self._items = self.runs, [], None, []
        return runs


class _Unit:
    """Where the blocks of a unit go, and those of its states that come from blocks of the newest layout."""

    def __init__(self, block_class: type, blocks: _Topic, states: Callable[[StateKind], _Topic] | None) -> None:
        """`states`: the topic of a kind of states; None for blocks without any."""
        self._class, self._codec = block_class, codec_of(block_class)
        self._blocks = blocks
        self._states = states
        self._layout: Layout | None = None
        self._encoders: list[tuple[_Topic, _States]] = []

    def add(self, stamp_ns: int, data: bytes, layout: Layout | None) -> None:
        """Takes a block for both topics, without the bytes that DDS has filled it up with.

        `layout`: where its numbers lie, if that is known.
        """
        if self._states is None:
            self._blocks.add(READY, (stamp_ns, data))
            return
        if layout is None:
            layout = self._codec.layout(data)
            data = data[: layout.dtype.itemsize]
        self._blocks.add(READY, (stamp_ns, data))
        if self._layout is not layout:
            self._layout = layout
            self._encoders = [(self._states(kind), _States(kind, layout)) for kind in kinds_in(self._class, layout)]
        for topic, encoder in self._encoders:
            topic.add(encoder, data)


class MessageFile(Protocol):
    """What a recording needs of its file; see McapFile."""

    @property
    def chunks_ready(self) -> bool: ...
    @property
    def size(self) -> int: ...
    def attachment(self, name: str, media_type: str, data: bytes, log_time: int) -> None: ...
    def metadata(self, name: str, values: dict[str, str]) -> None: ...
    def channel(self, topic: str, type_name: str, schema_text: str, metadata: dict[str, str]) -> int: ...
    def messages(self, channel_id: int, rows: Bytes, times: Times) -> None: ...
    def close_chunk(self) -> None: ...
    def finish_chunks(self) -> None: ...
    def close(self) -> None: ...


def write_new_texts(file: MessageFile, texts: Mapping[str, str], written: set[str], log_time: int) -> None:
    """Long texts of checkpoints, by digest, but for those that are `written`."""
    for digest in texts.keys() - written:
        written.add(digest)
        file.attachment(
            f"{CHECKPOINT_TEXT}{digest}", "text/plain", texts[digest].encode(errors="surrogatepass"), log_time
        )


class Recording:
    """A recording being written.

    `block` records a unit's block with its per-cycle states; in the graph the block arrives as bytes, for
    `encoded_block`. Chunks are closed every `chunk_seconds` of recorded time and whenever `flush_if_due` sees
    `flush_seconds` of wall time passed; then the operating system gets them. A killed process loses only what came
    after the last ones. States of a unit have chunks of their own: who reads a column uncompresses nothing else. So
    have blocks: who reads commands and events uncompresses none.

    Errors (CncError): 26005 unknown message type, 26006 a block that does not fit its message, 26007 the file cannot be
    written, 26008 a topic with two types, 26009 the recording is closed. What was refused is not in the file; the rest
    is.
    """

    def __init__(
        self,
        path: str | Path,
        machine_yaml: str,
        start_ns: int = 0,
        cycle_time_ns: int = 1_000_000,
        *,
        chunk_seconds: float = 1.0,
        flush_seconds: float = 0.5,
        level: int = 1,
        notes: Mapping[str, str] = NO_NOTES,
        settings: Settings = AS_USUAL,
        file: MessageFile | None = None,
    ) -> None:
        """`notes` for its metadata. With a split in its `settings`, `path` is a folder of parts (PartsFolder).

        `file`: what takes the messages instead of an MCAP file.
        """
        self.path = Path(path)
        self.stamps = Stamps(start_ns, cycle_time_ns)
        self._chunk_cycles = max(1, round(chunk_seconds * 1e9 / cycle_time_ns))
        self._flush_seconds = flush_seconds
        self._chunk_end = BEFORE_ALL
        self._flushed_at: float | None = None
        self._topics: dict[str, _Topic] = {}
        self._units: dict[tuple[str, type], _Unit] = {}
        self._texts: set[str] = set()
        """Digests of those of checkpoints that are in the recording."""
        self._closed = False
        self._level, self._settings = level, settings
        self._split = settings.split
        self._part_begin = BEFORE_ALL
        """First cycle of the part that is being written."""
        self._folder = PartsFolder(self.path) if settings.split else None
        self._files = {MACHINE_FILE: machine_yaml, **settings.files}
        times = {"start_ns": str(start_ns), "cycle_time_ns": str(cycle_time_ns)}
        self._notes = {FORMAT: str(FORMAT_VERSION), **times, **notes}
        if file is None:
            self._file = self._new_file()
        else:
            self._file = file
            self._describe(file)

    def _new_file(self) -> MessageFile:
        """The file, or the next part of several."""
        path = self.path
        if self._folder is not None:
            path = self._folder.next_part()
            self._notes[PART] = str(self._folder.count)
        describe = write_beside if self._folder is None else self._folder.add
        file = McapFile(path, self._level, compression=self._settings.compression, describe=describe)
        with file.or_nothing():
            self._describe(file)
        return file

    def _describe(self, file: MessageFile) -> None:
        """Tells the file what a reader must know of the run."""
        for name, text in self._files.items():
            file.attachment(name, media_type(name), text.encode(), self.stamps.start_ns)
        file.metadata(METADATA, self._notes)

    def block(self, name: str, block: CycleBlock, *, handshakes: bool = True) -> None:
        """`/<name>/block` and, per cycle, `/<name>/state`.

        `handshakes`: `/<name>/handshake` for each request of a channel and `/<name>/offsets`; in the graph they have
        topics.
        """
        data, layout = codec_of(type(block)).encode_with_layout(block, self.stamps)
        self._block(name, type(block), data, layout)
        if handshakes and isinstance(block, ChannelBlock):
            for request in block.requests:
                self._single(topic_of(name, "handshake"), "cnc_ptp/msg/HandshakeRequest", request)
            for offsets in block.offsets:
                self._single(topic_of(name, "offsets"), "cnc_ptp/msg/ChannelOffsets", offsets)

    def encoded_block(self, name: str, block_class: type, data: bytes) -> None:
        """`/<name>/block` as it came over DDS and, per cycle, `/<name>/state`."""
        self._block(name, block_class, with_plain_header(block_class, data, self.stamps))

    def tick(self, tick: CycleTick, scheduled_monotonic_ns: int = 0) -> None:
        """`/clock/tick`."""
        if tick.first_cycle >= self._chunk_end:
            self._begin_chunk(tick.first_cycle)
        stamp_ns = self.stamps.at(tick.first_cycle)
        data = encode_tick(tick.first_cycle, tick.count, scheduled_monotonic_ns, stamp_ns)
        self._topic("/clock/tick", "cnc_ptp/msg/CycleTick").add(READY, (stamp_ns, data))

    # single messages

    def event(self, event: Event) -> None:
        self._single("/events", "cnc_ptp/msg/Event", event)

    def command(self, command: CommandRecord) -> None:
        self._single("/commands", "cnc_ptp/msg/CommandRecord", command)

    def raw(self, topic: str, type_name: str, cdr: bytes, log_time_ns: int) -> None:
        """A message as it came over DDS. A topic that the other methods of this class write must not come here too."""
        self._require_open(topic)
        self._topic(topic, type_name).add(READY, (log_time_ns, cdr))

    def attachment(self, name: str, media_type: str, text: str) -> None:
        """A file of the run, e.g. the NC program."""
        self._require_open(name)
        self._file.attachment(name, media_type, text.encode(), self.stamps.start_ns)

    def checkpoint(self, cycle: int, state: bytes, unit: str = "") -> None:
        """The state before `cycle`: of all units, or of `unit` as a part of it."""
        self._require_open("a checkpoint")
        name = f"{CHECKPOINT}{cycle}/{unit}" if unit else f"{CHECKPOINT}{cycle}"
        self._file.attachment(name, "application/octet-stream", state, self.stamps.at(cycle))

    def checkpoint_texts(self, texts: Mapping[str, str]) -> None:
        """Long texts that states refer to, by digest; each is written once."""
        write_new_texts(self._file, texts, self._texts, self.stamps.start_ns)

    # writing

    def flush_if_due(self, now: float) -> bool:
        """Writes a chunk when `flush_seconds` have passed since the last time; `now` in s of any steady clock."""
        if self._flushed_at is None:
            self._flushed_at = now
        if now - self._flushed_at < self._flush_seconds:
            return False
        self._flushed_at = now
        self.flush()
        return True

    def flush(self) -> None:
        """Writes the messages so far as a chunk and hands it to the operating system."""
        self._require_open("a flush")
        self._close_chunk()
        self._file.finish_chunks()

    def note_missing(self, what: str) -> None:
        """The recording says that it is not complete."""
        self._file.metadata(METADATA, {MISSING: what})

    def close(self) -> None:
        """Writes the rest and the summary. A second call has no effect."""
        if self._closed:
            return
        self._closed = True
        self._chunk_end = BEFORE_ALL
        try:
            self._close_chunk()
        finally:
            self._file.close()

    def __enter__(self) -> Recording:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _block(self, name: str, block_class: type, data: bytes, layout: Layout | None = None) -> None:
        stamp_ns, first_cycle, _count = head_of(data)
        if self._file.chunks_ready:
            self._file.finish_chunks()
        if first_cycle >= self._chunk_end:
            self._begin_chunk(first_cycle)
        unit = self._units.get((name, block_class)) or self._unit(name, block_class)
        unit.add(stamp_ns, data, layout)

    def _unit(self, name: str, block_class: type) -> _Unit:
        blocks = self._topic(topic_of(name, "block"), f"cnc_ptp/msg/{block_class.__name__}")
        blocks.has_blocks = True
        states = None if block_class is PlcBlock else partial(self._states_topic, name)
        if states is not None:
            states(kind_of(block_class))
        unit = self._units[name, block_class] = _Unit(block_class, blocks, states)
        return unit

    def _states_topic(self, name: str, kind: StateKind) -> _Topic:
        topic = self._topic(topic_of(name, kind.leaf), kind.state.name)
        topic.has_states = True
        return topic

    def _single(self, topic: str, type_name: str, value: Any) -> None:
        self._require_open(topic)
        data = encode(load_schema(type_name), value, self.stamps.header_of)
        cycle = value.cycle if hasattr(value, "cycle") else value.first_cycle
        self._topic(topic, type_name).add(READY, (self.stamps.at(cycle), data))

    def _topic(self, topic: str, type_name: str) -> _Topic:
        known = self._topics.get(topic)
        if known is None:
            self._require_open(topic)
            known = _Topic(self._announce(topic, type_name), load_schema(type_name).name)
            self._topics[topic] = known
        elif type_name not in known.type_names:
            raise CncError(
                TWO_TYPES,
                f"recording {self.path}: topic {topic} holds {known.type_names[1]}, a message of "
                f"{full_name(type_name)} came",
                "it was not recorded",
            )
        return known

    def _announce(self, topic: str, type_name: str) -> int:
        return self._file.channel(topic, full_name(type_name), load_schema(type_name).text, offer(type_name))

    def _require_open(self, what: str) -> None:
        if self._closed:
            raise CncError(
                CLOSED, f"recording {self.path}: {what} came after the recording was closed", "it was not recorded"
            )

    def _begin_chunk(self, first_cycle: int) -> None:
        """Closes the chunks before the block that would exceed them: those of one topic do not overlap in time."""
        self._require_open(f"the block with first cycle {first_cycle}")
        if self._chunk_end != BEFORE_ALL:
            self._close_chunk()
        if self._split is not None:
            self._begin_part_if_due(self._split, first_cycle)
        self._chunk_end = first_cycle + self._chunk_cycles

    def _begin_part_if_due(self, split: Split, first_cycle: int) -> None:
        """The next part when this one is full: each has whole chunks, and its size is known when they are written."""
        if self._part_begin == BEFORE_ALL:
            self._part_begin = first_cycle
        if split.size:
            self._file.finish_chunks()
        seconds = (first_cycle - self._part_begin) * self.stamps.cycle_time_ns * 1e-9
        if not (0 < split.size <= self._file.size or 0 < split.seconds <= seconds):
            return
        self._part_begin = first_cycle
        try:
            self._file.close()
            self._file = self._new_file()
        except CncError:
            self._closed = True
            raise
        for name, topic in self._topics.items():
            topic.channel_id = self._announce(name, topic.type_names[1])

    def _close_chunk(self) -> None:
        """A chunk of commands and all that is rare, one of the blocks, then one for the states of each unit.

        Who computes the run again reads the commands of hours, and then blocks of some seconds.
        """
        self._file.finish_chunks()
        topics = [*self._topics.values()]
        states = [topic for topic in topics if topic.has_states]
        self._write_chunk([topic for topic in topics if not (topic.has_states or topic.has_blocks)])
        self._write_chunk([topic for topic in topics if topic.has_blocks])
        for topic in states:
            self._write_chunk([topic])

    def _write_chunk(self, topics: Sequence[_Topic]) -> None:
        for topic in topics:
            self._hand_over(topic)
        self._file.close_chunk()

    def _hand_over(self, topic: _Topic) -> None:
        runs = topic.take()[::-1]
        while runs:
            encoder, collected = runs.pop()
            for rows, times in encoder.messages(collected, self.stamps):
                self._file.messages(topic.channel_id, rows, times)


def offer(type_name: str) -> dict[str, str]:
    """Metadata of a topic's channel: quality of service, hash of the type."""
    return {QOS: profiles_text(offered(full_name(type_name))), TYPE_HASH: type_hash(type_name)}


def media_type(name: str) -> str:
    return "application/yaml" if name.endswith((".yaml", ".yml")) else "text/plain"


def topic_of(name: str, leaf: str) -> str:
    return f"/{name.strip('/')}/{leaf}"
