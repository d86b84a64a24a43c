"""Recordings read back: whole, cut off at any byte, with any byte altered, written by other tools."""

import struct
import zlib

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from long_support import examples, long
from mcap.opcode import Opcode
from mcap.writer import CompressionType, Writer
from recording_support import MACHINE, Blocks, record

import cnc_ptp.recording
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import CommandRecord, Event
from cnc_ptp.recording.reader import Diagnostic, iter_messages, read_recording
from cnc_ptp.recording.writer import Recording
from cnc_ptp.wire.layout import Header, encode
from cnc_ptp.wire.schemas import load_schema, parse_schema, schema_text


@pytest.fixture(scope="module")
def run():
    return list(Blocks(3).machine(40, axes=("x",)))


@pytest.fixture(scope="module")
def path(tmp_path_factory, run):
    path = tmp_path_factory.mktemp("reader") / "run.mcap"
    record(path, run, chunk_seconds=0.1)
    return path


@pytest.fixture(scope="module")
def scratch(tmp_path_factory):
    return tmp_path_factory.mktemp("altered") / "run.mcap"


def column(run, unit, field):
    return [value for name, block in run if name == unit for value in getattr(block, field)]


def bits(values):
    return np.asarray(values).view(np.uint64).tolist()


DERIVED = ("set_position_modulo", "actual_position_modulo", "actual_torque_digits", "set_direction")
"""Of AxisState; test_modulo_and_direction has them."""


def test_states_are_those_of_the_blocks(path, run):
    recorded = read_recording(path)
    assert recorded.complete
    assert recorded.missing == ""
    for unit, type_name in (("x", "AxisState"), ("s", "SpindleState"), ("channel", "ChannelState")):
        rows = recorded.states[f"/{unit}/state"]
        assert recorded.topics[f"/{unit}/state"].type_name == f"cnc_ptp/msg/{type_name}"
        assert rows["cycle"].tolist() == list(range(400))
        for field in load_schema(f"cnc_ptp/msg/{type_name}").fields[2:]:
            if field.name in DERIVED:
                continue
            expected = column(run, unit, field.name)
            if field.type == "float64":
                assert bits(np.ascontiguousarray(rows[field.name])) == bits(expected)
            else:
                assert rows[field.name].tolist() == expected


def test_everything_else_is_there(path):
    recorded = read_recording(path)
    assert recorded.machine_yaml == MACHINE
    assert recorded.events == [Event(3, "x", 1, 23001, 'x: Öl <niedrig> & "fällt"', 4)]
    assert recorded.commands == [CommandRecord(0, "channel", "start", "{}", True, 0, "")]
    assert (recorded.start_ns, recorded.cycle_time_ns, recorded.block_cycles, recorded.last_cycle) == (
        0,
        1_000_000,
        10,
        399,
    )
    assert recorded.ticks["first_cycle"].tolist() == list(range(0, 400, 10))
    assert list(recorded.of_type("cnc_ptp/msg/AxisState")) == ["x"]
    assert recorded.seconds(np.array([0, 1500], dtype=np.uint64)).tolist() == [0.0, 1.5]
    info = recorded.topics["/x/state"]
    assert (info.count, info.first_ns, info.last_ns) == (400, 0, 399_000_000)


def test_events_and_commands_are_in_the_order_of_their_cycles(tmp_path):
    with Recording(tmp_path / "run.mcap", MACHINE) as recording:
        for cycle in (30, 10, 20, 10):
            recording.event(Event(cycle, "x", 0, 0, str(len(recording._topics))))
            recording.command(CommandRecord(cycle, "x", "stop", "{}", True, 0, ""))
        recording.attachment("part.nc", "text/plain", "N10 G1 X1\n")
    recorded = read_recording(tmp_path / "run.mcap")
    assert [event.cycle for event in recorded.events] == [10, 10, 20, 30]
    assert [command.cycle for command in recorded.commands] == [10, 10, 20, 30]
    assert recorded.attachments == {"part.nc": "N10 G1 X1\n"}
    assert (recorded.block_cycles, recorded.last_cycle) == (10, -1)


def test_diagnostics(tmp_path):
    text = schema_text("diagnostic_msgs/msg/DiagnosticArray")
    status = {
        "level": 0,
        "name": "clock",
        "message": "",
        "hardware_id": "",
        "values": [{"key": "blocks", "value": "100"}],
    }
    cdr = encode(parse_schema("diagnostic_msgs/msg/DiagnosticArray", text), {"header": Header(), "status": [status]})
    with Recording(tmp_path / "run.mcap", MACHINE) as recording:
        recording.raw("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", cdr, 5)
    assert read_recording(tmp_path / "run.mcap").diagnostics == [Diagnostic(5, "clock", {"blocks": "100"})]


def test_messages_in_log_time_order(path, run):
    messages = list(iter_messages(path))
    assert len(messages) == 40 * 5 + 400 * 3 + 2
    times = [message.log_time_ns for message in messages]
    assert times == sorted(times)
    events = list(iter_messages(path, topics={"/events"}))
    assert [(event.topic, event.type_name, event.log_time_ns) for event in events] == [
        ("/events", "cnc_ptp/msg/Event", 3_000_000)
    ]
    assert events[0].cdr == encode(
        load_schema("cnc_ptp/msg/Event"), read_recording(path).events[0], lambda _: Header(0, 3_000_000)
    )


@pytest.mark.parametrize("step", [2003, *long([997])])
def test_a_file_cut_off_anywhere_gives_all_whole_chunks(path, scratch, step):
    data = path.read_bytes()
    counts = []
    for size in [*range(8, len(data), step), *range(len(data) - 40, len(data))]:
        scratch.write_bytes(data[:size])
        recorded = read_recording(scratch)
        assert not recorded.complete
        assert recorded.missing.startswith(f"the file ends at offset {size} without having been closed (")
        assert recorded.missing.endswith("what was recorded after the last whole chunk is missing")
        counts.append(len(recorded.states.get("/x/state", ())))
        assert counts[-1] % 100 == 0
        if counts[-1]:
            assert recorded.states["/x/state"]["cycle"].tolist() == list(range(counts[-1]))
            assert len(list(iter_messages(scratch, topics={"/x/state"}))) == counts[-1]
    assert counts == sorted(counts)
    assert set(counts) == {0, 100, 200, 300, 400}


@settings(max_examples=examples(300), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(place=st.floats(0, 1, exclude_max=True), flip=st.integers(1, 255))
def test_any_altered_byte_is_noticed(path, scratch, place, flip):
    data = bytearray(path.read_bytes())
    position = int(place * len(data))
    data[position] ^= flip
    scratch.write_bytes(data)
    try:
        recorded = read_recording(scratch)
    except CncError as error:
        assert error.number in (26002, 26003)
        assert str(scratch) in error.message
    else:
        assert not recorded.complete
        assert position >= len(data) - 8  # the closing magic: nothing but the mark of completeness


def test_footer_without_the_end_of_the_data_section(path, tmp_path):
    """One altered bit makes DataEnd a record of another type, and no CRC of the data would be checked."""
    data = bytearray(path.read_bytes())
    place = data.rindex(bytes([Opcode.DATA_END]) + (4).to_bytes(8, "little"))
    data[place] ^= 1
    altered = tmp_path / "altered.mcap"
    altered.write_bytes(data)
    with pytest.raises(CncError) as error:
        read_recording(altered)
    assert error.value.number == 26003
    assert "the footer comes without an end of the data section before it; nothing was read" in error.value.message


def test_missing_file(tmp_path):
    with pytest.raises(CncError) as error:
        read_recording(tmp_path / "none.mcap")
    assert str(error.value) == (
        f"P-ERR-26001 recording {tmp_path}/none.mcap: cannot be opened: No such file or directory; nothing was "
        "read, check the path"
    )


@pytest.mark.parametrize(
    ("content", "shown"),
    [
        (b"", "it is empty"),
        (b"SQLite format 3\0 and more", "it begins with 'SQLite f' instead of '�MCAP0\\r\\n'"),
        (b"# cnc_ptp\n", "it begins with '# cnc_pt' instead of '�MCAP0\\r\\n'"),
    ],
)
def test_file_that_is_no_mcap(scratch, content, shown):
    scratch.write_bytes(content)
    with pytest.raises(CncError) as error:
        read_recording(scratch)
    assert str(error.value) == (
        f"P-ERR-26002 recording {scratch}: not an MCAP file: {shown}; nothing was "
        "read, give a file that cnc_ptp or 'ros2 bag record --storage mcap' has written"
    )


ADVICE = "; nothing was read, take an intact copy of the file or save what is whole with 'cnc_ptp recover'"


def records(data):
    """(offset, opcode, length) of the records of a file."""
    offset = 8
    while offset < len(data) - 8:
        opcode, length = struct.unpack_from("<BQ", data, offset)
        yield offset, opcode, length
        offset += 9 + length


def refusal(scratch, data):
    scratch.write_bytes(data)
    with pytest.raises(CncError) as error:
        read_recording(scratch)
    assert error.value.number == 26003
    text = str(error.value)
    assert text.startswith(f"P-ERR-26003 recording {scratch}: corrupt at offset ")
    assert text.endswith(ADVICE)
    return text.removeprefix(f"P-ERR-26003 recording {scratch}: corrupt at ").removesuffix(ADVICE)


def place_of(data, opcode):
    return next(offset for offset, found, _ in records(data) if found == opcode)


def test_corrupt_chunk_crc(path, scratch):
    data = bytearray(path.read_bytes())
    chunk = place_of(data, 6)
    data[chunk + 9 + 24] ^= 1
    assert refusal(scratch, data) == f"offset {chunk}: the CRC of the chunk does not match its content"


def test_corrupt_chunk_data(path, scratch):
    data = bytearray(path.read_bytes())
    chunk = place_of(data, 6)
    data[chunk + 9 + 44] ^= 255  # the magic of zstd
    assert refusal(scratch, data).startswith(f"offset {chunk}: the chunk cannot be uncompressed: ")


def test_corrupt_attachment(path, scratch):
    data = bytearray(path.read_bytes())
    place = place_of(data, 9)
    data[place + 60] ^= 1
    assert refusal(scratch, data) == f"offset {place}: the CRC of the attachment does not match its content"


@pytest.mark.parametrize("start", [1 << 48, (1 << 64) - 1])
def test_footer_before_the_summary(path, scratch, start):
    data = bytearray(path.read_bytes())
    place = place_of(data, 2)
    data[place + 9 : place + 17] = start.to_bytes(8, "little")
    found = f"offset {place}: the footer lies before the summary, which begins at {start}"
    assert refusal(scratch, data) == found
    with pytest.raises(CncError) as error:
        cnc_ptp.recording.open(scratch)
    assert found in str(error.value)


def test_corrupt_message_index_shows_in_the_data_section(path, scratch):
    data = bytearray(path.read_bytes())
    data[place_of(data, 7) + 20] ^= 1
    assert refusal(scratch, data) == (
        f"offset {place_of(data, 15)}: the CRC of the data section does not match its content"
    )


def test_corrupt_summary(path, scratch):
    data = bytearray(path.read_bytes())
    data[place_of(data, 11) + 10] ^= 1
    assert refusal(scratch, data) == f"offset {place_of(data, 2)}: the CRC of the summary does not match its content"


def test_unknown_record(path, scratch):
    data = bytearray(path.read_bytes())
    place = place_of(data, 12)
    data[place] = 0x42
    assert refusal(scratch, data) == f"offset {place}: a record of the unknown type 66 begins there"


def test_record_longer_than_a_closed_file(path, scratch):
    data = bytearray(path.read_bytes())
    place = place_of(data, 6)
    struct.pack_into("<Q", data, place + 1, 10**9)
    assert refusal(scratch, data) == (
        f"offset {place}: a record of 1000000000 bytes begins there, {len(data) - place - 9} bytes of it are present"
    )


def test_record_that_ends_too_early(path, scratch):
    data = bytearray(path.read_bytes())
    place = place_of(data, 12)
    struct.pack_into("<I", data, place + 9, 10**6)  # length of the metadata's name
    assert refusal(scratch, data).startswith(f"offset {place}: metadata record cannot be read: ")


def test_bytes_after_the_footer(path, scratch):
    data = path.read_bytes()
    end = len(data) - 8
    assert refusal(scratch, data[:end] + b"x" + data[end:]) == (
        f"offset {end}: 9 bytes follow the footer instead of the MCAP magic"
    )


def test_private_records_are_passed_over(path, scratch):
    data = bytearray(path.read_bytes())
    place = place_of(data, 6)
    private = struct.pack("<BQ", 0x99, 3) + b"abc"
    scratch.write_bytes(data[:place] + private + data[place : place_of(data, 15)])
    assert len(read_recording(scratch).states["/x/state"]) == 400


def chunk_file(content):
    """A file that was cut off after one uncompressed chunk with this content."""
    chunk = (
        struct.pack("<QQQII", 0, 0, len(content), zlib.crc32(content), 0) + struct.pack("<Q", len(content)) + content
    )
    return b"\x89MCAP0\r\n" + struct.pack("<BQ", 6, len(chunk)) + chunk


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"\x05\x00", "the chunk ends inside a record at 0"),
        (struct.pack("<BQ", 5, 100), "the record at 0 of the chunk says 100 bytes"),
        (struct.pack("<BQ", 5, 1) + b"x", "the record at 0 of the chunk says 1 bytes"),
        (struct.pack("<BQHIQQ", 5, 22, 9, 0, 0, 0), "a message of the unknown channel 9 is in the chunk"),
    ],
)
def test_chunks_that_make_no_sense(scratch, content, reason):
    assert refusal(scratch, chunk_file(content)) == f"offset 8: {reason}"


def other_tool(path, type_name, data, *, text=None):
    """A file of the library's own writer, messages mixed and compressed with lz4."""
    writer = Writer(str(path), compression=CompressionType.LZ4, chunk_size=2000)
    writer.start("ros2", "test")
    schema = writer.register_schema(type_name, "ros2msg", (text or schema_text(type_name)).encode())
    other = writer.register_channel("/other", "cdr", 0)
    channels = [writer.register_channel("/y/state", "cdr", schema) for _ in range(2)]  # two publishers
    for index, content in enumerate(data):
        writer.add_message(channels[index % 2], index, content, index)
        writer.add_message(other, index, b"?", index)
    writer.finish()


def test_files_of_other_writers_are_read(scratch):
    schema = load_schema("cnc_ptp/msg/AxisState")
    names = [field.name for field in schema.fields[1:]]
    other_tool(
        scratch,
        "cnc_ptp/msg/AxisState",
        [encode(schema, {"header": Header()} | dict.fromkeys(names, index)) for index in range(60)],
    )
    recorded = read_recording(scratch)
    assert recorded.complete
    assert recorded.machine_yaml == ""
    assert recorded.states["/y/state"]["cycle"].tolist() == list(range(60))
    assert recorded.topics["/other"].count == 60
    assert [message.log_time_ns for message in iter_messages(scratch)] == [index // 2 for index in range(120)]


def test_state_of_another_size_is_refused(scratch):
    schema = load_schema("cnc_ptp/msg/AxisState")
    names = [field.name for field in schema.fields[1:]]
    message = {"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base"}} | dict.fromkeys(names, 0)
    other_tool(scratch, "cnc_ptp/msg/AxisState", [encode(schema, message)])
    assert "a message of /y/state has 192 bytes instead of 184 (cnc_ptp/msg/AxisState with empty frame_id)" in refusal(
        scratch, scratch.read_bytes()
    )


def test_event_that_cannot_be_decoded_is_refused(scratch):
    other_tool(scratch, "cnc_ptp/msg/Event", [b"\0\1\0\0 no event"])
    assert "a message of /y/state is not a cnc_ptp/msg/Event: " in refusal(scratch, scratch.read_bytes())
