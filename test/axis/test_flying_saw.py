"""Flying saw: synchronous from its two positions on whatever the master does, within its limits at constant velocity."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples, long
from machine_support import assert_smooth
from slave_support import follow as follow_block

from cnc_ptp.axis.flying_saw import FlyingSaw
from cnc_ptp.errors import CncError
from cnc_ptp.motion import Limits
from cnc_ptp.motion.setpoints import MotionState

QUICK = settings(max_examples=examples(60), deadline=None, derandomize=True, database=None)
T = 0.001
LIMITS = Limits(velocity=2000.0, acceleration=5000.0, deceleration=5000.0, jerk=50000.0)
BLOCK = 10


def moving(velocity: float, seconds: float = 3.0, begin: float = 0.0) -> list[MotionState]:
    return [(begin + velocity * k * T, velocity, 0.0, 0.0) for k in range(round(seconds / T))]


def varying(accelerations: list[tuple[float, float]], velocity: float) -> list[MotionState]:
    """A master that holds accelerations (seconds, mm/s²) one after the other, integrated exactly."""
    p, v, states = 0.0, velocity, []
    for seconds, a in accelerations:
        for _ in range(round(seconds / T)):
            states.append((p, v, a, 0.0))
            p, v = p + v * T + 0.5 * a * T * T, v + a * T
            v = 0.0 if abs(v) < 1e-9 else v
    return states


def saw(factor: float, master_position: float, slave_position: float) -> FlyingSaw:
    positions = {"master_position": master_position, "slave_position": slave_position}
    return FlyingSaw("x", factor, **positions, limits=LIMITS, unit="mm")


def follow(coupling: FlyingSaw, states: list[MotionState], position: float = 0.0) -> np.ndarray:
    """Columns p, v, a, j, block by block as the axis asks."""
    rows: list[MotionState] = []
    for first in range(0, len(states), BLOCK):
        rows += follow_block(coupling, rows[-1][0] if rows else position, states[first : first + BLOCK])
    return np.array(rows)


def ramp_of(velocity: float) -> float:
    """Seconds from rest: V/A + A/J, or 2·√(V/J)."""
    v, a, j = abs(velocity), LIMITS.acceleration, LIMITS.jerk
    return float(v / a + a / j if v * j >= a * a else 2.0 * np.sqrt(v / j))


def test_run_up_begins_when_it_must_and_keeps_the_limits() -> None:
    """2000 mm/s need 0.5 s and 500 mm; 500 mm more are left at synchronous velocity, 0.25 s."""
    states = moving(2000.0)
    rows = follow(saw(1.0, 3000.0, 1000.0), states)
    assert_smooth(*rows[:, :3].T.tolist(), acceleration=5000.0, jerk=50000.0)
    started = np.flatnonzero(rows[:, 0] != 0.0)[0]
    assert started == pytest.approx((1.5 - 0.25 - 0.5) / T, abs=2)
    assert rows[1250:, 0] == pytest.approx(2000.0 * T * np.arange(1250, 3000) - 2000.0, abs=1e-9)
    assert (rows[1250:, 1] == 2000.0).all()


@QUICK
@given(
    st.floats(50.0, 2000.0),
    st.sampled_from([1.0, -1.0]),
    st.floats(0.2, 1.0),
    st.sampled_from([1.0, -1.0]),
    st.floats(0.0, 0.3),
    st.floats(0.0, 0.3),
)
def test_any_saw_is_synchronous_from_its_positions_on(
    speed: float, direction: float, ratio: float, sign: float, wait: float, cruise: float
) -> None:
    """The positions are chosen so that run-up, `wait` and `cruise` (s) fit; the slave begins at 12 mm."""
    v, factor = direction * speed, sign * ratio
    ramp = ramp_of(factor * v)
    master_position = v * (wait + ramp + cruise)
    slave_position = 12.0 + factor * v * (0.5 * ramp + cruise)
    rows = follow(saw(factor, master_position + v * 1e-9, slave_position), moving(v, 2.5), 12.0)
    assert_smooth(*rows[:, :3].T.tolist(), acceleration=5000.0, jerk=50000.0)
    place = v * T * np.arange(len(rows))
    behind = direction * place >= direction * master_position + 1e-6
    expected = slave_position + factor * (place - master_position)
    assert rows[behind, 0] == pytest.approx(expected[behind], abs=1e-5)
    assert rows[behind, 1] == pytest.approx(factor * v, rel=1e-9)


VARIANTS = {
    "slower": [(0.8, 0.0), (0.3, -4000.0), (2.0, 0.0)],
    "faster": [(0.8, 0.0), (0.1, 3000.0), (2.0, 0.0)],
    "waits": [(0.95, 0.0), (0.4, -5000.0), (0.5, 0.0), (0.3, 5000.0), (2.0, 0.0)],
    "to and fro": [(0.9, 0.0), (0.6, -5000.0), (0.8, 5000.0), (2.0, 0.0)],
    "slower while it waits": [(0.1, 0.0), (0.2, -4000.0), (4.0, 0.0)],
    "faster while it waits": [(0.1, 0.0), (0.1, -4000.0), (0.1, 4000.0), (4.0, 0.0)],
}


@pytest.mark.parametrize("name", VARIANTS)
@pytest.mark.parametrize("factor", [-0.75, *long([1.0])])
def test_master_that_changes_its_velocity_is_met_at_the_same_place(name: str, factor: float) -> None:
    states = varying(VARIANTS[name], 2000.0)
    slave_position = factor * 1000.0
    rows = follow(saw(factor, 3000.0, slave_position), states)
    place = np.array(states)[:, 0]
    met = int(np.flatnonzero(place >= 3000.0)[0])
    assert rows[met:, 0] == pytest.approx(slave_position + factor * (place[met:] - 3000.0), abs=1e-9)
    assert rows[met:, 1] == pytest.approx(factor * np.array(states)[met:, 1], abs=1e-9)
    p, v = rows[:, 0], rows[:, 1]
    assert np.diff(p) == pytest.approx(0.5 * T * (v[1:] + v[:-1]), abs=0.01)  # jerk · T³ at most
    assert v[1:-1] == pytest.approx((p[2:] - p[:-2]) / (2 * T), abs=2.6)  # half of what 5000 mm/s² change in a cycle
    assert np.abs(np.diff(v)).max() < 2.0 * 5000.0 * T


def test_slave_stands_while_the_master_stands_in_the_run_up() -> None:
    states = varying(VARIANTS["waits"], 2000.0)
    rows = follow(saw(1.0, 3000.0, 1000.0), states)
    standing = ~np.array(states)[:, 1:3].any(axis=1)
    assert standing.sum() > 400
    assert 0.0 < rows[standing, 0].max() < 1000.0
    assert np.ptp(rows[standing, 0]) == 0.0
    assert not rows[standing, 1:3].any()


def test_run_up_is_planned_anew_while_the_slave_waits() -> None:
    """The master slows from 2000 to 1200 mm/s before the run-up: 0.34 s are enough, within the limits."""
    rows = follow(saw(1.0, 3000.0, 1000.0), varying(VARIANTS["slower while it waits"], 2000.0))
    assert_smooth(*rows[:, :3].T.tolist(), acceleration=5000.0, jerk=50000.0)
    assert rows[:, 1].max() == pytest.approx(1200.0)


def test_synchronous_slave_stays_so_when_the_master_comes_back() -> None:
    states = varying([(2.0, 0.0), (0.8, -5000.0), (1.5, 0.0)], 2000.0)
    rows = follow(saw(1.0, 3000.0, 1000.0), states)
    place = np.array(states)[:, 0]
    assert place[-1] < 3000.0
    assert rows[2000:, 0] == pytest.approx(place[2000:] - 2000.0, abs=1e-9)


def refused(factor: float, master_position: float, slave_position: float, states: list[MotionState]) -> str:
    with pytest.raises(CncError) as caught:
        follow(saw(factor, master_position, slave_position), states)
    assert caught.value.number == 23051
    return caught.value.message


def test_what_cannot_be_synchronised() -> None:
    late = "the run-up takes 0.75 s, the master is there in 0.65 s"
    assert refused(1.0, 1300.0, 1000.0, moving(2000.0)) == late
    past = "the run-up takes 0.75 s, the master was there 0.1 s ago"
    assert refused(1.0, -200.0, 1000.0, moving(2000.0)) == past
    near = "the run-up takes 500 mm, the synchronous position is 400 mm away"
    assert refused(1.0, 3000.0, 400.0, moving(2000.0)) == near
    behind = "the run-up takes 500 mm, the synchronous position is 1000 mm behind the axis"
    assert refused(1.0, 3000.0, -1000.0, moving(2000.0)) == behind
    fast = "it would have to run at 3000 mm/s, its velocity is limited to 2000 mm/s"
    assert refused(-1.5, 3000.0, -1000.0, moving(2000.0)) == fast
    stands = "the master is at a standstill; a flying saw needs a moving master"
    assert refused(1.0, 3000.0, 1000.0, moving(0.0)) == stands


def test_master_that_gets_too_fast_or_turns_round_while_the_slave_waits() -> None:
    text = refused(1.0, 3000.0, 450.0, varying([(0.5, 0.0), (1.0, 1000.0)], 1000.0))
    assert text.startswith("the run-up takes ") and text.endswith(", the synchronous position is 450 mm away")
    assert refused(1.0, 3000.0, 1000.0, varying([(0.1, 0.0), (1.0, -2000.0)], 1000.0)).endswith(
        "is 1000 mm behind the axis"
    )


def test_change_of_the_source_moves_nothing() -> None:
    states = moving(2000.0)
    for cut in (500, 900, 1500):
        plain, shifted = saw(1.0, 3000.0, 1000.0), saw(1.0, 3000.0, 1000.0)
        follow(plain, states[:cut])
        follow(shifted, states[:cut])
        shifted.change_source(10.0, 35.0)
        moved = follow_block(shifted, 0.0, [(p + 25.0, v, a, j) for p, v, a, j in states[cut:]])
        assert np.array(moved) == pytest.approx(np.array(follow_block(plain, 0.0, states[cut:])), abs=1e-8)


@pytest.mark.parametrize("place", [0.0, 99_000.0, -99_000.0])
@pytest.mark.parametrize("velocity", [0.01, *long([1.0])])
def test_a_slow_saw_without_time_to_spare_is_not_late_far_from_zero(place: float, velocity: float) -> None:
    """The run-up fills the whole distance of the slave and the whole time of the master, wherever they are."""
    ramp = ramp_of(velocity)
    for begin in np.random.default_rng(5).uniform(0.0, 1.0, 200):
        slave = place + begin
        coupling = saw(1.0, slave + velocity * ramp, slave + 0.5 * velocity * ramp)
        rows = follow(coupling, moving(velocity, 0.5, slave), slave)
        assert coupling.synchronous and rows[-1, 1] == velocity
