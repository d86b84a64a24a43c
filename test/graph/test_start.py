"""Starting and ending: by hand without supervisor, composed, with a full disk."""

import re
import resource
import signal
import subprocess
import sys

import pytest
from graph_support import TIMEOUT, Running, command, one_axis_machine, run, verified
from mcap.writer import MCAP0_MAGIC

from cnc_ptp.commands.run.run import run as run_machine
from cnc_ptp.errors import CncError
from cnc_ptp.nodes.process import PROFILE, RANGE, set_environment
from cnc_ptp.recording.on_demand import OnDemand
from cnc_ptp.recording.reader import read_recording

SCENARIO = "- {at: 0.0, to: x, do: move_absolute, target: 5000.0, velocity: 100.0}\n"


@pytest.fixture
def one_axis(tmp_path):
    """A machine with a single axis: quick to start."""
    (tmp_path / "move.yaml").write_text(SCENARIO)
    return one_axis_machine(tmp_path)


def node(module, *arguments):
    return subprocess.Popen(
        [sys.executable, "-m", f"cnc_ptp.nodes.{module}", *map(str, arguments)], stderr=subprocess.PIPE, text=True
    )


def test_nodes_by_hand_without_a_supervisor(one_axis, tmp_path):
    recording = tmp_path / "hand.mcap"
    nodes = [
        node("recorder", one_axis, recording),
        node("axis", one_axis, "x", "--recorders", "1"),
        node("plc_bridge", one_axis, "--stay", "--recorders", "1", "--scenario", tmp_path / "move.yaml"),
    ]
    clock = node("clock", one_axis, "--duration", "1", "--wait-for", "recorder")
    try:
        assert clock.wait(TIMEOUT) == 0
        for process in reversed(nodes):
            process.send_signal(signal.SIGINT)
            assert process.wait(TIMEOUT) == 128 + signal.SIGINT
        assert [process.stderr.read() for process in (*nodes, clock)] == ["", "", "", ""]
    finally:
        for process in (*nodes, clock):
            process.kill()
            process.wait()
            process.stderr.close()
    recorded = verified(recording)
    assert recorded.complete and recorded.last_cycle == 999 and recorded.states["/x/state"]["set_velocity"][-1] == 100.0


def test_interrupted_composed_run(one_axis, tmp_path):
    recording = tmp_path / "composed.mcap"
    with Running(one_axis, "--scenario", tmp_path / "move.yaml", "--composed", "--record", recording) as graph:
        graph.wait_until_recorded(recording, 20_000)
        graph.process.send_signal(signal.SIGTERM)
        output = graph.finish(expect=1)
    assert "P-ERR-26106 the run was interrupted (SIGTERM); everything was stopped on its ramps" in output
    recorded = verified(recording)
    assert recorded.complete and recorded.states["/x/state"]["set_velocity"][-1] == 0.0


def test_full_disk(one_axis):
    """/dev/full can be opened, and takes nothing."""
    done = run("run", one_axis, "--record", "/dev/full", expect=1)
    text = "recording /dev/full: cannot be written: No space left on device; nothing is in it"
    assert f"P-ERR-26007 {text}" in done.stderr
    assert "failed: P-ERR-26104 node 'recorder' " in done.stdout
    assert "Exception in" not in done.stderr


def test_full_disk_in_a_composed_run(one_axis):
    done = run("run", one_axis, "--composed", "--record", "/dev/full", expect=1)
    assert "failed: P-ERR-26007 recording /dev/full: cannot be written" in done.stdout


def test_a_recording_that_a_composed_run_cannot_close_is_closed_behind_its_last_chunk(
    one_axis, tmp_path, monkeypatch, capfd
):
    recording = tmp_path / "run.mcap"

    def close(of: OnDemand) -> None:
        raise CncError(26007, "recording run.mcap: cannot be written: No space left on device", "its end is missing")

    monkeypatch.setattr(OnDemand, "close", close)
    scenario = str(tmp_path / "move.yaml")
    status = run_machine(str(one_axis), None, scenario, 20.0, str(recording), free_run=True, composed=True)
    output = capfd.readouterr().out
    assert status == 1
    assert (
        "failed: P-ERR-26007 recording run.mcap: cannot be written: No space left on device; its end is missing\n"
        in output
    )
    recorded = read_recording(recording)
    assert recording.read_bytes().endswith(MCAP0_MAGIC)
    assert "without having been closed" in recorded.missing and recorded.last_cycle > 900


@pytest.mark.parametrize("composed", [(), ("--composed",)])
def test_disk_that_gets_full_on_the_way(one_axis, tmp_path, composed):
    """The run continues to its end; the event says from where on the recording has nothing; the file opens."""
    recording = tmp_path / "run.mcap"
    options = ("--scenario", tmp_path / "move.yaml", "--duration", "4", *composed, "--record", recording)
    done = subprocess.run(
        command("run", one_axis, *options),
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (150_000, 150_000)),
    )
    assert "machine time 4.0" in done.stdout, done.stdout + done.stderr
    found = re.search(
        rf"P-ERR-26015 recorder: recording {recording}: cannot be written at offset \d+: File too large; the run continues "
        r"without it, about cycle (\d+) and later are missing",
        done.stderr,
    )
    assert found and done.returncode == 1, done.stderr
    recorded = read_recording(recording)
    assert not recorded.complete and 0 < recorded.last_cycle <= int(found[1]) + 1000 < 4000


def test_free_run_that_is_recorded_in_full(one_axis, tmp_path):
    """As fast as all can, the recorder included: not a block is missing."""
    recording = tmp_path / "free.mcap"
    run("run", one_axis, "--scenario", tmp_path / "move.yaml", "--duration", "6", "--free-run", "--record", recording)
    recorded = verified(recording)
    assert recorded.last_cycle == 5999 and read_recording(recording).topics["/plc/block"].count == 600


@pytest.mark.parametrize(
    ("given", "rmw", "result"),
    [
        ({}, "rmw_fastrtps_cpp", {RANGE: "SYSTEM_DEFAULT", PROFILE: "localhost.xml"}),
        ({RANGE: "LOCALHOST"}, "rmw_fastrtps_cpp", {RANGE: "SYSTEM_DEFAULT", PROFILE: "localhost.xml"}),
        ({RANGE: "SUBNET"}, "rmw_fastrtps_cpp", {RANGE: "SUBNET"}),
        ({PROFILE: "own.xml"}, "rmw_fastrtps_cpp", {RANGE: "LOCALHOST", PROFILE: "own.xml"}),
        ({"ROS_LOCALHOST_ONLY": "1"}, "rmw_fastrtps_cpp", {RANGE: "LOCALHOST", "ROS_LOCALHOST_ONLY": "1"}),
        ({}, "rmw_cyclonedds_cpp", {RANGE: "LOCALHOST"}),
    ],
)
def test_messages_stay_on_the_machine_unless_the_user_decides(given, rmw, result):
    environment = dict(given)
    set_environment(environment, rmw)
    if PROFILE in environment:
        environment[PROFILE] = environment[PROFILE].rpartition("/")[2]
    assert environment == result
