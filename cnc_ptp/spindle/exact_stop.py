"""Exact stop: a position is reached when the spindle has been there, at rest, for a while (TF5200 spindle 2.5, 2.6)."""

from __future__ import annotations

from math import ceil, inf

ROUNDING = 1e-9
"""Part of a cycle."""


class ExactStop:
    """Position and speed have been within their windows for a time; from then on the position alone counts."""

    def __init__(self, *, time: float, cycle_time: float) -> None:
        """Both in s."""
        self._cycles = ceil(time / cycle_time - ROUNDING)
        self._since: int | None = None
        self.reached = False
        self.left_at = inf
        """First cycle in which a position that was reached was lost again; infinite until then."""

    @property
    def settles(self) -> bool:
        """Within both windows in the last cycle."""
        return self._since is not None

    def forget(self) -> None:
        """Starts anew for another target, or none."""
        self._since, self.reached, self.left_at = None, False, inf

    def note(self, cycle: int, *, in_position: bool, at_rest: bool) -> bool:
        """True once the position is reached; to be called in every cycle from the end of the setpoint on."""
        if self.reached and not in_position:
            self.reached, self.left_at = False, float(cycle)
        if not self.reached:
            self._settle(cycle, in_position and at_rest)
        return self.reached

    def _settle(self, cycle: int, within: bool) -> None:
        if not within:
            self._since = None
            return
        if self._since is None:
            self._since = cycle
        if cycle - self._since >= self._cycles:
            self.reached, self.left_at = True, inf
