"""A recording as rosbag2 reads it: metadata in the file and next to it, quality of service, hashes of the types."""

import random
import shutil
import tracemalloc

import pytest
import yaml
from long_support import long
from mcap.reader import make_reader
from mcap.records import Channel, Schema, Statistics
from recording_support import Blocks, record, smooth_run
from rosbags.highlevel import AnyReader
from rosbags.interfaces import QosDurability, QosHistory, QosReliability
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from cnc_ptp.errors import CncError
from cnc_ptp.recording.bag import QOS, bag_information
from cnc_ptp.recording.closing import close_cut
from cnc_ptp.recording.mcap_chunks import McapRecords
from cnc_ptp.recording.qos import Qos, parse_profiles, profiles_text
from cnc_ptp.recording.reader import iter_messages, read_recording, topics_of
from cnc_ptp.recording.settings import Settings, Split
from cnc_ptp.recording.writer import Recording
from cnc_ptp.wire.schemas import schema_text, type_hash

REMEMBERED = {"/x/block", "/s/block", "/events", "/commands", "/channel/handshake", "/channel/offsets"}
STATISTICS = Statistics(
    attachment_count=0,
    channel_count=1,
    channel_message_counts={1: 3},
    chunk_count=1,
    message_count=3,
    message_end_time=2,
    message_start_time=1,
    metadata_count=0,
    schema_count=1,
)


@pytest.fixture
def path(tmp_path):
    """Ten seconds of a machine, the channel asks once."""
    path = tmp_path / "run.mcap"
    blocks = Blocks(21)
    record(
        path, [*blocks.machine(100, axes=("x",)), ("channel", blocks.channel_with_commands(1000))], chunk_seconds=0.2
    )
    return path


def test_folder_is_a_bag(path):
    with Reader(path.parent) as bag:
        counts = {connection.topic: connection.msgcount for connection in bag.connections}
        assert bag.message_count == sum(counts.values()) == sum(1 for _ in bag.messages())
        assert (bag.start_time, bag.end_time) == (0, 1_009_000_000 + 1)
        assert counts["/x/state"] == 1000
        assert counts["/channel/handshake"] == 1
        times = [time for _, time, _ in bag.messages()]
    assert (times[0], times[-1]) == (0, 1_009_000_000)


def test_quality_of_service_is_kept(path):
    for reader in (Reader(path.parent), Reader(path)):
        with reader as bag:
            for connection in bag.connections:
                [qos] = connection.ext.offered_qos_profiles
                assert qos.reliability == QosReliability.RELIABLE
                assert qos.history == QosHistory.KEEP_LAST
                assert qos.depth == 1000
                remembered = qos.durability == QosDurability.TRANSIENT_LOCAL
                assert remembered == (connection.topic in REMEMBERED), connection.topic
                assert (qos.lifespan.sec, qos.lifespan.nsec) == (9223372036, 854775807)


def test_file_itself_has_the_metadata_for_ros2_bag_info(path):
    with path.open("rb") as stream:
        reader = make_reader(stream)
        [own] = [record.metadata for record in reader.iter_metadata() if record.name == "rosbag2"]
        topics = {channel.topic: channel.metadata for channel in reader.get_summary().channels.values()}
    inside = yaml.safe_load(own["serialized_metadata"])
    assert {"rosbag2_bagfile_information": inside} == yaml.safe_load((path.parent / "metadata.yaml").read_text())
    assert list(inside) == [
        "version",
        "storage_identifier",
        "starting_time",
        "duration",
        "message_count",
        "topics_with_message_count",
        "compression_format",
        "compression_mode",
        "relative_file_paths",
        "files",
        "custom_data",
        "ros_distro",
    ]
    assert (inside["version"], inside["storage_identifier"], inside["ros_distro"]) == (9, "mcap", "kilted")
    assert inside["relative_file_paths"] == ["run.mcap"] == [file["path"] for file in inside["files"]]
    for entry in inside["topics_with_message_count"]:
        topic = entry["topic_metadata"]
        assert topic["serialization_format"] == "cdr"
        assert topic["type_description_hash"] == topics[topic["name"]]["topic_type_hash"]
        assert topic["offered_qos_profiles"] == yaml.safe_load(topics[topic["name"]]["offered_qos_profiles"])


@pytest.mark.parametrize("name", ["cnc_ptp/msg/AxisState", "cnc_ptp/msg/Event", "sensor_msgs/msg/JointState"])
def test_hashes_are_those_that_the_definitions_give(name):
    """REP 2016, computed by rosbags from the definition itself."""
    store = get_typestore(Stores.EMPTY)
    parts = schema_text(name).split("=" * 80 + "\nMSG: ")
    for other, text in [(name, parts[0]), *(part.split("\n", 1) for part in parts[1:])]:
        store.register(get_types_from_msg(text, other))
    assert type_hash(name) == store.hash_rihs01(name)


def test_hash_of_a_type_that_is_not_installed_is_empty(tmp_path, monkeypatch):
    monkeypatch.setattr("cnc_ptp.wire.schemas.message_file", lambda _: tmp_path / "Nothing.msg")
    assert type_hash.__wrapped__("cnc_ptp/msg/AxisState") == ""


def test_second_recording_of_a_folder_leaves_the_metadata_of_the_first(path):
    beside = path.parent / "metadata.yaml"
    before = beside.read_text()
    other = path.parent / "other.mcap"
    record(other, list(Blocks(4).machine(3)))
    assert beside.read_text() == before
    with Reader(other) as bag:
        assert bag.message_count == 3 * (6 + 40) + 2  # the file alone is a bag as well
    record(path, list(Blocks(4).machine(3)))
    assert beside.read_text() != before
    path.unlink()
    record(other, list(Blocks(4).machine(5)))
    assert yaml.safe_load(beside.read_text())["rosbag2_bagfile_information"]["relative_file_paths"] == ["other.mcap"]


@pytest.mark.parametrize("text", ["title: my data\n", "", "- 1\n", "rosbag2_bagfile_information: {}\n", "\x00\xff: ["])
def test_foreign_metadata_stays(tmp_path, text):
    (tmp_path / "metadata.yaml").write_text(text, encoding="latin-1")
    record(tmp_path / "run.mcap", list(Blocks(4).machine(3)))
    assert (tmp_path / "metadata.yaml").read_text(encoding="latin-1") == text


def test_recording_under_way_has_no_metadata_of_the_one_before(path):
    with Recording(path, "machine: {}"):
        assert not (path.parent / "metadata.yaml").exists()
    assert (path.parent / "metadata.yaml").exists()


def test_folder_that_takes_no_metadata(tmp_path, monkeypatch):
    def refuse(*_arguments, **_options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("pathlib.Path.write_text", refuse)
    record(tmp_path / "run.mcap", list(Blocks(4).machine(3)))
    assert read_recording(tmp_path / "run.mcap").complete
    assert not (tmp_path / "metadata.yaml").exists()


def test_quality_of_service_of_other_bags():
    old = "- history: 3\n  depth: 0\n  reliability: {}\n  durability: {}\n"
    log = "rcl_interfaces/msg/Log"
    assert parse_profiles(old.format(1, 1), log) == Qos(1000, "transient_local", "reliable", 10)
    assert parse_profiles(old.format(2, 2), "a/msg/B") == Qos(1000, "volatile", "best_effort")
    assert parse_profiles(old.format(1, 1) + old.format(2, 2), "a/msg/B") == Qos(1000, "volatile", "best_effort")
    assert parse_profiles(profiles_text(Qos(7, "transient_local")), "a/msg/B") == Qos(7, "transient_local")
    for nothing in ("", "[]", "- 1", "{", "- depth: many"):
        assert parse_profiles(nothing, "cnc_ptp/msg/Jog") == Qos(10)


@pytest.mark.parametrize("split", [None, Split(seconds=0.2)], ids=["file", "parts"])
def test_an_independent_reader_finds_the_same(tmp_path, split):
    """Topics, types, numbers of messages, times and bytes."""
    path = tmp_path / "bag" / ("run" if split else "run.mcap")
    path.parent.mkdir()
    with Recording(path, "machine: {}", chunk_seconds=0.1, settings=Settings(split=split)) as recording:
        for name, block in Blocks(8).machine(100):
            recording.block(name, block)
    topics = topics_of(path)
    with Reader(path if split else path.parent) as bag:
        found = {each.topic: (each.msgtype, each.msgcount) for each in bag.connections}
        read = sorted((time, each.topic, bytes(data)) for each, time, data in bag.messages())
        whole = bag.message_count, bag.start_time, bag.end_time
    assert found == {topic: (info.type_name, info.count) for topic, info in topics.items()}
    assert read == sorted((each.log_time_ns, each.topic, each.cdr) for each in iter_messages(path))
    assert whole == (len(read), 0, max(info.last_ns for info in topics.values()) + 1)
    assert len([*path.parent.rglob("*.mcap")]) == (5 if split else 1)


# a recorder that died


def whole_end(path):
    """Offset behind the last whole record that is data."""
    ends = [0]
    records = McapRecords(path)
    for item in records:
        ends.append(item.offset + 9 + len(item.body))
    return ends


@pytest.mark.parametrize("count", [8, *long([25])])
def test_cut_recording_is_closed_wherever_it_was_cut(path, tmp_path, count):
    data = path.read_bytes()
    whole = list(iter_messages(path))
    ends = [end for end in whole_end(path) if end > 3000]
    cuts = {end + more for end in ends for more in (-1, 0, 1, 5) if end + more < len(data)}
    (tmp_path / "cut").mkdir()
    cut = tmp_path / "cut" / "run.mcap"
    for size in random.Random(5).sample(sorted(cuts), count):
        cut.write_bytes(data[:size])
        before = read_recording(cut)
        assert not before.complete
        messages = list(iter_messages(cut))
        assert close_cut(cut) == before.missing
        assert list(iter_messages(cut)) == messages
        with cut.open("rb") as stream:
            reader = make_reader(stream, validate_crcs=True)
            assert reader.get_summary().statistics.message_count == len(messages)
            assert sum(1 for _ in reader.iter_messages()) == len(messages)
            assert [part.name for part in reader.iter_attachments()] == ["machine.yaml"]
        after = read_recording(cut)
        assert not after.complete
        assert after.missing == before.missing
        assert after.states.keys() == before.states.keys()
        assert close_cut(cut) == ""
    assert list(iter_messages(path)) == whole


def test_records_are_read_one_after_another(tmp_path):
    """A recording may be of some gigabytes: no more than some chunks of it are in memory."""
    path = tmp_path / "run.mcap"
    smooth_run(path, 8.0, settings=Settings("none"))
    path.write_bytes(path.read_bytes()[:-3000])
    size = path.stat().st_size
    for call in (close_cut, topics_of):
        tracemalloc.start()
        assert call(path)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < size / 3, (call, peak, size)


def test_closed_recording_is_read_by_rosbags(path, tmp_path):
    (tmp_path / "cut").mkdir()
    cut = tmp_path / "cut" / "run.mcap"
    cut.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    count = len(list(iter_messages(cut)))
    close_cut(cut)
    with AnyReader([cut.parent]) as bag:
        assert sum(1 for _ in bag.messages()) == count
        assert bag.message_count == count > 1000


def test_whole_recording_stays_as_it_is(path):
    before = path.read_bytes()
    assert close_cut(path) == ""
    assert path.read_bytes() == before


def test_corrupt_recording_is_not_touched(path, tmp_path):
    cut = tmp_path / "cut.mcap"
    data = bytearray(path.read_bytes()[: path.stat().st_size // 2])
    data[3000] ^= 255
    cut.write_bytes(data)
    with pytest.raises(CncError) as error:
        close_cut(cut)
    assert error.value.number == 26003
    assert cut.read_bytes() == data


def test_recording_that_holds_no_chunk_yet(path, tmp_path):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[:300])
    assert "without having been closed" in close_cut(cut)
    assert read_recording(cut).states == {}
    shutil.copy(cut, path)
    with path.open("rb") as stream:
        assert make_reader(stream).get_summary().statistics.message_count == 0


@pytest.mark.parametrize("offered", ["'no end", "reliable", "", "{a: 1}"])
def test_quality_of_service_that_is_no_list_is_left_out(offered):
    """Of a recording of another program, or a damaged one, that is recovered."""
    channel = Channel(id=1, topic="/x", message_encoding="cdr", metadata={QOS: offered}, schema_id=1)
    schema = Schema(id=1, name="std_msgs/msg/String", encoding="ros2msg", data=b"")
    [described] = bag_information("run.mcap", STATISTICS, [channel], [schema])["topics_with_message_count"]
    assert described["topic_metadata"] == {
        "name": "/x",
        "type": "std_msgs/msg/String",
        "serialization_format": "cdr",
        QOS: [],
        "type_description_hash": "",
    }
