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
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from multiprocessing import forkserver, get_context, parent_process
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import ModuleType

from setproctitle import setproctitle

PRELOAD = "cnc_ptp.nodes.preload"
CONTEXT = get_context("forkserver")
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
"""Without it NumPy starts threads; nodes have no use for them."""


def start_server() -> None:
    """Starts the server, unless it is there; it imports while its caller continues."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(ONE_THREAD)
    CONTEXT.set_forkserver_preload([PRELOAD])
    forkserver.ensure_running()
    for name, value in before.items():
        if value is None:
            del os.environ[name]
        else:
            os.environ[name] = value


def start_node(module: str, words: Sequence[str]) -> BaseProcess:
    """Runs the node `cnc_ptp.nodes.<module>` with a command line, in the environment and folder of the caller."""
    process = CONTEXT.Process(target=run_node, args=(module, words, {**os.environ}, os.getcwd()), name=module)
    with without_main_module():
        process.start()
    return process


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
    importlib.import_module(f"cnc_ptp.nodes.{module}").main()


def end_with_supervisor() -> None:
    """SIGTERM comes when the process that has started this one ends, however: its end of a pipe is closed then."""
    parent = parent_process()
    assert parent is not None
    fcntl.fcntl(parent.sentinel, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(parent.sentinel, fcntl.F_SETSIG, signal.SIGTERM)
    fcntl.fcntl(parent.sentinel, fcntl.F_SETFL, fcntl.fcntl(parent.sentinel, fcntl.F_GETFL) | os.O_ASYNC)
    if not parent.is_alive():  # before the signal was ordered
        sys.exit(128 + signal.SIGTERM)
