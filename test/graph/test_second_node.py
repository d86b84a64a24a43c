"""A second node for a unit: it is refused and told who has the unit; the first one continues undisturbed."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest
import rclpy
from graph_support import MILL, TIMEOUT, Running, nodes_of, one_axis_machine, run, verified
from ros_support import ros

from cnc_ptp import msg
from cnc_ptp.errors import CncError
from cnc_ptp.nodes import process
from cnc_ptp.nodes.axis import AxisNode
from cnc_ptp.nodes.clock import ClockNode
from cnc_ptp.nodes.plc_bridge import PlcBridgeNode
from cnc_ptp.nodes.topics import BLOCKS, REMEMBERED_BLOCKS, REPORT, block_topic
from cnc_ptp.parameters import read_machine


@pytest.fixture
def one_axis(tmp_path):
    return one_axis_machine(tmp_path)


def node(*arguments):
    command = [sys.executable, "-m", "cnc_ptp.nodes.axis", *map(str, arguments)]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True)


def refusal(process_id, command_line, domain):
    return (
        f"P-ERR-26141 x: process {process_id} ({command_line}) on this computer has this unit on ROS domain {domain} "
        "already; nothing was started. End one of the two\n"
    )


def command_line(one_axis, *more):
    """As the operating system shows a node of the run."""
    program = os.path.basename(sys.executable)
    return f"{program} -m cnc_ptp.nodes.axis {one_axis} x{''.join(f' {word}' for word in more)}"


def wait_until_claimed(process_id):
    """The claim is made as the node is."""
    deadline = time.monotonic() + TIMEOUT
    while time.monotonic() < deadline:
        claims = {
            line.split()[6] for line in Path("/proc/net/unix").read_text().splitlines() if "@cnc_ptp/unit/" in line
        }
        if sockets_of(process_id) & claims:
            return
        time.sleep(0.05)
    raise AssertionError("no claim was made")


def sockets_of(process_id):
    """Their inodes."""
    found = set()
    for file in Path(f"/proc/{process_id}/fd").iterdir():
        with suppress(FileNotFoundError):
            found.add(os.readlink(file).removeprefix("socket:[").removesuffix("]"))
    return found


@pytest.mark.parametrize("options", [[], ["--composed"]], ids=str)
def test_a_stray_node_was_there_first(one_axis, ros_domain, options):
    """The run ends before anything is started; the stray node stays."""
    stray = node(one_axis, "x")
    try:
        wait_until_claimed(stray.pid)
        error = run("run", one_axis, "--duration", "1", *options, expect=2).stderr
        assert error == refusal(stray.pid, command_line(one_axis), ros_domain)
        assert stray.poll() is None
        stray.send_signal(signal.SIGINT)
        assert stray.wait(TIMEOUT) == 128 + signal.SIGINT and stray.stderr.read() == ""
    finally:
        stray.kill()
        stray.wait()
        stray.stderr.close()
    assert "computed twice 0" in run("run", one_axis, "--duration", "0.2", *options).stdout  # the unit is free again


def test_a_recording_is_not_played_to_nodes_that_nobody_supervises(one_axis, ros_domain, tmp_path):
    """They would take its blocks and ticks for theirs; a run holds the whole domain."""
    run("simulate", one_axis, "--duration", "0.1", "--record", tmp_path / "run.mcap")
    stray = node(one_axis, "x")
    try:
        wait_until_claimed(stray.pid)
        refused = run("replay", tmp_path / "run.mcap", "--publish", expect=2)
        assert refused.stderr == refusal(stray.pid, command_line(one_axis), ros_domain)
        assert "published" not in refused.stdout
    finally:
        stray.kill()
        stray.wait()
        stray.stderr.close()
    assert "published" in run("replay", tmp_path / "run.mcap", "--publish").stdout


def test_a_second_node_during_the_run_is_refused(one_axis, ros_domain, tmp_path):
    recording = tmp_path / "run.mcap"
    scenario = tmp_path / "move.yaml"
    scenario.write_text("- {at: 0.0, to: x, do: move_absolute, target: 50000.0, velocity: 50.0}\n")
    with Running(one_axis, "--scenario", scenario, "--record", recording) as graph:
        graph.wait_until_recorded(recording, 5_000)
        own = nodes_of(graph.process.pid)["x"]
        second = node(one_axis, "x")
        try:
            assert second.wait(TIMEOUT) == 2
            assert second.stderr.read() == refusal(own, command_line(one_axis, "--recorders", "1"), ros_domain)
        finally:
            second.kill()
            second.wait()
            second.stderr.close()
        graph.process.send_signal(signal.SIGTERM)
        output = graph.finish(expect=1)
    assert "lost 0, computed twice 0" in output
    assert verified(recording).states["/x/state"]["set_velocity"].max() == 50.0


def test_the_clock_does_not_start_with_two_nodes_of_a_unit_on_two_computers(one_axis):
    """A claim does not reach other computers; their publishers are seen all the same."""
    with ros():
        clock = ClockNode(read_machine(str(one_axis)))
        nodes = [rclpy.create_node("x", namespace=place, enable_rosout=False) for place in ("/", "/elsewhere")]
        for one in nodes:
            one.create_publisher(msg.AxisBlock, f"/{block_topic('x')}", REMEMBERED_BLOCKS)
        report = nodes[0].create_publisher(msg.BlockReport, REPORT, BLOCKS)
        executor = process.EventsExecutor()
        executor.add_node(clock)
        try:
            with pytest.raises(CncError) as refused:
                for source in ("x", "plc") * 100:
                    report.publish(msg.BlockReport(source=source, first_cycle=-1))
                    executor.spin_once(timeout_sec=0.05)
                    clock.advance()
        finally:
            for one in (clock, *nodes):
                one.destroy_node()
            executor.shutdown()
    assert str(refused.value) == (
        "P-ERR-26140 2 nodes have the unit 'x' (/elsewhere/x and /x); the clock ends, nothing was started. "
        "End all but one of them"
    )


def test_nodes_that_were_never_set_up_end_without_a_word():
    with ros():
        machine = read_machine(str(MILL))
        for node in (AxisNode(machine, "x"), PlcBridgeNode(machine)):
            node.destroy_node()
