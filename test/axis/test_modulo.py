"""Modulo targets against exact arithmetic: direction, congruence, minimal distance, whole turns. Source: TX1250 2.1."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples

from cnc_ptp.axis.modulo import modulo_target

MANY = settings(max_examples=examples(500), deadline=None, derandomize=True)
NEAR = 3.6e-7
"""Degrees within which an axis is at its modulo position already."""


@pytest.mark.parametrize(
    ("position", "modulo_position", "target"),
    [
        (0.0, 540.0, 540.0),  # the example of the manual: one turn and 180 on top
        (10.0, 540.0, 540.0),
        (200.0, 540.0, 900.0),  # 180 lies 340 ahead, and one turn
        (0.0, 90.0, 90.0),
        (100.0, 90.0, 450.0),  # may end in the next period
        (100.0, -90.0, 90.0),
        (0.0, -90.0, -270.0),  # -90 is 90, approached backwards
        (50.0, 0.0, 360.0),  # 0 counts as positive
        (50.0, -0.0, 360.0),
        (50.0, -1e-6, 1e-6),  # 0 in negative direction
        (0.0, -1e-6, -360.0 + 1e-6),
        (50.0, -360.0, -360.0),  # 0 backwards, and one turn
        (50.0, 360.0, 720.0),
        (-30.0, 330.0, -30.0),
        (-30.0, 690.0, 330.0),
        (725.0, 5.0, 725.0),  # is there
        (725.0, -5.0, 725.0),
        (725.0, 365.0, 1085.0),
        (725.0, -725.0, 5.0),
        (-1000.0, 80.0, -1000.0),
        (-1000.0, -79.0, -1001.0),
        (-1000.0, 79.0, -641.0),
    ],
)
def test_worked_examples(position: float, modulo_position: float, target: float) -> None:
    assert modulo_target(position, modulo_position, 360.0) == pytest.approx(target, abs=1e-9)


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("turns", [0, 1, 5])
@pytest.mark.parametrize("error", [0.0, 1e-13, -1e-13, 1e-9, -1e-9, 5e-8, -5e-8])
@pytest.mark.parametrize("base", [90.0, 450.0, -270.0, 36_090.0])
def test_rounding_makes_no_full_turn(base: float, error: float, turns: int, direction: float) -> None:
    """An axis that is 1e-13 beyond its modulo position is there; it only makes the turns asked for."""
    position = base + error
    distance = modulo_target(position, direction * (90.0 + 360.0 * turns), 360.0) - position
    assert distance == pytest.approx(direction * 360.0 * turns, abs=1e-7)
    assert turns == 0 or distance * direction > 0.0


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_micro_degree_is_a_way(direction: float) -> None:
    """What the manual uses to approach 0 (1e-6) must not count as rounding."""
    assert modulo_target(90.0 + direction * 1e-6, direction * 90.0, 360.0) == pytest.approx(
        90.0 + direction * 360.0, abs=1e-9
    )


@MANY
@given(
    position=st.floats(-1e5, 1e5),
    modulo_position=st.floats(-2000.0, 2000.0),
    turn=st.sampled_from([360.0, 1.0, 25.4, 400.0]),
)
def test_direction_congruence_and_minimal_way(position: float, modulo_position: float, turn: float) -> None:
    target = modulo_target(position, modulo_position, turn)
    p, m, t = Fraction(position), abs(Fraction(modulo_position)), Fraction(turn)
    sign = -1 if modulo_position < 0.0 else 1
    turns, within = m // t, m % t
    minimal = sign * (within - p) % t
    near = Fraction(1e-9) * t
    rounding = 1e-15 * (abs(position) + abs(modulo_position) + turn) * 4
    if t - minimal <= 2 * near and abs(target - (position + sign * float(turns * t))) <= rounding:
        return  # counts as being there
    assert abs(float(p + sign * (minimal + turns * t) - Fraction(target))) <= rounding
    assert sign * (target - position) >= -rounding
    assert turns <= sign * (Fraction(target) - p) / t + Fraction(rounding) < turns + 1 + Fraction(2 * rounding)


@MANY
@given(position=st.floats(-1e6, 1e6), modulo_position=st.floats(-720.0, 720.0))
def test_the_same_command_again_only_adds_its_whole_turns(position: float, modulo_position: float) -> None:
    """Where the axis has arrived, a second start must not find a distance of nearly one turn because of rounding."""
    there = modulo_target(position, modulo_position, 360.0)
    again = modulo_target(there, modulo_position, 360.0)
    whole = math.copysign(360.0 * (abs(modulo_position) // 360.0), modulo_position)
    assert again - there == pytest.approx(whole, abs=2 * NEAR)
