"""Speed changes of a spindle: at constant acceleration or along an acceleration curve (TF5200 spindle 2.3.1, 2.8.4)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

from cnc_ptp.spindle.acceleration_curves import AccelerationCurve, RampPart
from cnc_ptp.spindle.speed_table import SpeedTable, table


class Ramp(Protocol):
    """How fast the magnitude of the speed may grow and fall."""

    def parts(self, speed: float, target: float) -> Iterator[RampPart]:
        """From one magnitude of speed to another, both >= 0, in °/s."""


class ConstantRamp:
    """|speed| grows with `acceleration` (P-AXIS-00001) and falls with `deceleration` (P-AXIS-00002), °/s²."""

    def __init__(self, *, acceleration: float, deceleration: float) -> None:
        self.acceleration = acceleration
        self.deceleration = deceleration

    def parts(self, speed: float, target: float) -> Iterator[RampPart]:
        rate = self.acceleration if target > speed else -self.deceleration
        yield (target - speed) / rate, (speed, rate)


def ramp_parts(speed: float, target: float, ramp: Ramp | AccelerationCurve) -> Iterator[RampPart]:
    """From a signed speed to another; a reversal passes through 0."""
    if speed * target < 0.0:
        yield from ramp_parts(speed, 0.0, ramp)
        yield from ramp_parts(0.0, target, ramp)
    elif speed != target:
        sign = -1.0 if speed < 0.0 or target < 0.0 else 1.0
        for duration, powers in ramp.parts(abs(speed), abs(target)):
            yield duration, powers if sign > 0.0 else tuple(-power for power in powers)


def plan_speed(position: float, speed: float, target_speed: float, ramp: Ramp | AccelerationCurve) -> SpeedTable:
    """The table from `speed` to `target_speed`, which then continues at that speed. Units: °, °/s."""
    return table(position, ramp_parts(speed, target_speed, ramp), target_speed)
