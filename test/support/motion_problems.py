"""Seeded planning problems: limits, start states of all kinds and targets over eight decades, near zero and far away."""

from __future__ import annotations

import math
import random
from typing import NamedTuple

from cnc_ptp.motion import Limits, Profile, plan_to_position


class Problem(NamedTuple):
    """A position target; written out it can be pasted."""

    position: float
    velocity: float
    acceleration: float
    target: float
    limits: Limits
    direct: bool

    def plan(self) -> Profile:
        return plan_to_position(*self[:5], direct=self.direct)


def log_uniform(draw: random.Random, low: float = 1e-3, high: float = 1e5) -> float:
    return math.exp(draw.uniform(math.log(low), math.log(high)))


def signed(draw: random.Random, low: float = 1e-3, high: float = 1e5) -> float:
    return draw.choice((-1.0, 1.0)) * log_uniform(draw, low, high)


def random_limits(draw: random.Random, *, symmetric: bool) -> Limits:
    acceleration = log_uniform(draw)
    return Limits(log_uniform(draw), acceleration, acceleration if symmetric else log_uniform(draw), log_uniform(draw))


def inside(draw: random.Random, limits: Limits) -> tuple[float, float]:
    """Anything that can be brought to a = 0 within ±V."""
    v = draw.uniform(-1.0, 1.0) * limits.velocity
    a = draw.uniform(-1.0, 1.0) * min(limits.acceleration, limits.deceleration)
    most = math.sqrt(2.0 * limits.jerk * (limits.velocity - math.copysign(v, v * a)))
    return v, max(-most, min(most, a))


STATES = {
    "rest": lambda draw, limits: (0.0, 0.0),
    "constant velocity": lambda draw, limits: (draw.uniform(-1.0, 1.0) * limits.velocity, 0.0),
    "at full velocity": lambda draw, limits: (draw.choice((-1.0, 1.0)) * limits.velocity, 0.0),
    "within the limits": inside,
    "about the limits": lambda draw, limits: (
        signed(draw, 0.1, 100.0) * limits.velocity,
        signed(draw, 0.1, 100.0) * draw.choice(limits[1:3]),
    ),
    "any velocity": lambda draw, limits: (signed(draw), 0.0),
    "any acceleration": lambda draw, limits: (0.0, signed(draw)),
    "anything": lambda draw, limits: (signed(draw), signed(draw)),
    "nearly rest": lambda draw, limits: (signed(draw, 1e-12, 1e-3), signed(draw, 1e-12, 1e-3)),
}
WITHIN_LIMITS = ("rest", "constant velocity", "at full velocity", "within the limits")

PLACES = (
    lambda draw: 0.0,
    lambda draw: signed(draw),
    lambda draw: draw.choice((-1e5, 1e5)),
)


def random_problem(draw: random.Random, kind: str) -> Problem:
    """Every quantity is drawn from 1e-3 … 1e5 on its own; one in ten ends exactly at 0."""
    limits = random_limits(draw, symmetric=draw.random() < 0.5)
    v, a = STATES[kind](draw, limits)
    p = draw.choice(PLACES)(draw)
    target = p + signed(draw) if draw.random() < 0.9 else 0.0
    return Problem(p, v, a, target, limits, draw.random() < 0.5)


def random_problems(seed: int, count: int, kinds: tuple[str, ...] = tuple(STATES)) -> list[Problem]:
    """`count` problems, the kinds of start state in turn."""
    draw = random.Random(seed)
    return [random_problem(draw, kinds[number % len(kinds)]) for number in range(count)]
