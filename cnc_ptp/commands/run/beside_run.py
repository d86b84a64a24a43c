"""The web face of a run: a process beside its graph, which ends with it."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
from types import TracebackType

from cnc_ptp.protocol.notes import Note
from cnc_ptp.ros_arguments import ros_arguments
from cnc_ptp.web.options import WebOptions, be_nice, listen, require_packages

PAGES_ENDED = 26211
END_TIME = 8.0
"""Seconds that it may take to end."""


class WebBesideRun:
    """Has its port from the beginning, and serves as soon as the machine runs; nothing without options."""

    def __init__(self, options: WebOptions | None, listening: socket.socket | None = None) -> None:
        """`listening`: a socket that has the port already. Raises CncError 26230, 26231, 26232, 26246, 26247."""
        self._options = options
        self._socket = listening
        self._process: subprocess.Popen[bytes] | None = None
        if options is not None and listening is None:
            self._socket = listen_for_pages(options)

    def begin(self) -> None:
        """The clock ticks: its process starts, and prints the address."""
        if self._options is None or self._socket is None or self._process is not None:
            return
        number = self._socket.fileno()
        words = [*self._options.words, "--listening", str(number), *ros_arguments().words]
        self._process = subprocess.Popen(
            [sys.executable, "-m", "cnc_ptp", "web", *words],
            pass_fds=[number],
            stdin=subprocess.PIPE,  # closed when this process ends, however: then it ends too
            start_new_session=True,  # Ctrl-C is for the run, which ends it in order
            preexec_fn=be_nice,
        )
        self._socket.close()
        self._socket = None

    @property
    def notes(self) -> list[Note]:
        """That its process has ended on its own."""
        status = None if self._process is None else self._process.poll()
        if status is None:
            return []
        text = f"web: the process of the pages has ended (status {status})"
        return [Note(PAGES_ENDED, f"{text}; the machine continues, `cnc_ptp web` serves pages of it again")]

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


def listen_for_pages(options: WebOptions) -> socket.socket:
    """The socket of the pages; what is wrong with them is reported before anything is started.

    Raises CncError 26230, 26231, 26232 (not secured), 26246 (users), 26247 (certificate).
    """
    require_packages()
    from cnc_ptp.web.access.security import require_secured, tls_context
    from cnc_ptp.web.access.users import Users

    require_secured(options, "--web-")
    tls_context(options.certificate, options.key)
    if options.users is not None:
        Users(options.users)
    return listen(options.host, options.port)
