"""Parameters that change while an axis runs: it is then the axis whose machine file has had the value from the start.

The oracle is a second machine with the value in its file: from the change on both give the same blocks to the bit.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import pytest
from machine_support import MachineBench
from replay_support import bits, replay, text_of

from cnc_ptp.parameters import MachineParameters, catalogue, load_machine

AXIS: dict[str, Any] = {
    "getriebe.0.kv": 3000,
    "getriebe.0.vb_eilgang": 300000,
    "getriebe.0.dynamik.vb_max": 500000,
    "getriebe.0.dynamik.a_max": 4000,
    "getriebe.0.slope_profil.a_beschl": 2000,
    "getriebe.0.slope_profil.a_brems": 1500,
    "getriebe.0.slope_profil.tr_beschl_zu": 40000,
    "getriebe.0.slep_ueberw_typ": 4,
    "getriebe.0.slep_max": 150000,
    "getriebe.0.slep_min": 50000,
    "getriebe.0.slep_dyn": 900,
    "getriebe.0.incr_per_rev": 1048576,
    "getriebe.0.load": 0.002,
    "getriebe.0.window": 1000,
    "getriebe.0.vb_reflow": 20000,
    "getriebe.0.vb_refmax": 50000,
    "antr.feed_const_num": 100000,
    "antr.acc_reference_value": 4,
    "antr.torque_scale_num": 1000,
    "vorsteuer.vorsteuerung": "VEL | ACC | JERK",
    "vorsteuer.default_active": 1,
    "vorsteuer.vs_a_faktor": 3000,
    "lr_param.frict_comp": 1,
    "frict_comp.mode": 3,
    "frict_comp.table_entries": 2,
    "frict_comp.position_delay": 100,
    "frict_comp.table.0.in": 0,
    "frict_comp.table.0.out": 200,
    "frict_comp.table.1.in": 100000,
    "frict_comp.table.1.out": 260,
    "frict_comp.table.2.in": 200000,
    "frict_comp.table.2.out": 300,
    "ptp.target_time_ms": 100,
    "simulation.model": "CASCADED",
    "simulation.drive_time_constant": 3000,
    "simulation.velocity_integral_time": 8000,
    "simulation.friction.coulomb": 0.8,
    "simulation.friction.static": 1.2,
    "kenngr.ref_richt": 1,
    "simulation.cam_position": 0,
}
ADDITIVE = {"vorsteuer.vorsteuerung": "ADD_VEL | ADD_ACC", "vorsteuer.vs_a_faktor": 1}
"""Beside the change of a delay, which additive commands have."""
MONITORED = {
    "getriebe.0.slep_ueberw_typ": 1,
    "getriebe.0.slep_min": 1000,
    "getriebe.0.slep_dyn": 990,
    "vorsteuer.default_active": 0,
}
MOVES = """\
- {at: 0.10, to: x, do: move_absolute, target: 20}
- {at: 0.70, to: x, do: move_absolute, target: -10, velocity: 50}
- {at: 1.50, to: x, do: move_relative, distance: 1, acceleration: 4100}
- {at: 1.70, to: x, do: home}
- {at: 2.60, to: x, do: jog, velocity: 400}
- {at: 2.80, to: plc, do: emergency_stop, enabled: on}
"""
CHANGE = 0.05
CHANGES: dict[str, tuple[Any, dict[str, Any]]] = {
    "P-AXIS-00099": (5000, {}),
    "P-AXIS-00236": (1, {}),
    "P-MACH-00014": (1, {"getriebe.0.window": 1}),
    "P-AXIS-00167": (100, MONITORED),
    "P-AXIS-00168": (2, {}),
    "P-AXIS-00169": (1, {}),
    "P-AXIS-00172": (0, {"getriebe.0.slep_max": 2}),
    "P-MACH-00031": (5000, {"getriebe.0.slep_max": 2}),
    "P-AXIS-00225": (6000, {}),
    "P-AXIS-00226": (2, {}),
    "P-AXIS-00228": (9, {"vorsteuer.vs_v_nenner": 10}),
    "P-AXIS-00229": (2, {}),
    "P-AXIS-00255": (0, {}),
    "P-AXIS-00337": (3, {}),
    "P-AXIS-00338": (50, {}),
    "P-AXIS-00389": (2000, ADDITIVE),
    "P-AXIS-00390": (1000, ADDITIVE),
    "P-AXIS-00514": (9, {"vorsteuer.feedforward_v_add_denom": 10}),
    "P-AXIS-00515": (2, {}),
    "P-MACH-00030": (4, {}),
    "P-COMP-00041": (0, {}),
    "P-COMP-00042": (3, {}),
    "P-COMP-00043": (3000, {}),
    "P-COMP-00045": (500, {}),
    "P-COMP-00046.1": (50000, {}),
    "P-COMP-00047.0": (100, {}),
    "P-COMP-00058": (3, {}),
    "P-AXIS-00218": (10000, {}),
    "P-AXIS-00219": (30000, {}),
    "P-AXIS-00412": (50000, {}),
    "P-MACH-00008": (40, {}),
    "P-AXIS-00001": (1500, {}),
    "P-AXIS-00002": (1000, {}),
    "P-AXIS-00196": (80000, {}),
    "P-AXIS-00008": (4200, {}),
    "P-AXIS-00003": (3000, {}),
    "P-AXIS-00212": (45000, {"getriebe.0.vb_eilgang": 30000, "getriebe.0.vb_refmax": 30000}),
    "P-AXIS-00177": (-50000, {}),
    "P-AXIS-00178": (150000, {}),
    "P-AXIS-00152": (70000, {}),
}
"""Parameter -> another value, and what else the machine needs so that it makes a difference."""


def machine_of(**others: Any) -> MachineParameters:
    values = {**AXIS, **others}
    lines = [f"    {name}: {value}" for name, value in values.items()]
    head = "/machine: {ros__parameters: {axes: [x], block_cycles: 50}}\n/x:\n  ros__parameters:\n"
    return load_machine(head + "\n".join(lines) + "\n", "m.yaml")


def name_of(parameter: str) -> str:
    """P-COMP-00046.1 -> frict_comp.table.1.in"""
    number, _, index = parameter.partition(".")
    entry = catalogue().by_id[number]
    return entry.ros_name((int(index or 0),)[: entry.index_count])


def run(machine: MachineParameters, change: tuple[str, Any] | None) -> MachineBench:
    write = (
        f"- {{at: {CHANGE}, to: x, do: write_parameter, parameter: {change[0]}, value: {change[1]}}}\n"
        if change
        else ""
    )
    return MachineBench(scenario=write + MOVES, machine=machine).run()


def seen(bench: MachineBench) -> tuple[list[str], list[str]]:
    """The axis from the change on: its blocks, and its events."""
    first = round(CHANGE / 0.05) + 1
    events = [f"{event.cycle} {event.error_id} {event.text}" for event in bench.all_events if event.source == "x"]
    return [text_of(block) for block in bench.blocks["x"][first:]], events


def test_each_parameter_that_can_change_is_tried() -> None:
    numbers = {number for number, entry in catalogue().by_id.items() if entry.change_for("T") in ("now", "standstill")}
    assert {parameter.partition(".")[0] for parameter in CHANGES} == numbers


@pytest.mark.parametrize("parameter", CHANGES)
def test_as_if_the_file_had_had_it_from_the_start(parameter: str) -> None:
    value, others = CHANGES[parameter]
    written = run(machine_of(**others), (parameter, value))
    assert [record.accepted for record in written.records if record.command == "write_parameter"] == [True]
    given = run(machine_of(**{**others, name_of(parameter): value}), None)
    assert seen(written) == seen(given)
    assert seen(written) != unchanged(tuple(others.items())), "the value makes no difference"


@cache
def unchanged(others: tuple[tuple[str, Any], ...]) -> tuple[list[str], list[str]]:
    return seen(run(machine_of(**dict(others)), None))


def test_many_changes_one_after_the_other() -> None:
    """Also of values whose limits are others: the table grows first, then it is used."""
    changes = {
        "P-AXIS-00099": 4000,
        "P-COMP-00046.2": 300000,
        "P-COMP-00042": 3,
        "P-AXIS-00228": 1,
        "P-AXIS-00168": 90000,
    }
    lines = [
        f"- {{at: 0.05, to: x, do: write_parameter, parameter: {name}, value: {value}}}\n"
        for name, value in changes.items()
    ]
    written = MachineBench(scenario="".join(lines) + MOVES, machine=machine_of()).run()
    given = run(machine_of(**{name_of(name): value for name, value in changes.items()}), None)
    assert seen(written) == seen(given)


def test_a_replay_has_the_changes_to_the_bit() -> None:
    machine = machine_of()
    scenario = (
        "- {at: 0.05, to: x, do: write_parameter, parameter: 'getriebe[0].kv', value: 4500}\n"
        "- {at: 0.30, to: x, do: write_parameter, parameter: P-AXIS-00168, value: 120000}\n"
    )
    bench = MachineBench(scenario=scenario + MOVES, machine=machine).run()
    assert sum(record.command == "write_parameter" and record.accepted for record in bench.records) == 2
    assert replay(machine, bench.records, len(bench.blocks["x"]))["x"] == bits(bench)["x"]


def bench_of(**others: Any) -> MachineBench:
    return MachineBench(machine=replace(machine_of(**others), block_cycles=10), end_when_idle=False).run(0.02)


@pytest.mark.parametrize(
    ("parameter", "value", "number", "reason"),
    [
        ("P-AXIS-00016", 3, 23095, "P-AXIS-00016 (kopf.achs_nr) cannot be written at run time, it is taken over at start-up only, as the manual has it"),
        ("P-AXIS-00234", 3, 23095, "P-AXIS-00234 (getriebe[i].wegaufz) cannot be written at run time, it is taken over at start-up only, as the manual has it"),
        ("P-AXIS-00015", 3, 23095, "P-AXIS-00015 (kenngr.achs_mode) cannot be written at run time, it is taken over at start-up only"),
        ("P-COMP-00062", 30, 110641, "P-COMP-00062 (frict_comp.max_points) cannot be written at run time, it is taken over at start-up only, as the manual has it"),
        ("kvv", 3, 23095, "axis x has no parameter 'kvv'"),
        ("P-AXIS-99999", 3, 23095, "axis x has no parameter 'P-AXIS-99999'"),
        ("P-AXIS-00216", 3, 23095, "P-AXIS-00216 getriebe[0].vb_min_null: only spindles have this parameter, x is one of the linear axes"),
        ("P-CHAN-00004", 1, 23095, "axis x has no parameter 'spindel.0.autom_range', P-CHAN-00004 belongs to channel nodes"),
        ("P-AXIS-00099.7", 3, 23095, "P-AXIS-00099 getriebe[7].kv: index 7 is outside 0 to 5"),
        ("P-COMP-00046", 3, 23095, "P-COMP-00046 (frict_comp.table[i].in) has an index: P-COMP-00046.0 is frict_comp.table[0].in"),
        ("P-AXIS-00099", 0, 23096, "P-AXIS-00099 getriebe[0].kv: value 0 is not above 0 (0.01/s)"),
        ("P-AXIS-00099", 0.5, 23096, "P-AXIS-00099 getriebe[0].kv: value 0.5 is a number, an integer is needed"),
        ("P-COMP-00042", 21, 23096, "compensation list, P-COMP-00042 frict_comp.table_entries of /x: value 21 is above the 20 entries of P-COMP-00062 frict_comp.max_points"),
        ("P-COMP-00046.1", 0, 23096, "compensation list, P-COMP-00046 frict_comp.table[1].in of /x: value 0 must be above the 0 of entry 0, velocities ascend"),
        ("P-AXIS-00008", 1, 23096, "axis list, P-AXIS-00001 getriebe[0].slope_profil.a_beschl of /x: value 2000 is above the maximum 1 mm/s² of P-AXIS-00008 getriebe[0].dynamik.a_max as written at run time"),
        ("P-AXIS-00229", 0, 23096, "axis list, P-AXIS-00229 vorsteuer.vs_v_nenner of /x: value 0 is not a valid denominator"),
    ],
)  # fmt: skip
def test_refusals(parameter: str, value: float, number: int, reason: str) -> None:
    bench = bench_of()
    text = bench.refused("x", "write_parameter", parameter=parameter, value=value)
    assert text.startswith(f"P-ERR-{number} axis x: write_parameter refused: {reason}")
    assert text.endswith("; nothing was changed")
    assert bench.run(0.05).column("x", "set_position") == [0.0] * 70


def test_at_a_standstill_only() -> None:
    bench = bench_of()
    bench.give("x", "move_absolute", target=30)
    bench.run(0.1)
    text = bench.refused("x", "write_parameter", parameter="P-AXIS-00099", value=4000)
    assert text == (
        "P-ERR-23097 axis x: write_parameter refused: P-AXIS-00099 (getriebe[i].kv) is written at a standstill only, the "
        "axis is in DiscreteMotion; nothing was changed"
    )
    assert bench.give("x", "write_parameter", parameter="P-AXIS-00168", value=140000).accepted
    bench.run(1.0)
    assert bench.give("x", "write_parameter", parameter="P-AXIS-00099", value=4000).accepted


def test_monitoring_that_changes_in_motion_acts_in_the_next_cycle() -> None:
    bench = bench_of()
    bench.give("x", "move_absolute", target=30)
    bench.run(0.1)
    assert bench.errors() == []
    bench.give("x", "write_parameter", parameter="P-AXIS-00168", value=1)
    bench.run(0.01)
    assert [event.error_id for event in bench.events if event.severity == 2] == [17744]


def test_what_the_drive_has_taken_over() -> None:
    """A position loop in the drive has its Kv from the start."""
    bench = bench_of(
        **{
            "kenngr.antr_typ": 2,
            "antr.operation_mode": "DRIVE_POSITION_CONTROL",
            "antr.telegram.commands": "[S-0-0047, S-0-0081]",
        }
    )
    text = bench.refused("x", "write_parameter", parameter="P-AXIS-00099", value=4000)
    assert text == (
        "P-ERR-23098 axis x: write_parameter refused: P-AXIS-00099 (getriebe[i].kv) cannot be written at run time, the "
        "drive has taken it over at start-up; nothing was changed"
    )


def test_soft_limits_beside_the_axis() -> None:
    """Where it stands must be permitted; a shift of its coordinates does not move them."""
    bench = bench_of()
    bench.give("x", "move_absolute", target=30)
    bench.run(1.0)
    assert bench.refused("x", "write_parameter", parameter="kenngr.swe_pos", value=299000) == (
        "P-ERR-23099 axis x: write_parameter refused: P-AXIS-00178 (kenngr.swe_pos): the axis stands at 30 mm, outside "
        "-10000 to 29.9 mm; nothing was changed"
    )
    assert bench.give("x", "set_position", position=500).accepted
    assert bench.refused("x", "write_parameter", parameter="kenngr.swe_pos", value=299000).startswith("P-ERR-23099")
    assert bench.give("x", "write_parameter", parameter="kenngr.swe_pos", value=301000).accepted


def test_what_a_channel_has_taken_over() -> None:
    bench = MachineBench(end_when_idle=False).run(0.02)
    assert bench.refused("x", "write_parameter", parameter="P-AXIS-00001", value=1000) == (
        "P-ERR-23100 axis x: write_parameter refused: P-AXIS-00001 (getriebe[i].slope_profil.a_beschl) cannot be written "
        "at run time, channel channel, which has the axis, has taken it over at start-up; nothing was changed"
    )
    assert bench.give("x", "write_parameter", parameter="getriebe[0].kv", value=4000).accepted


@pytest.mark.parametrize(
    ("parameter", "value", "others", "warning"),
    [
        ("P-AXIS-00338", 0, {}, "P-WARN-110473 axis x: write_parameter: P-AXIS-00338 vorsteuer.jerk_fact_denom of /x: value 0 is not a valid denominator, 100 is used"),
        ("P-AXIS-00389", 6000, ADDITIVE, "P-WARN-70349 axis x: write_parameter: P-AXIS-00389 vorsteuer.velocity_delay_time of /x: delay 6000 µs is not below 6 interpolator cycles (6000 µs), 0 is used"),
        ("P-AXIS-00390", 6000, ADDITIVE, "P-WARN-70348 axis x: write_parameter: P-AXIS-00390 vorsteuer.acceleration_delay_time of /x: delay 6000 µs is not below 6 interpolator cycles (6000 µs), 0 is used"),
    ],
)  # fmt: skip
def test_corrections_of_the_manual(parameter: str, value: float, others: dict[str, Any], warning: str) -> None:
    """As at start-up: the value is taken, and corrected with the vendor's number."""
    record = bench_of(**others).give("x", "write_parameter", parameter=parameter, value=value)
    assert (record.accepted, record.message) == (True, warning)


def test_how_it_was_switched_stays() -> None:
    """COMP OFF FRICT and the weight of G136 hold for the new values, too."""
    bench = bench_of(**{"vorsteuer.default_active": 0})
    bench.give("x", "set_friction_compensation", enabled=False)
    bench.give("x", "set_feedforward", enabled=True, weight_percent=50.0)
    for parameter, value in (("P-COMP-00045", 900), ("P-AXIS-00225", 2500)):
        assert bench.give("x", "write_parameter", parameter=parameter, value=value).accepted
    bench.give("x", "move_absolute", target=30)
    bench.run(0.3)
    assert set(bench.column("x", "friction_current")) == {0.0}
    assert bench.last("x").feedforward_percent[-1] == 50.0
