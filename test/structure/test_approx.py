"""`pytest.approx` of arrays and lists is what pytest compares value by value (test/support/approx_support.py)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from approx_support import within

RAMP = [0.1 * n for n in range(20)]
OFF = [*RAMP[:-1], RAMP[-1] + 1e-3]


@pytest.mark.parametrize("kind", [list, tuple, np.array])
def test_one_value_out_of_tolerance_is_a_difference(kind):
    assert kind(RAMP) == pytest.approx(kind(RAMP)) and kind(RAMP) != pytest.approx(kind(OFF))
    assert kind(OFF) == pytest.approx(kind(RAMP), abs=1.1e-3) and kind(OFF) != pytest.approx(kind(RAMP), abs=0.9e-3)
    assert kind(OFF) == pytest.approx(kind(RAMP), rel=1e-3) and kind(OFF) != pytest.approx(kind(RAMP), rel=1e-4)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_no_finite_number_equals_no_number(value):
    broken = [*RAMP[:-1], value]
    assert broken != pytest.approx(RAMP) and broken != pytest.approx(RAMP, rel=1.0, abs=1e9)
    assert pytest.approx(broken) != RAMP and pytest.approx(broken, rel=1.0, abs=1e9) != RAMP
    assert (broken == pytest.approx(broken)) is (value == value)


def test_other_lengths_and_shapes_differ():
    assert RAMP[:-1] != pytest.approx(RAMP) and np.ones((4, 5)) != pytest.approx(np.ones((5, 4)))
    assert np.ones(20) == pytest.approx(1.0), "an array against one number"
    assert np.ones(20) != pytest.approx(1.1) and pytest.approx(0.0, abs=1e9) != RAMP


def test_what_pytest_compares_exactly_is_no_number():
    assert pytest.approx([1.0] * 9 + [True]) != [1.0] * 10
    assert np.ones(10) != pytest.approx(np.array(1.0))


def test_what_is_near_is_decided_at_once():
    assert within(pytest.approx(RAMP), RAMP) and not within(pytest.approx(RAMP), OFF)
