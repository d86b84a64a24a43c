"""The simulated drive against the exact solution of its differential equations."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from cnc_ptp.control.drives import FirstOrderDrive

T = 0.001


def drive(time_constant: float, increment: float = 0.0, start: float = 0.0) -> FirstOrderDrive:
    return FirstOrderDrive(cycle_time=T, time_constant=time_constant, encoder_increment=increment, start_position=start)


def matrix_exponential(matrix: np.ndarray) -> np.ndarray:
    """Scaling and squaring of the series; the drive itself uses the closed form."""
    scaled, result, term = matrix / 1024.0, np.eye(len(matrix)), np.eye(len(matrix))
    for n in range(1, 20):
        term = term @ scaled / n
        result = result + term
    return np.linalg.matrix_power(result, 1024)


@pytest.mark.parametrize("time_constant", [0.0005, 0.003, 0.1])
def test_random_commands_follow_the_matrix_exponential(time_constant: float) -> None:
    """x' = v, v' = (u - v)/Ta with u held over a cycle, as one linear system of (x, v, u)."""
    lag = 1.0 / time_constant
    transition = matrix_exponential(np.array([[0.0, 1.0, 0.0], [0.0, -lag, lag], [0.0, 0.0, 0.0]]) * T)
    draw = random.Random(7)
    simulated, state = drive(time_constant, start=12.5), np.array([12.5, 0.0, 0.0])
    for _ in range(500):
        state[2] = draw.uniform(-300.0, 300.0)
        state = transition @ state
        simulated.step(state[2])
        assert simulated.position == pytest.approx(state[0], abs=1e-9)
        assert simulated.velocity == pytest.approx(state[1], abs=1e-9)


def test_step_response_reaches_63_percent_after_the_time_constant() -> None:
    simulated = drive(0.004)
    for _ in range(4):
        simulated.step(100.0)
    assert simulated.velocity == pytest.approx(100.0 * (1.0 - math.exp(-1.0)), rel=1e-12)
    assert simulated.position == pytest.approx(100.0 * (0.004 - 0.004 * (1.0 - math.exp(-1.0))), rel=1e-12)


def test_without_lag_the_command_acts_at_once() -> None:
    simulated = drive(0.0)
    simulated.step(250.0)
    assert (simulated.velocity, simulated.position) == (250.0, 0.25)


def test_a_ramp_leaves_a_lag_of_acceleration_times_time_constant() -> None:
    """v_command = a·t: the velocity lags by a·Ta once the start has died away (the command is a staircase: + a·T/2)."""
    simulated, a, time_constant = drive(0.003), 1000.0, 0.003
    for cycle in range(100):
        simulated.step(a * cycle * T)
    staircase = a * 100 * T - a * T / (1.0 - math.exp(-T / time_constant))
    assert simulated.velocity == pytest.approx(staircase, rel=1e-9)
    assert a * 100 * T - simulated.velocity == pytest.approx(a * time_constant + a * T / 2, rel=0.02)


def test_the_encoder_shows_whole_increments_of_the_true_position() -> None:
    coarse, ideal = drive(0.003, increment=0.01), drive(0.003)
    for cycle in range(300):
        for simulated in (coarse, ideal):
            simulated.step(7.0 * math.sin(0.05 * cycle))
        assert coarse.position / 0.01 == pytest.approx(round(coarse.position / 0.01), abs=1e-9)
        assert abs(coarse.position - ideal.position) <= 0.005 + 1e-12
        assert coarse.velocity == ideal.velocity


def test_start_position_on_the_encoder() -> None:
    assert drive(0.003, increment=0.01, start=1.2345).position == pytest.approx(1.23)
    assert drive(0.003, start=1.2345).position == 1.2345


def test_position_loop_at_constant_velocity_lags_by_v_over_kv() -> None:
    """To 1e-9 once the start has died away; the drive's lag does not change the steady state."""
    for time_constant in (0.0, 0.003):
        simulated, v = drive(time_constant), 120.0
        error = 0.0
        for cycle in range(2000):
            error = v * cycle * T - simulated.position
            simulated.step(50.0 * error)
        assert error == pytest.approx(v / 50.0, abs=1e-9)
        assert simulated.velocity == pytest.approx(v, abs=1e-9)


@pytest.mark.parametrize("time_constant", [0.0005, 0.003, 0.1])
def test_additive_velocity_and_torque_follow_the_matrix_exponential(time_constant: float) -> None:
    """x' = v, v' = (u + a - v)/Ta + M/k as one linear system of (x, v, u, a, M)."""
    lag, k = 1.0 / time_constant, 6.0e-4
    system = np.zeros((5, 5))
    system[0, 1] = 1.0
    system[1] = [0.0, -lag, lag, lag, 1.0 / k]
    transition = matrix_exponential(system * T)
    draw = random.Random(8)
    simulated = FirstOrderDrive(
        cycle_time=T, time_constant=time_constant, encoder_increment=0.0, torque_per_acceleration=k
    )
    state = np.zeros(5)
    for _ in range(300):
        state[2:] = draw.uniform(-300.0, 300.0), draw.uniform(-20.0, 20.0), draw.uniform(-1.0, 1.0)
        before = state[1]
        state = transition @ state
        simulated.step(*state[2:])
        assert simulated.position == pytest.approx(state[0], abs=1e-9)
        assert simulated.velocity == pytest.approx(state[1], abs=1e-9)
        assert simulated.torque == pytest.approx(k * (state[1] - before) / T, abs=1e-9)


def test_the_torque_over_time_is_the_momentum() -> None:
    simulated = FirstOrderDrive(cycle_time=T, time_constant=0.003, encoder_increment=0.0, torque_per_acceleration=2e-3)
    impulse = 0.0
    for cycle in range(200):
        simulated.step(80.0 * math.sin(0.07 * cycle))
        impulse += simulated.torque * T
    assert impulse == pytest.approx(2e-3 * simulated.velocity, rel=1e-12)
    assert simulated.has_torque


def test_velocity_and_torque_in_time_take_the_lag_of_a_ramp_away() -> None:
    """With M = k a a drive follows v(t) = a t but for the stairs of the command; without it lags by a Ta = 3 mm/s."""
    simulated = FirstOrderDrive(cycle_time=T, time_constant=0.003, encoder_increment=0.0, torque_per_acceleration=6e-4)
    a, torque = 1000.0, 6e-4 * 1000.0
    for cycle in range(50):
        simulated.step(a * (cycle + 0.5) * T, 0.0, torque)
    assert a * 50 * T - simulated.velocity == pytest.approx(0.0, abs=a * T * T / (8 * 0.003))


def test_an_ideal_drive_cannot_be_moved_by_a_torque() -> None:
    simulated = FirstOrderDrive(cycle_time=T, time_constant=0.0, encoder_increment=0.0, torque_per_acceleration=6e-4)
    simulated.step(10.0, 5.0, 100.0)
    assert (simulated.velocity, simulated.position) == (15.0, 0.015)
    assert simulated.torque == pytest.approx(6e-4 * 15.0 / T)


def test_a_drive_without_inertia_shows_no_torque() -> None:
    simulated = drive(0.003)
    simulated.step(10.0, 0.0, 100.0)
    reference = drive(0.003)
    reference.step(10.0)
    assert (simulated.torque, simulated.has_torque) == (0.0, False)
    assert (simulated.velocity, simulated.position) == (reference.velocity, reference.position)


def test_a_drive_comes_to_rest_exactly() -> None:
    simulated = drive(0.003)
    for command in [250.0] * 20 + [0.0] * 200:
        simulated.step(command)
    assert simulated.velocity == 0.0
