"""Inertia from torque and velocity: M = k·a + c·sign(v) + b·v + load, summed up over time.

Summing avoids differentiating the velocity: over a window of cycles 1 … n that does not change direction,
T·ΣM = k·(v_n - v_0) + c·(±nT) + b·(x_n - x_0) + load·nT; least squares give k in N (Nm) a mm/s² (deg/s²).
Friction is no straight line at low speeds, so the windows contradict each other more than noise would have it: how much
k differs between speeding up and slowing down, and between slow and fast, belongs to its deviation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cnc_ptp.commissioning.trace import Array, AxisTrace, Span

WINDOW = 0.01
"""Seconds of a window."""
LOWEST_PART = 0.05
"""Of the highest speed: slower windows are left out, there friction is no straight line."""
LEAST_TIME = 0.2
"""Seconds that all windows together must begin in."""
CORRELATED = 0.05
"""Seconds after which what the model does not explain is taken for independent."""
CHANGING = 0.2
"""Part of the largest change of velocity above which a window says something about the inertia."""
LARGEST_UNCERTAINTY = 0.2


@dataclass(frozen=True, slots=True)
class InertiaFit:
    """`torque_per_acceleration` k in N (Nm) a mm/s² (deg/s²), its deviation, Coulomb part c in N (Nm)."""

    torque_per_acceleration: float
    deviation: float
    coulomb: float
    viscous: float
    """N (Nm) a mm/s (deg/s)."""


@dataclass(frozen=True, slots=True)
class _Windows:
    """Rows (change of velocity, ± time, way, time) (n, 4) and impulses (n,) of windows that begin in cycles (n,)."""

    cycles: Array
    rows: Array
    impulses: Array


def fit_inertia(trace: AxisTrace) -> InertiaFit | None:
    """The inertia, or None where the recording holds no torque or not enough acceleration for it."""
    if trace.actual_torque is None or not np.any(trace.actual_torque):
        return None
    windows = _windows(trace, trace.actual_torque)
    if len(windows.rows) * trace.cycle_time < LEAST_TIME:
        return None
    solution, rank = _solve(windows.rows, windows.impulses)
    if rank < len(solution):
        return None
    k, coulomb, viscous = (float(value) for value in solution[:3])
    block = max(1, round(CORRELATED / trace.cycle_time))
    deviation = math.hypot(_scatter(windows, solution, block), _contradiction(windows))
    if k <= 0.0 or deviation > LARGEST_UNCERTAINTY * k:
        return None
    return InertiaFit(k, deviation, coulomb, viscous)


def _solve(rows: Array, impulses: Array) -> tuple[Array, int]:
    """Least squares solution and rank of the columns, each brought to the size 1."""
    scale = np.maximum(np.sqrt(np.mean(rows**2, axis=0)), 1e-300)
    solution, _, rank, _ = np.linalg.lstsq(rows / scale, impulses, rcond=1e-9)
    return solution / scale, int(rank)


def _scatter(windows: _Windows, solution: Array, block: int) -> float:
    """Standard deviation of k; residuals of windows that begin within `block` cycles may be alike (sandwich)."""
    scale = np.sqrt(np.mean(windows.rows**2, axis=0))
    scaled = windows.rows / scale
    scores = scaled * (windows.impulses - windows.rows @ solution)[:, None]
    starts = np.flatnonzero(np.diff(windows.cycles // block, prepend=-1.0))
    sums = np.add.reduceat(scores, starts, axis=0)
    weights = np.linalg.inv(scaled.T @ scaled)[0]
    return float(np.sqrt(np.sum((sums @ weights) ** 2)) / scale[0])


def _contradiction(windows: _Windows) -> float:
    """Half the difference of k between speeding up and slowing down, and between slow and fast, both together."""
    rows = windows.rows
    changing = np.abs(rows[:, 0]) >= CHANGING * np.max(np.abs(rows[:, 0]))
    way = np.abs(rows[:, 2])
    faster = np.where(rows[:, 0] * rows[:, 1] > 0.0, 1.0, -1.0)
    fast = np.where(way > np.median(way[changing]), 1.0, -1.0)
    sides = [side for side in (faster, fast) if np.ptp(side[changing]) > 0.0]
    columns = np.column_stack([rows, *(rows[:, 0] * side for side in sides)])
    return math.hypot(*_solve(columns, windows.impulses)[0][rows.shape[1] :])


def _windows(trace: AxisTrace, torque: Array) -> _Windows:
    """All windows of WINDOW seconds in one direction and fast enough, one beginning in each cycle."""
    velocity, step = trace.actual_velocity, max(2, round(WINDOW / trace.cycle_time))
    position, time = trace.actual_position, step * trace.cycle_time
    if trace.mean_velocity:  # half a cycle older than its row, so let all be that old
        position, torque = _half_a_cycle_before(position), _half_a_cycle_before(torque)
    first = np.concatenate([_one_way(velocity, span, step) for span in trace.unbroken()])
    end = first + step
    impulse = np.cumsum(torque) * trace.cycle_time
    rows = np.column_stack(
        [
            velocity[end] - velocity[first],
            np.sign(velocity[first]) * time,
            position[end] - position[first],
            np.full(len(first), time),
        ]
    )
    return _Windows(trace.cycle[first].astype(np.float64), rows, impulse[end] - impulse[first])


def _one_way(velocity: Array, span: Span, step: int) -> npt.NDArray[np.intp]:
    """Where windows of `step` cycles begin that are fast enough and do not turn back; not in the first cycle."""
    lowest = LOWEST_PART * float(np.max(np.abs(velocity)))
    part = velocity[span[0] + 1 : span[1]]
    signs = np.concatenate([[0.0], np.cumsum(np.where(np.abs(part) >= lowest, np.sign(part), 0.0))])
    return np.flatnonzero(np.abs(signs[step + 1 :] - signs[: -step - 1]) == step + 1) + span[0] + 1


def _half_a_cycle_before(values: Array) -> Array:
    before: Array = 0.5 * (values + np.concatenate([values[:1], values[:-1]]))
    return before
