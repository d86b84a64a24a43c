"""Exact steps of the linear part of a cascaded drive, computed once: the numbers by which a step multiplies.

Letters as in parameters/view/plant_model.py. A step starts at the velocity v0 with the friction f and is written in

    p = w - v0, r = u - v0      set velocities; without a filter p is r
    q = Kp p + i - f            acceleration that the velocity controller asks for, without friction
    n = m - f                   acceleration that there is, behind the current loop

so that friction and v0 themselves drop out: the distance is v0 t + x, the velocity v0 + y with y, x linear in p, r, q,
n.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cnc_ptp.parameters.view.control_view import PlantParameters
from cnc_ptp.parameters.view.matrix_exponential import exponential
from cnc_ptp.parameters.view.plant_model import F, I, M, Matrix, U, V, W, X, velocity_controlled

Weights = tuple[float, ...]
Rows = tuple[Weights, Weights, Weights]
"""Free, at the upper torque limit, at the lower one (index -1); there the limit is the acceleration asked for."""


class Transition(NamedTuple):
    """One step of `duration` s."""

    duration: float
    decay: float
    """Remaining part of w - u."""
    integral_by_p: float
    """The integral grows by integral_by_p p + integral_by_r r - Kp/Tn x."""
    integral_by_r: float
    slide: Rows
    """y by p, r, q; x by p, r, q; y, x by additional friction: 8 numbers."""
    slide_lag: Rows
    """With a current loop besides: m - m0 by p, r, q, n; y, x by n; m by additional friction: 7 numbers."""
    stand_lag: Rows
    """Friction holds the axis: m - m0 by w, u, i, m: 4 numbers."""


def transition(plant: PlantParameters, *, gain: float, duration: float) -> Transition:
    """The exact step of `plant` with velocity gain Kp (1/s) over `duration` s under held inputs."""
    time_constant = plant.time_constant
    decay = float(np.exp(-duration / time_constant)) if time_constant > 0.0 else 0.0
    rate = gain / plant.velocity_integral_time if plant.velocity_integral_time > 0.0 else 0.0
    slide, stand = changes(plant, gain, duration, stands=False), changes(plant, gain, duration, stands=True)
    asked = (slide[0] @ without_p(gain), slide[1])
    inputs = (W, U, I)
    return Transition(
        duration=duration,
        decay=decay,
        integral_by_p=rate * time_constant * (1.0 - decay),
        integral_by_r=rate * (duration - time_constant * (1.0 - decay)),
        slide=joined(rows(asked, (V, X), inputs), rows(slide, (V, X), (F,))),
        slide_lag=joined(rows(asked, (M,), (*inputs, M)), rows(slide, (V, X), (M,)), rows(slide, (M,), (F,))),
        stand_lag=rows(stand, (M,), (*inputs, M)),
    )


def changes(plant: PlantParameters, gain: float, duration: float, *, stands: bool) -> tuple[Matrix, Matrix]:
    """How the states change in a step: free, and at the torque limit."""
    free, held = (
        exponential(velocity_controlled(plant, gain=gain, held=held, stands=stands) * duration) - np.eye(7)
        for held in (False, True)
    )
    return free, held


def without_p(gain: float) -> Matrix:
    """Computes the input i from q and p: i = q - Kp p (+ f, which drops out)."""
    matrix = np.eye(7)
    matrix[I, W] = -gain
    return matrix


def rows(steps: tuple[Matrix, Matrix], outputs: tuple[int, ...], inputs: tuple[int, ...]) -> Rows:
    free, held = (tuple(float(step[out, into]) for out in outputs for into in inputs) for step in steps)
    return free, held, held


def joined(*parts: Rows) -> Rows:
    free, upper, lower = (sum(row, ()) for row in zip(*parts, strict=True))
    return free, upper, lower
