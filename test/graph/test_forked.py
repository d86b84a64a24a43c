"""Node processes: forked from a server that has started nothing, with the environment of their supervisor."""

import subprocess
import sys

from graph_support import TIMEOUT

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
WITHOUT_SERVER = """
import os, signal
from multiprocessing.forkserver import _forkserver
from cnc_ptp.errors import CncError
from cnc_ptp.nodes.forked import start_node, start_server
start_server()
os.kill(_forkserver._forkserver_pid, signal.SIGINT)  # ignored, also while it imports
start_node("clock", ["nowhere.yaml"]).join()
os.kill(_forkserver._forkserver_pid, signal.SIGKILL)
os.waitid(os.P_PID, _forkserver._forkserver_pid, os.WEXITED | os.WNOWAIT)
_forkserver.ensure_running = lambda: None  # it has looked for the server a moment before
try:
    start_node("clock", ["nowhere.yaml"])
except CncError as error:
    print(error)
"""


def test_a_node_that_cannot_be_started_because_the_server_is_gone():
    done = subprocess.run([sys.executable, "-c", WITHOUT_SERVER], capture_output=True, text=True, timeout=TIMEOUT)
    text = (
        "P-ERR-26104 the process that nodes are forked from has ended while nodes were started; nothing has moved yet"
    )
    assert done.stdout == f"{text}\n"
    assert "Traceback" not in done.stderr and "nowhere.yaml:1:1: machine file cannot be read" in done.stderr


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


REFUSED = """
import threading
from cnc_ptp.nodes import preload, process
def said():
    try:
        preload.require_nothing_started()
    except RuntimeError as error:
        print(error)
said()
waiting = threading.Event()
thread = threading.Thread(target=waiting.wait)
thread.start()
said()
waiting.set()
thread.join()
process.initialise()
said()
"""


def test_nothing_is_forked_from_a_process_with_threads_or_ros():
    done = subprocess.run([sys.executable, "-c", REFUSED], capture_output=True, text=True, timeout=TIMEOUT, check=True)
    ends = "in the process that node processes are to be forked from"
    assert done.stdout.splitlines() == [f"a thread runs {ends}", f"ROS has been started {ends}"]
