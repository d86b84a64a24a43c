"""Helpers of the tests of sweeps: a program that takes half a second, sweeps in this process or on workers."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from commands_support import MILL

from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.parameters import load_machine, machine_text
from cnc_ptp.sweep.goals import read_goals
from cnc_ptp.sweep.plans import Plan, grid
from cnc_ptp.sweep.results import Row, Variant
from cnc_ptp.sweep.sweep import Sweep, make_job
from cnc_ptp.sweep.variant_run import Job, compute
from cnc_ptp.sweep.variation import read_variations

PROGRAM = "N10 G1 X5 Y0 F3000\nN20 X5 Y5\nN30 X0 Y0\nN40 M30\n"
KV = "x.getriebe.0.kv=2000:8000:5"
LARGEST = "max(following_error.x)"


def program_in(folder: Path, text: str = PROGRAM) -> Path:
    path = folder / "short.nc"
    path.write_text(text)
    return path


def machine():
    return load_machine(machine_text(MILL), str(MILL))


def sweep_in(
    folder: Path,
    *vary: str,
    goals: Iterable[str] = (LARGEST, "program_time"),
    make_plan: Callable[..., Plan] = grid,
    seconds: float | None = None,
    program: str = PROGRAM,
) -> Sweep:
    """A sweep of the mill into the file `sweep.parquet`; it starts nothing."""
    text = machine_text(MILL)
    parameters = load_machine(text, str(MILL))
    entries = read_entries(parameters, program=str(program_in(folder, program)), scenario=None)
    variations = read_variations(vary or (KV,), parameters)
    read = read_goals([*goals], parameters)
    job = make_job(text, str(MILL), entries, variations, read, seconds)
    return Sweep(job, variations, read, make_plan(variations), folder / "sweep.parquet")


class Here:
    """A pool that computes in this process; `after`: of how many variants it is ended from outside."""

    def __init__(self, after: int | None = None, fails: Callable[[Variant], Row | None] = lambda variant: None) -> None:
        self.computed: list[int] = []
        self._after = after
        self._fails = fails

    def compute(self, job: Job, variants: Iterable[Variant], ended: Callable[[], bool]) -> Iterator[Row]:
        for variant in variants:
            if len(self.computed) == self._after or ended():
                return
            self.computed.append(variant.number)
            yield self._fails(variant) or compute(job, variant)

    def __enter__(self) -> Here:
        return self

    def __exit__(self, *error: object) -> None:
        pass


def run_here(sweep: Sweep, pool: Here | None = None) -> bool:
    return sweep.run(lambda: pool or Here(), lambda: False, lambda count: None)


def deadly(job: Job, variant: Variant) -> Row:
    """Computes nothing; the process of the worker dies at variant 1."""
    if variant.number == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return Row(*variant, (1.0,) * len(job.goals))
