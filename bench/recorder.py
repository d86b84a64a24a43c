"""The recorder in the graph: 8 axes at 1 ms, each in a process of its own, all of them in motion."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bench.figures import Effort, Figure, ShowProgress
from bench.graph import missing_samples
from bench.graph_run import run_graph
from bench.slaves import files
from cnc_ptp.recording.reader import read_recording

AXES = 8
KILOBYTE = 1e3


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """Loss, processor time, size of the file."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        machine, scenario = independent(folder)
        record = folder / "run.mcap"
        show(f"{effort.graph_seconds:.0f} s in real time, {AXES} axes")
        run = run_graph(
            machine,
            None,
            scenario,
            seconds=effort.graph_seconds,
            record=str(record),
            free_run=False,
            composed=False,
        )
        axes = f"recorder, {AXES} axes at 1 ms"
        yield Figure(f"{axes}: failures and errors", len(run.failures), "", goal=0.0, at_most=True)
        yield Figure(f"{axes}: blocks lost", run.lost_blocks, "", goal=0.0, at_most=True)
        yield Figure(f"{axes}: samples missing", missing_samples(str(record)), "", goal=0.0, at_most=True)
        if run.wall:
            recorder = next(seconds for node, seconds in run.cpu.items() if node.startswith("recorder"))
            yield Figure(f"{axes}: recorder", recorder / run.wall, "cores", goal=0.25, at_most=True)
            yield Figure(f"{axes}: all nodes", sum(run.cpu.values()) / run.wall, "cores")
        size = record.stat().st_size / KILOBYTE
        yield Figure(f"{axes}: file, each axis and second", size / (AXES * seconds_of(record)), "kB")


def independent(folder: Path) -> tuple[str, str]:
    """A machine of 8 axes and a scenario in which each moves at a velocity of its own."""
    machine, scenario = files(folder, AXES, lambda n: n - 1)
    move = "acceleration: 5000, deceleration: 5000, jerk: 50000"
    lines = [
        f"- {{at: 0, to: a{n}, do: move_absolute, target: 90000, velocity: {1000 - 50 * n}, {move}}}"
        for n in range(AXES)
    ]
    Path(scenario).write_text("\n".join(lines))
    return machine, scenario


def seconds_of(record: Path) -> float:
    """Machine time in the recording."""
    states = read_recording(record).states.values()
    return max(len(np.unique(rows["cycle"])) for rows in states) * 1e-3
