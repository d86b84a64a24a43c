"""Synchronous operation of spindles: commands of the master, carried out by its slaves in the same cycle (2.8.3)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from error_support import Refused, refused
from machine_support import MILL, MachineBench, spindle_bench, spindle_parameters
from spindle_support import two_gears

from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc.spindle_answers import spindle_answers
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import Command, CycleTick, SpindleBlock
from cnc_ptp.spindle.spindle_unit import SpindleUnit

SPINDLES = ("s", "t", "u")


def machine(**changes: Any) -> MachineParameters:
    """The mill with three equal spindles; changes by name of the spindle."""
    spindles = {
        name: replace(spindle_parameters(**changes.get(name, {})), name=name, number=10 + k)
        for k, name in enumerate(SPINDLES)
    }
    return replace(MILL, spindles=spindles, channels={})


def coupled(
    scenario: str = "", *, couple: str = "{at: 0.0, to: t, do: couple, master: s}", **changes: Any
) -> MachineBench:
    return MachineBench(scenario=f"- {couple}\n{scenario}", machine=machine(**changes), end_when_idle=False)


def test_a_slave_starts_stops_and_positions_with_its_master_in_the_same_cycle() -> None:
    scenario = """
- {at: 0.1, to: s, do: start, direction: cw, speed_rpm: 1000.0}
- {at: 0.5, to: s, do: set_speed, speed_rpm: 1500.0}
- {at: 0.9, to: s, do: orient, position_deg: 90.0, speed_rpm: 200.0}
- {at: 1.9, to: s, do: start, direction: ccw, speed_rpm: 300.0}
- {at: 2.2, to: s, do: stop}
"""
    run = coupled(scenario).run(2.5)
    for name in ("set_speed_rpm", "actual_speed_rpm", "mode", "state", "in_position", "set_position_deg"):
        assert run.column("t", name) == run.column("s", name), name
    assert max(run.column("s", "set_speed_rpm")) == 1500.0 and set(run.column("u", "set_speed_rpm")) == {0.0}
    assert [block.master for block in run.blocks["t"][:3]] == ["", "s", "s"]
    assert run.blocks["t"][0].master_wanted == "s" and not run.failed


def test_a_ratio_scales_speeds_and_positions_and_turns_the_direction() -> None:
    scenario = """
- {at: 0.1, to: s, do: start, direction: cw, speed_rpm: 1000.0}
- {at: 0.6, to: s, do: orient, position_deg: 80.0, speed_rpm: 400.0, direction: cw}
"""
    couple = "{at: 0.0, to: t, do: couple, master: s, factor_num: -3, factor_den: 4}"
    run = coupled(scenario, couple=couple).run(2.0)
    assert run.column("t", "set_speed_rpm")[550] == -750.0 and run.column("s", "set_speed_rpm")[550] == 1000.0
    assert run.column("s", "set_position_deg")[-1] % 360.0 == pytest.approx(80.0)
    assert run.column("t", "set_position_deg")[-1] % 360.0 == pytest.approx(360.0 - 60.0)
    assert min(run.column("t", "set_speed_rpm")) == -750.0 and max(run.column("t", "set_speed_rpm")) == 0.0


def test_a_stop_of_the_master_counts_in_the_gear_change_of_a_slave_too() -> None:
    """What the slave was commanded before its master stopped is forgotten with that."""
    each = machine()
    two = {**each.spindles, "t": replace(two_gears(), name="t", number=11)}
    scenario = """
- {at: 0.0, to: plc, do: auto_acknowledge, enabled: off}
- {at: 0.0, to: t, do: select_gear, stage: 2}
- {at: 0.1, to: t, do: couple, master: s}
- {at: 0.2, to: s, do: start, direction: cw, speed_rpm: 1000.0}
- {at: 0.5, to: s, do: stop}
- {at: 0.8, to: t, do: gear_changed}
"""
    run = MachineBench(scenario=scenario, machine=replace(each, spindles=two), end_when_idle=False).run(1.5)
    assert run.refusals() == [] and max(run.column("s", "set_speed_rpm")) == 1000.0
    assert run.last("t").gear[-1] == 2 and set(run.column("t", "set_speed_rpm")) == {0.0}


def test_slaves_stop_when_their_master_loses_its_power_in_a_gear_change() -> None:
    each = machine()
    two = {**each.spindles, "s": replace(two_gears(), number=10)}
    scenario = """
- {at: 0.0, to: plc, do: auto_acknowledge, enabled: off}
- {at: 0.0, to: t, do: couple, master: s}
- {at: 0.1, to: s, do: start, direction: cw, speed_rpm: 500.0}
- {at: 0.5, to: s, do: select_gear, stage: 2}
- {at: 1.0, to: s, do: power, enabled: off}
- {at: 1.5, to: s, do: gear_changed}
"""
    run = MachineBench(scenario=scenario, machine=replace(each, spindles=two), end_when_idle=False).run(2.0)
    assert run.refusals() == [] and run.errors() == []
    assert run.last("s").state[-1] == S.DISABLED and run.last("s").gear[-1] == 2
    assert run.column("t", "set_speed_rpm")[990] == 500.0 and run.last("t").set_speed_rpm[-1] == 0.0


def test_two_slaves_of_one_master() -> None:
    scenario = (
        "- {at: 0.0, to: u, do: couple, master: s}\n- {at: 0.1, to: s, do: start, direction: cw, speed_rpm: 1000.0}"
    )
    run = coupled(scenario).run(0.5)
    assert run.column("t", "set_speed_rpm") == run.column("s", "set_speed_rpm") == run.column("u", "set_speed_rpm")


def test_a_slave_keeps_within_its_own_limits() -> None:
    """Nothing is coupled cycle by cycle: a slower slave takes longer."""
    run = coupled("- {at: 0.1, to: s, do: start, direction: cw, speed_rpm: 1000.0}", t={"acceleration": 9000.0}).run(
        0.4
    )
    assert run.column("s", "set_speed_rpm")[-1] == 1000.0
    assert run.column("t", "set_speed_rpm")[300] == pytest.approx(300.0)


def test_a_slave_takes_no_motion_from_others_but_a_stop() -> None:
    run = coupled("- {at: 0.1, to: s, do: start, direction: cw, speed_rpm: 1000.0}").run(0.5)
    assert run.refusal("t", "start", direction="cw", speed_rpm=5.0) == refused(24022, master="s")
    record = run.give("t", "stop")
    assert record.accepted and record.message == "spindle t: stop ends the coupling to s"
    run.run(0.3)
    assert run.column("t", "set_speed_rpm")[-1] == 0.0 and run.column("s", "set_speed_rpm")[-1] == 1000.0
    assert run.last("t").master == ""
    run.give("s", "set_speed", speed_rpm=400.0)
    run.run(0.3)
    assert run.column("t", "set_speed_rpm")[-1] == 0.0 and run.column("s", "set_speed_rpm")[-1] == 400.0
    assert run.give("t", "start", direction="cw", speed_rpm=5.0).accepted


def test_a_stop_withdraws_a_coupling_that_the_plc_has_not_granted_yet() -> None:
    run = coupled("- {at: 0.1, to: s, do: start, direction: cw, speed_rpm: 1000.0}").run(0.05)
    run.give("t", "decouple")
    run.give("t", "couple", master="s")
    assert run.give("t", "stop").message == "spindle t: stop ends the coupling to s"
    run.run(0.4)
    assert run.last("t").master == "" and not any(run.column("t", "set_speed_rpm"))


def test_after_decoupling_the_spindle_goes_on_alone() -> None:
    scenario = """
- {at: 0.1, to: s, do: start, direction: cw, speed_rpm: 1000.0}
- {at: 0.4, to: t, do: decouple}
- {at: 0.5, to: s, do: stop}
"""
    run = coupled(scenario).run(0.8)
    assert run.column("t", "set_speed_rpm")[-1] == 1000.0 and run.column("s", "set_speed_rpm")[-1] == 0.0
    assert run.last("t").master == ""


def test_a_slave_that_cannot_follow_is_in_error() -> None:
    run = coupled("- {at: 0.1, to: s, do: start, direction: cw, speed_rpm: 5000.0}", t={"max_speed": 6000.0}).run(0.3)
    assert run.errors() == [
        "P-ERR-24025 spindle t: cannot carry out 'start' of its master s: speed 5000.0 rpm is above the maximum 1000 rpm "
        "(P-AXIS-00212); the spindle stops on its ramp (ErrorStop)"
    ]
    assert run.states("t")[-1] == S.ERROR_STOP


def test_against_the_preferred_direction_of_a_slave_its_own_error_counts() -> None:
    run = coupled("- {at: 0.1, to: s, do: start, direction: ccw, speed_rpm: 500.0}", t={"preferred_direction": 1}).run(
        0.3
    )
    assert [error.split(" ")[0] for error in run.errors()] == ["P-ERR-60254"] and run.last("t").error_id[-1] == 60254


def test_an_error_of_the_master_stops_its_slaves() -> None:
    run = coupled("- {at: 0.1, to: s, do: start, direction: cw, speed_rpm: 1000.0}").run(0.5)
    run.give("s", "upstream_lost", source="clock")
    run.run(0.5)
    assert run.errors()[1] == (
        "P-ERR-24026 spindle t: its master s is in error P-ERR-26101; the spindle stops on its ramp (ErrorStop)"
    )
    assert run.column("t", "set_speed_rpm")[-1] == 0.0


def test_a_slave_in_error_does_nothing_of_what_its_master_does() -> None:
    run = coupled().run(0.1)
    run.give("t", "upstream_lost", source="clock")
    run.give("s", "start", direction="cw", speed_rpm=1000.0)
    run.run(0.3)
    assert set(run.column("t", "set_speed_rpm")) == {0.0} and len(run.errors()) == 1


def test_without_its_master_a_slave_stops() -> None:
    run = coupled("- {at: 0.1, to: s, do: start, direction: cw, speed_rpm: 1000.0}").run(0.5)
    run.give("t", "upstream_lost", source="s")
    run.run(0.3)
    assert run.errors()[0].startswith("P-ERR-26101 spindle t: no block of 's' came within the watchdog time")
    assert run.column("t", "set_speed_rpm")[-1] == 0.0


def test_a_reset_of_the_master_stops_its_slaves_too() -> None:
    run = coupled("- {at: 0.1, to: s, do: start, direction: cw, speed_rpm: 1000.0}\n- {at: 0.5, to: s, do: reset}").run(
        1.0
    )
    assert run.column("t", "set_speed_rpm") == run.column("s", "set_speed_rpm") and run.states("t")[-1] == S.STANDSTILL


def test_a_slave_in_its_gear_change_follows_afterwards() -> None:
    """The slave changes its gear first and is coupled then; what its master does waits for the PLC."""
    gears = two_gears(change_position=20.0)
    machine_of_two = replace(machine(), spindles={**machine().spindles, "t": replace(gears, name="t", number=11)})
    scenario = """
- {at: 0.0, to: plc, do: auto_acknowledge, enabled: false}
- {at: 0.0, to: t, do: select_gear, stage: 2}
- {at: 0.0, to: t, do: couple, master: s}
- {at: 0.3, to: s, do: start, direction: cw, speed_rpm: 1000.0}
- {at: 0.6, to: t, do: gear_changed}
"""
    run = MachineBench(scenario=scenario, machine=machine_of_two, end_when_idle=False).run(1.2)
    speeds = run.column("t", "set_speed_rpm")
    assert speeds[599] == 0.0 and speeds[-1] == 1000.0 and run.column("s", "set_speed_rpm")[599] == 1000.0
    assert run.column("t", "gear")[-1] == 2


# ---------------------------------------------------------------- what the master has told a slave in its gear change


def slave_in_gear_change(scenario: str, *, resume: str = "", slowest: float = 72000.0) -> MachineBench:
    """1.5 s: t is coupled to s and waits for the PLC, which changes its gear at 1 s.

    `resume` is what t does before, `slowest` the maximum of the new gear in °/s.
    """
    begin = f"""
- {{at: 0.0, to: plc, do: auto_acknowledge, enabled: off}}
{resume}
- {{at: 0.2, to: t, do: couple, master: s}}
- {{at: 0.2, to: t, do: select_gear, stage: 2}}
- {{at: 1.0, to: t, do: gear_changed}}
"""
    two = {**machine().spindles, "t": replace(two_gears(second={"max_speed": slowest}), name="t", number=11)}
    bench = MachineBench(scenario=begin + scenario, machine=replace(machine(), spindles=two), end_when_idle=False)
    return bench.run(1.5)


START = "- {at: 0.3, to: s, do: start, direction: cw, speed_rpm: 1000.0}\n"
RESUME = "- {at: 0.0, to: t, do: start, direction: cw, speed_rpm: 200.0}"


def test_after_decoupling_a_slave_does_not_do_what_its_master_was_told_before() -> None:
    run = slave_in_gear_change(f"{START}- {{at: 0.6, to: t, do: decouple}}\n- {{at: 0.8, to: s, do: stop}}")
    assert run.refusals() == [] and max(run.column("s", "set_speed_rpm")) == 1000.0
    assert run.last("t").gear[-1] == 2 and set(run.column("t", "set_speed_rpm")) == {0.0}


def test_after_decoupling_a_slave_goes_on_with_what_it_did_itself() -> None:
    run = slave_in_gear_change(f"{START}- {{at: 0.6, to: t, do: decouple}}", resume=RESUME)
    assert run.last("s").set_speed_rpm[-1] == 1000.0
    assert run.last("t").set_speed_rpm[-1] == 200.0 and max(run.column("t", "set_speed_rpm")[1000:]) == 200.0


@pytest.mark.parametrize("resume", ["", RESUME])
@pytest.mark.parametrize(
    ("off_at", "then"), [(0.6, ()), (0.99, ()), (0.6, ("reset",)), (0.6, ("reset", "power, on: on"))]
)
def test_a_slave_does_not_start_after_its_master_was_switched_off(
    resume: str, off_at: float, then: tuple[str, ...]
) -> None:
    """Whether the master is still in error when the gear is changed, or has been reset, without power or with it."""
    commands = "".join(f"- {{at: 0.9, to: s, do: {command}}}\n" for command in then)
    run = slave_in_gear_change(f"{START}- {{at: {off_at}, to: s, do: power, enabled: off}}\n{commands}", resume=resume)
    assert [error.split(" ")[0] for error in run.errors()] == ["P-ERR-24011"]
    assert run.last("t").gear[-1] == 2 and run.last("t").state[-1] == S.STANDSTILL
    assert set(run.column("t", "set_speed_rpm")[600:]) == {0.0}


@pytest.mark.parametrize("resume", ["", RESUME])
def test_a_slave_does_not_start_after_its_master_was_reset_from_an_error(resume: str) -> None:
    """Held by override 0 the master is at a standstill: enable, error and reset come between two blocks."""
    scenario = f"""
- {{at: 0.0, to: s, do: set_override, percent: 0}}
{START}
- {{at: 0.6, to: s, do: power, enabled: off}}
- {{at: 0.6, to: s, do: reset}}
- {{at: 0.6, to: s, do: power, enabled: on}}
"""
    run = slave_in_gear_change(scenario, resume=resume)
    assert run.refusals() == [] and [error.split(" ")[0] for error in run.errors()] == ["P-ERR-24011"]
    assert run.last("s").state[-1] == run.last("t").state[-1] == S.STANDSTILL
    assert set(run.column("t", "set_speed_rpm")[600:]) == {0.0}


def test_a_positioning_of_a_master_without_power_does_not_come_later() -> None:
    """The master has come to its position and was switched off at rest, without an error."""
    scenario = "- {at: 0.3, to: s, do: orient, position_deg: 90.0}\n- {at: 0.9, to: s, do: power, enabled: off}"
    run = slave_in_gear_change(scenario)
    assert run.errors() == [] and run.last("s").set_position_deg[-1] % 360.0 == pytest.approx(90.0)
    assert run.last("s").state[-1] == S.DISABLED and set(run.column("t", "set_speed_rpm")) == {0.0}


def test_what_a_slave_cannot_do_after_its_gear_change_is_an_error_too() -> None:
    run = slave_in_gear_change("- {at: 0.3, to: s, do: start, direction: cw, speed_rpm: 5000.0}", slowest=6000.0)
    assert run.errors() == [
        "P-ERR-24025 spindle t: cannot carry out 'start' of its master s: speed 5000.0 rpm is above the maximum 1000 rpm "
        "of gear 2 (P-AXIS-00212); the spindle stops on its ramp (ErrorStop)"
    ]
    assert set(run.column("t", "set_speed_rpm")) == {0.0}


def test_what_the_plc_tells_the_master_is_acknowledged_by_the_master_alone() -> None:
    run = slave_in_gear_change("- {at: 0.3, to: s, do: start, direction: cw, speed_rpm: 1000.0, source: plc}")
    assert (run.last("s").plc_commands, run.last("s").plc_acknowledged) == (1, 1)
    assert {(block.plc_commands, block.plc_acknowledged) for block in run.blocks["t"]} == {(0, 0)}
    assert run.last("t").set_speed_rpm[-1] == 1000.0


# ---------------------------------------------------------------- what may not be coupled


def not_coupled(run: MachineBench) -> list[str]:
    return [f"P-WARN-{event.error_id} {event.text}" for event in run.events if event.severity == 1]


def test_a_circle_is_not_granted() -> None:
    """Both ask in the same block: the first one gets its master."""
    run = coupled("- {at: 0.0, to: s, do: couple, master: t}").run(0.2)
    assert not_coupled(run) == [
        "P-WARN-24024 spindle t: not coupled to s: s is itself a slave of t; nothing was changed"
    ]
    assert (run.last("s").master, run.last("t").master, run.last("t").master_wanted) == ("t", "", "")


def test_a_chain_is_not_granted_at_either_end() -> None:
    run = coupled("- {at: 0.1, to: u, do: couple, master: t}\n- {at: 0.2, to: s, do: couple, master: u}").run(0.4)
    assert not_coupled(run) == [
        "P-WARN-24024 spindle u: not coupled to t: t is itself a slave of s; nothing was changed",
        "P-WARN-24024 spindle s: not coupled to u: s is itself the master of t; nothing was changed",
    ]


def test_a_master_that_sends_nothing_is_not_granted() -> None:
    answers = spindle_answers({"t": spindle_block("t", "s")}, changes_gears_of=("t",))
    assert [answer.arguments for answer in answers] == [
        {"granted": False, "reason": "nothing is published by spindle s"}
    ]


def spindle_block(name: str, wanted: str) -> SpindleBlock:
    """A block of a spindle that asks for a master."""
    unit = SpindleUnit(replace(spindle_parameters(), name=name), cycle_time=0.001, spindles=(name, wanted))
    unit.command(Command(name, "couple", {"master": wanted}), 0)
    return unit.step(CycleTick(0, 10), {})


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        ({"master": "s"}, refused(24019)),
        ({"master": "x"}, refused(24020, master="x")),
    ],
)
def test_refused_couplings(arguments: dict[str, Any], wanted: Refused) -> None:
    assert spindle_bench().refusal("couple", **arguments) == wanted


def test_more_refusals() -> None:
    run = coupled().run(0.1)
    assert run.refusal("u", "couple", master="s", factor_num=0.0) == refused(24021, argument="factor_num", value=0.0)
    assert run.refusal("t", "couple", master="u") == refused(24027, master="s")
    assert run.refusal("u", "decouple") == refused(24023)


def test_coupling_of_a_turning_spindle_changes_nothing_yet() -> None:
    scenario = """
- {at: 0.0, to: u, do: start, direction: cw, speed_rpm: 500.0}
- {at: 0.3, to: u, do: couple, master: s}
- {at: 0.5, to: s, do: stop}
"""
    run = coupled(scenario).run(1.0)
    assert run.column("u", "set_speed_rpm")[499] == 500.0 and run.column("u", "set_speed_rpm")[-1] == 0.0
