"""Rest to rest: the seven-phase profile of an axis start, closed form.

Source: TX1250 2.1. If V cannot be reached, it is reduced to the largest velocity that is reachable with
A = min(A+, A-) on both sides; the ramps then use A+ and A-, and a short cruise fills what is left of the distance.
Near the distance L0 that A+ and A- themselves need for V this would be a jump; there V·L/L0 is more and counts.
"""

from __future__ import annotations

from math import cbrt, sqrt

from cnc_ptp.motion.limits import NEGLIGIBLE_DISTANCE, Limits, check_limits, check_state
from cnc_ptp.motion.profile import Profile, Segment


def reachable_velocity(distance: float, acceleration: float, jerk: float) -> float:
    """Largest peak velocity (mm/s) of a motion from rest to rest over `distance` (mm) with equal ramps and no cruise.

    The two ramps take distance = v·t(v): t = 2√(v/J) while vJ <= A², else t = v/A + A/J.
    """
    v = cbrt(0.25 * jerk * distance * distance)
    if v * jerk <= acceleration * acceleration:
        return v
    rise = acceleration / jerk
    return 2.0 * distance / (rise + sqrt(rise * rise + 4.0 * distance / acceleration))


def _ramp_shape(v: float, bound: float, jerk: float) -> tuple[float, float, float]:
    """Ramp 0 <-> v: time at full jerk (each side), time at constant acceleration, peak acceleration."""
    peak_squared = v * jerk
    if peak_squared <= bound * bound:
        peak = sqrt(peak_squared)
        return peak / jerk, 0.0, peak
    rise = bound / jerk
    return rise, v / bound - rise, bound


def plan_rest_to_rest(start: float, target: float, limits: Limits) -> Profile:
    """Seven-phase profile from standstill at `start` to standstill at `target` (mm); fewer rows where phases vanish.

    The rows up to the cruise are integrated from the start, those after it back from the target, so that both are exact
    and rounding (about one ulp) falls into the cruise. Raises CncError 23001 (limits) and 23002 (start, target).
    """
    check_limits(limits)
    check_state(start=start, target=target)
    return rest_to_rest(start, target, limits)


def rest_to_rest(start: float, target: float, limits: Limits) -> Profile:
    """`plan_rest_to_rest` for values that have been checked."""
    velocity, acceleration, deceleration, jerk = limits
    distance = abs(target - start)
    if distance < NEGLIGIBLE_DISTANCE:
        return Profile(((0.0, target, 0.0, 0.0, 0.0),))
    up, up_hold, up_top = _ramp_shape(velocity, acceleration, jerk)
    down, down_hold, down_top = _ramp_shape(velocity, deceleration, jerk)
    needed = 0.5 * velocity * (2.0 * (up + down) + up_hold + down_hold)
    if distance < needed:
        reduced = max(
            velocity * (distance / needed), reachable_velocity(distance, min(acceleration, deceleration), jerk)
        )
        velocity = min(velocity, reduced)
        up, up_hold, up_top = _ramp_shape(velocity, acceleration, jerk)
        down, down_hold, down_top = _ramp_shape(velocity, deceleration, jerk)
        needed = 0.5 * velocity * (2.0 * (up + down) + up_hold + down_hold)
    cruise = distance - needed
    s = 1.0 if target > start else -1.0
    sv, sj = s * velocity, s * jerk
    a, b = s * up_top, s * down_top
    rows: list[Segment] = [(0.0, start, 0.0, 0.0, sj)]
    t = up
    v = 0.5 * a * up
    p = start + sj * up * up * up / 6.0
    if up_hold > 0.0:
        rows.append((t, p, v, a, 0.0))
        t += up_hold
        p += up_hold * (v + 0.5 * a * up_hold)
        v = sv - v
    rows.append((t, p, v, a, -sj))
    t += up
    if cruise > 0.0:
        rows.append((t, start + 0.5 * sv * (2.0 * up + up_hold), sv, 0.0, 0.0))
        t += cruise / velocity
    rows.append((t, target - 0.5 * sv * (2.0 * down + down_hold), sv, 0.0, -sj))
    t += down
    v = 0.5 * b * down
    p = target - sj * down * down * down / 6.0
    if down_hold > 0.0:
        rows.append((t, p - down_hold * (v + 0.5 * b * down_hold), sv - v, -b, 0.0))
        t += down_hold
    rows.append((t, p, v, -b, sj))
    t += down
    rows.append((t, target, 0.0, 0.0, 0.0))
    return Profile(rows)
