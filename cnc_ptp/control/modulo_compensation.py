"""Compensation of the rounding error of a modulo circle in encoder increments (P-AXIS-00120, 00124, 00125)."""

from __future__ import annotations

from math import trunc

from cnc_ptp.parameters.view.control_view import ModuloError


class ModuloCompensation:
    """Puts back, increment by increment, what the encoder is short of after whole turns.

    A turn of the modulo range M shows on the encoder as M - e · P-AXIS-00124 / P-AXIS-00125, e deg an increment. What
    is missing is spread evenly over the turn, whole increments are added, on the way back they are taken off again.
    """

    __slots__ = ("_increment", "_increments_per_way", "_origin")

    def __init__(self, parameters: ModuloError, *, origin: float) -> None:
        """`origin` in deg: the encoder's position where nothing is missing yet."""
        self._increment = parameters.increment
        shown = parameters.turn - parameters.increments_per_turn * parameters.increment
        self._increments_per_way = parameters.increments_per_turn / shown if parameters.turn else 0.0
        self._origin = origin

    @property
    def on(self) -> bool:
        return self._increments_per_way != 0.0

    def correction(self, position: float) -> float:
        """To be added to the position `position` of the encoder, deg."""
        return trunc((position - self._origin) * self._increments_per_way) * self._increment
