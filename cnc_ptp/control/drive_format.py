"""Drive formats: conversion between kernel units and the integers of a telegram or the volts of a DA converter.

Sources: TF5200 feedforward 4.1 (velocity), 4.2 (resolution, torque); spindle 2.2.4, P-AXIS-00128, 00129, 00159.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from cnc_ptp.parameters.view.control_view import DriveParameters, DriveScaling


class Digits(NamedTuple):
    """A quantity as a signed integer of `bits` bits."""

    scale: float
    """Digits per unit; 0.0 outputs nothing."""
    bits: int

    def encode(self, value: float) -> int:
        """The nearest integer to value · scale, at most what the length holds: -2^(bits-1) … 2^(bits-1) - 1."""
        highest = (1 << (self.bits - 1)) - 1
        return max(-highest - 1, min(highest, round(value * self.scale)))

    def encode_all(self, values: Sequence[float]) -> list[int]:
        """`encode` of many values."""
        scale, highest = self.scale, (1 << (self.bits - 1)) - 1
        digits = [round(value * scale) for value in values]
        if digits and not (-highest - 1 <= min(digits) and max(digits) <= highest):
            return [self.encode(value) for value in values]
        return digits

    def decode(self, digits: int) -> float:
        """The value of an integer in kernel units."""
        return digits / self.scale if self.scale else 0.0


class CounterFormat(NamedTuple):
    """A position as a counter that overflows: increments modulo 2^bits."""

    scale: float
    """Increments per mm (deg)."""
    bits: int = 32

    def encode(self, position: float) -> int:
        """The counter as a signed integer, SGN32."""
        return self.signed(round(position * self.scale))

    def signed(self, increments: int) -> int:
        """-2^(bits-1) … 2^(bits-1) - 1."""
        half = 1 << (self.bits - 1)
        return (increments + half) % (1 << self.bits) - half

    def unsigned(self, increments: int) -> int:
        """The same counter as UNS32, 0 … 2^bits - 1."""
        return increments % (1 << self.bits)


class CounterReader:
    """Follows a counter over its overflow: the distance since the last value is less than half its range."""

    __slots__ = ("_format", "increments")

    def __init__(self, counter: CounterFormat, *, position: float) -> None:
        """`position` in mm (deg) is that of the present counter value."""
        self._format = counter
        self.increments = round(position * counter.scale)

    @property
    def position(self) -> float:
        """mm or deg."""
        return self.increments / self._format.scale

    def read(self, counter: int) -> float:
        """The position in mm (deg) that a new value of the counter, signed or unsigned, shows."""
        self.increments += self._format.signed(counter - self.increments)
        return self.increments / self._format.scale


class DriveFormat(NamedTuple):
    """The formats of one drive for each command and each actual value."""

    velocity: Digits
    position: CounterFormat
    lag: Digits
    torque: Digits
    additive_velocity: Digits
    additive_torque: Digits
    actual_position: CounterFormat
    actual_velocity: Digits
    actual_torque: Digits
    sign: int
    """-1 reverses commands and actual values (P-AXIS-00159)."""


def drive_format(scaling: DriveScaling, drive: DriveParameters) -> DriveFormat:
    """The formats that the parameters give; a DA word has a scale of its own (P-AXIS-00129 / P-AXIS-00128)."""
    command, feedback = dict(drive.command_bits), dict(drive.feedback_bits)
    return DriveFormat(
        velocity=Digits(scaling.analogue if drive.analogue else scaling.velocity, command["velocity"]),
        position=CounterFormat(scaling.position, command["position"]),
        lag=Digits(scaling.position, command["lag"]),
        torque=Digits(scaling.torque, command["torque"]),
        additive_velocity=Digits(scaling.velocity, command["additive_velocity"]),
        additive_torque=Digits(scaling.torque, command["additive_torque"]),
        actual_position=CounterFormat(scaling.position, feedback["position"]),
        actual_velocity=Digits(scaling.velocity, feedback["velocity"]),
        actual_torque=Digits(scaling.torque, feedback["torque"]),
        sign=-1 if drive.reverse else 1,
    )


def shown_velocity(scaling: DriveScaling, drive: DriveParameters) -> Digits:
    """The velocity command as it is shown, with the drive's sign; without a telegram, in the scale of a DA word."""
    velocity = drive_format(scaling, drive).velocity
    scale = scaling.analogue if drive.ideal else velocity.scale
    return Digits(-scale if drive.reverse else scale, velocity.bits)
