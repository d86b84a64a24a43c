"""The linear part of a simulated drive with its mechanics as differential equations.

States: w set velocity behind the filter, i integral part of the velocity controller, m acceleration by the motor
(torque over inertia), v velocity, x position. Inputs: commanded velocity u, deceleration f by friction.

    w' = (u - w) / Tf      i' = Kp / Tn (w - v)      m' = (Kp (w - v) + i - m) / Ti      v' = m - b v - f      x' = v

A time constant of 0 means that its state follows at once. Structure: TF5200 feedforward, figure 2.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cnc_ptp.parameters.view.control_view import PlantParameters

W, I, M, V, X, U, F = range(7)  # noqa: E741 - the letters of the equations
"""Indexes of states and inputs in a row."""

Matrix = NDArray[np.float64]


def velocity_controlled(plant: PlantParameters, *, gain: float, held: bool = False, stands: bool = False) -> Matrix:
    """d/dt of (w, i, m, v, x, u, f) as a 7 × 7 matrix; inputs are held, their rows are 0.

    `gain` is Kp in 1/s. `held`: the torque limit is active, then i is the required torque and constant.
    `stands`: friction holds the axis.
    """
    rows: Any = np.zeros((7, 7))
    if plant.time_constant > 0.0:
        rows[W, [W, U]] = -1.0 / plant.time_constant, 1.0 / plant.time_constant
    required = required_acceleration(plant, gain=0.0 if held else gain)
    if not held and plant.velocity_integral_time > 0.0:
        rows[I] = gain / plant.velocity_integral_time * set_minus_actual(plant)
    given = required
    if plant.current_time_constant > 0.0:
        rows[M] = required / plant.current_time_constant
        rows[M, M] -= 1.0 / plant.current_time_constant
        given = unit(M)
    if not stands:
        rows[V] = given
        rows[V, V] -= viscous_rate(plant)
        rows[V, F] = -1.0
        rows[X, V] = 1.0
    return rows  # type: ignore[no-any-return]


def required_acceleration(plant: PlantParameters, *, gain: float) -> Matrix:
    """Row of Kp (w - v) + i."""
    return unit(I) + gain * set_minus_actual(plant)


def set_minus_actual(plant: PlantParameters) -> Matrix:
    """Row of w - v; without a filter w is u."""
    return unit(W if plant.time_constant > 0.0 else U) - unit(V)


def viscous_rate(plant: PlantParameters) -> float:
    """b in 1/s: viscous friction over inertia."""
    return plant.viscous / plant.torque_per_acceleration


def unit(index: int) -> Matrix:
    row = np.zeros(7)
    row[index] = 1.0
    return row
