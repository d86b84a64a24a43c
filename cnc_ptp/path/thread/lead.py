"""How the path comes to where its spindle is: the mismatch between both fades out by a polynomial of fifth degree.

With e, e', e'' at the beginning, s = t/H and a0 = e, a1 = e'·H, a2 = e''·H²/2:

    e(s) = a0 + a1·s + a2·s² - (10·a0 + 6·a1 + 3·a2)·s³ + (15·a0 + 8·a1 + 3·a2)·s⁴ - (6·a0 + 3·a1 + a2)·s⁵

It ends with e = e' = e'' = 0. The horizon H is as short as the axes permit, so that the path is soon right.
"""

from __future__ import annotations

from typing import Final

from cnc_ptp.motion import Limits
from cnc_ptp.motion.setpoints import MotionState

GROWTH: Final = 1.25
MOST_GROWTHS: Final = 16
LOOKS: Final = 8
"""Places at which acceleration and jerk of a correction are looked at, besides its beginning."""
ACCELERATION_SHARE: Final = 0.9
JERK_SHARE: Final = 0.9
"""What the spindle's own acceleration and the correction may take together."""
NO_MISMATCH: Final = (0.0, 0.0, 0.0)


class Fading:
    """A mismatch (deg, deg/s, deg/s²) that fades out within `horizon` s."""

    def __init__(self, mismatch: tuple[float, float, float], horizon: float) -> None:
        e, rate, gain = mismatch
        self._horizon = horizon
        a0, a1, a2 = e, rate * horizon, 0.5 * gain * horizon * horizon
        self._terms = (
            a0,
            a1,
            a2,
            -(10.0 * a0 + 6.0 * a1 + 3.0 * a2),
            15.0 * a0 + 8.0 * a1 + 3.0 * a2,
            -(6.0 * a0 + 3.0 * a1 + a2),
        )

    def at(self, t: float) -> MotionState:
        """Mismatch and its derivatives after t s."""
        h = self._horizon
        s = t / h
        if s >= 1.0:
            return 0.0, 0.0, 0.0, 0.0
        a0, a1, a2, a3, a4, a5 = self._terms
        return (
            a0 + s * (a1 + s * (a2 + s * (a3 + s * (a4 + s * a5)))),
            (a1 + s * (2.0 * a2 + s * (3.0 * a3 + s * (4.0 * a4 + s * 5.0 * a5)))) / h,
            (2.0 * a2 + s * (6.0 * a3 + s * (12.0 * a4 + s * 20.0 * a5))) / (h * h),
            (6.0 * a3 + s * (24.0 * a4 + s * 60.0 * a5)) / (h * h * h),
        )


def fading(mismatch: tuple[float, float, float], shortest: float, acceleration: float, limits: Limits) -> Fading:
    """The quickest one that stays within `limits` (of φ) together with the `acceleration` of the spindle.

    At least `shortest` s; if none does, the longest one.
    """
    horizon = shortest
    for _ in range(MOST_GROWTHS):
        found = Fading(mismatch, horizon)
        if mismatch == NO_MISMATCH or _fits(found, horizon, acceleration, limits):
            return found
        horizon *= GROWTH
    return Fading(mismatch, horizon)


def _fits(found: Fading, horizon: float, acceleration: float, limits: Limits) -> bool:
    most = ACCELERATION_SHARE * min(limits.acceleration, limits.deceleration)
    for place in range(LOOKS):
        _, _, gain, jerk = found.at(horizon * place / LOOKS)
        if (place and abs(gain + acceleration) > most) or abs(jerk) > JERK_SHARE * limits.jerk:
            return False
    return True
