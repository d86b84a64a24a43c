"""`cnc_ptp sweep`: many offline runs with other parameters, their goals as a table and a page."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from cnc_ptp.commands.console import RUN_FAILED, print_missing_folders
from cnc_ptp.commands.output_file import check_output, check_page, write_output
from cnc_ptp.commissioning.faults import BAD_OUTPUT
from cnc_ptp.errors import CncError
from cnc_ptp.interrupt import INTERRUPTED, EndRequest
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.parameters import MachineParameters, load_machine, machine_text
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.sweep.goals import Goal, read_goals
from cnc_ptp.sweep.optimiser import OptimisedPlan
from cnc_ptp.sweep.page import sweep_page
from cnc_ptp.sweep.plans import Plan, grid, random_plan
from cnc_ptp.sweep.pool import Pool
from cnc_ptp.sweep.results import Results, Row
from cnc_ptp.sweep.sweep import Sweep, make_job
from cnc_ptp.sweep.variation import Variation, check_variations, outermost_machines, read_variations

PARQUET = ".parquet"
MOST_SHOWN = 5
"""Failed variants whose text is printed."""


def sweep(
    machine: str,
    program: str | None,
    scenario: str | None,
    duration: float | None,
    vary: Sequence[str],
    goals: Sequence[str],
    output: str,
    page: str | None,
    random: int | None,
    optimise: int | None,
    seed: int,
    workers: int | None,
    scheduler: str | None,
    dialect: str | None = None,
) -> int:
    """Computes what is missing of a sweep and writes its table. Status 1 when all variants have failed."""
    inputs = {"machine_file": machine, "NC_program": program, "scenario": scenario}
    check_files(output, page, inputs)
    text = machine_text(machine)
    parameters = load_machine(text, machine)
    print_missing_folders(parameters)
    variations = read_variations(vary, parameters)
    read = read_goals(goals, parameters)
    check_variations(variations, text, machine)
    machines = [parameters, *outermost_machines(variations, text, machine)]
    entries = first_possible(machines, program=program, scenario=scenario, dialect=dialect)
    plan = make_plan(variations, read, random, optimise, seed)
    job = make_job(text, machine, entries, variations, read, duration)
    whole = Sweep(job, variations, read, plan, Path(output))
    started = time.monotonic()
    with EndRequest() as end, SweepProgress(plan.total) as progress:
        finished = whole.run(lambda: Pool(workers, scheduler), lambda: end.given, progress.show)
    if not finished:
        print_interrupted(whole)
        return 128 + end.number
    results = whole.results
    print_results(results, output, whole.taken_over, time.monotonic() - started)
    if page is not None:
        write_output(page, sweep_page(results, Path(output).name, plan.description), remains=f"{output} is complete")
    return RUN_FAILED if len(results.failed) == plan.total else 0


def print_interrupted(whole: Sweep) -> None:
    """What is kept, and how to continue."""
    text = f"P-ERR-{INTERRUPTED} the sweep was interrupted; no variant was finished"
    if whole.rows:
        kept = f"{len(whole.rows)} of {whole.plan.total} variants are kept in {whole.journal}"
        text = f"P-ERR-{INTERRUPTED} the sweep was interrupted; {kept}, the same command computes the others"
    Console(stderr=True, highlight=False, soft_wrap=True).print(text, style="bold red", markup=False)


def check_files(output: str, page: str | None, inputs: dict[str, str | None]) -> None:
    """Raises CncError 27030 for files of a wrong name, in a folder that does not exist, or that are inputs."""
    if Path(output).suffix.lower() != PARQUET:
        wrong = f"{output}: the file name of a sweep must end in {PARQUET}"
        raise CncError(BAD_OUTPUT, wrong, "nothing was started")
    check_output(output, **inputs)
    if page is not None:
        check_page(page, **inputs)


def first_possible(machines: Sequence[MachineParameters], **files: str | None) -> list[Entry]:
    """Program and scenario, checked with the first machine that takes them; raises what the very first one says."""
    refused: CncError | None = None
    for machine in machines:
        try:
            return read_entries(machine, **files)  # type: ignore[arg-type]
        except ProgramError as error:
            refused = refused or error
    assert refused is not None
    raise refused


def make_plan(
    variations: Sequence[Variation], goals: Sequence[Goal], random: int | None, optimise: int | None, seed: int
) -> Plan:
    if optimise is not None:
        return OptimisedPlan(variations, goals, optimise, seed)
    if random is not None:
        return random_plan(variations, random, seed)
    return grid(variations)


def print_results(results: Results, output: str, taken_over: int, seconds: float) -> None:
    """How many variants there are, the best of each goal, and why others have failed."""
    console = Console(highlight=False, soft_wrap=True)
    before = f", {taken_over} of them before" if taken_over else ""
    failed = f", {len(results.failed)} failed" if results.failed else ""
    console.print(f"{output}: {len(results.rows)} variants{before}{failed}; {seconds:.1f} s", markup=False)
    for place, goal in enumerate(results.goals):
        if (row := results.best(place)) is not None:
            word = "largest" if goal.maximise else "least"
            line = f"{word} {goal.label} {row.goals[place]:.6g}: variant {row.number}, {values_text(results, row)}"
            console.print(line, markup=False)
    if len(results.goals) > 1 and results.sound:
        front = ", ".join(str(row.number) for row in results.pareto_front())
        console.print(f"Pareto front: {front}", markup=False)
    for row in results.failed[:MOST_SHOWN]:
        text = f"failed: variant {row.number}, {values_text(results, row)}: P-ERR-{row.error} {row.message}"
        console.print(text, style="yellow", markup=False)


def values_text(results: Results, row: Row) -> str:
    return " ".join(f"{name}={shown(value)}" for name, value in zip(results.names, row.values, strict=True))


def shown(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


class SweepProgress:
    """A bar over the variants, on a terminal only."""

    def __init__(self, total: int) -> None:
        console = Console(stderr=True)
        columns = TextColumn("variants"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
        self._progress = Progress(*columns, console=console, disable=not console.is_terminal)
        self._task = self._progress.add_task("variants", total=total)

    def __enter__(self) -> SweepProgress:
        self._progress.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._progress.stop()

    def show(self, finished: int) -> None:
        self._progress.update(self._task, completed=finished)
