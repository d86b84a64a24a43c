"""Records and metadata of a recording with values that none has (found by bench.fuzz, seed 420)."""

import struct

import pytest
from mcap.opcode import Opcode
from mcap.records import Attachment

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import Event, Severity
from cnc_ptp.recording.mcap_chunks import RawRecord, RecordReader
from cnc_ptp.recording.mcap_file import METADATA, McapFile
from cnc_ptp.recording.opened import OpenRecording
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.recording.writer import Recording

END = "; nothing was read, take an intact copy of the file or save what is whole with 'cnc_ptp recover'"
HUGE = 2**64 - 1


def refusal(call):
    with pytest.raises(CncError) as caught:
        call()
    return str(caught.value)


@pytest.mark.parametrize(
    ("name", "value", "shown", "least"),
    [
        ("start_ns", "0\r\x00cycle_time_ns", "'0\\r\\x00cycle_time_ns'", 0),
        ("start_ns", str(2**63), f"'{2**63}'", 0),
        ("start_ns", "9" * 5000, f"'{'9' * 19}'", 0),
        ("cycle_time_ns", "0", "'0'", 1),
        ("cycle_time_ns", "1e6", "'1e6'", 1),
    ],
)
def test_times_that_are_none(name, value, shown, least, tmp_path):
    """mcap-every, numbers 1124 and 1216."""
    path = tmp_path / "r.mcap"
    file = McapFile(path)
    file.metadata(METADATA, {name: value})
    file.close()
    text = (
        f"P-ERR-26003 recording {path}: corrupt: its metadata have {name} = {shown}; nothing was read, a whole number "
        f"from {least} to 2**63 - 1 is needed"
    )
    assert [refusal(lambda read=read: read(path)) for read in (read_recording, OpenRecording, RunInputs)] == [text] * 3


def test_records_that_are_shorter_or_longer_than_they_say(tmp_path):
    """mcap-open number 8013; mcap-report numbers 8296, 4738 and 10501."""
    path = tmp_path / "r.mcap"
    reader = RecordReader(path)
    begin = f"P-ERR-26003 recording {path}: corrupt at offset 7: "
    text = f"{begin}the attachment has 3 bytes, and no CRC{END}"
    assert refusal(lambda: reader.attachment(RawRecord(7, Opcode.ATTACHMENT, b"abc"))) == text
    named = struct.pack("<QQI1sI1sQ", 0, 0, 1, b"a", 1, b"b", HUGE)
    assert refusal(lambda: reader.parse(Attachment.read, RawRecord(7, Opcode.ATTACHMENT, named))).startswith(
        f"{begin}attachment record cannot be read: OverflowError("
    )
    chunk = struct.pack("<QQQII4sQ", 0, 0, HUGE, 0, 4, b"zstd", 0)
    assert refusal(lambda: reader.chunk(RawRecord(7, Opcode.CHUNK, chunk))).startswith(
        f"{begin}the chunk cannot be uncompressed: "
    )


def test_a_topic_that_no_chunk_has(tmp_path):
    """Though it has messages, as the summary says: mcap-open number 1269."""
    path = tmp_path / "r.mcap"
    with Recording(path, "") as recording:
        recording.event(Event(0, "x", Severity.INFO, 0, "something else"))
    with OpenRecording(path) as opened:
        opened._chunks["/events"] = []
        text = f"P-ERR-26011 recording {path}: holds nothing of /events; nothing was read"
        assert refusal(lambda: opened.columns("/events", "cycle", start=0.0, end=1.0)) == text
