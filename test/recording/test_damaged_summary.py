"""A file whose summary is damaged, or that has topics that nobody can read here."""

import struct

import pytest
from click.testing import CliRunner
from machine_support import ROOT
from mcap.writer import Writer
from mcap_ros2.writer import Writer as RosWriter

import cnc_ptp.recording
from cnc_ptp.cli import main
from cnc_ptp.errors import CncError
from cnc_ptp.recording.mcap_index import END_SIZE
from cnc_ptp.recording.run_inputs import RunInputs


def refusal(call, *arguments):
    with pytest.raises(CncError) as refused:
        call(*arguments)
    return str(refused.value)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    path = tmp_path_factory.mktemp("whole") / "run.mcap"
    story = path.with_name("story.yaml")
    story.write_text("- {at: 0.0, to: x, do: move_absolute, target: 300, velocity: 100}\n")
    words = ["simulate", str(ROOT / "config" / "ptp.yaml"), "--scenario", str(story), "--duration", "0.2"]
    assert CliRunner().invoke(main, [*words, "--record", str(path)]).exit_code == 0
    return path


def summary_of(data):
    """Where it begins and ends."""
    (start,) = struct.unpack_from("<Q", data, len(data) - END_SIZE + 9)
    return start, len(data) - END_SIZE


@pytest.mark.parametrize("place", [0.1, 0.5, 0.9])
def test_a_damaged_summary_is_named(run, tmp_path, place):
    data = bytearray(run.read_bytes())
    start, end = summary_of(data)
    data[start + int(place * (end - start))] ^= 0x55
    path = tmp_path / "run.mcap"
    path.write_bytes(data)
    for call in (cnc_ptp.recording.open, RunInputs):
        assert refusal(call, path) == (
            f"P-ERR-26003 recording {path}: corrupt at offset {start}: the CRC of the summary does not match its content; "
            "nothing was read, take an intact copy of the file or save what is whole with 'cnc_ptp recover'"
        )


def test_an_index_of_messages_that_leads_nowhere(run, tmp_path):
    """An offset of 2⁶³ and more (`mcap-motion`, seed 7, number 2530)."""
    with cnc_ptp.recording.open(run) as opened:
        (file,) = opened._files
        (channel,) = file.ids_of("/x/state")
        place = next(chunk for chunk in file.chunks if channel in chunk.indexes)
        index = place.indexes[channel]
    data = bytearray(run.read_bytes())
    data[index + 9 + 6 + 8 : index + 9 + 6 + 16] = bytes([255] * 8)
    path = tmp_path / "run.mcap"
    path.write_bytes(data)
    with cnc_ptp.recording.open(path) as opened:
        assert refusal(lambda: opened.columns("/x/state")["set_position"]) == (
            f"P-ERR-26003 recording {path}: corrupt at offset {place.offset}: a message index leads behind the end of the "
            "chunk; nothing was read, take an intact copy of the file or save what is whole with 'cnc_ptp recover'"
        )


def without_crc(data):
    """As other programs write it."""
    data[-12:-8] = bytes(4)
    return data


def test_damaged_schemas_of_a_summary_without_a_crc_give_no_traceback(run, tmp_path):
    data = without_crc(bytearray(run.read_bytes()))
    start, _ = summary_of(data)
    path = tmp_path / "run.mcap"
    for text, spoilt in ((b"string command", b"strin# command"), (b"float64 set_position", b"flout64 set_position")):
        changed = bytearray(data)
        place = changed.index(text, start)
        changed[place : place + len(text)] = spoilt
        path.write_bytes(changed)
        with cnc_ptp.recording.open(path) as opened:
            [*unreadable] = opened.unreadable
            assert unreadable and "/clock/tick" in opened.topics
            assert refusal(opened.columns, unreadable[0]) == (
                f"P-ERR-26005 recording {path}: the schema of {unreadable[0]} is none of ROS 2; nothing was read"
            )


def test_commands_that_cannot_be_decoded_are_named(run, tmp_path):
    data = without_crc(bytearray(run.read_bytes()))
    start, _ = summary_of(data)
    place = data.index(b"string command", data.index(b"cnc_ptp/msg/CommandRecord", start))
    data[place : place + 6] = b"strin#"
    path = tmp_path / "run.mcap"
    path.write_bytes(data)
    text = refusal(RunInputs, path)
    assert text.startswith(f"P-ERR-26003 recording {path}: corrupt at offset 0: the commands cannot be read: ")


def test_topics_of_other_encodings_do_not_hide_the_rest(tmp_path):
    path = tmp_path / "foreign.mcap"
    with path.open("wb") as stream:
        writer = RosWriter(stream)
        schema = writer.register_msgdef("geometry_msgs/msg/Point", "float64 x")
        writer.write_message("/point", schema, {"x": 1.0}, 0, 0, 0)
        inner: Writer = writer._writer
        json = inner.register_schema("note", "jsonschema", b"{}")
        channel = inner.register_channel("/note", "json", json)
        inner.add_message(channel, 0, b"{}", 0)
        writer.finish()
    with cnc_ptp.recording.open(path) as opened:
        assert (list(opened.topics), opened.unreadable) == (["/point"], ["/note"])
        assert opened.columns("/point")["x"].tolist() == [1.0]
        assert refusal(opened.columns, "/note") == (
            f"P-ERR-26005 recording {path}: the schema of /note is none of ROS 2; nothing was read"
        )
