"""Homing of a spindle by the zero pulse of its encoder, while it turns (TF5200 spindle 2.7)."""

from __future__ import annotations

from math import ceil, floor

TURN = 360.0
PATIENCE = 2.0 * TURN
"""° of the setpoint within which the zero pulse must come."""


class ZeroPulse:
    """The mark that the encoder passes once per turn; its place is latched exactly, also between two cycles."""

    def __init__(self, mark: float) -> None:
        """`mark` in °, as the encoder counts."""
        self._mark = mark
        self._last: float | None = None

    def arm(self) -> None:
        """Looks for the pulse from the next cycle on."""
        self._last = None

    def passed(self, encoder: float) -> float | None:
        """Position of the mark that was passed since the previous cycle, None if there was none."""
        last, self._last = self._last, encoder
        if last is None or last == encoder:
            return None
        before, now = (last - self._mark) / TURN, (encoder - self._mark) / TURN
        if encoder > last:
            turns = floor(now)
            return turns * TURN + self._mark if turns > before else None
        turns = ceil(now)
        return turns * TURN + self._mark if turns < before else None


def nearest_shift(position: float, reference: float) -> float:
    """The shift to be added to coordinates so that `position` is `reference` modulo one turn; at most half a turn."""
    shift = (reference - position) % TURN
    return shift - TURN if shift > 0.5 * TURN else shift
