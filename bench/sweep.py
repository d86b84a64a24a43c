"""Sweeps: variants on one and on two worker processes, the start of the workers included."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from bench.figures import Effort, Figure, ShowProgress, medians_of
from bench.jobs import ROOT
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.parameters import load_machine, machine_text
from cnc_ptp.sweep.goals import read_goals
from cnc_ptp.sweep.plans import grid
from cnc_ptp.sweep.pool import Pool
from cnc_ptp.sweep.sweep import Sweep, make_job
from cnc_ptp.sweep.variation import read_variations

MACHINE = str(ROOT / "config" / "mill.yaml")
PROGRAM = str(ROOT / "examples" / "tuning.nc")
VARIANTS = 200
MOST_RUNS = 3
"""A sweep takes a minute."""


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """Variants per second; the goal is one for two workers against one."""
    count = effort.scaled(VARIANTS, least=2)
    show(f"{count} variants")
    one, two = medians_of(min(effort.runs, MOST_RUNS), [seconds_with(1, count), seconds_with(2, count)])
    yield Figure(f"{count} variants, one worker", one, "s")
    name = f"{count} variants, two workers against one"
    yield Figure(name, count / two, "1/s", goal=1.8, of_ratio=True, peer="one worker", peer_value=count / one)


def seconds_with(workers: int, count: int) -> Callable[[], float]:
    def measure() -> float:
        with tempfile.TemporaryDirectory() as folder:
            sweep = sweep_into(Path(folder) / "sweep.parquet", count)
            started = time.perf_counter()
            assert sweep.run(lambda: Pool(workers, None), lambda: False, lambda finished: None)
            seconds = time.perf_counter() - started
            assert not sweep.results.failed
            return seconds

    return measure


def sweep_into(target: Path, count: int) -> Sweep:
    text = machine_text(MACHINE)
    machine = load_machine(text, MACHINE)
    entries = read_entries(machine, program=PROGRAM, scenario=None)
    variations = read_variations([f"x.getriebe.0.kv=4000:6000:{count}"], machine)
    goals = read_goals(["max(following_error.x)", "program_time"], machine)
    job = make_job(text, MACHINE, entries, variations, goals, None)
    return Sweep(job, variations, goals, grid(variations), target)
