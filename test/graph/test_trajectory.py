"""Trajectories in the graph: action, topic and service, cancel, tolerances; equal to the offline run to the bit."""

from __future__ import annotations

import math
import signal
import subprocess

import numpy as np
import pytest
from client_support import connected
from graph_support import PTP, TIMEOUT, Running, command, run, states_equal, verified
from long_support import long
from scipy.interpolate import CubicHermiteSpline
from trajectory_msgs.msg import JointTrajectory
from trajectory_support import TrajectoryClient, duration, trajectory

from cnc_ptp import action, msg
from cnc_ptp.nodes.topics import TRAJECTORY_TOPIC
from cnc_ptp.protocol.axis_states import AxisStateCode

Result = action.FollowTrajectory.Result
ROWS = "[[0, [0, 0], [0, 0]], [0.6, [100, 50], [40, 0]], [1.2, [50, 60], [0, 0]]]"
SCENARIO = f"""
- {{at: 0.1, to: plc, do: follow_trajectory, axes: [x, "y"], points: {ROWS}, path_tolerance: [5, 5]}}
- {{at: 2.0, to: plc, do: follow_trajectory, axes: [c, x, z], points: [[2, [90, 0, 10], [0, 0, 0]]]}}
- {{at: 2.5, to: x, do: stop}}
"""


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    return tmp_path_factory.mktemp("trajectory") / "run.mcap"


@pytest.fixture(scope="module")
def graph(ros_domain, recording):
    with Running(PTP, "--duration", 300, "--record", recording) as graph:
        graph.wait_for_nodes(7)
        yield graph


@pytest.fixture(scope="module")
def client(graph):
    with connected(TrajectoryClient, PTP) as client:
        client.wait_blocks("x", 1)
        yield client


def test_a_goal_in_metres_and_radians_is_reached(client):
    rows = [(0.4, [0.1, -0.5], [0.2, 0.0]), (1.0, [0.12, 1.0], [0.0, 0.0])]
    handle = client.follow(["x", "c"], rows, path_tolerance=[0.01, 0.2], goal_tolerance=[1e-4, 1e-4],
                           goal_time_tolerance=duration(0.5))  # fmt: skip
    result = client.result(handle)
    assert (result.success, result.error_code, result.error_id, result.error_string) == (True, 0, 0, "")
    assert client.blocks["x"][-1].set_position[-1] == pytest.approx(120.0, abs=1e-9)
    assert client.blocks["c"][-1].set_position[-1] == pytest.approx(math.degrees(1.0), abs=1e-9)
    feedback = client.feedback[len(client.feedback) // 2]
    assert list(feedback.joint_names) == ["x", "c"] and 0.0 < feedback.desired.positions[0] < 0.13
    for wanted, actual, error in zip(
        feedback.desired.positions, feedback.actual.positions, feedback.error.positions, strict=True
    ):
        assert error == wanted - actual and abs(error) < 0.01
    spline = CubicHermiteSpline([0.0, 0.4, 1.0], [0.0, 100.0, 120.0], [0.0, 200.0, 0.0])
    block = next(block for block in client.blocks["x"] if block.first_cycle and 40.0 < block.set_position[0] < 80.0)
    start = next(b for b in client.blocks["x"] if b.job_events and b.job_events[0].status == 1).job_events[0].cycle
    at = (np.arange(block.first_cycle, block.first_cycle + block.count) - start - 10) * 0.001
    np.testing.assert_allclose(block.set_position, spline(at), atol=1e-9)


def test_a_cancel_stops_all_axes_on_their_ramps(client):
    handle = client.follow(["x", "z"], [(3.0, [0.5, 0.5], [0.0, 0.0])])
    client.wait_blocks("x", 60)
    other = client.follow(["y"], [(1.0, [0.1], [0.0])])
    assert not other.accepted  # one at a time: the active one goes on
    cancelled = handle.cancel_goal_async()
    client.spin_until(cancelled.done, "the answer to the cancel")
    result = client.result(handle)
    client.at_rest("x", "z")
    assert (result.success, result.error_code) == (False, Result.ABORTED)
    assert result.error_string == (
        "axis x: the trajectory was aborted by a stop or another command; all axes have stopped"
    )
    velocity = np.array([v for block in client.blocks["x"] for v in block.set_velocity])
    assert np.abs(np.diff(velocity)).max() <= 5000.0 * 0.001 * 1.001
    assert 0.0 < client.blocks["z"][-1].set_position[-1] < 500.0


def test_a_path_tolerance_stops_all_axes(client):
    """The lag of x is v / Kv (500 1/s): 0.3 mm at 150 mm/s."""
    now = [client.blocks[axis][-1].set_position[-1] * 1e-3 for axis in ("x", "z")]
    goal = [(2.0, [now[0] + 0.2, now[1] + 0.01], [0.0, 0.0])]
    result = client.result(client.follow(["x", "z"], goal, path_tolerance=[1e-4, 1e-2]))
    assert (result.success, result.error_code, result.error_id) == (False, Result.PATH_TOLERANCE_VIOLATED, 23065)
    assert (
        result.error_string.startswith("axis x: 0.1") and "more than the path tolerance 0.1 mm" in result.error_string
    )
    client.at_rest("z")
    client.shows("x", "state", AxisStateCode.ERROR_STOP)
    client.wait_last("x", lambda block: block.set_velocity[-1] == 0.0, "at rest")
    client.done("x", "reset")
    client.at_rest("x")


def test_a_goal_tolerance_that_is_missed_leaves_the_axis_at_a_standstill(client):
    goal = client.blocks["z"][-1].set_position[-1] + 20.0
    rows = [(0.2, [goal * 1e-3], [0.0])]
    result = client.result(client.follow(["z"], rows, goal_tolerance=[1e-9]))
    assert (result.success, result.error_code, result.error_id) == (False, Result.GOAL_TOLERANCE_VIOLATED, 23066)
    assert "0 s after its end, more than the goal tolerance 1e-06 mm" in result.error_string
    client.at_rest("z")


def test_refused_goals_move_nothing(client):
    before = {axis: client.blocks[axis][-1].set_position[-1] for axis in ("x", "y")}
    result = client.result(client.follow(["x", "q"], [(1.0, [0.0, 0.0], [0.0, 0.0])]))
    assert (result.error_code, result.error_id) == (Result.INVALID_JOINTS, 23064)
    assert result.error_string == (
        "plc plc: follow_trajectory refused: there is no axis 'q'; known are: x, y, z, c; nothing was changed"
    )
    result = client.result(client.follow(["x", "y"], [(1.0, [0.0], [0.0, 0.0])]))
    assert (result.error_code, result.error_id) == (Result.INVALID_GOAL, 23064)
    start = before["y"] * 1e-3
    result = client.result(client.follow(["x", "y"], [(0.1, [before["x"] * 1e-3, start + 10.0], [0.0, 0.0])]))
    assert (result.error_code, result.error_id) == (Result.INVALID_GOAL, 23004)
    assert result.error_string == (
        "axis y: begin_trajectory refused: velocity 150000 mm/s at 0.05 s is above the maximum 10000.0 mm/s "
        "(P-AXIS-00212); nothing was changed"
    )
    client.at_rest("x", "y")
    assert {axis: client.blocks[axis][-1].set_position[-1] for axis in ("x", "y")} == before


def test_a_trajectory_on_the_topic(client):
    start = client.blocks["y"][-1].set_position[-1]
    writer = client.create_publisher(JointTrajectory, TRAJECTORY_TOPIC, 10)
    client.spin_until(writer.get_subscription_count, "the reader")
    writer.publish(trajectory(["y"], [(0.3, [start * 1e-3 + 0.02], [0.0])]))
    client.wait_last("y", lambda block: abs(block.set_position[-1] - start - 20.0) < 1e-9, "at the target")
    client.at_rest("y")


def test_the_service_takes_mm(client):
    start = client.blocks["y"][-1].set_position[-1]
    points = [msg.TrajectoryPoint(time=0.3, positions=[start - 5.0], velocities=[0.0])]
    client.done("plc", "follow_trajectory", axes=["y"], points=points, goal_tolerance=[0.1], goal_time=0.5)
    client.wait_last("y", lambda block: block.set_position[-1] == start - 5.0, "at the target")
    client.at_rest("y")
    client.refused(
        "plc",
        "follow_trajectory",
        23064,
        "plc plc: follow_trajectory refused: axes is empty; known are: x, y, z, c; nothing was changed",
    )


def test_the_command_line_takes_rows(client):
    start = [client.blocks[axis][-1].set_position[-1] for axis in ("x", "y")]
    points = [[0.5, [start[0] + 3.0, start[1] - 2.0], [0, 0]]]
    done = subprocess.run(
        command("do", "plc", "follow_trajectory", "axes=[x, y]", f"points={points}", "path_tolerance=[5e0, 5]"),
        capture_output=True, text=True, timeout=TIMEOUT, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    client.wait_last("y", lambda block: abs(block.set_position[-1] - start[1] + 2.0) < 1e-9, "at the target")
    client.at_rest("x", "y")
    assert client.blocks["x"][-1].set_position[-1] == pytest.approx(start[0] + 3.0, abs=1e-9)


def test_the_recording_is_computed_again(graph, client, recording):
    client.wait_blocks("plc", 10)
    graph.process.send_signal(signal.SIGINT)
    graph.finish(expect=1)
    verified(recording)


@pytest.mark.parametrize("options", [[], *long([["--composed"]])], ids=str)
def test_the_graph_equals_the_offline_run(tmp_path, options):
    scenario = tmp_path / "s.yaml"
    scenario.write_text(SCENARIO)
    offline, graph = tmp_path / "offline.mcap", tmp_path / "graph.mcap"
    run("simulate", PTP, "--scenario", scenario, "--record", offline)
    run("run", PTP, "--scenario", scenario, *options, "--record", graph)
    assert states_equal(offline, graph) == []
    verified(graph)
