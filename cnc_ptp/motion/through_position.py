"""Through a position at a velocity, from any state: the first part of a motion that is blended with the next one.

Seen in the direction of the velocity W, let Γ be the fastest ramp to V followed by cruising, and D(τ) the place where W
is reached when Γ is left at τ on the fastest ramp to W. D never falls. Within the ramp of Γ the τ with D(τ) = target is
found by bisection, on its cruise D grows by V a second.
"""

from __future__ import annotations

from cnc_ptp.motion.limits import Limits, check_limits, check_state
from cnc_ptp.motion.profile import Piece, Profile, integrate
from cnc_ptp.motion.ramp import ramp

HALVINGS = 60
"""Steps of the bisection: below the rounding of τ."""


def plan_through_position(p: float, v: float, a: float, target: float, velocity: float, limits: Limits) -> Profile:
    """Fastest jerk-limited motion from (p, v, a) to the signed `velocity` (not 0, mm/s) exactly at `target` (mm).

    V of the limits is the largest velocity until the last ramp; it may be below |velocity|. If the velocity cannot be
    reached by then, the ramp to it starts immediately and ends behind the target.
    Raises CncError 23001 (limits) and 23002 (state, target, velocity).
    """
    check_limits(limits)
    check_state(position=p, start_velocity=v, start_acceleration=a, target=target, velocity=velocity)
    s = 1.0 if velocity > 0.0 else -1.0
    v, a, wanted, distance = s * v, s * a, s * velocity, s * (target - p)
    pieces = ramp(v, a, limits.velocity, limits)
    if _way(pieces, v, a, 0.0, wanted, limits)[0] >= distance:
        rows, t, way, _ = integrate(0.0, 0.0, v, ramp(v, a, wanted, limits), p, s)
        return Profile([*rows, (t, p + s * way, velocity, 0.0, 0.0)])
    rows, t, _, _ = integrate(0.0, 0.0, v, _leave(pieces, v, a, distance, wanted, limits), p, s)
    return Profile([*rows, (t, target, velocity, 0.0, 0.0)])


def _leave(pieces: list[Piece], v: float, a: float, distance: float, wanted: float, limits: Limits) -> list[Piece]:
    """The pieces of Γ up to the point where it must be left, and the ramp to `wanted` from there."""
    duration = sum(piece[0] for piece in pieces)
    way, whole, last = _way(pieces, v, a, duration, wanted, limits)
    if way <= distance:
        return [*whole, ((distance - way) / limits.velocity, 0.0, 0.0), *last]
    low, high = 0.0, duration
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if _way(pieces, v, a, middle, wanted, limits)[0] < distance:
            low = middle
        else:
            high = middle
    _, begin, last = _way(pieces, v, a, low, wanted, limits)
    return [*begin, *last]


def _way(
    pieces: list[Piece], v: float, a: float, leave: float, wanted: float, limits: Limits
) -> tuple[float, list[Piece], list[Piece]]:
    """D(leave), the pieces of Γ until then, and the ramp to `wanted` that follows."""
    begin: list[Piece] = []
    for d, start, j in pieces:
        d = min(d, leave)
        if d > 0.0:
            begin.append((d, start, j))
            a = start + j * d
        leave -= d
    _, _, x, v = integrate(0.0, 0.0, v, begin)
    last = ramp(v, a, wanted, limits)
    return integrate(0.0, x, v, last)[2], begin, last
