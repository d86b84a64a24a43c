"""Position target from any state.

Seen in the direction s of the target, let Γ be the fastest ramp to the velocity V followed by cruising, and D(τ) the
place where the axis comes to rest when it leaves Γ at τ on the fastest stop ramp. D never falls, so the motion is Γ up
to the τ with D(τ) = target, then the stop ramp. With c = vJ - a²/2 (constant under jerk +J), q = vJ + a²/2 (the square
of the coming deceleration peak) and g = `brake_term`:

    D·J² = const + 2ca + a³ + g(q)                  jerk +J      (a polynomial of degree four for y = √q + a, or for a)
    D·J² = const + q²/(2A) + qA/2 + g(q)            constant A   (a quadratic for √q(√q + A), or for q)
    D    = const + V·τ                              cruise

and D is constant while Γ brakes or lowers its acceleration, because the stop ramp does the same. All of it is closed
form; the two of degree four (`quartic.py`) are followed by one Newton step against rounding.
"""

from __future__ import annotations

from math import sqrt

from cnc_ptp.motion.limits import NEGLIGIBLE_DISTANCE, Limits, check_limits, check_state, usual
from cnc_ptp.motion.profile import Piece, Profile, integrate, integrate_back
from cnc_ptp.motion.quartic import largest_root
from cnc_ptp.motion.ramp import brake, brake_term, ramp, stopping_distance
from cnc_ptp.motion.rest_to_rest import rest_to_rest

WAY_ROUNDING = 1e-13
PLACE_ROUNDING = 4.5e-16
"""Part of the stopping distance, and of both positions, that counts as rounding when a braking axis is replanned."""

REST_ROUNDING = 1e-9
"""Part of the velocity by which the last jerk phase of a stop may miss standstill through rounding."""


def plan_to_position(p: float, v: float, a: float, target: float, limits: Limits, *, direct: bool = False) -> Profile:
    """Fastest jerk-limited motion from (p, v, a) to standstill exactly at `target` (mm).

    A velocity above V and an acceleration above A+ or A- are left as fast as the limits allow. If the axis cannot
    stop before the target, or moves away from it, it stops and returns (TX1250 2.3); `direct` reverses without the
    standstill in between, which is faster. Raises CncError 23001 (limits) and 23002 (state, target).
    """
    check_limits(limits)
    if not usual(p, v, a, target):
        check_state(position=p, velocity=v, acceleration=a, target=target)
    s = _side(p, v, a, target, limits)
    if s == 0.0:
        return _table(p, v, target, 1.0, [], ramp(v, a, 0.0, limits))
    if _stops_first(s * v, s * a, limits) and not direct:
        return _stop_and_return(p, v, a, target, limits, limits)
    v *= s
    a *= s
    head, tail = _leave_ramp(v, a, s * (target - p), limits)
    return _table(p, v, target, s, head, tail)


def plan_with_ramp(
    p: float, v: float, a: float, target: float, limits: Limits, stronger: Limits
) -> tuple[Profile, Limits]:
    """`plan_to_position` with A- and J of `stronger` where those of `limits` would lead past `target`.

    If these do too, the stop is the stronger one, the return is within `limits`. Also returns the limits of the part
    that comes first. Raises as `plan_to_position`.
    """
    check_limits(stronger)
    first = limits
    if leads_past(p, v, a, target, limits):
        first = limits._replace(deceleration=stronger.deceleration, jerk=stronger.jerk)
        if leads_past(p, v, a, target, first):
            return _stop_and_return(p, v, a, target, limits, first), first
    return plan_to_position(p, v, a, target, first), first


def leads_past(p: float, v: float, a: float, target: float, limits: Limits) -> bool:
    """True when an axis in motion cannot stop before `target`, or moves away from it."""
    s = _side(p, v, a, target, limits)
    return s != 0.0 and _stops_first(s * v, s * a, limits)


def _side(p: float, v: float, a: float, target: float, limits: Limits) -> float:
    """Where the target is, seen from the place where the fastest stop ends: +1, -1, or 0 but for rounding there."""
    stop = stopping_distance(v, a, limits.deceleration, limits.jerk)
    gap = target - p - stop
    if abs(gap) <= WAY_ROUNDING * abs(stop) + PLACE_ROUNDING * (abs(p) + abs(target)) + NEGLIGIBLE_DISTANCE:
        return 0.0
    return 1.0 if gap > 0.0 else -1.0


def _stops_first(v: float, a: float, limits: Limits) -> bool:
    """True when the velocity that is left without the acceleration leads away from the target (at positive places).

    In the last jerk phase of a stop it is 0 but for rounding; then the direction of the velocity itself decides.
    """
    left = v + a * abs(a) / (2.0 * limits.jerk)
    return left < -REST_ROUNDING * v


def _stop_and_return(p: float, v: float, a: float, target: float, limits: Limits, stop_limits: Limits) -> Profile:
    """Two profiles joined in one table: the stop ramp, then from rest to rest back to the target within `limits`.

    Distances are counted from p, so that the return keeps its digits far away from zero.
    """
    table, t, stop, _ = integrate(0.0, 0.0, v, ramp(v, a, 0.0, stop_limits), p)
    back = rest_to_rest(stop, target - p, limits)
    table += [(t + t0, p + x, v0, a0, j0) for t0, x, v0, a0, j0 in back.rows]
    table[-1] = (t + back.duration, target, 0.0, 0.0, 0.0)
    return Profile(table)


def _table(p: float, v: float, target: float, s: float, head: list[Piece], tail: list[Piece]) -> Profile:
    """Rows for the pieces of Γ (counted on from p and v) and of the stop ramp (counted back from the target at rest).

    All values seen in direction s. Start and end are exact, the rounding of the whole falls between the two.
    """
    rows, t, _, _ = integrate(0.0, 0.0, v, head, p, s)
    last, t = integrate_back(t, tail, target, s)
    rows += last
    if rows:
        rows[0] = (0.0, p, s * v, rows[0][3], rows[0][4])
    rows.append((t, target, 0.0, 0.0, 0.0))
    return Profile(rows)


def _leave_ramp(v: float, a: float, distance: float, limits: Limits) -> tuple[list[Piece], list[Piece]]:
    """The pieces of Γ up to the point where it must be left for the target, and the stop ramp from there."""
    velocity, _, deceleration, jerk = limits
    scale = jerk * jerk
    head: list[Piece] = []
    x = 0.0
    pieces = ramp(v, a, velocity, limits)
    for d, a, j in pieces:
        if d <= 0.0:
            continue
        if j > 0.0:
            top = _leave_at_rising_acceleration(x, v, a, a + j * d, distance, deceleration, jerk)
            if top is not None:
                d = (top - a) / jerk
                head.append((d, a, j))
                return head, brake(v + d * (a + d * (0.5 * j)), top, deceleration, jerk)
        elif j == 0.0 and a > 0.0:
            held = _time_at_constant_acceleration(x, v, a, distance, deceleration, jerk)
            if held <= d:
                head.append((held, a, 0.0))
                return head, brake(v + held * a, a, deceleration, jerk)
        head.append((d, a, j))
        x += d * (v + d * (0.5 * a + d * (j / 6.0)))
        v += d * (a + d * (0.5 * j))
    cruise = distance - x - brake_term(velocity * jerk, deceleration) / scale
    return head, [(max(0.0, cruise) / velocity, 0.0, 0.0), *brake(velocity, 0.0, deceleration, jerk)]


def _time_at_constant_acceleration(
    x: float, v: float, a: float, distance: float, deceleration: float, jerk: float
) -> float:
    """Seconds after which a piece of constant a > 0, started at x with v, must be left to stop at `distance`.

    Solved for the change of q (and of m = q + a√q, of √q), because compared with q it may be small. D is constant at q
    < 0.
    """
    q = v * jerk + 0.5 * a * a
    ahead = jerk * jerk * (distance - x) - a * (q - a * a / 6.0)
    before = 0.0
    if q < 0.0:
        ahead += 0.5 * q * (q / a + a)
        before, q = -q, 0.0
    free = ahead - brake_term(q, deceleration)
    if free <= 0.0:
        return before / (jerk * a)
    top = sqrt(q)
    m = top * (top + a)
    m_left = sqrt(m * m + 2.0 * a * free)
    root = sqrt(a * a + 4.0 * m_left)
    top_left = 0.5 * (root - a)
    if top_left <= deceleration:
        rise = 4.0 * a * free * (top_left + top) / ((m_left + m) * (root + 2.0 * top + a))
    else:
        bounded = ahead - 0.5 * q * (deceleration + q / deceleration)
        k = 1.0 / a + 1.0 / deceleration
        slope = q * k + 0.5 * (a + deceleration)
        rise = 2.0 * bounded / (slope + sqrt(slope * slope + 2.0 * k * bounded))
    return (before + rise) / (jerk * a)


def _leave_at_rising_acceleration(
    x: float, v: float, a: float, end: float, distance: float, deceleration: float, jerk: float
) -> float | None:
    """Acceleration at which a piece of jerk +J from a to `end`, started at x with v, is left to stop at `distance`.

    None if it is not left. Within the piece the deceleration peak √q is above A- outside -edge < a < edge, edge² = A-²
    - c.
    """
    c = v * jerk - 0.5 * a * a
    rest = jerk * jerk * (distance - x) + a * (c + a * a / 6.0)
    low = max(a, -deceleration)
    if c < 0.0:
        low = max(low, sqrt(-c))
    if end <= low or end * (2.0 * c + end * end) + brake_term(c + end * end, deceleration) < rest:
        return None
    edge_squared = deceleration * deceleration - c
    if edge_squared <= 0.0:
        return _solve_bounded(low, end, c, rest, deceleration)
    edge = sqrt(edge_squared)
    brake_cubed = deceleration * deceleration * deceleration
    if low < -edge <= end and -edge * (2.0 * c + edge_squared) + brake_cubed >= rest:
        return _solve_bounded(low, -edge, c, rest, deceleration)
    if edge < end and (edge <= low or edge * (2.0 * c + edge_squared) + brake_cubed < rest):
        return _solve_bounded(max(low, edge), end, c, rest, deceleration)
    return _solve_free(low, min(end, edge), c, rest)


def _solve_free(low: float, high: float, c: float, rest: float) -> float:
    """a in [low, high] with 2ca + a³ + (c + a²)^1.5 = rest.

    y = √(c + a²) + a is the largest root of y⁴ + 4cy² - 4·rest·y - c² = 0; one Newton step takes its rounding away.
    """
    y = max(largest_root(4.0 * c, -4.0 * rest, 20.0 * c * c), sqrt(max(0.0, -c)))
    a = 0.5 * (y - c / y) if y > 0.0 else 0.0
    q = c + a * a
    top = sqrt(q) if q > 0.0 else 0.0
    slope = (2.0 * top + a) * (top + a)
    if slope > 0.0:
        a -= (a * (2.0 * c + a * a) + q * top - rest) / slope
    return min(max(a, low), high)


def _solve_bounded(low: float, high: float, c: float, rest: float, bound: float) -> float:
    """a in [low, high] with 2ca + a³ + q·A-/2 + q²/(2A-) = rest, q = c + a².

    x = a + A-/2 is the largest root of (x² + m)² + 2A-·c·x = 2A-·rest, m = c - A-²/4; then as in `_solve_free`.
    """
    a = largest_root(2.0 * c - 0.5 * bound * bound, 2.0 * bound * c, 8.0 * bound * rest) - 0.5 * bound
    q = c + a * a
    slope = (a + bound) * (2.0 * q / bound + a)
    if slope > 0.0:
        a -= (a * (2.0 * c + a * a) + 0.5 * q * (bound + q / bound) - rest) / slope
    return min(max(a, low), high)
