"""`cnc_ptp recover`: a file cut at any byte, a damaged chunk."""

import pytest
from click.testing import CliRunner
from long_support import long
from mcap.reader import make_reader
from mcap.writer import MCAP0_MAGIC, Writer
from recording_support import MACHINE, smooth_run

import cnc_ptp.recording
from cnc_ptp import cli
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import CycleTick
from cnc_ptp.recording.mcap_index import McapIndex
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.recovery import recover
from cnc_ptp.recording.writer import Recording


def messages(path):
    """As the library's own reader finds them by the summary."""
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        return [(channel.topic, message.log_time, message.data) for _, channel, message in reader.iter_messages()]


@pytest.mark.parametrize("step", [13, *long([1])])
def test_every_byte_at_which_a_file_may_be_cut(tmp_path, step):
    whole, cut, output = tmp_path / "whole.mcap", tmp_path / "cut.mcap", tmp_path / "new" / "out.mcap"
    output.parent.mkdir()
    with Recording(whole, MACHINE) as recording:
        for first in range(0, 30, 10):
            recording.tick(CycleTick(first, 10))
            recording.flush()
    data, expected, counts = whole.read_bytes(), messages(whole), []
    assert len(expected) == 3
    for size in [*range(0, len(data), step), len(data)]:
        cut.write_bytes(data[:size])
        if size < 8:
            with pytest.raises(CncError, match="ends before its first message" if size else "not an MCAP file"):
                recover(cut, output)
            continue
        try:
            recovered = recover(cut, output)
        except CncError as refused:
            text = f"P-ERR-26224 recording {cut}: holds no message that can be saved; nothing whole follows at offset "
            assert str(refused).startswith(text) and str(refused).endswith("; nothing was written")
            assert not counts and [*output.parent.iterdir()] == []
            continue
        found = messages(output)
        assert found == expected[: len(found)] and len(found) == recovered.messages
        counts.append(len(found))
    assert counts == sorted(counts) and {*counts} == {1, 2, 3}
    assert recovered.lost == [] and read_recording(output).complete
    assert read_recording(output).machine_yaml == MACHINE


def test_a_damaged_chunk_is_left_out(tmp_path):
    path, output = tmp_path / "run.mcap", tmp_path / "out.mcap"
    smooth_run(path, 3.0, axes=("x",))
    index = McapIndex(path)
    [ids] = [index.ids_of("/x/state")]
    place = [chunk for chunk in index.chunks if not ids.isdisjoint(chunk.indexes)][1]
    index.close()
    data = bytearray(path.read_bytes())
    data[place.offset + place.length // 2] ^= 0x55
    path.write_bytes(data)
    result = CliRunner().invoke(cli.main, ["recover", str(path), "-o", str(output)])
    assert result.exit_code == 0
    first, lost = result.output.splitlines()
    assert first.startswith(f"{output}: ") and first.endswith(" messages, 0 s to 2.999 s")
    assert lost.startswith(f"lost: at offset {place.offset}: the ")
    with cnc_ptp.recording.open(output) as recording:
        cycles = recording.columns("/x/state", "cycle")["cycle"].tolist()
        assert cycles == [*range(1000), *range(2000, 3000)]
        assert len(recording.columns("/s/state", "cycle")["cycle"]) == 3000
    recorded = read_recording(output)
    assert not recorded.complete and recorded.missing.startswith(f"at offset {place.offset}: ")


@pytest.mark.parametrize(("what", "place"), [("damaged", -60), ("missing", None)])
def test_a_damaged_index_alone_is_told(tmp_path, what, place):
    path, output = tmp_path / "run.mcap", tmp_path / "out.mcap"
    smooth_run(path, 1.5, axes=("x",))
    data, expected = bytearray(path.read_bytes()), messages(path)
    if place is None:
        del data[-20:]
    else:
        data[place] ^= 0x55
    path.write_bytes(data)
    result = CliRunner().invoke(cli.main, ["recover", str(path), "-o", str(output)])
    assert result.output.splitlines() == [
        f"{output}: {len(expected)} messages, 0 s to 1.499 s",
        f"note: the index at its end was {what}, all messages are kept",
    ]
    assert messages(output) == expected and read_recording(output).complete


def test_a_cut_file_is_told_up_to_its_last_state(tmp_path):
    path, output = tmp_path / "run.mcap", tmp_path / "out.mcap"
    smooth_run(path, 3.0, axes=("x",))
    index = McapIndex(path)
    [*_, (_, place)] = sorted((chunk.first_ns, chunk.offset) for chunk in index.chunks)
    index.close()
    path.write_bytes(path.read_bytes()[: place + 20])
    result = CliRunner().invoke(cli.main, ["recover", str(path), "-o", str(output)])
    first, lost = result.output.splitlines()
    last = max(int(rows["cycle"].max()) for rows in read_recording(path).states.values())
    assert first == f"{output}: {len(messages(output))} messages, 0 s to {last / 1000:g} s"
    assert lost == f"lost: nothing whole follows at offset {place} of {place + 20}"


def test_the_recording_itself_is_not_overwritten(tmp_path):
    smooth_run(tmp_path / "run.mcap", 0.1)
    result = CliRunner().invoke(cli.main, ["recover", str(tmp_path / "run.mcap"), "-o", str(tmp_path / "run.mcap")])
    assert result.exit_code == 2 and "would overwrite the recording" in " ".join(result.output.split())


def test_a_file_without_messages_of_ros_gives_none(tmp_path):
    path, output = tmp_path / "foreign.mcap", tmp_path / "out.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        channel = writer.register_channel("/note", "json", writer.register_schema("note", "jsonschema", b"{}"))
        writer.add_message(channel, 0, b"{}", 0)
        writer.finish()
    output.write_bytes(MCAP0_MAGIC + b"former")
    result = CliRunner().invoke(cli.main, ["recover", str(path), "-o", str(output)])
    assert result.exit_code == 2
    assert " ".join(result.stderr.split()).startswith(
        f"P-ERR-26224 recording {path}: holds no message that can be saved; at offset "
    )
    assert "/note holds no messages of ROS 2" in result.stderr.replace("\n", " ")
    assert output.read_bytes() == MCAP0_MAGIC + b"former" and sorted(each.name for each in tmp_path.iterdir()) == [
        path.name,
        output.name,
    ]
