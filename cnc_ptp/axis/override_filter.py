"""Override filter: removes the noise of a potentiometer from the override, as the PLC library of the vendor does."""

from __future__ import annotations


class OverrideFilter:
    """Passes an override on in steps, at most once per interval; 0 and 100 % immediately."""

    def __init__(self, *, steps: int, interval_cycles: int) -> None:
        """`steps` between 0 and 100 %, 0 = no filter; `interval_cycles` between two values that are passed on."""
        self._steps = steps
        self._interval = interval_cycles
        self._waiting: float | None = None
        self._passed_cycle = -interval_cycles

    def take(self, cycle: int, percent: float) -> float | None:
        """An override given at `cycle`: the percentage to be used now, None when it has to wait."""
        if self._steps == 0 or percent in (0.0, 100.0):
            return self._pass_on(cycle, percent)
        self._waiting = max(1, round(0.01 * percent * self._steps)) * 100.0 / self._steps
        return self.due(cycle)

    @property
    def due_cycle(self) -> int | None:
        """The cycle at which a waiting override is to be used, if one waits."""
        return None if self._waiting is None else self._passed_cycle + self._interval

    def due(self, cycle: int) -> float | None:
        """The percentage that has waited for the interval to end at `cycle`, if any."""
        if self._waiting is None or cycle - self._passed_cycle < self._interval:
            return None
        return self._pass_on(cycle, self._waiting)

    def _pass_on(self, cycle: int, percent: float) -> float:
        self._waiting = None
        self._passed_cycle = cycle
        return percent
