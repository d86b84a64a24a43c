"""Spindles on the bench: what they did in which cycle, drives that do not do what they should."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from machine_support import CYCLE_TIME, UnitBench, changed_gear, spindle_parameters

from cnc_ptp.control.drives import FirstOrderDrive
from cnc_ptp.parameters import SpindleParameters
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.spindle.spindle_unit import SpindleUnit

RPM = 6.0
"""°/s."""
UP, DOWN = 36_000.0, 40_000.0
"""Acceleration and deceleration of the spindle of config/mill.yaml, °/s²."""


def bench_of(parameters: SpindleParameters, *, count: int = 10, **options: Any) -> UnitBench:
    return UnitBench(SpindleUnit(parameters, cycle_time=CYCLE_TIME, **options), count=count)


def two_gears(*, gear: int = 1, second: Mapping[str, Any] | None = None, **changes: Any) -> SpindleParameters:
    """Gears 1 and 2; the changes count for both, `second` for gear 2 only."""
    parameters = spindle_parameters(gear=gear, **changes)
    first = replace(next(iter(parameters.gears.values())), stage=1)
    return replace(parameters, gears={1: first, 2: changed_gear(first, stage=2, **(second or {}))})


def states(bench: UnitBench) -> list[S]:
    """The states in their order, each once in a row."""
    column = bench.column("state")
    return [S(state) for state, before in zip(column, [None, *column], strict=False) if state != before]


def first_cycle(bench: UnitBench, name: str, wanted: Callable[[Any], bool], begin: int = 0) -> int:
    """The first cycle from `begin` on in which a column is as wanted."""
    return next(cycle for cycle, value in enumerate(bench.column(name)) if cycle >= begin and wanted(value))


def trapezoid(distance: float, speed: float) -> float:
    """Seconds of a positioning from rest to rest at constant acceleration and deceleration."""
    reached = min(speed, (2.0 * distance * UP * DOWN / (UP + DOWN)) ** 0.5)
    ramps = 0.5 * reached**2 * (1.0 / UP + 1.0 / DOWN)
    return reached / UP + reached / DOWN + (distance - ramps) / reached


def assert_reached_in_windows(bench: UnitBench, *, window: float, zero_rpm: float, hold: int) -> None:
    """Each rising edge of in_position has `hold` cycles within both windows behind it; the bit is on in the window only."""
    column = bench.columns()
    away = [t - a for t, a in zip(column["target_position_deg"], column["actual_position_deg"], strict=True)]
    within = [
        abs(a) <= window * (1 + 1e-9) and abs(v) <= zero_rpm * (1 + 1e-9)
        for a, v in zip(away, column["actual_speed_rpm"], strict=True)
    ]
    there = column["in_position"]
    for k, on in enumerate(there):
        if on and not there[k - 1]:
            assert all(within[k - hold : k + 1]), f"cycle {k}"
        assert not on or (abs(away[k]) <= window * (1 + 1e-9) and column["state"][k] == S.STANDSTILL)
    assert any(there) or bench.events


class StuckDrive(FirstOrderDrive):
    """A drive that shows where it is but no longer turns once it is `stuck`."""

    __slots__ = ("limit", "stuck")

    def __init__(self, *, stuck: bool = True, limit: float = float("inf")) -> None:
        self.stuck = stuck
        self.limit = limit
        super().__init__(cycle_time=CYCLE_TIME, time_constant=0.0, encoder_increment=0.0)

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        bounded = max(-self.limit, min(self.limit, command))
        super().step(0.0 if self.stuck else bounded)
