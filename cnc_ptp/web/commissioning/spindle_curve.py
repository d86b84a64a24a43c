"""The acceleration of a spindle over its speed, gear by gear, as a page draws it."""

from __future__ import annotations

from typing import Any

from cnc_ptp.parameters import ParameterSet
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.parameters.view.spindle_view import GearParameters, spindle_view
from cnc_ptp.spindle.acceleration_curves import AccelerationCurve

POINTS = 101


def spindle_curve(parameters: ParameterSet, cycle_time: float) -> list[dict[str, Any]]:
    """Of each gear: kind of the curve (constant without one), points of speed (rpm) and acceleration (deg/s²)."""
    gears = spindle_view(parameters, cycle_time).gears
    return [gear_curve(stage, gear) for stage, gear in gears.items()]


def gear_curve(stage: int, gear: GearParameters) -> dict[str, Any]:
    speeds = [gear.max_speed * number / (POINTS - 1) for number in range(POINTS)]
    if gear.curve is None:
        accelerations = [gear.acceleration] * POINTS
    else:
        curve = AccelerationCurve(gear.curve, top_speed=gear.max_speed, most=gear.max_acceleration)
        accelerations = [curve.acceleration(speed) for speed in speeds]
    points = [
        {"speed": speed / DEG_S_PER_RPM, "acceleration": acceleration}
        for speed, acceleration in zip(speeds, accelerations, strict=True)
    ]
    return {"gear": stage, "kind": gear.curve.kind if gear.curve else "constant", "points": points}
