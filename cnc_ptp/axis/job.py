"""What the PTP generator of an axis is to do: positionings, endless motion, a new velocity on the way."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import copysign, isinf

from cnc_ptp.motion import (
    Limits,
    Profile,
    plan_rest_to_rest,
    plan_through_position,
    plan_to_position,
    plan_to_velocity,
    plan_with_ramp,
)
from cnc_ptp.motion.limits import SMALLEST_LIMIT

Start = tuple[float, float, float]
"""Position, velocity, acceleration of the axis where a table starts."""


@dataclass(frozen=True, slots=True)
class Job:
    """A positioning: its target, its limits, and the velocity that its last part can reach within them.

    The velocity of the limits is the commanded one; it may become reachable with a new target.
    A target at ±infinity is endless motion in that direction.
    """

    target: float
    limits: Limits
    reduced_velocity: float
    ramp: Limits | None = None
    """What has moved the axis before: its A- and J count where those of the limits would lead past the target, or too
    fast."""
    through: float = 0.0
    """Signed velocity (mm/s, deg/s) with which it passes its target (blending); 0: it ends there."""
    jog: bool = False
    """Only another jog may change it."""
    stands: bool = False
    """Endless at velocity 0."""

    def shifted(self, distance: float) -> Job:
        """The same in coordinates that have grown by `distance`."""
        return replace(self, target=self.target + distance)

    def table(self, start: Start, limits: Limits, through: float) -> tuple[Profile, Limits]:
        """The table from `start` to the target within `limits`, and the limits of its first part.

        `through`: speed with which it passes the target, if it is to pass it.
        """
        position, velocity, acceleration = start
        if self.through:
            passing = copysign(max(through, SMALLEST_LIMIT), self.through)
            return plan_through_position(*start, self.target, passing, limits), limits
        if velocity == 0.0 and acceleration == 0.0 and not isinf(self.target):
            return plan_rest_to_rest(position, self.target, limits), limits
        return planned(start, self.target, limits, self.ramp)


@dataclass(frozen=True, slots=True)
class Activation:
    """A new velocity (mm/s) that becomes active when the axis passes `position` in `direction`."""

    position: float
    direction: float
    velocity: float


def planned(start: Start, target: float, limits: Limits, ramp: Limits | None) -> tuple[Profile, Limits]:
    """The table of an axis in motion to `target` (±infinity: endless), and the limits of its first part.

    With a `ramp` (see `Job`) an acceleration that leads too far is taken out with its jerk first.
    """
    if ramp is None or not leads_too_fast(start, limits):
        return _to_target(start, target, limits, ramp)
    position, velocity, acceleration = start
    jerk = -copysign(ramp.jerk, acceleration)
    d = -acceleration / jerk
    after = position + d * (velocity + d * (acceleration / 3.0)), velocity + 0.5 * d * acceleration, 0.0
    rest, _ = _to_target(after, target, limits, ramp)
    rows = [(0.0, position, velocity, acceleration, jerk), *((d + t, p, v, a, j) for t, p, v, a, j in rest.rows)]
    return Profile(rows), limits._replace(deceleration=ramp.deceleration, jerk=ramp.jerk)


def _to_target(start: Start, target: float, limits: Limits, ramp: Limits | None) -> tuple[Profile, Limits]:
    if isinf(target):
        return plan_to_velocity(*start, copysign(limits.velocity, target), limits), limits
    if ramp is None:
        return plan_to_position(*start, target, limits), limits
    return plan_with_ramp(*start, target, limits, ramp)


def leads_too_fast(start: Start, limits: Limits) -> bool:
    """True when the acceleration, taken out with their J, leaves a velocity above V, or one in the other direction."""
    _, v, a = start
    left = v + a * abs(a) / (2.0 * limits.jerk)
    return a != 0.0 and (abs(left) > max(abs(v), limits.velocity) or left * v < 0.0)


def stronger(limits: Limits, ramp: Limits | None) -> Limits | None:
    """`limits` with A- and J of `ramp` where these are larger; None if none is."""
    if ramp is None or (ramp.deceleration <= limits.deceleration and ramp.jerk <= limits.jerk):
        return None
    return limits._replace(deceleration=max(limits.deceleration, ramp.deceleration), jerk=max(limits.jerk, ramp.jerk))
