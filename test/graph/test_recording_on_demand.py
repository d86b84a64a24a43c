"""The recorder of a running graph: recordings on demand and snapshots, by its services and by `do recorder`."""

import pytest
import rclpy
from graph_support import PTP, Running, kill, run, states_equal, verified
from long_support import long
from ros_support import ros
from rosbags.rosbag2 import Reader

from cnc_ptp.client import CncError, Machine, RecorderOptions
from cnc_ptp.nodes.topics import RECORDER_SERVICES
from cnc_ptp.recording.reader import read_recording

SCENARIO = """
- {at: 0.0, to: x, do: move_absolute, target: 300, velocity: 20}
- {at: 2.0, to: x, do: set_override, percent: 50}
"""


class Asker:
    """Services of the recorder from outside."""

    def __init__(self):
        self.node = rclpy.create_node("asker", enable_rosout=False, start_parameter_services=False)
        self.clients = {
            name: self.node.create_client(kind, f"/recorder/{name}") for name, kind in RECORDER_SERVICES.items()
        }

    def ask(self, name, **fields):
        client = self.clients[name]
        assert client.wait_for_service(timeout_sec=20.0)
        future = client.call_async(RECORDER_SERVICES[name].Request(**fields))
        rclpy.spin_until_future_complete(self.node, future, timeout_sec=20.0)
        return future.result()

    def wait(self, seconds):
        rclpy.spin_until_future_complete(self.node, rclpy.task.Future(), timeout_sec=seconds)


@pytest.fixture
def asker():
    with ros():
        asker = Asker()
        yield asker
        asker.node.destroy_node()


def full_blocks(path):
    """All units have the same cycles, without a gap."""
    recorded = verified(path)
    spans = {(int(rows["cycle"].min()), int(rows["cycle"].max()), len(rows)) for rows in recorded.states.values()}
    assert len(spans) == 1
    first, last, count = spans.pop()
    assert count == last - first + 1
    return first, last


@pytest.mark.parametrize("options", [[], *long([["--composed"]])], ids=str)
def test_recordings_of_a_running_graph_can_be_computed_again(tmp_path, asker, options):
    scenario = tmp_path / "story.yaml"
    scenario.write_text(SCENARIO)
    with Running(PTP, "--scenario", scenario, "--duration", "12", "--keep", "2", *options) as graph:
        first, snapshot, late = (str(tmp_path / f"{name}.mcap") for name in ("first", "snapshot", "late"))
        while not (started := asker.ask("start", file=first)).accepted:
            assert started.error_id == 26196, started.message
            assert started.message == "recorder: start refused: the machine has not begun; nothing was changed"
            asker.wait(0.05)
        again = asker.ask("start", file=late)
        assert (again.accepted, again.error_id) == (False, 26190)
        assert again.message == (f"recorder: start refused: recording {first} is being written; nothing was changed")
        asker.wait(2.5)
        stopped = asker.ask("stop")
        assert stopped.accepted and full_blocks(first) == (started.cycle, stopped.cycle - 1)
        assert "scenario.yaml" in read_recording(first).attachments
        taken = asker.ask("snapshot", file=snapshot, seconds=1.0)
        assert taken.accepted and taken.message == ""
        begin, end = full_blocks(snapshot)
        assert begin == taken.cycle and end - begin + 1 >= 1000
        refused = asker.ask("stop")
        assert (refused.accepted, refused.error_id) == (False, 26191)
        assert asker.ask("start", file=late).accepted
        graph.finish(expect=0)  # a recording that nobody stops is closed with the run
        assert full_blocks(late)[1] == 11999


@pytest.mark.long
def test_commands_of_the_command_line(tmp_path):
    with Running(PTP, "--duration", "60", "--keep", "3") as graph:
        graph.wait_for_nodes(5)
        files = [tmp_path / f"{name}.mcap" for name in "ab"]
        assert f"recorder: start: {files[0]} begins with cycle " in run("do", "recorder", "start", files[0]).stdout
        assert run("do", "recorder", "start", files[1], expect=1).stderr.startswith(
            "P-ERR-26190 recorder: start refused: "
        )
        assert "recorder: stop: the recording ends before cycle " in run("do", "recorder", "stop").stdout
        output = run("do", "recorder", "snapshot", files[1], "seconds=60").stdout
        assert f"recorder: snapshot: {files[1]} begins with cycle " in output
        assert " s were kept and are in the snapshot, 60 s were asked for" in output
        assert run("do", "recorder", "rewind", expect=2).stderr == (
            "P-ERR-22002 recorder: unknown command 'rewind'; nothing was sent. Known: snapshot, start, stop\n"
        )
        for file in files:
            full_blocks(file)


@pytest.mark.parametrize("options", [*long([[]]), ["--split", "1s"]], ids=["file", "parts"])
def test_a_killed_recorder_leaves_a_recording_that_every_reader_opens(tmp_path, options):
    with Running(PTP, "--stay", "--recorder", *options) as graph:
        nodes = graph.wait_for_nodes(5)
        path = tmp_path / ("parts" if options else "a.mcap")
        run("do", "recorder", "start", path)
        newest = path / "parts_1.mcap" if options else path
        graph.wait_until_recorded(newest, 20_000)
        kill(nodes["recorder"])
        output = graph.finish(expect=1)
        assert "P-ERR-26104 node 'recorder' " in output
    recorded = verified(path, whole=False)
    assert not recorded.complete and "without having been closed" in recorded.missing
    with Reader(path if options else path.parent) as bag:
        assert bag.message_count == sum(1 for _ in bag.messages()) > 0


def test_the_client_of_a_graph_records(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    options = RecorderOptions(keep=5.0, compression="lz4")
    with Machine.start(PTP, composed=True, recorder=options) as m:
        m.x.move_absolute(20, velocity=50)
        began = m.recorder.start("a.mcap")
        m.run_for(0.5)
        ended = m.recorder.stop()
        taken = m.recorder.snapshot("b.mcap", 0.3)
        before = m.recorder.snapshot("c.mcap", 1, until=ended.cycle * 1e-3)
        with pytest.raises(CncError) as refused:
            m.recorder.stop()
        assert str(refused.value) == (
            "P-ERR-26191 recorder: stop refused: no recording is being written; nothing was changed"
        )
    assert full_blocks("a.mcap") == (began.cycle, ended.cycle - 1)
    assert full_blocks("c.mcap") == (before.cycle, ended.cycle - 1)
    first, last = full_blocks("b.mcap")
    assert first == taken.cycle and 300 <= last - first + 1 <= 320


@pytest.mark.long
def test_without_a_recorder(tmp_path):
    with Running(PTP, "--duration", "60") as graph:
        graph.wait_for_nodes(4)
        assert run("do", "recorder", "stop", expect=1).stderr == (
            "P-ERR-26136 recorder: stop: no answer; `cnc_ptp run` has a recorder with --record, --recorder or --keep\n"
        )


def test_an_error_leaves_a_snapshot(tmp_path):
    scenario = tmp_path / "story.yaml"
    scenario.write_text(
        "- {at: 0.0, to: x, do: move_absolute, target: 300, velocity: 100}\n"
        "- {at: 2.0, to: y, do: external_enable, mode: absolute}\n"
        "- {at: 2.0, to: y, do: external_setpoints, setpoints: [[2100, 0, 0, 0, 1], [2101, 0.01, 10, 10, 1]]}\n"
    )
    folder = tmp_path / "snapshots"
    run("run", PTP, "--scenario", scenario, "--duration", "4", "--keep", "1", "--snapshots", folder, expect=1)
    [snapshot] = folder.glob("error_*.mcap")
    first, last = full_blocks(snapshot)
    assert last - first + 1 in range(1000, 1600)


@pytest.mark.long
def test_parts_of_a_graph_are_those_of_the_run_offline(tmp_path):
    scenario = tmp_path / "story.yaml"
    scenario.write_text(SCENARIO)
    job = (PTP, "--scenario", scenario, "--duration", "3", "--split", "1s", "--compression", "lz4")
    run("simulate", *job, "--record", tmp_path / "a")
    run("run", *job, "--free-run", "--record", tmp_path / "b")
    assert states_equal(tmp_path / "a", tmp_path / "b") == []
    verified(tmp_path / "b")
    assert len([*(tmp_path / "b").glob("b_*.mcap")]) == 3


def test_a_split_or_a_condition_that_is_wrong_starts_nothing(tmp_path):
    for command in ("simulate", "run"):
        told = run(command, PTP, "--duration", "1", "--record", tmp_path / "a", "--split", "5 apples", expect=2).stderr
        assert told.startswith("P-ERR-26019 --split '5 apples': it is not a number with one of the units ")
    folder = tmp_path / "snaps"
    words = ("--keep", "1", "--snapshots", folder, "--snapshot-when", "q.set_position > 1")
    assert "P-ERR-26012" in run("run", PTP, "--duration", "1", *words, expect=2).stderr
    assert not [*tmp_path.iterdir()]
    missing = tmp_path / "none" / "snaps"
    assert run("run", PTP, "--duration", "1", "--keep", "1", "--snapshots", missing, expect=2).stderr == (
        f"P-ERR-26113 recording {missing} cannot be written: there is no folder {missing.parent}, make it or "
        "give another name; nothing was started\n"
    )
