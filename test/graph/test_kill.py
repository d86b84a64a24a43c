"""`kill -9` of any node in mid-program: a clear error, a stop on ramps, a readable recording, no orphan, no hang."""

import os
import signal
import time

import numpy as np
import psutil
import pytest
from graph_support import (
    LATHE,
    LONG_PROGRAM,
    MILL,
    Running,
    alive,
    kill,
    one_axis_machine,
    small_machine,
    verified,
    wait_until_gone,
)
from long_support import long
from mcap.reader import SeekingReader, make_reader
from rosbags.rosbag2 import Reader

from cnc_ptp.parameters import read_machine

NODES = ["x", "channel", "clock", *long(["s", "plc", "recorder"])]
SAY_SO = {
    "x": {"plc", "channel"},
    "s": {"plc", "channel"},
    "channel": {"x", "y", "s", "plc"},
    "plc": {"x", "y", "s", "channel"},
    "clock": {"x", "y", "s", "channel", "plc"},
}
"""By the node that is killed: whose watchdog tells of it (26101)."""
UNDER_WAY = 150_000  # bytes of recording: about a second


@pytest.fixture
def running(tmp_path):
    (tmp_path / "long.nc").write_text(LONG_PROGRAM.replace(" Z-20", "").replace("N40 Z0\n", ""))
    recording = tmp_path / "run.mcap"
    with Running(small_machine(tmp_path), "--program", tmp_path / "long.nc", "--record", recording) as graph:
        nodes = graph.wait_for_nodes(7)
        graph.wait_until_recorded(recording, UNDER_WAY)
        yield graph, dict(nodes), recording


@pytest.mark.parametrize("node", NODES)
def test_killed_node(running, node):
    graph, nodes, recording = running
    kill(nodes[node])
    output = graph.finish(expect=1)
    process = f"node '{node}' (process {nodes[node]})"
    assert f"P-ERR-26104 {process} was ended by SIGKILL during the run; everything stops on its ramps" in output
    assert wait_until_gone(nodes.values()) == []
    recorded = verified(recording, whole=False)
    assert recorded.complete == (node != "recorder")
    assert recorded.last_cycle > 500
    check_every_reader_opens(recording)
    check_ramps(recorded, skip=node, ended=node != "recorder")
    drives = {node} & {"x", "s"}
    assert {stop.unit for stop in recorded.drive_stops} == drives, "no drive of a living unit brakes on its own"
    assert all(stop.actual_velocity[-1] == 0.0 for stop in recorded.drive_stops)
    assert len([event for event in recorded.events if event.error_id in (26265, 26266)]) == len(drives)
    assert "P-ERR-26267" not in output
    lost = {event.source for event in recorded.events if event.error_id == 26101}
    if node != "recorder":
        assert lost >= SAY_SO[node]
        if node != "s":
            assert recorded.states["/s/state"]["set_speed_rpm"][-1] == 0.0


def test_a_clock_and_an_axis_that_die_together(running):
    """The watchdog of the drive ends with the clock: nobody lets the drive brake, all others stop."""
    graph, nodes, recording = running
    for node in ("clock", "x"):
        kill(nodes[node])
    output = graph.finish(expect=1)
    assert "P-ERR-26104 node 'clock'" in output and "P-ERR-26104 node 'x'" in output
    assert wait_until_gone(nodes.values()) == []
    recorded = verified(recording, whole=False)
    check_every_reader_opens(recording)
    check_ramps(recorded, skip="x", ended=True)
    assert recorded.drive_stops == []
    assert recorded.states["/s/state"]["set_speed_rpm"][-1] == 0.0


def test_a_composed_run_that_is_killed(tmp_path):
    """Everything ends with its process; the file can be read to its last whole chunk, and the next run starts."""
    machine, program, recording = small_machine(tmp_path), tmp_path / "long.nc", tmp_path / "run.mcap"
    program.write_text(LONG_PROGRAM.replace(" Z-20", "").replace("N40 Z0\n", ""))
    with Running(machine, "--composed", "--program", program, "--record", recording) as graph:
        graph.wait_until_recorded(recording, UNDER_WAY)
        family = [each.pid for each in psutil.Process(graph.process.pid).children(recursive=True)]
        kill(graph.process.pid)
        graph.finish(expect=-signal.SIGKILL)
    assert wait_until_gone(family) == []
    recorded = verified(recording, whole=False)
    assert not recorded.complete and recorded.last_cycle > 500
    check_ramps(recorded, skip="x", ended=False)
    program.write_text("N10 G00 X1\nM30\n")
    with Running(machine, "--composed", "--program", program) as graph:
        graph.finish(expect=0)


@pytest.mark.parametrize("node", ["s", *long(["z", "channel", "plc", "clock"])])
def test_killed_node_while_it_taps(tmp_path, node):
    """Spindle and axis come to rest; without their channel in step, as their events say."""
    (tmp_path / "tap.nc").write_text("G63 Z-100 F500 S400\nM30\n")
    recording = tmp_path / "run.mcap"
    with Running(MILL, "--program", tmp_path / "tap.nc", "--record", recording) as graph:
        nodes = dict(graph.wait_for_nodes(8))
        graph.wait_until_recorded(recording, 2 * UNDER_WAY)
        kill(nodes[node])
        output = graph.finish(expect=1)
    assert f"P-ERR-26104 node '{node}' (process {nodes[node]}) was ended by SIGKILL" in output
    recorded = verified(recording, whole=False)
    check_ramps(recorded, skip=node, ended=True, axes=("x", "y", "z"))
    assert "P-ERR-26101" in output
    assert {stop.unit for stop in recorded.drive_stops} == {node} & {"s", "z"}
    assert recorded.states["/z/state"]["set_position"][-1] < 0.0, "the tool is in the hole"
    if node != "s":
        speed = recorded.states["/s/state"]["set_speed_rpm"]
        assert speed.max() > 100.0 and speed[-1] == 0.0
    if node not in ("s", "z"):
        lost = f"no block of '{node}' came within the watchdog time"
        assert f"P-ERR-26101 axis z: {lost}; the axis stops in step with spindle s (ErrorStop)" in output
        stops = "the spindle stops in step with the axes of the path (ErrorStop)"
        assert f"P-ERR-26101 spindle s: {lost}; {stops}" in output
        z, s = recorded.states["/z/state"], recorded.states["/s/state"]
        count = min(len(z["cycle"]), len(s["cycle"]))
        assert (z["cycle"][:count] == s["cycle"][:count]).all()
        turned = s["set_position_deg"][:count] - s["set_position_deg"][0]
        depth = z["set_position"][:count] - z["set_position"][0]
        assert turned == pytest.approx(-360.0 / 1.25 * depth, abs=0.01)


RETRACTS = "axis X retracts by 5 mm while the path follows spindle s, then the path stops and the program is aborted"
THREAD_BREAKS_OFF = {
    "s": f"channel channel: no block of 's' came within the watchdog time; {RETRACTS}",
    "z": f"channel channel: no block of 'z' came within the watchdog time; {RETRACTS}",
    "x": "channel channel: no block of 'x' came within the watchdog time; the path stops on its ramp in the thread and"
    " the program is aborted",
    "plc": f"channel channel: no block of 'plc' came within the watchdog time; {RETRACTS}",
    "clock": "channel channel: no block of 'clock' came within the watchdog time; its axes stop without it and the"
    " program is aborted",
    "channel": "axis z: no block of 'channel' came within the watchdog time; the axis stops on its own ramp (ErrorStop)",
}
"""By the node that is killed: what the event says of the axes."""


@pytest.mark.parametrize("node", ["plc", *long(["z", "s", "x", "channel", "clock"])])
def test_killed_node_while_it_cuts_a_thread(tmp_path, node):
    """The tool leaves the groove by X in step with the spindle, or the path stops in it, as the event says."""
    (tmp_path / "thread.nc").write_text("G18 G90 M03 S400\nG00 X36 Z300\nG33 Z20 K1.5\nM30\n")
    recording = tmp_path / "run.mcap"
    with Running(LATHE, "--program", tmp_path / "thread.nc", "--record", recording) as graph:
        nodes = dict(graph.wait_for_nodes(8))
        graph.wait_until_recorded(recording, 4 * UNDER_WAY)
        kill(nodes[node])
        output = graph.finish(expect=1)
    assert f"P-ERR-26104 node '{node}' (process {nodes[node]}) was ended by SIGKILL" in output
    assert f"P-ERR-26101 {THREAD_BREAKS_OFF[node]}" in output
    assert wait_until_gone(nodes.values()) == []
    recorded = verified(recording, whole=False)
    check_every_reader_opens(recording)
    check_ramps(recorded, skip=node, ended=True, axes=("x", "z"), machine=LATHE)
    retracted = "retracts" in THREAD_BREAKS_OFF[node]
    x, z, spindle = (recorded.states[f"/{name}/state"] for name in ("x", "z", "s"))
    assert x["set_position"][-1] == (41.0 if retracted else 36.0)
    assert z["set_position"].min() > 20.0, "the thread did not come to its end"
    if retracted and node == "s":
        lost = next(event.cycle for event in recorded.events if event.error_id == 26101)
        inside = (x["cycle"] >= lost) & (x["set_position"] < 37.0)
        assert inside.sum() > 10
        assert z["set_velocity"][inside] == pytest.approx([-10.0] * inside.sum()), "at the last speed of the spindle"
    if node != "s":
        assert spindle["set_speed_rpm"][-1] == 0.0
    passed = recorded.threads["channel"]
    assert np.nanmax(abs(passed["set_phase_error_deg"])) < 0.01
    assert set(passed["spindle"][passed["spindle"] > 0]) == {3}


def test_killed_server_of_processes(running):
    """It alone learns how a node ends; the nodes are there and stop on their ramps."""
    graph, nodes, recording = running
    (server,) = (
        child.pid for child in psutil.Process(graph.process.pid).children() if "forkserver" in " ".join(child.cmdline())
    )
    kill(server)
    output = graph.finish(expect=1)
    text = "P-ERR-26104 the process that nodes are forked from has ended; everything stops on its ramps"
    assert output.count("P-ERR-26104") == 1 and text in output
    assert wait_until_gone(nodes.values()) == []
    recorded = verified(recording)
    check_ramps(recorded, skip="", ended=True)


@pytest.mark.parametrize("node", ["x", "recorder"])
def test_killed_node_in_a_free_run_that_is_recorded(tmp_path, node):
    """The recorder waits for nobody who is gone, and the clock not for the recorder."""
    (tmp_path / "long.nc").write_text(LONG_PROGRAM.replace(" Z-20", "").replace("N40 Z0\n", ""))
    recording = tmp_path / "run.mcap"
    options = ("--program", tmp_path / "long.nc", "--record", recording, "--free-run")
    with Running(small_machine(tmp_path), *options) as graph:
        nodes = dict(graph.wait_for_nodes(7))
        graph.wait_until_recorded(recording, UNDER_WAY)
        kill(nodes[node])
        output = graph.finish(expect=1)
        assert f"P-ERR-26104 node '{node}' (process {nodes[node]}) was ended by SIGKILL during the run" in output
        assert wait_until_gone(nodes.values()) == []
        recorded = verified(recording, whole=False)
        if node != "recorder":
            assert recorded.states["/y/state"]["set_velocity"][-1] == 0.0


def check_every_reader_opens(recording):
    """The file has its end and its summary, and rosbag2 its metadata, whoever has closed it."""
    with recording.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert isinstance(reader, SeekingReader)
        count = sum(1 for _ in reader.iter_messages())
        assert count == reader.get_summary().statistics.message_count
    with Reader(recording.parent) as bag:
        assert bag.message_count == count == sum(1 for _ in bag.messages())


def check_ramps(recorded, *, skip, ended, axes=("x", "y"), machine=MILL):
    """No axis goes beyond its acceleration and jerk, and each that is alive is at a standstill at the end."""
    machine = read_machine(str(machine))
    for name in axes:
        axis, rows = machine.axes[name], recorded.states[f"/{name}/state"]
        assert np.all(np.diff(rows["cycle"].astype(int)) == 1), f"{name}: cycles are missing"
        limit = max(axis.acceleration, axis.deceleration)
        steps = np.abs(np.diff(rows["set_velocity"])) / 1e-3
        assert steps.max() <= limit * (1.0 + 1e-6), f"{name} accelerates with {steps.max()} mm/s²"
        moves = np.abs(np.diff(rows["set_position"])) / 1e-3
        assert moves.max() <= axis.max_velocity * (1.0 + 1e-6), f"{name} moves with {moves.max()} mm/s"
        bends = np.abs(np.diff(rows["set_acceleration"])) / 1e-3
        assert bends.max() <= axis.jerk * (1.0 + 1e-6), f"{name} jerks with {bends.max()} mm/s³"
        if ended and name != skip:
            assert rows["set_velocity"][-1] == 0.0, f"{name} still moves at the end"


def test_a_second_interrupt_ends_the_stop(running):
    graph, nodes, recording = running
    for node in ("x", "plc"):  # which do not answer, so that the stop takes its time
        os.kill(nodes[node], signal.SIGSTOP)
    graph.process.send_signal(signal.SIGINT)
    time.sleep(0.5)
    graph.process.send_signal(signal.SIGTERM)
    output = graph.finish(expect=1)
    assert "P-ERR-26106 the run was interrupted (SIGINT); everything stops on its ramps" in output
    assert "P-ERR-26106 a second interrupt (SIGTERM) has ended the stop before its end" in output
    assert wait_until_gone(nodes.values()) == []
    recorded = verified(recording, whole=False)
    assert "x" in {stop.unit for stop in recorded.drive_stops}
    assert 26265 in {event.error_id for event in recorded.events}


def test_interrupted_supervisor(running):
    graph, nodes, recording = running
    graph.process.send_signal(signal.SIGINT)
    output = graph.finish(expect=1)
    assert "P-ERR-26106 the run was interrupted (SIGINT); everything stops on its ramps" in output
    assert wait_until_gone(nodes.values()) == []
    recorded = verified(recording)
    assert recorded.complete
    check_ramps(recorded, skip="", ended=True)


def test_killed_supervisor_leaves_no_orphan(running):
    graph, nodes, recording = running
    assert all(alive(pid) for pid in nodes.values())
    kill(graph.process.pid)
    graph.process.wait()
    assert wait_until_gone(nodes.values()) == []
    assert verified(recording, whole=False).last_cycle > 500


def test_interrupt_while_the_nodes_start(tmp_path):
    with Running(one_axis_machine(tmp_path), "--record", tmp_path / "run.mcap") as graph:
        nodes = graph.wait_for_nodes(4)
        graph.process.send_signal(signal.SIGTERM)
        output = graph.finish(expect=1)
    assert "P-ERR-26106 the run was interrupted (SIGTERM); nothing has moved yet" in output
    assert "KeyboardInterrupt" not in output
    assert wait_until_gone(nodes.values()) == []
    assert not (tmp_path / "run.mcap").exists(), "nothing was recorded before the first tick"


def test_killed_node_while_the_nodes_start(tmp_path):
    with Running(one_axis_machine(tmp_path), "--record", tmp_path / "run.mcap") as graph:
        nodes = dict(graph.wait_for_nodes(4))
        kill(nodes["x"])
        output = graph.finish(expect=1)
    text = f"P-ERR-26104 node 'x' (process {nodes['x']}) was ended by SIGKILL during the run; nothing has moved yet"
    assert text in output
    assert wait_until_gone(nodes.values()) == []
    assert not (tmp_path / "run.mcap").exists(), "nothing was recorded before the first tick"
