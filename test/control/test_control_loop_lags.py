"""Following errors of the control loop against closed forms of the sampled loop."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from loop_support import (
    ACC,
    ADD_ACC,
    ADD_VEL,
    KV,
    PLANT,
    TA,
    VEL,
    T,
    control,
    feedforward,
    first_order,
    lags,
    loop_with,
    make_loop,
    motion,
    run,
    trapezoid,
)

from cnc_ptp.control.control_loop import ControlLoop
from cnc_ptp.control.drives import CascadedDrive

A = 2000.0
J = 25_000.0


def steady(setpoints: list[tuple[int, float]], last: int) -> slice:
    """The last cycles of a phase list, when what came before has died away."""
    cycles = sum(count for count, _ in setpoints)
    return slice(cycles - last, cycles)


def matched(mode: int, time_constant: float) -> ControlLoop:
    """A feedforward that knows the time constant of its drive."""
    parameters = control(of_feedforward=feedforward(mode, always_active=True, time_constant=time_constant))
    return make_loop(parameters, first_order(time_constant))


def to_velocity(v: float) -> list[tuple[int, float]]:
    """Two jerk phases to `v` = 0.08² · jerk, then 1 s at constant velocity."""
    jerk = v / 0.0064
    return [(80, jerk), (80, -jerk), (1000, 0.0)]


@pytest.mark.parametrize("time_constant", [0.0, 0.0007, 0.003, 0.009])
@pytest.mark.parametrize("v", [0.5, 33.3, -480.0])
def test_constant_velocity_lags_by_v_over_kv(time_constant: float, v: float) -> None:
    phases = to_velocity(v)
    error = lags(run(loop_with(0, time_constant=time_constant), motion(phases)))
    assert np.abs(error[steady(phases, 50)] - v / KV).max() < 1e-6


@pytest.mark.parametrize("time_constant", [0.0, 0.0007, 0.003, 0.009])
def test_with_velocity_feedforward_constant_acceleration_lags_by_a_ta_over_kv(time_constant: float) -> None:
    phases = [(80, J), (1000, 0.0)]
    error = lags(run(loop_with(VEL, time_constant=time_constant), motion(phases)))
    assert np.abs(error[steady(phases, 50)] - A * time_constant / KV).max() < 1e-6


def test_without_feedforward_constant_acceleration_adds_its_lag_to_that_of_the_mean_velocity() -> None:
    """The command is held over a cycle: v at its middle counts; before the settled state the lag grows with a/Kv."""
    phases = [(80, J), (1000, 0.0)]
    states = motion(phases)
    error = lags(run(loop_with(0), states))
    settled = states[-50:]
    expected = [(v + A * T / 2) / KV + A * TA / KV - A / KV**2 for _, v, _, _ in settled]
    assert np.abs(error[-50:] - expected).max() < 1e-6


@pytest.mark.parametrize("mode", [VEL | ACC, ADD_VEL | ADD_ACC])
@pytest.mark.parametrize("time_constant", [0.0007, 0.003, 0.009])
def test_velocity_and_acceleration_feedforward_leave_nothing(mode: int, time_constant: float) -> None:
    """At constant velocity and constant acceleration, once the phases of jerk before them have died away."""
    phases = [(80, J), (600, 0.0), (80, -J), (600, 0.0)]
    error = lags(run(matched(mode, time_constant), motion(phases)))
    assert np.abs(error[480:680]).max() < 1e-6
    assert np.abs(error[-100:]).max() < 1e-6


@pytest.mark.parametrize("time_constant", [0.0007, 0.003, 0.009])
@pytest.mark.parametrize("j", [50_000.0, -12_500.0])
def test_constant_jerk_leaves_the_part_that_changes_within_a_cycle(time_constant: float, j: float) -> None:
    """-Ta·j·(T/(1 - e^(-T/Ta)) - Ta - T/2)/Kv, about -j·T²/(12 Kv): the axis is ahead by what holding a command costs.

    From V(n+1) = u + (V(n) - u)·e^(-T/Ta) and its integral, with a following error that no longer changes.
    """
    error = lags(run(matched(VEL | ACC, time_constant), motion([(1200, j)])))
    held = T / (1.0 - math.exp(-T / time_constant))
    closed_form = -time_constant * j * (held - time_constant - T / 2.0) / KV
    assert np.abs(error[-50:] - closed_form).max() < 1e-9
    assert closed_form == pytest.approx(-j * T * T / (12.0 * KV), rel=(T / time_constant) ** 2 / 50.0)


def test_a_motion_of_seven_phases_stays_within_a_tenth_of_a_micrometre_with_feedforward() -> None:
    """400 mm/s, 2000 mm/s², 25 m/s³: without feedforward 8 mm, with it the residual of the jerk phases and no more."""
    states = motion(trapezoid(J, 80, 120, 400))
    without, with_it = (np.abs(lags(run(loop_with(mode), states))).max() for mode in (0, VEL | ACC))
    assert without == pytest.approx(400.0 / KV, rel=0.02)
    assert with_it < 1e-4 and without > 50_000 * with_it


@pytest.mark.parametrize("gain", [200.0, 500.0])
@pytest.mark.parametrize("current_time_constant", [0.0, 0.0003])
@pytest.mark.parametrize("v_integral_time", [0.0, 0.004])
def test_additive_torque_with_the_exact_inertia_on_a_cascaded_drive(
    gain: float, current_time_constant: float, v_integral_time: float
) -> None:
    """A P controller in the drive leaves a/(Kp·Kv) to the position controller; the torque takes that away."""
    plant = replace(
        PLANT,
        cascaded=True,
        velocity_gain=gain,
        velocity_integral_time=v_integral_time,
        current_time_constant=current_time_constant,
    )
    left = A / gain / KV if v_integral_time == 0.0 else 0.0
    for mode, expected in ((ADD_VEL, left), (ADD_VEL | ADD_ACC, 0.0)):
        parameters = control(plant=plant, of_feedforward=feedforward(mode, always_active=True))
        loop = make_loop(parameters, CascadedDrive(plant, cycle_time=T))
        error = lags(run(loop, motion([(80, J), (600, 0.0), (80, -J), (600, 0.0)])))
        assert error[679] == pytest.approx(expected, abs=1e-9)
        assert error[-1] == pytest.approx(0.0, abs=1e-9)


def test_nothing_is_left_at_standstill() -> None:
    states = motion(trapezoid(J, 80, 120, 400, rest=1500))
    for mode in (0, VEL, VEL | ACC, ADD_VEL | ADD_ACC):
        cycles = run(loop_with(mode), states)
        assert abs(cycles[-1].following_error) < 1e-9
        assert cycles[-1].feedforward_velocity == cycles[-1].additive_velocity == cycles[-1].additive_torque == 0.0
