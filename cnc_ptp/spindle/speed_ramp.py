"""Speed changes of an endlessly rotating spindle at constant acceleration (TF5200 spindle 2.3.1)."""

from __future__ import annotations

from cnc_ptp.motion import Profile
from cnc_ptp.motion.profile import Piece, integrate


def plan_speed(
    position: float, speed: float, target_speed: float, *, acceleration: float, deceleration: float
) -> Profile:
    """The table from `speed` to `target_speed`, which then goes on at that speed.

    Units: deg, deg/s, deg/s². |speed| grows with `acceleration` (P-AXIS-00001) and falls with `deceleration`
    (P-AXIS-00002); a reversal passes through 0.
    """
    pieces: list[Piece] = []
    if speed * target_speed < 0.0:
        pieces.append(_piece(speed, 0.0, acceleration, deceleration))
        pieces.append(_piece(0.0, target_speed, acceleration, deceleration))
    else:
        pieces.append(_piece(speed, target_speed, acceleration, deceleration))
    rows, t, end_position, _ = integrate(0.0, position, speed, pieces)
    return Profile([*rows, (t, end_position, target_speed, 0.0, 0.0)])


def _piece(speed: float, target_speed: float, acceleration: float, deceleration: float) -> Piece:
    rate = acceleration if abs(target_speed) > abs(speed) else deceleration
    change = target_speed - speed
    return abs(change) / rate, rate if change > 0.0 else -rate, 0.0
