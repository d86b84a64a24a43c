"""Inertia from torque and velocity: M = k·a + c·sign(v) + b·v + load, summed up over time.

Summing avoids differentiating the velocity: over a window of cycles 1 … n that does not change direction,
T·ΣM = k·(v_n - v_0) + c·(±nT) + b·(x_n - x_0) + load·nT + d·(M_n - M_0); d is the time by which the torque is older
than its row, as far as the sum is. The measured columns are noisy, which would draw k towards 0 in a least squares
fit. So each has an instrument, the same column of the set velocity, behind the lag of its
position loop, which knows nothing of that noise: Zᵀ·(columns·solution - impulses) = 0.
Friction is no straight line at low speeds, so the windows contradict each other more than noise would have it: how much
k differs between speeding up and slowing down, and between slow and fast, belongs to its deviation.
A drive may report the torque at the end of each cycle instead of the mean of it, then d is T/2 more. As the command is
held, the torque has a ripple of period T in a ramp, of which such samples see one phase only: k comes out too small,
and no other k fits better. The ripple bends d, too: behind a filter Ta of the command k lacks T/Ta·|1/2 - d/T| of
itself if the current follows immediately (Euler-Maclaurin: k·Kp·T²/(12·Ta), d by Kp·T²/12), less where it lags. That
much belongs to the deviation.
Source: instrumental variables, Söderström and Stoica, System Identification, 8.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.signal import lfilter

from cnc_ptp.commissioning.trace import Array, AxisTrace, Span

WINDOW = 0.01
"""Seconds of a window."""
LOWEST_PART = 0.05
"""Of the highest speed: slower windows are left out, there friction is no straight line."""
LEAST_TIME = 0.2
"""Seconds in which all windows together must start."""
CORRELATED = 0.1
"""Seconds after which residuals of the model are taken for independent."""
CHANGING = 0.2
"""Part of the largest change of velocity above which a window is used for the inertia."""
LARGEST_UNCERTAINTY = 0.3
LAGS = np.concatenate([[0.0], np.geomspace(5e-4, 0.5, 40)])
"""Seconds; lags of the position loop that are tried."""
RANK = 1e-7
SURE = 2.5
"""Standard deviations that hold the truth in 95 % of runs; the digits of a torque are no noise, for that 2 would do."""
MOMENTARY = 0.25
"""Cycles off T/2 below which the age of the torque is that of a momentary value, else of the mean of a cycle."""
LARGEST_BEND = 1.0 / 12.0
"""Cycles by which the ripple bends the age where Kp = 1/T; noise alone is not taken for a faster drive."""


@dataclass(frozen=True, slots=True)
class InertiaFit:
    """`torque_per_acceleration` k in N (Nm) a mm/s² (deg/s²), its deviation, Coulomb part c in N (Nm).

    `deviation`: SURE standard deviations, by how much the windows contradict each other, and what the ripple of the
    held command may hide from a drive that reports momentary torques.
    """

    torque_per_acceleration: float
    deviation: float
    coulomb: float
    viscous: float
    """N (Nm) a mm/s (deg/s)."""


@dataclass(frozen=True, slots=True)
class _Windows:
    """Rows (change of velocity, ± time, distance, time, change of torque) (n, 5) and impulses (n,) of windows.

    They begin in cycles (n,); `instruments` (n, 5) are the rows of the set velocity.
    """

    cycles: Array
    rows: Array
    instruments: Array
    impulses: Array


def fit_inertia(trace: AxisTrace, *, time_constant: float) -> InertiaFit | None:
    """The inertia, or None if the recording holds no torque or not enough acceleration for it.

    `time_constant`: s, the lag of the drive behind its command.
    """
    if trace.actual_torque is None or not np.any(trace.actual_torque):
        return None
    windows = _windows(trace, trace.actual_torque)
    if len(windows.rows) * trace.cycle_time < LEAST_TIME:
        return None
    inverse = _inverse(windows.instruments, windows.rows)
    if inverse is None:
        return None
    solution = inverse @ (windows.instruments.T @ windows.impulses)
    k, coulomb, viscous = (float(value) for value in solution[:3])
    block = max(1, round(CORRELATED / trace.cycle_time))
    scatter = [_scatter(windows, solution, weights, block) for weights in inverse]
    ripple = k * _ripple(solution[-1], 2.0 * scatter[-1], trace, time_constant)
    deviation = math.hypot(SURE * scatter[0], _contradiction(windows), ripple)
    if k <= 0.0 or deviation > LARGEST_UNCERTAINTY * k:
        return None
    return InertiaFit(k, deviation, coulomb, viscous)


def _inverse(instruments: Array, rows: Array) -> Array | None:
    """(Zᵀ·X)⁻¹; None if the columns do not differ."""
    product = instruments.T @ rows
    scale = np.sqrt(np.mean(rows**2, axis=0)), np.sqrt(np.mean(instruments**2, axis=0))
    if not (np.all(scale[0]) and np.all(scale[1])):
        return None
    scaled = product / np.outer(scale[1], scale[0]) / len(rows)
    if np.linalg.matrix_rank(scaled, tol=RANK) < len(scaled):
        return None
    inverse: Array = np.linalg.inv(scaled) / np.outer(scale[0], scale[1]) / len(rows)
    return inverse


def _scatter(windows: _Windows, solution: Array, weights: Array, block: int) -> float:
    """Standard deviation of the unknown with these weights.

    Residuals of windows that begin within `block` cycles may be alike (sandwich).
    """
    scores = windows.instruments @ weights * (windows.impulses - windows.rows @ solution)
    starts = np.flatnonzero(np.diff(windows.cycles // block, prepend=-1.0))
    sums = np.add.reduceat(scores, starts)
    freedom = max(1, len(sums) - len(solution))
    return float(np.sqrt(np.sum(sums**2) * len(sums) / freedom))


def _ripple(age: float, spread: float, trace: AxisTrace, time_constant: float) -> float:
    """Part of k that momentary torques may lack, 0.0 if the torque is as old as a mean of the cycle; ages in s."""
    cycles = age / trace.cycle_time - (0.5 if trace.mean_velocity else 0.0)
    off = abs(cycles % 1.0 - 0.5)
    if off >= MOMENTARY:
        return 0.0
    unsure = spread / trace.cycle_time
    part = min(off + unsure, max(off - unsure, LARGEST_BEND))
    return part * trace.cycle_time / time_constant if time_constant else math.inf


def _contradiction(windows: _Windows) -> float:
    """Half the difference of k between speeding up and slowing down, and between slow and fast, both together."""
    rows, instruments = windows.rows, windows.instruments
    change, distance = instruments[:, 0], np.abs(instruments[:, 2])
    changing = np.abs(change) >= CHANGING * np.max(np.abs(change))
    faster = np.where(change * instruments[:, 1] > 0.0, 1.0, -1.0)
    fast = np.where(distance > np.median(distance[changing]), 1.0, -1.0)
    sides = [side for side in (faster, fast) if np.ptp(side[changing]) > 0.0]
    columns, wanted = (
        np.column_stack([values, *(values[:, 0] * side for side in sides)]) for values in (rows, instruments)
    )
    inverse = _inverse(wanted, columns)
    if inverse is None:
        return math.inf
    return math.hypot(*(inverse @ (wanted.T @ windows.impulses))[rows.shape[1] :])


def _windows(trace: AxisTrace, torque: Array) -> _Windows:
    """All windows of WINDOW seconds in one direction and fast enough, one beginning in each cycle."""
    wanted, step = _wanted_velocity(trace), max(2, round(WINDOW / trace.cycle_time))
    position, time = trace.actual_position, step * trace.cycle_time
    if trace.mean_velocity:  # half a cycle older than its row, so let the position be that old
        position = 0.5 * (position + np.concatenate([position[:1], position[:-1]]))
    first = np.concatenate([_one_way(trace.actual_velocity, wanted, span, step) for span in trace.unbroken()])
    end = first + step
    direction, constant = np.sign(wanted[first]) * time, np.full(len(first), time)

    def change(values: Array) -> Array:
        changed: Array = values[end] - values[first]
        return changed

    impulse, distance = np.cumsum(torque) * trace.cycle_time, np.cumsum(wanted) * trace.cycle_time
    rows = [change(trace.actual_velocity), direction, change(position), constant, change(torque)]
    instruments = [change(wanted), direction, change(distance), constant, change(np.gradient(wanted))]
    return _Windows(
        trace.cycle[first].astype(np.float64), np.column_stack(rows), np.column_stack(instruments), change(impulse)
    )


def _wanted_velocity(trace: AxisTrace) -> Array:
    """The set velocity behind that lag of first order which makes it most like the actual one."""
    spans = list(trace.unbroken())
    candidates = (_lagged(trace.set_velocity, spans, lag / trace.cycle_time) for lag in LAGS)
    return min(candidates, key=lambda velocity: float(np.sum((velocity - trace.actual_velocity) ** 2)))


def _lagged(velocity: Array, spans: list[Span], cycles: float) -> Array:
    """Each stretch without gaps behind a lag of so many cycles, settled at its start."""
    pole = math.exp(-1.0 / cycles) if cycles else 0.0
    parts = [velocity[first:end] for first, end in spans]
    lagged = [lfilter([1.0 - pole], [1.0, -pole], part, zi=[pole * part[0]])[0] for part in parts]
    joined: Array = np.concatenate(lagged)
    return joined


def _one_way(velocity: Array, wanted: Array, span: Span, step: int) -> npt.NDArray[np.intp]:
    """Where windows of `step` cycles begin that are fast enough and do not turn back; not in the first cycle.

    The set velocity decides which are fast enough, as the actual one is noisy.
    """
    lowest = LOWEST_PART * float(np.max(np.abs(wanted)))
    part, direction = wanted[span[0] + 1 : span[1]], np.sign(velocity[span[0] + 1 : span[1]])
    good = (np.abs(part) >= lowest) & (np.sign(part) == direction)
    signs = np.concatenate([[0.0], np.cumsum(np.where(good, direction, 0.0))])
    return np.flatnonzero(np.abs(signs[step + 1 :] - signs[: -step - 1]) == step + 1) + span[0] + 1
