"""Many motions from rest to rest planned in one call, with the same closed form as `plan_rest_to_rest`."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cnc_ptp.motion.limits import (
    LARGEST_LIMIT,
    LARGEST_STATE,
    NEGLIGIBLE_DISTANCE,
    SMALLEST_LIMIT,
    Limits,
    check_limit,
    check_state,
)
from cnc_ptp.motion.profile import Profile

Floats = NDArray[np.float64]


class RestToRestBatch:
    """n planned motions: `rows` (5, 8, n) holds t, p, v, a, j at the start of the seven phases and at the end.

    Phases that vanish have no length. `duration` (n,) in seconds.
    """

    def __init__(self, rows: Floats) -> None:
        self.rows = rows
        self.duration: Floats = rows[0, 7]

    def __len__(self) -> int:
        return len(self.duration)

    def profile(self, index: int) -> Profile:
        """The runtime table of one of the motions."""
        t, p, v, a, j = self.rows[:, :, index].tolist()
        table = list(zip(t, p, v, a, j, strict=True))
        return Profile([*(row for row, end in zip(table, t[1:], strict=False) if end > row[0]), table[7]])


def plan_rest_to_rest_batch(
    start: ArrayLike,
    target: ArrayLike,
    velocity: ArrayLike,
    acceleration: ArrayLike,
    deceleration: ArrayLike,
    jerk: ArrayLike,
) -> RestToRestBatch:
    """Plan n motions from rest to rest; every argument is a number or an array (n,), units as in `Limits`.

    Raises CncError 23001 or 23002 for the first bad value, as `plan_rest_to_rest` does.
    """
    given = (start, target, velocity, acceleration, deceleration, jerk)
    start, end, v, up, down, j = np.broadcast_arrays(*(np.atleast_1d(np.asarray(each, np.float64)) for each in given))
    for name, bounds in zip(Limits._fields, (v, up, down, j), strict=True):
        good = (bounds >= SMALLEST_LIMIT) & (bounds <= LARGEST_LIMIT)
        if not good.all():
            check_limit(name, float(bounds[~good][0]))
    for name, places in (("start", start), ("target", end)):
        good = np.abs(places) <= LARGEST_STATE
        if not good.all():
            check_state(**{name: float(places[~good][0])})
    return RestToRestBatch(_plan(start, end, v, up, down, j))


def _ramp_shapes(v: Floats, bound: Floats, j: Floats) -> tuple[Floats, Floats, Floats]:
    """Ramps 0 <-> v: time at full jerk (each side), time at constant acceleration, peak acceleration."""
    peak = np.minimum(np.sqrt(v * j), bound)
    rise = peak / j
    return rise, np.maximum(v / bound - rise, 0.0) * (peak == bound), peak


def _reachable(distance: Floats, bound: Floats, j: Floats) -> Floats:
    """Peak velocities of rest-to-rest motions without cruise, see `reachable_velocity`."""
    free = np.cbrt(0.25 * j * distance * distance)
    rise = bound / j
    bounded = 2.0 * distance / (rise + np.sqrt(rise * rise + 4.0 * distance / bound))
    return np.where(free * j <= bound * bound, free, bounded)


def _plan(start: Floats, end: Floats, velocity: Floats, up: Floats, down: Floats, j: Floats) -> Floats:
    signed_distance = end - start
    distance = np.abs(signed_distance)
    distance[distance < NEGLIGIBLE_DISTANCE] = 0.0
    s = np.copysign(1.0, signed_distance)
    v = velocity
    rise, rise_hold, rise_top = _ramp_shapes(v, up, j)
    fall, fall_hold, fall_top = _ramp_shapes(v, down, j)
    needed = 0.5 * v * (2.0 * (rise + fall) + rise_hold + fall_hold)
    short = np.nonzero(distance < needed)[0]
    if len(short):
        reachable = _reachable(distance[short], np.minimum(up[short], down[short]), j[short])
        reduced = np.minimum(v[short], np.maximum(v[short] * (distance[short] / needed[short]), reachable))
        v = v.copy()
        v[short] = reduced
        rise[short], rise_hold[short], rise_top[short] = _ramp_shapes(reduced, up[short], j[short])
        fall[short], fall_hold[short], fall_top[short] = _ramp_shapes(reduced, down[short], j[short])
        needed[short] = 0.5 * reduced * (2.0 * (rise[short] + fall[short]) + rise_hold[short] + fall_hold[short])
    cruise = np.maximum(distance - needed, 0.0)
    rows = np.zeros((5, 8, len(signed_distance)))
    cruise /= np.where(v > 0.0, v, 1.0)
    phases = (rise, rise_hold, rise, cruise, fall, fall_hold, fall)
    for phase, d in enumerate(phases):
        np.add(rows[0, phase], d, out=rows[0, phase + 1])
    _fill(rows, start, end, s * v, s * j, phases, s * rise_top, s * fall_top)
    return rows


def _fill(
    rows: Floats, start: Floats, end: Floats, v: Floats, j: Floats, phases: tuple[Floats, ...], up: Floats, down: Floats
) -> None:
    """Positions up to the cruise from the start, those after it from the target; v, j, up, down are signed."""
    rise, rise_hold, _, _, fall, fall_hold, _ = phases
    _, p, velocity, a, jerk = rows
    low = 0.5 * up * rise
    p[0] = start
    p[1] = start + j * rise * rise * rise / 6.0
    p[2] = p[1] + rise_hold * (low + 0.5 * up * rise_hold)
    p[3] = start + 0.5 * v * (2.0 * rise + rise_hold)
    p[4] = end - 0.5 * v * (2.0 * fall + fall_hold)
    last = 0.5 * down * fall
    p[6] = end - j * fall * fall * fall / 6.0
    p[5] = p[6] - fall_hold * (last + 0.5 * down * fall_hold)
    p[7] = end
    velocity[1] = low
    velocity[2] = v - low
    velocity[3] = velocity[4] = v
    velocity[5] = v - last
    velocity[6] = last
    a[1] = a[2] = up
    a[5] = a[6] = -down
    jerk[0] = jerk[6] = j
    jerk[2] = jerk[4] = -j
