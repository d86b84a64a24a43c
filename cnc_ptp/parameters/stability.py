"""The gain at which a position loop becomes unstable, from the parameters of its drive."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.linalg import expm

from cnc_ptp.parameters.control_view import PlantParameters
from cnc_ptp.parameters.plant_model import U, V, X, velocity_controlled

SPEED_STATES = 5
BISECTIONS = 40


def is_stable(plant: PlantParameters, kv: float, cycle_time: float) -> bool:
    """All poles of the sampled loop lie inside the unit circle; `kv` in 1/s, `cycle_time` in s."""
    step, held = sampled_drive(plant, cycle_time)
    return spectral_radius(step, held, kv, plant.bus_delay_cycles) < 1.0


def stability_limit(plant: PlantParameters, cycle_time: float) -> float:
    """The Kv in 1/s at which the sampled loop u[k] = -Kv·x[k], held over a cycle and delayed by the bus, oscillates.

    For a first-order drive z[k+1] = A z[k] + B u[k] is the exact solution over a cycle with z = (x, v); for a cascaded
    one it is that of plant_model.py without friction. The limit is where a pole reaches the unit circle, by bisection.
    """
    step, held = sampled_drive(plant, cycle_time)
    low, high = 0.0, 4.0 / cycle_time
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        stable = spectral_radius(step, held, middle, plant.bus_delay_cycles) < 1.0
        low, high = (middle, high) if stable else (low, middle)
    return low


def sampled_drive(plant: PlantParameters, cycle_time: float) -> tuple[Any, Any]:
    """(A, B) with the position as state 0."""
    if not plant.cascaded:
        decay = math.exp(-cycle_time / plant.time_constant) if plant.time_constant > 0.0 else 0.0
        way = plant.time_constant * (1.0 - decay)
        return np.array([[1.0, way], [0.0, decay]]), np.array([cycle_time - way, 1.0 - decay])
    order = [X, *(state for state in range(SPEED_STATES) if state != X)]
    step = expm(velocity_controlled(plant, gain=plant.velocity_gain) * cycle_time)
    assert V in order
    return step[np.ix_(order, order)], step[order, U]


def spectral_radius(step: Any, held: Any, kv: float, delay: int) -> float:
    """Largest magnitude of the poles with `delay` cycles between command and drive."""
    states = len(held)
    loop = np.zeros((states + delay, states + delay))
    loop[:states, :states] = step
    if delay == 0:
        loop[:, 0] -= kv * held
    else:
        loop[:states, states] = held
        loop[-1, 0] = -kv
        for index in range(states, states + delay - 1):
            loop[index, index + 1] = 1.0
    return float(np.max(np.abs(np.linalg.eigvals(loop))))
