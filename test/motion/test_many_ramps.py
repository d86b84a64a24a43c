"""Ramps to a velocity from start states of all kinds over eight decades: checked, and held against two other methods.

Where |v| only grows or only falls, and where A+ = A-, Ruckig's velocity interface knows the duration. Where v changes
its sign with A+ ≠ A- the phase plane does: with w = a²/2 as a function of v the jerk gives lines of slope ±J, and the
fastest ramp is the largest w below the line from the start, the line to the end, A-²/2 at v < 0 and A+²/2 at v > 0.
"""

from __future__ import annotations

import math
import random
from itertools import pairwise

import pytest
from long_support import long
from motion_checker import Motions, assert_all, over_acceleration, steps
from motion_problems import STATES, Problem, random_limits, signed
from ruckig_peer import RuckigPeer

from cnc_ptp.motion import Limits, plan_to_velocity

CHUNK = 4000
Line = tuple[float, float]
"""w at v = 0 and its slope."""


def random_ramps(seed: int) -> list[tuple[Problem, float]]:
    """Start states of all kinds with the velocity that is wanted: 0, the old one, within V, anything."""
    draw = random.Random(seed)
    ramps = []
    for number in range(CHUNK):
        limits = random_limits(draw, symmetric=draw.random() < 0.4)
        v, a = list(STATES.values())[number % len(STATES)](draw, limits)
        wanted = draw.choice((0.0, v, draw.uniform(-1.0, 1.0) * limits.velocity, signed(draw)))
        ramps.append((Problem(draw.choice((0.0, signed(draw))), v, a, 0.0, limits, False), wanted))
    return ramps


@pytest.mark.parametrize("chunk", [*range(2), *long(range(2, 5))])
def test_any_ramp_ends_exactly_within_its_limits(chunk):
    ramps = random_ramps(1000 + chunk)
    problems = [problem for problem, _ in ramps]
    profiles = [plan_to_velocity(*problem[:3], wanted, problem.limits) for problem, wanted in ramps]
    motions = Motions.of(problems, profiles)
    for (problem, wanted), profile in zip(ramps, profiles, strict=True):
        assert profile.end[1:] == (wanted, 0.0)
        assert profile.rows[0][:4] == (0.0, *problem[:3]) or len(profile.rows) == 1
    for name, found in zip(("position step", "velocity step", "acceleration step"), steps(motions), strict=True):
        assert_all(found, name, ramps)
    assert_all(over_acceleration(motions), "acceleration above A+ or A-", ramps)


def one_way(problem: Problem, wanted: float) -> float | None:
    """The direction of v (±1) where it keeps its sign during the ramp, 1 where A+ = A- makes it unimportant."""
    _, v, a, _, limits, _ = problem
    for s in (1.0, -1.0):
        lowest = min(s * v, s * v - a * a / (2.0 * limits.jerk) if s * a < 0.0 else s * v, s * wanted)
        if lowest >= 0.0:
            return s
    return 1.0 if limits.acceleration == limits.deceleration else None


@pytest.mark.parametrize("chunk", [*range(2), *long(range(2, 5))])
def test_as_fast_as_ruckig_in_its_velocity_mode(chunk):
    """Starts within the bounds of a; a difference of velocity that is rounding (4e-15) takes no time here.

    Both sides get the one bound that counts.
    """
    peer, compared = RuckigPeer(), 0
    for problem, wanted in random_ramps(2000 + chunk):
        _, v, a, _, limits, _ = problem
        s = one_way(problem, wanted)
        duration = plan_to_velocity(0.0, v, a, wanted, limits).duration
        if s is None or duration == 0.0 or abs(a) > min(limits.acceleration, limits.deceleration):
            continue
        left = a * abs(a) / (2.0 * limits.jerk)
        peer.scale(duration, duration * (abs(v) + abs(wanted) + abs(left)))
        bound = limits.acceleration if s * (wanted - v - left) > 0.0 else limits.deceleration
        theirs = peer.to_velocity(v, a, wanted, limits._replace(acceleration=bound, deceleration=bound))
        if theirs is not None:
            compared += 1
            assert duration <= theirs * (1 + 1e-9), (problem, wanted, theirs)
            if abs(wanted - v - left) > 1e-8 * (abs(v) + abs(wanted) + abs(left)):
                assert duration >= theirs * (1 - 1e-9), (problem, wanted, theirs)
    assert compared > 0.3 * CHUNK


def phase_plane_time(v: float, a: float, wanted: float, limits: Limits) -> float:
    """Seconds of the fastest ramp from v up to `wanted` > v + a|a|/(2J), a <= A+ and A- at the start."""
    _, growth, reduction, jerk = limits
    first = 0.0
    if a < 0.0:
        first, v, a = -a / jerk, v - a * a / (2.0 * jerk), 0.0
    below, above = 0.5 * reduction**2, 0.5 * growth**2
    lines: list[Line] = [(0.5 * a * a - jerk * v, jerk), (jerk * wanted, -jerk)]
    sides = [(v, min(0.0, wanted), below, (above, -jerk)), (max(0.0, v), wanted, above, (below, jerk))]
    return first + sum(side_time(low, high, [*lines, (cap, 0.0), other]) for low, high, cap, other in sides)


def side_time(low: float, high: float, lines: list[Line]) -> float:
    """∫ dv/√(2w) from low to high under the lowest of the lines, exact between their crossings."""
    if high <= low:
        return 0.0
    crossings = [(w2 - w1) / (k1 - k2) for w1, k1 in lines for w2, k2 in lines if k1 != k2]
    cuts = sorted({low, high, *(v for v in crossings if low < v < high)})
    total = 0.0
    for begin, end in pairwise(cuts):
        w, slope = min(lines, key=lambda line: line[0] + line[1] * 0.5 * (begin + end))
        a1, a2 = (math.sqrt(2.0 * max(0.0, w + slope * v)) for v in (begin, end))
        total += abs(a2 - a1) / abs(slope) if slope else (end - begin) / a1
    return total


def test_through_zero_with_unequal_bounds_as_fast_as_the_phase_plane_allows():
    draw, compared = random.Random(3000), 0
    while compared < 5000:
        limits = random_limits(draw, symmetric=False)
        bound = min(limits.acceleration, limits.deceleration)
        v, a = draw.choice((-1.0, 0.1)) * draw.random() * limits.velocity, draw.uniform(-1.0, 1.0) * bound
        wanted = draw.random() * limits.velocity
        if wanted <= v + a * abs(a) / (2.0 * limits.jerk):
            continue
        compared += 1
        best = phase_plane_time(v, a, wanted, limits)
        for s in (1.0, -1.0):
            duration = plan_to_velocity(0.0, s * v, s * a, s * wanted, limits).duration
            assert duration == pytest.approx(best, rel=1e-9), (v, a, wanted, limits)
