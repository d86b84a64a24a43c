"""Monitoring of the following error: fixed, linear in the velocity, or after an estimation filter.

Sources: P-AXIS-00167, 00168, 00169, 00172 (axis list); TF5200 axis position lag, types 1, 2 and 4. The formulas of the
factor P-AXIS-00167 are missing in the available texts and read so that 1024 switches the monitoring off.
"""

from __future__ import annotations

from math import ceil, inf

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.view.control_view import ESTIMATED, FIXED, LINEAR, MONITORING_TYPES, LagMonitoring

BY_ESTIMATE = f"{ids.GETRIEBE_SLEP_DYN}, estimated"
BY_VELOCITY = f"{ids.GETRIEBE_SLEP_DYN}, linear"
SCALE = 1024
SETTLING = 5.0
"""Time constants 1/Kv that the lag of a motion has to fall before the axis counts as at a standstill."""


class FollowingErrorMonitor:
    """Decides in each cycle which following error is too large; `advance` once per cycle."""

    __slots__ = (
        "_above",
        "_cycle_time",
        "_estimate",
        "_factor",
        "_kind",
        "_moving",
        "_needed",
        "_rest",
        "_settling",
        "_standing",
        "on",
    )

    def __init__(self, parameters: LagMonitoring, *, kv: float, cycle_time: float) -> None:
        """`kv` in 1/s, `cycle_time` in s."""
        self._cycle_time = cycle_time
        self._estimate = 0.0
        self._above = self._rest = 0
        self.take(parameters, kv=kv)

    def take(self, parameters: LagMonitoring, *, kv: float) -> None:
        """Other limits; what has been observed so far stays."""
        off = parameters.kind in (ESTIMATED, LINEAR) and parameters.dynamic >= SCALE
        self._kind = 0 if off else parameters.kind
        self.on = self._kind in MONITORING_TYPES
        self._moving, self._standing = parameters.moving_limit, parameters.standstill_limit
        self._factor = parameters.dynamic / SCALE
        if self._kind == LINEAR:
            self._factor = SCALE / (SCALE - parameters.dynamic) / kv
        self._settling = ceil(SETTLING / kv / self._cycle_time)
        self._needed = round(parameters.filter_time / self._cycle_time)

    def source(self, velocity: float) -> str:
        """The parameter that sets `limit`, for messages."""
        return self._limit(velocity)[1]

    def limit(self, velocity: float) -> float:
        """Largest following error at a set velocity, mm (deg).

        Type 4: P-AXIS-00168, at a standstill P-AXIS-00169. Type 2: v/Kv · 1024/(1024 - P-AXIS-00167), at least
        P-AXIS-00168; at a standstill P-AXIS-00169. Type 1: e' = e · P-AXIS-00167/1024 + |v| · T, within P-AXIS-00169
        and P-AXIS-00168.
        """
        return self._limit(velocity)[0]

    def _limit(self, velocity: float) -> tuple[float, str]:
        kind, moving, standing = self._kind, self._moving, self._standing
        if kind == ESTIMATED:
            estimate = self._next_estimate(velocity)
            if max(standing, estimate) >= moving:
                return moving, ids.GETRIEBE_SLEP_MAX
            return (estimate, BY_ESTIMATE) if estimate > standing else (standing, ids.GETRIEBE_SLEP_MIN)
        if kind not in (LINEAR, FIXED):
            return inf, ""
        if velocity == 0.0 and self._rest >= self._settling:
            return standing, ids.GETRIEBE_SLEP_MIN
        linear = abs(velocity) * self._factor if kind == LINEAR else 0.0
        return (linear, BY_VELOCITY) if linear > moving else (moving, ids.GETRIEBE_SLEP_MAX)

    def exceeded(self, following_error: float, velocity: float) -> bool:
        """True when the error has been above the limit for longer than the filter time; changes nothing."""
        return abs(following_error) > self.limit(velocity) and self._above >= self._needed

    def advance(self, following_error: float, velocity: float) -> None:
        """Ends this cycle."""
        self._rest = self._rest + 1 if velocity == 0.0 else 0
        if self._needed:
            self._above = self._above + 1 if abs(following_error) > self.limit(velocity) else 0
        if self._kind == ESTIMATED:
            self._estimate = self._next_estimate(velocity)

    def forget(self) -> None:
        """The loop is open."""
        self._estimate, self._above, self._rest = 0.0, 0, 0

    def _next_estimate(self, velocity: float) -> float:
        return self._estimate * self._factor + abs(velocity) * self._cycle_time
