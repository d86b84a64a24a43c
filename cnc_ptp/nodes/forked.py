"""Processes of nodes, forked from a server that has imported what they need.

The server (start method forkserver of multiprocessing) is a program of its own: it has neither the ROS context nor the
signal handlers, threads and locks of the process that runs the graph, so that no node can inherit them.
"""

from __future__ import annotations

import fcntl
import importlib
import os
import signal
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import forkserver, get_context, parent_process
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import ModuleType

from setproctitle import setproctitle

from cnc_ptp.errors import CncError
from cnc_ptp.one_thread import ONE_THREAD

PRELOAD = "cnc_ptp.nodes.preload"
CONTEXT = get_context("forkserver")
NODE_DIED = 26104
SERVER_ENDED = "the process that nodes are forked from has ended"
UNKNOWN = 255
"""Exit status of every process when the server has ended."""


def start_server() -> None:
    """Starts the server, unless it is there; it imports while its caller continues.

    It ignores SIGINT from its first instruction on: Ctrl-C is for the caller, which ends its nodes in order.
    """
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(ONE_THREAD)
    CONTEXT.set_forkserver_preload([PRELOAD])
    handler = signal.signal(signal.SIGINT, signal.SIG_IGN)
    forkserver.ensure_running()
    signal.signal(signal.SIGINT, handler)
    for name, value in before.items():
        if value is None:
            del os.environ[name]
        else:
            os.environ[name] = value


def start_node(module: str, words: Sequence[str]) -> BaseProcess:
    """Runs the node `cnc_ptp.nodes.<module>` with a command line, in the environment and folder of the caller.

    Raises CncError 26104 when the server has ended.
    """
    process = CONTEXT.Process(target=run_node, args=(module, words, {**os.environ}, os.getcwd()), name=module)
    with without_main_module():
        try:
            process.start()
        except (EOFError, ConnectionError):
            raise CncError(NODE_DIED, f"{SERVER_ENDED} while nodes were started", "nothing has moved yet") from None
    return process


def is_alive(process: BaseProcess) -> bool:
    """True while a node's process runs, also without the server, which alone learns how a process has ended."""
    return process.exitcode is None or server_is_gone(process)


def server_is_gone(process: BaseProcess) -> bool:
    """The server has ended and left this process behind."""
    if process.exitcode != UNKNOWN:
        return False
    try:
        state = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def end(process: BaseProcess, number: signal.Signals) -> None:
    """Sends a signal to a node's process if it still runs."""
    if process.pid is not None and is_alive(process):
        with suppress(ProcessLookupError):
            os.kill(process.pid, number)


def wait_for(process: BaseProcess, deadline: float) -> None:
    """Returns when it has ended, or at `deadline` of the monotonic clock."""
    process.join(max(0.0, deadline - time.monotonic()))
    while server_is_gone(process) and time.monotonic() < deadline:
        time.sleep(0.01)


@contextmanager
def without_main_module() -> Iterator[None]:
    """multiprocessing would execute the main module of a program again in each process; nodes do not need it."""
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


def run_node(module: str, words: Sequence[str], environment: Mapping[str, str], folder: str) -> None:
    """In the new process: what `python -m cnc_ptp.nodes.<module> WORDS` does."""
    os.setsid()
    end_with_supervisor()
    setproctitle(" ".join([Path(sys.executable).name, "-m", f"cnc_ptp.nodes.{module}", *words]))
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = [module, *words]
    importlib.import_module(PRELOAD)  # multiprocessing does not tell when the server could not import it
    importlib.import_module(f"cnc_ptp.nodes.{module}").main()


def end_with_supervisor() -> None:
    """SIGTERM comes when the process that has started this one ends, however: its end of a pipe is closed then."""
    parent = parent_process()
    assert parent is not None
    end_with(parent.sentinel)
    if not parent.is_alive():  # before the signal was ordered
        sys.exit(128 + signal.SIGTERM)


def end_with(pipe: int) -> None:
    """SIGTERM comes when something can be read from a pipe, or its other end is closed."""
    fcntl.fcntl(pipe, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(pipe, fcntl.F_SETSIG, signal.SIGTERM)
    fcntl.fcntl(pipe, fcntl.F_SETFL, fcntl.fcntl(pipe, fcntl.F_GETFL) | os.O_ASYNC)
