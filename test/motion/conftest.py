"""An independent checker of runtime tables, and seeded limits and start states."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from itertools import pairwise

import pytest

from cnc_ptp.motion import Limits, Profile
from cnc_ptp.motion.profile import Segment

Reached = tuple[float, float, float]


def log_uniform(draw: random.Random, low: float = 1e-3, high: float = 1e5) -> float:
    return math.exp(draw.uniform(math.log(low), math.log(high)))


def random_limits(draw: random.Random, *, symmetric: bool) -> Limits:
    acceleration = log_uniform(draw)
    return Limits(log_uniform(draw), acceleration, acceleration if symmetric else log_uniform(draw), log_uniform(draw))


def random_start(draw: random.Random, limits: Limits) -> tuple[float, float, float]:
    """A start state within the limits: rest, constant velocity, or anything that can be brought to a = 0 within ±V."""
    p = draw.choice([0.0, draw.uniform(-1.0, 1.0) * log_uniform(draw)])
    kind = draw.randrange(5)
    if kind == 0:
        return p, 0.0, 0.0
    v = draw.uniform(-1.0, 1.0) * limits.velocity
    if kind == 1:
        return p, v, 0.0
    a = draw.uniform(-1.0, 1.0) * min(limits.acceleration, limits.deceleration)
    room = limits.velocity - (v if a > 0.0 else -v)
    most = math.sqrt(2.0 * limits.jerk * room)
    return p, v, max(-most, min(most, a))


def follow(row: Segment, d: float) -> Reached:
    """State d seconds after a row, by the Taylor series of its jerk."""
    _, p, v, a, j = row
    return p + v * d + a * d * d / 2 + j * d**3 / 6, v + a * d + j * d * d / 2, a + j * d


def assert_table(profile: Profile, start: Reached, end: Reached, limits: Limits) -> None:
    """Right start and end, jerks 0 or ±J, and p, v, a go through every row border without a step.

    1e-9 of the largest value of the motion, plus what one rounding of the time moves (a by J·ulp(t), v by a·ulp(t), …).
    """
    rows = profile.rows
    assert rows[-1] == (profile.duration, *end, 0.0)
    assert profile.end == end
    ulp = 2.0 * math.ulp(profile.duration)
    a_scale = max(abs(row[3]) for row in rows)
    v_scale = max(abs(row[2]) for row in rows)
    p_scale = max(abs(row[1]) for row in rows)
    tolerances = (1e-9 * p_scale + ulp * v_scale, 1e-9 * v_scale + ulp * a_scale, 1e-9 * a_scale + ulp * limits.jerk)
    for reached, wanted, tolerance in zip(rows[0][1:4], start, tolerances, strict=True):
        assert abs(reached - wanted) <= tolerance
    for row, following in pairwise(rows):
        assert row[0] <= following[0]
        assert abs(row[4]) in (0.0, limits.jerk)
        for reached, wanted, tolerance in zip(
            follow(row, following[0] - row[0]), following[1:4], tolerances, strict=True
        ):
            assert abs(reached - wanted) <= tolerance


def assert_limits(profile: Profile, limits: Limits) -> None:
    """|v| <= V, |a| <= A+ where |v| grows and <= A- where it shrinks, to 1e-9, in all rows and extremes between them.

    Acceleration is linear between rows, so its extremes lie in the rows; velocity has its extremes where a = 0.
    """
    for row, following in pairwise(profile.rows):
        _, _, v, a, j = row
        d = following[0] - row[0]
        if j and 0.0 < -a / j < d:
            assert abs(follow(row, -a / j)[1]) <= limits.velocity * (1 + 1e-9)
        for speed, acceleration, beside in ((v, a, following[2]), (following[2], following[3], v)):
            assert abs(speed) <= limits.velocity * (1 + 1e-9)
            direction = speed if abs(speed) > 1e-9 * abs(beside) else beside
            bound = limits.acceleration if direction * acceleration > 0.0 else limits.deceleration
            if speed * beside < 0.0:
                bound = max(limits.acceleration, limits.deceleration)
            assert abs(acceleration) <= bound * (1 + 1e-9)


@pytest.fixture(scope="session")
def check_table() -> Callable[..., None]:
    return assert_table


@pytest.fixture(scope="session")
def check_limits() -> Callable[..., None]:
    return assert_limits


@pytest.fixture(scope="session")
def draw_limits() -> Callable[..., Limits]:
    return random_limits


@pytest.fixture(scope="session")
def draw_start() -> Callable[..., Reached]:
    return random_start
