"""What is whole in a damaged or cut recording, as a file of its own: `cnc_ptp recover`."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from errno import EEXIST
from pathlib import Path

from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, Schema
from mcap.well_known import MessageEncoding, SchemaEncoding
from mcap.writer import MCAP0_MAGIC

from cnc_ptp.errors import CncError
from cnc_ptp.recording.bag import FILE, RECORD
from cnc_ptp.recording.mcap_chunks import (
    CORRUPT,
    KNOWN_OPCODES,
    NOTHING_LEFT,
    STEP,
    MessageRun,
    RawRecord,
    RecordReader,
)
from cnc_ptp.recording.mcap_file import METADATA, MISSING, RECORD_PREFIX, McapFile
from cnc_ptp.recording.mcap_index import McapIndex
from cnc_ptp.recording.new_recording import NOTHING_WRITTEN, folder_beside, in_place_of, not_written
from cnc_ptp.recording.origin import WITHOUT
from cnc_ptp.recording.overwriting import require_recording, why_not_made
from cnc_ptp.recording.parts import NO_FOLDER, PartsFolder, describe_file, information_of, named_files_of, replace_parts


@dataclass
class Recovered:
    """What was written, why the rest was not, and what was wrong without a loss."""

    messages: int = 0
    lost: list[str] = field(default_factory=list)
    mended: list[str] = field(default_factory=list)


def recover(source: str | Path, output: str | Path) -> Recovered:
    """Writes whole records of `source`, chunk by chunk, to `output`; chunks that are damaged are left out.

    A folder of parts becomes a folder of parts, without those of which nothing can be read. What is there under the
    name of `output` is unchanged until all is written; of a folder its parts are replaced, other files stay. Raises
    CncError 26001, 26002, 26007 (not written), 26014, 26117, 26224 (nothing can be saved); of a folder 26020, and 26001
    or 26002 when no part can be read.
    """
    path, new = Path(source), Path(output)
    if not path.is_file() or path.name == FILE:
        return _recover_parts(path, new)
    require_recording(new, NOTHING_WRITTEN)
    with in_place_of(new) as part:
        recovered = _recover_file(path, part)
        require_something(path, recovered)
    describe_file(new)
    return recovered


def require_something(path: Path, recovered: Recovered) -> None:
    """Raises CncError 26224."""
    if not recovered.messages:
        why = "".join(f"; {text}" for text in recovered.lost)
        raise CncError(NOTHING_LEFT, f"recording {path}: holds no message that can be saved{why}", NOTHING_WRITTEN)


def _recover_parts(source: Path, output: Path) -> Recovered:
    """`lost` names the part."""
    parts = named_files_of(source)
    target = Path(os.path.realpath(output))
    try:
        with folder_beside(output) as new:
            if target.exists() and not target.is_dir():
                raise FileExistsError(EEXIST, os.strerror(EEXIST))
            try:
                whole = _write_parts(parts, new)
                require_something(source, whole)
                replace_parts(new, target)
            except OSError as error:
                raise not_written(output, str(error.strerror)) from error
    except OSError as error:
        reason = f"recording {output}: no folder for its parts: {why_not_made(error, output)}"
        raise CncError(NO_FOLDER, reason, NOTHING_WRITTEN) from error
    return whole


def _write_parts(parts: list[Path], output: Path) -> Recovered:
    readable: list[tuple[Path, list[str]]] = []
    whole, gap = Recovered(), list[str]()
    for part in parts:
        try:
            _Records(part).close()
            readable.append((part, gap))
            gap = []
        except CncError as error:
            if part is parts[-1] and not readable:
                raise
            gap.append(part.name)
            whole.lost.append(f"{part.name}: {error.reason}")
    folder = PartsFolder(output)
    for number, (part, before) in enumerate(readable):
        target = folder.next_part()
        recovered = _recover_file(part, target, before, gap if number == len(readable) - 1 else [])
        folder.add(target, information_of(target))
        whole.messages += recovered.messages
        whole.lost += [f"{part.name}: {text}" for text in recovered.lost]
        whole.mended += [f"{part.name}: {text}" for text in recovered.mended]
    return whole


def _recover_file(path: Path, output: Path, before: Sequence[str] = (), behind: Sequence[str] = ()) -> Recovered:
    """`before`, `behind`: parts of the run that cannot be read; without those before it cannot be computed again."""
    records = _Records(path)
    with McapFile(output) as file:
        schemas, channels, damage = _names_of_summary(path)
        copy = _Copy(records, file, schemas, channels)
        for record in records:
            copy.take(record)
        copy.take_loose()
        if records.end:
            copy.recovered.lost.append(records.end)
        if damage and not copy.recovered.lost:
            copy.recovered.mended.append(f"the index at its end was {damage}, all messages are kept")
        lost = [*(f"{name} is missing" for name in [*before, *behind]), *copy.recovered.lost]
        without = {WITHOUT: f"what was before it is lost: {', '.join(before)}"} if before else {}
        if lost:
            file.metadata(METADATA, {MISSING: "; ".join(lost), **without})
    return copy.recovered


def _names_of_summary(path: Path) -> tuple[dict[int, Schema], dict[int, Channel], str]:
    """Schemas and channels; the chunk in which they were announced may be damaged. Why there are none."""
    try:
        index = McapIndex(path)
    except CncError as error:
        return {}, {}, "damaged" if error.number == CORRUPT else ""
    index.close()
    return (index.schemas, index.channels, "") if index.indexed else ({}, {}, "missing")


class _Records(RecordReader):
    """The records of the data section that are whole; `end` says why there are no more, if the file was cut."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.end = ""
        try:
            self._stream = path.open("rb")
            self._size = os.fstat(self._stream.fileno()).st_size
            begin = self._stream.read(len(MCAP0_MAGIC))
        except OSError as error:
            raise self.unreadable(error) from error
        try:
            self.require_magic(begin)
        except CncError:
            self.close()
            raise

    def close(self) -> None:
        self._stream.close()

    def __iter__(self) -> Iterator[RawRecord]:
        offset = len(MCAP0_MAGIC)
        with self._stream as stream:
            while True:
                head = stream.read(RECORD_PREFIX.size)
                opcode, length = RECORD_PREFIX.unpack(head) if len(head) == RECORD_PREFIX.size else (0, 0)
                start = offset + RECORD_PREFIX.size
                if opcode == Opcode.DATA_END:
                    return
                if opcode not in KNOWN_OPCODES or length > self._size - start:
                    self.end = f"nothing whole follows at offset {offset} of {self._size}"
                    return
                yield RawRecord(offset, opcode, memoryview(stream.read(length)))
                offset = start + length


class _Copy:
    """Takes record after record into a new file."""

    def __init__(
        self, records: _Records, file: McapFile, schemas: dict[int, Schema], channels: dict[int, Channel]
    ) -> None:
        self.recovered = Recovered()
        self._records = records
        self._file = file
        self._schemas = dict(schemas)
        self._channels = dict(channels)
        self._ids: dict[int, int] = {}
        """Channel there -> channel here."""
        self._left_out: set[int] = set()
        """Channels whose messages cannot be taken."""
        self._loose = bytearray()
        """Messages that are in no chunk."""
        self._last_loose: RawRecord | None = None

    def take(self, record: RawRecord) -> None:
        with self._noted(record):
            if record.opcode == Opcode.CHUNK:
                self.take_loose()  # may name its channels
                self._take_items(record, self._records.in_chunk(record))
            elif record.opcode in (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE):
                self._loose += RECORD_PREFIX.pack(record.opcode, len(record.body))
                self._loose += record.body
                self._last_loose = record
                if len(self._loose) > STEP:
                    self.take_loose()
            elif record.opcode == Opcode.ATTACHMENT:
                part = self._records.attachment(record)
                self._file.attachment(part.name, part.media_type, part.data, part.log_time)
            elif record.opcode == Opcode.METADATA:
                self._metadata(self._records.parse(Metadata.read, record))

    def take_loose(self) -> None:
        """The messages that are in no chunk become one."""
        if self._last_loose is not None:
            record, content = self._last_loose, bytes(self._loose)
            self._last_loose, self._loose = None, bytearray()
            with self._noted(record):
                self._take_items(record, self._records.in_records(record, content))

    @contextmanager
    def _noted(self, record: RawRecord) -> Iterator[None]:
        """What cannot be read is noted; what cannot be written raises."""
        try:
            yield
        except CncError as error:
            if self._file.failed:
                raise
            self._note(error.reason.partition(": corrupt ")[2] or error.reason)
        except struct.error:
            self._note(f"at offset {record.offset}: a record that is too short")

    def _note(self, text: str) -> None:
        if text not in self.recovered.lost:
            self.recovered.lost.append(text)

    def _take_items(self, record: RawRecord, items: Iterator[Schema | Channel | MessageRun]) -> None:
        """All of a whole chunk, without messages of channels that are not of ROS 2: that is noted once."""
        runs: list[MessageRun] = []
        for item in items:
            if isinstance(item, Schema):
                self._schemas[item.id] = item
            elif isinstance(item, Channel):
                self._channels[item.id] = item
            else:
                runs.append(item)
        for run in runs:
            if run.channel_id in self._left_out:
                continue
            with self._noted(record):
                id = self._id_of(run.channel_id, record)
                self._file.messages(id, run.rows.copy(), run.head["log_time"].copy())
                self.recovered.messages += len(run.rows)
        self._file.close_chunk()
        self._file.finish_chunks()

    def _id_of(self, id: int, record: RawRecord) -> int:
        if id not in self._ids:
            channel = self._channels.get(id)
            schema = self._schemas.get(channel.schema_id) if channel else None
            if channel is None or schema is None:
                raise self._records.corrupt(record.offset, f"a message of the unknown channel {id} is in the chunk")
            if channel.message_encoding != MessageEncoding.CDR or schema.encoding != SchemaEncoding.ROS2:
                self._left_out.add(id)
                raise self._records.corrupt(record.offset, f"{channel.topic} holds no messages of ROS 2")
            self._ids[id] = self._file.channel(
                channel.topic, schema.name, schema.data.decode(errors="replace"), channel.metadata
            )
        return self._ids[id]

    def _metadata(self, metadata: Metadata) -> None:
        """That of rosbag2 is made anew."""
        if metadata.name != RECORD:
            self._file.metadata(metadata.name, metadata.metadata)
