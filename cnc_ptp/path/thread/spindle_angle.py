"""Where a spindle will be: a parabola through the actual angles that it has reported last.

With u = -(N-1)/2 … (N-1)/2 for the last N cycles and sums over them, the least squares fit c0 + c1·u + c2·u² has

    c1 = Σu·y / Σu²      c2 = Σ(u² - Σu²/N)·y / (Σu⁴ - (Σu²)²/N)      c0 = (Σy - c2·Σu²) / N
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Final

from cnc_ptp.motion.setpoints import MotionState

SAMPLES: Final = 12
"""Cycles whose angles count."""
TREND: Final = 0.03
"""s for which the spindle is taken to keep its acceleration; then it keeps its speed."""
_CENTRE: Final = 0.5 * (SAMPLES - 1)
_PLACES: Final = [index - _CENTRE for index in range(SAMPLES)]
_SQUARES: Final = sum([u * u for u in _PLACES])
_MEAN: Final = _SQUARES / SAMPLES
_BENT: Final = [u * u - _MEAN for u in _PLACES]
_BENT_SQUARES: Final = sum([w * w for w in _BENT])


class SpindleAngle:
    """The actual angle of a spindle, deg, and what is to be expected of it."""

    def __init__(self, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self._cycle_time = cycle_time
        self._angles: deque[float] = deque(maxlen=SAMPLES)
        self._last_cycle = 0
        self._state = (0.0, 0.0, 0.0)
        """Angle, speed and acceleration in the last cycle, on the parabola."""

    def read(self, first_cycle: int, angles: Sequence[float]) -> None:
        """Actual angles of the cycles from `first_cycle` on; behind a gap those before it do not count."""
        if first_cycle != self._last_cycle + 1:
            self._angles.clear()
        self._angles.extend(angles)
        self._last_cycle = first_cycle + len(angles) - 1
        if self.known:
            self._state = self._fit()

    @property
    def known(self) -> bool:
        """Enough cycles were reported."""
        return len(self._angles) == SAMPLES

    @property
    def speed(self) -> float:
        """deg/s, signed."""
        return self._state[1]

    @property
    def acceleration(self) -> float:
        """deg/s², signed."""
        return self._state[2]

    def _fit(self) -> tuple[float, float, float]:
        last = self._angles[-1]
        total = tilt = bend = 0.0
        for index, angle in enumerate(self._angles):
            y = angle - last
            total += y
            tilt += _PLACES[index] * y
            bend += _BENT[index] * y
        c2 = bend / _BENT_SQUARES
        c1 = tilt / _SQUARES
        c0 = total / SAMPLES - c2 * _MEAN
        t = self._cycle_time
        at_last = c0 + _CENTRE * (c1 + _CENTRE * c2)
        return last + at_last, (c1 + 2.0 * c2 * _CENTRE) / t, 2.0 * c2 / (t * t)

    def at(self, cycle: float) -> MotionState:
        """Angle, speed, acceleration and jerk expected at a cycle (also between two of them).

        A spindle that brakes stays where it stops.
        """
        angle, speed, acceleration = self._state
        t = (cycle - self._last_cycle) * self._cycle_time
        ends = TREND
        if speed * acceleration < 0.0:
            ends = min(ends, -speed / acceleration)
        trend = min(t, ends)
        angle += trend * (speed + 0.5 * trend * acceleration)
        speed += trend * acceleration
        if t > ends:
            return angle + (t - trend) * speed, speed, 0.0, 0.0
        return angle, speed, acceleration, 0.0
