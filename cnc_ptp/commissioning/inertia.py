"""Inertia from torque and velocity: M = k·a + c·sign(v) + b·v + load, summed up over time.

Summing avoids differentiating the velocity: over a window of cycles 1 … n that does not change direction,
T·ΣM = k·(v_n - v_0) + c·(±nT) + b·(x_n - x_0) + load·nT; least squares give k in N (Nm) a mm/s² (deg/s²).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cnc_ptp.commissioning.trace import Array, AxisTrace

WINDOW = 0.01
"""Seconds of a window."""
LOWEST_PART = 0.05
"""Of the highest speed: slower windows are left out, there friction is no straight line."""
LEAST_WINDOWS = 20
LARGEST_UNCERTAINTY = 0.2


@dataclass(frozen=True, slots=True)
class InertiaFit:
    """`torque_per_acceleration` k in N (Nm) a mm/s² (deg/s²), its standard deviation, Coulomb part c in N (Nm)."""

    torque_per_acceleration: float
    deviation: float
    coulomb: float
    viscous: float
    """N (Nm) a mm/s (deg/s)."""


def fit_inertia(trace: AxisTrace) -> InertiaFit | None:
    """The inertia, or None where the recording holds no torque or not enough acceleration for it."""
    if trace.actual_torque is None or not np.any(trace.actual_torque):
        return None
    rows, impulses = _windows(trace, trace.actual_torque)
    if len(rows) < LEAST_WINDOWS:
        return None
    scale = np.maximum(np.sqrt(np.mean(rows**2, axis=0)), 1e-300)
    solution, _, rank, _ = np.linalg.lstsq(rows / scale, impulses, rcond=1e-9)
    if rank < rows.shape[1]:
        return None
    residuals = impulses - (rows / scale) @ solution
    variance = float(residuals @ residuals) / max(len(rows) - rows.shape[1], 1)
    deviations = np.sqrt(np.diag(np.linalg.inv((rows / scale).T @ (rows / scale))) * variance) / scale
    k, coulomb, viscous = (float(value) for value in (solution / scale)[:3])
    deviation = float(deviations[0])
    if k <= 0.0 or deviation > LARGEST_UNCERTAINTY * k:
        return None
    return InertiaFit(k, deviation, coulomb, viscous)


def _windows(trace: AxisTrace, torque: Array) -> tuple[Array, Array]:
    """Rows (change of velocity, ± time, way, time) and impulses of all usable windows."""
    velocity, step = trace.actual_velocity, max(2, round(WINDOW / trace.cycle_time))
    position = trace.actual_position
    if trace.mean_velocity:  # half a cycle older than its row, so let all be that old
        position, torque = _half_a_cycle_before(position), _half_a_cycle_before(torque)
    lowest = LOWEST_PART * float(np.max(np.abs(velocity)))
    rows, impulses = [], []
    for span_first, span_end in trace.unbroken():
        for first in range(span_first + 1, span_end - step, step):
            end = first + step
            part = velocity[first : end + 1]
            if np.min(np.abs(part)) < lowest or part[0] * part[-1] < 0.0:
                continue
            time = step * trace.cycle_time
            way = float(position[end] - position[first])
            rows.append((float(part[-1] - part[0]), np.sign(part[0]) * time, way, time))
            impulses.append(float(np.sum(torque[first + 1 : end + 1])) * trace.cycle_time)
    return np.array(rows).reshape(-1, 4), np.array(impulses)


def _half_a_cycle_before(values: Array) -> Array:
    return 0.5 * (values + np.concatenate([values[:1], values[:-1]]))
