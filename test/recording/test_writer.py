"""The writer's file, read back by the readers of mcap and rosbags, and its refusals."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from mcap.reader import NonSeekingReader, make_reader
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory
from recording_support import MACHINE, record

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import AxisBlock, Command, CommandRecord, CycleTick, Event, PlcBlock, Refusal
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.writer import Recording
from cnc_ptp.wire.layout import Header, encode
from cnc_ptp.wire.schemas import load_schema


@pytest.fixture
def path(tmp_path) -> Path:
    return tmp_path / "run.mcap"


def messages(path, **options):
    with path.open("rb") as stream:
        yield from make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()]).iter_decoded_messages(
            **options
        )


def test_seeking_reader_gives_all_in_log_time_order(path, blocks):
    run = list(blocks.machine(250))
    record(path, run, chunk_seconds=0.5)
    times, counts = [], {}
    for schema, channel, message, _ in messages(path):
        times.append(message.log_time)
        counts[channel.topic, schema.name] = counts.get((channel.topic, schema.name), 0) + 1
        assert schema.encoding == "ros2msg"
        assert channel.message_encoding == "cdr"
    assert times == sorted(times)
    assert counts == {
        ("/clock/tick", "cnc_ptp/msg/CycleTick"): 250,
        ("/plc/block", "cnc_ptp/msg/PlcBlock"): 250,
        ("/channel/block", "cnc_ptp/msg/ChannelBlock"): 250,
        ("/x/block", "cnc_ptp/msg/AxisBlock"): 250,
        ("/y/block", "cnc_ptp/msg/AxisBlock"): 250,
        ("/s/block", "cnc_ptp/msg/SpindleBlock"): 250,
        ("/channel/state", "cnc_ptp/msg/ChannelState"): 2500,
        ("/x/state", "cnc_ptp/msg/AxisState"): 2500,
        ("/y/state", "cnc_ptp/msg/AxisState"): 2500,
        ("/s/state", "cnc_ptp/msg/SpindleState"): 2500,
        ("/events", "cnc_ptp/msg/Event"): 1,
        ("/commands", "cnc_ptp/msg/CommandRecord"): 1,
    }


def test_statistics_index_and_crcs_are_those_of_the_library(path, blocks):
    record(path, list(blocks.machine(120)), chunk_seconds=0.25)
    with path.open("rb") as stream:
        reader = make_reader(stream)
        summary = reader.get_summary()
        assert reader.get_header().profile == "ros2"
    statistics = summary.statistics
    assert statistics.message_count == 120 * 6 + 1200 * 4 + 2 == sum(statistics.channel_message_counts.values())
    assert (statistics.chunk_count, statistics.attachment_count, statistics.metadata_count) == (30, 1, 2)
    assert (statistics.channel_count, statistics.schema_count) == (12, 10)
    assert (statistics.message_start_time, statistics.message_end_time) == (0, 1_199_000_000)
    ranges = [(chunk.message_start_time, chunk.message_end_time) for chunk in summary.chunk_indexes]
    names = {channel.id: channel.topic for channel in summary.channels.values()}
    own = [{names[id] for id in chunk.message_index_offsets} for chunk in summary.chunk_indexes[:6]]
    assert own == [
        {"/clock/tick", "/events", "/commands"},
        {f"/{unit}/block" for unit in ("plc", "channel", "x", "y", "s")},
        {"/channel/state"},
        {"/x/state"},
        {"/y/state"},
        {"/s/state"},
    ]
    assert ranges[2::6] == ranges[3::6] == ranges[5::6]
    assert ranges[2::6] == [
        (0, 249_000_000),
        (250_000_000, 499_000_000),
        (500_000_000, 749_000_000),
        (750_000_000, 999_000_000),
        (1_000_000_000, 1_199_000_000),
    ]
    with path.open("rb") as stream:  # also checks the CRC of the data section
        assert sum(1 for _ in NonSeekingReader(stream).iter_messages(log_time_order=False)) == statistics.message_count
    with path.open("rb") as stream:
        assert [type(item).__name__ for item in StreamReader(stream, validate_crcs=True).records][:3] == [
            "Header",
            "Attachment",
            "Metadata",
        ]


def test_a_topic_and_a_time_range_are_found_by_the_index(path, blocks):
    record(path, list(blocks.machine(100)), chunk_seconds=0.1)
    found = messages(path, topics=["/y/state"], starting_at=400_000_000, ending_before=405_000_000)
    assert [decoded.cycle for _, _, _, decoded in found] == [400, 401, 402, 403, 404]


def test_rosbags_reads_the_file(path, blocks):
    rosbags = pytest.importorskip("rosbags.highlevel", reason="rosbags is not installed")
    run = list(blocks.machine(30))
    record(path, run)
    with rosbags.AnyReader([path]) as reader:
        connections = [connection for connection in reader.connections if connection.topic == "/x/state"]
        rows = [
            (time, reader.deserialize(data, connection.msgtype))
            for connection, time, data in reader.messages(connections)
        ]
    block = next(block for name, block in run if name == "x")
    assert [time for time, _ in rows] == list(range(0, 300_000_000, 1_000_000))
    assert [state.status_bits for _, state in rows[:10]] == block.status_bits


def test_stamps_follow_start_and_cycle_time(path, blocks):
    with Recording(path, MACHINE, start_ns=1_700_000_000_999_000_000, cycle_time_ns=500_000) as recording:
        recording.block("x", blocks.axis(4, count=3))
        recording.event(Event(5, "x", 0, 0, "text"))
    found = [
        (message.log_time, decoded.header.stamp.sec, decoded.header.stamp.nanosec)
        for _, _, message, decoded in messages(path)
    ]
    at_4 = (1_700_000_001_001_000_000, 1_700_000_001, 1_000_000)
    at_5 = (1_700_000_001_001_500_000, 1_700_000_001, 1_500_000)
    at_6 = (1_700_000_001_002_000_000, 1_700_000_001, 2_000_000)
    assert found == [at_4, at_4, at_5, at_5, at_6]


def test_attachment_comes_first_and_is_there_before_the_first_chunk(path):
    recording = Recording(path, MACHINE)
    recorded = read_recording(path)
    assert recorded.machine_yaml == MACHINE
    assert not recorded.complete
    recording.close()


def test_blocks_of_changing_shape_keep_their_order(path, blocks):
    run = [
        blocks.channel(0),
        blocks.channel(10, count=4),
        blocks.channel_with_commands(14),
        blocks.channel(24, axes=()),
        blocks.channel(34),
    ]
    with Recording(path, MACHINE) as recording:
        for block in run:
            recording.block("/channel/", block)
    read = [decoded for _, _, _, decoded in messages(path, topics=["/channel/block"])]
    assert [(block.first_cycle, block.count, list(block.axes), len(block.commands)) for block in read] == [
        (block.first_cycle, block.count, block.axes, len(block.commands)) for block in run
    ]
    assert read[2].commands[0].arguments_json == '{"speed_rpm": 1000.0}'
    assert read[2].requests[0].header.stamp.nanosec == 17_000_000
    cycles = [decoded.cycle for _, _, _, decoded in messages(path, topics=["/channel/state"])]
    assert cycles == list(range(44))


def test_blocks_are_taken_as_messages(path, blocks):
    schema = load_schema("cnc_ptp/msg/AxisBlock")
    block = blocks.axis(50)
    data = encode(schema, block, lambda value: Header(0, 50_000_000))
    with Recording(path, MACHINE) as recording:
        recording.encoded_block("x", AxisBlock, data)
    recorded = read_recording(path)
    assert recorded.states["/x/state"]["status_bits"].tolist() == block.status_bits
    assert recorded.topics["/x/block"].count == 1


def test_flush_is_due_after_half_a_second_of_wall_time(path, blocks):
    with Recording(path, MACHINE) as recording:
        recording.block("x", blocks.axis(0))
        assert not recording.flush_if_due(100.0)
        assert not recording.flush_if_due(100.49)
        assert read_recording(path).topics == {}
        assert recording.flush_if_due(100.5)
        assert read_recording(path).topics["/x/state"].count == 10
        recording.block("x", blocks.axis(10))
        assert not recording.flush_if_due(100.9)
        assert recording.flush_if_due(101.0)
        assert read_recording(path).topics["/x/state"].count == 20


def test_killed_process_leaves_all_flushed_chunks(path):
    code = (
        "import os, signal, sys\n"
        "from recording_support import Blocks, MACHINE\n"
        "from cnc_ptp.recording.writer import Recording\n"
        "recording = Recording(sys.argv[1], MACHINE)\n"
        "recording.flush_if_due(0.0)\n"
        "for name, block in Blocks(1).machine(250):\n"
        "    recording.block(name, block)\n"
        "    if (name, block.first_cycle) == ('s', 2290): recording.flush_if_due(0.6)\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    folders = os.pathsep.join(filter(None, sys.path))
    done = subprocess.run(
        [sys.executable, "-c", code, str(path)], env=os.environ | {"PYTHONPATH": folders}, check=False
    )
    assert done.returncode == -signal.SIGKILL
    recorded = read_recording(path)
    assert not recorded.complete
    assert recorded.missing.endswith("what was recorded after the last whole chunk is missing")
    assert {topic: info.count for topic, info in recorded.topics.items() if topic.endswith("/state")} == {
        "/channel/state": 2300,
        "/x/state": 2300,
        "/y/state": 2300,
        "/s/state": 2300,
    }


def test_chunks_are_written_on_the_way_without_a_flush(path, blocks):
    with Recording(path, MACHINE, chunk_seconds=0.1) as recording:
        for name, block in blocks.machine(35):
            recording.block(name, block)
        for _chunk, compression in recording._file._closed_chunks:  # others have been written already
            compression.result()
        recording.block("plc", PlcBlock(350, 10))
        assert len(read_recording(path).states["/x/state"]) == 300
    assert len(read_recording(path).states["/x/state"]) == 350


def test_block_with_another_number_of_values_is_refused_and_the_rest_kept(path, blocks):
    bad = blocks.axis(10)
    bad.set_velocity.append(1.0)
    with Recording(path, MACHINE) as recording:
        recording.block("x", blocks.axis(0))
        with pytest.raises(CncError) as error:
            recording.block("x", bad)
        with pytest.raises(CncError):
            recording.block("x", bad)
        recording.block("x", blocks.axis(20))
    assert str(error.value) == (
        "P-ERR-26006 recording: AxisBlock with first cycle 10, count 10 does not fit its message: set_velocity "
        "holds 11 values; it was not recorded"
    )
    assert read_recording(path).states["/x/state"]["cycle"].tolist() == [*range(10), *range(20, 30)]


@pytest.mark.parametrize(("maker", "field"), [("axis", "set_jerk"), ("spindle", "mode"), ("channel", "line")])
def test_first_block_with_another_number_of_values_is_refused(path, blocks, maker, field):
    bad = getattr(blocks, maker)(0)
    getattr(bad, field).append(1)
    with Recording(path, MACHINE) as recording:
        with pytest.raises(CncError) as error:
            recording.block("u", bad)
        recording.block("u", getattr(blocks, maker)(10))
    assert str(error.value) == (
        f"P-ERR-26006 recording: {type(bad).__name__} with first cycle 0, count 10 does not fit its message: "
        f"{field} holds 11 "
        "values; it was not recorded"
    )
    assert read_recording(path).topics["/u/state"].count == 10


def test_blocks_of_a_spindle_with_commands_and_texts(path, blocks):
    """What its slaves do too, who commands it and what was refused: such blocks have a length of their own."""
    plain, busy = blocks.spindle(0), blocks.spindle(10)
    busy.master, busy.source, busy.refused = "t", "channel", [Refusal("channel", 24012, "spindle s: ...")]
    busy.commands = [Command("s", "start", {"direction": "cw", "speed_rpm": 1000.0})]
    with Recording(path, MACHINE) as recording:
        for block in (plain, busy, blocks.spindle(20)):
            recording.block("s", block)
    found = {
        message.first_cycle: message for schema, _, _, message in messages(path) if schema.name.endswith("SpindleBlock")
    }
    assert sorted(found) == [0, 10, 20]
    assert (found[10].master, found[10].source) == (busy.master, busy.source)
    assert list(found[10].refused) == ["channel: P-ERR-24012 spindle s: ..."]
    assert [Refusal.decode(text) for text in found[10].refused] == busy.refused
    assert [(each.command, each.arguments_json) for each in found[10].commands] == [
        ("start", '{"direction": "cw", "speed_rpm": 1000.0}')
    ]
    assert read_recording(path).topics["/s/state"].count == 30


def test_channel_setpoints_of_different_length_are_refused(path, blocks):
    bad = blocks.channel(0)
    bad.set_velocity.pop()
    with Recording(path, MACHINE) as recording, pytest.raises(CncError) as error:
        recording.block("channel", bad)
    assert str(error.value) == (
        "P-ERR-26006 recording: ChannelBlock with first cycle 0, count 10 does not fit its message: set_velocity "
        "holds 29 values; "
        "it was not recorded"
    )


@pytest.mark.parametrize(("field", "value"), [("state", 256), ("error_id", -1), ("set_position", "far")])
def test_value_beyond_its_field_is_refused(path, blocks, field, value):
    bad = blocks.axis(0)
    getattr(bad, field)[3] = value
    with Recording(path, MACHINE) as recording:
        recording.block("x", blocks.axis(0))
        with pytest.raises(CncError, match="does not fit its message") as error:
            recording.block("x", bad)
    assert error.value.number == 26006


def test_topic_with_two_types_is_refused(path, blocks):
    with Recording(path, MACHINE) as recording:
        recording.block("x", blocks.axis(0))
        with pytest.raises(CncError) as error:
            recording.block("x", blocks.spindle(0))
        recording.raw("/x/block", "cnc_ptp/AxisBlock", b"\0\1\0\0", 0)
    assert str(error.value) == (
        f"P-ERR-26008 recording {path}: topic /x/block holds cnc_ptp/msg/AxisBlock, a message of "
        "cnc_ptp/msg/SpindleBlock "
        "came; it was not recorded"
    )


@pytest.mark.parametrize(
    ("call", "what"),
    [
        (lambda recording, blocks: recording.block("x", blocks.axis(10)), "the block with first cycle 10"),
        (
            lambda recording, blocks: recording.block("c", blocks.channel_with_commands(10)),
            "the block with first cycle 10",
        ),
        (lambda recording, blocks: recording.block("plc", PlcBlock(10, 10)), "the block with first cycle 10"),
        (lambda recording, blocks: recording.tick(CycleTick(10, 10)), "the block with first cycle 10"),
        (lambda recording, blocks: recording.event(Event(1, "x", 0, 0, "")), "/events"),
        (lambda recording, blocks: recording.command(CommandRecord(1, "x", "stop", "{}", True, 0, "")), "/commands"),
        (lambda recording, blocks: recording.raw("/any", "std_msgs/msg/Header", b"", 0), "/any"),
        (lambda recording, blocks: recording.attachment("p.nc", "text/plain", ""), "p.nc"),
        (lambda recording, blocks: recording.flush(), "a flush"),
    ],
)
def test_nothing_is_taken_after_close(path, blocks, call, what):
    recording = Recording(path, MACHINE)
    recording.block("x", blocks.axis(0))
    recording.close()
    recording.close()
    with pytest.raises(CncError) as error:
        call(recording, blocks)
    assert str(error.value) == (
        f"P-ERR-26009 recording {path}: {what} came after the recording was closed; it was not recorded"
    )


def test_path_that_cannot_be_created(tmp_path):
    path = tmp_path / "missing" / "run.mcap"
    with pytest.raises(CncError) as error:
        Recording(path, MACHINE)
    assert str(error.value) == (
        f"P-ERR-26007 recording {path} cannot be written: there is no folder {path.parent}, make it or give another "
        "name; nothing is recorded"
    )


def test_a_folder_that_takes_no_file_is_not_called_missing():
    with pytest.raises(CncError) as error:
        Recording("/proc/run.mcap", MACHINE)
    assert str(error.value) == (
        "P-ERR-26007 recording /proc/run.mcap cannot be written: No such file or directory; nothing is recorded"
    )


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_full_disk():
    with pytest.raises(CncError) as error:
        Recording("/dev/full", MACHINE)
    assert str(error.value) == (
        "P-ERR-26007 recording /dev/full: cannot be written: No space left on device; nothing is in it"
    )
    assert Path("/dev/full").is_char_device()


def test_disk_that_gets_full_keeps_what_was_written(path, blocks):
    recording = Recording(path, MACHINE)
    recording.block("x", blocks.axis(0))
    recording.flush()
    whole = path.stat().st_size
    full = open("/dev/full", "wb")  # noqa: SIM115
    recording._file._stream, kept = full, recording._file._stream
    for first in (10, 20):
        recording.block("x", blocks.axis(first))
        with pytest.raises(CncError, match="No space left on device"):
            recording.flush()
    with pytest.raises(CncError, match="No space left on device"):
        recording.close()
    kept.close()
    assert path.stat().st_size == whole
    assert read_recording(path).states["/x/state"]["cycle"].tolist() == list(range(10))
