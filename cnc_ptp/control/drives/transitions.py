"""Exact steps of the linear part of a cascaded drive, worked out once: numbers that a step multiplies with.

A step begins at velocity v0 and is written in deviations from it: p = w - v0, r = u - v0, y = v - v0. Letters as in
parameters/plant_model.py.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from cnc_ptp.parameters.control_view import PlantParameters
from cnc_ptp.parameters.plant_model import F, I, M, Matrix, U, V, W, X, velocity_controlled

Row = tuple[float, ...]

SLIDING_INPUTS = (W, U, I, M, F)
STANDING_INPUTS = (W, U, I, M)
HELD_INPUTS = (I, M, F)


class Transition(NamedTuple):
    """One step of `duration` s. Rows are what the named inputs contribute, one after another."""

    duration: float
    decay: float
    """p and w: what is left of the deviation from u."""
    sliding: Row
    """Changes of i, m, v, x by p, r, i, m, f (20 numbers; those of m and i are without the old value)."""
    held: Row
    """The same of m, v, x by the torque asked for, m, f (9 numbers): the torque limit holds."""
    standing: Row
    """Changes of i, m by w, u, i, m (8 numbers): friction holds the axis."""
    held_standing: Row
    """Change of m by the torque asked for, m."""


def transition(plant: PlantParameters, *, gain: float, duration: float) -> Transition:
    """The exact step of `plant` with velocity gain Kp (1/s) over `duration` s under held inputs."""

    def changes(held: bool, stands: bool, outputs: tuple[int, ...], inputs: tuple[int, ...]) -> Row:
        matrix = velocity_controlled(plant, gain=gain, held=held, stands=stands)
        step: Matrix = expm(matrix * duration) - np.eye(len(matrix))
        return tuple(float(step[out, into]) for out in outputs for into in inputs)

    time_constant = plant.time_constant
    return Transition(
        duration=duration,
        decay=float(np.exp(-duration / time_constant)) if time_constant > 0.0 else 0.0,
        sliding=changes(False, False, (I, M, V, X), SLIDING_INPUTS),
        held=changes(True, False, (M, V, X), HELD_INPUTS),
        standing=changes(False, True, (I, M), STANDING_INPUTS),
        held_standing=changes(True, True, (M,), (I, M)),
    )
