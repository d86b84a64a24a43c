"""Modulo start: a position within the turn, whole turns in addition, the sign as direction (TX1250 2.1)."""

from __future__ import annotations

ROUNDING = 1e-9
"""Part of a turn; an axis this near to its target has reached it, on either side."""


def modulo_target(position: float, modulo_position: float, turn: float) -> float:
    """The absolute target of a modulo start from `position`, all in degrees (mm), `turn` > 0.

    Its magnitude is turns·turn + the position within the turn; the distance is the shortest one in the direction of its
    sign (0.0 counts as positive) that ends there, plus the whole turns.
    """
    sign = -1.0 if modulo_position < 0.0 else 1.0
    turns, within = divmod(abs(modulo_position), turn)
    distance = sign * (within - position) % turn
    if turn - distance <= ROUNDING * turn:
        distance = 0.0
    return position + sign * (distance + turns * turn)
