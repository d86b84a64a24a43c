"""Position, lag and delayed commands in front of a drive, the virtual drive, and which drive an axis gets."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from loop_support import KV, PLANT, TA, T, control, first_order

from cnc_ptp.control.drives import (
    CascadedDrive,
    DelayedDrive,
    Drive,
    FirstOrderDrive,
    LagCommandedDrive,
    PositionCommandedDrive,
    TelegramDrive,
    TorqueCommandedDrive,
    VirtualDrive,
    make_drive,
)
from cnc_ptp.parameters.view.control_view import ControlParameters


def values(drive: Drive) -> tuple[float, float, float]:
    return drive.position, drive.velocity, drive.torque


def test_a_position_command_is_what_a_velocity_command_of_kv_times_the_lag_is() -> None:
    by_position, by_velocity = PositionCommandedDrive(first_order(start=2.0), kv=40.0), first_order(start=2.0)
    for cycle in range(300):
        target = 2.0 + 0.03 * cycle
        additive = (1.5, 0.1 * math.sin(0.1 * cycle))
        command = 40.0 * (target - by_velocity.position)
        by_position.step(target, *additive)
        by_velocity.step(command, *additive)
        assert values(by_position) == values(by_velocity)


def test_a_drive_under_position_command_lags_by_v_over_kv() -> None:
    drive = PositionCommandedDrive(first_order(), kv=40.0)
    lag = 0.0
    for cycle in range(2000):
        lag = 80.0 * cycle * T - drive.position
        drive.step(80.0 * cycle * T)
    assert lag == pytest.approx(80.0 / 40.0, abs=1e-9)


def test_under_lag_command_the_drive_multiplies() -> None:
    by_lag, by_velocity = LagCommandedDrive(first_order(), kv=40.0), first_order()
    for cycle in range(100):
        by_lag.step(0.01 * cycle, 3.0, 0.2)
        by_velocity.step(0.4 * cycle, 3.0, 0.2)
        assert by_lag.position == pytest.approx(by_velocity.position, rel=1e-12)
        assert by_lag.has_torque


@pytest.mark.parametrize("cycles", [1, 3])
def test_a_delayed_drive_does_the_same_some_cycles_later(cycles: int) -> None:
    delayed, direct = DelayedDrive(first_order(start=5.0), cycles=cycles, rest=0.0), first_order(start=5.0)
    past = []
    for cycle in range(100):
        inputs = (20.0 * math.sin(0.1 * cycle), 0.1 * cycle, 0.05)
        delayed.step(*inputs)
        direct.step(*inputs)
        past.append(values(direct))
        expected = past[cycle - cycles] if cycle >= cycles else (5.0, 0.0, 0.0)
        assert values(delayed) == expected


def test_the_virtual_drive_is_where_it_is_told_to_be() -> None:
    drive = VirtualDrive(start_position=4.0)
    assert (*values(drive), drive.has_torque) == (4.0, 0.0, 0.0, False)
    drive.follow(5.5, 12.0)
    drive.step(100.0, 100.0, 100.0)
    assert values(drive) == (5.5, 12.0, 0.0)


def of(interface: str, *, ideal: bool = True, **plant: float | bool) -> ControlParameters:
    parameters = control(interface=interface, plant=replace(PLANT, **plant))  # type: ignore[arg-type]
    return replace(parameters, drive=replace(parameters.drive, ideal=ideal))


@pytest.mark.parametrize(
    ("parameters", "kind"),
    [
        (of("velocity"), FirstOrderDrive),
        (of("velocity", cascaded=True), CascadedDrive),
        (of("position"), PositionCommandedDrive),
        (of("lag", cascaded=True), LagCommandedDrive),
        (of("torque"), TorqueCommandedDrive),
        (of("torque", cascaded=True), TorqueCommandedDrive),
        (of("none"), VirtualDrive),
        (of("velocity", bus_delay_cycles=2), DelayedDrive),
        (of("velocity", ideal=False, bus_delay_cycles=2), TelegramDrive),
        (of("none", ideal=False), VirtualDrive),
    ],
)
def test_choice(parameters: ControlParameters, kind: type) -> None:
    assert type(make_drive(parameters, T)) is kind


def test_the_plant_and_its_kv_reach_the_drive() -> None:
    chosen = make_drive(of("position", kv=KV / 2.0, start_position=1.0, bus_delay_cycles=1), T)
    by_hand = PositionCommandedDrive(first_order(TA, start=1.0), kv=KV / 2.0)
    by_hand.step(1.0)
    for cycle in range(50):
        chosen.step(1.0 + 0.02 * cycle)
        expected = values(by_hand)
        by_hand.step(1.0 + 0.02 * cycle)
        assert values(chosen) == expected
