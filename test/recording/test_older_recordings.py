"""Recordings from before messages of blocks had all their fields: they are read as they are defined in the file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from machine_support import ROOT
from mcap.reader import make_reader
from mcap.records import Schema
from mcap.writer import Writer

from cnc_ptp.client import Machine
from cnc_ptp.commands.run.what_if import compute
from cnc_ptp.protocol.blocks import ChannelBlock
from cnc_ptp.recording.run_difference import difference
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.recording.what_if import Change, WhatIf
from cnc_ptp.web.faces.recorded_file import RecordedFile
from cnc_ptp.wire.block_codec import codec_of
from cnc_ptp.wire.layout import encode, header_at
from cnc_ptp.wire.schemas import recorded_schema
from cnc_ptp.wire.stamps import Stamps

ADDED = ("default_index", "changed_indices", "changed_offsets", "changed_inactive")
"""Of ChannelOffsets, in November 2026."""
TYPE = "cnc_ptp/msg/ChannelBlock"
STAMPS = Stamps(0, 1_000_000)


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The same run as it is recorded today, and as it was before."""
    folder = tmp_path_factory.mktemp("recordings")
    today, older = folder / "today.mcap", folder / "older.mcap"
    with Machine.offline(str(ROOT / "config" / "mill.yaml"), record=today) as m:
        m.channel.set_zero_offset(2, "X", 12.5)
        m.channel.load("part.nc", text="M3 S500\nG55 G1 X14 F600\nM5\nM30\n")
        m.channel.start().wait()
    make_older(today, older)
    return today, older


def make_older(today: Path, older: Path) -> None:
    with today.open("rb") as stream, older.open("wb") as target:
        read, write = make_reader(stream), Writer(target)
        write.start(profile="ros2")
        for attachment in read.iter_attachments():
            times = attachment.create_time, attachment.log_time
            write.add_attachment(*times, attachment.name, attachment.media_type, attachment.data)
        for metadata in read.iter_metadata():
            write.add_metadata(metadata.name, metadata.metadata)
        channels: dict[str, int] = {}
        for schema, channel, message in read.iter_messages():
            assert schema is not None
            definition = older_definition(schema)
            if channel.topic not in channels:
                id = write.register_schema(schema.name, schema.encoding, definition)
                channels[channel.topic] = write.register_channel(channel.topic, "cdr", id, channel.metadata)
            data = older_block(message.data, definition) if schema.name == TYPE else message.data
            write.add_message(channels[channel.topic], message.log_time, data, message.publish_time)
        write.finish()


def older_definition(schema: Schema) -> bytes:
    lines = schema.data.decode().splitlines()
    return "\n".join(line for line in lines if not any(f" {name} " in line for name in ADDED)).encode()


def older_block(data: bytes, definition: bytes) -> bytes:
    block, schema = codec_of(ChannelBlock).decode(data), recorded_schema(TYPE, definition)
    header = header_at(STAMPS.at(block.first_cycle))
    values: dict[str, Any] = {field.name: getattr(block, field.name, header) for field in schema.fields}
    return encode(schema, values, STAMPS.header_of)


def blocks_of(path: Path) -> list[ChannelBlock]:
    with RunInputs(path) as recorded:
        codec = recorded.codec(ChannelBlock)
        return [codec.decode(message.cdr) for message in recorded.messages([TYPE])]


def test_a_block_has_all_that_its_file_has(recordings: tuple[Path, Path]) -> None:
    now, before = map(blocks_of, recordings)
    told = [offsets for block in now for offsets in block.offsets]
    assert [offsets.changed_indices for offsets in told] == [[], [2], [2], [2]]
    for offsets in told:
        for name, value in (("default_index", -1), *((name, []) for name in ADDED[1:])):
            setattr(offsets, name, value)
    assert before == now


def test_an_older_recording_is_computed_again(recordings: tuple[Path, Path], tmp_path: Path) -> None:
    new = tmp_path / "new.mcap"
    with RunInputs(recordings[1]) as recorded:
        compute(WhatIf(recorded, Change()), recorded, new)
    assert difference(recordings[0], new).parts_at is None


def test_pages_have_the_blocks_of_an_older_recording(recordings: tuple[Path, Path]) -> None:
    counts = []
    for path in recordings:
        file = RecordedFile(str(path))
        counts.append(len(file.first.blocks["channel"]))
        file.close()
    assert counts[0] == counts[1] > 10
