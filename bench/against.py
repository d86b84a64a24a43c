"""`python -m bench.against [COMMIT]`: this tree against another commit, both by their command line, run in turn.

Processor time of all processes of a run counts, so that neighbours on the computer do not. The other commit gets a
worktree and an environment of its own (build/against), which takes minutes the first time.
"""

from __future__ import annotations

import os
import re
import resource
import statistics
import subprocess
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import click
import psutil
from rich.console import Console

from bench import jobs
from bench.figures import Figure, table
from bench.jobs import ROOT, long_program

MACHINE, BRACKET, OVERRIDES = (
    str(Path(file).relative_to(ROOT)) for file in (jobs.MACHINE, jobs.BRACKET, jobs.OVERRIDES)
)
"""Each tree has its own."""

BASELINE = "147e025"
"""The commit before the kernel was compiled."""
OF_THIS_TREE = ("AMENT_PREFIX_PATH", "LD_LIBRARY_PATH", "PYTHONPATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE")
"""Environment variables that would lead to its libraries."""
SAMPLE = 0.05
SETTLED = 3.0
"""Seconds after the first cycle from which on processor time counts: all nodes run evenly."""
FAREWELL = 0.5
"""Seconds at the end of a run that are not counted."""
BLOCKS_PER_SECOND = 100.0
LATENESS = re.compile(r"block lateness p50 ([\d.]+) ms, p99 ([\d.]+) ms")


@dataclass
class Run:
    """Observations of one call of `cnc_ptp`."""

    startup: float = 0.0
    """Seconds from the call to the first tick: the recording begins then."""
    wall: float = 0.0
    """Seconds from there to the end."""
    cpu: float = 0.0
    """Processor seconds of all its processes."""
    cores: float = 0.0
    """The same from `SETTLED` on, per second of wall time."""
    pss_mb: float = 0.0
    output: str = ""
    samples: list[tuple[float, float]] = field(default_factory=list)


def call(tree: Path, *words: str, record: Path) -> Run:
    """Runs `cnc_ptp WORDS --record RECORD` of a tree, and watches its processes."""
    record.unlink(missing_ok=True)
    run, seconds = Run(), {}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.monotonic()
    command = [tree / ".venv" / "bin" / "cnc_ptp", *words, "--record", record]
    environment = {name: value for name, value in os.environ.items() if name not in OF_THIS_TREE}
    with subprocess.Popen(
        command, cwd=tree, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as child:
        process = psutil.Process(child.pid)
        while child.poll() is None:
            now = time.monotonic()
            for each in family(process):
                seconds[each.pid] = processor_seconds(each) or seconds.get(each.pid, 0.0)
            if not run.startup and record.exists() and record.stat().st_size:
                run.startup = now - begin
            if run.startup:
                run.samples.append((now, sum(seconds.values())))
            if run.startup and not run.pss_mb and now - begin - run.startup > SETTLED:
                run.pss_mb = sum(map(proportional_memory, family(process))) / 1e6
            time.sleep(SAMPLE)
        run.output = child.stdout.read() if child.stdout else ""
    if child.returncode:
        raise click.ClickException(f"{tree}: cnc_ptp {' '.join(words)} ended with {child.returncode}:\n{run.output}")
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    waited_for = ended.ru_utime + ended.ru_stime - before.ru_utime - before.ru_stime
    run.wall, run.cpu = time.monotonic() - begin - run.startup, max(sum(seconds.values()), waited_for)
    even = [(at, cpu) for at, cpu in run.samples if SETTLED < at - begin - run.startup < run.wall - 2.0 * FAREWELL]
    if len(even) > 1:
        run.cores = (even[-1][1] - even[0][1]) / (even[-1][0] - even[0][0])
    return run


def family(process: psutil.Process) -> list[psutil.Process]:
    try:
        return [process, *process.children(recursive=True)]
    except psutil.NoSuchProcess:
        return []


def processor_seconds(process: psutil.Process) -> float:
    try:
        times = process.cpu_times()
        return float(times.user + times.system)
    except (psutil.NoSuchProcess, psutil.AccessDenied):
        return 0.0


def proportional_memory(process: psutil.Process) -> float:
    try:
        return float(process.memory_full_info().pss)
    except (psutil.NoSuchProcess, psutil.AccessDenied):
        return 0.0


def tree_of(commit: str) -> Path:
    """The worktree of a commit, set up."""
    tree = ROOT / "build" / "against" / commit
    if not tree.exists():
        subprocess.run(["git", "worktree", "add", "--detach", str(tree), commit], cwd=ROOT, check=True)
    subprocess.run(["make", "setup"], cwd=tree, check=True, stdout=subprocess.DEVNULL)
    return tree


def figures(old: Path, runs: int, seconds: float, show: Console) -> Iterator[Figure]:
    """Each job in both trees, in turn; medians."""
    with tempfile.TemporaryDirectory() as name:
        record, program = Path(name) / "run.mcap", Path(name) / "long.nc"
        program.write_text(long_program(40.0 * seconds))
        job = (MACHINE, "--program", str(program), "--duration")

        def both(*words: str) -> tuple[list[Run], list[Run]]:
            show.print(f"cnc_ptp {' '.join(words[:2])} {' '.join(words[4:])} ...", markup=False)
            pairs = [(call(old, *words, record=record), call(ROOT, *words, record=record)) for _ in range(runs)]
            return [before for before, _ in pairs], [after for _, after in pairs]

        yield from offline(*both("simulate", MACHINE, "--program", BRACKET, "--scenario", OVERRIDES))
        yield from offline(*both("simulate", *job, str(8.0 * seconds)), name="a long program offline")
        yield from paced(*both("run", *job, str(seconds)))
        length = 2.0 * seconds
        yield from rate("free run, one process per node", length, 5.0, *both("run", *job, str(length), "--free-run"))
        length = 10.0 * seconds
        words = ("run", *job, str(length), "--free-run", "--composed")
        yield from rate("free run, composed", length, 10.0, *both(*words))


def offline(before: list[Run], after: list[Run], name: str = "bracket offline, start included") -> Iterator[Figure]:
    yield compared(f"{name}: processor time", [1.0 / run.cpu for run in before], [1.0 / run.cpu for run in after], 6.0)


def paced(before: list[Run], after: list[Run]) -> Iterator[Figure]:
    """The real-time run."""
    per_block = 1e3 / BLOCKS_PER_SECOND
    old, new = ([run.cores for run in runs] for runs in (before, after))
    yield compared("real time, 8 nodes: cores", new, old, 3.0, unit="cores")
    yield Figure("  processor time of a block", statistics.median(new) * per_block, "ms", goal=6.0, at_most=True)
    late = [float(found[2]) for run in after if (found := LATENESS.search(run.output))]
    yield Figure("  block lateness p99", statistics.median(late), "ms", goal=10.0, at_most=True)
    old, new = ([run.startup for run in runs] for runs in (before, after))
    yield compared("start-up to the first cycle", new, old, 3.0, unit="s")
    old, new = ([run.pss_mb for run in runs] for runs in (before, after))
    yield compared("memory of all processes (PSS)", new, old, 2.0, unit="MB")


def rate(name: str, length: float, goal: float, before: list[Run], after: list[Run]) -> Iterator[Figure]:
    """Cycles per second of `length` seconds of machine time."""
    old, new = ([1000.0 * length / max(run.wall - FAREWELL, 0.1) for run in runs] for runs in (before, after))
    yield compared(name, old, new, goal, unit="cycles/s")


def compared(name: str, small: list[float], large: list[float], goal: float, unit: str = "") -> Figure:
    """How many times `large` is `small`; the name has both, if they have a unit."""
    lower, upper = statistics.median(small), statistics.median(large)
    text = f"{name} ({lower:.4g} and {upper:.4g} {unit})" if unit else name
    return Figure(text, upper / lower, "×", goal=goal)


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("commit", default=BASELINE)
@click.option("--runs", default=3, show_default=True, help="Runs of each job, in turn with the other commit.")
@click.option("--seconds", default=12.0, show_default=True, help="Length of the real-time run; the others follow it.")
def main(commit: str, runs: int, seconds: float) -> None:
    """How many times this tree is as fast as COMMIT. Commit your work first; nothing here fails."""
    console = Console(highlight=False)
    found = list(figures(tree_of(commit), runs, seconds, console))
    console.print(table(f"against {commit}", found))


if __name__ == "__main__":
    main()
