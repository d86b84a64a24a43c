"""The view of a spindle: gears, scaling of the manual's examples, feedback, curves, corrected resolutions."""

from __future__ import annotations

import math
from typing import Any

import pytest

from cnc_ptp.parameters import GearParameters, MachineParameters, SpindleParameters, load_machine
from cnc_ptp.parameters.control_view import control_view
from cnc_ptp.parameters.spindle_view import CurveParameters, SpeedScaling

DEFAULT_GEAR: dict[str, Any] = {
    "stage": 1,
    "kv": 10.0,
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
    "following_error_monitoring": False,
    "following_error_limit": 10.0,
    "following_error_standstill_limit": 2.0,
    "position_window": 0.05,
    "encoder_increment": 0.0001,
    "reversed": False,
    "output_gain": 120.0,
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
        open_loop=False,
        feedback="POSITION",
        scaling=SpeedScaling(1, 0.036, 0),
        speed_reached_band=0.1,
        preferred_direction=0,
        velocity_control_on=2_000_000.0,
        velocity_control_off=0.0,
        gear=1,
        gears={1: GearParameters(**DEFAULT_GEAR, control=control)},
        stops_at_reset=True,
        target_time=2.0,
        speed_time=0.0,
        gear_change_time=10.0,
        drive_time_constant=0.0,
        zero_pulse=0.0,
        max_override_percent=100.0,
        powered_at_start=True,
        referenced_at_start=True,
        start_position=0.0,
    )


def test_every_gear_that_the_file_describes_has_a_record() -> None:
    view = spindle("kenngr.getriebe_stufe: 2, getriebe: {0: {kv: 100}, 1: {kv: 300, dynamik.vb_max: 60000000}}")
    assert (view.gear, sorted(view.gears), view.gears[2].kv, view.gears[1].kv) == (2, [1, 2], 3.0, 1.0)
    assert view.max_speed_deg_s == 60_000.0
    assert sorted(spindle("kenngr.getriebe_stufe: 4").gears) == [4]


def test_values_of_a_gear_in_kernel_units() -> None:
    view = gear(
        "getr_schalt_pos: -905000, pos_refpkt: 123456, vb_reflow: 50000, vb_regelgrenze: 12000000, "
        "multi_gain_z: 32767, multi_gain_n: 18, reverse: 1"
    )
    assert (view.change_position, view.reference_position, view.homing_speed) == (-90.5, 12.3456, 50.0)
    assert (view.control_limit, view.reversed) == (12_000.0, True)
    assert view.output_gain * 1000.0 / 60.0 == pytest.approx(32767 / 18)


@pytest.mark.parametrize(
    ("drive", "limit"), [(1, 0.2), (2, math.inf), (3, 0.2), (4, 0.2), (6, 0.2), (7, math.inf), (16, math.inf)]
)
def test_the_control_limit_is_watched_for_analogue_drives(drive: int, limit: float) -> None:
    parameters = "getriebe.0: {vb_regelgrenze: 200, vb_reflow: 100}"
    assert spindle(f"kenngr.antr_typ: {drive}, {parameters}").gears[1].control_limit == limit


def test_a_control_limit_of_0_is_none() -> None:
    assert gear("vb_regelgrenze: 0").control_limit == math.inf


@pytest.mark.parametrize(("restricted", "positive", "direction"), [(0, 0, 0), (0, 1, 0), (1, 0, -1), (1, 1, 1)])
def test_preferred_direction(restricted: int, positive: int, direction: int) -> None:
    assert spindle(f"kenngr: {{vorz_richtung: {restricted}, beweg_richt: {positive}}}").preferred_direction == direction


@pytest.mark.parametrize(("kind", "on"), [(0, False), (1, True), (2, True), (3, False), (4, True), (5, False)])
def test_following_error_monitoring(kind: int, on: bool) -> None:
    assert gear(f"slep_ueberw_typ: {kind}").following_error_monitoring is on


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
def test_the_ways_to_acknowledge_a_speed(mode: str, telegram: str, open_loop: bool, feedback: str) -> None:
    view = spindle(
        f"antr.operation_mode: {mode}, simulation.telegram: {telegram}, getriebe.0: {{wegaufz: 1, wegaufn: 1}}"
    )
    assert (view.open_loop, view.feedback, view.has_position) == (open_loop, feedback, feedback == "POSITION")
    assert view.referenced_at_start is (feedback == "POSITION")


def test_scaling_examples_of_the_manual_to_the_digit() -> None:
    """Page 17: 32767 increments are 3000 rpm; page 18: 1 increment is 1 rpm."""
    sensorless = spindle("antr: {v_time_base: 0, v_reso_num: 32767, v_reso_denom: 1080000000}").scaling
    assert round(3000.0 * 6.0 * sensorless.per_deg_s(0.001)) == 32767
    with_speed = spindle("antr: {v_time_base: 0, v_reso_num: 1, v_reso_denom: 360000}").scaling
    assert [round(rpm * 6.0 * with_speed.per_deg_s(0.001), 9) for rpm in (1.0, 750.0)] == [1.0, 750.0]


def test_time_bases_of_the_scaling() -> None:
    assert SpeedScaling(10, 0.5, 1).per_deg_s(0.002) == 20.0
    assert SpeedScaling(10, 0.5, 2).per_deg_s(0.002) == pytest.approx(0.04)


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
    assert found.spindles["s"].gears[1].encoder_increment == 0.0001
    assert found.warnings == (
        "m.yaml:2:46: P-AXIS-00234 getriebe[0].wegaufz of /s: P-WARN-110386 value 0 is corrected to 1",
        "m.yaml:2:58: P-AXIS-00233 getriebe[0].wegaufn of /s: P-WARN-110086 value 0 is corrected to 1",
    )
