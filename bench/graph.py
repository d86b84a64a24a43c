"""The ROS graph: real time as 8 processes, then as fast as possible as 8 processes and composed in one."""

from __future__ import annotations

import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from statistics import mean

import numpy as np

from bench.figures import Effort, Figure, ShowProgress
from bench.graph_run import SUPERVISOR, GraphRun, run_graph
from bench.jobs import MACHINE, long_program
from cnc_ptp.parameters import read_machine
from cnc_ptp.recording.reader import read_recording

FREE_RUN_SECONDS = 60.0
COMPOSED_SECONDS = 120.0
LEAST_SECONDS = 5.0


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """The real-time run, then the rates without a paced clock."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        program, record = folder / "long.nc", str(folder / "run.mcap")
        program.write_text(long_program(max(effort.graph_seconds, COMPOSED_SECONDS)))
        job = (MACHINE, str(program))
        seconds = effort.graph_seconds
        show(f"{seconds:.0f} s in real time, 8 processes")
        paced = run_graph(*job, seconds=seconds, record=record, free_run=False, composed=False)
        yield from real_time(paced)
        yield Figure("samples missing in the recording", missing_samples(record), "", goal=0.0, at_most=True)
        yield from resources(paced)
        show("free run, 8 processes")
        free_seconds = max(LEAST_SECONDS, FREE_RUN_SECONDS * effort.size)
        free = run_graph(*job, seconds=free_seconds, record=record, free_run=True, composed=False)
        yield from rate("free run as 8 processes", free)
        show("free run, composed")
        composed_seconds = max(LEAST_SECONDS, COMPOSED_SECONDS * effort.size)
        composed = run_graph(*job, seconds=composed_seconds, record=record, free_run=True, composed=True)
        yield from rate("free run composed in one process", composed)


def real_time(run: GraphRun) -> Iterator[Figure]:
    """Figures that must hold in real time: blocks, lateness."""
    machine = read_machine(MACHINE)
    block_ms = machine.block_cycles * machine.cycle_time_us / 1000.0
    yield Figure("failures and errors", len(run.failures), "", goal=0.0, at_most=True)
    yield from failures(run)
    yield Figure("blocks computed by all units", run.blocks, "")
    yield Figure("blocks lost", run.lost_blocks, "", goal=0.0, at_most=True)
    yield Figure("ticks and blocks that came twice", run.duplicates, "", goal=0.0, at_most=True)
    yield Figure("block lateness p50", run.lateness_p50_ms, "ms")
    yield Figure("block lateness p99", run.lateness_p99_ms, "ms", goal=block_ms, at_most=True)
    yield Figure("block lateness, largest", run.lateness_max_ms, "ms")


def resources(run: GraphRun) -> Iterator[Figure]:
    """Cores and memory: of the 8 nodes together, then each; and the supervisor."""
    yield Figure("start-up, from the call to the first cycle", run.startup, "s")
    if not run.wall:
        return
    cores = {name: seconds / run.wall for name, seconds in run.cpu.items()}
    nodes = [name for name in cores if name != SUPERVISOR]
    yield Figure(f"{len(nodes)} nodes together", sum(cores[name] for name in nodes), "cores", goal=0.6, at_most=True)
    for name in [*nodes, SUPERVISOR]:
        yield Figure(f"  {name}", cores[name], "cores")
    yield from spindle_beside_axis({name: cores[name] for name in nodes})
    yield Figure("others on this computer meanwhile", run.others / run.wall, "cores")
    if not run.pss_mb:
        return
    yield Figure(f"memory of {len(nodes)} nodes (PSS)", sum(run.pss_mb[name] for name in nodes), "MB")
    for name in [*nodes, SUPERVISOR]:
        yield Figure(f"  {name}", run.pss_mb[name], "MB")


def spindle_beside_axis(cores: Mapping[str, float]) -> Iterator[Figure]:
    """Processor time of the spindle nodes over that of the axis nodes, means of the same run."""
    spindles, axes = ([cores[name] for name in cores if name.startswith(kind)] for kind in ("spindle", "axis"))
    if spindles and axes:
        yield Figure("a spindle node, in axis nodes", mean(spindles) / mean(axes), "", goal=1.0, at_most=True)


def failures(run: GraphRun) -> Iterator[Figure]:
    """The first failure, and the number of failures."""
    for text, count in Counter(run.failures).most_common(3):
        yield Figure(text, count, "times", goal=0.0, at_most=True)


def rate(name: str, run: GraphRun) -> Iterator[Figure]:
    """Cycles per second and the cores that this takes; failures."""
    yield from failures(run)
    if run.wall:
        yield Figure(name, run.cycles / run.wall, "cycles/s")
        yield Figure(f"{name}: all processes", sum(run.cpu.values()) / run.wall, "cores")


def missing_samples(record: str) -> int:
    """State samples that the file lacks according to the cycle numbers, over all units."""
    recorded = read_recording(record)
    expected = recorded.last_cycle + 1
    return sum(expected - len(np.unique(rows["cycle"])) for rows in recorded.states.values())
