"""The bound on the velocity along a path: closed forms; what the planner has of it on a part of the contour."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest
from path_bound import PathBound, bound_of

from bench.lookahead import AXES, FEED, example, feed_reached, run
from cnc_ptp.motion import Limits, plan_rest_to_rest
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.path.lookahead.parts import PathPart

A, J = AXES[0].acceleration, AXES[0].jerk


def line(length: float, direction: tuple[float, float], feed: float = 100.0) -> PathBound:
    u = np.linspace(0.0, length, 4001)[:-1] + length / 8000.0
    q1 = np.tile(direction, (len(u), 1))
    return PathBound(u, q1, 0.0 * q1, 0.0 * q1, [0.0, length], feed=feed, acceleration=A, jerk=J)


@pytest.mark.parametrize(("direction", "best"), [((1.0, 0.0), 1.0), ((sqrt(0.5), sqrt(0.5)), sqrt(2.0))])
def test_a_line_from_rest_to_rest(direction: tuple[float, float], best: float) -> None:
    """The time of the seven segments; on a diagonal both axes give all they have."""
    bound = line(40.0, direction)
    u = np.linspace(0.0, 40.0, 400_001)[1:-1]
    seconds = float(np.sum(1.0 / bound.at(u))) * 40.0 / 400_000
    exact = plan_rest_to_rest(0.0, 40.0, Limits(100.0, A * best, A * best, J * best)).duration
    assert seconds == pytest.approx(exact, rel=0.01)
    assert seconds < exact


def test_a_circle_is_run_through_at_the_velocity_of_its_curvature() -> None:
    """√(a·r) at r = 4 mm in the direction in which one axis alone turns; the whole feed at r = 20 mm."""
    for radius, velocity in ((4.0, sqrt(A * 4.0)), (20.0, 100.0)):
        angle = np.linspace(0.0, 2.0 * pi, 2001)
        cos, sin = np.cos(angle), np.sin(angle)
        q1, q2, q3 = (
            np.column_stack(pair) / radius**power
            for pair, power in (((-sin, cos), 0), ((-cos, -sin), 1), ((sin, -cos), 2))
        )
        bound = PathBound(radius * angle, q1, q2, q3, [-1e6, 1e6], feed=100.0, acceleration=A, jerk=1e9)
        assert bound.velocity.min() == pytest.approx(velocity, rel=1e-9)
        assert bound.free(radius * angle).all() == (radius == 20.0)


def test_the_planner_never_exceeds_the_bound_and_nearly_reaches_it() -> None:
    """The beginning of the contour of `python -m bench lookahead`, which shows the figures of all of it."""
    points = list(example()["points"](1500))
    parts: list[PathPart] = []
    rows: list[MotionState] = []
    run(points, parts.append, rows.extend)
    bound = bound_of(parts, feed=FEED, acceleration=A, jerk=J)
    places, velocity = np.array([row[0] for row in rows]), np.array([row[1] for row in rows])
    assert (velocity <= bound.at(places) * 1.002).all()
    free, everywhere, length = feed_reached(points)
    assert free >= 0.9 and everywhere >= 0.9 and 0.3 < length < 1.0
