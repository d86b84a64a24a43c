"""Closes the recording of a recorder that died, so that readers which need the summary open it."""

from __future__ import annotations

from pathlib import Path

from mcap.opcode import Opcode
from mcap.records import AttachmentIndex, Channel, Chunk, ChunkIndex, Metadata, MetadataIndex, Schema
from mcap.writer import MCAP0_MAGIC

from cnc_ptp.recording.bag import RECORD
from cnc_ptp.recording.mcap_chunks import McapRecords, MessageRun, RawRecord
from cnc_ptp.recording.mcap_file import METADATA, MISSING, RECORD_PREFIX, Contents, McapFile, bytes_of, count_chunk
from cnc_ptp.recording.parts import begun_parts, describe_folder


def close_cut(path: str | Path) -> str:
    """Ends a recording of cnc_ptp that was cut off behind its last whole chunk: data end, summary, footer.

    Returns what is missing, which the file then says too; empty for a file that is whole, which is unchanged,
    and for anything but a regular file.
    Raises CncError 26001 to 26003 (the file is unchanged) and 26007.
    """
    if not Path(path).is_file():  # a device, such as /dev/full, has no end
        return ""
    records = McapRecords(Path(path))
    survey = _Survey(records)
    for record in records:
        survey.take(record)
    if records.complete:
        return ""
    with McapFile(Path(path), found=survey.before_last_chunk()) as file:
        survey.write_last_chunk(file)
        file.metadata(METADATA, {MISSING: records.missing})
    return records.missing


def close_cut_recording(path: str | Path) -> str:
    """close_cut for a file, or for the parts of a folder, whose `metadata.yaml` then lists all of them.

    A folder without parts is unchanged: the first one could not be written.
    """
    folder = Path(path)
    if not folder.is_dir():
        return close_cut(path)
    parts = begun_parts(folder, folder.stem)
    missing = "; ".join(filter(None, [close_cut(part) for part in parts]))
    if parts:
        describe_folder(folder)
    return missing


class _Survey:
    """The contents of a file that its summary would list. The last chunk is kept back: its indexes may be cut off."""

    def __init__(self, records: McapRecords) -> None:
        self._records = records
        self._contents = Contents()
        self._contents.end = len(MCAP0_MAGIC)
        self._last: RawRecord | None = None
        self._index_offsets: dict[int, int] = {}
        self._ended = False

    def take(self, record: RawRecord) -> None:
        self._ended = self._ended or record.opcode == Opcode.DATA_END or self._is_closing(record)
        if self._ended:
            return
        if record.opcode == Opcode.MESSAGE_INDEX:
            self._index_offsets[int.from_bytes(record.body[:2], "little")] = record.offset
            return
        self._count_last_chunk(record.offset)
        if record.opcode == Opcode.CHUNK:
            self._last = record
            self._contents.end = record.offset
            return
        self._contents.end = record.offset + RECORD_PREFIX.size + len(record.body)
        if record.opcode == Opcode.ATTACHMENT:
            self._count_attachment(record)
        elif record.opcode == Opcode.METADATA:
            self._count_metadata(record)

    def before_last_chunk(self) -> Contents:
        contents = self._contents
        contents.crc = self._records.crc_up_to(contents.end)
        return contents

    def write_last_chunk(self, file: McapFile) -> None:
        if self._last is None:
            return
        schemas: dict[int, Schema] = {schema.id: schema for schema in self._contents.schemas}
        for item in self._records.in_chunk(self._last):
            if isinstance(item, Schema):
                schemas[item.id] = item
            elif isinstance(item, Channel):
                schema = schemas[item.schema_id]
                file.channel(item.topic, schema.name, schema.data.decode(), item.metadata)
            else:
                file.messages(item.channel_id, item.rows.copy(), item.head["log_time"].copy())

    def _is_closing(self, record: RawRecord) -> bool:
        """The record of rosbag2 is the first that is written when a recording is closed."""
        return record.opcode == Opcode.METADATA and self._records.parse(Metadata.read, record).name == RECORD

    def _count_last_chunk(self, end: int) -> None:
        """The chunk before the record at `end`, with its indexes."""
        if self._last is None:
            return
        record, contents = self._last, self._contents
        chunk = self._records.parse(Chunk.read, record)
        messages = sum(self._count(item) for item in self._records.in_chunk(record))
        length = RECORD_PREFIX.size + len(record.body)
        first, last = chunk.message_start_time, chunk.message_end_time
        index = ChunkIndex(
            chunk_length=length,
            chunk_start_offset=record.offset,
            compression=chunk.compression,
            compressed_size=len(chunk.data),
            message_end_time=last,
            message_index_length=end - record.offset - length,
            message_index_offsets=self._index_offsets,
            message_start_time=first,
            uncompressed_size=chunk.uncompressed_size,
        )
        contents.chunk_indexes += bytes_of(index)
        count_chunk(contents.statistics, messages, first, last)
        self._last, self._index_offsets = None, {}

    def _count(self, item: Schema | Channel | MessageRun) -> int:
        """Notes the contents of a chunk; returns the number of messages."""
        if isinstance(item, Schema):
            self._contents.schemas.append(item)
        elif isinstance(item, Channel):
            self._contents.channels.append(item)
        else:
            counts = self._contents.statistics.channel_message_counts
            counts[item.channel_id] = counts.get(item.channel_id, 0) + len(item.rows)
            return len(item.rows)
        return 0

    def _count_attachment(self, record: RawRecord) -> None:
        part = self._records.attachment(record)
        length, size = RECORD_PREFIX.size + len(record.body), len(part.data)
        index = AttachmentIndex(
            record.offset, length, part.log_time, part.create_time, size, part.name, part.media_type
        )
        self._contents.attachment_indexes += bytes_of(index)
        self._contents.statistics.attachment_count += 1

    def _count_metadata(self, record: RawRecord) -> None:
        name = self._records.parse(Metadata.read, record).name
        length = RECORD_PREFIX.size + len(record.body)
        self._contents.metadata_indexes.append(MetadataIndex(record.offset, length, name))
        self._contents.statistics.metadata_count += 1
