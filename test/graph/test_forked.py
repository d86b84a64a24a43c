"""Node processes: forked from a server that has started nothing, with the environment of their supervisor."""

import subprocess
import sys
import threading

import pytest
import rclpy
from graph_support import TIMEOUT

from cnc_ptp.nodes import process

SCRIPT = """
import os
print("script", flush=True)
from cnc_ptp.nodes.forked import start_node, start_server
start_server()
os.environ["OF_THE_RUN"] = "1"
os.chdir({folder!r})
node = start_node("clock", ["nowhere.yaml"])
node.join()
print(node.exitcode, "OPENBLAS_NUM_THREADS" in os.environ)
"""


def test_a_script_without_a_main_guard_starts_nodes(tmp_path):
    """It is not executed again in the node's process; the node works in the present folder."""
    script = tmp_path / "script.py"
    script.write_text(SCRIPT.format(folder=str(tmp_path)))
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=TIMEOUT, check=True)
    assert done.stdout.splitlines() == ["script", "2 False"]
    assert "nowhere.yaml:1:1: machine file cannot be read" in done.stderr and done.stderr.count("P-ERR-") == 1


def test_the_server_has_started_nothing():
    code = "import cnc_ptp.nodes.preload, gc, threading, rclpy; print(threading.active_count(), rclpy.ok(), gc.get_freeze_count() > 0)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=TIMEOUT, check=True)
    assert done.stdout.split() == ["1", "False", "True"]


def test_nothing_is_forked_from_a_process_with_threads_or_ros():
    from cnc_ptp.nodes.preload import require_nothing_started

    waiting = threading.Event()
    thread = threading.Thread(target=waiting.wait)
    thread.start()
    with pytest.raises(RuntimeError) as refused:
        require_nothing_started()
    waiting.set()
    thread.join()
    assert str(refused.value) == "a thread runs in the process that node processes are to be forked from"
    process.initialise()
    try:
        with pytest.raises(RuntimeError) as refused:
            require_nothing_started()
    finally:
        rclpy.try_shutdown()
    assert str(refused.value) == "ROS has been started in the process that node processes are to be forked from"
