"""Cyclic slave: its acceleration keeps AccBound whatever the factors are; between them it is exactly linear."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples
from slave_support import follow

from cnc_ptp.axis.coupling import CyclicCoupling
from cnc_ptp.motion.setpoints import MotionState

QUICK = settings(max_examples=examples(60), deadline=None, derandomize=True, database=None)
T = 0.001
A = 5000.0
BLOCK = 10


def master(accelerations: Sequence[float], start: float = 100.0) -> list[MotionState]:
    """A master that holds each acceleration for a block, integrated exactly; a state a cycle, at the end one more."""
    p, v, states = start, 0.0, []
    for a in np.repeat(accelerations, BLOCK).tolist():
        states.append((p, v, a, 0.0))
        p, v = p + v * T + 0.5 * a * T * T, v + a * T
    return [*states, (p, v, 0.0, 0.0)]


def slave(states: Sequence[MotionState], factors: Sequence[float], bound: float, start: float = -7.0) -> np.ndarray:
    """Columns p, v, a of a slave that gets a factor a block."""
    coupling = CyclicCoupling("x", bound, cycle_time=T)
    rows: list[MotionState] = []
    for block, factor in enumerate(factors):
        coupling.set_factor(factor)
        part = states[block * BLOCK : (block + 1) * BLOCK]
        rows += follow(coupling, start if not rows else rows[-1][0], part)
    return np.array(rows)[:, :3]


def highest_accelerations(rows: np.ndarray) -> tuple[float, float, float]:
    """As it is reported, as velocity has it, and as position has it."""
    p, v, a = rows.T
    return np.abs(a).max(), np.abs(np.diff(v)).max() / T, np.abs(np.diff(p, 2)).max() / T**2


CONSTANT = [A] * 20 + [0.0] * 180
"""Up to 1000 mm/s in 0.2 s, then on for 1.8 s."""


def changing(*factors: float) -> np.ndarray:
    """The slave of a master under CONSTANT that gets its factors in equal parts of the 2 s; AccBound 8000."""
    return slave(master(CONSTANT), np.repeat(factors, 200 // len(factors)).tolist(), 8000.0)


MOTIONS = st.lists(st.sampled_from([-A, -2000.0, 0.0, 0.0, 3000.0, A]), min_size=15, max_size=40)
FACTORS = st.lists(st.floats(-3.0, 3.0), min_size=1, max_size=15)


@QUICK
@given(MOTIONS, FACTORS, st.floats(1.0, 3.0))
def test_acceleration_bound_is_kept_above_the_stability_bound(
    motion: list[float], factors: list[float], reserve: float
) -> None:
    factors = [factors[k % len(factors)] for k in range(len(motion))]
    bound = max(reserve * max(map(abs, factors)) * A, 1.0)
    rows = slave(master(motion), factors, bound)
    reported, by_velocity, by_position = highest_accelerations(rows)
    assert reported <= bound * (1.0 + 1e-9)
    assert by_velocity <= bound * (1.0 + 1e-9) + 1e-9
    assert by_position <= bound * (1.0 + 1e-9) + 1e-5  # positions are rounded at 1e-13, over T² that is 1e-7


@QUICK
@given(MOTIONS, FACTORS, st.floats(0.05, 1.0))
def test_acceleration_bound_is_kept_below_it_too(motion: list[float], factors: list[float], share: float) -> None:
    factors = [factors[k % len(factors)] for k in range(len(motion))]
    bound = max(share * max(map(abs, factors)) * A, 1.0)
    reported, by_velocity, by_position = highest_accelerations(slave(master(motion), factors, bound))
    assert max(reported, by_velocity) <= bound * (1.0 + 1e-9) + 1e-9
    assert by_position <= bound * (1.0 + 1e-9) + 1e-5


@QUICK
@given(MOTIONS, FACTORS, st.floats(-3.0, 3.0))
def test_slave_is_exactly_linear_once_its_factor_stays(motion: list[float], factors: list[float], last: float) -> None:
    """2 · 3 · v/(B - 3·A) is the longest distance to a new velocity; after it the offset no longer changes."""
    held = 130
    bound = 8.0 * A
    states = master([*motion, *[0.0] * held])
    rows = slave(states, [*(factors[k % len(factors)] for k in range(len(motion))), *[last] * held], bound)
    p, v, _ = np.array(states)[: len(rows), :3].T
    first = len(motion) * BLOCK + int(6.0 * np.abs(v).max() / (bound - 3.0 * A) / T) + 2
    offset = rows[first:, 0] - last * p[first:]
    assert len(offset) > 500
    assert np.ptp(offset) <= 1e-9
    assert rows[first:, 1] == pytest.approx(last * v[first:], abs=1e-9)


def test_change_of_factor_takes_the_time_of_the_bound() -> None:
    """0.5 -> 1.5 at 1000 mm/s and 8000 mm/s²: 0.125 s; the velocity is a straight line."""
    rows = changing(0.5, 1.5)
    distance = rows[1000:1125, 1]
    assert distance == pytest.approx(500.0 + 8.0 * np.arange(1, 126), abs=1e-9)
    assert rows[1124:, 1] == pytest.approx(1500.0, abs=1e-9)
    assert rows[1124, 0] - rows[999, 0] == pytest.approx(1000.0 * 0.125, abs=1e-9)


def test_factor_0_brings_the_slave_to_rest_and_change_of_sign_turns_it() -> None:
    rows = changing(1.0, 0.0, -1.0, 1.0)
    assert rows[620:1000, 1].tolist() == pytest.approx([1000.0 - 8.0 * k for k in range(121, 125)] + [0.0] * 376)
    assert np.ptp(rows[630:1000, 0]) == 0.0
    assert rows[1400, 1] == pytest.approx(-1000.0, abs=1e-9)
    assert rows[1999, 1] == pytest.approx(1000.0, abs=1e-9)
    assert highest_accelerations(rows)[1] == pytest.approx(8000.0)


def test_slave_without_a_factor_stands() -> None:
    coupling = CyclicCoupling("x", 8000.0, cycle_time=T)
    assert {state[:3] for state in follow(coupling, 5.0, master(CONSTANT))} == {(5.0, 0.0, 0.0)}


def test_factor_that_is_set_at_rest_acts_from_the_first_cycle() -> None:
    states = master([A, 0.0, -A, 0.0])
    rows = slave(states, [1.5] * 4, 7500.0)
    assert rows[:, 0] == pytest.approx(-7.0 + 1.5 * (np.array(states)[:40, 0] - 100.0), abs=1e-12)


def test_slave_below_the_stability_bound_lags_and_catches_up_in_velocity() -> None:
    """AccBound 2000 for a master with 5000: the ramp to 1000 mm/s takes 0.5 s instead of 0.2 s."""
    states = master(CONSTANT)
    rows = slave(states, [1.0] * 200, 2000.0)
    assert rows[:500, 1] == pytest.approx(2.0 * np.arange(0, 500), abs=3.0)
    assert rows[505:, 1] == pytest.approx(1000.0, abs=1e-9)
    assert np.abs(rows[:, 2]).max() == pytest.approx(2000.0)


@pytest.mark.parametrize("factor", [1e308, -1e308])
def test_huge_factor_is_no_way_around_the_bound(factor: float) -> None:
    rows = slave(master([A] * 20 + [0.0] * 20 + [-A] * 20), [factor] * 60, 8000.0)
    assert np.isfinite(rows).all()
    assert np.abs(np.diff(rows[:, 1])).max() <= 8.0 * (1.0 + 1e-9)


def test_change_of_the_source_moves_nothing() -> None:
    """The master's position is counted 25 mm further from a block on: the slave continues as if nothing had been."""
    states = master(CONSTANT)
    plain, shifted = (CyclicCoupling("x", 8000.0, cycle_time=T) for _ in range(2))
    for coupling in (plain, shifted):
        coupling.set_factor(-2.0)
        follow(coupling, 0.0, states[:400])
    shifted.change_source(10.0, 35.0)
    expected = follow(plain, 0.0, states[400:800])
    moved = follow(shifted, 0.0, [(p + 25.0, v, a, j) for p, v, a, j in states[400:800]])
    assert np.array(moved) == pytest.approx(np.array(expected), abs=1e-9)
