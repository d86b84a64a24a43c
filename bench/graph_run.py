"""One run of the ROS graph with its processes watched; runs in a process of its own, because it starts and ends ROS."""

from __future__ import annotations

import os
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context

import psutil

SETTLED_CYCLES = 1000
"""The figures start here, when all nodes run evenly."""
SAMPLE_PERIOD = 1.0
SUPERVISOR = "supervisor and monitor"
COMPOSED = "all nodes"


@dataclass(slots=True)
class GraphRun:
    """Observations of a run between its first and its last sample."""

    startup: float = 0.0
    """Seconds until the first cycle was reported."""
    wall: float = 0.0
    cycles: int = 0
    cpu: dict[str, float] = field(default_factory=dict)
    """Processor seconds by node."""
    others: float = 0.0
    """Processor seconds that everything else on this computer took (and what the host took away)."""
    pss_mb: dict[str, float] = field(default_factory=dict)
    """Memory by node, shared pages split over those who use them."""
    blocks: int = 0
    lost_blocks: int = 0
    duplicates: int = 0
    lateness_p50_ms: float = 0.0
    lateness_p99_ms: float = 0.0
    lateness_max_ms: float = 0.0
    failures: list[str] = field(default_factory=list)


def run_graph(
    machine: str,
    program: str | None,
    scenario: str | None = None,
    *,
    seconds: float,
    record: str,
    free_run: bool,
    composed: bool,
) -> GraphRun:
    """Runs `seconds` of machine time in a new process, in a ROS domain that others do not use."""
    os.environ.setdefault("ROS_DOMAIN_ID", str(1 + os.getpid() % 100))
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        options = (machine, program, scenario, seconds, record, free_run)
        return pool.submit(_run, options, composed).result()


def _run(arguments: tuple[str, str | None, str | None, float, str, bool], composed: bool) -> GraphRun:
    from cnc_ptp.nodes.composed import run_composed
    from cnc_ptp.nodes.supervisor import RunOptions, Supervisor
    from cnc_ptp.parameters import read_machine
    from cnc_ptp.recording.node_figures import BLOCKS, CAME_TWICE, LOST_BLOCKS

    options = RunOptions(*arguments)
    parameters, seconds = read_machine(options.machine), arguments[3]
    watch = Watch(memory_at=0.8 * seconds * 1e6 / parameters.cycle_time_us, own=COMPOSED if composed else SUPERVISOR)

    def show(monitor: object) -> None:
        watch.look(monitor.cycle)  # type: ignore[attr-defined]

    if composed:
        monitor, failures = run_composed(parameters, options, show=show)
    else:
        supervisor = Supervisor(parameters, options, show=show)
        monitor, failures = supervisor.run(), supervisor.failures
    run = watch.finish()
    run.failures = failures + monitor.errors
    nodes = monitor.diagnostics.values()
    run.blocks, run.lost_blocks, run.duplicates = (
        sum(int(node[key]) for node in nodes) for key in (BLOCKS, LOST_BLOCKS, CAME_TWICE)
    )
    lateness = monitor.lateness()
    run.lateness_p50_ms = lateness.percentile_us(50.0) / 1000.0
    run.lateness_p99_ms = lateness.percentile_us(99.0) / 1000.0
    run.lateness_max_ms = lateness.largest_us / 1000.0
    return run


@dataclass(frozen=True, slots=True)
class Sample:
    """A moment of a run."""

    time: float
    cycle: int
    cpu: dict[str, float]
    busy: float
    """Processor seconds of the whole computer, besides idling."""


class Watch:
    """Samples the processes of the run once per second: this one and its children."""

    def __init__(self, *, memory_at: float, own: str) -> None:
        """`memory_at`: cycle at which the memory is read. `own`: name for this process."""
        self._started = time.monotonic()
        self._memory_at = memory_at
        self._own = own
        self._samples: list[Sample] = []
        self._processes: dict[str, psutil.Process] = {}
        self.run = GraphRun()

    def look(self, cycle: int) -> None:
        """Called many times per second with the last cycle that was reported."""
        now = time.monotonic()
        if cycle and not self.run.startup:
            self.run.startup = now - self._started
            self._processes = self._find_processes()
        if cycle < SETTLED_CYCLES or (self._samples and now - self._samples[-1].time < SAMPLE_PERIOD):
            return
        try:
            cpu = {name: process_seconds(process) for name, process in self._processes.items()}
            if cycle >= self._memory_at and not self.run.pss_mb:
                self.run.pss_mb = {name: each.memory_full_info().pss / 1e6 for name, each in self._processes.items()}
        except (psutil.NoSuchProcess, psutil.AccessDenied):  # the run is ending
            return
        self._samples.append(Sample(now, cycle, cpu, computer_seconds()))

    def finish(self) -> GraphRun:
        """The differences between the first and the last sample."""
        if len(self._samples) > 1:
            first, last = self._samples[0], self._samples[-1]
            self.run.wall, self.run.cycles = last.time - first.time, last.cycle - first.cycle
            self.run.cpu = {name: last.cpu[name] - first.cpu[name] for name in last.cpu}
            self.run.others = max(0.0, last.busy - first.busy - sum(self.run.cpu.values()))
        return self.run

    def _find_processes(self) -> dict[str, psutil.Process]:
        own = psutil.Process()
        return {node_name(words_of(child)): child for child in nodes_of(own)} | {self._own: own}


def nodes_of(run: psutil.Process) -> list[psutil.Process]:
    """The node processes of a run."""
    family = run.children(recursive=True)
    return [child for child in family if any(word.startswith("cnc_ptp.nodes.") for word in words_of(child))]


def words_of(process: psutil.Process) -> list[str]:
    return " ".join(process.cmdline()).split()


def process_seconds(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)


def computer_seconds() -> float:
    """Processor seconds of everything, with those that the host of a virtual machine took away."""
    times = psutil.cpu_times()
    return float(sum(times) - times.idle - times.iowait - times.guest - times.guest_nice)


def node_name(command_line: list[str]) -> str:
    """python -m cnc_ptp.nodes.axis MACHINE x -> axis x."""
    kind = command_line[2].rpartition(".")[2]
    return f"{kind} {command_line[4]}" if kind in ("axis", "spindle", "nc_channel") else kind
