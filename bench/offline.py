"""The offline run: speed over real time with and without recording, memory over a long run."""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from bench.figures import Effort, Figure, ShowProgress, Stopwatch, stopwatch
from bench.jobs import BRACKET, MACHINE, OVERRIDES, ROOT, long_program
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.run_entries import read_entries, read_file
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import read_machine
from cnc_ptp.recording.offline_run import write
from cnc_ptp.recording.writer import Recording

LONG = 600.0
"""Seconds of machine time of the long run of which the memory is measured."""


@dataclass(frozen=True, slots=True)
class OfflineRun:
    """Times and memory of one run."""

    machine_seconds: float
    blocks: int
    watch: Stopwatch


def run_offline(
    machine: str,
    *,
    program: str,
    scenario: str | None = None,
    seconds: float | None = None,
    record: str | None = None,
) -> OfflineRun:
    """As `cnc_ptp simulate` does it; the machine and the job are read before the watch starts."""
    parameters = read_machine(machine)
    entries = read_entries(parameters, program=program, scenario=scenario)
    units = build_units(parameters, scenario=entries, end_when_idle=seconds is None)
    offline = OfflineMachine(parameters, units)
    cycle_ns = parameters.cycle_time_us * 1000
    cycles = None if seconds is None else round(seconds * 1e9 / cycle_ns)
    blocks = 0
    with stopwatch() as watch, ExitStack() as stack:
        recording = None
        if record is not None:
            recording = stack.enter_context(Recording(record, read_file("machine file", machine), 0, cycle_ns))
        for outputs in offline.run(cycles=cycles):
            blocks += 1
            if recording is not None:
                write(recording, outputs)
    return OfflineRun(blocks * parameters.block_cycles * cycle_ns * 1e-9, blocks, watch)


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """Speed on the example, memory."""
    with tempfile.TemporaryDirectory() as folder:
        yield from speed(effort, show, str(Path(folder) / "run.mcap"))
        yield from memory(effort, show, Path(folder))


def speed(effort: Effort, show: ShowProgress, record: str) -> Iterator[Figure]:
    """examples/bracket.nc with its overrides on config/mill.yaml, with and without recording in turn."""
    recorded: list[OfflineRun] = []
    kernel: list[OfflineRun] = []
    seconds = None if effort.size >= 0.1 else 1.0
    for n in range(effort.runs):
        show(f"bracket, run {n + 1} of {effort.runs}")
        recorded.append(run_offline(MACHINE, program=BRACKET, scenario=OVERRIDES, seconds=seconds, record=record))
        kernel.append(run_offline(MACHINE, program=BRACKET, scenario=OVERRIDES, seconds=seconds))
    yield Figure("bracket with full recording", times_real_time(recorded), "× real time", goal=72.0, aim=100.0)
    yield Figure("bracket without recording", times_real_time(kernel), "× real time")
    cpu = statistics.median(run.machine_seconds / run.watch.cpu for run in recorded)
    yield Figure("the same with recording, by processor time of all threads", cpu, "× real time")
    whole = statistics.median(block_time_us(run, run.watch.wall) for run in recorded)
    units = statistics.median(block_time_us(run, run.watch.wall) for run in kernel)
    yield Figure("a block of 10 cycles: kernel", units, "µs/block")
    yield Figure("a block of 10 cycles: recording", whole - units, "µs/block")


def times_real_time(runs: list[OfflineRun]) -> float:
    return statistics.median(run.machine_seconds / run.watch.wall for run in runs)


def block_time_us(run: OfflineRun, seconds: float) -> float:
    return 1e6 * seconds / run.blocks


def memory(effort: Effort, show: ShowProgress, folder: Path) -> Iterator[Figure]:
    """Largest resident size of a run that records, after a tenth and after all of a long program."""
    long = LONG * effort.size
    program = folder / "long.nc"
    program.write_text(long_program(long))
    peaks = []
    for seconds in (0.1 * long, long):
        show(f"memory of {seconds:.0f} s")
        arguments = [MACHINE, str(program), str(seconds), str(folder / "long.mcap")]
        command = [sys.executable, "-m", "bench.peak_memory", *arguments]
        peaks.append(float(subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout))
        yield Figure(f"largest memory of a recorded run of {seconds:.0f} s", peaks[-1], "MB")
    growth = 1000.0 * (peaks[1] - peaks[0]) / (0.9 * long)
    yield Figure("growth", growth, "kB/s of machine time")
