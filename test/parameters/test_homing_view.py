"""Homing of an axis from its machine file: units, defaults, contradictions."""

from __future__ import annotations

import pytest

from cnc_ptp.parameters import AxisParameters, ParameterError, load_machine

HEAD = "/machine: {ros__parameters: {axes: [x]}}\n/x: {ros__parameters: {"


def axis(parameters: str) -> AxisParameters:
    return load_machine(f"{HEAD}{parameters}}}}}", "m.yaml").axes["x"]


def test_values_in_kernel_units() -> None:
    view = axis(
        "homing_required: 1, kenngr: {ref_richt: 1, fast_from_cam: 1, homing_max_movement_dist: 1230000, "
        "homing: {homing_type: IGNORE_ABS_POS}}, "
        "getriebe: {'0': {pos_refpkt: -5000, vb_reflow: 2000, vb_refmax: 40000}}, "
        "antr: {simu: {rpf_weg_bis_nip: 30000}}, simulation: {cam_position: 12345, cam_length: 20000, "
        "zero_pulse_distance: 0}"
    )
    homing = view.homing
    assert (homing.required, homing.direction, homing.fast_off_cam, homing.kind) == (True, 1.0, True, "IGNORE_ABS_POS")
    assert (homing.range, homing.reference_position, homing.slow, homing.fast) == (123.0, -0.5, 2.0, 40.0)
    assert (homing.to_zero_pulse, homing.cam_position, homing.cam_length) == (3.0, 1.2345, 2.0)
    assert homing.pulse_distance == 0.0


def test_range_without_a_parameter() -> None:
    assert axis("kenngr: {swe_neg: -1000000, swe_pos: 500000}").homing.range == 300.0
    table = "kenngr: {achs_typ: ACHSTYP_ROTATOR, achs_mode: 4}, getriebe: {'0': {moduloo: 3600000, modulou: 0}}"
    assert axis(table).homing.range == 720.0


def test_a_sercos_drive() -> None:
    """What is not given for the drive is that of its axis."""
    drive = "kenngr: {antr_typ: 2, homing: {homing_type: DRIVE_CONTROLLED}}, homing_timeout_ms: 2500, "
    gear = "getriebe: {'0': {window: 200, slope_profil: {a_beschl: 800, tr_beschl_zu: 40000}}}"
    view = axis(drive + gear + ", simulation: {referenced_at_start: 0}")
    sercos = view.control.sercos
    assert sercos is not None and sercos.homing is view.homing and view.homing.timeout == 2.5
    assert (sercos.acceleration, sercos.jerk, sercos.position_window) == (800.0, 20_000.0, 0.02)
    assert (sercos.rotary, sercos.referenced, sercos.parameter_scaling, sercos.fault) == (False, False, False, "NONE")
    own = "simulation: {sercos: {homing_acceleration: 300, homing_jerk: 7000, velocity_scaling: PARAMETER, "
    sercos = axis(f"{drive}{gear}, {own}homing_fault: NO_MARKER}}}}").control.sercos
    assert sercos is not None
    assert (sercos.acceleration, sercos.jerk, sercos.parameter_scaling) == (300.0, 7000.0, True)
    assert (sercos.fault, sercos.referenced) == ("NO_MARKER", True)
    assert axis("kenngr: {antr_typ: 4}").control.sercos is None


def test_an_axis_that_is_not_referenced_counts_from_0() -> None:
    view = axis("simulation: {start_position: 85, referenced_at_start: 0}")
    assert (view.start_position, view.control.plant.start_position) == (0.0, 85.0)
    assert axis("simulation: {start_position: 85}").start_position == 85.0


@pytest.mark.parametrize(
    ("parameters", "text"),
    [
        (
            "kenngr: {ref_ohne_nocken: 1}",
            "P-AXIS-00156 kenngr.ref_ohne_nocken of /x: value 1 needs P-AXIS-00157 kenngr.ref_ohne_rev = 1",
        ),
        (
            "kenngr: {ref_ohne_nocken: 1, ref_ohne_rev: 1, homing_without_zero_pulse: 1}",
            "P-AXIS-00084 kenngr.homing_without_zero_pulse of /x: value 1 leaves homing without a signal, P-AXIS-00156 "
            "kenngr.ref_ohne_nocken is 1",
        ),
        (
            "kenngr: {homing: {homing_type: IGNORE_ABS_POS}}, simulation: {referenced_at_start: 0}",
            "P-AXIS-00299 kenngr.homing.homing_type of /x: IGNORE_ABS_POS needs an axis that is referenced at start, "
            "P-SIM-00005 is 0",
        ),
        (
            "kenngr: {antr_typ: 4, homing: {homing_type: DRIVE_CONTROLLED}}",
            "P-AXIS-00299 kenngr.homing.homing_type of /x: DRIVE_CONTROLLED needs a SERCOS drive, P-AXIS-00020 "
            "kenngr.antr_typ is 4",
        ),
        (
            "kenngr: {antr_typ: 2, homing: {homing_type: DRIVE_CONTROLLED}}, getriebe: {'0': {load: 1}}, "
            "antr: {telegram: {commands: [S-0-0080]}}",
            "P-AXIS-00299 kenngr.homing.homing_type of /x: DRIVE_CONTROLLED needs a drive that takes velocities or "
            "positions, it takes torques",
        ),
    ],
)
def test_contradictions(parameters: str, text: str) -> None:
    with pytest.raises(ParameterError) as caught:
        axis(parameters)
    (problem,) = caught.value.problems
    assert problem.error_id == 25009 and f"axis list, {text}" in str(problem)
