"""Coupled axes: 32 of them offline, a cascade of 8 in processes of their own in real time."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import yaml

from bench.figures import Effort, Figure, ShowProgress, medians_of, stopwatch
from bench.graph_run import run_graph
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import read_machine

SOURCE = "config/ptp.yaml"
OFFLINE_AXES, OFFLINE_SECONDS = 32, 4.0
CASCADE_AXES = 8


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """Rates offline, lateness of a cascade in the graph."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        show(f"{OFFLINE_AXES} coupled axes offline")
        seconds = OFFLINE_SECONDS * effort.size
        tree = files(folder, OFFLINE_AXES, lambda n: n // 2 if n % 2 else n - 1)
        rate = medians_of(effort.runs, [lambda: offline_rate(*tree, seconds)])[0]
        yield Figure(f"{OFFLINE_AXES} coupled axes offline, not recorded", rate, "x real time", goal=28.0)
        show(f"cascade of {CASCADE_AXES} processes")
        machine, scenario = files(folder, CASCADE_AXES, lambda n: n - 1)
        record = str(folder / "run.mcap")
        run = run_graph(
            machine, None, scenario, seconds=effort.graph_seconds, record=record, free_run=False, composed=False
        )
    name = f"cascade of {CASCADE_AXES} axes"
    yield Figure(f"{name}: failures and errors", len(run.failures), "", goal=0.0, at_most=True)
    yield Figure(f"{name}: blocks lost", run.lost_blocks, "", goal=0.0, at_most=True)
    yield Figure(f"{name}: all nodes", sum(run.cpu.values()) / run.wall, "cores", goal=1.0, at_most=True)
    yield Figure(f"{name}: block lateness p50", run.lateness_p50_ms, "ms")
    yield Figure(f"{name}: block lateness p99", run.lateness_p99_ms, "ms", goal=10.0, at_most=True)
    yield Figure(f"{name}: block lateness, largest", run.lateness_max_ms, "ms")


def files(folder: Path, count: int, master_of: object) -> tuple[str, str]:
    """A machine of `count` axes like x, and a scenario that couples each but the first and moves that one for long."""
    source = yaml.load(Path(SOURCE).read_text(), yaml.BaseLoader)
    names = [f"a{number}" for number in range(count)]
    machine = source["/machine"]["ros__parameters"] | {"axes": names}
    text = [yaml.dump({"/machine": {"ros__parameters": machine}})]
    for number, name in enumerate(names, 1):
        own = source["/x"]["ros__parameters"] | {"kopf": {"achs_nr": str(number)}}
        text.append(yaml.dump({f"/{name}": {"ros__parameters": own}}))
    couplings = [
        f"- {{at: 0, to: a{n}, do: couple, master: a{master_of(n)}, factor: 0.99}}"  # type: ignore[operator]
        for n in range(1, count)
    ]
    move = "velocity: 1000, acceleration: 5000, deceleration: 5000, jerk: 50000"
    couplings.append(f"- {{at: 0, to: a0, do: move_absolute, target: 90000, {move}}}")
    paths = folder / f"{count}.yaml", folder / f"{count}_scenario.yaml"
    paths[0].write_text("".join(text).replace("'", ""))
    paths[1].write_text("\n".join(couplings))
    return str(paths[0]), str(paths[1])


def offline_rate(machine: str, scenario: str, seconds: float) -> float:
    """Machine time over wall time."""
    parameters = read_machine(machine)
    units = build_units(parameters, scenario=read_entries(parameters, program=None, scenario=scenario))
    offline = OfflineMachine(parameters, units)
    cycles = round(seconds * 1e6 / parameters.cycle_time_us)
    with stopwatch() as watch:
        for _ in offline.run(cycles=cycles):
            pass
    return seconds / watch.wall
