"""Where the messages of a topic lie in an MCAP file, from its summary; from the records themselves where it has none.

Nothing but the summary is read when a file is opened, and later only the chunks that are asked for: a file of an hour
opens like one of a second.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from mcap.opcode import Opcode
from mcap.records import Attachment, AttachmentIndex, Channel, Metadata, MetadataIndex, Schema, Statistics
from mcap.writer import MCAP0_MAGIC

from cnc_ptp.recording.mcap_chunks import MessageRun, RawRecord, RecordReader, nothing_left
from cnc_ptp.recording.mcap_file import HEAD_SIZE, INDEX_ENTRY, RECORD_PREFIX
from cnc_ptp.wire.layout import Bytes

END_SIZE = RECORD_PREFIX.size + 20 + len(MCAP0_MAGIC)
"""Bytes of the footer and the magic behind it."""
CHUNK_INDEX = struct.Struct("<QQQQI")
"""First and last time, offset and length of the chunk, bytes of the table that follows."""
INDEX_OFFSET = struct.Struct("<HQ")
"""A channel and the offset of its message index."""
SUMMARY_CRC = struct.Struct("<I")
NOT_CLOSED = "the file was not closed; what was recorded after its last whole chunk is missing"


class ChunkPlace(NamedTuple):
    """A chunk of a file: log times in ns, its channels, and where their message indexes lie (none: not known)."""

    first_ns: int
    last_ns: int
    offset: int
    length: int
    channels: Collection[int]
    indexes: Mapping[int, int]

    def may_hold(self, channels: Collection[int]) -> bool:
        """Messages of some of them; true where its channels are not known."""
        return not self.channels or any(channel in self.channels for channel in channels)


class McapIndex(RecordReader):
    """Chunks, channels and metadata of an MCAP file, which stays open until `close`.

    Raises CncError 26001 (cannot be opened), 26002 (not an MCAP file), 26003 (corrupt: where, why), 26206 (no chunks).
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.chunks: list[ChunkPlace] = []
        self.channels: dict[int, Channel] = {}
        self.schemas: dict[int, Schema] = {}
        self.counts: dict[int, int] = {}
        """Messages by channel."""
        self.metadata: list[Metadata] = []
        self.attachments: dict[str, int] = {}
        """Offsets by name."""
        self._chunk_count = -1
        """What the summary says; -1: nothing."""
        self._has_loose = False
        """There are messages in no chunk."""
        try:
            self._file = os.open(path, os.O_RDONLY)
            self._size = os.fstat(self._file).st_size
            begin = self._bytes(0, len(MCAP0_MAGIC))
        except OSError as error:
            raise self.unreadable(error) from error
        self.require_magic(begin)
        summary = self._summary_start()
        self.indexed = summary is not None
        """The file has a summary: it was closed."""
        if summary is not None:
            self._read_summary(summary)
        if not self.chunks and self._chunk_count != 0:
            self._scan()
        if not self.chunks and (self._has_loose or any(self.counts.values())):
            self.close()
            raise self.without_chunks()

    @property
    def missing(self) -> str:
        """What the file lacks; empty for one that was closed."""
        return "" if self.indexed else NOT_CLOSED

    def close(self) -> None:
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def ids_of(self, topic: str) -> set[int]:
        """The channels of a topic."""
        return {id for id, channel in self.channels.items() if channel.topic == topic}

    def attached(self, name: str) -> bytes:
        """The content of an attachment that the file has."""
        record: Attachment = self.attachment(self.record(self.attachments[name]))
        return record.data

    def runs(self, place: ChunkPlace, channels: Collection[int]) -> Iterator[MessageRun]:
        """The messages of some channels in a chunk, in the order of their log times as far as it has an index."""
        record = self.record(place.offset)
        if not place.indexes:
            yield from (run for run in self.in_chunk(record) if isinstance(run, MessageRun) and run[0] in channels)
            return
        data = np.frombuffer(self.chunk(record), dtype=np.uint8)
        for channel in channels:
            if channel in place.indexes:
                yield from self._indexed_runs(place, channel, data)

    def _indexed_runs(self, place: ChunkPlace, channel: int, data: Bytes) -> Iterator[MessageRun]:
        offsets = self._message_offsets(place.indexes[channel])
        if not len(offsets):
            return
        if int(offsets.max()) + HEAD_SIZE > len(data):
            raise self.corrupt(place.offset, "a message index leads behind the end of the chunk")
        offsets = offsets.astype(np.int64)
        sizes = data[offsets[:, None] + np.arange(1, RECORD_PREFIX.size)].view("<u8")[:, 0] + RECORD_PREFIX.size
        if (sizes < HEAD_SIZE).any() or (sizes > len(data) - offsets.astype(np.uint64)).any():
            raise self.corrupt(place.offset, "a message of the chunk is longer than the chunk")
        bounds = [0, *(np.flatnonzero(np.diff(sizes)) + 1).tolist(), len(sizes)]
        for first, end in pairwise(bounds):
            yield MessageRun(channel, _rows(data, offsets[first:end], int(sizes[first])))

    def _message_offsets(self, offset: int) -> npt.NDArray[Any]:
        body = self.record(offset).body
        if (len(body) - 6) % INDEX_ENTRY.itemsize:
            raise self.corrupt(offset, "the message index is no list of times and offsets")
        offsets: npt.NDArray[Any] = np.frombuffer(body[6:], dtype=INDEX_ENTRY)["offset"]
        return offsets

    # the file

    def _bytes(self, offset: int, length: int) -> bytes:
        return os.pread(self._file, length, offset)

    def record(self, offset: int) -> RawRecord:
        """The record at an offset."""
        head = self._bytes(offset, RECORD_PREFIX.size)
        if len(head) == RECORD_PREFIX.size:
            opcode, length = RECORD_PREFIX.unpack(head)
            start = offset + RECORD_PREFIX.size
            if length <= self._size - start:
                return RawRecord(offset, opcode, memoryview(self._bytes(start, length)))
        raise self.corrupt(offset, "no whole record begins there")

    def _summary_start(self) -> int | None:
        end = self._bytes(max(0, self._size - END_SIZE), END_SIZE)
        if len(end) < END_SIZE or not end.endswith(MCAP0_MAGIC) or end[0] != Opcode.FOOTER:
            return None
        record = RawRecord(self._size - END_SIZE, Opcode.FOOTER, memoryview(end)[RECORD_PREFIX.size :])
        footer = self.footer(record)
        start = int(footer.summary_start)
        if not start:
            return None
        summary = self._bytes(start, self._size - start - len(MCAP0_MAGIC) - SUMMARY_CRC.size)
        if footer.summary_crc not in (0, zlib.crc32(summary)):
            raise self.corrupt(start, "the CRC of the summary does not match its content")
        return start

    def _read_summary(self, start: int) -> None:
        for record in self._summary_records(start):
            if record.opcode == Opcode.CHUNK_INDEX:  # most are
                self.chunks.append(self._chunk_place(record))
            elif record.opcode == Opcode.STATISTICS:
                statistics = self.parse(Statistics.read, record)
                self.counts, self._chunk_count = statistics.channel_message_counts, statistics.chunk_count
            elif record.opcode == Opcode.METADATA_INDEX:
                place = self.parse(MetadataIndex.read, record)
                self.metadata.append(self.parse(Metadata.read, self.record(place.offset)))
            elif record.opcode == Opcode.ATTACHMENT_INDEX:
                attachment = self.parse(AttachmentIndex.read, record)
                self.attachments[attachment.name] = attachment.offset
            else:
                self._take_name(record)

    def _chunk_place(self, record: RawRecord) -> ChunkPlace:
        try:
            first, last, offset, length, size = CHUNK_INDEX.unpack_from(record.body)
            table = record.body[CHUNK_INDEX.size : CHUNK_INDEX.size + size]
            indexes = dict(INDEX_OFFSET.iter_unpack(table))
            return ChunkPlace(first, last, offset, length, indexes.keys(), indexes)
        except struct.error as error:
            raise self.corrupt(record.offset, f"the chunk index cannot be read: {error}") from error

    def _scan(self) -> None:
        """All whole records of a file without a list of its chunks, which are uncompressed for their channels."""
        self.counts, self.metadata, self.attachments = {}, [], {}
        for record in self._records(len(MCAP0_MAGIC)):
            self._take_name(record)
            if record.opcode == Opcode.METADATA:
                self.metadata.append(self.parse(Metadata.read, record))
            elif record.opcode == Opcode.ATTACHMENT:
                self.attachments[self.attachment(record).name] = record.offset
            elif record.opcode == Opcode.MESSAGE:
                self._has_loose = True
            elif record.opcode == Opcode.CHUNK:
                first, last = struct.unpack_from("<QQ", record.body)
                items = [*self.in_chunk(record)]
                channels = {item.channel_id for item in items if isinstance(item, MessageRun)}
                self.chunks.append(ChunkPlace(first, last, record.offset, len(record.body), channels, {}))
                for item in items:
                    self._count(item)

    def _summary_records(self, start: int) -> Iterator[RawRecord]:
        """They are many and small: one call reads all."""
        data = memoryview(self._bytes(start, self._size - start))
        offset = 0
        while offset + RECORD_PREFIX.size <= len(data):
            opcode, length = RECORD_PREFIX.unpack_from(data, offset)
            begin = offset + RECORD_PREFIX.size
            if opcode == Opcode.FOOTER or length > len(data) - begin:
                return
            yield RawRecord(start + offset, opcode, data[begin : begin + length])
            offset = begin + length

    def _records(self, offset: int) -> Iterator[RawRecord]:
        """The whole records from an offset on."""
        while offset + RECORD_PREFIX.size <= self._size:
            opcode, length = RECORD_PREFIX.unpack(self._bytes(offset, RECORD_PREFIX.size))
            start = offset + RECORD_PREFIX.size
            if opcode == Opcode.FOOTER or length > self._size - start:
                return
            yield RawRecord(offset, opcode, memoryview(self._bytes(start, length)))
            offset = start + length

    def _take_name(self, record: RawRecord) -> None:
        if record.opcode == Opcode.SCHEMA:
            self._count(self.parse(Schema.read, record))
        elif record.opcode == Opcode.CHANNEL:
            self._count(self.parse(Channel.read, record))

    def _count(self, item: Schema | Channel | MessageRun) -> None:
        if isinstance(item, Schema):
            self.schemas[item.id] = item
        elif isinstance(item, Channel):
            self.channels[item.id] = item
        else:
            self.counts[item.channel_id] = self.counts.get(item.channel_id, 0) + len(item.rows)


def require_chunks(path: Path, missing: str, files: Sequence[McapIndex]) -> None:
    """Raises CncError 26224 for a recording that was cut before its first message; `missing`: what it lacks."""
    if missing and not any(file.chunks for file in files):
        for file in files:
            file.close()
        raise nothing_left(path)


def _rows(data: Bytes, offsets: npt.NDArray[np.int64], size: int) -> Bytes:
    """Messages of one size as rows; without a copy where they follow each other."""
    first, count = int(offsets[0]), len(offsets)
    if (np.diff(offsets) == size).all():
        return data[first : first + count * size].reshape(count, size)
    rows: Bytes = data[offsets[:, None] + np.arange(size)]
    return rows
