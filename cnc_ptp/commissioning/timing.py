"""Settling and measuring times of a motion at constant velocity."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Seconds = Callable[[float], float]
"""Seconds for a speed in mm/s (deg/s)."""
LAGS = 10.0
"""Time constants 1/Kv in which the position loop settles."""
BREAKING_TIME, BREAKING_WAY = 0.2, 1.0
"""Seconds, and mm (deg) after which they are not needed: a slow drive has to build up torque against the friction."""
LONGEST, SHORTEST, MEASURED_WAY = 0.5, 0.1, 50.0
"""Seconds that are measured: a distance of 50 mm (deg), but within these limits."""


@dataclass(frozen=True, slots=True)
class Timing:
    """Times at a constant velocity for a position controller gain `kv` in 1/s."""

    kv: float

    def settling(self, speed: float) -> float:
        """Seconds of settling, not used."""
        return LAGS / self.kv + min(BREAKING_TIME, BREAKING_WAY / speed)

    def steady(self, speed: float) -> float:
        """Seconds of constant velocity: settling and measuring."""
        return self.settling(speed) + min(LONGEST, max(SHORTEST, MEASURED_WAY / speed))


def always(seconds: float) -> Seconds:
    """The same for all speeds."""
    return lambda _speed: seconds


DYNAMIC_STEADY = always(0.05)
"""Times of motions that show the dynamics of a drive."""
