"""What a drive does without setpoints: closed forms of its ramps, limits and continuity over random states."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cnc_ptp.control.drives.setpoint_watchdog import (
    axis_stop,
    braking_deceleration,
    own_stop,
    spindle_stop,
)
from cnc_ptp.parameters import read_machine

CONFIG = Path(__file__).parents[2] / "config"
MILL = read_machine(str(CONFIG / "mill.yaml"))
X = MILL.axes["x"]  # A 2000, A- 2400 mm/s², at most 4000, jerk 50000 mm/s³
GEAR = MILL.spindles["s"].gears[1]
CYCLE = 1e-3
BRAKING = 4000.0
"""mm/s²; the file gives no P-AXIS-00003, so that P-AXIS-00008 is the emergency ramp."""


def test_an_axis_brakes_with_its_emergency_deceleration():
    """From v without acceleration: A/J up, hold, A/J down; distance v²/2A + vA/2J, time v/A + A/J."""
    stop = axis_stop(X, 10.0, 400.0, 0.0, BRAKING)
    a, jerk = BRAKING, 50_000.0
    assert braking_deceleration(X, in_step=False) == a and X.jerk == jerk
    assert stop.duration == pytest.approx(400.0 / a + a / jerk, abs=1e-12)
    assert stop.end == (pytest.approx(10.0 + 400.0**2 / (2.0 * a) + 400.0 * a / (2.0 * jerk), abs=1e-9), 0.0, 0.0)


def test_a_slow_axis_does_not_reach_its_deceleration():
    """Below A²/J the peak is √(vJ): time 2√(v/J), distance v√(v/J)."""
    v, jerk = 50.0, 50_000.0
    stop = axis_stop(X, 0.0, -v, 0.0, BRAKING)
    assert stop.duration == pytest.approx(2.0 * (v / jerk) ** 0.5, abs=1e-12)
    assert stop.end[0] == pytest.approx(-v * (v / jerk) ** 0.5, abs=1e-9)


def test_an_emergency_ramp_is_never_weaker_than_the_own_one():
    weak = replace(X, emergency_deceleration=100.0)
    assert braking_deceleration(weak, in_step=False) == X.deceleration == 2400.0


def test_a_drive_of_a_group_brakes_on_the_ramp_of_the_others():
    assert braking_deceleration(X, in_step=True) == 2400.0
    assert (
        braking_deceleration(GEAR, in_step=True) == 40_000.0 and braking_deceleration(GEAR, in_step=False) == 72_000.0
    )


def test_a_spindle_brakes_at_a_constant_deceleration():
    """v²/2a of way, v/a of time."""
    a = 72_000.0
    stop = spindle_stop(90.0, -6000.0, a)
    assert stop.duration == 6000.0 / a
    assert stop.end == (90.0 - 6000.0**2 / (2.0 * a), 0.0, 0.0)
    assert stop.state_at(0.5 * stop.duration)[1] == pytest.approx(-3000.0)


def test_a_drive_that_stands_needs_no_ramp():
    for profile in (axis_stop(X, 7.0, 0.0, 0.0, BRAKING), spindle_stop(7.0, 0.0, BRAKING)):
        assert own_stop(profile, CYCLE) == ([7.0], [0.0])


def test_a_slow_drive_brakes_within_its_jerk():
    """3 mm/s are below A- · T = 4 mm/s, but the jerk needs 2√(v/J) = 15.5 ms for them."""
    assert len(own_stop(axis_stop(X, 0.0, 3.0, 0.0, BRAKING), CYCLE).positions) == 16


def test_the_last_cycle_is_the_first_one_at_a_standstill():
    """A ramp of 2.5 cycles takes three, one of two cycles two."""
    for cycles, count in ((2.5, 3), (2.0, 2)):
        stop = own_stop(spindle_stop(0.0, cycles * CYCLE * BRAKING, BRAKING), CYCLE)
        assert len(stop.positions) == len(stop.velocities) == count
        assert stop.velocities[-1] == 0.0 and stop.velocities[-2] > 0.0


STATES = st.tuples(st.floats(-1e4, 1e4), st.floats(-500.0, 500.0), st.floats(-1e5, 1e5))


@given(STATES)
def test_an_axis_stays_within_its_limits_from_any_state(state):
    """Second differences of the positions are accelerations, third ones jerks."""
    position, velocity, acceleration = state
    stop = own_stop(axis_stop(X, position, velocity, acceleration, BRAKING), CYCLE)
    most = BRAKING
    start = min(most, max(-most, acceleration))
    velocities = np.array([velocity, *stop.velocities])
    assert np.abs(np.diff(velocities)).max() / CYCLE <= most * (1.0 + 1e-9) + 1e-6
    accelerations = np.diff(velocities) / CYCLE
    assert abs(accelerations[0] - start) <= X.jerk * CYCLE * (1.0 + 1e-6) + 1e-6
    assert np.abs(np.diff(accelerations)).max(initial=0.0) <= X.jerk * CYCLE * (1.0 + 1e-6) + 1e-5
    assert stop.velocities[-1] == 0.0
    mean = 0.5 * (velocities[1:] + velocities[:-1]) * CYCLE
    moved = np.diff([position, *stop.positions])
    assert np.abs(moved - mean).max() <= X.jerk * CYCLE**3 + 1e-9
