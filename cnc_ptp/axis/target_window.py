"""Target window monitoring: the axis must reach the place where its setpoint has come to rest (TX1250 2.6, PEH)."""

from __future__ import annotations


class TargetWindow:
    """Monitors an axis from the end of a motion on; reports once that it has not come into the window in time."""

    def __init__(self, *, window: float, cycles: int) -> None:
        """`window` in mm (deg) to each side of the target; `cycles` after which it must be there, 0 = any time."""
        self.set(window=window, cycles=cycles)
        self._has_target = False
        self._watching = False
        self._has_moved = False
        self._standing_since: int | None = None
        self.target: float | None = None
        """Where the motion was to end; None: wherever the setpoint comes to rest."""

    def set(self, *, window: float, cycles: int) -> None:
        """Another window and time."""
        self._window = window
        self._cycles = cycles

    @property
    def watching(self) -> bool:
        """True from the start of a motion until the axis is in its window, or is found not to be."""
        return self._watching

    def watch(self, target: float | None = None) -> None:
        """A motion begins."""
        self._has_target = self._watching = True
        self._has_moved = False
        self._standing_since = None
        self.target = target

    def forget(self) -> None:
        """A fault ended the motion: there is no longer a target."""
        self._has_target = self._watching = False

    def moves(self) -> None:
        """The setpoint still moves in this cycle."""
        self._has_moved = True
        self._standing_since = None

    def error(self, set_position: float, actual_position: float) -> float:
        """Distance between the axis and its target, mm (deg)."""
        return actual_position - (set_position if self.target is None else self.target)

    def reached(self, set_position: float, actual_position: float) -> bool:
        """For a setpoint at a standstill: the axis is in the window of its last target."""
        return self._has_target and abs(self.error(set_position, actual_position)) <= self._window

    def overdue(self, cycle: int, set_position: float, actual_position: float) -> bool:
        """For a setpoint at its end: True once when the axis should have been in its window by `cycle`."""
        if not (self._watching and self._has_moved):
            return False
        if self._standing_since is None:
            self._standing_since = cycle
        late = self._cycles > 0 and cycle - self._standing_since >= self._cycles
        inside = self.reached(set_position, actual_position)
        self._watching = not (inside or late)
        return late and not inside
