"""Gear changes from a program: the sequences of the manual's table, what the spindle does, what the path waits for."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest
from channel_spindle_support import MANUAL, MOS, MVS_SVS, machine_of, moves, requests, run, three, told, told_at
from machine_support import MILL, MachineBench

from cnc_ptp.parameters import MachineParameters, SpindleParameters
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

RANGES = ((50.0, 560.0), (400.0, 800.0), (700.0, 3500.0), (3501.0, 4000.0), (3800.0, 5500.0), (5400.0, 7000.0))
"""TF5200 spindle p.36, M40 to M45, rpm."""


def geared(node: str = "s", **changes: Any) -> SpindleParameters:
    """The mill's spindle with six gear records."""
    spindle = MILL.spindles["s"]
    gears = {stage: replace(spindle.gears[1], stage=stage) for stage in range(1, 7)}
    return replace(spindle, name=node, gears=gears, **changes)


def gear_machine(*, automatic: bool, from_top: bool = False) -> MachineParameters:
    spindles = three(ranges=RANGES, automatic=automatic, from_top=from_top)
    return machine_of(*spindles, units={"s": geared()}, gear_change=True)


def stages(bench: MachineBench) -> list[int]:
    return [arguments["stage"] for command, arguments in told(bench) if command == "select_gear"]


def test_automatic_selection_changes_gears_as_the_table_says() -> None:
    """p.37: 650 M41, 750 stays, 950 M42, 1050 stays, 750 stays (M42 holds it), 500 down to M40, 350 stays."""
    bench = run("S650 M03\nS750\nS950\nS1050\nS750\nS500\nS350\nM41 S750\nM05", gear_machine(automatic=True))
    assert bench.errors() == [] and bench.refusals() == []
    assert stages(bench) == [2, 3, 1, 2]
    gear = bench.column("s", "gear")
    assert [gear[0], *(new for old, new in pairwise(gear) if new != old)] == [1, 2, 3, 1, 2]


def test_manual_selection_changes_gears_as_programmed() -> None:
    """p.38: M41, stays, M42, stays, back to M41, stays."""
    text = "M41 S650 M03\nM41 S750\nM42 S950\nM42 S1050\nM41 S750\nM41 S500\nM05"
    bench = run(text, gear_machine(automatic=False))
    assert bench.errors() == [] and stages(bench) == [2, 3, 2]


@pytest.mark.parametrize(("from_top", "wanted"), [(False, 2), (True, 3)])
def test_direction_of_the_search(from_top: bool, wanted: int) -> None:
    """750 rpm lies in M41 and M42; M40 is active."""
    assert stages(run("S750 M3", gear_machine(automatic=True, from_top=from_top))) == [wanted]


def test_the_rest_of_the_block_comes_when_the_gear_is_in() -> None:
    bench = run("G01 X1 F3000 S950 M03", gear_machine(automatic=True))
    assert [command for command, _ in told(bench)] == ["select_gear", "gear_changed", "start", "stop"]
    gear, x = bench.column("s", "gear"), bench.column("x", "set_position")
    in_gear = gear.index(3)
    assert told_at(bench, "start") > in_gear and {x[cycle] for cycle in range(in_gear)} == {0.0}
    assert bench.column("channel", "state")[in_gear - 1] == C.WAITING
    assert moves(bench)[0][0] > told_at(bench, "start")


def test_a_gear_that_is_in_is_not_selected_again() -> None:
    assert stages(run("M40 S500 M03\nM05\nM40 S300 M04", gear_machine(automatic=False))) == []


def test_a_gear_change_while_turning_goes_on_with_the_new_speed() -> None:
    bench = run("M41 S600 M04\nM42 S900\nG04 0.5", gear_machine(automatic=False))
    assert [command for command, _ in told(bench)][-3:] == ["gear_changed", "start", "stop"]
    assert told(bench)[-2] == ("start", {"direction": "ccw", "speed_rpm": 900.0})
    assert min(bench.column("s", "set_speed_rpm")) == pytest.approx(-900.0)


@pytest.mark.parametrize(
    ("block", "highest"), [("M40 S50", 50.0), ("M40 M5", 0.0), ("M40 M19 S.POS=10 S20", 20.0), ("M40 M4 S60", 60.0)]
)
def test_after_the_gear_the_old_speed_is_never_taken_up_again(block: str, highest: float) -> None:
    bench = run(f"M42 S3000 M3\nG04 0.5\n{block}\nG04 1", gear_machine(automatic=False))
    assert bench.errors() == [] and stages(bench) == [3, 1]
    back = bench.column("s", "gear").index(1, 1000)
    assert max(map(abs, bench.column("s", "set_speed_rpm")[back:])) == pytest.approx(highest)


def test_only_a_new_gear_while_turning_keeps_the_speed() -> None:
    bench = run("M41 S750 M03\nM42\nG04 0.5", gear_machine(automatic=False))
    assert stages(bench) == [2, 3] and told(bench)[-2] == ("start", {"direction": "cw", "speed_rpm": 750.0})
    assert bench.column("s", "set_speed_rpm")[-600] == pytest.approx(750.0)


def test_the_path_waits_until_the_plc_has_changed_the_gear() -> None:
    bench = MachineBench(
        "%P\nM42 S900 M03\nG01 X1 F3000\nM30",
        MANUAL + "- {at: 4, to: s, do: gear_changed}",
        machine=gear_machine(automatic=False),
    ).run()
    assert bench.errors() == [] and told_at(bench, "start") == 4020 and moves(bench)[0][0] > 4020
    waiting = MachineBench("%P\nM42 S900 M03\nM30", MANUAL, machine=gear_machine(automatic=False)).run(2.0)
    assert waiting.units["channel"].waits_for() == "channel channel waits in line 2 for gear 3 of spindle s"


@pytest.mark.parametrize(
    ("what", "errors"),
    [
        ("{at: 2, to: channel, do: reset}", []),
        (
            "{at: 2, to: x, do: power, enabled: off}",
            [
                "P-ERR-23010 axis x: the enable was removed during path motion; the axis stops on its own ramp "
                "(ErrorStop)",
                "P-ERR-22012 channel channel: x is in error P-ERR-23010; the path stops on its ramp and the program is "
                "aborted",
            ],
        ),
    ],
)
def test_nothing_turns_when_the_program_ends_while_somebody_changes_the_gear(what: str, errors: list[str]) -> None:
    """The gear is changed from outside, which would take up the rotation of the program again."""
    scenario = f"{MANUAL}- {{at: 1, to: s, do: select_gear, stage: 2}}\n- {what}\n- {{at: 3, to: s, do: gear_changed}}"
    bench = MachineBench(
        "%P\nS500 M03\nG01 X90 F300\nM30", scenario, machine=gear_machine(automatic=False), end_when_idle=False
    ).run(4.0)
    assert bench.errors() == errors and bench.refusals() == []
    assert bench.column("s", "gear")[2990] == 1 and bench.column("s", "gear")[-1] == 2
    assert set(bench.column("s", "set_speed_rpm")[2000:]) == {0.0} and bench.column("s", "set_speed_rpm")[990] == 500.0


def test_a_plc_that_never_changes_the_gear_aborts_the_program() -> None:
    machine = gear_machine(automatic=False)
    patient = replace(machine, spindles={**machine.spindles, "s": geared(gear_change_time=1.0)})
    bench = MachineBench("%P\nM42 S900 M03\nG01 X1 F3000\nM30", MANUAL, machine=patient, end_when_idle=False).run(4.0)
    assert bench.errors()[-1] == (
        "P-ERR-22012 channel channel: s is in error P-ERR-24016; the path stops on its ramp and the program is aborted"
    )
    assert bench.position("x") == 0.0


def test_the_next_program_knows_the_gear() -> None:
    """Manual selection: S950 needs no M42 when M42 is in from the program before."""
    bench = MachineBench("%P\nM42 S900 M03\nM05\nM30", machine=gear_machine(automatic=False), end_when_idle=False).run(
        4.0
    )
    bench.give("channel", "load", program="b.nc", text="%B\nS950 M03\nM05\nM30")
    assert bench.give("channel", "start").accepted
    bench.run(2.0)
    assert bench.errors() == [] and stages(bench) == [3]
    bench.give("channel", "mdi", text="S960 M03")
    bench.run(1.0)
    assert bench.refusals() == [] and bench.last("s").set_speed_rpm[-1] == pytest.approx(960.0)


def test_a_speed_beyond_every_gear_is_refused_before_anything_moves() -> None:
    bench = MachineBench("%P\nG00 X1\nS8000 M3\nM30", machine=gear_machine(automatic=True), end_when_idle=False).run(
        0.1
    )
    assert bench.refusals() == [
        "P-ERR-21069 test.nc line 3 column 1 'S8000 M3': speed 8000 rpm of spindle S is in no gear stage "
        "(P-CHAN-00058, P-CHAN-00055): M40 50 to 560 rpm, M41 400 to 800 rpm, M42 700 to 3500 rpm, "
        "M43 3501 to 4000 rpm, M44 3800 to 5500 rpm, M45 5400 to 7000 rpm; nothing was started"
    ]
    assert bench.position("x") == 0.0


def told_to_the_plc(bench: MachineBench) -> list[tuple[str, int, str, bool]]:
    return [(r.kind, r.number, r.spindle, r.acknowledge_needed) for r in requests(bench) if r.number in range(40, 46)]


def test_m40_to_m45_go_to_the_plc_as_their_synchronisation_says() -> None:
    """p.37: `OK, M41 → PLC` only where the gear changes, programmed or found; the path waits for the answer too."""
    machine = gear_machine(automatic=True)
    channel = machine.channels["channel"]
    functions = {**channel.m_functions, 41: MVS_SVS, 42: MOS}
    machine = replace(machine, channels={"channel": replace(channel, m_functions=functions)})
    bench = run("S650 M03\nS750\nS950\nM40 S500\nG01 X1 F3000\nM05", machine)
    assert bench.errors() == [] and stages(bench) == [2, 3, 1]
    assert told_to_the_plc(bench) == [("M", 41, "s", True), ("M", 42, "s", False), ("M", 40, "s", False)]


def test_a_gear_that_the_plc_does_not_acknowledge_holds_the_path() -> None:
    machine = gear_machine(automatic=True)
    channel = machine.channels["channel"]
    functions = {**channel.m_functions, 41: MVS_SVS}
    machine = replace(machine, channels={"channel": replace(channel, m_functions=functions)})
    scenario = """
    - {at: 0, to: plc, do: auto_acknowledge, enabled: off}
    - {at: 1.5, to: s, do: gear_changed}
    - {at: 3.0, to: plc, do: acknowledge, id: 1}
    """
    bench = MachineBench("%P\nS650 M03\nG01 X1 F3000\nM30", scenario, machine=machine, end_when_idle=False).run(5.0)
    in_gear = bench.column("s", "gear").index(2)
    assert 1500 <= in_gear < 1600 and told_at(bench, "start") >= 3000
    assert moves(bench)[0][0] > 3000 and bench.errors() == []


def test_the_gear_follows_the_speed_of_a_positioning_too() -> None:
    """Automatic selection: 950 rpm lie in M42 alone; as programmed any gear will do that reaches them."""
    assert stages(run("M19 S950 S.POS=90", gear_machine(automatic=True))) == [3]
    assert stages(run("M19 S950 S.POS=90", gear_machine(automatic=False))) == []
    assert stages(run("S600 M3\nM19 S.POS=90", gear_machine(automatic=True))) == [2]


def test_a_positioning_above_the_active_gear_is_found_when_the_program_is_read() -> None:
    unit = geared()
    slow = replace(unit, gears={**unit.gears, 1: replace(unit.gears[1], max_speed=500.0 * 6.0)})
    machine = machine_of(*three(ranges=RANGES), units={"s": slow}, gear_change=True)
    bench = MachineBench("%P\nG01 X1 F3000\nM19 S501 S.POS=0\nM30", machine=machine, end_when_idle=False).run(0.2)
    assert bench.refusals() == [
        "P-ERR-22010 test.nc line 3 column 5 'M19 S501 S.POS=0': spindle S: 501 rpm is above the maximum 500 rpm of gear 1 "
        "(P-AXIS-00212); nothing was started"
    ]
    assert set(bench.column("x", "set_position")) == {0.0}
