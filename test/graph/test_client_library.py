"""cnc_ptp.client.Machine with the graph: the same story as offline, and what only a graph can do to its client."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
import threading
import time

import psutil
import pytest
from client_stories import BLOCKS_EXPECTED, EXPECTED, block_story, refusal, setpoints, story
from graph_support import ROOT, Running, one_axis_machine, small_machine, verified, wait_until_gone

from cnc_ptp.client import CncError, JobStatus, Machine, MC_ReadParameter
from cnc_ptp.client.graph_link import GraphLink
from cnc_ptp.client.session import Session
from cnc_ptp.nodes.client import client_thread
from cnc_ptp.nodes.client.machine_client import MachineClient
from cnc_ptp.recording.reader import read_recording

KILLED = """
import sys, time
from cnc_ptp.client import Machine
m = Machine.start(sys.argv[1], record=sys.argv[2], namespace="killed")
m.x.move_absolute(500, velocity=200)
m.wait_until(lambda: m.x.state.set_velocity == 200.0, timeout=60.0)
print(m._session.link._graph._process.pid, flush=True)
time.sleep(600)
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("library")


@pytest.fixture(scope="module")
def mill(folder):
    return small_machine(folder)


@pytest.fixture(scope="module")
def m(ros_domain, mill, folder):
    """All nodes in one process."""
    with Machine.start(mill, record=folder / "run.mcap", composed=True) as machine:
        yield machine
    recorded = verified(folder / "run.mcap")
    assert recorded.complete and recorded.states["/x/state"]["set_velocity"][-1] == 0.0


def family(m: Machine) -> list[int]:
    """Processes of a graph."""
    graph = psutil.Process(m._session.link._graph._process.pid)
    return [graph.pid, *(child.pid for child in graph.children(recursive=True))]


def test_the_story_is_that_of_the_offline_machine_to_the_bit(ros_domain, mill, folder):
    with Machine.offline(mill, record=folder / "offline.mcap") as machine:
        offline = story(machine, folder)
    with Machine.start(mill, record=folder / "graph.mcap", composed=True, namespace="story") as machine:
        graph = story(machine, folder)
        processes = family(machine)
    assert offline == graph == EXPECTED
    assert wait_until_gone(processes) == []
    moved = setpoints(folder / "offline.mcap")
    assert setpoints(folder / "graph.mcap") == moved
    assert {unit: len(motions) for unit, motions in moved.items()} == {
        "x by move_absolute": 2, "s by start": 1, "x by start": 2, "y by start": 2, "x by mdi": 1, "y by mdi": 1,
    }  # fmt: skip
    assert all(all(motions) for motions in moved.values())
    for name in ("offline", "graph"):
        verified(folder / f"{name}.mcap")
    topics = [{*read_recording(folder / f"{name}.mcap").states} for name in ("offline", "graph")]
    assert topics[0] == topics[1]


def test_function_blocks_are_those_of_the_offline_machine(ros_domain, mill):
    with Machine.offline(mill) as machine:
        assert block_story(machine) == BLOCKS_EXPECTED
    started = Machine.start(mill, composed=True, namespace="blocks")
    with started, Machine.connect(namespace="blocks") as other:
        assert block_story(other) == BLOCKS_EXPECTED
        read = MC_ReadParameter(started.x)
        read(True, "P-AXIS-00236")
        assert read.value == 77.0  # as the other client has written it


def test_a_second_start_on_the_domain_is_refused(m, mill, ros_domain):
    with pytest.raises(CncError) as refused:
        Machine.start(mill, composed=True)
    assert str(refused.value) == (
        f"P-ERR-26107 a run is under way on ROS domain {ros_domain} of this machine; nothing was started. "
        "Wait for its end, choose another --namespace, or set ROS_DOMAIN_ID to another number"
    )


def test_what_cannot_be_started(m, mill, folder):
    why = f"there is no folder {folder}/none, make it or give another name"
    text = f"recording {folder}/none/a.mcap cannot be written: {why}; nothing was started"
    assert refusal(lambda: Machine.start(mill, record=folder / "none" / "a.mcap", namespace="a"))[:2] == (26113, text)
    number, text, _ = refusal(lambda: Machine.start(mill, scenario=folder / "none.yaml", namespace="a", composed=True))
    assert (number, text) == (
        26110,
        f"scenario {folder}/none.yaml cannot be read: No such file or directory; nothing was started",
    )
    typo = folder / "typo.yaml"
    typo.write_text(f"{mill.read_text()}nonsense: 1\n")
    number, text, _ = refusal(lambda: Machine.start(typo, namespace="a"))
    assert 25000 < number < 26000 and text.endswith("; nothing was started")
    number, text, _ = refusal(lambda: Machine.start(mill, composed=True, namespace="a", timeout=0.0))
    assert (number, text) == (
        26176,
        f"the graph of {mill} did not start: it was not running within 0 s; nothing has moved",
    )


def test_a_plc_in_a_file_and_a_scenario_serve_the_graph_that_is_started(m, folder):
    """As offline: test/client/test_offline.py."""
    plc, scenario, path = folder / "plc.py", folder / "scenario.yaml", folder / "plc.mcap"
    plc.write_text(
        "from cnc_ptp.plc.plcopen import MC_MoveAbsolute\n\n\n"
        "class Plc:\n    def __init__(self, io):\n        self.move = MC_MoveAbsolute(io.axis('y'))\n\n"
        "    def cycle(self, io):\n        self.move(io.axis('x').actual_position > 20.0, position=30.0)\n"
    )
    scenario.write_text("- {at: 0.05, to: x, do: set_override, percent: 50}\n")
    with Machine.start(
        ROOT / "config" / "ptp.yaml", record=path, scenario=scenario, plc=plc, composed=True, namespace="b"
    ) as other:
        other.x.move_absolute(40.0).wait(30.0)
        other.wait_until(lambda: other.y.state.set_position == 30.0, timeout=30.0)
        assert other.x.state.override_percent == 50.0
    assert verified(path).attachments["plc/plc.py"] == plc.read_text()


def test_no_machine_to_connect_to(m, ros_domain):
    text = f"no machine is running on ROS domain {ros_domain} in namespace /nowhere; nothing was sent"
    assert refusal(lambda: Machine.connect(namespace="nowhere", timeout=1.0))[:2] == (26135, text)


def test_another_client_ends_and_the_motion_continues(m):
    with Machine.connect() as other:
        assert {*other.axes} == {"x", "y"} and other.cycle_time == 0.001
        job = other.x.move_absolute(60, velocity=40)
        other.wait_until(lambda: other.x.state.set_velocity == 40.0, timeout=30.0)
    assert refusal(other.x.halt)[0] == 26172
    assert m.x.state.set_velocity > 0.0
    m.wait_until(lambda: m.x.state.set_position == 60.0, timeout=30.0)
    assert job.status is not JobStatus.DONE, "its client has ended before"
    m.x.move_absolute(0).wait(30.0)


def test_a_jog_goes_on_while_the_client_lives(m):
    job = m.y.jog(20).wait(30.0)
    begin = m.y.state.set_position
    m.run_for(1.0)
    assert m.y.state.set_velocity == 20.0 and m.y.state.set_position - begin == pytest.approx(20.0, abs=1.0)
    assert m.y.jog(20).number == job.number, "nothing new"
    faster = m.y.jog(40).wait(30.0)
    assert (job.status, faster.reached) == (JobStatus.ABORTED, True)
    assert m.y.jog(0).wait(30.0).done and m.y.state.set_velocity == 0.0
    assert m.y.jog(0).number == 0
    assert refusal(lambda: m.y.jog(5000))[0] == 23004
    with Machine.connect() as other:
        other.y.jog(-10).wait(30.0)
        text = f"plc: /y/jog has a second client '{m._session.link._thread.client.get_name()}'; it is ignored while the first one jogs y"
        assert refusal(lambda: m.y.jog(10))[:2] == (26144, f"{text}; nothing was changed")
    m.wait_until(lambda: m.y.state.set_velocity == 0.0, timeout=30.0)
    m.y.move_absolute(0).wait(30.0)


def test_events_and_states_come_as_iterators(m):
    events, coming = m.events(duration=3.0), m.x.states(duration=1.5)
    job = m.x.move_relative(5)
    states = [state for state in coming if state.cycle >= job.cycle]
    assert [state.cycle for state in states] == [*range(job.cycle, states[-1].cycle + 1)]
    assert max(state.set_velocity for state in states) > 0.0
    assert [event.text for event in events if event.source == "x"] == [
        "x: Standstill -> DiscreteMotion",
        "x: DiscreteMotion -> Standstill",
    ]
    m.x.move_relative(-5).wait(30.0)


def test_waits_in_an_event_loop(m):
    async def both():
        ticking = 0

        async def ticks():
            nonlocal ticking
            while True:
                await asyncio.sleep(0.02)
                ticking += 1

        side = asyncio.create_task(ticks())
        await asyncio.gather(m.x.move_absolute(10), m.y.move_absolute(20).wait_async(30.0))
        side.cancel()
        return ticking, await anext(aiter(m.x.states()))

    ticking, state = asyncio.run(both())
    assert ticking > 5 and state.set_position == 10.0
    with pytest.raises(CncError, match=r"26170 axis x: move_absolute is not done after 0\.01 s; it continues"):
        asyncio.run(m.x.move_absolute(0).wait_async(0.01))
    m.wait_until(lambda: m.x.state.set_position == 0.0, timeout=30.0)
    m.y.move_absolute(0).wait(30.0)


def test_series_and_tables_by_services(m, folder):
    m.x.external_enable("relative").wait(30.0)
    m.x.external_setpoints([[cycle, 0.01 * cycle, 10.0, 0.0, 1] for cycle in range(1, 101)] + [[101, 1.0, 0.0, 0.0, 0]])
    m.wait_until(lambda: m.x.state.set_position == pytest.approx(1.0), timeout=30.0)
    m.x.external_disable().wait(30.0)
    (folder / "cam.csv").write_text("master,slave\n0,0\n50,10\n100,0\n")
    m.x.move_absolute(0).wait(30.0)
    for table in ({"table": [[0, 0], [50, 10], [100, 0]]}, {"file": str(folder / "cam.csv")}):
        m.y.couple_cam("x", **table).wait(30.0)
        m.x.move_absolute(50).wait(30.0)
        assert m.y.state.set_position == pytest.approx(10.0)
        m.x.move_absolute(0).wait(30.0)
        m.y.decouple()
    m.x.reset_feedforward()
    m.s.reset_feedforward()
    assert refusal(lambda: m.channel.acknowledge(7))[0] == 22007


def test_feedforward_is_left_as_it_is_where_nothing_is_said(m):
    m.x.set_feedforward(enabled=True, weight_percent=40)
    m.x.set_feedforward(weight_percent=50)
    m.run_for(0.05)
    assert m.x.state.feedforward_percent == 50.0
    m.x.set_feedforward(enabled=False)
    m.x.set_feedforward(weight_percent=60)
    m.run_for(0.05)
    assert m.x.state.feedforward_percent == 0.0
    m.x.reset_feedforward()


def test_a_node_that_dies_ends_the_machine_and_every_wait(ros_domain, folder):
    machine = one_axis_machine(folder)
    with pytest.raises(CncError) as gone, Machine.start(machine, namespace="dies") as m:
        job = m.x.move_absolute(500, velocity=50)
        m.wait_until(lambda: m.x.state.set_velocity == 50.0, timeout=30.0)
        processes = family(m)
        victim = next(pid for pid in processes if "cnc_ptp.nodes.axis" in " ".join(psutil.Process(pid).cmdline()))
        os.kill(victim, signal.SIGKILL)
        job.wait(60.0)
    assert gone.value.number == 26171
    assert str(gone.value).startswith(
        f"P-ERR-26171 the machine has ended: P-ERR-26104 node 'x' (process {victim}) was ended by SIGKILL"
    )
    assert wait_until_gone(processes) == []


def test_an_error_in_the_program_leaves_no_process(ros_domain, folder):
    machine, record = one_axis_machine(folder), folder / "error.mcap"
    with pytest.raises(ZeroDivisionError), Machine.start(machine, record=record, namespace="error") as m:
        m.x.move_absolute(500, velocity=200)
        m.wait_until(lambda: m.x.state.set_velocity == 200.0, timeout=30.0)
        processes = family(m)
        1 / 0  # noqa: B018
    assert wait_until_gone(processes) == [] and len(processes) > 4
    rows = verified(record).states["/x/state"]
    assert rows["set_velocity"][-1] == 0.0 and rows["set_position"][-1] < 500.0


def test_a_client_that_is_killed_leaves_a_machine_that_stops_on_its_ramps(ros_domain, folder):
    record = folder / "killed.mcap"
    client = subprocess.Popen(
        [sys.executable, "-c", KILLED, str(one_axis_machine(folder)), str(record)], stdout=subprocess.PIPE, text=True
    )
    graph = psutil.Process(int(client.stdout.readline()))
    processes = [graph.pid, *(child.pid for child in graph.children(recursive=True))]
    client.kill()
    client.wait()
    client.stdout.close()
    assert wait_until_gone(processes) == []
    recorded = verified(record, whole=False)
    rows = recorded.states["/x/state"]
    assert rows["set_velocity"][-1] == 0.0 and 0.0 < rows["set_position"][-1] < 500.0
    assert [c.command for c in recorded.commands if c.target == "x"] == ["move_absolute", "stop"]


MOVES = """
import os, signal
from cnc_ptp.client import Machine
m = Machine.connect(timeout=30.0)
m.x.move_absolute(60, velocity=40)
m.wait_until(lambda: m.x.state.set_velocity == 40.0, timeout=30.0)
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_the_motion_of_a_connected_client_that_is_killed_continues_to_its_target(m):
    m.wait_until(lambda: m.x.state.set_velocity == 0.0, timeout=30.0)
    m.x.move_absolute(0).wait(30.0)
    done = subprocess.run([sys.executable, "-c", MOVES], timeout=120, check=False)
    assert done.returncode == -signal.SIGKILL
    m.wait_until(lambda: m.x.state.set_position == 60.0 and m.x.state.set_velocity == 0.0, timeout=30.0)
    assert m.x.state.error_id == 0
    m.x.move_absolute(0).wait(30.0)


STOPS = """
import os, signal, sys
from cnc_ptp.client import Machine, MC_Stop
with Machine.connect(timeout=30.0) as m:
    stop = MC_Stop(m.x)
    for _ in m.plc_cycles():
        stop(True)
        if stop.done:
            break
    if sys.argv[1] == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.parametrize("end", ["killed", "closed"])
def test_a_client_that_ends_while_its_mc_stop_holds_locks_no_axis_for_ever(m, end):
    """Of a client that was killed an operator's reset ends the hold; one that closes its machine lets go itself."""
    m.wait_until(lambda: m.x.state.set_velocity == 0.0, timeout=30.0)
    done = subprocess.run([sys.executable, "-c", STOPS, end], timeout=120, check=False)
    assert done.returncode == (-signal.SIGKILL if end == "killed" else 0)
    if end == "killed":
        held = "MC_Stop of a client holds the axis while its execute is true (hold_stop); nothing was changed"
        number, text, *_ = refusal(lambda: m.x.move_relative(1))
        assert (number, text) == (22165, f"axis x: move_relative refused: {held}")
        assert m.x.reset().warning == "axis x: reset ends MC_Stop of a client (hold_stop)"
    m.x.move_relative(1).wait(30.0)


def test_a_stopped_client_does_not_know_how_its_job_has_ended(m, mill):
    """SIGSTOP for longer than DDS keeps blocks: here they are left out where they come in."""
    link = m._session.link
    job = m.x.move_absolute(20)
    take, link.seen.take_block = link.seen.take_block, lambda unit, block: None
    time.sleep(3.0)
    link.seen.take_block = take
    assert refusal(lambda: job.wait(30.0))[:2] == (
        26175,
        "axis x: move_absolute has ended in blocks that this client has not got; how it has ended is not known",
    )
    assert m.x.state.set_position == 20.0
    m.x.move_absolute(0).wait(30.0)


@pytest.mark.long
def test_a_machine_that_ends_says_so_to_other_clients(ros_domain, folder):
    machine = one_axis_machine(folder)
    with Machine.start(machine, namespace="ends", composed=True) as m, Machine.connect(namespace="ends") as other:
        job = other.x.jog(10).wait(30.0)
        m.close()
        begin = time.monotonic()
        text = "the machine has ended: its run has ended; its units stand"
        assert refusal(lambda: other.run_for(60.0))[:2] == (26171, text)
        assert time.monotonic() - begin < 4.0
    assert job.status is JobStatus.ABORTED


@pytest.mark.long
def test_a_machine_that_falls_silent_is_gone(ros_domain, folder):
    with (
        Running(one_axis_machine(folder), "--composed", "--stay", "--namespace", "silent") as run,
        Machine.connect(namespace="silent", timeout=60.0) as other,
    ):
        run.process.kill()
        assert refusal(lambda: other.run_for(60.0))[:2] == (
            26171,
            "nothing new for 5 s: the machine no longer runs; what it does is not known",
        )


def test_a_unit_that_says_nothing(m, monkeypatch):
    monkeypatch.setattr("cnc_ptp.client.graph_link.PATIENCE", 5.0)
    link = GraphLink(domain=None, namespace="")
    link.observe({"plc": "plc", "ghost": "axis"}, 0.001)
    session = Session(link)
    session.run(session.until(lambda: "plc" in link.seen.blocks, 60.0, "the plc"))
    text = "nothing has come of ghost within 0.1 s; nothing was sent"
    assert refusal(lambda: link.wait_until_complete(0.1))[:2] == (26176, text)
    text = "axis ghost: jog: no answer within 5 s; the jog was ended"
    assert refusal(lambda: session.ask("ghost", "jog", {"velocity": 1.0}))[:2] == (26136, text)
    link.seen.take_block = None
    text = "the client has failed: TypeError('the first argument must be callable'); its units continue"
    assert refusal(lambda: session.run(session.until(lambda: False, 60.0, "-")))[:2] == (26171, text)
    assert refusal(lambda: session.ask("plc", "stop_all", {}))[0] == 26171
    link.close()


@pytest.mark.long
def test_a_graph_that_does_not_react_is_killed(ros_domain, folder, monkeypatch):
    monkeypatch.setattr("cnc_ptp.client.graph_link.STOP_TIME", 1.0)
    monkeypatch.setattr("cnc_ptp.client.started_graph.STOP_TIME", 1.0)
    with Machine.start(one_axis_machine(folder), namespace="stopped") as m:
        processes = family(m)
        os.kill(processes[0], signal.SIGSTOP)
    assert wait_until_gone(processes) == []


def test_a_participant_that_does_not_end_is_left_alone(ros_domain, monkeypatch):
    """A close that waits for a lock of DDS would wait for ever."""
    released, end = threading.Event(), MachineClient.end
    monkeypatch.setattr(MachineClient, "end", lambda client: released.wait(30.0) and end(client))
    monkeypatch.setattr(client_thread, "END_TIME", 0.2)
    thread = client_thread.ClientThread(domain=None, namespace="", after=lambda client: None)
    text = r"^the DDS participant of the client has not ended within 0\.2 s; it is left alone$"
    with pytest.warns(ResourceWarning, match=text):
        thread.close()
    released.set()
    thread._thread.join(30.0)
    assert not thread._thread.is_alive()


def test_the_user_may_have_ros_of_his_own(m):
    import rclpy

    rclpy.init()
    try:
        node = rclpy.create_node("of_the_user")
        assert m.x.move_relative(1).wait(30.0).done
        node.destroy_node()
    finally:
        rclpy.try_shutdown()
