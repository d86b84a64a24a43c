"""The numbers of TX1250 chapter 2 in the runs behind the figures, against closed forms."""

from math import sqrt

import numpy as np
import pytest
from figure_support import (
    CYCLE_TIME,
    arrival,
    cycle_of,
    cycles,
    integrated,
    largest_step,
    ramp_time,
    run_of,
    seven_phases,
    through,
    x,
)

DYNAMICS = {
    # distance, V, A+, A-, J; velocity that is reached, largest acceleration and deceleration that are reached
    "1_1": ((1000.0, 2000.0, 5000.0, 5000.0, 50000.0), (2000.0, 5000.0, 5000.0)),
    "1_2": ((1000.0, 2000.0, 5000.0, 10000.0, 50000.0), (2000.0, 5000.0, 10000.0)),
    "1_3": ((1000.0, 2000.0, 15000.0, 15000.0, 50000.0), (2000.0, 10000.0, 10000.0)),
    "2_1": ((1000.0, 2000.0, 5000.0, 5000.0, 20000.0), (1696.7720, 5000.0, 5000.0)),
    "2_2": ((1000.0, 2000.0, 5000.0, 5000.0, 50000.0), (2000.0, 5000.0, 5000.0)),
    "2_3": ((1000.0, 2000.0, 5000.0, 5000.0, 100000.0), (2000.0, 5000.0, 5000.0)),
    "3_1": ((800.0, 1500.0, 5000.0, 5000.0, 50000.0), (1500.0, 5000.0, 5000.0)),
    "3_2": ((800.0, 1750.0, 5000.0, 5000.0, 50000.0), (1750.0, 5000.0, 5000.0)),
    "3_3": ((800.0, 2000.0, 5000.0, 5000.0, 50000.0), (1765.5644, 5000.0, 5000.0)),
}
SECONDS = {"1_1": 1.0, "1_2": 0.95, "1_3": 0.9, "2_2": 1.0, "2_3": 0.95, "3_1": 0.9333333, "3_2": 0.9071429}
"""Durations that come out round by hand."""

JERK_LIMITED = {
    "ptp_override_100_75_100",
    "ptp_override_20_100",
    "ptp_new_target_in_stop_phase",
    "ptp_new_target_reversal",
}
"""Beside the nine dynamics; all with A+ = A- = 5000, J = 50000."""
RAMP = ramp_time(2000.0, 5000.0, 50000.0)
"""0.5 s from rest to 2000 mm/s."""


# axis start


@pytest.mark.parametrize("name", DYNAMICS)
def test_dynamics_duration_is_that_of_the_seven_phases(name: str) -> None:
    (distance, *limits), _ = DYNAMICS[name]
    _, seconds = seven_phases(distance, *limits)
    assert seconds == pytest.approx(SECONDS.get(name, seconds), abs=1e-7)
    figure = f"ptp_dynamics_{name}"
    assert arrival(figure) - cycle_of(figure, 0) == cycles(seconds)
    assert x(figure, "set_position")[-1] == distance
    assert x(figure, "actual_position")[-1] == pytest.approx(distance, abs=1e-6)


@pytest.mark.parametrize("name", DYNAMICS)
def test_dynamics_reach_what_can_be_reached(name: str) -> None:
    (distance, v, up, down, j), (velocity, highest, lowest) = DYNAMICS[name]
    assert seven_phases(distance, v, up, down, j)[0] == pytest.approx(velocity, abs=1e-4)
    half_cycle = 0.5 * CYCLE_TIME * j  # what the jerk changes between a peak and the nearest cycle
    figure = f"ptp_dynamics_{name}"
    assert x(figure, "set_velocity").max() == pytest.approx(velocity, abs=half_cycle * CYCLE_TIME + 1e-4)
    assert x(figure, "set_acceleration").max() == pytest.approx(highest, abs=half_cycle)
    assert x(figure, "set_acceleration").min() == pytest.approx(-lowest, abs=half_cycle)
    assert x(figure, "set_velocity").max() <= v * (1.0 + 1e-12)


@pytest.mark.parametrize("name", DYNAMICS)
def test_an_acceleration_is_held_above_the_critical_jerk_only(name: str) -> None:
    (_, _, up, down, j), (velocity, highest, lowest) = DYNAMICS[name]
    acceleration = x(f"ptp_dynamics_{name}", "set_acceleration")
    for limit, reached, path in ((up, highest, acceleration), (down, lowest, -acceleration)):
        held = velocity / limit - limit / j  # the constant phase in s; critical: J = A²/V
        assert np.count_nonzero(path >= limit * (1.0 - 1e-9)) == pytest.approx(max(0.0, held / CYCLE_TIME), abs=1.01)
        assert (reached == limit) == (j >= limit * limit / velocity * (1.0 - 1e-9))


def test_critical_jerks_of_dynamics_1() -> None:
    """A²/V: 12500 and 50000 and 112500 mm/s³ for 5000, 10000 and 15000 mm/s² at 2000 mm/s, J = 50000 in between."""
    peak = {name: np.abs(x(f"ptp_dynamics_{name}", "set_acceleration")).max() for name in ("1_1", "1_2", "1_3")}
    assert peak["1_1"] == 5000.0
    assert peak["1_2"] == pytest.approx(10000.0, abs=1e-6)
    assert peak["1_3"] == pytest.approx(sqrt(2000.0 * 50000.0), abs=1e-6)


# override


def test_override_75_and_back_changes_the_level_to_1500() -> None:
    name = "ptp_override_100_75_100"
    velocity = x(name, "set_velocity")
    change = ramp_time(500.0, 5000.0, 50000.0)
    assert change == pytest.approx(0.2)
    start, down, up = (cycle_of(name, command) for command in range(3))
    assert (start, down, up) == (50, 1000, 1800)
    assert np.all(velocity[start + cycles(RAMP) : down] == pytest.approx(2000.0, abs=1e-9))
    assert np.all(velocity[down + cycles(change) : up] == pytest.approx(1500.0, abs=1e-9))
    assert velocity[up + cycles(change)] == pytest.approx(2000.0, abs=1e-9)
    assert (velocity[start : start + cycles(RAMP)] < 2000.0).all()
    assert (velocity[down + 1 : down + cycles(change)] > 1500.0).all()
    slow = (up - down) * CYCLE_TIME  # loses 500 mm/s from the first change to the second, ramps on average half of it
    lost = 500.0 * slow
    assert arrival(name) - start == cycles(5000.0 / 2000.0 + RAMP + lost / 2000.0)
    assert x(name, "set_position")[-1] == 5000.0


def test_override_20_at_the_start_then_100() -> None:
    name = "ptp_override_20_100"
    velocity = x(name, "set_velocity")
    first, change = ramp_time(400.0, 5000.0, 50000.0), ramp_time(1600.0, 5000.0, 50000.0)
    start, up = cycle_of(name, 0), cycle_of(name, 1)
    assert np.all(velocity[start + cycles(first) : up] == pytest.approx(400.0, abs=1e-9))
    assert velocity[up + cycles(change)] == pytest.approx(2000.0, abs=1e-9)
    assert (velocity[up + 1 : up + cycles(change)] < 2000.0).all()
    slow = (up - start) * CYCLE_TIME
    way = 400.0 * (slow - 0.5 * first) + 1200.0 * change + 1000.0 * RAMP
    assert arrival(name) - start == cycles(slow + change + (5000.0 - way) / 2000.0 + RAMP)
    assert x(name, "set_position")[-1] == 5000.0


# new target


def test_new_target_in_the_stop_phase_goes_on_to_5000() -> None:
    name = "ptp_new_target_in_stop_phase"
    position, velocity, acceleration = (x(name, f"set_{field}") for field in ("position", "velocity", "acceleration"))
    start, change = cycle_of(name, 0), cycle_of(name, 1)
    brake_begin = start + cycles(3000.0 / 2000.0)
    assert (brake_begin, change) == (1550, 1800)  # 0.25 s after the start of the first positioning's brake phase
    way, v, a = through([(0.1, -50000.0), (0.15, 0.0)], 2000.0, 0.0)
    state = (position[change], velocity[change], acceleration[change])
    assert state == pytest.approx((2500.0 + way, v, a), abs=1e-8)
    assert (v, a) == pytest.approx((1000.0, -5000.0))
    # the acceleration turns round with J, is held and goes back to 0 at the old velocity
    on, v, a = through([(0.2, 50000.0), (0.15, 0.0), (0.1, -50000.0)], v, a)
    assert (v, a) == pytest.approx((2000.0, 0.0), abs=1e-9)
    top = change + cycles(0.45)
    assert position[top] == pytest.approx(2500.0 + way + on, abs=1e-8)
    assert velocity[top] == pytest.approx(2000.0, abs=1e-9)
    assert (velocity[change + 1 : top] < 2000.0).all()
    assert velocity[change:top].min() == pytest.approx(750.0, abs=1e-9)
    constant = (5000.0 - (2500.0 + way + on) - 1000.0 * RAMP) / 2000.0
    assert arrival(name) - change == cycles(0.45 + constant + RAMP)
    assert position[-1] == 5000.0


def test_new_target_behind_stops_and_goes_back_to_2000() -> None:
    name = "ptp_new_target_reversal"
    position, velocity = x(name, "set_position"), x(name, "set_velocity")
    start, change = cycle_of(name, 0), cycle_of(name, 1)
    passed = 2000.0 * ((change - start) * CYCLE_TIME - 0.5 * RAMP)
    assert position[change] == pytest.approx(passed, abs=1e-9)
    assert passed == pytest.approx(2300.0)
    turn = passed + 1000.0 * RAMP  # the stop with A- and J
    assert position.max() == pytest.approx(turn, abs=1e-6)
    assert position[-1] == 2000.0
    back_velocity, back = seven_phases(turn - 2000.0, 2000.0, 5000.0, 5000.0, 50000.0)
    assert velocity.min() == pytest.approx(-back_velocity, abs=0.02)
    assert arrival(name) - change == cycles(RAMP + back)


# position compensation


@pytest.mark.parametrize(
    ("name", "length", "difference", "reached"),
    [
        ("ptp_compensation_full", 5000.0, 250.0, 250.0),
        ("ptp_compensation_partial", 2000.0, 500.0, 165.0),
        ("ptp_compensation_full_negative", 5000.0, -250.0, -250.0),
    ],
)
def test_compensation_is_a_trapezoid_over_the_whole_length(
    name: str, length: float, difference: float, reached: float
) -> None:
    start, begin = cycle_of(name, 0), cycle_of(name, 1)
    seconds = length / 2000.0
    first, last = (500.0, 1000.0) if difference > 0.0 else (1000.0, 500.0)
    slopes = 1.0 / first + 1.0 / last
    # D = v·T - v²/2·(1/AK+ + 1/AK-), at most VK = 300
    root = seconds**2 - 2.0 * slopes * abs(difference)
    peak = min(300.0, (seconds - sqrt(root)) / slopes) if root >= 0.0 else 300.0
    assert peak * seconds - 0.5 * peak**2 * slopes == pytest.approx(abs(reached))
    t = np.arange(cycles(seconds) + 1) * CYCLE_TIME
    trapezoid = np.minimum(np.minimum(first * t, peak), last * np.maximum(seconds - t, 0.0))
    sign = np.sign(difference)
    during = slice(begin, begin + len(t))
    extra = x(name, "set_velocity")[during] - 2000.0
    assert extra == pytest.approx(sign * trapezoid, abs=1e-6)
    base = 2000.0 * ((np.arange(begin, begin + len(t)) - start) * CYCLE_TIME - 0.5 * RAMP)
    way = x(name, "set_position")[during] - base
    assert way[-1] == pytest.approx(reached, abs=1e-6)
    assert way[-1] - way[-10] != 0.0  # it continues to the very end of L
    assert base[-1] - base[0] == pytest.approx(length)
    assert x(name, "set_position")[-1] == pytest.approx(10000.0 + reached, abs=1e-6)
    bit = x(name, "status_bits").astype(int) & (1 << 13)
    assert np.flatnonzero(bit)[[0, -1]] == pytest.approx([begin, begin + cycles(seconds) - 1], abs=1)


@pytest.mark.parametrize(
    ("name", "end"),
    [
        ("ptp_compensation_full", 10250.0),
        ("ptp_compensation_partial", 10165.0),
        ("ptp_compensation_full_negative", 9750.0),
    ],
)
def test_end_positions_that_the_manual_prints(name: str, end: float) -> None:
    assert x(name, "set_position")[-1] == pytest.approx(end, abs=1e-6)
    assert x(name, "actual_position")[-1] == pytest.approx(end, abs=1e-6)
    assert x(name, "set_velocity")[-1] == 0.0


# external setpoints


def test_external_setpoints_move_in_three_phases() -> None:
    name = "ptp_external_setpoints"
    begin = cycle_of(name, 1) + 1  # one cycle before the motion, the direction is set already
    motion = slice(begin, begin + 851)
    velocity, acceleration = x(name, "set_velocity"), x(name, "set_acceleration")
    t = np.arange(851) * CYCLE_TIME
    trapezoid = np.minimum(np.minimum(4000.0 * t, 1000.0), 4000.0 * (0.85 - t))
    assert velocity[motion] == pytest.approx(trapezoid, abs=1e-9)
    phases = np.repeat([4000.0, 0.0, -4000.0, 0.0], [250, 350, 250, 1])
    assert (acceleration[motion] == phases).all()
    way = np.concatenate([[0.0], np.cumsum(0.5 * (trapezoid[1:] + trapezoid[:-1]) * CYCLE_TIME)])
    assert x(name, "set_position")[motion] == pytest.approx(way, abs=1e-9)
    assert x(name, "set_position")[-1] == 600.0
    assert largest_step(velocity) == pytest.approx(4.0)  # A·T: the velocity does not step, the acceleration may


def test_external_setpoints_are_enabled_from_one_command_to_the_other() -> None:
    name = "ptp_external_setpoints"
    enabled = np.flatnonzero(x(name, "status_bits").astype(int) & (1 << 14))
    assert (enabled[0], enabled[-1] + 1) == (cycle_of(name, 0), cycle_of(name, 2))


# all of them


@pytest.mark.parametrize("name", [*(f"ptp_dynamics_{n}" for n in DYNAMICS), *sorted(JERK_LIMITED)])
def test_neither_velocity_nor_acceleration_steps(name: str) -> None:
    limits = DYNAMICS[name[-3:]][0] if name[-3:] in DYNAMICS else (0.0, 2000.0, 5000.0, 5000.0, 50000.0)
    _, v, up, down, j = limits
    assert largest_step(x(name, "set_acceleration")) <= j * CYCLE_TIME * (1.0 + 1e-9)
    assert largest_step(x(name, "set_velocity")) <= max(up, down) * CYCLE_TIME * (1.0 + 1e-9)
    assert np.abs(x(name, "set_velocity")).max() <= v * (1.0 + 1e-9)
    assert x(name, "set_acceleration").max() <= up * (1.0 + 1e-9)
    assert -x(name, "set_acceleration").min() <= max(up, down) * (1.0 + 1e-9)


@pytest.mark.parametrize("name", ["full", "partial", "full_negative"])
def test_a_compensation_steps_the_acceleration_by_its_own_rates_only(name: str) -> None:
    figure = f"ptp_compensation_{name}"
    basic_v, basic_a = 5000.0 * CYCLE_TIME, 50000.0 * CYCLE_TIME
    assert largest_step(x(figure, "set_velocity")) <= basic_v + 1000.0 * CYCLE_TIME
    assert largest_step(x(figure, "set_acceleration")) <= basic_a + 1000.0 + 1e-9


@pytest.mark.parametrize("name", [*(f"ptp_dynamics_{n}" for n in DYNAMICS), *sorted(JERK_LIMITED)])
def test_positions_are_the_integral_of_the_velocities(name: str) -> None:
    assert integrated(name) == pytest.approx(x(name, "set_position"), abs=1e-4)
    assert run_of(name).columns["x"]["error_id"].max() == 0.0
