"""Reads the records of an MCAP file one after another, without its index, so that a file cut off anywhere gives all
that it holds.

A file that does not end with the MCAP magic was cut off (killed process, full disk): reading stops at the first record
that is not whole. Anything else that does not fit is corruption and raises an error that names the place.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path
from typing import BinaryIO, NamedTuple, TypeVar

import numpy as np
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, DataEnd, Footer, Schema
from mcap.stream_reader import get_chunk_data_stream
from mcap.writer import MCAP0_MAGIC

from cnc_ptp.errors import CncError
from cnc_ptp.recording.mcap_file import HEAD_SIZE, MESSAGE_HEAD, RECORD_PREFIX
from cnc_ptp.wire.layout import Bytes

UNREADABLE = 26001
NOT_MCAP = 26002
CORRUPT = 26003
WITHOUT_CHUNKS = 26206
NOTHING_LEFT = 26224
CRC_SIZE = 4

Record = TypeVar("Record")
KNOWN_OPCODES = frozenset(int(opcode) for opcode in Opcode)
FIRST_PRIVATE_OPCODE = 0x80
RUN_STEP = 64
STEP = 2**20


class RawRecord(NamedTuple):
    """A record of the file and where it begins."""

    offset: int
    opcode: int
    body: memoryview


class MessageRun(NamedTuple):
    """Messages of one channel and one size that follow each other: rows (n, HEAD_SIZE + size) of bytes."""

    channel_id: int
    rows: Bytes

    @property
    def head(self) -> np.ndarray[tuple[int], np.dtype[np.void]]:
        head: np.ndarray[tuple[int], np.dtype[np.void]] = self.rows[:, :HEAD_SIZE].view(MESSAGE_HEAD)[:, 0]
        return head

    @property
    def contents(self) -> Bytes:
        return self.rows[:, HEAD_SIZE:]


class RecordReader:
    """Reads what is in records of the file `path`; what does not fit raises CncError 26003 with its place."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def parse(self, read: Callable[[ReadDataStream], Record], record: RawRecord) -> Record:
        """The record as read by a record class of the library."""
        try:
            return read(ReadDataStream(BytesIO(record.body)))
        except (struct.error, McapError, UnicodeDecodeError, ValueError, OverflowError) as error:
            raise self.corrupt(record.offset, f"{_name(record.opcode)} record cannot be read: {error!r}") from error

    def attachment(self, record: RawRecord) -> Attachment:
        if len(record.body) < CRC_SIZE:
            raise self.corrupt(record.offset, f"the attachment has {len(record.body)} bytes, and no CRC")
        (crc,) = struct.unpack("<I", record.body[-CRC_SIZE:])
        if crc not in (0, zlib.crc32(record.body[:-4])):
            raise self.corrupt(record.offset, "the CRC of the attachment does not match its content")
        attachment: Attachment = self.parse(Attachment.read, record)
        return attachment

    def chunk(self, record: RawRecord) -> bytes:
        """The uncompressed records of a chunk, CRC checked."""
        chunk = self.parse(Chunk.read, record)
        try:
            stream, length = get_chunk_data_stream(chunk)
            data = stream.read(length)
        except (zstandard.ZstdError, RuntimeError, ValueError, MemoryError, OverflowError) as error:
            raise self.corrupt(record.offset, f"the chunk cannot be uncompressed: {error}") from error
        if len(data) != chunk.uncompressed_size or chunk.uncompressed_crc not in (0, zlib.crc32(data)):
            raise self.corrupt(record.offset, "the CRC of the chunk does not match its content")
        return data

    def in_chunk(self, record: RawRecord) -> Iterator[Schema | Channel | MessageRun]:
        """Schemas, channels and runs of messages in a chunk."""
        yield from self.in_records(record, self.chunk(record))

    def in_records(self, record: RawRecord, content: bytes) -> Iterator[Schema | Channel | MessageRun]:
        """The same of records one after another; `record` is the place of errors."""
        data = np.frombuffer(content, dtype=np.uint8)
        offset = 0
        while offset < len(data):
            if len(data) - offset < RECORD_PREFIX.size:
                raise self.corrupt(record.offset, f"the chunk ends inside a record at {offset}")
            opcode, length = RECORD_PREFIX.unpack_from(content, offset)
            size = RECORD_PREFIX.size + length
            if size > len(data) - offset or (opcode == Opcode.MESSAGE and size < HEAD_SIZE):
                raise self.corrupt(record.offset, f"the record at {offset} of the chunk says {length} bytes")
            inner = RawRecord(record.offset, opcode, data[offset + RECORD_PREFIX.size : offset + size].data)
            if opcode == Opcode.MESSAGE:
                rows = data[offset:]
                count = run_length(rows, size)
                yield MessageRun(_channel_id(inner), rows[: count * size].reshape(count, size))
                size *= count
            elif opcode == Opcode.SCHEMA:
                yield self.parse(Schema.read, inner)
            elif opcode == Opcode.CHANNEL:
                yield self.parse(Channel.read, inner)
            offset += size

    def corrupt(self, offset: int, reason: str) -> CncError:
        return CncError(
            CORRUPT,
            f"recording {self.path}: corrupt at offset {offset}: {reason}",
            "nothing was read, take an intact copy of the file or save what is whole with 'cnc_ptp recover'",
        )

    def without_chunks(self) -> CncError:
        return CncError(
            WITHOUT_CHUNKS,
            f"recording {self.path}: its messages are in no chunks",
            "nothing was read, 'cnc_ptp recover' makes a file that has them",
        )

    def require_magic(self, begin: bytes) -> None:
        """Raises CncError 26002 unless a file with this begin is an MCAP file, 26224 where it was cut within it."""
        if begin != MCAP0_MAGIC:
            if begin and MCAP0_MAGIC.startswith(begin):
                raise nothing_left(self.path)
            text, magic = (content.decode(errors="replace") for content in (begin, MCAP0_MAGIC))
            why = f"it begins with {text!r} instead of {magic!r}" if begin else "it is empty"
            raise CncError(
                NOT_MCAP,
                f"recording {self.path}: not an MCAP file: {why}",
                "nothing was read, give a file that cnc_ptp or 'ros2 bag record --storage mcap' has written",
            )

    def footer(self, record: RawRecord) -> Footer:
        """The last record of a closed file."""
        footer: Footer = self.parse(Footer.read, record)
        if footer.summary_start > record.offset:
            raise self.corrupt(
                record.offset, f"the footer lies before the summary, which begins at {footer.summary_start}"
            )
        return footer

    def unreadable(self, error: OSError) -> CncError:
        return CncError(
            UNREADABLE, f"recording {self.path}: cannot be opened: {error.strerror}", "nothing was read, check the path"
        )


class McapRecords(RecordReader):
    """The records of a file in order, one after another: no more than one of them is in memory.

    After iteration `complete` and `missing` say what is missing, if anything.
    Raises CncError 26001 (cannot be opened), 26002 (not an MCAP file), 26003 (corrupt: where, why).
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.complete = False
        self.missing = ""
        self._crc = 0
        """Of what was read so far."""
        try:
            with path.open("rb") as file:
                begin = file.read(len(MCAP0_MAGIC))
                self._size = file.seek(0, os.SEEK_END)
                end = self._bytes(file, max(0, self._size - len(MCAP0_MAGIC)), len(MCAP0_MAGIC))
        except OSError as error:
            raise self.unreadable(error) from error
        self._data_ended = False
        self.require_magic(begin)
        self._cut_off = end != MCAP0_MAGIC or self._size == len(MCAP0_MAGIC)

    def _bytes(self, file: BinaryIO, offset: int, length: int) -> bytes:
        file.seek(offset)
        return file.read(length)

    def __iter__(self) -> Iterator[RawRecord]:
        with self.path.open("rb") as file:
            yield from self._records(file)

    def _records(self, file: BinaryIO) -> Iterator[RawRecord]:
        offset, end = len(MCAP0_MAGIC), self._size
        self._crc = zlib.crc32(MCAP0_MAGIC)
        while offset < end:
            head = self._bytes(file, offset, RECORD_PREFIX.size)
            if len(head) < RECORD_PREFIX.size:
                return self._stop(offset, f"{end - offset} bytes of a record head follow")
            opcode, length = RECORD_PREFIX.unpack(head)
            self._require_known(offset, opcode)
            start = offset + RECORD_PREFIX.size
            if length > end - start:
                return self._stop(
                    offset, f"a record of {length} bytes begins there, {end - start} bytes of it are present"
                )
            body = file.read(length)
            record = RawRecord(offset, opcode, memoryview(body))
            yield record
            offset = start + length
            if opcode == Opcode.DATA_END:
                self._check_data_crc(record)
            elif opcode == Opcode.FOOTER:
                return self._finish(file, record, offset)
            elif not self._data_ended:
                self._crc = zlib.crc32(body, zlib.crc32(head, self._crc))
        return self._stop(offset, "the summary is missing")

    def crc_up_to(self, offset: int) -> int:
        """CRC of the file before `offset`."""
        crc = 0
        with self.path.open("rb") as file:
            while offset > 0:
                part = file.read(min(offset, STEP))
                crc = zlib.crc32(part, crc)
                offset -= len(part) or offset
        return crc

    def _require_known(self, offset: int, opcode: int) -> None:
        if opcode not in KNOWN_OPCODES and opcode < FIRST_PRIVATE_OPCODE:
            raise self.corrupt(offset, f"a record of the unknown type {opcode} begins there")

    def _check_data_crc(self, record: RawRecord) -> None:
        self._data_ended = True
        expected = self.parse(DataEnd.read, record).data_section_crc
        if expected not in (0, self._crc):
            raise self.corrupt(record.offset, "the CRC of the data section does not match its content")

    def _finish(self, file: BinaryIO, record: RawRecord, end: int) -> None:
        if not self._data_ended:
            raise self.corrupt(record.offset, "the footer comes without an end of the data section before it")
        footer = self.footer(record)
        begin = footer.summary_start or record.offset
        summary = self._bytes(file, begin, record.offset + RECORD_PREFIX.size + 16 - begin)
        if footer.summary_crc not in (0, zlib.crc32(summary)):
            raise self.corrupt(record.offset, "the CRC of the summary does not match its content")
        rest = self._bytes(file, end, self._size - end)
        if rest == MCAP0_MAGIC:
            self.complete = True
        elif MCAP0_MAGIC.startswith(rest):
            self._stop(end, "the closing magic is missing")
        else:
            raise self.corrupt(end, f"{len(rest)} bytes follow the footer instead of the MCAP magic")

    def _stop(self, offset: int, found: str) -> None:
        """The file ends at a place where it should not."""
        if not self._cut_off:
            raise self.corrupt(offset, found)
        self.missing = (
            f"the file ends at offset {self._size} without having been closed ({found}, "
            f"last whole record up to offset {offset}); what was recorded after the last whole chunk is missing"
        )


def nothing_left(path: Path) -> CncError:
    """Of a recording that was cut within its begin."""
    return CncError(
        NOTHING_LEFT,
        f"recording {path}: ends before its first message: it was cut, or has only just begun",
        "nothing of a run is in it",
    )


def run_length(data: Bytes, size: int) -> int:
    """How many messages of `size` bytes and of the channel of the first one `data` begins with."""
    limit = len(data) // size
    rows = data[: limit * size].reshape(limit, size)[:, :11]  # opcode, length, channel
    first = rows[0]
    count, step = 1, 1
    while count < limit:
        equal = (rows[count : count + step] == first).all(axis=1)
        if not equal.all():
            return count + int(equal.argmin())
        count += len(equal)
        step = max(RUN_STEP, 2 * step)
    return count


def _channel_id(message: RawRecord) -> int:
    (channel_id,) = struct.unpack_from("<H", message.body)
    return int(channel_id)


def _name(opcode: int) -> str:
    return Opcode(opcode).name.lower() if opcode in KNOWN_OPCODES else f"private ({opcode})"
