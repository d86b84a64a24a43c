"""Every error of drives, telegrams, feedforward and friction tables, word for word; what is corrected instead."""

from __future__ import annotations

import math

import pytest

from cnc_ptp.parameters import MachineParameters, ParameterError, load_machine
from cnc_ptp.parameters.check.stability import stability_limit

EFFECT = "; the node does not start"


def load(x: str) -> MachineParameters:
    return load_machine(f"/machine: {{ros__parameters: {{axes: [x]}}}}\n/x: {{ros__parameters: {{{x}}}}}\n", "m.yaml")


def texts(x: str) -> list[str]:
    """The problems without their places."""
    with pytest.raises(ParameterError) as caught:
        load(x)
    return [f"P-ERR-{problem.error_id} {problem.text}{EFFECT}" for problem in caught.value.problems]


def notices(x: str) -> list[str]:
    return [str(notice).split(": ", 1)[1] for notice in load(x).warnings]


SERCOS = "kenngr: {antr_typ: 2}"
CARRIES = "the command telegram carries velocity"

PROBLEMS = {
    f"{SERCOS}, vorsteuer: {{vorsteuerung: ADD_VEL}}": (
        "P-ERR-70350 axis list, P-AXIS-00223 vorsteuer.vorsteuerung of /x: ADD_VEL needs an additive velocity command "
        f"(S-0-0037, 60B1, NSOLL_B), {CARRIES}"
    ),
    f"{SERCOS}, vorsteuer: {{vorsteuerung: ADD_ACC}}": (
        "P-ERR-70351 axis list, P-AXIS-00223 vorsteuer.vorsteuerung of /x: ADD_ACC needs an additive torque command "
        f"(S-0-0081, 60B2, M_ADD1), {CARRIES}"
    ),
    f"{SERCOS}, vorsteuer: {{vorsteuerung: ADD_ACC | ADD_JERK}}": (
        "P-ERR-70351 axis list, P-AXIS-00223 vorsteuer.vorsteuerung of /x: ADD_ACC and ADD_JERK need an additive "
        f"torque command (S-0-0081, 60B2, M_ADD1), {CARRIES}"
    ),
    'antr: {feed_const_num: 50000}, getriebe: {"0": {gear_fact_denom: 0}}': (
        "P-ERR-110579 axis list, P-AXIS-00512 getriebe[0].gear_fact_denom of /x: value 0 is not a valid denominator of a gear "
        "ratio"
    ),
    "vorsteuer: {vs_a_nenner: 0}": (
        "P-ERR-25019 axis list, P-AXIS-00226 vorsteuer.vs_a_nenner of /x: value 0 is not a valid denominator"
    ),
    "vorsteuer: {vs_v_nenner: 0}": (
        "P-ERR-25019 axis list, P-AXIS-00229 vorsteuer.vs_v_nenner of /x: value 0 is not a valid denominator"
    ),
    "vorsteuer: {feedforward_v_add_denom: 0}": (
        "P-ERR-25019 axis list, P-AXIS-00515 vorsteuer.feedforward_v_add_denom of /x: value 0 is not a valid denominator"
    ),
    "kenngr: {antr_typ: 8}, antr: {telegram: {commands: [60FF, S-0-0037]}}": (
        "P-ERR-25020 machine list, P-MACH-00020 antr.telegram.commands of /x: object S-0-0037 cannot be exchanged with "
        "drive type 8 (P-AXIS-00020), known are 60FF, 607A, 6071, 60B1, 60B2"
    ),
    "kenngr: {antr_typ: 16}, antr: {telegram: {feedback: [606C]}}": (
        "P-ERR-25020 machine list, P-MACH-00021 antr.telegram.feedback of /x: object 606C cannot be exchanged with "
        "drive type 16 (P-AXIS-00020), known are none"
    ),
    "kenngr: {antr_typ: 8}, antr: {operation_mode: DRIVE_POSITION_CONTROL}": (
        "P-ERR-25020 axis list, P-AXIS-00320 antr.operation_mode of /x: mode DRIVE_POSITION_CONTROL commands the "
        f"position, {CARRIES}"
    ),
    "frict_comp: {mode: 3}": (
        "P-ERR-110592 compensation list, P-COMP-00041 frict_comp.mode of /x: mode 3 has no values, P-COMP-00042 "
        "frict_comp.table_entries is 0"
    ),
    "frict_comp: {mode: 2}": (
        "P-ERR-110592 compensation list, P-COMP-00041 frict_comp.mode of /x: mode 2 is unknown, there are 0 (off) and "
        "3 (additive current)"
    ),
    "frict_comp: {table_entries: 21}": (
        "P-ERR-25009 compensation list, P-COMP-00042 frict_comp.table_entries of /x: value 21 is above the 20 entries "
        "of P-COMP-00062 frict_comp.max_points"
    ),
    "frict_comp: {table_entries: 3, max_points: 2}": (
        "P-ERR-25009 compensation list, P-COMP-00042 frict_comp.table_entries of /x: value 3 is above the 2 entries of "
        "P-COMP-00062 frict_comp.max_points"
    ),
    'frict_comp: {mode: 3, table_entries: 2, table: {"0": {in: 316}, "1": {in: 316}}}': (
        "P-ERR-110591 compensation list, P-COMP-00046 frict_comp.table[1].in of /x: value 316 must be above the 316 of "
        "entry 0, velocities ascend"
    ),
    'frict_comp: {mode: 3, table_entries: 1, table: {"0": {in: -1}}}': (
        "P-ERR-110591 compensation list, P-COMP-00046 frict_comp.table[0].in of /x: value -1 must be not negative, "
        "velocities ascend"
    ),
    'frict_comp: {mode: 3, table_entries: 20, table: {"0": {in: 5}}}': (
        "P-ERR-110591 compensation list, P-COMP-00042 frict_comp.table_entries of /x: value 20, but the velocity "
        "(P-COMP-00046) of entries 1 ... 19 is not given"
    ),
    'frict_comp: {mode: 3, table_entries: 8, table: {"1": {in: 5}, "3": {in: 6}, "4": {in: 7}}}': (
        "P-ERR-110591 compensation list, P-COMP-00042 frict_comp.table_entries of /x: value 8, but the velocity "
        "(P-COMP-00046) of entries 2, 5 ... 7 is not given"
    ),
    'frict_comp: {mode: 3, table_entries: 3, table: {"0": {in: 5}, "2": {in: 6}}}': (
        "P-ERR-110591 compensation list, P-COMP-00042 frict_comp.table_entries of /x: value 3, but the velocity "
        "(P-COMP-00046) of entry 1 is not given"
    ),
    f'{SERCOS}, lr_param: {{frict_comp: 1}}, frict_comp: {{mode: 3, table_entries: 1, table: {{"0": {{out: 5}}}}}}': (
        "P-ERR-70351 axis list, P-AXIS-00522 lr_param.frict_comp of /x: friction compensation needs an additive torque "
        f"command (S-0-0081, 60B2, M_ADD1), {CARRIES}"
    ),
    'simulation: {model: CASCADED}, getriebe: {"0": {load: 0}}': (
        "P-ERR-25009 axis list, P-AXIS-00391 getriebe[0].load of /x: value 0 is not a valid inertia for P-SIM-00006 "
        "simulation.model CASCADED, P-SIM-00007 simulation.inertia is 0 too"
    ),
    "simulation: {model: CASCADED, current_time_constant: 5000, velocity_integral_time: 5000}": (
        "P-ERR-25009 simulation list, P-SIM-00009 simulation.velocity_integral_time of /x: value 5000 is not above the "
        "5000 µs of P-SIM-00010 simulation.current_time_constant, the velocity controller is unstable"
    ),
    'antr: {telegram: {commands: [S-0-0080]}}, getriebe: {"0": {load: 0}}': (
        "P-ERR-25009 axis list, P-AXIS-00391 getriebe[0].load of /x: value 0 is not a valid inertia for a torque command, "
        "P-SIM-00007 simulation.inertia is 0 too"
    ),
    f'{SERCOS}, antr: {{sercos: {{mdt: {{"0": {{nc_ref: S_0_0036, ident_nr: 37}}}}}}}}': (
        "P-ERR-25020 machine list, P-MACH-00023 antr.sercos.mdt[0].ident_nr of /x: value 37 is not the number of "
        "S-0-0036, the object in P-MACH-00022"
    ),
    f'{SERCOS}, antr: {{sercos: {{at: {{"0": {{ident_nr: 51}}, "1": {{nc_ref: S-0-0084, ident_nr: 40}}}}}}}}': (
        "P-ERR-25020 machine list, P-MACH-00026 antr.sercos.at[1].ident_nr of /x: value 40 is not the number of "
        "S-0-0084, the object in P-MACH-00025"
    ),
    f"{SERCOS}, antr: {{telegram: {{commands: [S-0-0036, S-0-0037, S-0-0036]}}}}": (
        "P-ERR-25020 machine list, P-MACH-00020 antr.telegram.commands of /x: object S-0-0036 is in the telegram twice"
    ),
    f'{SERCOS}, antr: {{telegram: {{feedback: [S-0-0051]}}, sercos: {{at: {{"0": {{ident_nr: 51}}}}}}}}': (
        "P-ERR-25020 machine list, P-MACH-00026 antr.sercos.at[0].ident_nr of /x: object S-0-0051 is in the telegram twice"
    ),
    "antr: {telegram: {commands: [S-0-0036, 60FF]}}": (
        "P-ERR-25020 machine list, P-MACH-00020 antr.telegram.commands of /x: objects S-0-0036 and 60FF both carry the "
        "velocity"
    ),
    'kenngr: {antr_typ: 2}, antr: {sercos: {at: {"0": {ident_nr: 37}}}}': (
        "P-ERR-25020 machine list, P-MACH-00026 antr.sercos.at[0].ident_nr of /x: object S-0-0037 is one of the command "
        "telegram (antr.sercos.mdt, antr.telegram.commands), known here are S-0-0051, S-0-0040, S-0-0084"
    ),
}


@pytest.mark.parametrize("section", PROBLEMS)
def test_problem(section: str) -> None:
    assert texts(section) == [PROBLEMS[section] + EFFECT]


def test_objects_by_number_and_by_name_make_additive_commands_possible() -> None:
    objects = 'sercos: {mdt: {"0": {ident_nr: 36}, "1": {nc_ref: S_0_0037}, "2": {ident_nr: 81}}}'
    machine = load(f"{SERCOS}, vorsteuer: {{vorsteuerung: ADD_VEL | ADD_ACC}}, antr: {{{objects}}}")
    drive = machine.axes["x"].control.drive
    assert drive.commands == {"velocity", "additive_velocity", "additive_torque"}
    assert drive.interface == "velocity"


def test_an_object_by_number_and_name_alike() -> None:
    objects = 'sercos: {mdt: {"0": {nc_ref: S_0_0036, ident_nr: 36}}}'
    assert load(f"{SERCOS}, antr: {{{objects}}}").axes["x"].control.drive.commands == {"velocity"}


def test_an_additive_object_alone_is_added_to_the_command_of_the_drive_type() -> None:
    """As TF5200 feedforward 4.1 has it; a torque feedback comes beside the position."""
    objects = 'sercos: {mdt: {"0": {nc_ref: S_0_0037, ident_len: 4}}, at: {"0": {nc_ref: S_0_0084}}}'
    drive = load(f"{SERCOS}, vorsteuer: {{vorsteuerung: 0x101}}, antr: {{{objects}}}").axes["x"].control.drive
    assert (drive.interface, drive.commands) == ("velocity", {"velocity", "additive_velocity"})
    assert drive.feedback == {"position", "torque"}


def test_profidrive_with_an_additive_torque() -> None:
    telegram = "antr: {telegram: {commands: [XERR, NSOLL_B, M_ADD1], feedback: [G1_XIST1, MIST_GLATT]}}"
    drive = load(f"kenngr: {{antr_typ: 3}}, {telegram}").axes["x"].control.drive
    assert (drive.interface, drive.commands) == ("lag", {"lag", "additive_velocity", "additive_torque"})
    assert drive.feedback == {"position", "torque"}


def test_a_torque_command_can_hold_feedforward_and_friction() -> None:
    table = 'frict_comp: {mode: 3, table_entries: 1, table: {"0": {out: 5}}}'
    torque = "vorsteuer: {vorsteuerung: ADD_VEL | ADD_ACC}, antr: {telegram: {commands: [S-0-0080]}}"
    drive = load(f"{SERCOS}, {torque}, lr_param: {{frict_comp: 1}}, {table}").axes["x"].control.drive
    assert (drive.interface, drive.commands) == ("torque", {"torque"})


@pytest.mark.parametrize(
    ("kind", "interface", "commands", "feedback"),
    [
        (1, "velocity", {"velocity"}, {"position"}),
        (2, "velocity", {"velocity"}, {"position"}),
        (3, "lag", {"lag", "additive_velocity"}, {"position", "velocity"}),
        (6, "velocity", {"velocity"}, {"position"}),
        (8, "velocity", {"velocity"}, {"position"}),
        (16, "none", set(), set()),
    ],
)
def test_presets_of_drive_types(kind: int, interface: str, commands: set[str], feedback: set[str]) -> None:
    drive = load(f"kenngr: {{antr_typ: {kind}}}").axes["x"].control.drive
    assert (drive.interface, drive.commands, drive.feedback) == (interface, commands, feedback)


NOTICES = {
    "vorsteuer: {velocity_delay_time: 6000}": (
        "P-AXIS-00389 vorsteuer.velocity_delay_time of /x: delay 6000 µs is not below 6 interpolator "
        "cycles (6000 µs), 0 is used"
    ),
    "vorsteuer: {acceleration_delay_time: 7000}": (
        "P-AXIS-00390 vorsteuer.acceleration_delay_time of /x: delay 7000 µs is not below 6 interpolator "
        "cycles (6000 µs), 0 is used"
    ),
    "antr: {torque_scale_denom: 0}": (
        "P-AXIS-00326 antr.torque_scale_denom of /x: value 0 is not a valid denominator, no additive torque is output"
    ),
    "antr: {acc_reference_value: 0}, vorsteuer: {vorsteuerung: ADD_ACC}": (
        "P-AXIS-00392 antr.acc_reference_value of /x: value 0 is not a valid reference of the torque scaling, no "
        "additive torque is output"
    ),
    "antr: {acc_reference_value: 0}, lr_param: {frict_comp: 1}, "
    "frict_comp: {mode: 3, table_entries: 1, table: {'0': {out: 5}}}": (
        "P-AXIS-00392 antr.acc_reference_value of /x: value 0 is not a valid reference of the torque scaling, no "
        "additive torque is output"
    ),
    "vorsteuer: {jerk_fact_denom: 0}": (
        "P-AXIS-00338 vorsteuer.jerk_fact_denom of /x: value 0 is not a valid denominator, 100 is used"
    ),
    "vorsteuer: {vs_v_faktor: 6, vs_v_nenner: 5}": (
        "P-AXIS-00228 vorsteuer.vs_v_faktor of /x: weight 1.2 of the feedforward is above 1, the axis leads its setpoint"
    ),
    "vorsteuer: {feedforward_v_add_num: 2}": (
        "P-AXIS-00514 vorsteuer.feedforward_v_add_num of /x: weight 2 of the velocity feedforward is above 1, the axis "
        "leads its setpoint"
    ),
    'getriebe: {"0": {slep_ueberw_typ: 3}}': (
        "P-AXIS-00172 getriebe[0].slep_ueberw_typ of /x: type 3 is none of 1, 2, 4, the following error is not monitored"
    ),
    "kenngr: {antr_typ: 3}, vorsteuer: {vorsteuerung: VEL | ADD_ACC}, simulation: {drive_kv: 900}, "
    "antr: {telegram: {commands: [XERR, M_ADD1]}}": (
        "P-SIM-00019 simulation.drive_kv of /x: gain 9 1/s of the drive is not the 10 1/s of P-AXIS-00099 with which "
        "feedforward becomes a position; a lag remains"
    ),
    "frict_comp: {position_delay: 30}": (
        "P-COMP-00043 frict_comp.position_delay of /x: value 30 is above the 10 of the manual, accepted"
    ),
    'getriebe: {"0": {kv: 300000}}': (
        "P-AXIS-00099 getriebe[0].kv of /x: gain 3000 1/s makes the position loop unstable, with this drive the limit "
        "is 2000 1/s"
    ),
    'kenngr: {antr_typ: 1}, getriebe: {"0": {dynamik: {vb_max: 300000}}}': (
        "P-AXIS-00129 getriebe[0].multi_gain_z of /x: the 16 bits of the command carry 273.058 mm/s, less than the 300 "
        "mm/s of P-AXIS-00212"
    ),
    "kenngr: {antr_typ: 8}, antr: {v_reso_num: 0}": (
        "P-AXIS-00206 antr.v_reso_num of /x: the 32 bits of the command carry 0 mm/s, less than the 200 mm/s of "
        "P-AXIS-00212"
    ),
    'kenngr: {antr_typ: 6, achs_typ: ACHSTYP_ROTATOR}, getriebe: {"0": {dynamik: {vb_max: 300000}}}': (
        "P-AXIS-00129 getriebe[0].multi_gain_z of /x: the 16 bits of the command carry 273.058 deg/s, less than the 300 "
        "deg/s of P-AXIS-00212"
    ),
    "antr: {operation_mode: OPEN_POSITION_LOOP_MODE}": (
        "P-AXIS-00320 antr.operation_mode of /x: mode OPEN_POSITION_LOOP_MODE is accepted, but the position loop stays "
        "closed"
    ),
    "kenngr: {antr_typ: 3}, simulation: {drive_kv: 300000}": (
        "P-SIM-00019 simulation.drive_kv of /x: gain 3000 1/s makes the position loop unstable, with this drive the "
        "limit is 2000 1/s"
    ),
    'antr: {telegram: {commands: [S-0-0080]}}, getriebe: {"0": {kv: 5000}}, lr_param: {velocity_gain: 5000}': (
        "P-AXIS-00099 getriebe[0].kv of /x: gain 50 1/s makes the position loop unstable, with this drive the limit is "
        "0 1/s"
    ),
}


@pytest.mark.parametrize("section", NOTICES)
def test_notice(section: str) -> None:
    assert notices(section) == [NOTICES[section]]


FINE = "antr: {acc_reference_value: 4, torque_scale_num: 100000"
"""100000 digits are 4 Nm: 16 bits carry 1.31068 Nm."""
AXIS_WITH_INERTIA = 'getriebe: {"0": {load: 1, dynamik: {a_max: 2000}}}'
"""1 kg at 2 m/s²: 2 N."""
TORQUE_WORDS = {
    "commands: [S-0-0036, S-0-0081]": (
        "vorsteuer: {vorsteuerung: ADD_ACC}",
        ["additive torque command carry 1.31068 N, less than the 2 N of a_max and the friction table"],
    ),
    "commands: [S-0-0036, S-0-0081], feedback: [S-0-0051]": ("vorsteuer: {vorsteuerung: VEL}", []),
    "commands: [S-0-0036, S-0-0081], feedback: []": (
        "lr_param: {frict_comp: 1}, frict_comp: {mode: 3, table_entries: 1, table: {'0': {out: 40000}}}",
        ["additive torque command carry 1.31068 N, less than the 1.6 N of a_max and the friction table"],
    ),
    "feedback: [S-0-0051, S-0-0084]": (
        "simulation: {model: CASCADED}",
        ["actual torque carry 1.31068 N, less than the 2 N of a_max and the friction table"],
    ),
    "feedback: [S-0-0084, S-0-0051]": (
        "simulation: {model: CASCADED, torque_limit: 3}",
        ["actual torque carry 1.31068 N, less than the 3 N of the torque limit P-SIM-00011"],
    ),
    "commands: [S-0-0080], feedback: [S-0-0051, S-0-0040]": (
        "simulation: {torque_limit: 0}",
        ["torque command carry 1.31068 N, less than the 2 N of a_max and the friction table"],
    ),
    "commands: [S-0-0080], feedback: [S-0-0040, S-0-0051]": ("simulation: {torque_limit: 1}", []),
}


@pytest.mark.parametrize("telegram", TORQUE_WORDS)
def test_torque_words_that_are_too_short(telegram: str) -> None:
    more, texts = TORQUE_WORDS[telegram]
    scale = "v_reso_num: 10000, v_reso_denom: 10000"
    section = f"{SERCOS}, {FINE}, {scale}, telegram: {{{telegram}}}}}, {AXIS_WITH_INERTIA}, {more}"
    start = "P-AXIS-00325 antr.torque_scale_num of /x: the 16 bits of the "
    assert notices(section) == [f"{start}{text}; more is cut off" for text in texts]


def test_torque_words_that_are_long_enough() -> None:
    """32 bits; no format at all on the simulated drive; torque of a motor behind a feed constant in Nm."""
    objects = 'sercos: {mdt: {"0": {ident_nr: 36}, "1": {ident_nr: 81, ident_len: 4}}}, v_reso_denom: 10'
    more = f"{AXIS_WITH_INERTIA}, vorsteuer: {{vorsteuerung: ADD_ACC}}"
    assert notices(f"{SERCOS}, {FINE}, {objects}}}, {more}") == []
    assert notices(f"{FINE}}}, {more}") == []
    motor = "feed_const_num: 100000, telegram: {commands: [S-0-0081]}, v_reso_denom: 10"
    assert notices(f"{SERCOS}, {FINE}, {motor}}}, {more}".replace("load: 1,", "load: 0.002,")) == [
        "P-AXIS-00325 antr.torque_scale_num of /x: the 16 bits of the additive torque command carry 1.31068 Nm, less "
        "than the 2.51327 Nm of a_max and the friction table; more is cut off"
    ]


def spindle_notices(s: str) -> list[str]:
    text = f"/machine: {{ros__parameters: {{spindles: [s]}}}}\n/s: {{ros__parameters: {{{s}}}}}\n"
    return [str(notice).split(": ", 1)[1] for notice in load_machine(text, "m.yaml").warnings]


def test_all_gears_of_a_spindle_are_checked() -> None:
    """The second one is unstable, and too fast for the DA word."""
    gears = 'getriebe: {"0": {kv: 5000}, "1": {kv: 300000}}'
    assert spindle_notices(gears) == [
        "P-AXIS-00099 getriebe[1].kv of /s: gain 3000 1/s makes the position loop unstable, with this drive the limit "
        "is 2000 1/s"
    ]
    drive = "kenngr: {antr_typ: 1, achs_mode: 4, ref_ohne_nocken: 1, ref_ohne_rev: 1}"
    speeds = 'getriebe: {"0": {dynamik: {vb_max: 200000}}, "1": {dynamik: {vb_max: 300000}}}'
    assert spindle_notices(f"{drive}, {speeds}") == [
        "P-AXIS-00129 getriebe[1].multi_gain_z of /s: the 16 bits of the command carry 273.058 deg/s, less than the 300 "
        "deg/s of P-AXIS-00212"
    ]


def test_a_gain_of_the_drive_is_reported_once() -> None:
    assert spindle_notices(
        'kenngr: {antr_typ: 3}, simulation: {drive_kv: 300000}, getriebe: {"0": {kv: 9}, "1": {kv: 9}}'
    ) == [
        "P-SIM-00019 simulation.drive_kv of /s: gain 3000 1/s makes the position loop unstable, with this drive the "
        "limit is 2000 1/s"
    ]


def test_a_bus_has_one_velocity_scale_for_all_gears() -> None:
    speeds = 'getriebe: {"0": {dynamik: {vb_max: 300000}}, "1": {dynamik: {vb_max: 200000}}}'
    assert spindle_notices(f"kenngr: {{antr_typ: 8}}, antr: {{v_reso_num: 0}}, {speeds}") == [
        "P-AXIS-00206 antr.v_reso_num of /s: the 32 bits of the command carry 0 deg/s, less than the 300 deg/s of "
        "P-AXIS-00212"
    ]


def test_a_proportional_velocity_controller_in_the_nc_is_stable() -> None:
    assert notices("antr: {telegram: {commands: [S-0-0080]}}, lr_param: {velocity_integral_time: 0}") == []


def test_a_velocity_from_positions_makes_a_torque_loop_unstable_earlier() -> None:
    """c = 1.995: the limit is 2000 · (2 - c)/(2 + c) = 2.503 1/s; with 606C it is 2000 1/s."""
    section = 'kenngr: {{antr_typ: 8}}, antr: {{telegram: {{commands: ["6071"], feedback: ["6064"{}]}}}}, '
    section += 'lr_param: {{velocity_gain: 1995, velocity_integral_time: 0}}, getriebe: {{"0": {{kv: 5000}}}}'
    assert notices(section.format(", 606C")) == []
    assert notices(section.format("")) == [
        "P-AXIS-00099 getriebe[0].kv of /x: gain 50 1/s makes the position loop unstable, with this drive the limit is "
        "2.503 1/s"
    ]


def test_a_torque_scaling_without_reference_does_not_matter_where_no_torque_goes_out() -> None:
    assert notices("antr: {acc_reference_value: 0}, vorsteuer: {vorsteuerung: VEL | ACC}") == []


@pytest.mark.parametrize(
    "section",
    [
        "vorsteuer: {feedforward_v_add_num: 2, vs_v_nenner: 2}",
        'getriebe: {"0": {slep_ueberw_typ: 0}}',
        "kenngr: {antr_typ: 3}, vorsteuer: {vorsteuerung: ADD_VEL}, simulation: {drive_kv: 900}",
        "kenngr: {antr_typ: 3}, simulation: {drive_kv: 900}",
        "kenngr: {antr_typ: 3}, vorsteuer: {vorsteuerung: VEL}, simulation: {drive_kv: 1000}",
        "vorsteuer: {vorsteuerung: VEL}, simulation: {drive_kv: 900}",
    ],
)
def test_no_notice(section: str) -> None:
    assert notices(section) == []


def test_what_is_corrected() -> None:
    control = (
        load(
            "vorsteuer: {velocity_delay_time: 6000, acceleration_delay_time: 5999, jerk_fact_denom: 0}, "
            "antr: {torque_scale_denom: 0}"
        )
        .axes["x"]
        .control
    )
    assert (control.feedforward.velocity_delay, control.feedforward.acceleration_delay) == (0.0, 0.005999)
    assert (control.feedforward.jerk_weight, control.scaling.torque) == (0.01, 0.0)


@pytest.mark.parametrize("time_constant", [0.0005, 0.003, 0.02])
def test_stability_limit_of_a_first_order_drive_is_the_closed_form(time_constant: float) -> None:
    """Jury's conditions for z² - z (1 + d - K (T - L)) + d + K (L - d T): det < 1 and 1 + trace + det > 0."""
    t, d = 0.001, math.exp(-0.001 / time_constant)
    way = time_constant * (1.0 - d)
    by_determinant = (1.0 - d) / (way * (1.0 - d) - d * (t - way))
    by_trace = 2.0 * (1.0 + d) / ((t - way) * (1.0 + d) - way * (1.0 - d))
    limits = [limit for limit in (by_determinant, by_trace) if limit > 0.0]
    plant = load(f"simulation: {{drive_time_constant: {round(time_constant * 1e6)}}}").axes["x"].control.plant
    assert stability_limit(plant, t) == pytest.approx(min(limits), rel=1e-9)


def test_each_cycle_of_delay_lowers_the_limit() -> None:
    limits = []
    for cycles in range(4):
        section = f"simulation: {{drive_time_constant: 3000, bus_delay_cycles: {cycles}}}"
        limits.append(stability_limit(load(section).axes["x"].control.plant, 0.001))
    assert limits == sorted(limits, reverse=True)
    # pure dead time of n cycles in front of an integrator: Kv T = 2 sin(π / (4 n + 2))
    plant = load("simulation: {bus_delay_cycles: 3}").axes["x"].control.plant
    assert stability_limit(plant, 0.001) == pytest.approx(2000.0 * math.sin(math.pi / 14.0), rel=1e-9)


@pytest.mark.parametrize(
    ("text", "error_id", "values"),
    [
        (
            "vorsteuer: {velocity_delay_time: 6000}",
            70349,
            (("P-AXIS-00389", 6000.0, "µs"), ("limit", 6000.0, "µs"), ("corrected", 0.0, "µs")),
        ),
        (
            "vorsteuer: {acceleration_delay_time: 7000}",
            70348,
            (("P-AXIS-00390", 7000.0, "µs"), ("limit", 6000.0, "µs"), ("corrected", 0.0, "µs")),
        ),
        ("antr: {torque_scale_denom: 0}", 110465, (("P-AXIS-00326", 0.0, ""),)),
        ("vorsteuer: {jerk_fact_denom: 0}", 110473, (("P-AXIS-00338", 0.0, ""), ("corrected", 100.0, ""))),
        ("vorsteuer: {vs_v_faktor: 6, vs_v_nenner: 5}", 26120, (("P-AXIS-00228", 6.0, ""),)),
    ],
)
def test_notices_have_the_number_of_the_vendor_and_their_values(
    text: str, error_id: int, values: tuple[tuple[str, float, str], ...]
) -> None:
    (notice,) = load(text).warnings
    assert (notice.error_id, notice.values) == (error_id, values)


def test_a_misprinted_name_of_the_manual_leads_to_the_right_one() -> None:
    with pytest.raises(ParameterError) as refusal:
        load("vorsteuer: {jerk_fact_nom: 1}")
    assert "did you mean vorsteuer.jerk_fact_num (P-AXIS-00337)?" in str(refusal.value)


def test_an_object_in_the_wrong_telegram_is_reported_at_its_place() -> None:
    """The list line of the manual, antr.sercos.at[0].ident_nr 37 beside mdt[0].nc_ref S_0_0037, below other lists."""
    text = (
        'kenngr: {antr_typ: 2}\n    antr:\n      telegram: {feedback: [S-0-0051]}\n      sercos:\n        mdt: {"0": {ident_len: 4, nc_ref: S_0_0037}}\n'
        '        at:\n          "0":\n            ident_nr: 37'
    )
    machine = f"/machine: {{ros__parameters: {{axes: [x]}}}}\n/x:\n  ros__parameters:\n    {text}\n"
    with pytest.raises(ParameterError) as refusal:
        load_machine(machine, "m.yaml")
    (problem,) = refusal.value.problems
    assert (problem.error_id, str(problem.place)) == (25020, "m.yaml:11:23")
    assert problem.text.startswith(
        "machine list, P-MACH-00026 antr.sercos.at[0].ident_nr of /x: object S-0-0037 is one of"
    )


@pytest.mark.parametrize(
    ("x", "reported"),
    [
        ("getriebe: {'0': {gear_fact_num: 3}}", True),
        ("getriebe: {'0': {gear_fact_denom: 2}}", True),
        ("getriebe: {'0': {gear_fact_num: 2, gear_fact_denom: 2}}", False),
        ("getriebe: {'0': {gear_fact_num: 3}}, antr: {feed_const_num: 50000}", False),
    ],
)
def test_a_gear_ratio_without_feed_constant_is_reported(x: str, reported: bool) -> None:
    text = (
        "without effect, there is no feed constant (P-AXIS-00362 and P-AXIS-00363 are 1); the resolution is "
        "P-AXIS-00234/00233"
    )
    found = [notice for notice in notices(x) if "gear_fact" in notice]
    name = "P-AXIS-00511 getriebe[0].gear_fact_num" if "num: 3" in x else "P-AXIS-00512 getriebe[0].gear_fact_denom"
    assert found == ([f"{name} of /x: {text}"] if reported else [])
