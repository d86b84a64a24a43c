"""Phases of constant velocity in a recording."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cnc_ptp.commissioning.timing import Seconds
from cnc_ptp.commissioning.trace import Array, AxisTrace, Span

LEAST_CYCLES = 3
SAME = 1e-7
"""Relative change of a setpoint from cycle to cycle that is still a constant velocity."""
LARGEST_DRIFT = 1e-3
"""Relative change over a whole phase."""


@dataclass(frozen=True, slots=True)
class SteadyPhase:
    """Rows first … end - 1 move with the constant set velocity `velocity` (mm/s, deg/s, with its sign), settled."""

    velocity: float
    first: int
    end: int

    def __len__(self) -> int:
        return self.end - self.first


def steady_phases(trace: AxisTrace, *, settling: Seconds, shortest: float) -> list[SteadyPhase]:
    """Phases in which the set velocity is constant and not zero, without their first `settling(speed)` seconds.

    Shorter ones than `shortest` seconds are left out.
    """
    least = max(1, round(shortest / trace.cycle_time))
    phases = []
    for first, end in _moving(trace):
        velocity = float(trace.set_velocity[first])
        skipped = round(settling(abs(velocity)) / trace.cycle_time)
        if end - first - skipped >= least:
            phases.append(SteadyPhase(velocity, first + skipped, end))
    return phases


def longest_steady(trace: AxisTrace) -> tuple[float, float]:
    """Seconds and velocity of the longest motion with constant velocity, settling included; (0, 0) if there is none."""
    first, end = max(_moving(trace), key=lambda span: span[1] - span[0], default=(0, 0))
    return (end - first) * trace.cycle_time, float(trace.set_velocity[first]) if end else 0.0


def _moving(trace: AxisTrace) -> Iterator[Span]:
    """Stretches with a constant set velocity that is not zero."""
    spans = (span for whole in trace.unbroken() for span in _constant(trace.set_velocity, whole))
    return (span for span in spans if span[1] - span[0] >= LEAST_CYCLES and trace.set_velocity[span[0]])


def _constant(values: Array, span: Span) -> list[Span]:
    """Stretches of `span` in which a value is constant from cycle to cycle and does not drift slowly."""
    first, end = span
    part = values[first:end]
    steps = np.abs(np.diff(part)) > SAME * np.abs(part[1:])
    edges = [0, *(np.flatnonzero(steps) + 1).tolist(), len(part)]
    pairs = pairwise(edges)
    return [(first + low, first + high) for low, high in pairs if _holds(part[low:high])]


def _holds(values: Array) -> bool:
    return bool(np.ptp(values) <= LARGEST_DRIFT * abs(float(values[0])))
