"""Position controller gain for a drive that was identified: the stability limit, and a proposal."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cnc_ptp.commissioning.dynamics import DriveFit

HIGHEST = 1e6
"""1/s; a limit beyond it is none."""


@dataclass(frozen=True, slots=True)
class GainProposal:
    """Kv in 1/s, times in s.

    `total`: Ta + dead time + T/2 (the command is held for a cycle, half of it late on average). `limit`: Kv at which
    the loop starts to oscillate, the lowest of all (Ta, dead time) that fit. `proposed` = 1/(4·total): damping 1, no
    overshoot. `fastest` = 1/(2·total): damping 0.71, 4 % overshoot, more is not advisable.
    """

    total: float
    limit: float
    proposed: float
    fastest: float


def propose_gain(fit: DriveFit) -> GainProposal:
    """Kv from the loop Ta·s² + s + Kv = 0 with damping D = 1/(2·sqrt(Kv·Ta)), Ta including all small delays.

    D = 1 gives Kv = 1/(4·Ta), D = 1/sqrt(2) Kv = 1/(2·Ta). Source: the second-order loop in its standard form; Groß,
    Hamann, Wiegärtner, Electrical Feed Drives in Automation, position control. If the limit is closer than three
    times the proposal, a third of the limit is proposed.
    """
    total = fit.delay + 0.5 * fit.cycle_time
    possible = {(fit.time_constant, fit.dead_cycles), *fit.alternatives}
    limit = min(stability_limit(lag, dead, fit.cycle_time) for lag, dead in possible)
    proposed = min(1.0 / (4.0 * total), limit / 3.0)
    return GainProposal(total, limit, proposed, min(1.0 / (2.0 * total), limit / 2.0))


def stability_limit(time_constant: float, dead_cycles: int, cycle_time: float) -> float:
    """The Kv in 1/s at which the sampled loop of P controller, held command, dead time, lag and integrator oscillates.

    x[k+1] = x[k] + T·u + (v[k] - u)·L, v[k+1] = u + (v[k] - u)·p, u = -Kv·x[k-d]; p = exp(-T/Ta), L = Ta·(1 - p).
    The limit is where the largest eigenvalue reaches the unit circle.
    """
    low, high = 0.0, 1.0 / cycle_time
    while spectral_radius(high, time_constant, dead_cycles, cycle_time) < 1.0:
        low, high = high, 2.0 * high
        if high > HIGHEST:
            return math.inf
    for _ in range(60):
        middle = 0.5 * (low + high)
        stable = spectral_radius(middle, time_constant, dead_cycles, cycle_time) < 1.0
        low, high = (middle, high) if stable else (low, middle)
    return low


def spectral_radius(kv: float, time_constant: float, dead_cycles: int, cycle_time: float) -> float:
    """Largest magnitude of the poles of that loop."""
    pole = math.exp(-cycle_time / time_constant) if time_constant > 0.0 else 0.0
    lag = time_constant * (1.0 - pole)
    # (z - 1)(z - p)·z^d + Kv·((T - L)·(z - p) + L·(1 - p)) = 0
    polynomial = np.zeros(dead_cycles + 3)
    polynomial[:3] = (1.0, -1.0 - pole, pole)
    polynomial[-2:] += kv * np.array([cycle_time - lag, lag * (1.0 - pole) - (cycle_time - lag) * pole])
    return float(np.max(np.abs(np.roots(polynomial))))
