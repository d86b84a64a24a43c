"""A linear axis that counts modulo (P-AXIS-00015 0x4) is like a rotary one: starts, soft limits, NC programs."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import pytest
from machine_support import MILL, MachineBench, UnitBench, axis_bench, machine

CONVEYOR = {"modulo": True, "modulo_low": 0.0, "modulo_high": 500.0}
LIMITS = {"soft_limit_negative": -math.inf, "soft_limit_positive": math.inf}


def conveyor() -> UnitBench:
    return axis_bench(**CONVEYOR, **LIMITS)


@pytest.mark.parametrize(
    ("position", "end"), [(120.0, 120.0), (-120.0, -380.0), (1250.0, 1250.0), (-1e-6, -500.0 + 1e-6), (500.0, 500.0)]
)
def test_modulo_start(position: float, end: float) -> None:
    bench = conveyor()
    bench.accepted("move_modulo", position=position)
    bench.run(3000)
    assert bench.last.set_position[-1] == pytest.approx(end, abs=1e-9)
    assert (bench.last.modulo_begin, bench.last.modulo_length) == (0.0, 500.0)


@pytest.mark.parametrize("seed", range(4))
def test_a_row_of_modulo_starts(seed: int) -> None:
    """Each ends at its station, in the direction of its sign, with the whole lengths asked for and less than one more."""
    choice, bench = random.Random(seed), conveyor()
    before = 0.0
    for _ in range(4):
        position = choice.choice([1, -1]) * choice.uniform(1.0, 1400.0)
        bench.accepted("move_modulo", position=position)
        bench.run(3000)
        end = bench.last.set_position[-1]
        lengths, station = divmod(Fraction(abs(position)), 500)
        assert float((Fraction(end) - station) / 500) == pytest.approx(round((end - float(station)) / 500), abs=1e-9)
        distance = math.copysign(1.0, position) * (end - before)
        assert 500.0 * lengths <= distance + 1e-6 and distance < 500.0 * (lengths + 1)
        before = end


def test_an_nc_program_moves_it_without_an_end() -> None:
    """As a rotary modulo axis: absolute targets are those of the endless position."""
    changed = machine(MILL, x={**CONVEYOR, **LIMITS})
    bench = MachineBench("%P\nG01 X1200 F60000\nG90 X0\nM30", machine=changed).run()
    assert not bench.failed
    assert max(bench.column("x", "set_position")) == pytest.approx(1200.0, abs=1e-6) and bench.position("x") == 0.0
