"""Compensation of the rounding error of a modulo circle in encoder increments (P-AXIS-00120, 00124, 00125)."""

from __future__ import annotations

from math import trunc

from cnc_ptp.parameters.control_view import ModuloError


class ModuloCompensation:
    """Puts back, increment by increment, what the encoder is short of after whole turns.

    After n turns of the modulo range n · P-AXIS-00124 / P-AXIS-00125 increments are missing; whole ones are added.
    """

    __slots__ = ("_increment", "_increments_per_way")

    def __init__(self, parameters: ModuloError) -> None:
        self._increment = parameters.increment
        self._increments_per_way = parameters.increments_per_turn / parameters.turn if parameters.turn else 0.0

    @property
    def on(self) -> bool:
        return self._increments_per_way != 0.0

    def correction(self, position: float) -> float:
        """To be added to the actual position `position`, deg."""
        return trunc(position * self._increments_per_way) * self._increment
