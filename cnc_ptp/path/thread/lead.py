"""How the path comes to where its spindle is: the mismatch e between both (deg) goes to 0.

A small one fades out by a polynomial of fifth degree within the horizon H. With e, e', e'' at the beginning, s = t/H
and a0 = e, a1 = e'·H, a2 = e''·H²/2:

    e(s) = a0 + a1·s + a2·s² - (10·a0 + 6·a1 + 3·a2)·s³ + (15·a0 + 8·a1 + 3·a2)·s⁴ - (6·a0 + 3·a1 + a2)·s⁵

It ends with e = e' = e'' = 0. One that is too large for this, within the acceleration and jerk of the axes, is made up
for as fast as they permit: the longer it lasts, the longer the pitch is wrong.
"""

from __future__ import annotations

from typing import Final, Protocol

from cnc_ptp.motion import Limits, plan_to_position
from cnc_ptp.motion.setpoints import MotionState

LOOKS: Final = 8
"""Places at which velocity and acceleration of a polynomial are looked at."""
ACCELERATION_SHARE: Final = 0.9
"""What the acceleration of the spindle and the correction may take together."""
SMALLEST_SHARE: Final = 0.1
"""Of the acceleration that is left for the correction, whatever the spindle does."""
Mismatch = tuple[float, float, float]
"""deg, deg/s, deg/s² by which the path is ahead of its spindle."""


class Fading(Protocol):
    """A mismatch that goes to 0."""

    def at(self, t: float) -> MotionState:
        """The mismatch and its derivatives after t s."""


class SmoothFading:
    """By the polynomial, within `horizon` s."""

    def __init__(self, mismatch: Mismatch, horizon: float) -> None:
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
        """As Fading."""
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

    @property
    def largest_jerk(self) -> float:
        """deg/s³; it is a parabola over the time, so that is at an end or at its vertex."""
        h = self._horizon
        _, _, _, a3, a4, a5 = self._terms
        first, last = 6.0 * a3, 6.0 * a3 + 24.0 * a4 + 60.0 * a5
        found = max(abs(first), abs(last))
        if a5 and 0.0 < -0.2 * a4 / a5 < 1.0:
            found = max(found, abs(first - 2.4 * a4 * a4 / a5))
        return found / (h * h * h)


class QuickFading:
    """As fast as limits permit."""

    def __init__(self, mismatch: Mismatch, limits: Limits) -> None:
        e, rate, gain = mismatch
        self._profile = plan_to_position(e, rate, gain, 0.0, limits, direct=True)

    def at(self, t: float) -> MotionState:
        """As Fading."""
        return self._profile.state_at(t)


def fading(mismatch: Mismatch, horizon: float, acceleration: float, limits: Limits) -> Fading:
    """Smooth within `horizon` s, or if that is too fast for `limits` (of φ) as quickly as they permit.

    `acceleration` (deg/s²) is that of the spindle, which the correction comes on top of; the velocity of `limits` is
    what is left for it.
    """
    smooth = SmoothFading(mismatch, horizon)
    if not any(mismatch) or _fits(smooth, horizon, acceleration, limits):
        return smooth
    return QuickFading(mismatch, _left(acceleration, limits))


def _fits(found: SmoothFading, horizon: float, acceleration: float, limits: Limits) -> bool:
    if found.largest_jerk > limits.jerk:
        return False
    most = ACCELERATION_SHARE * min(limits.acceleration, limits.deceleration)
    for place in range(1, LOOKS):
        _, rate, gain, _ = found.at(horizon * place / LOOKS)
        if abs(rate) > limits.velocity or abs(gain + acceleration) > most:
            return False
    return True


def _left(acceleration: float, limits: Limits) -> Limits:
    """For a correction beside the acceleration of the spindle."""
    weakest = min(limits.acceleration, limits.deceleration)
    left = max(ACCELERATION_SHARE * weakest - abs(acceleration), SMALLEST_SHARE * weakest)
    return Limits(limits.velocity, left, left, limits.jerk)
