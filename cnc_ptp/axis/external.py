"""External setpoints: an external generator moves the axis, alone or superimposed on its PTP motion (TX1250 2.6)."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple

from cnc_ptp.axis.tables import standing
from cnc_ptp.motion import Limits, Profile, plan_to_velocity
from cnc_ptp.motion.limits import LARGEST_STATE, rounding
from cnc_ptp.motion.setpoints import MotionState

LONGEST_PERIOD = 0.02
"""Seconds between two setpoints of a cyclic task; a longer distance is a pause."""
NEGLIGIBLE_VELOCITY = 1e-9
"""mm/s (deg/s): rounding of an external generator; a slower last setpoint is at a standstill."""
ABSOLUTE = "absolute"
RELATIVE = "relative"


class Setpoint(NamedTuple):
    """The commanded state of the axis in `cycle`, in mm, mm/s, mm/s² (deg for rotary axes).

    `direction` 0 ends the motion: that position is taken over once more, then setpoints are ignored until -1 or +1
    comes.
    """

    cycle: int
    position: float
    velocity: float
    acceleration: float
    direction: int


def read_setpoint(row: object) -> Setpoint:
    """A setpoint from five numbers. Raises ValueError with the reason if they are none."""
    names = ", ".join(Setpoint._fields)
    if not isinstance(row, (list, tuple)):
        raise ValueError(f"a setpoint needs {names}; {row!r} is not a list of them")
    if len(row) != len(Setpoint._fields):
        raise ValueError(f"a setpoint needs {names}; {list(row)} has {len(row)} values")
    for name, value in zip(Setpoint._fields, row, strict=True):
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not is_number or not -LARGEST_STATE <= value <= LARGEST_STATE:
            raise ValueError(f"{name} = {value!r} is not a number within ±{LARGEST_STATE:g}")
    cycle, position, velocity, acceleration, direction = row
    if cycle < 0 or cycle != int(cycle):
        raise ValueError(f"cycle = {cycle} is not a whole number from 0 on")
    if direction not in (-1, 0, 1):
        raise ValueError(f"setpoint of cycle {int(cycle)}: direction = {direction} is not one of -1, 0, 1")
    return Setpoint(int(cycle), float(position), float(velocity), float(acceleration), int(direction))


def read_setpoints(rows: Iterable[object]) -> list[Setpoint]:
    """Setpoints from rows of five numbers, in ascending cycles. Raises ValueError with the first reason."""
    setpoints = [read_setpoint(row) for row in rows]
    for before, setpoint in pairwise(setpoints):
        check_order(before.cycle, setpoint)
    return setpoints


def check_order(before: int, setpoint: Setpoint) -> None:
    """Raises ValueError when `setpoint` does not come after the cycle `before`."""
    if setpoint.cycle <= before:
        raise ValueError(f"setpoint of cycle {setpoint.cycle}: comes after cycle {before}; cycles must ascend")


class ExternalSetpoints:
    """The contribution of external setpoints, added to the basic motion cycle by cycle.

    `at` must be called in the order of cycles; for the same cycle it may be called again. Between two setpoints the
    axis continues with velocity and acceleration of the last one, at most to standstill. When the setpoints end
    in motion, the contribution comes to rest on the ramp of the axis.
    """

    def __init__(self, *, cycle_time: float, dead_time: float, limits: Limits) -> None:
        """`cycle_time` in s; `dead_time` in s by which setpoints come late; `limits` of the axis."""
        self._cycle_time = cycle_time
        self._dead_time = dead_time
        self.limits = limits
        self._waiting: deque[Setpoint] = deque()
        self._driving: Setpoint | None = None
        self._period = 1
        self._longest_period = max(1, round(LONGEST_PERIOD / cycle_time))
        self._last_cycle: int | None = None
        self._rest = standing(0.0)
        self._rest_cycle = 0
        self._reference = 0.0
        self._velocity = 0.0
        """What was contributed in the cycle of the last `at`."""
        self.mode: str | None = None
        """absolute, relative, or None while disabled."""
        self.rejected: tuple[Setpoint, float] | None = None
        """A setpoint too far away to be reached, with its distance (mm, deg); it was not taken over."""

    # commands

    def enable(self, cycle: int, mode: str, position: float) -> None:
        """Setpoints count from `cycle` on, at which the axis is at `position`. No effect if already enabled.

        Absolute setpoints are positions of the axis, relative ones count from where the axis is now.
        """
        if self.mode is None:
            self._period = 1
            contribution = self.contribution(cycle)[0]
            self._reference = position - contribution if mode == ABSOLUTE else -contribution
            self.mode = mode

    def carry(self, position: float) -> None:
        """The contribution alone places the axis, the basic motion rests at 0: setpoints come out to the bit."""
        self._rest = standing(position)

    def takes(self, cycle: int) -> bool:
        """True for setpoints that come at `cycle` while enabled, or with the command that disables."""
        return self.mode is not None or self._last_cycle == cycle

    @property
    def newest_cycle(self) -> int:
        """Cycle of the newest setpoint that waits or drives the axis; -1 without one."""
        if self._waiting:
            return self._waiting[-1].cycle
        return -1 if self._driving is None else self._driving.cycle

    def feed(self, setpoints: Iterable[Setpoint]) -> None:
        """Takes setpoints in the order of their cycles; once disabled, none after the last cycle.

        The end of a motion (direction 0) replaces what waits from its cycle on.
        """
        last = self._last_cycle if self.mode is None else None
        for setpoint in setpoints:
            if setpoint.direction == 0:
                self._waiting = deque(waiting for waiting in self._waiting if waiting.cycle < setpoint.cycle)
            if last is None or setpoint.cycle <= last:
                self._waiting.append(setpoint)

    def disable(self, cycle: int) -> None:
        """The setpoint of `cycle` is taken over once more, then the contribution comes to rest."""
        self.mode = None
        self._waiting = deque(setpoint for setpoint in self._waiting if setpoint.cycle <= cycle)
        if self._driving is not None and self._last_cycle is None:
            self._last_cycle = cycle

    def brake(self, cycle: int, state: MotionState) -> None:
        """Another motion ends at `cycle` with `state`: it comes to rest here, in addition to what is contributed."""
        position, velocity = self.contribution(cycle)[0] + state[0], state[1]
        self._rest, self._rest_cycle = plan_to_velocity(position, velocity, 0.0, 0.0, self.limits), cycle

    def reset(self) -> None:
        """The basic motion has taken over what was contributed."""
        self.mode = self._driving = self._last_cycle = self.rejected = None
        self._waiting.clear()
        self._rest = standing(0.0)

    # setpoints

    def moving(self, cycle: int) -> bool:
        """True while a setpoint drives the axis or the contribution comes to rest."""
        return self._driving is not None or (cycle - self._rest_cycle) * self._cycle_time < self._rest.duration

    def silence(self, cycle: int) -> int:
        """Cycles for which the axis has been moving on without a new setpoint, in the cycle of the last `at`."""
        if self._driving is None or self._velocity == 0.0:
            return 0
        return cycle - self._driving.cycle

    def zero(self, cycle: int) -> float:
        """The lasting part of the contribution: without relative setpoints, or once it is at rest after the end."""
        if self.mode is not None:
            return -self._reference if self.mode == RELATIVE else self.contribution(cycle)[0]
        rest = self._rest if self._driving is None else self._to_rest(self._driving, cycle)
        return rest.end[0]

    def at(self, cycle: int, base: MotionState) -> MotionState:
        """Basic motion plus contribution at `cycle`; takes the setpoints that have come due."""
        self._advance(cycle)
        position, velocity, acceleration, jerk = base
        p, v, a, j = self.contribution(cycle)
        self._velocity = v
        return position + p, velocity + v, acceleration + a, jerk + j

    def contribution(self, cycle: int) -> MotionState:
        """What the external setpoints add at `cycle`."""
        if self._driving is not None:
            return self._driven(self._driving, cycle)
        return self._rest.state_at((cycle - self._rest_cycle) * self._cycle_time)

    def _driven(self, setpoint: Setpoint, cycle: int) -> MotionState:
        """The setpoint (its position is that of the contribution) brought forward to `cycle` and by the dead time.

        At most to where it comes to rest.

        Its acceleration counts for the usual time between setpoints, so that silence does not speed the axis up.
        """
        d = (cycle - setpoint.cycle) * self._cycle_time + self._dead_time
        position, v, a = setpoint.position, setpoint.velocity, setpoint.acceleration
        if v == 0.0 and a * setpoint.direction <= 0.0:
            return position, 0.0, a if d == 0.0 else 0.0, 0.0
        ramp = min(d, self._period * self._cycle_time + self._dead_time)
        if a * v < 0.0 and ramp >= -v / a:
            return position - 0.5 * v * v / a, 0.0, 0.0, 0.0
        return position + d * v + a * ramp * (d - 0.5 * ramp), v + a * ramp, a if d == ramp else 0.0, 0.0

    def _advance(self, cycle: int) -> None:
        """Takes the setpoints that have come due; a late one counts from now on, brought forward."""
        self._come_to_rest(cycle)
        while self._waiting and self._waiting[0].cycle <= cycle:
            setpoint = self._waiting.popleft()
            if setpoint.direction == 0 and self._driving is None:
                continue
            if self._driving is not None and setpoint.cycle <= self._driving.cycle:
                self._last_cycle = cycle  # an end that was overtaken: it counts, its position is out of date
                continue
            driving = setpoint._replace(position=setpoint.position - self._reference)
            distance = self._driven(driving, cycle)[0] - self.contribution(cycle - 1)[0]
            farthest = self.limits.velocity * self._cycle_time * (1.0 + 1e-9)
            if abs(distance) > farthest + rounding(setpoint.position, self._reference):
                self.rejected = setpoint, distance
                self._waiting.clear()
                return
            if self._driving is not None:
                self._period = min(setpoint.cycle - self._driving.cycle, self._longest_period)
            self._driving = driving
            self._last_cycle = cycle if setpoint.direction == 0 or self.mode is None else None

    def _come_to_rest(self, cycle: int) -> None:
        """Comes to rest after the last cycle of the setpoints."""
        if self._driving is None or self._last_cycle is None or cycle <= self._last_cycle:
            return
        self._rest = self._to_rest(self._driving, self._last_cycle)
        self._rest_cycle = self._last_cycle
        self._driving = self._last_cycle = None

    def _to_rest(self, driving: Setpoint, cycle: int) -> Profile:
        """The ramp to rest from `cycle` on; a setpoint at a standstill stays where it is.

        Setpoints know no jerk limit, and neither does their end: their acceleration ends too. On the jerk limit of
        the axis it would raise the velocity further by a²/2J.
        """
        position, velocity, _, _ = self._driven(driving, cycle)
        if abs(velocity) <= NEGLIGIBLE_VELOCITY:
            velocity = 0.0
        return plan_to_velocity(position, velocity, 0.0, 0.0, self.limits)
