"""Backlash, encoder, viscous friction and torque command of the simulated mechanics, in closed form."""

from __future__ import annotations

import itertools
import math
import random

import pytest
from plant_support import PLANT, T, frictionless, plant

from cnc_ptp.control.drives import CascadedDrive, TorqueCommandedDrive

K = PLANT.torque_per_acceleration


def test_a_torque_command_moves_a_free_axis_on_a_parabola() -> None:
    drive = TorqueCommandedDrive(frictionless(start_position=-3.0), cycle_time=T)
    for _ in range(100):
        drive.step(0.12, 5.0)
    a = 0.12 / K
    assert drive.velocity == pytest.approx(a * 0.1, rel=1e-12)
    assert drive.position == pytest.approx(-3.0 + a * 0.1**2 / 2.0, rel=1e-12)
    assert drive.torque == pytest.approx(0.12)


def test_against_viscous_friction_it_reaches_torque_over_friction() -> None:
    """v(t) = M/b (1 - e^(-b t/k))."""
    of = plant(coulomb=0.0, static=0.0, viscous=0.01)
    drive = TorqueCommandedDrive(of, cycle_time=T)
    for _ in range(60):
        drive.step(0.3, 0.0, 0.2)
    assert drive.velocity == pytest.approx(0.5 / 0.01 * (1.0 - math.exp(-0.01 / K * 0.06)), rel=1e-12)


def test_a_current_loop_delays_the_torque() -> None:
    """M(t) = M (1 - e^(-t/Ti)), shown as the mean of a cycle."""
    drive = TorqueCommandedDrive(frictionless(current_time_constant=0.002), cycle_time=T)
    for cycle in range(1, 20):
        drive.step(0.4)
        begin, end = (math.exp(-time * T / 0.002) for time in (cycle - 1, cycle))
        assert drive.torque == pytest.approx(0.4 * (1.0 - 0.002 / T * (begin - end)), rel=1e-12)


@pytest.mark.parametrize("encoder_at_load", [True, False])
def test_the_load_follows_behind_the_play(encoder_at_load: bool) -> None:
    """Forward it is half the play behind the motor, backward half of it ahead, in between it is at rest."""
    play = 0.05
    of = plant(backlash=play, encoder_at_load=encoder_at_load)
    drive, motor = CascadedDrive(of, cycle_time=T), CascadedDrive(plant(), cycle_time=T)
    load, positions = 0.0, []
    for cycle in range(1500):
        command = 10.0 * math.sin(2.0 * math.pi * cycle * T)
        drive.step(command)
        motor.step(command)
        load = min(max(load, motor.position - play / 2.0), motor.position + play / 2.0)
        assert drive.load_position == pytest.approx(
            load, abs=1e-6
        )  # a reversal within a cycle is seen by the drive alone
        assert drive.position == (drive.load_position if encoder_at_load else motor.position)
        assert drive.velocity == motor.velocity
        positions.append(load)
    assert sum(1 for a, b in itertools.pairwise(positions[200:]) if a == b) > 20


def test_the_encoder_shows_whole_increments() -> None:
    coarse, ideal = CascadedDrive(plant(encoder_increment=0.01), cycle_time=T), CascadedDrive(plant(), cycle_time=T)
    draw = random.Random(5)
    for _ in range(300):
        command = draw.uniform(-30.0, 30.0)
        coarse.step(command)
        ideal.step(command)
        assert coarse.position / 0.01 == pytest.approx(round(coarse.position / 0.01), abs=1e-9)
        assert abs(coarse.position - ideal.position) <= 0.005 + 1e-12
        assert coarse.velocity == ideal.velocity


def test_it_starts_where_it_is_put_and_stays() -> None:
    drive = CascadedDrive(plant(start_position=123.456, backlash=0.1), cycle_time=T)
    assert (drive.position, drive.velocity, drive.torque, drive.has_torque) == (123.456, 0.0, 0.0, True)
    drive.step(0.0)
    assert (drive.position, drive.velocity, drive.torque) == (123.456, 0.0, 0.0)
