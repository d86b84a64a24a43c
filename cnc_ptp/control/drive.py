"""Drives behind one small interface; the default one is simulated."""

from __future__ import annotations

import math
from typing import Protocol

NEGLIGIBLE = 1e-12
"""mm/s or deg/s; a lag below it is over, so that a drive comes to rest exactly."""


class Drive(Protocol):
    """What the position controller needs of a drive; a real one would exchange its process data in `step`."""

    position: float
    """Actual position as the encoder shows it, mm or deg."""
    velocity: float
    """Actual velocity, mm/s or deg/s."""

    def step(self, command_velocity: float) -> None:
        """Holds `command_velocity` (mm/s or deg/s) for one cycle and takes over the new actual values."""


class SimulatedDrive:
    """Velocity-controlled drive as a first-order lag G(s) = 1 / (1 + Ta s) before an integrator and an encoder.

    The command is held over a cycle, so the discrete solution is exact:
    v(T) = u + (v0 - u) e^(-T/Ta), x(T) = x0 + u T + (v0 - u) Ta (1 - e^(-T/Ta)). Source: TF5200 feedforward, figure 1.
    """

    __slots__ = ("_cycle_time", "_decay", "_encoder_increment", "_lag_time", "_true_position", "position", "velocity")

    def __init__(
        self, *, cycle_time: float, time_constant: float, encoder_increment: float, start_position: float = 0.0
    ) -> None:
        """`cycle_time` and `time_constant` in s (0 = no lag), `encoder_increment` in mm or deg (0 = ideal encoder)."""
        self._cycle_time = cycle_time
        self._decay = math.exp(-cycle_time / time_constant) if time_constant > 0.0 else 0.0
        self._lag_time = time_constant * (1.0 - self._decay)
        self._encoder_increment = encoder_increment
        self._true_position = start_position
        self.velocity = 0.0
        self.step(0.0)  # stands; shows the position as the encoder does

    def step(self, command_velocity: float) -> None:
        surplus = self.velocity - command_velocity
        if -NEGLIGIBLE < surplus < NEGLIGIBLE:
            surplus = 0.0
        self._true_position += command_velocity * self._cycle_time + surplus * self._lag_time
        self.velocity = command_velocity + surplus * self._decay
        increment = self._encoder_increment
        self.position = round(self._true_position / increment) * increment if increment else self._true_position
