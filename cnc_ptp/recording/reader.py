"""Reads a recording: per-cycle states as NumPy arrays, events, commands, machine file, statistics."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, Schema
from mcap_ros2.decoder import DecoderFactory

from cnc_ptp.protocol.blocks import CommandRecord, Event, read_values
from cnc_ptp.protocol.event_values import read_event_values
from cnc_ptp.recording.bag import QOS
from cnc_ptp.recording.mcap_chunks import McapRecords, MessageRun, RawRecord, RecordReader, nothing_left
from cnc_ptp.recording.mcap_file import METADATA, MISSING
from cnc_ptp.recording.origin import notes_of
from cnc_ptp.recording.parts import files_of
from cnc_ptp.recording.writer import CHECKPOINT, CHECKPOINT_TEXT, MACHINE_FILE
from cnc_ptp.wire.layout import Bytes, Layout, Records, fixed_layout
from cnc_ptp.wire.schemas import full_name, recorded_schema

AXIS_STATE = "cnc_ptp/msg/AxisState"
SPINDLE_STATE = "cnc_ptp/msg/SpindleState"
CHANNEL_STATE = "cnc_ptp/msg/ChannelState"
THREAD_STATE = "cnc_ptp/msg/ThreadState"
STATE_TYPES = (AXIS_STATE, SPINDLE_STATE, CHANNEL_STATE)
TICK = "cnc_ptp/msg/CycleTick"
EVENT = "cnc_ptp/msg/Event"
COMMAND = "cnc_ptp/msg/CommandRecord"
OFFSETS = "cnc_ptp/msg/ChannelOffsets"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"
DRIVE_STOP = "cnc_ptp/msg/DriveStop"


@dataclass(slots=True)
class TopicInfo:
    """A topic of the file; log times in ns, `qos`: its offered_qos_profiles."""

    topic: str
    type_name: str
    count: int = 0
    first_ns: int = 0
    last_ns: int = 0
    qos: str = ""

    def add(self, run: MessageRun) -> None:
        """Counts messages."""
        times = run.head["log_time"]
        self.first_ns = int(times.min()) if self.count == 0 else min(self.first_ns, int(times.min()))
        self.last_ns = max(self.last_ns, int(times.max()))
        self.count += len(times)


class Diagnostic(NamedTuple):
    """One status of a diagnostics message."""

    time_ns: int
    name: str
    values: dict[str, str]


class DriveStop(NamedTuple):
    """What the drive of a unit has done on its own after its last setpoint (DriveStop.msg), mm or deg.

    first_cycle      of both columns, which have one value for each cycle
    """

    unit: str
    first_cycle: int
    actual_position: npt.NDArray[np.float64]
    actual_velocity: npt.NDArray[np.float64]


class Coordinates(NamedTuple):
    """What lies between programmed and machine positions of a channel from a cycle on (a part of ChannelOffsets).

    `axes` by name; `systems`: coordinate systems and kinematics (#FACE, #CYL) by command, `origin` by axis: machine
    position of the zero point of the kinematics (mm, deg), empty without.
    """

    cycle: int
    channel: str
    axes: tuple[str, ...]
    systems: tuple[str, ...]
    origin: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Reduced:
    """What a long recording (`long_recording.py`) keeps of all its cycles.

    stride       cycles from one of its states to the next; two together are the extremes of 2 · stride cycles
    last_cycle   of all states
    path_stride  cycles from one of `paths` to the next, which are states as they were, by axis
    largest      following error and its cycle, by axis
    in_program   cycles in which a program was being executed, by channel
    missing      blocks
    """

    stride: int
    last_cycle: int
    path_stride: int
    paths: dict[str, Records]
    largest: dict[str, tuple[float, int]]
    in_program: dict[str, int]
    missing: int


class RawMessage(NamedTuple):
    """A message as it lies in the file."""

    topic: str
    type_name: str
    log_time_ns: int
    cdr: bytes


@dataclass
class Recorded:
    """A recording that was read.

    `states[topic]` is a structured array (n,) in the order of the file with the fields of the message (`cycle`,
    `set_position`, …, `header.stamp.sec`, `header.stamp.nanosec`), `threads[channel]` one with the cycles of its
    threads. `complete` is False when the file was cut off;
    `missing` then says what is missing. `reduced`: of a long recording, whose states are extremes of many cycles.
    """

    path: Path
    complete: bool = False
    missing: str = ""
    machine_yaml: str = ""
    attachments: dict[str, str] = field(default_factory=dict)
    metadata: dict[str, str] = field(default_factory=dict)
    topics: dict[str, TopicInfo] = field(default_factory=dict)
    states: dict[str, Records] = field(default_factory=dict)
    threads: dict[str, Records] = field(default_factory=dict)
    ticks: Records | None = None
    events: list[Event] = field(default_factory=list)
    commands: list[CommandRecord] = field(default_factory=list)
    diagnostics: list[Diagnostic] = field(default_factory=list)
    coordinates: list[Coordinates] = field(default_factory=list)
    drive_stops: list[DriveStop] = field(default_factory=list)
    reduced: Reduced | None = None

    @property
    def stride(self) -> int:
        """Cycles from one state to the next; more than 1 where they were reduced."""
        return 1 if self.reduced is None else self.reduced.stride

    @property
    def start_ns(self) -> int:
        return int(self.metadata.get("start_ns", "0"))

    @property
    def cycle_time_ns(self) -> int:
        return int(self.metadata.get("cycle_time_ns", "1000000"))

    @property
    def last_cycle(self) -> int:
        """The last cycle of which a state was recorded, -1 if none was."""
        if self.reduced is not None:
            return self.reduced.last_cycle
        return max((int(rows["cycle"].max()) for rows in self.states.values()), default=-1)

    @property
    def longest(self) -> int:
        """The largest number of states of a unit."""
        return max((len(rows) for rows in self.states.values()), default=0)

    @property
    def block_cycles(self) -> int:
        """Cycles of a block, as most ticks have it; 10 where no ticks were recorded."""
        if self.ticks is None or len(self.ticks) == 0:
            return 10
        counts, numbers = np.unique(self.ticks["count"], return_counts=True)
        return int(counts[numbers.argmax()])

    def of_type(self, type_name: str) -> dict[str, Records]:
        """The per-cycle states of one message type, by the name of the unit."""
        return {
            topic.removeprefix("/").removesuffix("/state"): rows
            for topic, rows in self.states.items()
            if self.topics[topic].type_name == type_name
        }

    def seconds(self, cycles: npt.NDArray[np.uint64]) -> npt.NDArray[np.float64]:
        """Time since cycle 0 in s."""
        return cycles.astype(np.float64) * (self.cycle_time_ns * 1e-9)


def read_recording(path: str | Path) -> Recorded:
    """Reads everything that is whole in a file, or in the parts of a folder.

    Raises CncError 26001 to 26005 (see McapRecords, schemas), 26014 and 26016.
    """
    return read_with(Reader(Path(path)))


def read_with(reader: Reader) -> Recorded:
    """What a reader makes of the files of its path, one after another."""
    for file in files_of(reader.recorded.path):
        records = McapRecords(file)
        reader.begin(records)
        for record in records:
            reader.take(record)
        reader.end_of_file(records.missing)
    return reader.finish()


def require_messages(recorded: Recorded) -> None:
    """Raises CncError 26224 for a recording that was cut before its first message."""
    if recorded.missing and not recorded.topics:
        raise nothing_left(recorded.path)


def topics_of(path: str | Path) -> dict[str, TopicInfo]:
    """The topics that have messages, piece by piece: nothing of them is kept. Same errors as read_recording."""
    by_name: dict[str, TopicInfo] = {}
    for file in files_of(Path(path)):
        records = McapRecords(file)
        names = Names(records, by_name)
        for record in records:
            names.take(record)
            for item in records.in_chunk(record) if record.opcode == Opcode.CHUNK else ():
                if isinstance(item, MessageRun):
                    names.topic(item, record).add(item)
                else:
                    names.add(item)
    return {topic: info for topic, info in by_name.items() if info.count}


def iter_messages(path: str | Path, topics: Collection[str] | None = None) -> Iterator[RawMessage]:
    """All whole messages in log-time order, as bytes; of the given topics only. Same errors as read_recording."""
    waiting: list[tuple[int, int, RawMessage]] = []
    serial = 0
    for records, names, record in _all_records(Path(path)):
        names.take(record)
        if record.opcode != Opcode.CHUNK:
            continue
        start = int.from_bytes(record.body[:8], "little")
        while waiting and waiting[0][0] < start:
            yield heapq.heappop(waiting)[2]
        for item in records.in_chunk(record):
            if not isinstance(item, MessageRun):
                names.add(item)
            elif topics is None or names.topic(item, record).topic in topics:
                for message in _raw_messages(names.topic(item, record), item):
                    heapq.heappush(waiting, (message.log_time_ns, serial := serial + 1, message))
    while waiting:
        yield heapq.heappop(waiting)[2]


def _all_records(path: Path) -> Iterator[tuple[McapRecords, Names, RawRecord]]:
    """Of a file, or of the parts of a folder one after another."""
    for file in files_of(path):
        records = McapRecords(file)
        names = Names(records, {})
        yield from ((records, names, record) for record in records)


def _raw_messages(info: TopicInfo, run: MessageRun) -> Iterator[RawMessage]:
    for time, content in zip(run.head["log_time"].tolist(), run.contents, strict=True):
        yield RawMessage(info.topic, info.type_name, time, content.tobytes())


class Names:
    """Schemas and channels of a file as they are read."""

    def __init__(self, records: RecordReader, by_name: dict[str, TopicInfo]) -> None:
        """`by_name`: topics of the files before, to which those of this file are added."""
        self.records = records
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self.topics: dict[int, TopicInfo] = {}
        self.by_name = by_name

    def take(self, record: RawRecord) -> None:
        if record.opcode == Opcode.SCHEMA:
            self.add(self.records.parse(Schema.read, record))
        elif record.opcode == Opcode.CHANNEL:
            self.add(self.records.parse(Channel.read, record))

    def add(self, item: Schema | Channel) -> None:
        if isinstance(item, Schema):
            self.schemas[item.id] = item
        elif item.id not in self.channels:
            schema = self.schemas.get(item.schema_id)
            type_name = full_name(schema.name) if schema else ""
            info = TopicInfo(item.topic, type_name, qos=item.metadata.get(QOS, ""))
            self.channels[item.id] = item
            self.topics[item.id] = self.by_name.setdefault(item.topic, info)

    def topic(self, run: MessageRun, record: RawRecord) -> TopicInfo:
        info = self.topics.get(run.channel_id)
        if info is None:
            raise self.records.corrupt(
                record.offset, f"a message of the unknown channel {run.channel_id} is in the chunk"
            )
        return info


class Reader:
    """Collects the contents of the records of files, one after another."""

    records: RecordReader
    names: Names
    _decoders: DecoderFactory

    def __init__(self, path: Path) -> None:
        self._by_name: dict[str, TopicInfo] = {}
        self._missing: list[str] = []
        self._notes: list[dict[str, str]] = []
        self.recorded = Recorded(path)
        self._layouts: dict[str, Layout] = {}
        self._rows: dict[str, list[Bytes]] = {}
        self._handlers: dict[str, Callable[[int, str, Any], None]] = {
            EVENT: self._event,
            COMMAND: self._command,
            DIAGNOSTICS: self._diagnostics,
            OFFSETS: self._offsets,
            DRIVE_STOP: self._drive_stop,
        }

    def begin(self, records: RecordReader) -> None:
        """The records that come are those of another file."""
        self.records = records
        self.names = Names(records, self._by_name)
        self._decoders = DecoderFactory()  # it knows schemas by their number in the file

    def end_of_file(self, missing: str) -> None:
        """`missing`: what the file lacks, if anything."""
        if missing:
            self._missing.append(missing)

    def take(self, record: RawRecord) -> None:
        self.names.take(record)
        if record.opcode == Opcode.CHUNK:
            for item in self.records.in_chunk(record):
                if isinstance(item, MessageRun):
                    self.messages(item, record)
                else:
                    self.names.add(item)
        elif record.opcode == Opcode.ATTACHMENT:
            attachment = self.records.attachment(record)
            self.attachment(attachment.name, attachment.data)
        elif record.opcode == Opcode.METADATA:
            self.metadata(self.records.parse(Metadata.read, record))

    def metadata(self, metadata: Metadata) -> None:
        if metadata.name == METADATA:
            self._notes.append(metadata.metadata)
            self.recorded.metadata = notes_of(self.recorded.path, self._notes)

    def attachment(self, name: str, data: bytes) -> None:
        if is_kept(name):
            self.recorded.attachments[name] = data.decode(errors="replace")

    def finish(self) -> Recorded:
        recorded = self.recorded
        recorded.missing = "; ".join(filter(None, [recorded.metadata.get(MISSING), *self._missing]))
        recorded.complete = not recorded.missing
        recorded.machine_yaml = recorded.attachments.pop(MACHINE_FILE, "")
        recorded.topics = {topic: info for topic, info in self._by_name.items() if info.count}
        for topic, rows in self._rows.items():
            self._store(recorded.topics[topic], self._layouts[topic].read(np.concatenate(rows).reshape(-1)))
        recorded.events.sort(key=lambda event: event.cycle)
        recorded.commands.sort(key=lambda command: command.cycle)
        recorded.coordinates.sort(key=lambda change: change.cycle)
        return recorded

    def _store(self, info: TopicInfo, rows: Records) -> None:
        if info.type_name == TICK:
            self.recorded.ticks = rows
        elif info.type_name == THREAD_STATE:
            self.recorded.threads[info.topic.removeprefix("/").removesuffix("/thread")] = rows
        else:
            self.recorded.states[info.topic] = rows

    def messages(self, run: MessageRun, record: RawRecord) -> None:
        info = self.names.topic(run, record)
        info.add(run)
        if info.type_name in (*STATE_TYPES, THREAD_STATE, TICK):
            self._fixed(info, run, record)
        elif info.type_name in self._handlers:
            self._decode(info, run, record)

    def _fixed(self, info: TopicInfo, run: MessageRun, record: RawRecord) -> None:
        layout = self._layouts.get(info.topic)
        if layout is None:
            schema = recorded_schema(info.type_name, self._schema(run).data)
            layout = self._layouts[info.topic] = fixed_layout(schema)
        if run.contents.shape[1] != layout.dtype.itemsize:
            raise self.records.corrupt(
                record.offset,
                f"a message of {info.topic} has {run.contents.shape[1]} bytes instead of {layout.dtype.itemsize} "
                f"({info.type_name} with empty frame_id)",
            )
        self.keep(info, layout, run.contents)

    def keep(self, info: TopicInfo, _layout: Layout, contents: Bytes) -> None:
        """Takes messages (n, size) whose numbers lie at fixed places."""
        if info.type_name == TICK:
            contents = contents.copy()  # much else is in their chunk
        self._rows.setdefault(info.topic, []).append(contents)

    def _decode(self, info: TopicInfo, run: MessageRun, record: RawRecord) -> None:
        decoder = self._decoder(info, run, record)
        handler = self._handlers[info.type_name]
        for time, content in zip(run.head["log_time"].tolist(), run.contents, strict=True):
            try:
                handler(time, info.topic, decoder(content.tobytes()) if decoder else None)
            except Exception as error:  # whatever the generated decoder raises on bytes that are no such message
                reason = f"a message of {info.topic} is not a {info.type_name}: {error!r}"
                raise self.records.corrupt(record.offset, reason) from error

    def _decoder(self, info: TopicInfo, run: MessageRun, record: RawRecord) -> Callable[[bytes], Any] | None:
        try:
            decoder: Callable[[bytes], Any] | None = self._decoders.decoder_for("cdr", self._schema(run))
        except Exception as error:  # whatever the library raises on a text that defines no message
            reason = f"the definition of {info.type_name} cannot be read: {error!r}"
            raise self.records.corrupt(record.offset, reason) from error
        return decoder

    def _schema(self, run: MessageRun) -> Schema:
        return self.names.schemas[self.names.channels[run.channel_id].schema_id]

    def _event(self, _time: int, _topic: str, message: Any) -> None:
        values = read_event_values(message)
        self.recorded.events.append(
            Event(message.cycle, message.source, message.severity, message.error_id, message.text, message.line, values)
        )

    def _command(self, _time: int, _topic: str, message: Any) -> None:
        self.recorded.commands.append(command_record(message))

    def _diagnostics(self, time: int, _topic: str, message: Any) -> None:
        for status in message.status:
            values = {pair.key: pair.value for pair in status.values}
            self.recorded.diagnostics.append(Diagnostic(time, status.name, values))

    def _offsets(self, _time: int, topic: str, message: Any) -> None:
        channel = topic.removeprefix("/").removesuffix("/offsets")
        self.recorded.coordinates.append(coordinates(channel, message))

    def _drive_stop(self, _time: int, _topic: str, message: Any) -> None:
        columns = np.array(message.actual_position), np.array(message.actual_velocity)
        self.recorded.drive_stops.append(DriveStop(message.unit, message.first_cycle, *columns))


def is_kept(attachment: str) -> bool:
    """Checkpoints are of no use but for a replay (run_inputs.py)."""
    return not attachment.startswith((CHECKPOINT, CHECKPOINT_TEXT))


def coordinates(channel: str, offsets: Any) -> Coordinates:
    """Of ChannelOffsets; those of older recordings have no origin."""
    origin = tuple(getattr(offsets, "origin", ()))
    return Coordinates(offsets.cycle, channel, tuple(offsets.axes), tuple(offsets.systems), origin)


def command_record(message: Any) -> CommandRecord:
    """Of a CommandRecord message; those of older recordings have fewer fields."""
    return CommandRecord(
        message.cycle,
        message.target,
        message.command,
        message.arguments_json,
        message.accepted,
        message.error_id,
        message.message,
        getattr(message, "id", 0),
        read_values(getattr(message, "values_json", "")),
        getattr(message, "job", 0),
        getattr(message, "warning_id", 0),
    )
