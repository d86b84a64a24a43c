"""The torque limit of the cascaded drive: held, anti-windup, against a simulation in very short steps."""

from __future__ import annotations

import math
from collections.abc import Iterable

import pytest
from plant_support import Point, T, friction_torque, frictionless, plant

from cnc_ptp.control.drives import CascadedDrive
from cnc_ptp.parameters.view.control_view import PlantParameters

SHORT_STEPS = 1000


def in_short_steps(of: PlantParameters, commands: Iterable[float]) -> list[Point]:
    """Euler's method in steps of 1 µs: first order and slow, but each line is an equation of the plant."""
    h, k, limit = T / SHORT_STEPS, of.torque_per_acceleration, of.torque_limit
    w = integral = v = 0.0
    x = of.start_position
    points = []
    for u in commands:
        impulse = 0.0
        for _ in range(SHORT_STEPS):
            error = (w if of.time_constant else u) - v
            asked = k * of.velocity_gain * (error + integral)
            growth = h * error / of.velocity_integral_time
            if abs(asked + k * of.velocity_gain * growth) <= limit:
                integral += growth
            w += h * (u - w) / of.time_constant if of.time_constant else 0.0
            torque = min(limit, max(-limit, asked))
            impulse += h * torque
            if v == 0.0 and abs(torque) <= of.static:
                continue
            direction = math.copysign(1.0, v or torque)
            friction = direction * of.static if v == 0.0 else friction_torque(of, v)
            new_v = v + h * (torque - friction) / k
            new_v = 0.0 if v and of.static and new_v * v < 0.0 else new_v
            x += h * (v + new_v) / 2.0
            v = new_v
        points.append(Point(x, v, impulse / T))
    return points


@pytest.mark.parametrize(
    ("of", "commands"),
    [
        (frictionless(torque_limit=0.9), [30.0] * 60),
        (plant(torque_limit=0.9), [30.0] * 60),
        (plant(torque_limit=0.65), [20.0 * math.sin(0.0126 * cycle) for cycle in range(300)]),
        (plant(torque_limit=0.65, time_constant=0.0), [15.0] * 60 + [-15.0] * 60),
    ],
    ids=["no friction", "step", "circle", "reversal"],
)
def test_it_does_what_very_short_steps_do(of: PlantParameters, commands: list[float]) -> None:
    drive = CascadedDrive(of, cycle_time=T)
    for command, truth in zip(commands, in_short_steps(of, commands), strict=True):
        drive.step(command)
        assert drive.position == pytest.approx(truth.position, abs=1e-4)
        assert drive.velocity == pytest.approx(truth.velocity, abs=0.02)
        assert drive.torque == pytest.approx(truth.torque, abs=0.02)
        assert abs(drive.torque) <= of.torque_limit * (1.0 + 1e-12)


def test_at_the_limit_it_accelerates_evenly() -> None:
    of = frictionless(torque_limit=0.6, time_constant=0.0)
    drive = CascadedDrive(of, cycle_time=T)
    for _ in range(50):
        drive.step(1e4)
    a = of.torque_limit / of.torque_per_acceleration
    assert drive.velocity == pytest.approx(a * 50 * T, rel=1e-12)
    assert drive.position == pytest.approx(a * (50 * T) ** 2 / 2.0, rel=1e-12)
    assert drive.torque == pytest.approx(0.6, rel=1e-15)


def test_the_integral_does_not_wind_up() -> None:
    """A step that holds the limit for 100 ms overshoots no more than a short one does."""
    overshoots = []
    for speed in (10.0, 100.0):
        drive = CascadedDrive(frictionless(torque_limit=0.6, time_constant=0.0), cycle_time=T)
        peak = 0.0
        for _ in range(400):
            drive.step(speed)
            peak = max(peak, drive.velocity)
        overshoots.append(peak - speed)
        assert drive.velocity == pytest.approx(speed, abs=1e-6)
    assert overshoots[1] == pytest.approx(overshoots[0], rel=0.05)


def test_a_limit_below_the_static_friction_holds_the_axis_for_ever() -> None:
    drive = CascadedDrive(plant(torque_limit=0.45), cycle_time=T)
    for _ in range(3000):
        drive.step(100.0)
    assert (drive.position, drive.velocity) == (0.0, 0.0)
    assert drive.torque == pytest.approx(0.45)
    drive.step(-100.0)
    for _ in range(30):
        drive.step(-100.0)
    assert drive.torque == pytest.approx(-0.45)


def test_a_drive_at_its_limit_gives_way_to_an_additive_torque_against_it() -> None:
    of = frictionless(torque_limit=0.6)
    drive = CascadedDrive(of, cycle_time=T)
    drive.step(0.0, 0.0, -5.0)
    assert drive.torque == pytest.approx(-0.6)
    assert drive.velocity == pytest.approx(-0.6 / of.torque_per_acceleration * T)


def test_an_axis_without_inertia_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^a cascaded drive needs an inertia above 0 \(P-SIM-00007, P-AXIS-00391\)$"):
        CascadedDrive(plant(torque_per_acceleration=0.0), cycle_time=T)
