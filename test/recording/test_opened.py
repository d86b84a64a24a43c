"""`cnc_ptp.recording.open`: columns and tables, compared with the messages as the readers of mcap decode them."""

import csv
import json
import math

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType, Writer
from mcap_ros2.decoder import DecoderFactory
from recording_support import Blocks, record, smooth_run

import cnc_ptp.recording
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import CommandRecord, Event
from cnc_ptp.recording import opened
from cnc_ptp.recording.export import export_topic
from cnc_ptp.recording.message_fields import plain
from cnc_ptp.wire.layout import encode
from cnc_ptp.wire.schemas import load_schema


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """One second in chunks of 0.1 s; all kinds of messages, numbers of every kind."""
    path = tmp_path_factory.mktemp("opened") / "run.mcap"
    blocks = Blocks(11)
    run = [*blocks.machine(100), ("channel", blocks.channel_with_commands(1000)), ("x", blocks.axis(1000, 3))]
    record(path, run, chunk_seconds=0.1)
    return path


def decoded(path):
    """Messages by topic, in the order of log times, by the library's own reader: (log time, message)."""
    messages = {}
    with path.open("rb") as stream:
        for _, channel, message, content in make_reader(
            stream, decoder_factories=[DecoderFactory()]
        ).iter_decoded_messages():
            messages.setdefault(channel.topic, []).append((message.log_time, content))
    return messages


def value_of(message, name):
    for part in name.split("."):
        message = getattr(message, part)
    return plain(message)


def same(one, other):
    if isinstance(one, list):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, float) and math.isnan(one):
        return math.isnan(other)
    return one == other


def assert_all_equal(path):
    expected = decoded(path)
    with cnc_ptp.recording.open(path) as recording:
        assert {name: topic.count for name, topic in recording.topics.items()} == {
            name: len(messages) for name, messages in expected.items()
        }
        for name, messages in expected.items():
            topic = recording.topics[name]
            columns = recording.columns(name, "log_time", *topic.fields)
            assert columns["log_time"].tolist() == [time for time, _ in messages]
            for field in topic.fields:
                values = [np.asarray(value).tolist() for value in columns[field]]
                wanted = [value_of(message, field) for _, message in messages]
                assert same([plain(value) for value in values], wanted), (name, field)


def test_every_field_of_every_topic_is_as_the_library_decodes_it(path):
    assert_all_equal(path)


def test_numbers_need_no_object_a_message(path, monkeypatch):
    def never(*_arguments):
        raise AssertionError

    with cnc_ptp.recording.open(path) as recording:
        monkeypatch.setattr(recording._readers["/x/state"], "_decode", never)
        columns = recording.columns("/x/state")
        assert columns["set_position"].dtype == np.float64
        assert columns["status_bits"].dtype == np.uint32
        assert columns["time"].tolist() == pytest.approx(np.arange(1003) * 1e-3, abs=1e-12)


def test_columns_are_read_when_they_are_asked_for(path, monkeypatch):
    with cnc_ptp.recording.open(path) as recording:
        asked = []
        read = recording._read
        monkeypatch.setattr(recording, "_read", lambda *given: asked.append(given[2]) or read(*given))
        columns = recording.columns("/x/state")
        assert not asked
        assert {"time", "cycle", "set_position"} < {*columns}
        assert len(columns["cycle"]) == len(columns["cycle"]) == 1003
        assert {tuple(names) for names in asked} == {("cycle",)}
        asked.clear()
        together = recording.columns("/x/state", "cycle", "set_jerk")
        assert (len(together), len(together["cycle"]), len(together["set_jerk"])) == (2, 1003, 1003)
        assert {tuple(names) for names in asked} == {("cycle", "set_jerk")}


def test_a_window_reads_its_chunks_only(path, monkeypatch):
    with cnc_ptp.recording.open(path) as recording:
        chunks = []
        inside = recording._files[0].chunk
        monkeypatch.setattr(recording._files[0], "chunk", lambda record: chunks.append(record.offset) or inside(record))
        columns = recording.columns("/y/state", "cycle", start=0.45, end=0.455)
        assert columns["cycle"].tolist() == [450, 451, 452, 453, 454, 455]
        assert len(chunks) == 1


def test_table(path):
    with cnc_ptp.recording.open(path) as recording:
        table = recording.frame("/x/state", start=0.3, end=0.302)
        assert table.index.name == "time"
        assert table.index.tolist() == pytest.approx([0.3, 0.301, 0.302])
        assert table["cycle"].tolist() == [300, 301, 302]
        assert not [name for name in table.columns if name.startswith("header")]
        assert recording.frame("/x/state", "set_jerk", "time").columns.tolist() == ["set_jerk"]
        blocks = recording.frame("/y/block", "set_position", start=0.5, end=0.5)
        assert blocks.columns.tolist() == [f"set_position[{place}]" for place in range(10)]
        assert recording.frame("/events", "text", "severity").values.tolist() == [['x: Öl <niedrig> & "fällt"', 1]]
        assert recording.frame("/commands")["arguments_json"].tolist() == ["{}"]


def test_sequences_of_different_lengths_are_objects(path):
    with cnc_ptp.recording.open(path) as recording:
        columns = recording.columns("/x/block")
        assert columns["set_position"].dtype == object
        assert [len(row) for row in columns["set_position"][-2:]] == [10, 3]
        assert recording.columns("/x/block", "set_position", end=0.5)["set_position"].shape == (51, 10)


def test_a_cut_file_gives_its_whole_chunks(path, tmp_path):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])
    with cnc_ptp.recording.open(cut) as recording:
        assert not recording._files[0].indexed
        cycles = recording.columns("/x/state", "cycle")["cycle"]
        assert cycles.tolist() == list(range(len(cycles)))
        assert recording.topics["/x/state"].count == len(cycles) in range(500, 1000)
        assert recording.metadata["cycle_time_ns"] == "1000000"


@pytest.mark.parametrize("compression", list(CompressionType))
@pytest.mark.parametrize("indexes", [IndexType.ALL, IndexType.NONE])
def test_other_writers(tmp_path, compression, indexes):
    """One message after another, topics mixed, times out of order, some texts, DDS has filled up messages."""
    path = tmp_path / "other.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream, compression=compression, index_types=indexes, chunk_size=3000)
        writer.start("ros2")
        channels = {}
        for name in ("Event", "CommandRecord", "AxisState"):
            schema = load_schema(f"cnc_ptp/msg/{name}")
            schema_id = writer.register_schema(f"cnc_ptp/msg/{name}", "ros2msg", schema.text.encode())
            channels[name] = schema, writer.register_channel(f"/{name}", "cdr", schema_id)
        zero = cnc_ptp.wire.layout.zero(channels["AxisState"][0])
        for step in range(200):
            time = 5_000_000_000 + 1000 * (step ^ 3)
            contents = {
                "Event": Event(step, "x" * (step % 5), 1, 23001, "", step),
                "CommandRecord": CommandRecord(step, "", "", "", bool(step % 2), 0, ""),
                "AxisState": {**zero, "cycle": step, "set_position": step / 7},
            }
            for name, value in contents.items():
                schema, channel = channels[name]
                filled = bytes(step % 4) if name == "AxisState" else b""
                writer.add_message(channel, time, encode(schema, value) + filled, time)
        writer.finish()
    if indexes == IndexType.ALL:
        assert_all_equal(path)
    with cnc_ptp.recording.open(path) as recording:
        assert recording.start_ns == 5_000_000_000
        columns = recording.columns("/AxisState", "cycle", "set_position")
        assert [cycle ^ 3 for cycle in columns["cycle"].tolist()] == list(range(200))
        assert columns["set_position"].tolist() == [cycle / 7 for cycle in columns["cycle"].tolist()]
        assert recording.columns("/Event")["source"].tolist() == ["x" * ((step ^ 3) % 5) for step in range(200)]


def refusal(call):
    with pytest.raises(CncError) as error:
        call()
    return str(error.value)


def test_refusals(path, tmp_path, monkeypatch):
    with cnc_ptp.recording.open(path) as recording:
        assert refusal(lambda: recording.frame("/x/stat")) == (
            f"P-ERR-26011 recording {path}: holds no topic '/x/stat'; did you mean '/x/state' or '/y/state' or "
            "'/s/state'?; nothing was read"
        )
        assert refusal(lambda: recording.columns("/x/state", "set_positon")) == (
            f"P-ERR-26011 recording {path}: holds no field 'set_positon' of /x/state; did you mean 'set_position' or "
            "'set_position_modulo' or 'actual_position'?; nothing was read"
        )
        assert refusal(lambda: recording.columns("/x/state", start=7, end=8)) == (
            f"P-ERR-26011 recording {path}: holds nothing of /x/state from 7 s to 8 s, it covers 0 s to 1.002 s; "
            "nothing was read"
        )
        monkeypatch.setattr(opened, "import_module", lambda name: (_ for _ in ()).throw(ImportError(name)))
        assert refusal(lambda: recording.frame("/x/state")) == (
            "P-ERR-26013 pandas is not installed; nothing was read, install it with: pip install pandas"
        )
    assert refusal(lambda: cnc_ptp.recording.open(tmp_path)) == (
        f"P-ERR-26014 recording {tmp_path}: a folder without a metadata.yaml of rosbag2; nothing was read, give a file of "
        "the folder"
    )
    assert refusal(lambda: cnc_ptp.recording.open(tmp_path / "none.mcap")) == (
        f"P-ERR-26001 recording {tmp_path / 'none.mcap'}: cannot be opened: No such file or directory; nothing was read, "
        "check the path"
    )


def test_folder_of_a_recording(path):
    with cnc_ptp.recording.open(path.parent) as recording, cnc_ptp.recording.open(path) as file:
        assert recording.topics == file.topics


def test_exports_hold_the_same_numbers(tmp_path):
    smooth_run(tmp_path / "run.mcap", 0.3)
    parquet = pytest.importorskip("pyarrow.parquet")
    with cnc_ptp.recording.open(tmp_path / "run.mcap") as recording:
        for topic in recording.topics:
            expected = recording.columns(topic)
            files = [tmp_path / f"out{ending}" for ending in (".csv", ".parquet", ".npz")]
            assert {export_topic(recording, topic, file) for file in files} == {len(expected["time"])}
            rows = [*csv.DictReader(files[0].open(newline=""))]
            table = parquet.read_table(files[1])
            archive = np.load(files[2])
            assert [*rows[0]] == table.column_names == archive.files == [*expected]
            for name, column in expected.items():
                values = column.tolist()
                texts = [row[name] for row in rows]
                if column.dtype == object or column.ndim > 1:
                    wanted = [value if isinstance(value, str) else json.dumps(value) for value in values]
                    assert texts == wanted
                    assert column.ndim > 1 or archive[name].tolist() == wanted
                else:
                    assert [float(text == "True" if text in ("True", "False") else text) for text in texts] == values
                    assert table[name].to_pylist() == archive[name].tolist() == values
                    assert archive[name].dtype == column.dtype
