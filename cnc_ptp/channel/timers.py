"""Timers of a program (#TIMER): they count the cycles of the run, so that they are the same in every run."""

from __future__ import annotations

from cnc_ptp.nc.canonical import Timer


class Timers:
    """All timers of a channel; they are kept from one program to the next."""

    def __init__(self, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self._milliseconds = cycle_time * 1000.0
        self._counted: dict[int, int] = {}
        """Cycles up to the last stop."""
        self._since: dict[int, int] = {}
        """The cycle at which a timer that runs was started."""
        self.read: dict[int, float] = {}
        """V.G.TIMER: what #TIMER READ has found, ms."""

    def carry_out(self, timer: Timer, cycle: int) -> None:
        """One command; `cycle` is the one at which its block begins."""
        number, action = timer.number, timer.action
        if action == "READ":
            self.read[number] = self._cycles(number, cycle) * self._milliseconds
        elif action == "START":
            self._since.setdefault(number, cycle)
        elif action == "STOP":
            self._counted[number] = self._cycles(number, cycle)
            self._since.pop(number, None)
        else:
            self._counted.pop(number, None)
            self._since.pop(number, None)

    def _cycles(self, number: int, cycle: int) -> int:
        running = cycle - self._since[number] if number in self._since else 0
        return self._counted.get(number, 0) + running
