"""Modulo compensation with an encoder whose turn is some increments too short."""

from __future__ import annotations

import math
import random

import pytest
from loop_support import PLANT, T, control, make_loop, motion, trapezoid

from cnc_ptp.control.drives import Drive, FirstOrderDrive, PositionCommandedDrive
from cnc_ptp.control.modulo_compensation import ModuloCompensation
from cnc_ptp.parameters import load_machine
from cnc_ptp.parameters.view.control_view import ModuloError

INCREMENT = 0.01
"""deg"""


class ShortTurns(Drive):
    """A drive whose encoder shows whole increments, `missing` fewer a turn than 360°/increment."""

    def __init__(self, *, missing: float, start: float = 0.0, kv: float | None = None) -> None:
        ideal = FirstOrderDrive(cycle_time=T, time_constant=0.003, encoder_increment=0.0, start_position=0.0)
        self.drive = ideal if kv is None else PositionCommandedDrive(ideal, kv=kv)
        self.motor, self.missing, self.start = ideal, missing, start
        super().__init__()
        self._take_over()

    def _take_over(self) -> None:
        self.position, self.velocity = self.shown(self.true_position), self.motor.velocity

    @property
    def true_position(self) -> float:
        return self.motor.position

    def shown(self, position: float) -> float:
        share = (360.0 - self.missing * INCREMENT) / 360.0
        return self.start + round(position * share / INCREMENT) * INCREMENT

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        if isinstance(self.drive, PositionCommandedDrive):  # its position loop closes over the same encoder
            command += self.true_position - self.position
        self.drive.step(command, additive_velocity, additive_torque)
        self._take_over()


def correction(missing: float, origin: float = 0.0) -> ModuloCompensation:
    return ModuloCompensation(ModuloError(360.0, INCREMENT, missing), origin=origin)


@pytest.mark.parametrize("missing", [0.25, 1.0, 7.0, -3.0])
def test_what_the_encoder_is_short_of_comes_back(missing: float) -> None:
    """Over thousands of turns both ways the corrected position stays within an increment or so of the true one."""
    encoder, draw = ShortTurns(missing=missing), random.Random(2)
    compensation = correction(missing)
    for _ in range(2000):
        true = draw.choice([1.0, 10.0, 1000.0, 20_000.0]) * draw.uniform(-360.0, 360.0)
        shown = encoder.shown(true)
        assert abs(shown + compensation.correction(shown) - true) <= 1.51 * INCREMENT
    if abs(missing) >= 1.0:
        shown = encoder.shown(3_600_000.0)
        assert abs(shown - 3_600_000.0) > 0.9 * 10_000 * INCREMENT


def test_only_whole_increments_are_added() -> None:
    compensation = correction(2.0)
    steps = [compensation.correction(float(n)) / INCREMENT for n in range(-800, 801)]
    assert all(step == pytest.approx(round(step), abs=1e-9) for step in steps)
    assert steps[800] == 0.0 and sorted(steps) == steps
    assert [round(steps[800 + turn]) for turn in (-720, -360, 360, 720)] == [-4, -2, 2, 4]


def test_without_parameters_there_is_nothing() -> None:
    compensation = ModuloCompensation(ModuloError(0.0, 0.0, 0.0), origin=5.0)
    assert not compensation.on and compensation.correction(1e6) == 0.0


@pytest.mark.parametrize("start", [0.0, 5000.0, -123.4])
def test_at_its_start_an_axis_is_where_the_encoder_shows(start: float) -> None:
    """What is missing counts from there, whatever the encoder shows."""
    parameters = control(modulo_error=ModuloError(360.0, INCREMENT, 5.0))
    loop = make_loop(parameters, ShortTurns(missing=5.0, start=round(start / INCREMENT) * INCREMENT))
    assert loop.position == pytest.approx(start, abs=1e-9)


@pytest.mark.parametrize("interface", ["velocity", "position"])
@pytest.mark.parametrize("compensated", [True, False])
def test_an_axis_stays_on_its_turns(interface: str, compensated: bool) -> None:
    """36 turns and back to 0 with 5 increments missing a turn: 1.8° off without the compensation."""
    drive = ShortTurns(missing=5.0, kv=50.0 if interface == "position" else None)
    error = ModuloError(360.0, INCREMENT, 5.0) if compensated else None
    loop = make_loop(control(interface=interface, modulo_error=error, plant=PLANT), drive)
    forth = motion(trapezoid(90_000.0, 400, 0, 100, rest=600))
    assert forth[-1][0] == pytest.approx(36 * 360.0)
    for state in forth:
        loop.step(state, True)
    off = drive.true_position - forth[-1][0]
    expected = 0.0 if compensated else forth[-1][0] * 5.0 * INCREMENT / 360.0
    assert off == pytest.approx(expected, abs=2 * INCREMENT)
    for state in motion(trapezoid(90_000.0, 400, 0, 100, rest=600, sign=-1.0), start=forth[-1][0]):
        loop.step(state, True)
    assert drive.true_position == pytest.approx(0.0, abs=2 * INCREMENT)


AXIS = """
/machine: {ros__parameters: {axes: [c]}}
/c:
  ros__parameters:
    kenngr: {achs_typ: ACHSTYP_ROTATOR, antr_typ: 4}
    lr_param: {mod_komp: 1}
    getriebe: {"0": {modulo_fehler: 7, modulo_umdreh: 2}}
"""


def test_parameters_of_the_compensation() -> None:
    """P-AXIS-00124 = 7 increments in P-AXIS-00125 = 2 turns; off with P-AXIS-00120 = 0 or without turns."""
    error = load_machine(AXIS, "m.yaml").axes["c"].control.modulo_error
    assert (error.turn, error.increments_per_turn) == (360.0, 3.5)
    assert math.isclose(error.increment, 0.0001)
    for change in (("mod_komp: 1", "mod_komp: 0"), ("modulo_umdreh: 2", "modulo_umdreh: 0")):
        off = load_machine(AXIS.replace(*change), "m.yaml").axes["c"].control.modulo_error
        assert not ModuloCompensation(off, origin=0.0).on
