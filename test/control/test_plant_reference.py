"""The cascaded drive against an independent solution of its differential equations (solve_ivp with events)."""

from __future__ import annotations

import math
import random

import pytest
from plant_support import Point, Reference, T, frictionless, plant

from cnc_ptp.control.drives import CascadedDrive
from cnc_ptp.parameters.view.control_view import PlantParameters

Inputs = list[tuple[float, float, float]]
THERE_AND_BACK: Inputs = [(20.0 * math.sin(2.0 * math.pi * 2.0 * cycle * T), 0.0, 0.0) for cycle in range(600)]
"""Two turns of a circle: stops, rests and reverses."""


def largest_deviations(of: PlantParameters, inputs: Inputs) -> Point:
    """Between drive and reference over all cycles."""
    drive, reference = CascadedDrive(of, cycle_time=T), Reference(of)
    position = velocity = torque = 0.0
    for each in inputs:
        drive.step(*each)
        truth = reference.cycle(*each)
        position = max(position, abs(drive.position - truth.position))
        velocity = max(velocity, abs(drive.velocity - truth.velocity))
        torque = max(torque, abs(drive.torque - truth.torque))
    return Point(position, velocity, torque)


@pytest.mark.parametrize(
    "of",
    [
        frictionless(),
        frictionless(time_constant=0.0),
        frictionless(velocity_integral_time=0.0),
        frictionless(current_time_constant=0.0003),
        plant(coulomb=0.0, static=0.0, viscous=0.02, current_time_constant=0.0003),
        frictionless(velocity_gain=20_000.0, velocity_integral_time=0.0002),
    ],
    ids=["plain", "no filter", "proportional", "current loop", "viscous", "fast"],
)
def test_the_linear_part_is_exact(of: PlantParameters) -> None:
    deviation = largest_deviations(of, THERE_AND_BACK[:250])
    assert deviation.position < 1e-10
    assert deviation.velocity < 1e-8
    assert deviation.torque < 1e-8


def test_coulomb_friction_alone() -> None:
    deviation = largest_deviations(plant(static=0.3), THERE_AND_BACK)
    assert deviation.position < 1e-7
    assert deviation.velocity < 5e-5
    assert deviation.torque < 2e-5


@pytest.mark.long
@pytest.mark.parametrize(
    "of",
    [
        plant(),
        plant(current_time_constant=0.0003),
        plant(stribeck_velocity=0.3),
        plant(time_constant=0.0),
        plant(velocity_integral_time=0.0),
    ],
    ids=["plain", "current loop", "narrow", "no filter", "proportional"],
)
def test_reversals_with_stribeck_friction(of: PlantParameters) -> None:
    deviation = largest_deviations(of, THERE_AND_BACK)
    assert deviation.position < 5e-6
    assert deviation.velocity < 2e-3
    assert deviation.torque < 1e-3


def test_stick_slip_at_creeping_speed() -> None:
    deviation = largest_deviations(plant(), [(0.3, 0.0, 0.0)] * 800)
    assert deviation.position < 1e-6
    assert deviation.velocity < 1e-3


def test_jumping_commands_with_additive_values() -> None:
    draw = random.Random(3)
    inputs = [(draw.uniform(-20.0, 20.0), draw.uniform(-2.0, 2.0), draw.uniform(-0.3, 0.3)) for _ in range(300)]
    deviation = largest_deviations(plant(), inputs)
    assert deviation.position < 1e-4
    assert deviation.velocity < 0.05
