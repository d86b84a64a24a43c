"""Typed views: conversions to the digit, defaults, members of channels."""

import math
import pickle

import pytest

from cnc_ptp.parameters import (
    AxisParameters,
    ChannelParameters,
    ChannelSpindle,
    MachineParameters,
    ParameterError,
    Synchronisation,
    load_machine,
)
from cnc_ptp.parameters.list_units import to_kernel
from cnc_ptp.parameters.view.encoder import resolution
from cnc_ptp.parameters.view.homing_view import HomingParameters
from cnc_ptp.parameters.view.probe_view import ProbeParameters

NONE = Synchronisation.NO_SYNCH


def load(*sections: str, **units: list[str]) -> MachineParameters:
    """A machine of the units, with the sections."""
    lists = ", ".join(f"{kind}: [{', '.join(names)}]" for kind, names in units.items())
    return load_machine("\n".join([f"/machine: {{ros__parameters: {{{lists}}}}}", *sections]), "m.yaml")


def axis(parameters: str) -> AxisParameters:
    return load(f"/x: {{ros__parameters: {{{parameters}}}}}", axes=["x"]).axes["x"]


def channel(*parameters: str) -> ChannelParameters:
    """The channel of a machine with axes x (1), y (2), c (3) and spindles s (4), t (5)."""
    section = "/ch: {ros__parameters: {" + ", ".join(parameters) + "}}"
    c = "/c: {ros__parameters: {kenngr.achs_typ: ACHSTYP_ROTATOR}}"
    t = "/t: {ros__parameters: {kopf.log_achs_name: S2}}"
    return load(section, c, t, channels=["ch"], axes=["x", "y", "c"], spindles=["s", "t"]).channels["ch"]


@pytest.mark.parametrize(
    ("value", "unit", "kernel"),
    [
        (3_000_000, "0.1 µm", 300.0),
        (1, "0.1 µm", 0.0001),
        (3_600_000, "0.0001°", 360.0),
        (166_666, "µm/s", 166.666),
        (72_000_000, "0.001°/s", 72_000.0),
        (100, "0.001°/s", 0.1),
        (4_500, "0.01/s", 45.0),
        (50, "0.1 %", 0.05),
        (3_000, "µs", 0.003),
        (200, "ms", 0.2),
        (1_000, "mm/s²", 1_000.0),
        (-7, "°", -7.0),
    ],
)
def test_units(value: int, unit: str, kernel: float) -> None:
    assert to_kernel(value, unit) == kernel


def test_machine_of_defaults() -> None:
    machine = load("/x:", axes=["x"])
    assert (machine.cycle_time_us, machine.block_cycles, machine.watchdog_ms, machine.life_sign_timeout_ms) == (
        1000,
        10,
        200,
        1000,
    )
    assert (machine.channels, machine.spindles, machine.warnings) == ({}, {}, ())
    assert machine.axes["x"] == AxisParameters(
        name="x",
        number=1,
        rotary=False,
        modulo=False,
        facing=False,
        diameter_absolute=False,
        diameter_relative=False,
        modulo_low=0.0,
        modulo_high=0.0,
        virtual=False,
        max_velocity=200.0,
        rapid_velocity=166.666,
        reference_velocity=200.0,
        max_acceleration=1000.0,
        acceleration=1000.0,
        deceleration=1000.0,
        emergency_deceleration=1000.0,
        jerk=20_000.0,
        soft_limit_negative=-10_000.0,
        soft_limit_positive=10_000.0,
        position_window=0.05,
        encoder_increment=0.0001,
        override_type=1,
        override_steps=0,
        override_interval=0.15,
        external_dead_time=0.0,
        external_timeout=0.2,
        target_time=2.0,
        error_propagation_delayed=False,
        error_propagation_delay=0.0,
        couple_to_actual=False,
        velocity_window=1.0,
        velocity_filter_time=0.01,
        max_override_percent=100.0,
        powered_at_start=True,
        referenced_at_start=True,
        start_position=0.0,
        homing=HomingParameters(
            kind="CNC_CONTROLLED",
            required=False,
            reference_position=0.0,
            direction=-1.0,
            without_cam=False,
            without_reversing=False,
            without_zero_pulse=False,
            fast_off_cam=False,
            fast=83.333,
            slow=16.666,
            range=40_000.0,
            timeout=120.0,
            cam_position=0.0,
            cam_length=0.0,
            to_zero_pulse=0.001,
            pulse_distance=10.0,
        ),
        probe=ProbeParameters(measures=False, stroke=0.0, below=-214748.3648, above=214748.3647),
        control=machine.axes["x"].control,
    )


def test_axes_of_a_channel_are_equally_late() -> None:
    """P-COMP-00044 of x, P-AXIS-00165 of y (a PROFIdrive with feedforward): the larger one for both; q is none of it."""
    path = "'0': {log_achs_nr: 1}, '1': {log_achs_nr: 2}"
    sections = (
        f"/ch: {{ros__parameters: {{gruppe: {{'0': {{achs_anzahl: 2, achse: {{{path}}}}}}}}}}}",
        "/x: {ros__parameters: {kopf: {achs_nr: 1}, lr_param: {frict_comp: 1}, frict_comp: {reversal_lookahead: 2}}}",
        "/y: {ros__parameters: {kopf: {achs_nr: 2}, kenngr: {antr_typ: 3}, vorsteuer: {vorsteuerung: VEL, "
        "shift_time: 3}}}",
        "/q: {ros__parameters: {kopf: {achs_nr: 3}}}",
    )
    axes = load(*sections, channels=["ch"], axes=["x", "y", "q"]).axes
    assert {name: view.control.delay_cycles for name, view in axes.items()} == {"x": 3, "y": 3, "q": 0}
    alone = load(*sections[1:], axes=["x", "y", "q"]).axes
    assert {name: view.control.delay_cycles for name, view in alone.items()} == {"x": 2, "y": 3, "q": 0}


def test_resolution_of_the_feedforward_manual() -> None:
    """Page 20: 2^20 increments, gear 3, 5 mm a revolution: 62.91456 increments per 0.1 µm."""
    text = "antr.feed_const_num: 50000, getriebe.0: {incr_per_rev: 1048576, gear_fact_num: 3, gear_fact_denom: 1}"
    machine = load(f"/x: {{ros__parameters: {{{text}}}}}", axes=["x"])
    assert float(resolution(machine.raw("x"), 0)) == 62.91456
    assert machine.axes["x"].encoder_increment == 0.0001 / 62.91456


def test_resolution_by_increments_per_distance() -> None:
    assert axis("getriebe.0: {wegaufz: 2, wegaufn: 5}").encoder_increment == 0.00025
    assert axis("getriebe.0: {wegaufz: 2, wegaufn: 5}, simulation.encoder: 0").encoder_increment == 0.0


def test_jerk_is_acceleration_over_ramp_time() -> None:
    view = axis(
        "getriebe.0: {dynamik: {a_max: 5000}, slope_profil: {a_beschl: 2000, a_brems: 2400, tr_beschl_zu: 40000}}"
    )
    assert (view.acceleration, view.deceleration, view.jerk, view.max_acceleration) == (
        2000.0,
        2400.0,
        50_000.0,
        5000.0,
    )


def test_defaults_give_way_to_the_limits_of_the_file() -> None:
    view = axis("getriebe.0.dynamik: {vb_max: 100000, a_max: 500, tr_min: 60000}")
    assert (view.rapid_velocity, view.acceleration, view.deceleration) == (100.0, 500.0, 500.0)
    assert view.jerk == 500 / 0.06


def test_emergency_deceleration() -> None:
    assert axis("getriebe.0.dynamik: {a_max: 500, a_emergency: 1000}").emergency_deceleration == 1000.0


def test_reference_velocity() -> None:
    assert axis("ptp.reference_velocity: 150").reference_velocity == 150.0


@pytest.mark.parametrize(("kind", "on"), [(0, False), (1, True), (2, True), (3, False), (4, True), (5, False)])
def test_following_error_monitoring(kind: int, on: bool) -> None:
    assert axis(f"getriebe.0: {{slep_ueberw_typ: {kind}, slep_max: 250000}}").control.monitoring.kind == kind


def test_rotary_axis_with_and_without_modulo() -> None:
    limited = axis("kenngr: {achs_typ: 0x2, swe_neg: -900000, swe_pos: 900000}")
    assert (limited.rotary, limited.modulo, limited.soft_limit_negative, limited.soft_limit_positive) == (
        True,
        False,
        -90.0,
        90.0,
    )
    endless = axis(
        "kenngr: {achs_typ: ACHSTYP_ROTATOR, achs_mode: 0x204}, getriebe.0: {modulou: -1800000, moduloo: 1800000}"
    )
    assert (endless.modulo, endless.modulo_low, endless.modulo_high) == (True, -180.0, 180.0)
    assert (endless.soft_limit_negative, endless.soft_limit_positive) == (-math.inf, math.inf)


def test_linear_axis_with_modulo() -> None:
    """A conveyor: 0x4 counts for it too, its range is in 0.1 µm; it has no soft limits."""
    view = axis("kenngr.achs_mode: 0x4, getriebe.0: {modulou: -1000000, moduloo: 2500000}")
    assert (view.rotary, view.modulo, view.modulo_low, view.modulo_high) == (False, True, -100.0, 250.0)
    assert (view.soft_limit_negative, view.soft_limit_positive) == (-math.inf, math.inf)
    assert not axis("getriebe.0: {moduloo: 2500000}").modulo


@pytest.mark.parametrize(
    ("parameters", "texts"),
    [
        ("kenngr.achs_mode: 0x4", ["not given, the modulo range of the axis ends at 360 mm"]),
        (
            "kenngr.achs_mode: 0x400, getriebe.0.modulou: -5000",
            ["not given, the modulo range of the axis ends at 360 mm"],
        ),
        ("kenngr.achs_mode: 0x400, getriebe.0.moduloo: 5000000", []),
        ("kenngr.achs_mode: 0x1", []),
        ("kenngr: {achs_mode: 0x4, achs_typ: ACHSTYP_ROTATOR}", []),
    ],
)
def test_notice_of_a_conveyor_without_a_range(parameters: str, texts: list[str]) -> None:
    warnings = load(f"/x: {{ros__parameters: {{{parameters}}}}}", axes=["x"]).warnings
    assert [notice.text for notice in warnings if "P-AXIS-00126" in notice.parameter] == texts


@pytest.mark.parametrize("mode", ["0x1", "0x404"])
def test_a_turntable_may_have_soft_limits_without_effect(mode: str) -> None:
    """Only a linear axis gets a notice: everybody knows that a turntable is endless."""
    axis(f"kenngr: {{achs_typ: ACHSTYP_ROTATOR, achs_mode: {mode}, swe_neg: -10, swe_pos: 10}}")


def test_logical_numbers_that_the_file_leaves_out() -> None:
    section = "/y: {ros__parameters: {kopf.achs_nr: 1}}"
    machine = load(section, axes=["x", "y"], spindles=["s"])
    assert (machine.axes["x"].number, machine.axes["y"].number, machine.spindles["s"].number) == (2, 1, 3)


def test_channel_of_defaults_has_everything() -> None:
    view = channel()
    assert [axis[:2] for axis in view.axes] == [("X", "x"), ("Y", "y"), ("C", "c")]
    assert view.spindles == (
        ChannelSpindle("S", "s", NONE, NONE, NONE, NONE, NONE, own_name="S", number=4),
        ChannelSpindle("S2", "t", NONE, NONE, NONE, NONE, NONE, own_name="S2", number=5),
    )
    assert view.main_spindle == "S"
    assert view.m_functions == dict.fromkeys((0, 1, 2, 3, 4, 5, 17, 19, 29, 30), NONE)
    assert view.h_functions == {}
    assert (view.max_override_percent, view.circle_center_tolerance, view.circle_center_ratio) == (100.0, 2.0, 0.05)


def test_channel_with_lists() -> None:
    view = channel(
        "gruppe.0.achse: {1: {log_achs_nr: 1}, 3: {log_achs_nr: 3, bezeichnung: C1}}",
        "spdl_anzahl: 2, main_spindle_ax_nr: 5, main_spindle_name: SMAIN",
        "spindel.0: {log_achs_nr: 4, bezeichnung: S1, m3_synch: 0x00020002}",
        "spindel.1: {log_achs_nr: 5, m19_synch: MNS_SNS}",
        "m_synch: {8: MVS_SVS, 9: '0x8', 10: NOT_VALID, 3: PLC_INFO|MOS}",
        "h_synch: {7: MVS_SNS, 8: '0x0', 9: NOT_VALID}",
        "max_vb_override: 1500, mittelpkt_diff: 1000, mittelpkt_faktor: 5",
    )
    plc = Synchronisation.PLC_INFO | Synchronisation.MVS_SVS
    assert [axis[:2] for axis in view.axes] == [("X", "x"), ("C1", "c")]
    assert view.spindles == (
        ChannelSpindle("S1", "s", plc, NONE, NONE, NONE, NONE, own_name="S1", number=4),
        ChannelSpindle("SMAIN", "t", NONE, NONE, NONE, Synchronisation.MNS_SNS, NONE, own_name="S2", number=5),
    )
    assert view.main_spindle == "SMAIN"
    assert view.m_functions[8] is Synchronisation.MVS_SVS
    assert view.m_functions[9] is Synchronisation.MNS_SNS
    assert view.m_functions[3] == Synchronisation.MOS | Synchronisation.PLC_INFO
    assert 10 not in view.m_functions
    assert view.h_functions == {7: Synchronisation.MVS_SNS, 8: NONE}
    assert (view.max_override_percent, view.circle_center_tolerance, view.circle_center_ratio) == (150.0, 0.1, 0.005)


def test_channel_without_spindle() -> None:
    view = load(channels=["ch"], axes=["x"]).channels["ch"]
    assert (view.spindles, view.main_spindle) == ((), "")


def test_a_channel_that_lists_no_axes_gets_those_that_no_other_lists() -> None:
    section = "/a: {ros__parameters: {gruppe.0.achse.0.log_achs_nr: 1}}"
    machine = load(section, channels=["a", "b"], axes=["x", "y"])
    assert [axis[:2] for axis in machine.channels["a"].axes] == [("X", "x")]
    assert [axis[:2] for axis in machine.channels["b"].axes] == [("Y", "y")]


def test_a_spindle_serves_several_channels() -> None:
    machine = load(channels=["a", "b"], spindles=["s"])
    assert machine.channels["a"].spindles == machine.channels["b"].spindles


def test_warnings() -> None:
    text = "kenngr.swe_toleranz: 1, getriebe.0: {slep_ueberw_typ: 4, slep_max: 200000}"
    assert tuple(map(str, load(f"/x: {{ros__parameters: {{{text}}}}}", axes=["x"]).warnings)) == (
        "m.yaml:2:45: P-AXIS-00179 kenngr.swe_toleranz of /x: accepted, but without effect in this version",
        "m.yaml:2:91: P-AXIS-00168 getriebe[0].slep_max of /x: "
        "limit 20 mm is not above vb_max / kv, the 20 mm expected at P-AXIS-00212",
    )


def test_units_without_a_section() -> None:
    text = "/machine:\n  ros__parameters:\n    channels: [ch]\n    axes: [x, q]\n    spindles: [s]\n/x:\n/ch: {}\n"
    behind = "has no section in the file, all its parameters have their defaults"
    assert tuple(map(str, load_machine(text, "m.yaml").warnings)) == (
        f"m.yaml:4:11: P-MACH-00005 axes of /machine: axis /q {behind}",
        f"m.yaml:5:15: P-MACH-00006 spindles of /machine: spindle /s {behind}",
    )
    assert tuple(map(str, load(channels=["ch"]).warnings)) == (
        f"m.yaml:1:40: P-MACH-00004 channels of /machine: channel /ch {behind}",
    )


def test_preferred_direction_is_for_spindles() -> None:
    text = "/c: {ros__parameters: {kenngr: {achs_typ: ACHSTYP_ROTATOR, vorz_richtung: 1}}}"
    assert tuple(map(str, load(text, axes=["c"]).warnings)) == (
        "m.yaml:2:75: P-AXIS-00224 kenngr.vorz_richtung of /c: accepted, but without effect in this version",
    )
    assert load(text.replace("/c", "/s").replace("ROTATOR", "SPINDEL"), spindles=["s"]).warnings == ()


def test_a_machine_can_go_to_another_process() -> None:
    machine = load("/x: {ros__parameters: {getriebe.0.kv: 5}}", channels=["ch"], axes=["x"], spindles=["s"])
    copy = pickle.loads(pickle.dumps(machine))
    assert copy == machine
    assert copy.raw("x").kernel("P-AXIS-00099", 0) == 0.05


def test_text_is_no_number() -> None:
    with pytest.raises(TypeError, match=r"^P-AXIS-00018 is no number$"):
        load(axes=["x"]).raw("x").number("P-AXIS-00018")


def test_an_error_can_go_to_another_process() -> None:
    with pytest.raises(ParameterError) as caught:
        load("/x: {ros__parameters: {getriebe.0.kv: 0}}", axes=["x"])
    copy = pickle.loads(pickle.dumps(caught.value))
    assert (str(copy), copy.problems) == (str(caught.value), caught.value.problems)


@pytest.mark.parametrize(
    ("mode", "number", "modulo"),
    [
        ("ACHSMODE_LINEAR", 0x1, False),
        ("ACHSMODE_MODULO", 0x4, True),
        ("ACHSMODE_MODULO_LINEAR | ACHSMODE_ROT_TABLE", 0x1400, True),
        ("0x400", 0x400, True),
        ("0x80 | ACHSMODE_MODULO", 0x84, True),
    ],
)
def test_constants_of_the_axis_mode(mode: str, number: int, modulo: bool) -> None:
    machine = load(f"/x: {{ros__parameters: {{kenngr: {{achs_mode: {mode}}}}}}}", axes=["x"])
    assert machine.sets["x"].number("P-AXIS-00015") == number
    assert machine.axes["x"].modulo is modulo


def test_an_unknown_constant_of_the_axis_mode() -> None:
    with pytest.raises(ParameterError) as refusal:
        load("/x: {ros__parameters: {kenngr: {achs_mode: ACHSMODE_MODULO | ACHSMODE_SPIN}}}", axes=["x"])
    assert (
        "value 'ACHSMODE_MODULO | ACHSMODE_SPIN' has 'ACHSMODE_SPIN', which is none of ACHSMODE_LINEAR, ACHSMODE_MODULO"
        in str(refusal.value)
    )
