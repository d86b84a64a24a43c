"""The graph that a client has started: a process of its own, which ends on its ramps when the client ends."""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from typing import Any

from cnc_ptp.client.faults import NOT_STARTED
from cnc_ptp.errors import CncError

STOP_TIME = 30.0
"""Seconds for all ramps and the end of all nodes."""
TERMINATE_TIME = 5.0
LOG_LINES = 5


class StartedGraph:
    """The process of the graph. It gets SIGTERM when this process ends, however: its end of a pipe is closed then."""

    def __init__(self, options: Mapping[str, Any], *, domain: int | None, namespace: str) -> None:
        """`options`: of RunOptions, and `composed`."""
        self._machine = options["machine"]
        self._log = tempfile.TemporaryFile()  # noqa: SIM115  # open as long as the process
        self._reports, reporting = os.pipe()
        environment = dict(os.environ)
        if domain is not None:
            environment["ROS_DOMAIN_ID"] = str(domain)
        words = [str(reporting), json.dumps(options), *(["--namespace", namespace] if namespace else [])]
        self._process = subprocess.Popen(
            [sys.executable, "-m", "cnc_ptp.client.graph_process", *words],
            stdin=subprocess.PIPE,
            stdout=self._log,
            stderr=self._log,
            pass_fds=[reporting],
            env=environment,
            start_new_session=True,  # Ctrl-C is for the client, which ends it in order
        )
        os.close(reporting)
        self._text = b""
        self._is_open = True
        self.is_running = False
        """The clock ticks."""
        self.failures: list[str] = []
        """What went wrong with its processes, after its end."""

    def wait_until_running(self, timeout: float) -> None:
        """Raises CncError 26176, or that of the start."""
        deadline = time.monotonic() + timeout
        while not self.is_running:
            self._read(deadline - time.monotonic())
            if not self._is_open:
                raise self._not_started(f"its process has ended ({self._process.wait()})")
            if time.monotonic() > deadline:
                raise self._not_started(f"it was not running within {timeout:g} s")

    @property
    def has_ended(self) -> bool:
        self._read(0.0)
        return self._process.poll() is not None

    def wait(self, timeout: float) -> bool:
        """True when the process has ended."""
        try:
            self._process.wait(max(0.0, timeout))
        except subprocess.TimeoutExpired:
            return False
        return True

    def end(self) -> None:
        """Everything stops on its ramps, as far as that has not been done; no process is left."""
        if not self.has_ended:
            self._process.terminate()
            if not self.wait(STOP_TIME):
                self._process.kill()  # its nodes get SIGTERM then
                self.wait(TERMINATE_TIME)
        self._read(0.0)
        for file in (self._process.stdin, self._log):
            if file is not None:
                file.close()
        if self._reports >= 0:
            os.close(self._reports)
            self._reports = -1

    def _read(self, timeout: float) -> None:
        """Takes the reports that have come, or come in this time."""
        while self._is_open and select.select([self._reports], [], [], max(0.0, timeout))[0]:
            data = os.read(self._reports, 1 << 16)
            self._is_open = bool(data)
            *lines, self._text = (self._text + data).split(b"\n")
            for line in lines:
                self._take(json.loads(line))
            timeout = 0.0

    def _take(self, report: dict[str, Any]) -> None:
        self.is_running = self.is_running or "running" in report
        self.failures += report.get("failures", [])
        if refused := report.get("refused"):
            number, reason, effect, where, values = refused
            raise CncError(number, reason, effect, where=where, **values)

    def _not_started(self, reason: str) -> CncError:
        text = "; ".join([reason, *self.failures, *self._last_words()])
        return CncError(NOT_STARTED, f"the graph of {self._machine} did not start: {text}", "nothing has moved")

    def _last_words(self) -> list[str]:
        """The last lines that it has written."""
        self._log.seek(0)
        return self._log.read().decode(errors="replace").splitlines()[-LOG_LINES:]
