"""Slaves in processes of their own: cascades without delay, coupling by service, factors by topic, dead masters."""

import time
from copy import deepcopy

import numpy as np
import pytest
import yaml
from client_support import beside_composed_run
from graph_support import PTP, Running, kill, run, verified, wait_until_gone
from long_support import long_sets

from cnc_ptp import msg, srv
from cnc_ptp.parameters import read_machine

MOVE = "target: {}, velocity: 500, acceleration: 5000, deceleration: 5000, jerk: 50000"
CASCADE = f"""
- {{at: 0.0, to: "y", do: couple, master: x, factor: 0.5}}
- {{at: 0.0, to: z, do: couple, master: "y", factor: -2.0}}
- {{at: 0.0, to: x, do: move_absolute, {MOVE.format(50_000)}}}
"""
UNDER_WAY = 100_000  # bytes of recording: about a second


def machine_of(folder, count):
    """`count` linear axes a0, a1, … like x of config/ptp.yaml, the last one first in the file."""
    ptp = yaml.load(PTP.read_text(), yaml.BaseLoader)
    names = [f"a{number}" for number in range(count)]
    machine = ptp["/machine"]["ros__parameters"] | {"axes": names[::-1]}
    axes = {}
    for number, name in enumerate(names, 1):
        axes[f"/{name}"] = {
            "ros__parameters": deepcopy(ptp["/x"]["ros__parameters"]) | {"kopf": {"achs_nr": str(number)}}
        }
    path = folder / f"{count}.yaml"
    path.write_text(yaml.dump({"/machine": {"ros__parameters": machine}, **axes}).replace("'", ""))
    return path


def test_a_cascade_of_eight_processes_has_no_cycle_of_delay(tmp_path):
    lines = [f"- {{at: 0, to: a{n}, do: couple, master: a{n - 1}, factor: {1.0 + 0.1 * n}}}" for n in range(7, 0, -1)]
    lines.append(f"- {{at: 0, to: a0, do: move_absolute, {MOVE.format(500)}}}")
    scenario = tmp_path / "cascade.yaml"
    scenario.write_text("\n".join(lines))
    output = run("run", machine_of(tmp_path, 8), "--scenario", scenario, "--record", tmp_path / "run.mcap").stdout
    assert "lost 0, computed twice 0" in output
    states = verified(tmp_path / "run.mcap").states
    ratio = 1.0
    for n in range(1, 8):
        ratio *= 1.0 + 0.1 * n
        difference = states[f"/a{n}/state"]["set_position"] - ratio * states["/a0/state"]["set_position"]
        assert np.abs(difference).max() <= 1e-9 * ratio * 500.0
    assert states["/a0/state"]["set_position"][-1] == 500.0


@pytest.mark.parametrize(("dead", "first"), [("x", "y"), *long_sets([("y", "z")])])
def test_a_dead_master_stops_its_slaves(tmp_path, dead, first):
    """The next slave misses its master's blocks, stops on its own ramp with an error, and all others follow."""
    scenario, recording = tmp_path / "cascade.yaml", tmp_path / "run.mcap"
    scenario.write_text(CASCADE)
    with Running(PTP, "--scenario", scenario, "--record", recording) as graph:
        nodes = dict(graph.wait_for_nodes(7))
        graph.wait_until_recorded(recording, UNDER_WAY)
        kill(nodes[dead])
        output = graph.finish(expect=1)
    assert wait_until_gone(nodes.values()) == []
    assert f"axis {first}: no block of '{dead}' came within the watchdog time" in output
    assert f"P-ERR-26104 node '{dead}'" in output and "P-ERR-26265 " in output
    recorded = verified(recording, whole=False)
    (stop,) = recorded.drive_stops
    ramp = np.abs(np.diff(stop.actual_velocity)).max() / 1e-3
    assert stop.unit == dead and stop.actual_velocity[-1] == 0.0
    assert ramp <= read_machine(str(PTP)).axes[dead].deceleration * (1.0 + 1e-6), "as its group"
    for axis in {"x", "y", "z"} - {dead}:
        rows = recorded.states[f"/{axis}/state"]
        assert rows["set_velocity"][-1] == 0.0 and np.abs(rows["set_velocity"]).max() > 100.0
        bends = np.abs(np.diff(rows["set_acceleration"])) / 1e-3
        assert bends.max() <= 50_000.0 * 2.0 * (1.0 + 1e-6)


@pytest.fixture(scope="module")
def client():
    with beside_composed_run(PTP) as node:
        yield node


def couple(client, axis, kind="couple", service=srv.Couple, **fields):
    return client.ask(service, f"/{axis}/{kind}", **fields)


def test_coupling_by_service(client):
    """The PLC node answers with what the axis said; the axis' own services do the rest."""
    answer = couple(client, "y", master="x", factor=0.5)
    assert answer.accepted and answer.message == ""
    client.shows("y", "state", 5)
    refused = couple(client, "x", master="y", factor=2.0)
    assert (refused.accepted, refused.error_id) == (False, 23046)
    assert refused.message == "axis x: couple refused: y is a slave of the axis already (y -> x); nothing was changed"
    client.done("x", "move_absolute", target=100.0, velocity=200.0)
    client.shows("x", "set_position", 100.0)
    client.shows("y", "set_position", 50.0)
    client.done("y", "set_coupling_factor", factor=-1.0)
    client.done("x", "move_absolute", target=0.0, velocity=200.0)
    client.shows("y", "set_position", 150.0)
    client.done("y", "decouple", target=float("nan"), velocity=float("nan"))
    client.shows("y", "state", 1)
    client.done("y", "move_absolute", target=0.0, velocity=500.0)
    client.shows("y", "set_position", 0.0)


def test_a_cam_from_a_file(client, tmp_path):
    table = tmp_path / "cam.csv"
    table.write_text("master,slave\n0,0\n50,10\n100,0\n")
    nan = float("nan")
    scaling = {"master_scaling": nan, "slave_scaling": nan, "slave_offset": nan}
    file = {"file": str(table), "cyclic": True}
    answer = couple(client, "z", "couple_cam", srv.CoupleCam, master="x", **file, **scaling)
    assert answer.accepted, answer.message
    client.done("x", "move_absolute", target=50.0, velocity=200.0)
    client.shows("z", "set_position", 10.0)
    client.done("x", "move_absolute", target=0.0, velocity=200.0)
    client.shows("z", "set_position", 0.0)
    client.done("z", "decouple", target=nan, velocity=nan)
    missing = couple(client, "z", "couple_cam", srv.CoupleCam, master="x", file="/no/cam.csv", **scaling)
    text = "cam file /no/cam.csv cannot be read: No such file or directory; nothing was started"
    assert (missing.accepted, missing.error_id, missing.message) == (False, 26110, text)


def test_a_factor_by_topic_that_falls_silent_freezes(client):
    answer = couple(client, "c", "couple_cyclic", srv.CoupleCyclic, master="x", acc_bound=20_000.0)
    assert answer.accepted, answer.message
    for _ in range(20):  # as a PLC does: what comes before c has reported that it is coupled does not count
        client.write("/c/coupling_factor", msg.CyclicCouplingFactor, valid=True, factor=0.5)
        if client.commands("c", "set_cyclic_factor"):
            break
    client.done("x", "move_absolute", target=100.0, velocity=200.0)
    client.shows("x", "set_position", 100.0)
    client.wait_last("c", lambda block: abs(block.set_position[-1] - 50.0) < 1e-6, "half the way")
    client.write("/c/coupling_factor", msg.CyclicCouplingFactor, valid=True, factor=float("nan"))
    client.spin_until(lambda: any(event.error_id == 26118 for event in client.events), "the event")
    texts = [event.text for event in client.events if event.error_id == 26118]
    assert texts == ["plc: no message on /c/coupling_factor for 1000 ms; the factor is unchanged"]
    client.done("x", "move_absolute", target=0.0, velocity=200.0)
    client.shows("x", "set_position", 0.0)
    client.wait_last("c", lambda block: abs(block.set_position[-1]) < 1e-6, "the return with the same factor")
    client.done("c", "decouple", target=float("nan"), velocity=float("nan"))


def test_a_slave_decoupled_while_it_waits_is_free_at_once(client):
    """Coupling, motion and decoupling in quick succession: no deadlock between gate and service."""
    for _ in range(5):
        assert couple(client, "y", master="x", factor=1.0).accepted
        client.done("x", "move_relative", distance=1.0, velocity=500.0)
        client.done("y", "decouple", target=float("nan"), velocity=float("nan"))
        client.call("y", "stop")
        client.wait_last("y", lambda block: block.state[-1] == 1, "Standstill")
        client.wait_last("x", lambda block: block.state[-1] == 1, "Standstill")
    time.sleep(0.1)
    assert not [event for event in client.events if event.severity == 2]
