"""The motions that commands ask for: where each ends, seen from where it begins. Positions are those of the axis."""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import copysign

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import SLAVE_LOCKED, START_BESIDE_EXTERNAL, TRAJECTORY_RUNS
from cnc_ptp.axis.modulo import modulo_target
from cnc_ptp.motion import Limits
from cnc_ptp.motion.limits import rounding

BESIDE_EXTERNAL = "external setpoints are enabled; a PTP start is not permitted at the same time"


def refuse_other_source(axis: Axis, command: str, beside_external: str = BESIDE_EXTERNAL) -> None:
    """Raises 23027 and 23040 if external setpoints or a master move the axis."""
    if axis.external.mode is not None:
        axis.refuse(command, START_BESIDE_EXTERNAL, beside_external)
    if axis.coupled and axis.coupling is not None:
        reason = f"the axis is a slave of {axis.coupling.master}; decouple it"
        axis.refuse(command, SLAVE_LOCKED, reason, master=axis.coupling.master)


def refuse_beside_trajectory(axis: Axis, command: str) -> None:
    """Raises 23067 for what would move the axis away from its trajectory."""
    if axis.ptp.follows:
        axis.refuse(command, TRAJECTORY_RUNS, "the axis follows a trajectory; stop it first")


class Motion(ABC):
    """A motion with its limits, and the warning of the command that asks for it."""

    def __init__(self, command: str, limits: Limits, warning: str | None) -> None:
        self.command = command
        self.limits = limits
        self.warning = warning
        self.endless = False
        """At a velocity; on a linear axis up to its soft limit."""

    @abstractmethod
    def goal(self, axis: Axis, start: float) -> float:
        """Where it ends if it begins at `start`."""

    def start(self, axis: Axis, cycle: int) -> float:
        """What it counts from if it begins now."""
        return axis.setpoint(cycle)[0]

    def check(self, axis: Axis, start: float, goal: float, *, at_rest: bool) -> None:
        """Raises 120002, 120003, 23002 for a motion that leads beyond the limits; it begins `at_rest` or in motion."""
        axis.checks.soft_limits(self.command, goal)

    def shift(self, distance: float) -> None:
        """All coordinates of the axis grow by `distance` while it waits; what is relative stays."""
        return


class ToTarget(Motion):
    """Positioning to `target`."""

    def __init__(self, command: str, limits: Limits, warning: str | None, target: float) -> None:
        super().__init__(command, limits, warning)
        self._target = target

    def goal(self, axis: Axis, start: float) -> float:
        return self._target

    def shift(self, distance: float) -> None:
        self._target += distance


class ByDistance(Motion):
    """Positioning over a distance; `additive`: from the target of the last positioning, whatever became of it."""

    def __init__(
        self, command: str, limits: Limits, warning: str | None, distance: float, *, additive: bool = False
    ) -> None:
        super().__init__(command, limits, warning)
        self._distance = distance
        self._additive = additive

    def goal(self, axis: Axis, start: float) -> float:
        return start + self._distance

    def start(self, axis: Axis, cycle: int) -> float:
        """See Motion."""
        last = axis.last_target if self._additive else None
        return axis.setpoint(cycle)[0] if last is None else last


class ToModulo(Motion):
    """Positioning within a turn (TX1250 2.1)."""

    def __init__(self, command: str, limits: Limits, warning: str | None, position: float) -> None:
        super().__init__(command, limits, warning)
        self._position = position

    def goal(self, axis: Axis, start: float) -> float:
        return modulo_target(start, self._position, axis.modulo_range[1])


class AtVelocity(Motion):
    """Endless motion in the direction of `velocity`, on a linear axis up to its soft limit."""

    def __init__(self, command: str, limits: Limits, warning: str | None, velocity: float) -> None:
        super().__init__(command, limits, warning)
        self._velocity = velocity
        self.endless = True

    def goal(self, axis: Axis, start: float) -> float:
        return axis.checks.soft_limit(self._velocity).position

    def check(self, axis: Axis, start: float, goal: float, *, at_rest: bool) -> None:
        """Raises 120002 and 120003 outwards from the soft limit at which, or beyond which, the axis is."""
        limit = axis.checks.soft_limit(self._velocity)
        room = copysign(1.0, self._velocity) * (limit.position - start)
        if room < -rounding(limit.position, start):
            reason = f"the axis is at {start} {axis.unit}, beyond its {limit.text}"
            axis.refuse(self.command, limit.number, reason, position=start, limit=limit.position)
        if room <= axis.parameters.encoder_increment and at_rest:
            axis.refuse(self.command, limit.number, f"the axis is at its {limit.text}", limit=limit.position)


class AtRest(Motion):
    """Motion at velocity 0: the axis comes to rest, and waits there for another motion."""

    def __init__(self, command: str, limits: Limits, warning: str | None) -> None:
        super().__init__(command, limits, warning)
        self.endless = True

    def goal(self, axis: Axis, start: float) -> float:
        return start

    def check(self, axis: Axis, start: float, goal: float, *, at_rest: bool) -> None:
        """See Motion: it leads nowhere."""

    def room(self, axis: Axis, cycle: int) -> tuple[float, float]:
        """Where the basic motion may come to rest: from the negative soft limit to the positive one."""
        low, high = (axis.checks.soft_limit(direction).position for direction in (-1.0, 1.0))
        shift = axis.shift(cycle)
        return low - shift, high - shift
