"""Planners of the path velocity: with limited jerk, with sine-squared ramps or with steps of the acceleration.

P-CHAN-00071, #SLOPE.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from cnc_ptp.motion import (
    Limits,
    Profile,
    plan_rest_to_rest,
    plan_to_position,
    plan_to_velocity,
    sine_from_rest,
    sine_stopping_distance,
    sine_to_position,
    sine_to_rest,
    step_stopping_distance,
    step_to_position,
    step_to_velocity,
    stopping_distance,
)
from cnc_ptp.nc.canonical import SIN2, STEP, TRAPEZ


class Planner(NamedTuple):
    """Profiles from a path length s, a velocity v and an acceleration a; mm and s."""

    from_rest: Callable[[float, float, Limits], Profile]
    """Start, target."""
    to_position: Callable[[float, float, float, float, Limits], Profile]
    """s, v, a, target."""
    to_rest: Callable[[float, float, float, Limits], Profile]
    """s, v, a."""
    stopping_distance: Callable[[float, float, Limits], float]
    """v, a."""


JERK_LIMITED = Planner(
    from_rest=plan_rest_to_rest,
    to_position=plan_to_position,
    to_rest=lambda s, v, a, limits: plan_to_velocity(s, v, a, 0.0, limits),
    stopping_distance=lambda v, a, limits: stopping_distance(v, a, limits.deceleration, limits.jerk),
)
STEPS = Planner(
    from_rest=lambda start, target, limits: step_to_position(start, 0.0, target, limits),
    to_position=lambda s, v, a, target, limits: step_to_position(s, v, target, limits),
    to_rest=lambda s, v, a, limits: step_to_velocity(s, v, 0.0, limits),
    stopping_distance=lambda v, a, limits: step_stopping_distance(v, limits.deceleration),
)
"""The acceleration steps, so the previous one does not count."""
SINE = Planner(
    from_rest=sine_from_rest,
    to_position=sine_to_position,
    to_rest=sine_to_rest,
    stopping_distance=sine_stopping_distance,
)
"""The jerk does not step, either."""
PLANNERS = {STEP: STEPS, TRAPEZ: JERK_LIMITED, SIN2: SINE}
"""By #SLOPE."""
