"""Exact steps of the linear part of a cascaded drive, worked out once: numbers that a step multiplies with.

Letters as in parameters/plant_model.py. A step begins at the velocity v0 and is written in deviations from it:
p = w - v0, r = u - v0, y = v - v0. Without a filter p is r.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from cnc_ptp.parameters.control_view import PlantParameters
from cnc_ptp.parameters.plant_model import F, I, M, Matrix, U, V, W, X, velocity_controlled

Row = tuple[float, ...]
Rows = tuple[Row, Row, Row]
"""Free, at the upper torque limit, at the lower one (index -1). At a limit `i` is the limit itself and stays."""


class Transition(NamedTuple):
    """One step of `duration` s. Rows are changes of states by inputs, state by state."""

    duration: float
    decay: float
    """What is left of w - u."""
    slide: Rows
    """i, v, x by p, r, i, f: 12 numbers."""
    slide_lag: Rows
    """With a current loop also m by p, r, i, f, m, and i, v, x by m: 8 numbers."""
    stand: Rows
    """Friction holds the axis: i by w, u, i; 3 numbers."""
    stand_lag: Rows
    """The same: m by w, u, i, m, and i by m: 5 numbers."""


def transition(plant: PlantParameters, *, gain: float, duration: float) -> Transition:
    """The exact step of `plant` with velocity gain Kp (1/s) over `duration` s under held inputs."""

    def steps(stands: bool) -> tuple[Matrix, Matrix]:
        free, held = (
            velocity_controlled(plant, gain=gain, held=held, stands=stands) * duration for held in (False, True)
        )
        return expm(free) - np.eye(7), expm(held) - np.eye(7)

    slide, stand = steps(stands=False), steps(stands=True)
    return Transition(
        duration=duration,
        decay=float(np.exp(-duration / plant.time_constant)) if plant.time_constant > 0.0 else 0.0,
        slide=rows(slide, (I, V, X), (W, U, I, F)),
        slide_lag=joined(rows(slide, (M,), (W, U, I, F, M)), rows(slide, (I, V, X), (M,))),
        stand=rows(stand, (I,), (W, U, I)),
        stand_lag=joined(rows(stand, (M,), (W, U, I, M)), rows(stand, (I,), (M,))),
    )


def rows(steps: tuple[Matrix, Matrix], outputs: tuple[int, ...], inputs: tuple[int, ...]) -> Rows:
    free, held = (tuple(float(step[out, into]) for out in outputs for into in inputs) for step in steps)
    return free, held, held


def joined(first: Rows, second: Rows) -> Rows:
    free, upper, lower = (a + b for a, b in zip(first, second, strict=True))
    return free, upper, lower
