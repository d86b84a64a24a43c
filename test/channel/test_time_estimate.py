"""The times of a program before it runs, against its run: linked blocks, exact stops, dwells, cycles."""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from long_support import long
from machine_support import CYCLE_TIME, MILL, MachineBench

from cnc_ptp.channel import time_estimate
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.program_files import read_program
from cnc_ptp.machine.run_entries import program_search, read_entries
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.nc.canonical import Dwell
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.channel_states import ChannelStateCode

PROJECT = Path(__file__).parents[2]
STARTS = (
    [],
    ["G60"],
    ["G359"],
    ["#CONTOUR MODE [DEV PATH_DEV=0.02]", "G261"],
    ["#CONTOUR MODE [DEV PATH_DEV=0.3]", "G261"],
    ["#HSC ON [BSPLINE PATH_DEV=0.01]"],
    ["#SLOPE [TYPE=STEP]"],
)


def random_lines(numbers: random.Random) -> Iterator[str]:
    """Lines long and short, arcs, rapid traverse, dwells, other feeds."""
    yield from numbers.choice(STARTS)
    yield f"G01 X{numbers.uniform(1.0, 20.0):.3f} F{numbers.choice([500, 2000, 6000])}"
    x = y = 20.0
    for _ in range(numbers.randint(3, 12)):
        kind = numbers.random()
        if kind < 0.1:
            yield f"G04 X{numbers.uniform(0.05, 0.5):.2f}"
        elif kind < 0.25:
            yield f"G00 X{numbers.uniform(0.0, 60.0):.3f} Y{numbers.uniform(0.0, 60.0):.3f} Z{numbers.uniform(0, 9):.3f}"
        elif kind < 0.35:
            yield f"G01 F{numbers.choice([300, 1000, 3000, 6000])}"
        elif kind < 0.5:
            radius = numbers.uniform(1.0, 10.0)
            yield f"G91 G0{numbers.choice('23')} X{2.0 * radius:.4f} Y0 I{radius:.4f} J0"
            yield "G90"
        else:
            step = numbers.choice([0.2, 2.0, 15.0])
            for _ in range(numbers.randint(1, 12)):
                x = min(60.0, max(0.0, x + numbers.uniform(-step, step)))
                y = min(60.0, max(0.0, y + numbers.uniform(-step, step)))
                yield f"G01 X{x:.3f} Y{y:.3f}"


def program(*lines: str) -> str:
    return "\n".join(["%P", *lines, "M30"])


def estimate(bench: MachineBench) -> float:
    """Time left as the first block with the program shows it, s."""
    return next(block.time_left for block in bench.blocks["channel"] if block.time_left > 0.0)


def assert_progress(bench: MachineBench) -> None:
    """Percentage and time left never go back, and end at 100 % and 0 s."""
    blocks = [block for block in bench.blocks["channel"] if block.state[0] != ChannelStateCode.IDLE]
    share, left = [block.progress for block in blocks], [block.time_left for block in blocks if block.time_left >= 0.0]
    assert all(one <= other for one, other in pairwise(share))
    assert all(one >= other for one, other in pairwise(left[1:]))
    assert (share[-1], left[-1]) == (1.0, 0.0)


@pytest.mark.parametrize("seed", [0, *long([3, 1, 2, *range(4, 30)])])
def test_random_programs_take_as_long_as_estimated(seed: int) -> None:
    bench = MachineBench(program(*random_lines(random.Random(seed)))).run()
    assert bench.events == []
    done = [block.done for block in bench.blocks["channel"]]
    cycles = max(place for place, finished in enumerate(done) if not finished) * MILL.block_cycles
    last = bench.blocks["channel"][cycles // MILL.block_cycles].state.count(ChannelStateCode.RUNNING)
    run = (cycles + last) * CYCLE_TIME
    assert estimate(bench) == pytest.approx(run, rel=0.03, abs=0.03)
    assert_progress(bench)


@pytest.mark.parametrize(
    ("machine", "file", "dialect"),
    [
        pytest.param("config/mill.yaml", "bracket.nc", None, marks=pytest.mark.long),
        pytest.param("config/mill.yaml", "pocket.nc", None, marks=pytest.mark.long),
        pytest.param("config/mill.yaml", "plate.ngc", "iso", marks=pytest.mark.long),
        pytest.param("config/lathe.yaml", "lathe.nc", None, marks=pytest.mark.long),
        pytest.param("config/lathe.yaml", "turning.nc", None, marks=pytest.mark.long),
    ],
)
def test_examples_take_as_long_as_estimated(machine: str, file: str, dialect: str | None) -> None:
    """The cycles in which an axis moves, and the dwells: how long spindles and PLC let wait is not known before."""
    parameters, path = read_machine(str(PROJECT / machine)), str(PROJECT / "examples" / file)
    channel = next(iter(parameters.channels.values()))
    bench = MachineBench(machine=parameters)
    bench.units = build_units(
        parameters, scenario=read_entries(parameters, program=path, scenario=None, dialect=dialect)
    )
    bench.offline = OfflineMachine(parameters, bench.units)
    bench.run()
    moving = np.any([np.array(bench.column(axis.node, "set_velocity")) != 0.0 for axis in channel.axes], axis=0)
    unit = bench.units[channel.name]
    unit.prepare(file, *read_program(path, program_search(parameters)), dialect)
    dwells = [
        block.motion.seconds for block in unit._programs._prepared.known.blocks if isinstance(block.motion, Dwell)
    ]
    run = np.count_nonzero(moving) * parameters.cycle_time_us * 1e-6 + sum(dwells)
    assert estimate(bench) == pytest.approx(run, rel=0.02)
    assert_progress(bench)


def estimated(text: str) -> tuple[float, float]:
    """Seconds of a program: as it is estimated, and planned as a whole."""
    unit = MachineBench(text, start=False).units["channel"]
    unit.prepare("test.nc", text)
    known, start, estimate = (
        unit._programs._prepared.known.blocks,
        unit._programs._prepared.start,
        unit._programs._estimate,
    )
    places = time_estimate.places_of(known, start)
    return sum(estimate.seconds(known, start)), sum(estimate._planned(known, places, estimate._sketch(known, places)))


@pytest.mark.interpreted
def test_windows_of_a_long_program_are_planned(monkeypatch: pytest.MonkeyPatch) -> None:
    """A long program of parts of every kind: within 10 %."""
    monkeypatch.setattr(time_estimate, "BUDGET", 3000.0)
    monkeypatch.setattr(time_estimate, "WINDOW", 300.0)
    numbers = random.Random(1)
    parts = [["#HSC OFF", "G260", "#SLOPE [TYPE=TRAPEZ]", *random_lines(numbers)] for _ in range(12)]
    sampled, planned = estimated(program(*(line for part in parts for line in part)))
    assert sampled == pytest.approx(planned, rel=0.1)
    assert sampled != planned
