"""The checker has teeth: a table that is wrong by a billionth and a bit is found, whatever is wrong with it."""

from __future__ import annotations

import numpy as np
import pytest
from motion_checker import Motions, assert_motions, over_acceleration, over_velocity, steps
from motion_problems import Problem

from cnc_ptp.motion import Limits, Profile

LIMITS = Limits(2000.0, 5000.0, 10000.0, 50000.0)
PROBLEM = Problem(1e5, 100.0, -300.0, 1e5 - 3000.0, LIMITS, True)


def with_factor(column: int, factor: float) -> Profile:
    """The plan with one value of its fourth row changed."""
    rows = [list(row) for row in PROBLEM.plan().rows]
    rows[3][column] *= factor
    return Profile([tuple(row) for row in rows])


def test_the_plan_itself_passes():
    assert_motions([PROBLEM], [PROBLEM.plan()])


@pytest.mark.parametrize("column", [1, 2, 3])
def test_a_step_is_found(column):
    wrong = with_factor(column, 1 + (1e-10 if column == 1 else 1e-8))
    assert steps(Motions.of([PROBLEM], [wrong]))[column - 1, 0] > 1.0
    with pytest.raises(AssertionError) as fault:
        assert_motions([PROBLEM], [wrong])
    assert " step: " in str(fault.value)
    assert repr(PROBLEM.limits) in str(fault.value)


@pytest.mark.parametrize(
    ("name", "check"),
    [("velocity", over_velocity), ("acceleration", over_acceleration), ("deceleration", over_acceleration)],
)
def test_a_limit_that_is_broken_by_3e9ths_is_found(name, check):
    tighter = PROBLEM._replace(limits=LIMITS._replace(**{name: getattr(LIMITS, name) * (1 - 3e-9)}))
    assert check(Motions.of([PROBLEM], [PROBLEM.plan()]))[0] <= 1.0
    assert check(Motions.of([tighter], [PROBLEM.plan()]))[0] > 1.0


def test_a_velocity_above_v_that_is_left_late_is_found():
    """0.1 ms of waiting before the ramp from 3000 to 2000 mm/s."""
    problem = PROBLEM._replace(velocity=3000.0, acceleration=0.0, target=1.1e5)
    rows = problem.plan().rows
    late = [(*rows[0][:4], 0.0), *((t + 1e-4, p + 0.3, *rest) for t, p, *rest in rows)]
    assert over_velocity(Motions.of([problem], [problem.plan()]))[0] <= 1.0
    assert over_velocity(Motions.of([problem], [Profile(late)]))[0] > 1.0


def test_shorter_tables_are_filled_with_their_last_row():
    short = PROBLEM._replace(target=1e5, velocity=0.0, acceleration=0.0)
    motions = Motions.of([PROBLEM, short], [PROBLEM.plan(), short.plan()])
    assert motions.t.shape == (2, len(PROBLEM.plan().rows))
    assert (motions.p[1] == 1e5).all()
    assert steps(motions).shape == (3, 2)
    assert np.isfinite(over_velocity(motions)).all()
