"""Writes the recording of a run: per-cycle states, blocks, events and commands as an MCAP file.

There is no clock here: the log time of a message is the stamp of its cycle, and the caller says when wall time has
passed.
"""

from __future__ import annotations

from collections.abc import Hashable
from copy import copy
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol

import numpy as np

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import (
    AxisBlock,
    ChannelBlock,
    CommandRecord,
    CycleBlock,
    CycleTick,
    Event,
    PlcBlock,
    SpindleBlock,
)
from cnc_ptp.recording.bag import QOS, TYPE_HASH
from cnc_ptp.recording.blocks import (
    BlockLayout,
    Packer,
    StateBlock,
    StateKind,
    Times,
    cycles_of,
    fill_states,
    kind_of,
    require_shape,
)
from cnc_ptp.recording.layout import Bytes, Header, encode, header_at, repeat
from cnc_ptp.recording.mcap_file import HEAD_SIZE, McapFile
from cnc_ptp.recording.qos import offered, profiles_text
from cnc_ptp.recording.schemas import full_name, load_schema, type_hash

TWO_TYPES = 26008
CLOSED = 26009
ROOM = bytes(HEAD_SIZE)  # for the record head in front of each message
MACHINE_FILE = "machine.yaml"
METADATA = "cnc_ptp"
MISSING = "missing"
"""Key of the metadata: what a recording that was closed for a dead recorder does not have."""
BEFORE_ALL = -1  # end of the chunk before the first block


@dataclass(frozen=True, slots=True)
class TickMessage:
    """A CycleTick with the field that only a paced clock has."""

    first_cycle: int
    count: int
    scheduled_monotonic_ns: int = 0


class Stamps:
    """Cycle number -> ns since the epoch."""

    def __init__(self, start_ns: int, cycle_time_ns: int) -> None:
        self.start_ns = start_ns
        self.cycle_time_ns = cycle_time_ns

    def at(self, cycle: int) -> int:
        return self.start_ns + cycle * self.cycle_time_ns

    def at_all(self, cycles: Times) -> Times:
        return np.uint64(self.start_ns) + cycles * np.uint64(self.cycle_time_ns)

    def header_of(self, value: Any) -> Header:
        """The header of an event, command or handshake (cycle) or of a block (first_cycle)."""
        return header_at(self.at(value.cycle if hasattr(value, "cycle") else value.first_cycle))


class _Encoder(Protocol):
    """Turns the items of a topic into messages: rows (n, HEAD_SIZE + size) and times (n,) for each size."""

    def messages(self, collected: list[Any], stamps: Stamps) -> list[tuple[Bytes, Times]]: ...


class _States:
    """Packed blocks of one length -> state messages, one per cycle."""

    def __init__(self, kind: StateKind, count: int, packer: Packer) -> None:
        self.kind = kind
        self.count = count
        self.packer = packer

    def messages(self, collected: list[bytes], stamps: Stamps) -> list[tuple[Bytes, Times]]:
        layout = self.kind.layout
        rows = self.packer.rows(collected)
        cycles = cycles_of(rows, self.count)
        times = stamps.at_all(cycles)
        raw = repeat(ROOM + layout.template, len(cycles))
        fill_states(self.kind, raw[:, HEAD_SIZE:].view(layout.dtype)[:, 0], rows, cycles, times)
        return [(raw, times)]


class _Blocks:
    """Packed blocks of one shape -> block messages."""

    def __init__(self, shape: BlockLayout) -> None:
        self.shape = shape
        self.packer = shape.packer

    def messages(self, collected: list[bytes], stamps: Stamps) -> list[tuple[Bytes, Times]]:
        layout = self.shape.layout
        rows = self.packer.rows(collected)
        times = stamps.at_all(rows["first_cycle"].astype(np.uint64))
        raw = repeat(ROOM + layout.template, len(rows))
        self.shape.fill(raw[:, HEAD_SIZE:].view(layout.dtype)[:, 0], rows, times)
        return [(raw, times)]


class _Ready:
    """(time, CDR) pairs -> messages."""

    def messages(self, collected: list[tuple[int, bytes]], _stamps: Stamps) -> list[tuple[Bytes, Times]]:
        result: list[tuple[Bytes, Times]] = []
        for _, group in groupby(collected, key=lambda message: len(message[1])):
            times, contents = zip(*group, strict=True)
            joined = bytearray().join(ROOM + content for content in contents)
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
        self._encoder: _Encoder | None = None
        self._items: list[Any] = []

    def add(self, encoder: _Encoder, item: Any) -> None:
        if encoder is not self._encoder:
            self._encoder = encoder
            self._items = []
            self.runs.append((encoder, self._items))
        self._items.append(item)

    def take(self) -> list[tuple[_Encoder, list[Any]]]:
        runs, self.runs, self._encoder = self.runs, [], None
        return runs


class _Unit:
    """Where the blocks of a unit go, and how blocks of each shape are encoded."""

    def __init__(self, kind: StateKind, blocks: _Topic, states: _Topic) -> None:
        self.kind = kind
        self.blocks = blocks
        self.states = states
        self._encoders: dict[Hashable, tuple[_Blocks, _States]] = {}

    def encoders(self, key: Hashable, block: StateBlock) -> tuple[_Blocks, _States]:
        known = self._encoders.get(key)
        if known is None:
            require_shape(self.kind, block)
            blocks = _Blocks(BlockLayout(self.kind.block, block))
            known = self._encoders[key] = blocks, _States(self.kind, block.count, blocks.packer)
        return known


class Recording:
    """A recording being written.

    Offline, `axis_block`, `spindle_block` and `channel_block` record a unit's block with its per-cycle states. In the
    graph the block itself arrives as bytes and goes to `raw`, and `states` records the states alone. A chunk is
    closed every `chunk_seconds` of recorded time and whenever `flush_if_due` sees `flush_seconds` of wall time passed;
    then the operating system gets it. A killed process loses only what came after its last chunk.

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
    ) -> None:
        self.path = Path(path)
        self.stamps = Stamps(start_ns, cycle_time_ns)
        self._chunk_cycles = max(1, round(chunk_seconds * 1e9 / cycle_time_ns))
        self._flush_seconds = flush_seconds
        self._chunk_end = BEFORE_ALL
        self._flushed_at: float | None = None
        self._topics: dict[str, _Topic] = {}
        self._units: dict[tuple[str, type], _Unit] = {}
        self._encoders: dict[Hashable, _Blocks | _States] = {}
        self._closed = False
        self._file = McapFile(self.path, level)
        self.attachment(MACHINE_FILE, "application/yaml", machine_yaml)
        self._file.metadata(METADATA, {"start_ns": str(start_ns), "cycle_time_ns": str(cycle_time_ns)})

    def block(self, name: str, block: CycleBlock) -> None:
        """A block of any unit, and its per-cycle states if it has any."""
        if isinstance(block, AxisBlock):
            self.axis_block(name, block)
        elif isinstance(block, SpindleBlock):
            self.spindle_block(name, block)
        elif isinstance(block, ChannelBlock):
            self.channel_block(name, block)
        else:
            self.plc_block(block, name)

    # whole blocks with their states (offline)

    def axis_block(self, name: str, block: AxisBlock) -> None:
        """`/<name>/block` and, per cycle, `/<name>/state`."""
        self._block_and_states(name, block, (block.count, block.master))

    def spindle_block(self, name: str, block: SpindleBlock) -> None:
        if block.commands or block.refused:
            self.spindle_block_message(name, block)
            self.states(name, block)
        else:
            self._block_and_states(name, block, (block.count, block.master, block.master_wanted, block.source))

    def channel_block(self, name: str, block: ChannelBlock) -> None:
        """`/<name>/block`, per cycle `/<name>/state`, and `/<name>/handshake` for each request in it."""
        if block.commands or block.requests:
            self.channel_block_message(name, block)
            self.states(name, block)
        else:
            self._block_and_states(name, block, _channel_shape(block))
        for request in block.requests:
            self._single(topic_of(name, "handshake"), "cnc_ptp/msg/HandshakeRequest", request)

    # states alone, blocks alone

    def states(self, name: str, block: StateBlock) -> None:
        """`/<name>/state` alone, a message per cycle of the block (graph)."""
        kind = kind_of(block)
        encoder = self._encoders.get((kind, block.count))
        if encoder is None:
            encoder = self._encoders[kind, block.count] = _States(kind, block.count, kind.packer(block.count))
        self._add_packed(topic_of(name, "state"), kind.state.name, encoder, block)

    def _block_alone(self, name: str, block: StateBlock) -> None:
        require_shape(kind_of(block), block)
        self._block(topic_of(name, "block"), kind_of(block).block.name, block, None)

    def spindle_block_message(self, name: str, block: SpindleBlock) -> None:
        """`/<name>/block`."""
        message: Any = copy(block)
        message.refused = [refusal.encode() for refusal in block.refused]
        self._block_alone(name, message)

    def channel_block_message(self, name: str, block: ChannelBlock) -> None:
        self._block_alone(name, block)

    def plc_block(self, block: PlcBlock, name: str = "plc") -> None:
        self._block(topic_of(name, "block"), "cnc_ptp/msg/PlcBlock", block, None if block.commands else "plc")

    def tick(self, tick: CycleTick, scheduled_monotonic_ns: int = 0) -> None:
        """`/clock/tick`."""
        message = TickMessage(tick.first_cycle, tick.count, scheduled_monotonic_ns)
        self._block("/clock/tick", "cnc_ptp/msg/CycleTick", message, "tick")

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
        self._file.finish_chunk()

    def close(self) -> None:
        """Writes the rest and the summary. A second call has no effect."""
        if self._closed:
            return
        self._closed = True
        self._chunk_end = BEFORE_ALL
        try:
            self._hand_over()
        finally:
            self._file.close()

    def __enter__(self) -> Recording:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _block_and_states(self, name: str, block: StateBlock, shape: Hashable) -> None:
        unit = self._units.get((name, type(block))) or self._unit(name, block)
        blocks, states = unit.encoders(shape, block)
        row = blocks.packer.pack(block)
        if block.first_cycle >= self._chunk_end:
            self._begin_chunk(block.first_cycle)
        unit.blocks.add(blocks, row)
        unit.states.add(states, row)

    def _unit(self, name: str, block: StateBlock) -> _Unit:
        kind = kind_of(block)
        blocks = self._topic(topic_of(name, "block"), kind.block.name)
        states = self._topic(topic_of(name, "state"), kind.state.name)
        unit = self._units[name, type(block)] = _Unit(kind, blocks, states)
        return unit

    def _block(self, topic: str, type_name: str, block: Any, shape: Hashable) -> None:
        """`shape`: None for blocks that hold more than numbers at known places."""
        if shape is None:
            if block.first_cycle >= self._chunk_end:
                self._begin_chunk(block.first_cycle)
            self._single(topic, type_name, block)
            return
        encoder = self._encoders.get((type_name, shape))
        if encoder is None:
            encoder = self._encoders[type_name, shape] = _Blocks(BlockLayout(load_schema(type_name), block))
        self._add_packed(topic, type_name, encoder, block)

    def _add_packed(self, topic: str, type_name: str, encoder: _Blocks | _States, block: Any) -> None:
        if self._file.chunk_ready:
            self._file.finish_chunk()
        row = encoder.packer.pack(block)
        if block.first_cycle >= self._chunk_end:
            self._begin_chunk(block.first_cycle)
        self._topic(topic, type_name).add(encoder, row)

    def _single(self, topic: str, type_name: str, value: Any) -> None:
        self._require_open(topic)
        data = encode(load_schema(type_name), value, self.stamps.header_of)
        cycle = value.cycle if hasattr(value, "cycle") else value.first_cycle
        self._topic(topic, type_name).add(READY, (self.stamps.at(cycle), data))

    def _topic(self, topic: str, type_name: str) -> _Topic:
        known = self._topics.get(topic)
        if known is None:
            self._require_open(topic)
            schema = load_schema(type_name)
            known = _Topic(self._file.channel(topic, full_name(type_name), schema.text, offer(type_name)), schema.name)
            self._topics[topic] = known
        elif type_name not in known.type_names:
            raise CncError(
                TWO_TYPES,
                f"recording {self.path}: topic {topic} holds {known.type_names[1]}, a message of "
                f"{full_name(type_name)} came",
                "it was not recorded",
            )
        return known

    def _require_open(self, what: str) -> None:
        if self._closed:
            raise CncError(
                CLOSED, f"recording {self.path}: {what} came after the recording was closed", "it was not recorded"
            )

    def _begin_chunk(self, first_cycle: int) -> None:
        """Closes the chunk before the block that would exceed it, so that chunks do not overlap in time."""
        self._require_open(f"the block with first cycle {first_cycle}")
        if self._chunk_end != BEFORE_ALL:
            self._close_chunk()
        self._chunk_end = first_cycle + self._chunk_cycles

    def _close_chunk(self) -> None:
        self._hand_over()
        self._file.close_chunk()

    def _hand_over(self) -> None:
        for topic in self._topics.values():
            for encoder, collected in topic.take():
                for rows, times in encoder.messages(collected, self.stamps):
                    self._file.messages(topic.channel_id, rows, times)


def offer(type_name: str) -> dict[str, str]:
    """Metadata of a topic's channel: quality of service, hash of the type."""
    return {QOS: profiles_text(offered(full_name(type_name))), TYPE_HASH: type_hash(type_name)}


def topic_of(name: str, leaf: str) -> str:
    return f"/{name.strip('/')}/{leaf}"


def _channel_shape(block: ChannelBlock) -> Hashable:
    return block.count, tuple(block.axes), len(block.set_position)
