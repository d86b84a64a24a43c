"""The timing diagrams of function blocks: drawn from the run, by PLCopen's rules, in time with what the axis does."""

from __future__ import annotations

from functools import cache
from operator import attrgetter
from typing import Any

import numpy as np
import pytest
from figure_support import CYCLE_TIME, SCENARIOS, ramp_time, run_of, x
from plcopen_support import PlcBench

from cnc_ptp.machine.plc_file import read_plc
from cnc_ptp.parameters import read_machine
from figures.kinds import draw
from figures.picture import shown_cycles
from figures.run import Column
from figures.scenario_head import read_head

BLOCK = 10
"""Cycles of a PLC cycle."""
DIAGRAMS = [path.stem for path in sorted(SCENARIOS.glob("plc_*.yaml")) if read_head(path).signals]
MOVES = [name for name in DIAGRAMS if name.startswith("plc_move_")]
OUTPUTS = ("busy", "done", "in_velocity", "command_aborted", "error")


def signal(name: str, path: str) -> Column:
    """One value for each PLC cycle, 0 or 1."""
    values: Column = run_of(name).signals[path][::BLOCK]
    return values


def edges(name: str, path: str, *, rising: bool = True) -> list[int]:
    """PLC cycles in which a signal rises or falls."""
    steps = np.diff(signal(name, path), prepend=0.0)
    return [int(index) for index in np.flatnonzero(steps > 0.0 if rising else steps < 0.0)]


@cache
def seen_in_the_plc(name: str) -> dict[str, list[float]]:
    """The signals as the PLC itself sees them at the end of its calls, in a run of its own."""
    figure = read_head(SCENARIOS / f"{name}.yaml")
    seen: dict[str, list[float]] = {path: [] for path in figure.signals}
    make = read_plc(str(figure.plc_path)).make

    class Watched:
        def __init__(self, io: Any) -> None:
            self.plc = make(io)

        def cycle(self, io: Any) -> None:
            self.plc.cycle(io)
            for path, values in seen.items():
                values.append(float(bool(attrgetter(path)(self.plc))))

    PlcBench(Watched, figure.path.read_text(encoding="utf-8"), machine=read_machine(figure.machine_path)).run()
    return seen


@pytest.mark.parametrize("name", MOVES)
def test_signals_are_those_of_the_run(name: str) -> None:
    seen = seen_in_the_plc(name)
    assert {path: [*signal(name, path)] for path in seen} == seen
    assert run_of(name).signals.keys() == seen.keys() and any(max(values) for values in seen.values())


@pytest.mark.parametrize("name", DIAGRAMS)
def test_the_bars_of_a_diagram_are_its_signals(name: str) -> None:
    run = run_of(name)
    figure = draw(read_head(SCENARIOS / f"{name}.yaml"), run)
    plot = figure.axes[-1]
    end = shown_cycles(run)
    for row, (path, values) in enumerate(run.signals.items()):
        shown = np.zeros(end, dtype=bool)
        for bar in plot.collections[row].get_paths():
            (begin, _), (over, _) = bar.vertices.min(axis=0), bar.vertices.max(axis=0)
            shown[round(begin / CYCLE_TIME) : end if over > run.time[end - 1] - 1e-9 else round(over / CYCLE_TIME)] = (
                True
            )
        assert np.array_equal(shown, values[:end] > 0.0), path


@pytest.mark.parametrize("name", MOVES)
def test_outputs_exclude_each_other(name: str) -> None:
    """While execute is true exactly one is, apart from in_velocity, which goes with busy; active only with busy."""
    signals = run_of(name).signals
    for block in {path.partition(".")[0] for path in signals}:
        of_block = {path.partition(".")[2]: signals[path] for path in signals if path.startswith(f"{block}.")}
        ends = sum(of_block[output] for output in OUTPUTS if output in of_block and output != "in_velocity")
        assert np.max(ends) <= 1.0, block
        told = {"done", "command_aborted", "error"} <= of_block.keys()
        assert not told or np.all(ends[of_block["execute"] > 0.0] == 1.0), block
        for inner in ("active", "in_velocity"):
            assert inner not in of_block or np.all(of_block[inner] <= of_block["busy"])


def test_done_lasts_while_execute_is_true_and_for_one_call_if_it_fell_before() -> None:
    name = "plc_move_done"
    (first, second), (over, last) = edges(name, "first.done"), edges(name, "first.done", rising=False)
    assert over == edges(name, "first.execute", rising=False)[0] and first < over
    assert last == second + 1 and edges(name, "first.execute", rising=False)[1] < second


def test_one_after_the_other_and_one_over_the_other() -> None:
    name = "plc_move_sequence"
    done = edges(name, "first.done")[0]
    assert edges(name, "second.execute")[0] > done and x(name, "set_position")[done * BLOCK] == 500.0
    (aborted,) = edges(name, "first.command_aborted")
    assert aborted == edges(name, "second.active")[1] == edges(name, "first.busy", rising=False)[1]
    assert aborted == edges(name, "second.execute")[1] + 1
    assert abs(x(name, "set_velocity")[aborted * BLOCK]) > 900.0  # on the fly
    assert edges(name, "first.command_aborted", rising=False) == edges(name, "first.execute", rising=False)[1:]
    assert len(edges(name, "second.done")) == 2 and x(name, "set_position")[-1] == 800.0
    whole = 500.0 / 1000.0 + ramp_time(1000.0, 5000.0, 50_000.0)
    assert (done - edges(name, "first.execute")[0]) * BLOCK * CYCLE_TIME == pytest.approx(whole, abs=0.021)


@pytest.mark.parametrize(("name", "velocity"), [("plc_move_buffered", 0.0), ("plc_move_blended", 400.0)])
def test_the_velocity_where_the_second_takes_over(name: str, velocity: float) -> None:
    (taken,) = edges(name, "second.active")
    assert taken == edges(name, "first.done")[0] and edges(name, "second.busy")[0] < taken
    at_500 = int(np.argmax(x(name, "set_position") >= 500.0 - 1e-9))
    assert x(name, "set_velocity")[at_500] == pytest.approx(velocity, abs=1e-6)
    assert 0 <= taken * BLOCK - at_500 <= 2 * BLOCK
    assert x(name, "set_position")[-1] == 800.0


def test_in_velocity_is_the_commanded_velocity_times_the_override() -> None:
    """A PLC cycle shows the last cycle of the block before; the block from which the positioning acts ends it."""
    name = "plc_move_velocity"
    velocity, override = x(name, "set_velocity"), x(name, "override_percent")
    reached = np.abs(velocity - 400.0 * override / 100.0) < 1e-6
    (aborted,) = edges(name, "turn.command_aborted")
    shown = np.concatenate([[False], reached[BLOCK - 1 :: BLOCK]])[:aborted]
    assert np.array_equal(signal(name, "turn.in_velocity")[:aborted] > 0.0, shown)
    assert len(edges(name, "turn.in_velocity")) == 3
    assert edges(name, "turn.execute", rising=False)[0] < edges(name, "turn.in_velocity", rising=False)[0]
    assert edges(name, "turn.command_aborted", rising=False) == [aborted + 1]
    assert aborted == edges(name, "first.active")[0] and x(name, "set_position")[-1] == 1000.0


def test_a_block_that_is_started_again_tells_of_the_new_motion_only() -> None:
    name = "plc_move_again"
    _, again = edges(name, "first.execute")
    assert edges(name, "first.busy") == [edges(name, "first.execute")[0]]
    assert edges(name, "first.active", rising=False)[0] == again and edges(name, "first.active")[1] == again + 1
    assert not signal(name, "first.command_aborted").any() and len(edges(name, "first.done")) == 1
    assert x(name, "set_position")[-1] == 200.0


def test_an_aborted_motion_and_an_error() -> None:
    name = "plc_move_aborted"
    assert edges(name, "first.command_aborted") == edges(name, "halt.active") == [edges(name, "halt.execute")[0] + 1]
    name = "plc_move_error"
    error = edges(name, "first.error")
    assert error == [edges(name, "first.execute")[1]] and signal(name, "stop.execute")[error[0]] == 1.0
    assert edges(name, "first.error", rising=False) == [edges(name, "first.execute", rising=False)[1]]
    assert len(edges(name, "first.done")) == 1 and x(name, "set_position")[-1] == 500.0


def test_the_reference_is_set_while_the_drive_is_commanded() -> None:
    """TX1250 4.2: the reference point lies at 100 mm once S-0-0403 is 1, and the axis ends 20 mm behind it."""
    name = "plc_sercos_homing"
    [begin], [end] = edges(name, "commanded"), edges(name, "commanded", rising=False)
    [reference] = edges(name, "referenced")
    position = x(name, "set_position")
    jump = int(np.argmax(np.abs(np.diff(position))))
    assert begin < jump // BLOCK <= reference < end
    assert position[jump + 1] == pytest.approx(100.0, abs=0.01) and position[-1] == pytest.approx(120.0)
    assert np.abs(np.diff(position[: end * BLOCK])).max() == pytest.approx(np.abs(np.diff(position)).max())
