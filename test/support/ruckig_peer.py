"""Ruckig as the second opinion on durations."""

from __future__ import annotations

import math

import ruckig
from motion_problems import Problem

from cnc_ptp.motion import Limits, stopping_distance

BRAKE_MARGIN = 2.2e-14
"""What Ruckig shortens its first ramp by where a start is above the limits, in its unit of time."""

LONG = 4096.0
"""Units of time and length that a motion is given: Ruckig refuses more than 7600 and works to absolute margins."""


class RuckigPeer:
    """Durations by Ruckig, posed from position 0 in units of time and length that fit the motion.

    The units are powers of two, so the problem stays the same to the bit; without them Ruckig refuses or misses a
    fifth of the problems, because its margins (1e-8 of position and velocity) are absolute. A problem that it refuses
    all the same has the duration None.
    """

    def __init__(self) -> None:
        self.planner, self.trajectory = ruckig.Ruckig(1), ruckig.Trajectory(1)
        self.input = ruckig.InputParameter(1)
        self.input.target_acceleration = [0.0]
        self.second = self.millimetre = 1.0

    def scale(self, duration: float, way: float) -> None:
        """Choose the units for a motion of about this duration (s) and distance (mm)."""
        self.second = math.ldexp(LONG, -math.frexp(duration)[1])
        self.millimetre = math.ldexp(LONG, -math.frexp(way)[1])

    def to_position(self, way: float, v: float, a: float, limits: Limits) -> float | None:
        """Seconds to rest at `way`; A+ of the limits is Ruckig's largest acceleration, A- its smallest."""
        self.input.control_interface = ruckig.ControlInterface.Position
        self.input.target_position = [way * self.millimetre]
        return self._solve(v, a, 0.0, limits)

    def through(self, way: float, v: float, a: float, wanted: float, limits: Limits) -> float | None:
        """Seconds to the velocity `wanted` with a = 0 at `way`."""
        self.input.control_interface = ruckig.ControlInterface.Position
        self.input.target_position = [way * self.millimetre]
        return self._solve(v, a, wanted, limits)

    def to_velocity(self, v: float, a: float, wanted: float, limits: Limits) -> float | None:
        """Seconds to a velocity with a = 0."""
        self.input.control_interface = ruckig.ControlInterface.Velocity
        return self._solve(v, a, wanted, limits)

    def _solve(self, v: float, a: float, wanted: float, limits: Limits) -> float | None:
        per_second = self.millimetre / self.second
        per_second2 = per_second / self.second
        given = self.input
        given.current_velocity, given.current_acceleration = [v * per_second], [a * per_second2]
        given.target_velocity = [wanted * per_second]
        given.max_velocity = [limits.velocity * per_second]
        given.max_acceleration = [limits.acceleration * per_second2]
        given.min_acceleration = [-limits.deceleration * per_second2]
        given.max_jerk = [limits.jerk * per_second2 / self.second]
        try:
            self.planner.calculate(given, self.trajectory)
        except ruckig.RuckigError:
            return None
        duration: float = self.trajectory.duration / self.second
        return duration

    def duration(self, problem: Problem) -> float | None:
        """The longest that a plan of the problem may take, s; None where Ruckig refuses or cannot tell.

        Without reversal A+ and A- are Ruckig's largest and smallest acceleration: the semantics coincide. With
        reversal it knows no A+ against A-, so both are the smaller one: with A+ = A- that coincides for a direct
        reversal, otherwise it is a bound within V (above V the weaker ramp is fast for longer). Without `direct`
        (TX1250 2.3) it stops first and then starts from rest.
        """
        way = problem.target - problem.position
        _, v, a, _, limits, direct = problem
        stop = stopping_distance(v, a, limits.deceleration, limits.jerk)
        s = math.copysign(1.0, way - stop)
        v, a = s * v, s * a
        if v >= 0.0 and (a >= 0.0 or v >= a * a / (2.0 * limits.jerk)):
            return self.to_position(s * way, v, a, limits)
        both = min(limits.acceleration, limits.deceleration)
        weaker = limits._replace(acceleration=both, deceleration=both)
        if not direct:
            first, back = self.to_velocity(v, a, 0.0, weaker), self.to_position(s * (way - stop), 0.0, 0.0, weaker)
            return None if first is None or back is None else first + back
        if limits.acceleration != limits.deceleration and not within(problem, both):
            return None
        return self.to_position(s * way, v, a, weaker)

    def breaks_velocity(self, problem: Problem) -> bool:
        """Whether its last motion leaves V from a start within: seen once in a million, where a > 0 leads exactly to V."""
        limits = problem.limits
        speeds = [abs(v) for v in self.trajectory.profiles[0][0].v]
        most = limits.velocity * self.millimetre / self.second
        return within(problem, min(limits.acceleration, limits.deceleration)) and max(speeds) > most * (1 + 1e-9)

    def margin(self, problem: Problem, way: float) -> float:
        """Seconds that Ruckig may be too fast where a start is above the limits: its ramp is weaker by BRAKE_MARGIN."""
        limits = problem.limits
        both = min(limits.acceleration, limits.deceleration)
        if within(problem, both):
            return 0.0
        return BRAKE_MARGIN / self.second * limits.jerk / both * way / limits.velocity


def within(problem: Problem, bound: float) -> bool:
    """Whether the start and the velocity that its acceleration leads to are within V, and the acceleration in `bound`."""
    _, v, a, _, limits, _ = problem
    return abs(a) <= bound and max(abs(v), abs(v + a * abs(a) / (2.0 * limits.jerk))) <= limits.velocity
