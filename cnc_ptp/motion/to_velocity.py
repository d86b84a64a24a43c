"""Ramp to a velocity from any state; velocity 0 is the stop ramp. Source: TX1250 2.2 (override and stop)."""

from __future__ import annotations

from cnc_ptp.motion.limits import Limits, check_limits, check_state, usual
from cnc_ptp.motion.profile import Profile, integrate
from cnc_ptp.motion.ramp import ramp


def plan_to_velocity(p: float, v: float, a: float, velocity: float, limits: Limits) -> Profile:
    """Time-optimal ramp from (p, v, a) to the signed `velocity` (mm/s) with a = 0; V of the limits is not applied.

    A+ bounds the growth of |v|, A- its reduction, also when the direction changes. The end velocity is exact.
    Raises CncError 23001 (limits) and 23002 (state, velocity).
    """
    check_limits(limits)
    if not usual(p, v, a, velocity):
        check_state(position=p, start_velocity=v, start_acceleration=a, velocity=velocity)
    rows, t, p, _ = integrate(0.0, p, v, ramp(v, a, velocity, limits))
    rows.append((t, p, velocity, 0.0, 0.0))
    return Profile(rows)
