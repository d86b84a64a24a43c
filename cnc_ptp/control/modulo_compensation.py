"""Compensation of the rounding error of a modulo circle in encoder increments (P-AXIS-00120, 00124, 00125)."""

from __future__ import annotations

from math import trunc

from cnc_ptp.parameters.view.control_view import ModuloError


class ModuloCompensation:
    """Adds, increment by increment, what the encoder lacks after whole turns.

    A turn of the modulo range M shows on the encoder as M - e · P-AXIS-00124 / P-AXIS-00125, with e deg per increment.
    The difference is spread evenly over the turn; whole increments are added, and removed again in the other direction.
    """

    __slots__ = ("_increment", "_increments_per_deg", "_origin")

    def __init__(self, parameters: ModuloError, *, origin: float) -> None:
        """`origin` in deg: the encoder's position at which the compensation is 0."""
        self._increment = parameters.increment
        shown = parameters.turn - parameters.increments_per_turn * parameters.increment
        self._increments_per_deg = parameters.increments_per_turn / shown if parameters.turn else 0.0
        self._origin = origin

    @property
    def on(self) -> bool:
        return self._increments_per_deg != 0.0

    def correction(self, position: float) -> float:
        """The compensation to be added to `position` of the encoder, deg."""
        return trunc((position - self._origin) * self._increments_per_deg) * self._increment
