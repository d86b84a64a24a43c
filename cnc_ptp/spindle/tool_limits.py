"""Limits of a spindle: those of the gear, narrowed by those of the tool (TF5200 spindle 2.8.5)."""

from __future__ import annotations

from dataclasses import dataclass
from math import copysign, inf

from cnc_ptp.parameters import GearParameters
from cnc_ptp.spindle.acceleration_curves import AccelerationCurve
from cnc_ptp.spindle.positioning import PositioningLimits
from cnc_ptp.spindle.speed_ramp import ConstantRamp, Ramp


@dataclass(frozen=True, slots=True)
class ToolLimits:
    """Limits of the tool in °/s and °/s² (P-TOOL-00013 … 00015)."""

    max_speed: float = inf
    min_speed: float = 0.0
    max_acceleration: float = inf


class SpindleLimits:
    """Speeds and ramps that count in one gear with one tool."""

    def __init__(self, gear: GearParameters, tool: ToolLimits, *, control_limit: float = inf) -> None:
        """`control_limit` in °/s: above it there is no measured position to go to (2.4.2)."""
        self.gear = gear
        self.max_speed = min(gear.max_speed, tool.max_speed)
        self.max_positioning_speed = min(self.max_speed, control_limit)
        self.min_speed = min(tool.min_speed, self.max_speed)
        self.acceleration = min(gear.acceleration, tool.max_acceleration)
        self.deceleration = min(gear.deceleration, tool.max_acceleration)
        self.ramp: Ramp | AccelerationCurve = ConstantRamp(
            acceleration=self.acceleration, deceleration=self.deceleration
        )
        if gear.curve is not None:
            self.ramp = AccelerationCurve(gear.curve, top_speed=gear.max_speed, most=tool.max_acceleration)

    def endless(self, speed: float) -> float:
        """A signed speed of endless rotation within the limits; 0 (no speed, override 0) stays 0."""
        if speed == 0.0:
            return 0.0
        return copysign(min(max(abs(speed), self.min_speed), self.max_speed), speed)

    def positioning(self, speed: float) -> PositioningLimits:
        """Limits of a positioning at `speed`; the minimum of the tool is not applied there."""
        used = min(speed, self.max_positioning_speed)
        return PositioningLimits(used, self.acceleration, self.deceleration, self.ramp)
