"""Axes with compensation and external setpoints on the bench, and what nobody may see on them: steps."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from machine_support import CYCLE_TIME, UnitBench, axis_bench, position_after, seven_phases
from scipy.interpolate import CubicHermiteSpline

A, J = 5000.0, 50000.0
"""Acceleration and jerk of the axis of the bench."""
SetpointRow = list[float]
"""Cycle, position, velocity, acceleration, direction."""
HAS_JOB, COMPENSATING, EXTERNAL, IN_TARGET = 1 << 8, 1 << 13, 1 << 14, 1 << 4


def column(bench: UnitBench, name: str) -> np.ndarray:
    return np.array(bench.column(name), dtype=float)


def has_bit(bench: UnitBench, bit: int) -> np.ndarray:
    return np.array(bench.column("status_bits")) & bit != 0


def moving_axis(
    *, target: float = 10_000.0, velocity: float = 2000.0, cycles: int = 1000, count: int = 10, **changes: Any
) -> UnitBench:
    """An axis `cycles` after its start from 0 to `target`."""
    bench = axis_bench(count=count, **changes)
    bench.accepted("move_absolute", target=target, velocity=velocity)
    if cycles:
        bench.run(cycles)
    return bench


def settle(bench: UnitBench, cycles: int = 12_000) -> UnitBench:
    """Runs until the axis is at a standstill and has no job (at most `cycles` more), and 100 cycles on."""
    for _ in range(cycles // 500):
        bench.run(500)
        if bench.column("set_velocity")[-1] == 0.0 and bench.state in (0, 1, 7):
            break
    bench.run(100)
    return bench


def basic_velocity(bench: UnitBench) -> CubicHermiteSpline:
    """v(t) between the cycles of a bench without superposition (cubic, so exact for constant jerk)."""
    v, a = column(bench, "set_velocity"), column(bench, "set_acceleration")
    return CubicHermiteSpline(np.arange(len(v)) * CYCLE_TIME, v, a)


def start_ramp(velocity: float, t: np.ndarray) -> np.ndarray:
    """v(t) of the jerk-limited start to `velocity` with A and J, in closed form."""
    phases = seven_phases(1e6, velocity, A, A, J)
    return np.array([position_after(phases, x)[1] for x in t])


def assert_no_steps(bench: UnitBench, *, acceleration: float, jerk: float, corners: int) -> None:
    """Velocity is the integral of an acceleration within `acceleration`, position that of the velocity.

    The acceleration itself may step in `corners` cycles; in the others it changes by at most `jerk`·T.
    """
    p, v, a = (column(bench, f"set_{name}") for name in ("position", "velocity", "acceleration"))
    t = CYCLE_TIME
    slack = 1e-9 * (1.0 + np.abs(v[1:]))
    assert np.abs(a).max() <= acceleration * (1.0 + 1e-9)
    assert (np.abs(np.diff(v)) <= acceleration * t * (1.0 + 1e-9) + slack).all()
    way = np.diff(p) - 0.5 * t * (v[1:] + v[:-1])
    assert (np.abs(way) <= 0.25 * acceleration * t * t + 1e-11 * (1.0 + np.abs(p[1:]))).all()
    stepping = np.abs(np.diff(a)) > jerk * t * (1.0 + 1e-9) + 1e-6
    assert np.count_nonzero(stepping) <= corners
    change = np.abs(np.diff(v) - 0.5 * t * (a[1:] + a[:-1]))[~stepping]
    assert np.count_nonzero(change > 0.25 * jerk * t * t + slack[~stepping]) <= corners


def generator(
    way: float, *, first_cycle: int, velocity: float = 1000.0, a: float = 4000.0, every: int = 1, start: float = 0.0
) -> list[SetpointRow]:
    """The manual's example: three phases with rectangular acceleration, direction set one cycle longer on each side."""
    sign, ramp = float(np.sign(way)), velocity / a
    seconds = abs(way) / velocity + ramp
    rows = [[first_cycle, start, 0.0, 0.0, sign]]
    for k in range(round(seconds / CYCLE_TIME) + 1):
        t = k * CYCLE_TIME
        left = seconds - t
        if t < ramp - 1e-9:
            p, v, acceleration = 0.5 * a * t * t, a * t, a
        elif left > ramp + 1e-9:
            p, v, acceleration = velocity * (t - 0.5 * ramp), velocity, 0.0
        else:
            p, v, acceleration = abs(way) - 0.5 * a * left * left, a * left, -a if left > 1e-9 else 0.0
        rows.append([first_cycle + 1 + k, start + sign * p, sign * v, sign * acceleration, sign])
    end = rows[-1][0]
    rows += [[end + 1, start + way, 0.0, 0.0, sign], [end + 2, start + way, 0.0, 0.0, 0]]
    return [row for row in rows if every == 1 or (row[0] - first_cycle) % every == 0 or row[4] == 0]


def feed(bench: UnitBench, rows: Iterable[SetpointRow], cycles: int) -> None:
    """Runs `cycles` with each block's rows given before it, as the PLC does."""
    rows, end = list(rows), bench.cycle + cycles
    while bench.cycle < end:
        block_end = min(bench.cycle + bench.count, end)
        part = [row for row in rows if bench.cycle <= row[0] < block_end]
        if part:
            bench.accepted("external_setpoints", setpoints=part)
        bench.run(block_end - bench.cycle)


def external_axis(mode: str = "absolute", *, cycles: int = 10, count: int = 10, **changes: Any) -> UnitBench:
    bench = axis_bench(count=count, **changes)
    bench.accepted("external_enable", mode=mode)
    if cycles:
        bench.run(cycles)
    return bench


def setpoints(bench: UnitBench, rows: list[SetpointRow]) -> list[tuple[float, ...]]:
    """(position, velocity, acceleration) that the axis had in the cycles of `rows`."""
    columns = [bench.column(f"set_{name}") for name in ("position", "velocity", "acceleration")]
    return [tuple(values[int(row[0])] for values in columns) for row in rows]
