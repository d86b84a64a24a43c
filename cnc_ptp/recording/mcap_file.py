"""Writes an MCAP file chunk by chunk from NumPy arrays of messages.

`mcap.writer.Writer` takes one message a call (4 µs). Here a call takes any number of messages of equal size, as rows of
bytes with room for the record head in front; all other records are written by the library's record classes. Records and
their order follow the specification at mcap.dev/spec: in a chunk the messages are topic by topic, its message indexes
give their order in time. Chunks of several topics may be of the same time.
"""

from __future__ import annotations

import contextlib
import os
import struct
import zlib
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.well_known import MessageEncoding, SchemaEncoding
from mcap.writer import LIBRARY_IDENTIFIER, MCAP0_MAGIC

from cnc_ptp.errors import CncError
from cnc_ptp.recording.bag import RECORD, bag_information, forget_beside, metadata_text, write_beside
from cnc_ptp.recording.kept_records import KeptRecords
from cnc_ptp.recording.overwriting import why_not_made
from cnc_ptp.recording.settings import compressor
from cnc_ptp.wire.layout import Bytes

NOT_WRITTEN = 26007
METADATA = "cnc_ptp"
"""Name of our metadata record."""
MISSING = "missing"
"""Its key for what a recording that could not be written or closed does not have."""

Times = npt.NDArray[np.uint64]

MESSAGE_HEAD = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<u8"),
        ("publish_time", "<u8"),
    ]
)
HEAD_SIZE = MESSAGE_HEAD.itemsize
RECORD_PREFIX = struct.Struct("<BQ")  # opcode, length of what follows
INDEX_ENTRY = np.dtype([("log_time", "<u8"), ("offset", "<u8")])


@dataclass
class Contents:
    """What an MCAP file holds up to the offset `end`; `crc` is that of these bytes."""

    statistics: Statistics = field(default_factory=lambda: Statistics(0, 0, {}, 0, 0, 0, 0, 0, 0))
    end: int = 0
    crc: int = 0
    schemas: list[Schema] = field(default_factory=list)
    channels: list[Channel] = field(default_factory=list)
    chunk_indexes: bytearray = field(default_factory=bytearray)
    """Records as the summary has them."""
    attachment_indexes: bytearray = field(default_factory=bytearray)
    metadata_indexes: list[MetadataIndex] = field(default_factory=list)


class McapFile:
    """An MCAP file of the ROS 2 profile being written.

    Closed chunks are compressed by a thread of its own (outside the interpreter lock) while the next ones fill; then
    they are written and handed to the operating system immediately. All methods raise CncError 26007 once the file
    could not be written; it is cut back to the last whole record, and `close` still tries to give it a summary.
    """

    def __init__(
        self,
        path: Path,
        level: int = 1,
        *,
        found: Contents | None = None,
        compression: str = "zstd",
        describe: Callable[[Path, dict[str, Any]], None] = write_beside,
    ) -> None:
        """Starts a file, or continues one after what was `found` in it; all after that is cut off.

        `compression`: of Settings. `describe`: writes the metadata of rosbag2 when the file is closed.
        """
        self.path = path
        self._describe = describe
        self._compression = "" if compression == "none" else compression
        contents = found or Contents()
        self.statistics = contents.statistics
        self._compressor = compressor(compression, level)
        self._offset = contents.end
        self._crc = contents.crc
        self._schemas = contents.schemas
        self._channels = contents.channels
        self._chunk_indexes = kept(contents.chunk_indexes, path.parent)
        self._attachment_indexes = kept(contents.attachment_indexes, path.parent)
        self._metadata_indexes = contents.metadata_indexes
        self._chunk = _OpenChunk()
        self._closed_chunks: deque[tuple[_OpenChunk, Future[tuple[bytes, int]]]] = deque()
        self._worker = ThreadPoolExecutor(max_workers=1, thread_name_prefix="recording")
        self._failure: CncError | None = None
        self._pending = bytearray()
        self._whole = self._offset, self._crc
        """End of the last record that was handed over, and the CRC up to it."""
        try:
            self._stream = path.open("r+b" if found else "wb", buffering=0)
            if found:
                self._stream.seek(found.end)
                self._stream.truncate()
        except OSError as error:
            raise CncError(
                NOT_WRITTEN, f"recording {path} cannot be written: {why_not_made(error, path)}", "nothing is recorded"
            ) from error
        forget_beside(path)
        if found is None:
            self._write(MCAP0_MAGIC)
            self._record(Header("ros2", f"cnc_ptp {LIBRARY_IDENTIFIER}"))
            with self.or_nothing():
                self._flush()

    @contextlib.contextmanager
    def or_nothing(self) -> Iterator[None]:
        """What stands at the beginning of a file: when it cannot be written the file is not left."""
        try:
            yield
        except CncError:
            self._worker.shutdown()
            self._close_stream()
            file = Path(os.path.realpath(self.path))
            if file.is_file():  # a device stays
                with contextlib.suppress(OSError):
                    file.unlink()
            raise

    @property
    def size(self) -> int:
        """Bytes of what was written, without the chunks that are being compressed."""
        return self._offset

    @property
    def failed(self) -> bool:
        """The file could not be written."""
        return self._failure is not None

    def attachment(self, name: str, media_type: str, data: bytes, log_time: int) -> None:
        self.finish_chunks()
        start = self._offset
        self._record(Attachment(create_time=0, log_time=log_time, name=name, media_type=media_type, data=data))
        index = AttachmentIndex(start, self._offset - start, log_time, 0, len(data), name, media_type)
        self._attachment_indexes.add(bytes_of(index))
        self.statistics.attachment_count += 1
        self._flush()

    def metadata(self, name: str, values: dict[str, str]) -> None:
        self.finish_chunks()
        start = self._offset
        self._record(Metadata(name, values))
        self._metadata_indexes.append(MetadataIndex(start, self._offset - start, name))
        self.statistics.metadata_count += 1
        self._flush()

    def channel(self, topic: str, type_name: str, schema_text: str, metadata: dict[str, str]) -> int:
        """Announces a topic; its records go in front of the messages of the chunk being filled."""
        schema = next((known for known in self._schemas if known.name == type_name), None)
        if schema is None:
            schema = Schema(
                id=len(self._schemas) + 1, data=schema_text.encode(), encoding=SchemaEncoding.ROS2, name=type_name
            )
            self._schemas.append(schema)
            self._chunk.add_record(schema)
        channel = Channel(
            id=len(self._channels) + 1,
            topic=topic,
            message_encoding=MessageEncoding.CDR,
            metadata=metadata,
            schema_id=schema.id,
        )
        self._channels.append(channel)
        self._chunk.add_record(channel)
        return channel.id

    def messages(self, channel_id: int, rows: Bytes, times: Times) -> None:
        """Adds n messages of equal size to the chunk being filled: rows (n, HEAD_SIZE + size), times in ns (n,).

        The first HEAD_SIZE bytes of each row are filled in here.
        """
        counts = self.statistics.channel_message_counts
        known = counts.get(channel_id, 0)
        head = rows[:, :HEAD_SIZE].view(MESSAGE_HEAD)[:, 0]
        head["opcode"] = Opcode.MESSAGE
        head["length"] = rows.shape[1] - RECORD_PREFIX.size
        head["channel"] = channel_id
        head["sequence"] = np.arange(known + 1, known + 1 + len(rows), dtype=np.uint64)
        head["log_time"] = times
        head["publish_time"] = times
        counts[channel_id] = known + len(rows)
        self._chunk.add_messages(channel_id, rows, times)

    def close_chunk(self) -> None:
        """Closes the chunk being filled, which is compressed now; an empty chunk is left open."""
        chunk = self._chunk
        if chunk.message_count:
            self._chunk = _OpenChunk()
            self._closed_chunks.append((chunk, self._worker.submit(self._compress, chunk)))

    @property
    def chunks_ready(self) -> bool:
        """All closed chunks have been compressed and wait to be written."""
        return bool(self._closed_chunks) and self._closed_chunks[-1][1].done()

    def finish_chunks(self) -> None:
        """Returns when all closed chunks have been handed to the operating system."""
        try:
            while self._closed_chunks:
                chunk, compression = self._closed_chunks.popleft()
                self._write_chunk(chunk, *compression.result())
        finally:
            self._closed_chunks.clear()  # what cannot be written is lost

    def _write_chunk(self, chunk: _OpenChunk, compressed: bytes, crc: int) -> None:
        first, last = chunk.time_range()
        start = self._offset
        self._record(Chunk(self._compression, compressed, last, first, crc, chunk.size))
        end = self._offset
        index_offsets: dict[int, int] = {}
        for channel_id, entries in chunk.indexes.items():
            index_offsets[channel_id] = self._offset
            self._write(_message_index(channel_id, entries))
        self._flush()
        index = ChunkIndex(
            chunk_length=end - start,
            chunk_start_offset=start,
            compression=self._compression,
            compressed_size=len(compressed),
            message_end_time=last,
            message_index_length=self._offset - end,
            message_index_offsets=index_offsets,
            message_start_time=first,
            uncompressed_size=chunk.size,
        )
        self._chunk_indexes.add(bytes_of(index))
        count_chunk(self.statistics, chunk.message_count, first, last)

    def close(self) -> None:
        """Writes the last chunk and the summary, closes the file, and writes the metadata of rosbag2 (bag).

        After a failure: the summary of what is in the file, if there is room for it.
        """
        failure: CncError | None = None
        try:
            try:
                self.close_chunk()
                self.finish_chunks()
            except CncError as error:
                failure, self._failure = error, None
                self.metadata(METADATA, {MISSING: f"{error.reason}; what came after that is missing"})
            self._write_end()
        except CncError as error:
            failure = failure or error
        finally:
            self._worker.shutdown()
            self._close_stream()
        if failure is not None:
            raise failure

    def _write_end(self) -> None:
        information = bag_information(self.path.name, self.statistics, self._channels, self._schemas)
        notes = {"serialized_metadata": metadata_text(information)}
        start = self._offset
        self._record(Metadata(RECORD, notes))
        self._metadata_indexes.append(MetadataIndex(start, self._offset - start, RECORD))
        self.statistics.metadata_count += 1
        self._record(DataEnd(self._crc))
        self._write_summary()
        self._flush()
        self._describe(self.path, information)

    def __enter__(self) -> McapFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _compress(self, chunk: _OpenChunk) -> tuple[bytes, int]:
        """The records of a chunk compressed, part by part, and their crc; the parts are given free."""
        return self._compressor(chunk.parts, chunk.size)

    def _write_summary(self) -> None:
        self.statistics.schema_count = len(self._schemas)
        self.statistics.channel_count = len(self._channels)
        start = self._offset
        groups: list[tuple[Opcode, bytes]] = [
            (Opcode.SCHEMA, bytes_of(*self._schemas)),
            (Opcode.CHANNEL, bytes_of(*self._channels)),
            (Opcode.STATISTICS, bytes_of(self.statistics)),
            (Opcode.CHUNK_INDEX, self._kept(self._chunk_indexes)),
            (Opcode.ATTACHMENT_INDEX, self._kept(self._attachment_indexes)),
            (Opcode.METADATA_INDEX, bytes_of(*self._metadata_indexes)),
        ]
        summary = bytearray()
        offsets: list[SummaryOffset] = []
        for opcode, records in groups:
            if records:
                offsets.append(SummaryOffset(opcode, start + len(summary), len(records)))
                summary += records
        offset_start = start + len(summary)
        summary += bytes_of(*offsets)
        crc = zlib.crc32(struct.pack("<BQQQ", Opcode.FOOTER, 20, start, offset_start), zlib.crc32(summary))
        self._write(summary)
        self._record(Footer(start, offset_start, crc))
        self._write(MCAP0_MAGIC)

    def _kept(self, records: KeptRecords) -> bytes:
        """They need their room on the disk no longer."""
        try:
            return records.contents()
        except OSError as error:
            raise self._failed(error) from error
        finally:
            records.close()

    def _record(self, record: McapRecord) -> None:
        self._write(bytes_of(record))

    def _write(self, data: bytes | bytearray) -> None:
        if self._failure is not None:
            raise self._failure
        self._pending += data
        self._offset += len(data)
        self._crc = zlib.crc32(data, self._crc)

    def _flush(self) -> None:
        """Hands whole records to the operating system."""
        try:
            with memoryview(self._pending) as pending:
                written = 0
                while written < len(pending):
                    written += self._stream.write(pending[written:]) or 0
            self._stream.flush()
        except OSError as error:
            raise self._failed(error) from error
        self._pending.clear()
        self._whole = self._offset, self._crc

    def _close_stream(self) -> None:
        self._chunk_indexes.close()
        self._attachment_indexes.close()
        try:
            self._stream.close()
        except OSError as error:
            if self._failure is None:
                raise self._failed(error) from error

    def _cut_back(self) -> None:
        """To the last whole record: what did not fit is forgotten."""
        self._pending.clear()
        self._offset, self._crc = self._whole
        with contextlib.suppress(OSError):
            self._stream.seek(self._offset)
            self._stream.truncate()

    def _failed(self, error: OSError) -> CncError:
        self._cut_back()
        at, remains = "", "nothing is in it"
        if self._chunk_indexes:
            at, remains = f" at offset {self._offset}", "recording ends here, the chunks before it stay readable"
        self._failure = CncError(
            NOT_WRITTEN,
            f"recording {self.path}: cannot be written{at}: {error.strerror}",
            remains,
        )
        return self._failure


class _OpenChunk:
    """Records of a chunk before compression, and where the messages of each channel begin in it."""

    def __init__(self) -> None:
        self.parts: list[bytes | memoryview] = []
        self.size = 0
        self.message_count = 0
        self.indexes: dict[int, list[npt.NDArray[np.void]]] = {}

    def add_record(self, record: McapRecord) -> None:
        data = bytes_of(record)
        self.parts.append(data)
        self.size += len(data)

    def add_messages(self, channel_id: int, rows: Bytes, times: Times) -> None:
        count, row_size = rows.shape
        entries = np.empty(count, dtype=INDEX_ENTRY)
        entries["log_time"] = times
        entries["offset"] = np.arange(self.size, self.size + count * row_size, row_size, dtype=np.uint64)
        self.indexes.setdefault(channel_id, []).append(entries)
        self.parts.append(rows.reshape(-1).data)
        self.size += rows.size
        self.message_count += count

    def time_range(self) -> tuple[int, int]:
        times = [entries["log_time"] for runs in self.indexes.values() for entries in runs]
        return min(int(run.min()) for run in times), max(int(run.max()) for run in times)


def kept(records: bytearray, folder: Path) -> KeptRecords:
    """Those of a file in this folder, with what was found in it."""
    found = KeptRecords(folder)
    found.add(records)
    return found


def count_chunk(statistics: Statistics, messages: int, first: int, last: int) -> None:
    """Adds a chunk with log times from `first` to `last`."""
    if statistics.chunk_count == 0 or first < statistics.message_start_time:
        statistics.message_start_time = first
    statistics.message_end_time = max(statistics.message_end_time, last)
    statistics.message_count += messages
    statistics.chunk_count += 1


def _message_index(channel_id: int, runs: list[npt.NDArray[np.void]]) -> bytes:
    entries = np.concatenate(runs)
    if np.any(entries["log_time"][1:] < entries["log_time"][:-1]):
        entries = entries[np.argsort(entries["log_time"], kind="stable")]
    builder = RecordBuilder()
    builder.start_record(Opcode.MESSAGE_INDEX)
    builder.write2(channel_id)
    builder.write4(entries.nbytes)
    builder.write(entries.tobytes())
    builder.finish_record()  # type: ignore[no-untyped-call]
    return _contents(builder)


def bytes_of(*records: McapRecord) -> bytes:
    """The records as they stand in a file."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return _contents(builder)


def _contents(builder: RecordBuilder) -> bytes:
    contents: bytes = builder.end()  # type: ignore[no-untyped-call]
    return contents
