"""MCAP files as other programs write them: without chunks, and with topics that are not of ROS 2 between those that are."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Chunk, Message
from mcap.writer import Writer

import cnc_ptp.recording
from cnc_ptp import cli
from cnc_ptp.errors import CncError
from cnc_ptp.recording.recovery import recover

POINT = b"float64 x"
COUNT = 40


def write_mixed(path: Path, *, chunks: bool = True, json: bool = True, finish: bool = True) -> Path:
    """A point and a note in JSON in turn, 100 a second."""
    with path.open("wb") as stream:
        writer = Writer(stream, use_chunking=chunks)
        writer.start()
        of_point = writer.register_schema("geometry_msgs/msg/Point32", "ros2msg", POINT)
        point = writer.register_channel("/point", "cdr", of_point)
        note = writer.register_channel("/note", "json", writer.register_schema("note", "jsonschema", b"{}"))
        for number in range(COUNT):
            time = number * 10_000_000
            content = b"\0\1\0\0" + np.array([number / 2]).tobytes()
            writer.add_message(point, time, content, time)
            if json:
                writer.add_message(note, time, b"{}", time)
        if finish:
            writer.finish()
    return path


def values(path: Path) -> list[float]:
    with cnc_ptp.recording.open(path) as recording:
        return recording.columns("/point")["x"].tolist()


@pytest.mark.parametrize("chunks", [True, False])
def test_recover_takes_all_messages_of_ros_between_others(tmp_path: Path, chunks: bool) -> None:
    path, output = write_mixed(tmp_path / "mixed.mcap", chunks=chunks), tmp_path / "out.mcap"
    recovered = recover(path, output)
    assert recovered.messages == COUNT
    (lost,) = recovered.lost
    assert lost.endswith(": /note holds no messages of ROS 2")
    assert values(output) == [number / 2 for number in range(COUNT)]


def test_recover_makes_chunks_of_a_cut_file_without_any(tmp_path: Path) -> None:
    path, output = write_mixed(tmp_path / "loose.mcap", chunks=False, json=False, finish=False), tmp_path / "out.mcap"
    path.write_bytes(path.read_bytes()[:-5])
    recovered = recover(path, output)
    assert recovered.messages == COUNT - 1 and len(recovered.lost) == 1
    assert values(output) == [number / 2 for number in range(COUNT - 1)]


def test_recover_knows_channels_that_are_named_before_the_chunk(tmp_path: Path) -> None:
    """Some writers name them beside the chunks; the file was cut before its summary."""
    path, output = tmp_path / "cut.mcap", tmp_path / "out.mcap"
    content, chunk = b"\0\1\0\0" + np.array([2.5]).tobytes(), RecordBuilder()
    Message(channel_id=1, log_time=7, data=content, publish_time=7, sequence=0).write(chunk)
    data = chunk.end()
    with path.open("wb") as stream:
        writer = Writer(stream, use_chunking=False)
        writer.start()
        assert writer.register_channel("/point", "cdr", writer.register_schema("a/msg/P", "ros2msg", POINT)) == 1
        writer.finish()
    whole, named = path.read_bytes(), RecordBuilder()
    Chunk("", data, 7, 7, 0, len(data)).write(named)
    end = whole.index(bytes([Opcode.DATA_END]) + (4).to_bytes(8, "little"))
    path.write_bytes(whole[:end] + named.end())
    assert recover(path, output).messages == 1
    assert values(output) == [2.5]


@pytest.mark.parametrize("finish", [True, False])
def test_a_file_without_chunks_says_so(tmp_path: Path, finish: bool) -> None:
    path = write_mixed(tmp_path / "loose.mcap", chunks=False, finish=finish)
    with pytest.raises(CncError) as raised:
        cnc_ptp.recording.open(path)
    text = f"P-ERR-26206 recording {path}: its messages are in no chunks"
    assert str(raised.value) == f"{text}; nothing was read, 'cnc_ptp recover' makes a file that has them"
    result = CliRunner().invoke(cli.main, ["export", str(path), "--topic", "/point", "-o", str(tmp_path / "out.csv")])
    assert result.exit_code == 2
    assert " ".join(result.stderr.split()).startswith(text)
