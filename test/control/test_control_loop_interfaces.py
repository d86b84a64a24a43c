"""The same control loop in front of drives that take velocities, positions, lags or torques, closed and open."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from loop_support import (
    ACC,
    ADD_ACC,
    ADD_VEL,
    INERTIA,
    KV,
    NO_FRICTION,
    OFF,
    PLANT,
    VEL,
    MotionState,
    T,
    column,
    control,
    feedforward,
    lags,
    make_loop,
    motion,
    run,
    trapezoid,
)

from cnc_ptp.control.control_loop import ControlLoop
from cnc_ptp.control.drives import Drive, make_drive
from cnc_ptp.control.velocity_controller import VelocityController
from cnc_ptp.parameters.view.control_view import ControlParameters, LagMonitoring

COMMANDED = ("velocity", "position", "lag", "torque")
MECHANICS = replace(PLANT, cascaded=True, coulomb=0.3, static=0.5, stribeck_velocity=2.0, viscous=1e-3)
FRICTIONLESS = replace(PLANT, cascaded=True)
STATES = motion([(10, 0.0), *trapezoid(25_000.0, 60, 20, 150, rest=300)])
END = STATES[-1][0]


def looped(parameters: ControlParameters) -> ControlLoop:
    return make_loop(parameters, make_drive(parameters, T))


def for_interface(interface: str, **changes: Any) -> ControlParameters:
    """A torque interface has its own controller in the NC: P alone, 300/s."""
    changes.setdefault("plant", FRICTIONLESS if interface == "torque" else PLANT)
    return control(interface=interface, **changes)


@pytest.mark.parametrize("mode", [0, VEL, VEL | ACC, ADD_VEL, ADD_VEL | ADD_ACC])
@pytest.mark.parametrize("lead", [0, 3])
def test_velocity_position_and_lag_commands_move_alike(mode: int, lead: int) -> None:
    """A conventional feedforward becomes a shift of v/Kv of position or lag, as XERR of PROFIdrive."""
    of_feedforward = replace(OFF, mode=mode, always_active=True, lead_cycles=lead)
    ways = {}
    for interface in ("velocity", "position", "lag"):
        loop = looped(for_interface(interface, of_feedforward=of_feedforward))
        ways[interface] = column(run(loop, STATES), "actual_position")
    assert np.abs(ways["position"] - ways["velocity"]).max() < 1e-9
    assert np.abs(ways["lag"] - ways["velocity"]).max() < 1e-9
    assert ways["velocity"][-1] == pytest.approx(END, abs=1e-3) and END > 20.0


def test_torque_commands_with_the_velocity_controller_of_the_nc() -> None:
    """The lag at constant velocity is v/Kv behind a P controller too, as long as no friction is in the way."""
    states = motion([(80, 15_625.0), (80, -15_625.0), (1000, 0.0)])
    error = lags(run(looped(for_interface("torque")), states))
    assert error[-1] == pytest.approx(100.0 / KV, abs=1e-6)


@pytest.mark.parametrize("delay", [0.0, 0.0004, 0.002])
def test_torque_commands_with_feedforward(delay: float) -> None:
    """Without torque a/Kp of velocity is missing, a delay adds its own; with the exact inertia nothing is left."""
    states = motion([(80, 25_000.0), (600, 0.0)])
    of_feedforward = feedforward(ADD_VEL, always_active=True, velocity_delay=delay)
    error = lags(run(looped(for_interface("torque", of_feedforward=of_feedforward)), states))
    assert error[-1] == pytest.approx(2000.0 * (1.0 / 300.0 + delay) / KV, abs=1e-6)
    of_feedforward = replace(of_feedforward, mode=ADD_VEL | ADD_ACC)
    error = lags(run(looped(for_interface("torque", of_feedforward=of_feedforward)), states))
    assert error[-1] == pytest.approx(2000.0 * delay / KV, abs=1e-6)


@pytest.mark.parametrize("interface", ["velocity", "torque"])
def test_a_torque_without_scaling_is_not_put_out(interface: str) -> None:
    """110465: the axis moves as if ADD_ACC and friction compensation were not there."""
    friction = replace(NO_FRICTION, permitted=True, active=True, velocities=(0.0,), currents=(0.25,))
    ways = {}
    for scale, mode in ((0.0, ADD_VEL | ADD_ACC), (1.0, ADD_VEL)):
        parameters = for_interface(
            interface,
            plant=FRICTIONLESS,
            of_feedforward=feedforward(mode, always_active=True),
            friction=friction if scale == 0.0 else NO_FRICTION,
            torque_scale=scale,
        )
        cycles = run(looped(parameters), STATES)
        ways[scale] = column(cycles, "actual_position")
        assert set(column(cycles, "additive_torque")) == {0.0}
    assert np.array_equal(ways[0.0], ways[1.0])


def test_an_integral_part_takes_the_friction_over() -> None:
    parameters = for_interface("torque", plant=MECHANICS)
    drive = replace(parameters.drive, velocity_integral_time=0.02)
    states = motion([(80, 15_625.0), (80, -15_625.0), (1500, 0.0)])
    errors = [lags(run(looped(replace(parameters, drive=d)), states))[-1] for d in (parameters.drive, drive)]
    friction = 0.3 + 0.1
    assert errors[0] - 100.0 / KV == pytest.approx(friction / (300.0 * INERTIA) / KV, rel=0.01)
    assert errors[1] == pytest.approx(100.0 / KV, abs=1e-4)


def test_velocity_controller_is_pi() -> None:
    controller = VelocityController(gain=200.0, integral_time=0.01, torque_per_acceleration=INERTIA, cycle_time=T)
    errors = [1.0, 2.0, -0.5, 0.25]
    torques = [controller.torque(error) for error in errors]
    integrals = np.cumsum(errors) * T / 0.01
    assert torques == pytest.approx(200.0 * INERTIA * (np.array(errors) + integrals), rel=1e-12)
    assert controller.brake(3.0) == pytest.approx(-600.0 * INERTIA)
    assert controller.torque(1.0) == pytest.approx(200.0 * INERTIA * 1.1)


def test_a_virtual_axis_is_where_it_is_told_to_be() -> None:
    """No lag to monitor, no output, open or closed."""
    parameters = for_interface(
        "none",
        of_feedforward=feedforward(VEL | ACC, always_active=True),
        monitoring=LagMonitoring(4, 0.001, 0.001, 1000, 0.0),
        plant=replace(PLANT, start_position=5.0),
    )
    loop = looped(parameters)
    assert loop.position == 5.0 and not loop.too_far((0.0, 0.0, 0.0, 0.0))
    for closed in (True, False):
        for state in STATES:
            cycle = loop.step(state, closed)
            assert cycle == (state[0], state[1], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
            assert loop.position == state[0]


# ---------------------------------------------------------------- open

PLANTS = {
    "first order": PLANT,
    "no friction": FRICTIONLESS,
    "friction": MECHANICS,
    "bus and current loop": replace(MECHANICS, bus_delay_cycles=2, current_time_constant=0.0003, velocity_gain=200.0),
    "coarse encoder": replace(PLANT, encoder_increment=0.01),
    "backlash": replace(MECHANICS, backlash=0.02, encoder_increment=0.0001),
}
CASES = [
    (interface, plant) for interface in COMMANDED for plant in PLANTS if PLANTS[plant].cascaded or interface != "torque"
]


def moving_loop(interface: str, plant: str, mode: int = ADD_VEL | ADD_ACC) -> ControlLoop:
    """Half-way in its motion with feedforward, friction compensation and a delay line."""
    friction = replace(
        NO_FRICTION,
        permitted=True,
        active=True,
        velocities=(0.0,),
        currents=(0.25,),
        reversal_lookahead=4,
        delay_cycles=2,
    )
    of_feedforward = feedforward(mode, always_active=True, prefilter_cycles=3)
    loop = looped(for_interface(interface, plant=PLANTS[plant], of_feedforward=of_feedforward, friction=friction))
    run(loop, STATES[:200])
    assert loop.drive.velocity > 100.0
    return loop


@pytest.mark.parametrize(("interface", "plant"), CASES)
def test_an_open_loop_brings_the_drive_to_rest(interface: str, plant: str) -> None:
    """Opened at full velocity, which no axis does: velocity 0 is held, nothing of the past goes out."""
    loop = moving_loop(interface, plant)
    v = loop.drive.velocity
    cycles = run(loop, [STATES[200]] * 600, closed=False)
    assert abs(loop.drive.velocity) < 1e-6
    assert cycles[-1].actual_position == pytest.approx(cycles[-100].actual_position, abs=1e-9)
    distance = cycles[-1].actual_position - cycles[0].actual_position
    assert -0.0001 * v < distance < 0.03 * v
    for name in (
        "command_velocity",
        "feedforward_velocity",
        "additive_velocity",
        "additive_torque",
        "friction_current",
    ):
        assert set(column(cycles, name)) == {0.0}


@pytest.mark.parametrize(("interface", "plant"), CASES)
def test_closed_again_where_it_stands_nothing_moves(interface: str, plant: str) -> None:
    """Power off, placed at the actual position, power on: neither delay line nor feedforward knows the old place."""
    loop = moving_loop(interface, plant)
    run(loop, [STATES[200]] * 600, closed=False)
    place = loop.position
    cycles = run(loop, [(place, 0.0, 0.0, 0.0)] * 300)
    assert set(column(cycles, "command_velocity")) == {0.0}
    assert np.abs(column(cycles, "actual_position") - place).max() <= 1e-9
    assert set(column(cycles, "additive_torque")) == {0.0}


class Pushed(Drive):
    """A drive that somebody moves while nothing holds it."""

    def __init__(self, drive: Drive) -> None:
        super().__init__(has_torque=drive.has_torque)
        self.drive, self.by, self.commands = drive, 0.0, []
        self._take_over()

    def push(self, by: float) -> None:
        self.by = by
        self._take_over()

    def _take_over(self) -> None:
        self.position = self.drive.position + self.by
        self.velocity, self.torque = self.drive.velocity, self.drive.torque

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        self.commands.append((command, additive_velocity, additive_torque))
        self.drive.step(command, additive_velocity, additive_torque)
        self._take_over()


@pytest.mark.parametrize("interface", ["velocity", "lag", "torque"])
@pytest.mark.parametrize("lead", [0, 4])
def test_pushed_away_while_open(interface: str, lead: int) -> None:
    """5 mm away: from the first closed cycle on the loop holds the axis there."""
    of_feedforward = feedforward(ADD_VEL | ADD_ACC, always_active=True, lead_cycles=lead)
    parameters = for_interface(interface, of_feedforward=of_feedforward)
    drive = Pushed(make_drive(parameters, T))
    loop = make_loop(parameters, drive)
    run(loop, STATES)
    run(loop, [STATES[-1]] * 50, closed=False)
    drive.push(5.0)
    run(loop, [STATES[-1]] * 3, closed=False)
    place = loop.position
    assert place == pytest.approx(END + 5.0, abs=0.01)
    cycles = run(loop, [(place, 0.0, 0.0, 0.0)] * 20)
    assert np.abs(column(cycles, "command_velocity")).max() < 1e-9
    assert drive.commands[-20:] == [(pytest.approx(0.0, abs=1e-9), 0.0, 0.0)] * 20


def test_an_open_position_drive_is_told_where_it_is() -> None:
    parameters = for_interface("position")
    drive = Pushed(make_drive(parameters, T))
    loop = make_loop(parameters, drive)
    run(loop, STATES)
    for by in (0.0, 1.0, 7.5):
        drive.push(by)
        place = drive.position
        loop.step(STATES[-1], False)
        assert drive.commands[-1] == (place, 0.0, 0.0)


def test_a_start_in_motion_fills_the_delay_line_with_the_first_setpoint() -> None:
    """Closed on a moving setpoint: the position controller begins at that setpoint and not somewhere in the past."""
    loop = looped(for_interface("velocity", of_feedforward=feedforward(VEL, lead_cycles=4)))
    states: list[MotionState] = [(0.05 * n, 50.0, 0.0, 0.0) for n in range(10)]
    cycles = run(loop, states)
    assert [cycle.command_velocity for cycle in cycles[:5]] == [0.0] * 5
    assert cycles[5].command_velocity == pytest.approx(KV * 0.05)
