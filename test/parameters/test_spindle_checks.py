"""Spindle parameters against each other: exact texts of problems and of warnings."""

from __future__ import annotations

import pytest

from cnc_ptp.parameters import ParameterError, load_machine

END = "; the node does not start"
HEAD = "/machine: {ros__parameters: {spindles: [s]}}\n/s: {ros__parameters: {"
POLYNOMIAL = (
    "typ: 2, a_min: 2000, n_grenz: 12000000, a_konst: 16000, b1: -0.88888888, b2: 2.08333333E-5, b3: -1.92901234E-10"
)
HYPERBOLA = "typ: 1, a_min: 1400, n_grenz: 12000000, a_konst: 16000, b1: 2.285714E+4, b2: 4.166666E-1, b3: 2.857142E-2"
LIMITS = "dynamik: {vb_max: 48000000, a_max: 20000}"


def problems(parameters: str) -> list[str]:
    with pytest.raises(ParameterError) as caught:
        load_machine(f"{HEAD}{parameters}}}}}", "m.yaml")
    return [f"P-ERR-{problem.error_id} {problem}" for problem in caught.value.problems]


def warnings(parameters: str) -> tuple[str, ...]:
    return tuple(map(str, load_machine(f"{HEAD}{parameters}}}}}", "m.yaml").warnings))


CASES = {
    "a PLC spindle with a drive of the NC": (
        "kenngr: {achs_mode: 0x40000, antr_typ: 2}",
        "P-ERR-25009 m.yaml:2:58: axis list, P-AXIS-00020 kenngr.antr_typ of /s: value 2 must be 4 (simulation) or 16 "
        "(virtual axis), the PLC controls the spindle (P-AXIS-00015)",
    ),
    "homing without cam but with reverting": (
        "kenngr: {ref_ohne_nocken: 1}",
        "P-ERR-25009 m.yaml:2:49: axis list, P-AXIS-00156 kenngr.ref_ohne_nocken of /s: value 1 needs P-AXIS-00157 "
        "kenngr.ref_ohne_rev = 1",
    ),
    "an open position loop on a SERCOS drive": (
        "kenngr.antr_typ: 2, antr.operation_mode: OPEN_POSITION_LOOP_NO_FEEDBACK",
        "P-ERR-25009 m.yaml:2:65: axis list, P-AXIS-00320 antr.operation_mode of /s: OPEN_POSITION_LOOP_NO_FEEDBACK does "
        "not exist for drive type 2 SERCOS (P-AXIS-00020), only for 4 simulation, 5 Lightbus, 6 +-10 V terminal, "
        "7 real-time Ethernet, 8 CANopen",
    ),
    "position control without a position": (
        "simulation.telegram: SPEED",
        "P-ERR-25009 m.yaml:2:45: simulation list, P-SIM-00050 simulation.telegram of /s: value SPEED is not enough for "
        "P-AXIS-00320 DRIVE_DEFAULT, which needs POSITION",
    ),
    "speed feedback of a drive that sends nothing": (
        "simulation.telegram: NONE, antr.operation_mode: OPEN_POSITION_LOOP_VEL_FEEDBACK",
        "P-ERR-25009 m.yaml:2:45: simulation list, P-SIM-00050 simulation.telegram of /s: value NONE is not enough for "
        "P-AXIS-00320 OPEN_POSITION_LOOP_VEL_FEEDBACK, which needs SPEED",
    ),
    "speeds from positions without a resolution": (
        "antr.operation_mode: OPEN_POSITION_LOOP_MODE",
        "P-ERR-25016 m.yaml:2:1: axis list, P-AXIS-00234 getriebe[0].wegaufz of /s: no resolution is given, but the actual "
        "speed of the open position loop comes from positions",
    ),
    "homing above the control limit": (
        "getriebe.0: {vb_reflow: 50000, vb_regelgrenze: 49999}",
        "P-ERR-25009 m.yaml:2:49: axis list, P-AXIS-00218 getriebe[0].vb_reflow of /s: value 50000 is above the control "
        "limit 49999 (0.001°/s) of P-AXIS-00220 getriebe[0].vb_regelgrenze",
    ),
    "a polynomial that ends before the largest speed": (
        f"getriebe.0: {{{LIMITS}, beschl_kennlinie: {{typ: 2, n_grenz: 12000000, a_konst: 16000, b1: -1}}}}",
        "P-ERR-25009 m.yaml:2:146: axis list, P-AXIS-00026 getriebe[0].beschl_kennlinie.b1 of /s: the polynomial gives "
        "-20 °/s² at 28020 °/s, within P-AXIS-00212 (48000 °/s)",
    ),
    "a hyperbola with a pole": (
        f"getriebe.0: {{{LIMITS}, beschl_kennlinie: {{typ: 1, n_grenz: 12000000, a_konst: 16000, b1: 100, b2: -2}}}}",
        "P-ERR-25009 m.yaml:2:146: axis list, P-AXIS-00026 getriebe[0].beschl_kennlinie.b1 of /s: the hyperbola gives "
        "inf °/s² at 12000 °/s, within P-AXIS-00212 (48000 °/s)",
    ),
    "a floor above the curve": (
        f"getriebe.0: {{{LIMITS}, beschl_kennlinie: {{typ: 3, a_max: 16000, n1: 100, n2: 200, a_min: 17000}}}}",
        "P-ERR-25009 m.yaml:2:145: axis list, P-AXIS-00010 getriebe[0].beschl_kennlinie.a_min of /s: value 17000 is above "
        "16000 °/s² of P-AXIS-00240",
    ),
    "a polynomial above the largest acceleration": (
        f"getriebe.0: {{{LIMITS}, beschl_kennlinie: {{typ: 2, n_grenz: 12000000, a_konst: 16000, b1: 0.5}}}}",
        "P-ERR-25009 m.yaml:2:146: axis list, P-AXIS-00026 getriebe[0].beschl_kennlinie.b1 of /s: the polynomial gives "
        "20014 °/s² at 20028 °/s, above P-AXIS-00008 getriebe[0].dynamik.a_max (20000 °/s²)",
    ),
    "a constant acceleration above the largest one": (
        f"getriebe.0: {{{LIMITS}, beschl_kennlinie: {{typ: 2, n_grenz: 12000000, a_konst: 20001, b1: -0.1}}}}",
        "P-ERR-25009 m.yaml:2:123: axis list, P-AXIS-00007 getriebe[0].beschl_kennlinie.a_konst of /s: value 20001 is "
        "above the maximum 20000 °/s² of P-AXIS-00008 getriebe[0].dynamik.a_max in line 2",
    ),
    "a gear at start without a record": (
        "getriebe.0.kv: 1000, kenngr.getriebe_stufe: 3",
        "P-ERR-25009 m.yaml:2:45: axis list, P-AXIS-00079 kenngr.getriebe_stufe of /s: value 3 has no record getriebe[2], "
        "there is getriebe[0]",
    ),
    "a gear at start without any record": (
        "kenngr.getriebe_stufe: 2",
        "P-ERR-25009 m.yaml:2:45: axis list, P-AXIS-00079 kenngr.getriebe_stufe of /s: value 2 has no record getriebe[1], "
        "there is none",
    ),
    "the first gear at start, which has no record": (
        "getriebe: {1: {kv: 1000}, 4: {kv: 1000}}",
        "P-ERR-25009 m.yaml:2:1: axis list, P-AXIS-00079 kenngr.getriebe_stufe of /s: value 1 has no record getriebe[0], "
        "there are getriebe[1], getriebe[4]",
    ),
    "velocity control that is left above where it begins": (
        "antr: {velocity_position_control_on: 100, velocity_position_control_off: 101}",
        "P-ERR-25009 m.yaml:2:67: axis list, P-AXIS-00266 antr.velocity_position_control_off of /s: value 101 is above the "
        "maximum 100 (0.001°/s) of P-AXIS-00265 antr.velocity_position_control_on in line 2",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_contradictions(case: str) -> None:
    parameters, text = CASES[case]
    found = problems(parameters)
    place, _, expected = text.partition(": ")
    assert [each.partition(": ")[2] for each in found] == [expected + END]
    assert found[0].split(" ")[0] == place.split(" ")[0]
    assert found[0].split(" ")[1].startswith("m.yaml:2:")


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        (1, ("P-AXIS-00007 getriebe[0].beschl_kennlinie.a_konst", "P-AXIS-00130 getriebe[0].beschl_kennlinie.n_grenz")),
        (3, ("P-AXIS-00240 getriebe[0].beschl_kennlinie.a_max", "P-AXIS-00241 getriebe[0].beschl_kennlinie.n1")),
    ],
)
def test_a_curve_that_is_not_configured(kind: int, names: tuple[str, str]) -> None:
    curve = {1: "hyperbola", 3: "asynchronous"}[kind]
    assert problems(f"getriebe.0.beschl_kennlinie.typ: {kind}") == [
        f"P-ERR-25009 m.yaml:2:1: axis list, {name} of /s: value 0 gives no {curve} curve (P-AXIS-00202){END}"
        for name in names
    ]


@pytest.mark.parametrize(
    "curve", [POLYNOMIAL, HYPERBOLA, "typ: 3, a_max: 16000, a_min: 4000, n1: 10000000, n2: 20000000"]
)
def test_the_curves_of_the_manual_are_accepted(curve: str) -> None:
    assert warnings(f"getriebe.0: {{{LIMITS}, beschl_kennlinie: {{{curve}}}}}") == ()


def test_the_sign_of_b3_in_the_manuals_hyperbola_makes_a_step() -> None:
    """Page 47 has it negative, page 46 positive."""
    (text,) = warnings(
        f"getriebe.0: {{{LIMITS}, beschl_kennlinie: {{{HYPERBOLA.replace('2.857142E-2', '-2.857142E-2')}}}}}"
    )
    assert text.partition(": ")[2] == (
        "P-AXIS-00026 getriebe[0].beschl_kennlinie.b1 of /s: the hyperbola starts with 16271.2 °/s², P-AXIS-00007 is "
        "16000 °/s²: a step in the curve"
    )


def test_a_rapid_traverse_above_the_control_limit() -> None:
    (text,) = warnings("getriebe.0: {vb_eilgang: 250000, dynamik.vb_max: 48000000}")
    assert text == (
        "m.yaml:2:49: P-AXIS-00209 getriebe[0].vb_eilgang of /s: value 250000 is above the control limit 200000 (0.001°/s) "
        "of P-AXIS-00220 getriebe[0].vb_regelgrenze; positionings are that much slower"
    )
    assert warnings("getriebe.0: {vb_eilgang: 250000, vb_regelgrenze: 250000, dynamik.vb_max: 48000000}") == ()
    assert warnings("getriebe.0: {vb_eilgang: 250000, vb_regelgrenze: 0, dynamik.vb_max: 48000000}") == ()


@pytest.mark.parametrize(
    ("parameters", "texts"),
    [
        (
            "kenngr.antr_typ: 2",
            [
                "P-AXIS-00015 kenngr.achs_mode of /s: automatic homing is not possible with drive type 2 SERCOS, 0x100 should be set"
            ],
        ),
        (
            "kenngr: {antr_typ: 6, achs_mode: 0x104}",
            [
                "P-AXIS-00015 kenngr.achs_mode of /s: 0x100 (no automatic homing) should not be set for drive type 6 (+-10 V terminal), which the NC homes",
                "P-AXIS-00156 kenngr.ref_ohne_nocken of /s: should be 1 for a spindle with drive type 6 (+-10 V terminal); it is "
                "homed without a cam",
            ],
        ),
        ("kenngr: {antr_typ: 6, achs_mode: 0x4, ref_ohne_nocken: 1, ref_ohne_rev: 1}", []),
    ],
)
def test_warnings_about_homing(parameters: str, texts: list[str]) -> None:
    found = [text.partition(": ")[2] for text in warnings(parameters)]
    drive = "P-AXIS-00020 kenngr.antr_typ of /s: drive type "
    assert [text for text in found if not text.startswith(drive)] == texts
