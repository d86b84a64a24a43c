"""Evaluation of a circle test. Source: ISO 230-4 (circular deviation G, G(b), radial deviation F)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cnc_ptp.commissioning.circles import Circle, least_squares_circle, minimum_zone
from cnc_ptp.commissioning.trace import Array

BEFORE, AFTER = 4.0, 20.0
"""Degrees before and after a reversal in which its peak is searched."""
HARMONICS = 2
"""Waves per turn of the shape without peaks: centre, squareness, different gains and lags of the axes."""


@dataclass(frozen=True, slots=True)
class QuadrantPeak:
    """The deviation that a reversal leaves: `reversing` 0 or 1 is the axis of the plane that turns back at `angle`.

    `angle` in degrees (0, 90, 180, 270), `height` in mm over the shape of the rest of the circle, outward positive,
    `at` the angle of the peak itself.
    """

    angle: float
    reversing: int
    height: float
    at: float


@dataclass(frozen=True, slots=True)
class CircleResult:
    """One direction. Lengths in mm, angles in degrees.

    `circular_deviation` G: distance of the two concentric circles that hold the actual path, minimum zone.
    `radial_low`, `radial_high` F: deviations from the nominal radius about the least squares centre.
    `angles`, `deviations` (n,): what is drawn, deviation from the nominal radius over the angle about that centre.
    """

    clockwise: bool
    circular_deviation: float
    radial_low: float
    radial_high: float
    fitted: Circle
    peaks: tuple[QuadrantPeak, ...]
    angles: Array
    deviations: Array

    @property
    def largest_peak(self) -> float:
        """Largest magnitude of the quadrant peaks."""
        return max(abs(peak.height) for peak in self.peaks)


def evaluate_circle(points: Array, *, radius: float, clockwise: bool) -> CircleResult:
    """Evaluates the actual path `points` (n, 2) of one turn about a nominal circle of `radius` mm."""
    fitted = least_squares_circle(points)
    offsets = points - np.array(fitted.centre)
    angles = np.degrees(np.arctan2(offsets[:, 1], offsets[:, 0])) % 360.0
    deviations = np.hypot(offsets[:, 0], offsets[:, 1]) - radius
    return CircleResult(
        clockwise,
        minimum_zone(points).width,
        float(deviations.min()),
        float(deviations.max()),
        fitted,
        quadrant_peaks(angles, deviations, clockwise=clockwise),
        angles,
        deviations,
    )


def bidirectional_deviation(turns: Sequence[Array]) -> float:
    """G(b): width of the narrowest ring that holds the actual paths (n, 2) of both directions, mm."""
    return minimum_zone(np.vstack(turns)).width


def quadrant_peaks(angles: Array, deviations: Array, *, clockwise: bool) -> tuple[QuadrantPeak, ...]:
    """The four peaks: largest deviation near each reversal from the shape of the path away from all reversals.

    The shape is a constant and HARMONICS waves per turn, fitted by least squares outside the windows BEFORE … AFTER.
    """
    offsets = [(angles - angle if not clockwise else angle - angles) for angle in (0.0, 90.0, 180.0, 270.0)]
    offsets = [(offset + 180.0) % 360.0 - 180.0 for offset in offsets]
    windows = [(offset >= -BEFORE) & (offset <= AFTER) for offset in offsets]
    shape = _shape(angles, deviations, ~np.any(windows, axis=0))
    rest = deviations - shape
    return tuple(_peak(number, rest, angles, window) for number, window in enumerate(windows))


def _shape(angles: Array, deviations: Array, used: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> Array:
    turns = np.radians(angles)
    columns = [np.ones_like(turns)]
    for wave in range(1, HARMONICS + 1):
        columns += [np.cos(wave * turns), np.sin(wave * turns)]
    system = np.column_stack(columns)
    shape: Array = system @ np.linalg.lstsq(system[used], deviations[used], rcond=None)[0]
    return shape


def _peak(number: int, rest: Array, angles: Array, window: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> QuadrantPeak:
    """At 0° and 180° the first axis of the plane turns back, at 90° and 270° the second one."""
    if not np.any(window):
        return QuadrantPeak(90.0 * number, number % 2, math.nan, math.nan)
    places = np.flatnonzero(window)
    place = places[int(np.argmax(np.abs(rest[places])))]
    return QuadrantPeak(90.0 * number, number % 2, float(rest[place]), float(angles[place]))
