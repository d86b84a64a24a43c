"""Friction that holds: standing still, breaking away, coming to rest."""

from __future__ import annotations

import itertools
import math
import random
from dataclasses import replace

import pytest
from plant_support import PLANT, T, plant

from cnc_ptp.control.drives import CascadedDrive, TorqueCommandedDrive

K = PLANT.torque_per_acceleration


def test_a_standing_axis_stands_until_the_torque_exceeds_the_static_friction() -> None:
    drive = TorqueCommandedDrive(plant(start_position=7.25), cycle_time=T)
    for torque in (0.1, -0.3, 0.4999, -0.5, 0.5):
        for _ in range(200):
            drive.step(torque)
            assert (drive.position, drive.velocity, drive.torque) == (7.25, 0.0, pytest.approx(torque, abs=1e-15))
    drive.step(0.5001)
    assert drive.velocity > 0.0


def test_it_breaks_away_when_the_integral_has_grown_to_the_static_friction() -> None:
    """Without filter the torque of a standing drive is k Kp u (1 + t/Tn)."""
    of = plant(time_constant=0.0)
    command = 0.25
    instant = of.velocity_integral_time * (of.static / (K * of.velocity_gain * command) - 1.0)
    drive = CascadedDrive(of, cycle_time=T)
    cycle = 0
    while drive.velocity == 0.0:
        drive.step(command)
        cycle += 1
    assert cycle == math.ceil(instant / T)
    assert cycle > 20


def test_creeping_is_stick_slip_with_the_commanded_speed_in_the_mean() -> None:
    drive = CascadedDrive(plant(stribeck_velocity=0.1), cycle_time=T)
    speeds = []
    for _ in range(20_000):
        drive.step(0.05)
        speeds.append(drive.velocity)
    starts = sum(1 for before, now in itertools.pairwise(speeds) if before == 0.0 < now)
    assert speeds.count(0.0) > 2000
    assert starts > 5
    assert min(speeds) >= 0.0
    assert drive.position == pytest.approx(0.05 * 20.0, rel=0.05)


@pytest.mark.parametrize("static", [0.3, 0.5])
def test_it_comes_to_rest_exactly_and_does_not_drift(static: float) -> None:
    drive = CascadedDrive(plant(static=static), cycle_time=T)
    for command in [40.0] * 100 + [0.0] * 100:
        drive.step(command)
    position, torque = drive.position, drive.torque
    assert drive.velocity == 0.0
    assert abs(torque) <= static
    for _ in range(5000):
        drive.step(0.0)
        assert (drive.position, drive.velocity) == (position, 0.0)
    assert drive.torque == pytest.approx(torque, abs=1e-3)


def test_without_friction_it_comes_to_rest_exactly_too() -> None:
    drive = CascadedDrive(plant(coulomb=0.0, static=0.0), cycle_time=T)
    for command in [40.0] * 100 + [0.0] * 2000:
        drive.step(command)
    assert (drive.velocity, drive.torque) == (0.0, 0.0)


def test_a_sliding_axis_stops_after_the_way_of_its_energy() -> None:
    """Coulomb friction alone, torque 0: v²/2 = C/k · way; it stops in the cycle of k v / C and stays."""
    of = plant(static=0.3, viscous=0.0)
    drive = TorqueCommandedDrive(of, cycle_time=T)
    for _ in range(50):
        drive.step(1.0)
    speed, start = drive.velocity, drive.position
    assert speed == pytest.approx((1.0 - of.coulomb) / K * 50 * T, rel=1e-9)
    cycles = 0
    while drive.velocity:
        drive.step(0.0)
        cycles += 1
    assert cycles == math.ceil(K * speed / of.coulomb / T)
    assert drive.position - start == pytest.approx(K * speed**2 / 2.0 / of.coulomb, rel=1e-6)


def test_a_fast_reversal_does_not_stand() -> None:
    """The torque stays above the static friction: v passes zero on a parabola with a corner, m ± C."""
    of = plant(static=0.3, viscous=0.0)
    drive = TorqueCommandedDrive(of, cycle_time=T)
    for _ in range(5):
        drive.step(1.0)
    speed = drive.velocity
    for _ in range(8):
        drive.step(-1.0)
    braking = speed / ((1.0 + of.coulomb) / K)
    assert drive.velocity == pytest.approx(-(1.0 - of.coulomb) / K * (8 * T - braking), rel=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_friction_takes_energy_and_never_gives_any(seed: float) -> None:
    """Work of the motor = kinetic energy + loss; the loss is at least Coulomb friction times the way, both per axis."""
    draw = random.Random(seed)
    of = plant()
    drive = TorqueCommandedDrive(of, cycle_time=T)
    work = distance = 0.0
    for _ in range(300):
        torque, before = draw.uniform(-1.5, 1.5), drive.position
        held = draw.randrange(1, 6)
        for _ in range(held):
            drive.step(torque)
        work += torque * (drive.position - before)
        distance += abs(drive.position - before)
        loss = work - K * drive.velocity**2 / 2.0
        assert loss >= of.coulomb * distance * (1.0 - 1e-3) - 1e-6


@pytest.mark.parametrize("seed", range(5))
def test_random_commands_keep_it_bounded_and_zero_brings_it_to_rest(seed: int) -> None:
    draw = random.Random(seed)
    of = replace(
        plant(),
        time_constant=draw.choice([0.0, 0.002]),
        current_time_constant=draw.choice([0.0, 0.0004]),
        torque_limit=draw.choice([math.inf, 1.0]),
        stribeck_velocity=10.0 ** draw.uniform(-2.0, 1.0),
        static=draw.uniform(0.3, 0.8),
    )
    drive = CascadedDrive(of, cycle_time=T)
    for _ in range(400):
        drive.step(draw.uniform(-50.0, 50.0), draw.uniform(-5.0, 5.0), draw.uniform(-0.2, 0.2))
        assert abs(drive.velocity) < 3.0 * 55.0
        assert math.isfinite(drive.position)
    for _ in range(3000):
        drive.step(0.0)
    rest = drive.position
    assert drive.velocity == 0.0
    for _ in range(100):
        drive.step(0.0)
    assert (drive.velocity, drive.position) == (0.0, rest)


def test_the_same_commands_give_the_same_bits() -> None:
    runs = []
    for _ in range(2):
        drive = CascadedDrive(plant(current_time_constant=0.0003), cycle_time=T)
        for cycle in range(500):
            drive.step(20.0 * math.sin(0.03 * cycle))
        runs.append((drive.position, drive.velocity, drive.torque))
    assert runs[0] == runs[1]
