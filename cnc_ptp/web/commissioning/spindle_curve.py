"""The acceleration of a spindle over its speed, gear by gear, as a page draws it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import isclose
from typing import Any, NamedTuple

from cnc_ptp.parameters import ParameterSet
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.parameters.view.spindle_view import GearParameters, spindle_view
from cnc_ptp.spindle.acceleration_curves import AccelerationCurve

POINTS = 101
"""Of a gear, besides its break points."""
NO_STEP = 1e-6
"""Coefficients of a curve are rounded: by such a part its pieces may miss each other."""


class CurvePoint(NamedTuple):
    """Speed in °/s, acceleration in °/s²; `is_break`: the law of the curve changes here."""

    speed: float
    acceleration: float
    is_break: bool = False


def spindle_curve(parameters: ParameterSet, cycle_time: float) -> list[dict[str, Any]]:
    """Of each gear: kind of the curve (constant without one), points of speed (rpm) and acceleration (deg/s²)."""
    gears = spindle_view(parameters, cycle_time).gears
    return [gear_curve(stage, gear) for stage, gear in gears.items()]


def gear_curve(stage: int, gear: GearParameters) -> dict[str, Any]:
    speeds = [gear.max_speed * number / (POINTS - 1) for number in range(POINTS)]
    if gear.curve is None:
        points = [CurvePoint(speed, gear.acceleration) for speed in speeds]
    else:
        points = curve_points(
            AccelerationCurve(gear.curve, top_speed=gear.max_speed, most=gear.max_acceleration), speeds
        )
    shown = [
        {"speed": speed / DEG_S_PER_RPM, "acceleration": acceleration, "break": is_break}
        for speed, acceleration, is_break in points
    ]
    return {"gear": stage, "kind": gear.curve.kind if gear.curve else "constant", "points": shown}


def curve_points(curve: AccelerationCurve, speeds: Sequence[float]) -> list[CurvePoint]:
    """The curve at these speeds and at its break points, in their order; where it steps, both sides."""
    breaks = [*break_points(curve)]
    taken = {point.speed for point in breaks}
    between = [CurvePoint(speed, curve.acceleration(speed)) for speed in speeds if speed not in taken]
    return sorted(breaks + between, key=lambda point: point.speed)


def break_points(curve: AccelerationCurve) -> Iterator[CurvePoint]:
    """Where one piece of the curve ends and the next begins, below the top speed."""
    for below, above in pairwise(curve.pieces[:-1]):  # the last piece lies above the top speed
        left, right = below.acceleration(below.high), above.acceleration(above.low)
        yield CurvePoint(below.high, left, True)
        if not isclose(left, right, rel_tol=NO_STEP):
            yield CurvePoint(above.low, right, True)
