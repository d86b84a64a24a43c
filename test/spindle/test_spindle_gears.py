"""Gear changes: change position in rapid traverse, handshake, parameters of the new gear, what waits, errors."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from error_support import refused
from machine_support import MILL, MachineBench, UnitBench, spindle_bench
from spindle_support import RPM, bench_of, first_cycle, states, two_gears

from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import Refusal

SECOND = {"kv": 25.0, "max_speed": 6000.0 * RPM, "acceleration": 9000.0, "encoder_increment": 0.01}


def bench(**changes: Any) -> UnitBench:
    return bench_of(two_gears(second=SECOND, change_position=45.0, **changes))


def changed(each: UnitBench, stage: int = 2) -> UnitBench:
    """The whole gear change."""
    each.accepted("select_gear", stage=stage)
    each.run(500)
    assert each.last.gear_request == stage
    each.accepted("gear_changed")
    return each


def test_the_change_position_is_approached_in_rapid_traverse_the_shorter_way() -> None:
    each = bench(positioning_speed=600.0)
    each.accepted("select_gear", stage=2)
    each.run(300)
    assert each.column("target_position_deg")[5] == 45.0 and max(each.column("set_speed_rpm")) == pytest.approx(100.0)
    asked = next(block.first_cycle for block in each.blocks if block.gear_request)
    assert each.column("actual_position_deg")[asked] == pytest.approx(45.0, abs=0.06)
    assert set(each.column("gear_change_active")) == {True} and set(each.column("gear")) == {1}
    assert states(each) == [S.DISCRETE_MOTION, S.STANDSTILL]
    behind = bench_of(two_gears(change_position=300.0))
    behind.accepted("select_gear", stage=2)
    behind.run(300)
    assert behind.column("set_position_deg")[-1] == -60.0


def test_with_a_preferred_direction_it_is_approached_in_that_one() -> None:
    each = bench_of(two_gears(change_position=300.0, preferred_direction=1))
    each.accepted("select_gear", stage=2)
    each.run(400)
    assert each.column("set_position_deg")[-1] == 300.0


def test_after_the_acknowledgement_the_parameters_of_the_new_gear_count() -> None:
    each = changed(bench())
    each.run(10)
    assert (each.column("gear")[-1], each.column("gear_change_active")[-1], each.last.gear_request) == (2, False, 0)
    each.accepted("start", direction="cw", speed_rpm=1000.0)
    each.run(1500)
    begin = 510
    assert each.column("set_acceleration_deg_s2")[begin + 1] == 9000.0
    assert each.column("following_error_deg")[-1] == pytest.approx(1000.0 * RPM / 25.0, abs=0.02)
    counts = each.column("actual_position_deg")[-1] / 0.01
    assert abs(math.remainder(counts - each.unit.spindle.loop.control.offset / 0.01, 1.0)) < 1e-6
    assert each.refusal("start", direction="cw", speed_rpm=7000.0) == refused(24002, speed=7000.0, limit=6000.0, gear=2)


def test_nothing_steps_when_the_measuring_system_of_the_gear_changes() -> None:
    each = changed(bench())
    each.run(100)
    before, after = each.column("actual_position_deg")[499], each.column("actual_position_deg")[500:]
    assert after == pytest.approx([before] * 100, abs=0.01)
    assert max(map(abs, each.column("following_error_deg")[500:])) <= 0.01


def test_the_gear_in_use_is_not_changed() -> None:
    each = bench()
    assert each.accepted("select_gear", stage=1) == "spindle s: gear 1 is selected already"
    each.run(20)
    assert set(each.column("state")) == {S.STANDSTILL}


def test_an_endless_rotation_goes_on_after_the_change() -> None:
    each = bench()
    each.accepted("start", direction="ccw", speed_rpm=1000.0)
    each.run(400)
    changed(each).run(800)
    assert each.column("set_speed_rpm")[-1] == -1000.0 and each.column("gear")[-1] == 2


def test_an_endless_rotation_that_is_not_to_go_on() -> None:
    each = bench()
    each.accepted("start", direction="ccw", speed_rpm=1000.0)
    each.run(400)
    each.accepted("select_gear", stage=2, resume=False)
    each.run(500)
    assert at_rest_in_the_new_gear(each)


def test_a_rotation_that_is_too_fast_for_the_new_gear_does_not_go_on() -> None:
    each = bench()
    each.accepted("start", direction="cw", speed_rpm=9000.0)
    each.run(1700)
    each.accepted("select_gear", stage=2)
    each.run(1700)
    assert each.accepted("gear_changed") == (
        "P-WARN-24029 spindle s: the previous speed 9000 rpm is above the maximum 6000 rpm of gear 2 (P-AXIS-00212); the spindle stays at rest"
    )
    each.run(100)
    assert each.state == S.STANDSTILL and each.column("gear")[-1] == 2


def test_commands_wait_for_the_gear_in_their_order() -> None:
    each = bench()
    each.accepted("select_gear", stage=2)
    waits = "P-WARN-24030 spindle s: {} waits until {}"
    told = each.accepted("start", direction="cw", speed_rpm=600.0)
    assert told == waits.format("start", "the gear change is finished")
    told = each.accepted("set_speed", speed_rpm=900.0)
    assert told == waits.format("set_speed", "the commands before it are carried out")
    each.run(500)
    assert each.column("set_speed_rpm")[-1] == 0.0
    each.accepted("gear_changed")
    each.run(1000)
    assert each.column("set_speed_rpm")[-1] == 900.0


def test_a_waiting_command_that_cannot_be_carried_out_is_told_to_its_source() -> None:
    each = bench()
    each.accepted("select_gear", stage=2, source="one")
    each.accepted("start", direction="cw", speed_rpm=6500.0, source="one")
    each.run(500)
    each.accepted("gear_changed")
    each.run(10)
    text = "spindle s: start refused: speed 6500.0 rpm is above the maximum 6000 rpm of gear 2 (P-AXIS-00212); nothing was changed"
    assert each.event_texts() == [f"P-ERR-24002 {text}"]
    assert each.last.refused == [Refusal("one", 24002, text)]


def test_a_stop_on_the_way_gives_the_change_up_and_clears_what_waits() -> None:
    each = bench()
    each.accepted("select_gear", stage=2)
    each.accepted("start", direction="cw", speed_rpm=600.0)
    each.run(20)
    each.accepted("stop")
    each.run(300)
    assert set(each.column("gear")) == {1} and each.column("set_speed_rpm")[-1] == 0.0
    assert not each.column("gear_change_active")[-1] and each.last.gear_request == 0


def in_change(**changes: Any) -> UnitBench:
    """Turned at 600 rpm; now the PLC is to change the gear, and a command waits for that."""
    each = bench(**changes)
    each.accepted("start", direction="cw", speed_rpm=600.0)
    each.run(200)
    each.accepted("select_gear", stage=2)
    each.run(500)
    each.accepted("set_speed", speed_rpm=700.0)
    assert each.last.gear_request == 2
    return each


def at_rest_in_the_new_gear(each: UnitBench) -> bool:
    """After the acknowledgement of the PLC, and without a cycle in which the spindle moved since the change began."""
    each.accepted("gear_changed")
    begin = each.cycle
    each.run(300)
    return each.column("gear")[-1] == 2 and set(each.column("set_speed_rpm")[begin - 10 :]) == {0.0}


def test_a_stop_while_the_plc_changes_ends_the_rotation_too() -> None:
    each = in_change()
    each.accepted("stop")
    each.run(10)
    assert each.last.gear_request == 2
    assert at_rest_in_the_new_gear(each) and each.state == S.STANDSTILL


def test_a_reset_while_the_plc_changes_gives_the_change_up() -> None:
    each = in_change()
    each.accepted("reset")
    each.run(300)
    assert each.last.gear_request == 0 and set(each.column("set_speed_rpm")[700:]) == {0.0}
    assert each.refused("gear_changed").startswith("P-ERR-24015 ")
    assert set(each.column("gear")) == {1}


@pytest.mark.parametrize("stage", [0, 3, 7, -1])
def test_a_gear_without_a_record(stage: int) -> None:
    assert bench().refusal("select_gear", stage=stage) == refused(24014, gear=stage)


def test_an_acknowledgement_that_nobody_waits_for() -> None:
    each = bench()
    assert each.refusal("gear_changed") == refused(24015)
    each.accepted("select_gear", stage=2)
    each.run(10)
    assert each.refusal("gear_changed") == refused(24015)


def test_a_plc_that_never_acknowledges() -> None:
    each = bench(gear_change_time=0.5)
    each.accepted("select_gear", stage=2)
    each.run(1200)
    asked = first_cycle(each, "state", lambda state: state == S.STANDSTILL)
    assert each.events[0].cycle == asked + 500
    assert each.event_texts() == [
        "P-ERR-24016 spindle s: the PLC has not acknowledged the change to gear 2 within 0.5 s (P-MACH-00051); the spindle "
        "stops on its ramp (ErrorStop)"
    ]
    assert each.state == S.ERROR_STOP and each.column("gear")[-1] == 1
    each.accepted("reset")
    each.accepted("start", direction="cw", speed_rpm=100.0)


def test_the_enable_can_be_removed_while_the_plc_changes() -> None:
    each = in_change()
    each.accepted("power", enabled=False)
    each.run(10)
    assert (each.state, each.last.gear_request) == (S.DISABLED, 2)
    assert each.refusal("start", direction="cw", speed_rpm=600.0) == refused(24003, state="Disabled")
    assert at_rest_in_the_new_gear(each) and each.state == S.DISABLED
    each.accepted("power", enabled=True)
    each.run(100)
    assert each.state == S.STANDSTILL and set(each.column("set_speed_rpm")[700:]) == {0.0}


def test_an_enable_while_the_plc_changes_counts_afterwards() -> None:
    each = in_change()
    each.accepted("power", enabled=False)
    each.accepted("power", enabled=True)
    each.accepted("power", enabled=False)
    assert each.accepted("power", enabled=True) == "spindle s: power on counts when the PLC has changed the gear"
    each.run(10)
    assert each.state == S.DISABLED
    assert at_rest_in_the_new_gear(each) and each.state == S.STANDSTILL


def test_a_gear_change_without_power_can_be_given_up() -> None:
    each = in_change()
    each.accepted("power", enabled=False)
    each.run(10)
    each.accepted("reset")
    each.run(10)
    assert (each.state, each.last.gear_request, each.column("gear")[-1]) == (S.DISABLED, 0, 1)
    assert not each.column("gear_change_active")[-1]


def test_a_plc_that_never_acknowledges_without_power_moves_nothing() -> None:
    """The drive was turned by hand meanwhile: the spindle stays where it is."""
    each = in_change(gear_change_time=1.0)
    each.accepted("power", enabled=False)
    each.run(10)
    each.unit.spindle.loop.control.count_from(70.0)
    each.run(1500)
    assert each.event_texts() == [
        "P-ERR-24016 spindle s: the PLC has not acknowledged the change to gear 2 within 1 s (P-MACH-00051); the spindle "
        "stops on its ramp (ErrorStop)"
    ]
    assert each.column("actual_position_deg")[-1] == 70.0 and set(each.column("drive_output")[710:]) == {0}
    each.accepted("reset")
    each.run(10)
    assert each.state == S.DISABLED


def test_a_gear_change_homes_first_where_there_is_no_reference() -> None:
    each = bench(referenced_at_start=False, zero_pulse=20.0)
    each.accepted("select_gear", stage=2)
    each.run(900)
    assert states(each) == [S.HOMING, S.DISCRETE_MOTION, S.STANDSTILL] and each.last.gear_request == 2


def machine_with_two_gears() -> MachineParameters:
    return replace(MILL, spindles={"s": two_gears(second=SECOND, change_position=45.0)})


def test_the_plc_acknowledges_by_itself_a_block_later() -> None:
    run = MachineBench(scenario="- {at: 0.1, to: s, do: select_gear, stage: 2}", machine=machine_with_two_gears()).run()
    blocks = run.blocks["s"]
    asked = next(n for n, block in enumerate(blocks) if block.gear_request)
    assert blocks[asked + 1].gear[0] == 2 and not blocks[asked + 1].gear_request and not run.failed


def test_a_plc_that_is_asked_to_wait_does_not_acknowledge() -> None:
    scenario = """
- {at: 0.0, to: plc, do: auto_acknowledge, enabled: false}
- {at: 0.1, to: s, do: select_gear, stage: 2}
- {at: 2.0, to: s, do: gear_changed}
"""
    run = MachineBench(scenario=scenario, machine=machine_with_two_gears()).run()
    assert run.column("s", "gear").index(2) == 2000 and not run.failed


def test_a_run_that_waits_for_the_gear_for_ever_is_aborted() -> None:
    machine = machine_with_two_gears()
    spindle = replace(machine.spindles["s"], gear_change_time=0.0)
    scenario = (
        "- {at: 0.0, to: plc, do: auto_acknowledge, enabled: false}\n- {at: 0.1, to: s, do: select_gear, stage: 2}"
    )
    run = MachineBench(scenario=scenario, machine=replace(machine, spindles={"s": spindle})).run()
    assert run.errors()[0] == (
        "P-ERR-22014 plc plc: spindle s waits for the PLC to change to gear 2, but the scenario is finished; everything is "
        "stopped and the run ends"
    )


def test_a_spindle_of_one_gear() -> None:
    assert spindle_bench().accepted("select_gear", stage=1) == "spindle s: gear 1 is selected already"
