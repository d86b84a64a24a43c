"""The view of a spindle: gears, scaling of the manual's examples, feedback, curves, corrected resolutions."""

from __future__ import annotations

import math
from typing import Any

import pytest

from cnc_ptp.control.drive_format import shown_velocity
from cnc_ptp.parameters import GearParameters, MachineParameters, SpindleParameters, load_machine
from cnc_ptp.parameters.view.control_view import control_view
from cnc_ptp.parameters.view.spindle_view import CurveParameters

DEFAULT_GEAR: dict[str, Any] = {
    "stage": 1,
    "max_speed": 200.0,
    "positioning_speed": 166.666,
    "max_acceleration": 1000.0,
    "acceleration": 1000.0,
    "deceleration": 1000.0,
    "emergency_deceleration": 1000.0,
    "curve": None,
    "zero_speed": 0.1,
    "control_limit": 200.0,
    "change_position": 0.0,
    "reference_position": 0.0,
    "homing_speed": 16.666,
    "modulo_low": 0.0,
    "modulo_high": 360.0,
    "position_window": 0.05,
}


def machine(parameters: str) -> MachineParameters:
    text = f"/machine: {{ros__parameters: {{spindles: [s]}}}}\n/s: {{ros__parameters: {{{parameters}}}}}"
    return load_machine(text, "m.yaml")


def spindle(parameters: str = "") -> SpindleParameters:
    return machine(parameters).spindles["s"]


def gear(parameters: str) -> GearParameters:
    return spindle(f"getriebe.0: {{{parameters}}}").gears[1]


def test_a_spindle_of_defaults() -> None:
    control = control_view(machine("").raw("s"), 0, 0.001)
    assert spindle() == SpindleParameters(
        name="s",
        number=1,
        drive_type=4,
        plc_controlled=False,
        automatic_homing=True,
        path_gear=0,
        open_loop=False,
        feedback="POSITION",
        speed_reached_band=0.1,
        preferred_direction=0,
        velocity_control_on=2_000_000.0,
        velocity_control_off=0.0,
        gear=1,
        gears={1: GearParameters(**DEFAULT_GEAR, control=control)},
        stops_at_reset=True,
        target_time=2.0,
        settling_time=0.02,
        speed_time=5.0,
        gear_change_time=10.0,
        zero_pulse=0.0,
        max_override_percent=100.0,
        powered_at_start=True,
        referenced_at_start=True,
        start_position=0.0,
    )


def test_every_gear_that_the_file_describes_has_a_record() -> None:
    view = spindle("kenngr.getriebe_stufe: 2, getriebe: {0: {kv: 100}, 1: {kv: 300, dynamik.vb_max: 60000000}}")
    assert (view.gear, sorted(view.gears)) == (2, [1, 2])
    assert (view.gears[2].control.kv, view.gears[1].control.kv) == (3.0, 1.0)
    assert max(gear.max_speed for gear in view.gears.values()) == 60_000.0
    assert sorted(spindle("kenngr.getriebe_stufe: 4, getriebe.3.kv: 100").gears) == [4]


def test_values_of_a_gear_in_kernel_units() -> None:
    view = gear(
        "getr_schalt_pos: -905000, pos_refpkt: 123456, vb_reflow: 50000, vb_regelgrenze: 12000000, "
        "multi_gain_z: 32767, multi_gain_n: 18, reverse: 1"
    )
    assert (view.change_position, view.reference_position, view.homing_speed) == (-90.5, 12.3456, 50.0)
    assert (view.control_limit, view.control.drive.reverse) == (12_000.0, True)
    assert view.control.scaling.analogue * 1000.0 / 60.0 == pytest.approx(32767 / 18)


@pytest.mark.parametrize(
    ("drive", "limit"), [(1, 0.2), (2, math.inf), (3, 0.2), (4, 0.2), (6, 0.2), (7, math.inf), (16, math.inf)]
)
def test_the_control_limit_is_monitored_for_analogue_drives(drive: int, limit: float) -> None:
    parameters = "getriebe.0: {vb_regelgrenze: 200, vb_reflow: 100}"
    assert spindle(f"kenngr.antr_typ: {drive}, {parameters}").gears[1].control_limit == limit


def test_a_control_limit_of_0_means_none() -> None:
    assert gear("vb_regelgrenze: 0").control_limit == math.inf


@pytest.mark.parametrize(("restricted", "positive", "direction"), [(0, 0, 0), (0, 1, 0), (1, 0, -1), (1, 1, 1)])
def test_preferred_direction(restricted: int, positive: int, direction: int) -> None:
    assert spindle(f"kenngr: {{vorz_richtung: {restricted}, beweg_richt: {positive}}}").preferred_direction == direction


def test_modes_of_operation() -> None:
    view = spindle("kenngr.achs_mode: 0x40104")
    assert (view.plc_controlled, view.automatic_homing) == (True, False)


@pytest.mark.parametrize(
    ("mode", "telegram", "open_loop", "feedback"),
    [
        ("CNC_POSITION_CONTROL", "POSITION", False, "POSITION"),
        ("OPEN_POSITION_LOOP_MODE", "POSITION", True, "POSITION"),
        ("OPEN_POSITION_LOOP_MODE", "SPEED", True, "SPEED"),
        ("OPEN_POSITION_LOOP_MODE", "NONE", True, "NONE"),
        ("OPEN_POSITION_LOOP_VEL_FEEDBACK", "POSITION", True, "SPEED"),
        ("OPEN_POSITION_LOOP_NO_FEEDBACK", "POSITION", True, "NONE"),
    ],
)
def test_feedback_that_acknowledges_a_speed(mode: str, telegram: str, open_loop: bool, feedback: str) -> None:
    view = spindle(
        f"antr.operation_mode: {mode}, simulation.telegram: {telegram}, getriebe.0: {{wegaufz: 1, wegaufn: 1}}"
    )
    assert (view.open_loop, view.feedback, view.has_position) == (open_loop, feedback, feedback == "POSITION")
    assert view.referenced_at_start is (feedback == "POSITION")


@pytest.mark.parametrize("mode", ["POS", "VEL", "NO"])
@pytest.mark.parametrize(
    ("scaling", "rpm", "digits"),
    [
        ("v_time_base: 0, v_reso_num: 32767, v_reso_denom: 1080000000", 3000.0, 32767),
        ("v_time_base: 0, v_reso_num: 1, v_reso_denom: 360000", 750.0, 750),
        ("v_time_base: 1, v_reso_num: 10, v_reso_denom: 500", 1.0, 120),
        ("v_time_base: 2, v_reso_num: 10, v_reso_denom: 6", 1.0, 10),
    ],
)
def test_scaling_of_the_open_loop(mode: str, scaling: str, rpm: float, digits: int) -> None:
    """Page 17: 32767 digits are 3000 rpm; page 18: 1 digit is 1 rpm; 10 digits are 0.5° a second, 0.006° a cycle."""
    drive = f"antr: {{operation_mode: OPEN_POSITION_LOOP_{mode}_FEEDBACK, {scaling}}}"
    control = spindle(f"{drive}, getriebe.0: {{wegaufz: 1, wegaufn: 1}}").gears[1].control
    assert shown_velocity(control.scaling, control.drive).encode(rpm * 6.0) == digits


def test_digits_of_the_closed_loop() -> None:
    """A real drive shows the word of its telegram, a simulated one that of a DA converter; a reversed one the sign."""
    of_telegram = "antr: {v_time_base: 0, v_reso_num: 1, v_reso_denom: 360000}"
    for drive, digits in (
        ("kenngr.antr_typ: 2", 500),
        ("kenngr.antr_typ: 1", 360_000),
        ("kenngr.antr_typ: 4", 360_000),
    ):
        control = spindle(f"{drive}, {of_telegram}, getriebe.0: {{reverse: 1, vb_regelgrenze: 0}}").gears[1].control
        shown = shown_velocity(control.scaling, control.drive)
        assert shown.encode(500.0 * 6.0) == max(-(1 << shown.bits - 1), -digits)


def test_curves() -> None:
    text = "n_grenz: 12000000, a_konst: 16000, a_min: 1400, b1: 2.285714E+4, b2: 4.166666E-1, b3: 2.857142E-2"
    limits = "dynamik: {vb_max: 48000000, a_max: 20000}"
    assert gear(f"{limits}, beschl_kennlinie: {{typ: 1, {text}}}").curve == CurveParameters(
        "hyperbola", 1400.0, 12_000.0, 16_000.0, 2.285714e4, 4.166666e-1, 2.857142e-2, 0.0, 0.0, 0.0
    )
    drive = "typ: 3, a_max: 16000, a_min: 4000, n1: 10000000, n2: 20000000"
    curve = gear(f"{limits}, beschl_kennlinie: {{{drive}}}").curve
    assert curve is not None and curve[:2] == ("asynchronous", 4000.0) and curve[-3:] == (16_000.0, 10_000.0, 20_000.0)
    assert gear("beschl_kennlinie.typ: 0").curve is None


def test_a_resolution_of_0_is_corrected_with_the_warnings_of_the_manual() -> None:
    """Page 73: 110386 and, as it is printed, 110086."""
    found = machine("getriebe.0: {wegaufz: 0, wegaufn: 0}")
    assert found.spindles["s"].gears[1].control.plant.encoder_increment == 0.0001
    assert tuple(map(str, found.warnings)) == (
        "m.yaml:2:46: P-AXIS-00234 getriebe[0].wegaufz of /s: value 0 is corrected to 1",
        "m.yaml:2:58: P-AXIS-00233 getriebe[0].wegaufn of /s: value 0 is corrected to 1",
    )
