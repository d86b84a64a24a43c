"""Steady motion of the cascaded drive in closed form."""

from __future__ import annotations

import pytest
from plant_support import PLANT, T, friction_torque, frictionless, plant

from cnc_ptp.control.drives import CascadedDrive

SPEEDS = [0.8, -0.8, 2.0, -5.0, 30.0, -400.0]
K = PLANT.torque_per_acceleration


def after(drive: CascadedDrive, cycles: int, *inputs: float) -> CascadedDrive:
    for _ in range(cycles):
        drive.step(*inputs)
    return drive


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("current_time_constant", [0.0, 0.0005])
def test_at_constant_velocity_the_torque_is_the_friction_curve(speed: float, current_time_constant: float) -> None:
    drive = after(CascadedDrive(plant(current_time_constant=current_time_constant), cycle_time=T), 600, speed)
    assert drive.velocity == pytest.approx(speed, abs=1e-9)
    assert drive.torque == pytest.approx(friction_torque(PLANT, speed), abs=1e-9)


@pytest.mark.parametrize("speed", [5.0, -40.0])
def test_a_proportional_controller_is_behind_by_friction_over_gain(speed: float) -> None:
    of = plant(velocity_integral_time=0.0)
    drive = after(CascadedDrive(of, cycle_time=T), 400, speed)
    deviation = friction_torque(of, drive.velocity) / (K * of.velocity_gain)
    assert speed - drive.velocity == pytest.approx(deviation, abs=1e-9)


def test_an_additive_torque_of_the_friction_makes_that_good() -> None:
    of = plant(velocity_integral_time=0.0)
    drive = after(CascadedDrive(of, cycle_time=T), 400, 40.0, 0.0, friction_torque(of, 40.0))
    assert drive.velocity == pytest.approx(40.0, abs=1e-9)


def test_on_a_ramp_the_velocity_lags_by_acceleration_times_filter_time() -> None:
    """Only the filter lags, the PI controller does not. The stairs of the command are another a T/2 behind the ramp."""
    a, filter_time = 1000.0, 0.003
    drive = CascadedDrive(frictionless(), cycle_time=T)
    for cycle in range(400):
        drive.step(a * cycle * T)
    before = drive.position
    drive.step(a * 400 * T)
    mean_velocity = (drive.position - before) / T
    assert a * 400.5 * T - mean_velocity == pytest.approx(a * (filter_time + T / 2), rel=1e-3)


def test_at_constant_acceleration_the_torque_is_inertia_and_friction() -> None:
    a = 500.0
    drive = CascadedDrive(plant(), cycle_time=T)
    torques = []
    for cycle in range(400):
        drive.step(a * cycle * T)
        torques.append(drive.torque - friction_torque(PLANT, drive.velocity))
    assert sum(torques[-50:]) / 50 == pytest.approx(K * a, rel=0.02)  # each at the end of a stair, so a little less


def test_additive_velocity_acts_behind_the_filter_and_torque_at_once() -> None:
    """With both, the drive follows a ramp without the lag a Ta of the filter; the stairs of the command remain."""
    a = 500.0
    drive = CascadedDrive(frictionless(), cycle_time=T)
    for cycle in range(200):
        drive.step(0.0, a * (cycle + 0.5) * T, K * a)
    assert drive.velocity == pytest.approx(a * 200 * T, abs=a * T / 8)


def test_position_is_the_integral_of_the_velocity() -> None:
    drive = after(CascadedDrive(plant(), cycle_time=T), 600, 12.0)
    before = drive.position
    after(drive, 1000, 12.0)
    assert drive.position - before == pytest.approx(12.0, abs=1e-9)
