"""Trajectories in the graph that end in the middle: what the action says, and the axes at rest."""

import signal

import numpy as np
import pytest
from client_support import connected
from graph_support import PTP, Running, kill, verified
from long_support import long_but
from trajectory_support import TrajectoryClient

from cnc_ptp import action

Result = action.FollowTrajectory.Result

ENDS = {
    "axis lost": (26101, "axis y: its node is lost; the other axes stop on their ramps"),
    "another command": (0, "axis y: the trajectory was aborted by a stop or another command; all axes have stopped"),
    "without power": (0, "axis y: the trajectory was aborted by a stop or another command; all axes have stopped"),
    "emergency stop": (26168, "axis x: emergency stop; the axis stops on its emergency ramp (ErrorStop)"),
    "end of the run": (0, "axis x: the trajectory was aborted by a stop or another command; all axes have stopped"),
}


@pytest.mark.parametrize("end", long_but(ENDS, ["axis lost", "emergency stop"]))
def test_a_trajectory_that_ends_in_the_middle(ros_domain, tmp_path, end):
    """Number and text of the result; the axes that are still there come to rest on their ramps."""
    with Running(PTP, "--duration", 300, "--record", tmp_path / "run.mcap") as graph:
        nodes = dict(graph.wait_for_nodes(7))
        with connected(TrajectoryClient, PTP) as client:
            client.wait_blocks("x", 1)
            handle = client.follow(["x", "y"], [(20.0, [1.0, 1.0], [0.0, 0.0])])
            client.wait_last("y", lambda block: block.set_velocity[-1] > 10.0, "in motion")
            interrupt(end, graph, nodes, client)
            result = client.result(handle)
            assert (result.success, result.error_code) == (False, Result.ABORTED)
            assert (result.error_id, result.error_string) == ENDS[end]
            client.wait_last("x", lambda block: block.set_velocity[-1] == 0.0, "at rest")
            if end not in ("axis lost", "end of the run"):
                graph.process.send_signal(signal.SIGINT)
        graph.finish(expect=1)
    velocity = verified(tmp_path / "run.mcap", whole=False).states["/x/state"]["set_velocity"]
    assert velocity.max() > 10.0 and velocity[-1] == 0.0 and np.abs(np.diff(velocity)).max() <= 20.0 * 1.001


def interrupt(end, graph, nodes, client):
    if end == "axis lost":
        kill(nodes["y"])
    elif end == "another command":
        client.done("y", "stop")
    elif end == "without power":
        client.done("y", "power", enabled=False)
    elif end == "emergency stop":
        client.done("plc", "emergency_stop", enabled=True)
    else:
        graph.process.send_signal(signal.SIGINT)
