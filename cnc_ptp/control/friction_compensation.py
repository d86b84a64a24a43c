"""Friction compensation: an additional motor current over the commanded velocity, weighted around reversals.

Source: TF5200 friction 2.1 (table, weighting before and after a reversal), 5.2.2.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from itertools import pairwise

from cnc_ptp.control.history import SetpointHistory
from cnc_ptp.parameters.view.control_view import FrictionParameters

COUPLING_TIME = 0.1
"""Seconds in which the current rises or falls when it is switched in motion."""


class FrictionTable:
    """Current over |velocity|: linear between the entries, constant outside; odd in the velocity."""

    __slots__ = ("_currents", "_slopes", "_velocities")

    def __init__(self, velocities: tuple[float, ...], currents: tuple[float, ...]) -> None:
        """`velocities` ascending from 0 on in mm/s (deg/s), `currents` in the unit of the drive."""
        self._velocities, self._currents = velocities, currents
        points = list(zip(velocities, currents, strict=True))
        self._slopes = [(i1 - i0) / (v1 - v0) for (v0, i0), (v1, i1) in pairwise(points)]

    def current(self, velocity: float) -> float:
        """For the magnitude of `velocity`, without its sign."""
        speed, velocities = abs(velocity), self._velocities
        above = bisect_right(velocities, speed)
        if above == 0:
            return self._currents[0]
        if above == len(velocities):
            return self._currents[-1]
        return self._currents[above - 1] + self._slopes[above - 1] * (speed - velocities[above - 1])


class FrictionCompensation:
    """The current of one axis, cycle by cycle; `current` in the unit of the drive holds after `update`."""

    __slots__ = (
        "_active",
        "_behind",
        "_delayed",
        "_direction",
        "_factor",
        "_lookahead",
        "_moving",
        "_position_delay",
        "_reversed_at",
        "_step",
        "_table",
        "current",
        "on",
        "permitted",
    )

    def __init__(self, parameters: FrictionParameters, *, delay_cycles: int, cycle_time: float) -> None:
        """`delay_cycles`: by how many cycles the position controller works behind the newest setpoint."""
        self.permitted = parameters.permitted
        self._active = self.on = parameters.active
        self._table = FrictionTable(parameters.velocities, parameters.currents) if parameters.velocities else None
        self._lookahead = min(parameters.reversal_lookahead, delay_cycles)
        self._behind = delay_cycles
        self._position_delay = parameters.position_delay
        self._delayed: deque[float] = deque([0.0] * parameters.delay_cycles)
        self._direction = 0.0
        self._reversed_at: float | None = None
        self._moving = False
        self._factor, self._step = float(self.on), cycle_time / COUPLING_TIME
        self.current = 0.0

    @property
    def effective(self) -> bool:
        """P-AXIS-00522 and P-COMP-00041 are set, the table has entries: switched on, it outputs a current."""
        return self._active and self._table is not None

    def follow(self, before: FrictionCompensation) -> None:
        """Takes over how another one was switched, at a standstill."""
        if before._active:
            self.switch(before.on)

    def switch(self, on: bool) -> None:
        """COMP ON FRICT, COMP OFF FRICT; with P-COMP-00041 = 0 it stays off.

        Immediately at a standstill, else softly or with the next reversal.
        """
        self.on = on and self._active
        if not self._moving:
            self._factor = float(self.on)

    def forget(self) -> None:
        """The loop is open: no current, and no previous motion that could reverse."""
        self._direction, self._reversed_at, self.current = 0.0, None, 0.0
        self._moving, self._factor = False, float(self.on)
        for index in range(len(self._delayed)):
            self._delayed[index] = 0.0

    def update(self, history: SetpointHistory) -> None:
        """The current of this cycle, whose setpoint `history` has."""
        position, velocity = history.position(self._behind), history.velocity(self._behind)
        value = 0.0
        self._moving = velocity != 0.0
        if self._moving:
            self._note_direction(position, velocity, history)
            self._couple()
            if self._factor and self._table is not None:
                value = self._factor * self._table.current(velocity) * self._weight(position, velocity, history)
                value = value if velocity > 0.0 else -value
        else:
            self._factor = float(self.on)
        if self._delayed:
            self._delayed.append(value)
            value = self._delayed.popleft()
        self.current = value

    def _couple(self) -> None:
        """One cycle nearer to on or off; in motion an immediate change would make the current step."""
        target = float(self.on)
        self._factor = min(target, self._factor + self._step) if target else max(target, self._factor - self._step)

    def _note_direction(self, position: float, velocity: float, history: SetpointHistory) -> None:
        """Notes where the axis has reversed: at the farther of its two positions around that instant.

        The current changes its sign there, so it may be switched.
        """
        direction = 1.0 if velocity > 0.0 else -1.0
        if direction != self._direction:
            if self._direction != 0.0:
                self._factor = float(self.on)
                before = history.position(self._behind + 1)
                self._reversed_at = min(position, before) if velocity > 0.0 else max(position, before)
            self._direction = direction

    def _weight(self, position: float, velocity: float, history: SetpointHistory) -> float:
        weight = 1.0
        if self._reversed_at is not None:
            distance = abs(position - self._reversed_at)
            if distance < self._position_delay:
                weight = distance / self._position_delay
            else:
                self._reversed_at = None
        cycles = self._cycles_to_reversal(velocity, history)
        return min(weight, cycles / self._lookahead) if cycles else weight

    def _cycles_to_reversal(self, velocity: float, history: SetpointHistory) -> int:
        """Cycles up to the first one that does not move in the direction of `velocity`; 0: no reversal ahead."""
        end = 0
        for cycles in range(1, self._lookahead + 1):
            onward = history.velocity(self._behind - cycles) * velocity
            if onward <= 0.0 and not end:
                end = cycles
            if onward < 0.0:
                return end
            if onward > 0.0:
                end = 0
        return 0
