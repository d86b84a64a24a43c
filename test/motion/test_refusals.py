"""Everything a planner refuses, with its number and text."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from cnc_ptp.errors import CncError
from cnc_ptp.motion import (
    Limits,
    plan_rest_to_rest,
    plan_rest_to_rest_batch,
    plan_to_position,
    plan_to_velocity,
)

GOOD = Limits(100.0, 1000.0, 1000.0, 10000.0)

BAD_LIMITS = [(math.nan, "nan"), (math.inf, "inf"), (0.0, "0.0"), (-5.0, "-5.0"), (1e-10, "1e-10"), (1e300, "1e+300")]


@pytest.mark.parametrize("name", Limits._fields)
@pytest.mark.parametrize(("value", "text"), BAD_LIMITS)
def test_bad_limits(name, value, text):
    limits = GOOD._replace(**{name: value})
    expected = f"P-ERR-23001 motion limit {name} = {text} must be between 1e-09 and 1e+12; the motion is refused"
    for plan in (
        lambda: plan_rest_to_rest(0.0, 1.0, limits),
        lambda: plan_to_position(0.0, 0.0, 0.0, 1.0, limits),
        lambda: plan_to_velocity(0.0, 0.0, 0.0, 1.0, limits),
        lambda: plan_rest_to_rest_batch(np.zeros(3), 1.0, *(np.array([GOOD[n], x, x]) for n, x in enumerate(limits))),
    ):
        with pytest.raises(CncError) as fault:
            plan()
        assert str(fault.value) == expected


@pytest.mark.parametrize(
    ("plan", "name", "text"),
    [
        (lambda: plan_rest_to_rest(math.nan, 0.0, GOOD), "start", "nan"),
        (lambda: plan_rest_to_rest(0.0, math.inf, GOOD), "target", "inf"),
        (lambda: plan_rest_to_rest(-2e12, 0.0, GOOD), "start", "-2000000000000.0"),
        (lambda: plan_to_position(math.nan, 0.0, 0.0, 0.0, GOOD), "position", "nan"),
        (lambda: plan_to_position(0.0, math.inf, 0.0, 0.0, GOOD), "velocity", "inf"),
        (lambda: plan_to_position(0.0, 0.0, -math.inf, 0.0, GOOD), "acceleration", "-inf"),
        (lambda: plan_to_position(0.0, 0.0, 0.0, 1e13, GOOD), "target", "10000000000000.0"),
        (lambda: plan_to_velocity(math.nan, 0.0, 0.0, 0.0, GOOD), "position", "nan"),
        (lambda: plan_to_velocity(0.0, math.nan, 0.0, 0.0, GOOD), "start_velocity", "nan"),
        (lambda: plan_to_velocity(0.0, 0.0, math.nan, 0.0, GOOD), "start_acceleration", "nan"),
        (lambda: plan_to_velocity(0.0, 0.0, 0.0, math.nan, GOOD), "velocity", "nan"),
        (lambda: plan_rest_to_rest_batch([0.0, math.nan], 0.0, *GOOD), "start", "nan"),
        (lambda: plan_rest_to_rest_batch(0.0, [-math.inf, 0.0], *GOOD), "target", "-inf"),
    ],
)
def test_bad_states(plan, name, text):
    with pytest.raises(CncError) as fault:
        plan()
    assert fault.value.number == 23002
    assert str(fault.value) == (
        f"P-ERR-23002 motion value {name} = {text} must be between -1e+12 and 1e+12; the motion is refused"
    )


@pytest.mark.parametrize(
    "limits", [Limits(1e12, 1e12, 1e12, 1e12), Limits(1e-9, 1e-9, 1e-9, 1e-9), Limits(1e12, 1e-9, 1e12, 1e-9)]
)
def test_the_largest_and_smallest_values_still_give_finite_tables(limits):
    for profile in (
        plan_rest_to_rest(-1e12, 1e12, limits),
        plan_to_position(1e12, 1e12, -1e12, -1e12, limits),
        plan_to_position(1e12, 1e12, -1e12, -1e12, limits, direct=True),
        plan_to_velocity(0.0, -1e12, 1e12, 1e12, limits),
    ):
        assert all(math.isfinite(value) for row in profile.rows for value in row)


def test_extreme_values_in_any_mixture_give_finite_tables_that_end_exactly():
    draw = random.Random(60)

    def limit() -> float:
        return draw.choice((1e-9, 1e12, 10 ** draw.uniform(-9, 12)))

    def value() -> float:
        return draw.choice((0.0, 1.0, -1.0)) * draw.choice(
            (1e12, 10 ** draw.uniform(-300, -20), 10 ** draw.uniform(-40, 12))
        )

    for _ in range(5000):
        limits = Limits(limit(), limit(), limit(), limit())
        state = [value() for _ in range(3)]
        target = value()
        for direct in (False, True):
            profile = plan_to_position(*state, target, limits, direct=direct)
            assert profile.end == (target, 0.0, 0.0)
            assert all(math.isfinite(number) for row in profile.rows for number in row), (state, target, limits)
            assert list(profile.starts) == sorted(profile.starts)
