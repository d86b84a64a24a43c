"""The friction curve as the compensation value list of the manual (P-COMP-00041 …)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cnc_ptp.commissioning.faults import NO_FRICTION, NO_SCALE, refusal
from cnc_ptp.commissioning.friction import FrictionCurve, FrictionPoint
from cnc_ptp.parameters.declare import ids

MODE = 3
SCALES = (1000, 100, 10, 1)
"""P-COMP-00045 in 0.1 %: table values may be 1, 10, 100 or 1000 times the value for the drive."""
FINE_ENOUGH = 0.0025
"""Half a digit of the table over its smallest value."""
LARGEST = 2**31 - 2
"""Of a SGN32 (P-COMP-00046, 00047)."""
FROM_MM_S = 1000.0
"""µm/s (0.001 °/s) a mm/s (deg/s)."""


@dataclass(frozen=True, slots=True)
class Scaling:
    """How the drive counts torque: `digits` a N (Nm), from P-AXIS-00325 / P-AXIS-00326 / P-AXIS-00392."""

    numerator: float
    denominator: float
    reference: float

    @property
    def digits(self) -> float:
        return self.numerator / self.denominator / self.reference


@dataclass(frozen=True, slots=True)
class TableEntry:
    """frict_comp.table[i]: velocity in µm/s (0.001 °/s), current in digits, and the point that it comes from."""

    velocity: int
    current: int
    point: FrictionPoint


@dataclass(frozen=True, slots=True)
class FrictionTable:
    """The list: scaling_factor in 0.1 %, entries ascending."""

    scaling_factor: int
    entries: tuple[TableEntry, ...]
    dropped: int
    """Measured points that the table does not hold, because the curve is straight there …"""
    without_friction: tuple[float, ...] = ()
    """… and speeds at which there is none: 0 or less."""


def friction_table(curve: FrictionCurve, scaling: Scaling, *, max_points: int) -> FrictionTable:
    """The table of at most `max_points` entries: out = friction · digits · 1000 / scaling_factor, in = 1000 · speed.

    The scaling factor is the largest of 100, 10, 1, 0.1 % that keeps rounding to whole digits below FINE_ENOUGH.
    Raises CncError 27008 without friction, 27009 if the scaling of the torque is not usable.
    """
    _require_scale(curve.axis, scaling)
    points = [point for point in curve.points if round(point.speed * FROM_MM_S) > 0]
    _require_friction(curve.axis, points, scaling.digits)
    without = tuple(point.speed for point in points if point.friction <= 0.0)
    points = [point for point in points if point.friction > 0.0]
    kept = _thin(_distinct(points), max_points)
    factor = _scaling_factor([point.friction for point in kept], scaling.digits)
    per_torque = scaling.digits * 1000.0 / factor
    entries = tuple(
        TableEntry(round(point.speed * FROM_MM_S), _whole(curve.axis, point.friction * per_torque), point)
        for point in kept
    )
    return FrictionTable(factor, entries, len(curve.points) - len(without) - len(entries), without)


def _require_friction(axis: str, points: Sequence[FrictionPoint], digits: float) -> None:
    """Raises CncError 27008 unless some point is against the motion, above its scatter and half a digit of a table."""
    largest = max((point.friction for point in points), default=0.0)
    least = 0.5 * SCALES[-1] / 1000.0 / digits
    torque, remedy = f"the largest torque at constant velocity is {largest:.3g}", ""
    if points and all(point.friction < -point.scatter for point in points):
        reason = f"the torque at constant velocity acts in the direction of the motion (largest {largest:.3g})"
        remedy = ", check the sign of the torque"
    elif not any(point.friction > max(point.scatter, 1e-9 * largest) for point in points):
        reason = f"{torque}, within its scatter"
    elif largest < least:
        reason = f"{torque}, below half a digit of the finest table ({least:.3g} with P-COMP-00045 = {SCALES[-1]})"
    else:
        return
    raise refusal(NO_FRICTION, axis, f"no friction was found: {reason}; no table was made{remedy}")


def _require_scale(axis: str, scaling: Scaling) -> None:
    for number, value in (
        (ids.ANTR_TORQUE_SCALE_DENOM, scaling.denominator),
        (ids.ANTR_ACC_REFERENCE_VALUE, scaling.reference),
    ):
        if value == 0.0:
            raise refusal(
                NO_SCALE, axis, f"{number} is 0, so torque has no drive unit (P-ERR-110465); no table was made, set it"
            )


def _whole(axis: str, digits: float) -> int:
    if abs(digits) > LARGEST:
        raise refusal(
            NO_SCALE,
            axis,
            f"a table value of {digits:.4g} is beyond {LARGEST} (P-COMP-00047); no table was made, "
            "check P-AXIS-00325, P-AXIS-00326 and P-AXIS-00392",
        )
    return round(digits)


def _scaling_factor(frictions: Sequence[float], digits: float) -> int:
    smallest = min(abs(friction) for friction in frictions) * digits
    largest = max(abs(friction) for friction in frictions) * digits
    fits = [factor for factor in SCALES if largest * 1000.0 / factor <= LARGEST] or [SCALES[0]]
    fine = (factor for factor in fits if 0.5 * factor / 1000.0 <= FINE_ENOUGH * smallest)
    return next(fine, fits[-1])


def _distinct(points: Sequence[FrictionPoint]) -> list[FrictionPoint]:
    """Points whose velocities differ as whole numbers of the list: it must ascend (110591)."""
    result: list[FrictionPoint] = []
    for point in points:
        if not result or round(point.speed * FROM_MM_S) > round(result[-1].speed * FROM_MM_S):
            result.append(point)
    return result


def _thin(points: list[FrictionPoint], most: int) -> list[FrictionPoint]:
    """At most `most` points: starting with the ends, always the one that the table so far would miss most is added."""
    if len(points) <= most:
        return points
    speeds = np.array([point.speed for point in points])
    values = np.array([point.friction for point in points])
    kept = [0, len(points) - 1][: max(most, 1)]
    scale = np.maximum(np.abs(values), 1e-12)
    while len(kept) < most:
        missed = np.abs(np.interp(speeds, speeds[kept], values[kept]) - values) / scale
        missed[kept] = -1.0
        kept = sorted([*kept, int(np.argmax(missed))])
    return [points[index] for index in kept]
