"""PI velocity controller of the NC, for drives that take torque commands."""

from __future__ import annotations


class VelocityController:
    """M = k · Kp · (e + 1/Tn · ∫e dt), e = commanded - actual velocity; k makes an acceleration a torque."""

    __slots__ = ("_cycle_share", "_gain", "_integral")

    def __init__(self, *, gain: float, integral_time: float, torque_per_acceleration: float, cycle_time: float) -> None:
        """`gain` in 1/s, `integral_time` in s (0 = proportional), `torque_per_acceleration` in Nm (N) for 1 mm/s²."""
        self._gain = gain * torque_per_acceleration
        self._cycle_share = cycle_time / integral_time if integral_time else 0.0
        self._integral = 0.0

    def torque(self, velocity_error: float) -> float:
        """Torque command of this cycle, Nm (N)."""
        self._integral += velocity_error * self._cycle_share
        return self._gain * (velocity_error + self._integral)

    def brake(self, velocity: float) -> float:
        """Torque that brakes the actual `velocity` (mm/s, deg/s) while the loop is open; clears the integral."""
        self._integral = 0.0
        return -self._gain * velocity
