"""The zero pulse: latched exactly at its place, once per turn, in both directions."""

from __future__ import annotations

import random

import pytest

from cnc_ptp.spindle.homing import ZeroPulse, nearest_shift


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_one_pulse_a_turn_at_its_place(direction: float) -> None:
    draw = random.Random(4)
    pulse = ZeroPulse(77.7)
    pulse.arm()
    place, found = 13.0, []
    while abs(place - 13.0) < 5.0 * 360.0:
        before, place = place, place + direction * draw.uniform(0.0, 50.0)
        mark = pulse.passed(place)
        if mark is not None:
            assert min(before, place) <= mark <= max(before, place)
            found.append(mark)
    assert [(mark - 77.7) % 360.0 for mark in found] == pytest.approx([0.0] * 5)


def test_it_comes_when_the_place_is_met_and_not_when_it_is_left() -> None:
    pulse = ZeroPulse(0.0)
    pulse.arm()
    assert [pulse.passed(place) for place in (350.0, 360.0, 361.0, 370.0)] == [None, 360.0, None, None]
    pulse.arm()
    assert [pulse.passed(place) for place in (370.0, 360.0, 359.0)] == [None, 360.0, None]


def test_no_pulse_before_it_is_armed_and_none_at_rest() -> None:
    pulse = ZeroPulse(0.0)
    pulse.arm()
    assert pulse.passed(-1.0) is None  # where it was before is not known
    assert pulse.passed(-1.0) is None


@pytest.mark.parametrize(
    ("position", "reference", "shift"),
    [(10.0, 0.0, -10.0), (350.0, 0.0, 10.0), (725.0, 90.0, 85.0), (-5.0, -5.0, 0.0), (0.0, 180.0, 180.0)],
)
def test_coordinates_shift_by_half_a_turn_at_most(position: float, reference: float, shift: float) -> None:
    assert nearest_shift(position, reference) == pytest.approx(shift)
