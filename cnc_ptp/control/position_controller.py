"""P position controller with following-error monitoring."""

from __future__ import annotations


class PositionController:
    """v_command = Kv * (set position - actual position).

    Kv in 1/s (P-AXIS-00099 is in 0.01/s). Source: TF5200 feedforward, figure 1; PTP 2.1 (set execution task).
    """

    __slots__ = ("following_error_limit", "kv", "monitoring")

    def __init__(self, *, kv: float, following_error_limit: float, monitoring: bool) -> None:
        """`following_error_limit` in mm or deg (P-AXIS-00168); `monitoring` switches it on (P-AXIS-00172)."""
        self.kv = kv
        self.following_error_limit = following_error_limit
        self.monitoring = monitoring

    def command_velocity(self, following_error: float) -> float:
        """Velocity command in mm/s or deg/s for a following error in mm or deg."""
        return self.kv * following_error

    def exceeds_limit(self, following_error: float) -> bool:
        return self.monitoring and abs(following_error) > self.following_error_limit
