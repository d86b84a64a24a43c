"""The gain at which a loop becomes unstable, against loops that are run: just below it they die away, above they grow."""

from __future__ import annotations

import math

import pytest
from format_support import control_of
from long_support import long_but
from loop_support import LIMITS, T

from cnc_ptp.control.control_loop import ControlLoop
from cnc_ptp.control.drives import make_drive
from cnc_ptp.parameters.check.stability import position_loop

CASCADE = ("simulation.model: CASCADED", "getriebe.0.load: 0.6")
SERCOS_TORQUE = (
    "kenngr.antr_typ: 2",
    'antr.sercos.mdt: {"0": {ident_nr: 80, ident_len: 4}}',
    "antr.torque_scale_num: 1000000",
    "antr: {v_reso_num: 1000000, v_reso_denom: 1000}",
    "getriebe.0: {load: 0.6, wegaufz: 100000, wegaufn: 1}",
)
"""Torque commands in a telegram of fine digits."""
LOOPS = {
    "no lag": (),
    "first order": ("simulation.drive_time_constant: 3000",),
    "bus": ("simulation.drive_time_constant: 3000", "simulation.bus_delay_cycles: 2"),
    "cascaded": (*CASCADE, "simulation.drive_time_constant: 2000", "simulation.current_time_constant: 500"),
    "cascaded, bus": (*CASCADE, "simulation.bus_delay_cycles: 3"),
    "position": (
        "antr.operation_mode: DRIVE_POSITION_CONTROL",
        "simulation.drive_time_constant: 3000",
        "simulation.bus_delay_cycles: 2",
    ),
    "lag": ("antr.operation_mode: DSC_POSITION_CONTROL", "simulation.bus_delay_cycles: 1"),
    "torque": ("antr.telegram.commands: [S-0-0080]", "getriebe.0.load: 0.6", "simulation.current_time_constant: 300"),
    "torque, bus": (
        "antr.telegram.commands: [S-0-0080]",
        "getriebe.0.load: 0.6",
        "simulation.inertia: 0.5",
        "simulation.bus_delay_cycles: 1",
        "lr_param.velocity_gain: 150",
    ),
    "torque, PI": (
        "antr.telegram.commands: [S-0-0080]",
        "getriebe.0.load: 0.6",
        "lr_param: {velocity_gain: 400, velocity_integral_time: 20000}",
    ),
    "torque, velocity from positions": (*SERCOS_TORQUE, "lr_param.velocity_gain: 700"),
    "torque, velocity from positions, PI, bus": (
        *SERCOS_TORQUE,
        "lr_param: {velocity_gain: 250, velocity_integral_time: 20000}",
        "simulation.bus_delay_cycles: 1",
    ),
    "torque, velocity in the telegram": (
        *SERCOS_TORQUE,
        'antr.sercos.at: {"0": {ident_nr: 51}, "1": {ident_nr: 40}}',
        "lr_param.velocity_gain: 700",
    ),
}


def size_after(lines: tuple[str, ...], kv: float, cycles: int) -> float:
    """Following error of a loop some time after a step of 1 µm, mm; the largest of its last 100 cycles."""
    control = control_of(*lines, f"getriebe.0.kv: {round(100 * kv)}")
    loop = ControlLoop(control, cycle_time=T, limits=LIMITS, drive=make_drive(control, T))
    errors = [abs(loop.step((0.001, 0.0, 0.0, 0.0), closed=True).following_error) for _ in range(cycles)]
    return max(errors[-100:])


@pytest.mark.parametrize("name", long_but(LOOPS, [*LOOPS][::3]))
def test_the_limit_is_where_loops_begin_to_grow(name: str) -> None:
    lines = (*LOOPS[name], "simulation.encoder: 0")
    loop = position_loop(control_of(*lines), T)
    limit = loop.limit(T)
    assert loop.is_stable(0.98 * limit)
    assert not loop.is_stable(1.02 * limit)
    assert size_after(lines, 0.97 * limit, 4000) < 1e-4
    assert size_after(lines, 1.03 * limit, 4000) > 1e-2


@pytest.mark.parametrize("gain", [50, 300, 1000, 1900])
def test_limits_of_a_proportional_velocity_controller_are_closed_forms(gain: int) -> None:
    """Jury's conditions, c = Kp T: Kv < 2/T with the momentary velocity, Kv < 2/T · (2 - c)/(2 + c) with a differenced.

    z² - z (2 - c - c Kv T/2) + 1 - c + c Kv T/2 and 2 z³ + (c (Kv T + 1) - 4) z² + (2 + c Kv T) z - c.
    """
    c = gain * T
    controller = f"lr_param: {{velocity_gain: {gain}, velocity_integral_time: 0}}"
    lines = ("antr.telegram.commands: [S-0-0080]", "getriebe.0.load: 0.6", controller)
    assert position_loop(control_of(*lines), T).limit(T) == pytest.approx(2.0 / T, rel=1e-9)
    bus = position_loop(control_of("kenngr.antr_typ: 2", *lines), T)
    assert bus.limit(T) == pytest.approx(2.0 / T * (2.0 - c) / (2.0 + c), rel=1e-6)


@pytest.mark.parametrize("name", long_but(LOOPS, [*LOOPS][::3]))
def test_an_unstable_loop_swings_but_its_numbers_stay_numbers(name: str) -> None:
    lines = LOOPS[name]
    limit = position_loop(control_of(*lines), T).limit(T)
    assert math.isfinite(size_after(lines, 3.0 * limit, 6000))
