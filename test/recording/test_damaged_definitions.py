"""Recordings whose definitions of messages are damaged (found by bench.fuzz: mcap-read seed 2 number 22, mcap-replay 20;

mcap-report seed 420 numbers 351 and 5506)."""

import pytest
from mcap.writer import CompressionType, Writer

from cnc_ptp.errors import CncError
from cnc_ptp.recording.long_recording import read_own
from cnc_ptp.recording.reader import read_recording


def recording(path, type_name, definition):
    with path.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.NONE)
        writer.start()
        schema = writer.register_schema(type_name, "ros2msg", definition)
        writer.add_message(writer.register_channel("/a", "cdr", schema), 0, bytes(8), 0)
        writer.finish()
    return path


def refusals(path):
    for read in (read_recording, lambda file: read_own(file, None, None)):
        with pytest.raises(CncError) as caught:
            read(path)
        yield str(caught.value)


def test_the_definition_of_a_state(tmp_path):
    path = recording(tmp_path / "r.mcap", "cnc_ptp/msg/AxisState", b"float64 x\x80")
    text = "P-ERR-26005 recording: message type cnc_ptp/msg/AxisState: its definition is no UTF-8 at byte 9; the schema is not usable"
    assert [*refusals(path)] == [text, text]


def test_the_definition_of_an_event(tmp_path):
    path = recording(tmp_path / "r.mcap", "cnc_ptp/msg/Event", b"float64 x\x80")
    for text in refusals(path):
        begin = f"P-ERR-26003 recording {path}: corrupt at offset "
        assert text.startswith(begin)
        assert ": the definition of cnc_ptp/msg/Event cannot be read: UnicodeDecodeError(" in text


@pytest.mark.parametrize(
    ("definition", "reason"),
    [
        (b"uint64 cycle\nfloat64 cycle\n", "field cnc_ptp/msg/AxisState.cycle is defined twice"),
        (b"MSG: cnc_ptp/Other\nuint64 cycle\n", "its schema does not define it"),
    ],
    ids=["twice", "not at all"],
)
def test_a_definition_that_is_none_of_its_type(definition, reason, tmp_path):
    path = recording(tmp_path / "r.mcap", "cnc_ptp/msg/AxisState", definition)
    text = f"P-ERR-26005 recording: message type cnc_ptp/msg/AxisState: {reason}; the schema is not usable"
    assert [*refusals(path)] == [text, text]
