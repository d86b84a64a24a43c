"""A graph of processes as a user starts it, seen from outside: who its processes are, and what is left of them."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import psutil

SUPERVISOR, SERVER = "supervisor", "server of processes"
OBSERVERS = ("plc_bridge", "clock", "recorder")
START_PATIENCE = 120.0
"""Seconds to the first cycle: a start may be tried three times."""
POLL = 0.01
CLAIM = "cnc_ptp/domain/"


class Graph:
    """A run with a recording, from its start to the end of its last process."""

    def __init__(self, words: Sequence[str], recording: Path, *, domain: int) -> None:
        self.recording = recording
        self._log = recording.with_suffix(".log")
        self._shared = shared_memory()
        self.domain = domain
        environment = os.environ | {"ROS_DOMAIN_ID": str(domain)}
        command = [sys.executable, "-m", "cnc_ptp", "run", *words, "--record", str(recording)]
        recording.unlink(missing_ok=True)  # of an earlier run with the same folder: its file is the sign of the start
        with self._log.open("w") as log:
            self.process = subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL, env=environment)
        self.processes: dict[str, psutil.Process] = {}

    def wait_for_start(self) -> bool:
        """True when the recording has begun, with the first cycle, and every process is known by its name.

        A file without contents is only the question whether it can be written.
        """
        deadline = time.monotonic() + START_PATIENCE
        while time.monotonic() < deadline and self.running:
            if size_of(self.recording):
                self.processes = processes_of(psutil.Process(self.process.pid))
                return True
            time.sleep(POLL)
        return False

    @property
    def running(self) -> bool:
        return self.process.poll() is None

    @property
    def output(self) -> str:
        return self._log.read_text(errors="replace")

    @property
    def summed_up(self) -> bool:
        """It has said how it went, and that nothing has failed."""
        return "machine time" in self.output and "failed:" not in self.output

    @property
    def lateness(self) -> float:
        """Seconds by which the machine was behind the clock at most, as the run has told."""
        told = re.search(r"block lateness .* largest ([0-9.]+) ms", self.output)
        return float(told[1]) / 1000.0 if told else 0.0

    def wait(self, seconds: float) -> bool:
        """True when it has ended within so many seconds."""
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def interrupt(self) -> None:
        """Ctrl-C: everything stops on its ramps."""
        if self.running:
            self.process.send_signal(signal.SIGINT)

    def orphans(self, patience: float = 10.0) -> list[str]:
        """Processes of the run that have outlived it; they are ended."""
        family = [each for name, each in self.processes.items() if name != SUPERVISOR]
        _, alive = psutil.wait_procs(family, timeout=patience)
        alive = [each for each in alive if each.status() != psutil.STATUS_ZOMBIE]
        names = [name for name, each in self.processes.items() if each in alive]
        for each in alive:
            each.kill()
        return names

    def leftovers(self, patience: float = 5.0) -> list[str]:
        """Shared memory that nobody uses and claims that the run has not taken away, some seconds after its end.

        Another program that ends meanwhile takes away its own.
        """
        deadline = time.monotonic() + patience
        while (left := self._left()) and time.monotonic() < deadline:
            time.sleep(POLL)
        return left

    def _left(self) -> list[str]:
        claims = [name for name in Path("/proc/net/unix").read_text().split() if name == f"@{CLAIM}{self.domain}"]
        new = shared_memory() - self._shared
        return sorted(new - mapped() if new else new) + claims

    def end(self) -> None:
        """Whatever became of it: nothing of it runs on."""
        if self.running:
            self.process.kill()
        self.process.wait()
        self.orphans(5.0)


def size_of(file: Path) -> int:
    """0 for one that is not there, or no longer."""
    try:
        return file.stat().st_size
    except FileNotFoundError:
        return 0


def processes_of(supervisor: psutil.Process) -> dict[str, psutil.Process]:
    """By name: units, plc, clock, recorder, and those that run them."""
    found = {SUPERVISOR: supervisor}
    for child in supervisor.children(recursive=True):
        try:
            words = " ".join(child.cmdline()).split()
        except psutil.NoSuchProcess:
            continue
        node = next((word.removeprefix("cnc_ptp.nodes.") for word in words if word.startswith("cnc_ptp.nodes.")), "")
        if node:
            name = node if node in OBSERVERS else words[words.index(f"cnc_ptp.nodes.{node}") + 2]
            found["plc" if name == "plc_bridge" else name] = child
        else:
            found[SERVER if "forkserver" in " ".join(words) else f"process {child.pid}"] = child
    return found


def shared_memory() -> set[str]:
    return {f"/dev/shm/{each.name}" for each in Path("/dev/shm").iterdir()} if Path("/dev/shm").is_dir() else set()


def free_domain(wish: int, *, first: int = 101, count: int = 100) -> int:
    """One of `count` ROS domains from `first` on, 101 … 200, on which no run is under way."""
    for number in range(wish, wish + count):
        domain = first + number % count
        with socket.socket(socket.AF_UNIX) as claim:
            try:
                claim.bind(f"\0{CLAIM}{domain}")
            except OSError:
                continue
            return domain
    raise RuntimeError(f"{count} runs at once")


def mapped() -> set[str]:
    """Shared memory that a living process uses: another program's, since those of the run are looked for before."""
    found: set[str] = set()
    for maps in Path("/proc").glob("[0-9]*/maps"):
        try:
            words = maps.read_text().split()
        except OSError:  # it has ended, or is another user's
            continue
        found.update(word for word in words if word.startswith("/dev/shm/"))
    return found
