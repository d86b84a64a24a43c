"""The web face of a run: a process beside its graph, which ends with it."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from pathlib import Path
from types import TracebackType
from typing import NamedTuple

from cnc_ptp.ros_arguments import ros_arguments
from cnc_ptp.web.options import HOST, listen, require_packages

NICENESS = 10
"""While it starts beside a graph that has just begun."""
END_TIME = 8.0
"""Seconds that it may take to end."""


class RunFiles(NamedTuple):
    """What its pages know of the run."""

    machine: str
    program: str | None = None
    users: str | None = None


class WebBesideRun:
    """Has its port from the beginning, and serves as soon as the machine runs; nothing without a port."""

    def __init__(self, port: int | None, files: RunFiles, listening: socket.socket | None = None) -> None:
        """`listening`: a socket that has the port already. Raises CncError 26230, 26231, 26246."""
        self._port, self._files = port, files
        self._socket = listening
        self._process: subprocess.Popen[bytes] | None = None
        if port is not None:
            self._socket = listening or listen_for_pages(port)
            if files.users is not None:
                from cnc_ptp.web.access.users import Users

                Users(files.users)  # what is wrong with it is reported before anything is started

    def begin(self) -> None:
        """The clock ticks: its process starts, and prints the address."""
        if self._socket is None or self._process is not None:
            return
        folder = str(Path(self._files.program).parent) if self._files.program else "."
        options = ["--port", str(self._port), "--programs", folder, "--machine", self._files.machine]
        options += [] if self._files.users is None else ["--users", self._files.users]
        number = self._socket.fileno()
        self._process = subprocess.Popen(
            [sys.executable, "-m", "cnc_ptp", "web", *options, "--listening", str(number), *ros_arguments().words],
            pass_fds=[number],
            stdin=subprocess.PIPE,  # closed when this process ends, however: then it ends too
            start_new_session=True,  # Ctrl-C is for the run, which ends it in order
            preexec_fn=be_nice,
        )
        self._socket.close()
        self._socket = None

    def __enter__(self) -> WebBesideRun:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._socket is not None:
            self._socket.close()
        if self._process is not None and self._process.poll() is None:
            self._process.send_signal(signal.SIGTERM)
            try:
                self._process.wait(END_TIME)
            except subprocess.TimeoutExpired:
                self._process.kill()


def listen_for_pages(port: int) -> socket.socket:
    """The socket of the pages. Raises CncError 26230, 26231."""
    require_packages()
    return listen(HOST, port)


def be_nice() -> None:
    os.nice(NICENESS)
