"""A standing machine of separate processes (run --stay): how it ends."""

import re
import signal
import subprocess
import sys
import time

import pytest
from graph_support import Running, one_axis_machine, small_machine, verified
from live_support import call, wait_for_machine


@pytest.mark.parametrize("moving", [False, True])
def test_a_machine_of_processes_stays_until_it_is_told_to_end(moving, tmp_path):
    with Running(one_axis_machine(tmp_path), "--stay") as graph:
        wait_for_machine()
        if moving:
            assert call("do", "x", "move_absolute", "target=250", "velocity=20").exit_code == 0
        time.sleep(2.0)  # the supervisor has seen all units, too
        graph.process.send_signal(signal.SIGTERM)
        output = graph.finish(1 if moving else 0)
    assert ("the machine was ended (SIGTERM) with all units at a standstill" in output) is not moving
    told = "failed: P-ERR-26106 the run was interrupted (SIGTERM); everything stops on its ramps"
    assert (told in output) is moving
    assert "program time" not in output


def test_a_turning_spindle_comes_to_rest_on_its_ramp_before_its_node_ends(tmp_path):
    """12,000 rpm need more time than axes that stand."""
    path = tmp_path / "turning.mcap"
    with Running(small_machine(tmp_path), "--stay", "--record", path) as graph:
        wait_for_machine()
        assert call("do", "s", "start", "direction=cw", "speed_rpm=12000", "--wait").exit_code == 0
        graph.process.send_signal(signal.SIGINT)
        graph.finish(1)
    speed = verified(path, whole=False).states["/s/state"]["set_speed_rpm"]
    assert max(abs(speed)) > 10_000.0 and speed[-1] == 0.0


@pytest.mark.long
def test_commands_notice_that_the_machine_is_gone(tmp_path):
    """Killed as a power failure does it: `do --wait`, `jog` and `watch` end, each with status 1."""
    text = "nothing new for 5 s: the machine no longer runs"
    waiting = ["do", "x", "move_absolute", "target=100", "velocity=1", "--wait"]
    with Running(small_machine(tmp_path), "--stay", "--composed") as graph:
        wait_for_machine()
        clients = []
        for words, seen in (
            (waiting, r"x +DiscreteMotion"),
            (["jog", "y", "+", "--speed", "1", "--distance", "80"], r"y +ContinuousMotion"),
            (["watch", "x", "--rate", "0.1"], ""),
        ):
            job = [sys.executable, "-m", "cnc_ptp", *words]
            clients.append(subprocess.Popen(job, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True))
            while not re.search(seen, call("status").stdout):
                assert clients[-1].poll() is None
        assert clients[-1].stdout.readline()
        graph.process.kill()
        errors = [client.communicate(timeout=60.0)[1] for client in clients]
    assert [client.returncode for client in clients] == [1] * 3
    assert errors[0] == f"x: {text}\n" and errors[1].endswith(f"y: {text}\n") and errors[2] == f"{text}\n"
