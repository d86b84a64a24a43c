"""Motions without a limit of the jerk: the acceleration steps between A+, 0 and -A-, the jerk is 0. Closed forms.

Forward along a path: v >= 0, and the target is no nearer than the stopping distance v²/(2A-). From v over the peak u to
rest the distance is (u² - v²)/(2A+) + u²/(2A-), the rest is travelled at u.
"""

from __future__ import annotations

from math import sqrt

from cnc_ptp.motion.limits import NEGLIGIBLE_DISTANCE, Limits, check_limits, check_state
from cnc_ptp.motion.profile import Piece, Profile, integrate, integrate_back


def step_stopping_distance(v: float, deceleration: float) -> float:
    """Distance (mm) of the fastest stop from the velocity v >= 0."""
    return v * v / (2.0 * deceleration)


def step_to_velocity(p: float, v: float, velocity: float, limits: Limits) -> Profile:
    """Fastest ramp from v >= 0 to `velocity` >= 0, both in mm/s, from p on.

    Raises CncError 23001 (limits) and 23002 (state, velocity).
    """
    check_limits(limits)
    check_state(position=p, start_velocity=v, velocity=velocity)
    rows, t, p, _ = integrate(0.0, p, v, [_ramp(v, velocity, limits)])
    return Profile((*rows, (t, p, velocity, 0.0, 0.0)))


def step_to_position(p: float, v: float, target: float, limits: Limits) -> Profile:
    """Fastest motion from p with v >= 0 to standstill exactly at `target`; a velocity above V is left with A-.

    Raises CncError 23001 (limits) and 23002 (state, target).
    """
    check_limits(limits)
    check_state(position=p, velocity=v, target=target)
    distance = target - p
    if distance < NEGLIGIBLE_DISTANCE:
        return Profile(((0.0, target, 0.0, 0.0, 0.0),))
    velocity, acceleration, deceleration, _ = limits
    peak_squared = deceleration * (2.0 * distance * acceleration + v * v) / (acceleration + deceleration)
    peak = velocity if peak_squared >= velocity * velocity else sqrt(peak_squared)
    ramp = _ramp(v, peak, limits)
    cruise = distance - 0.5 * (v + peak) * ramp[0] - step_stopping_distance(peak, deceleration)
    head, t, _, _ = integrate(0.0, p, v, [ramp, (max(0.0, cruise) / peak, 0.0, 0.0)])
    tail, t = integrate_back(t, [_ramp(peak, 0.0, limits)], target)
    return Profile([*head, *tail, (t, target, 0.0, 0.0, 0.0)])


def _ramp(v: float, wanted: float, limits: Limits) -> Piece:
    """From v to `wanted` with A+ or A-."""
    if wanted >= v:
        return (wanted - v) / limits.acceleration, limits.acceleration, 0.0
    return (v - wanted) / limits.deceleration, -limits.deceleration, 0.0
