"""Several who command one spindle: channels at once, the PLC in order of arrival with acknowledgements."""

from __future__ import annotations

from typing import Any

import pytest
from channel_spindle_support import two_channels
from error_support import refused
from machine_support import MachineBench, UnitBench, spindle_bench
from spindle_support import bench_of, first_cycle, two_gears

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import Refusal


def per_cycle(bench: UnitBench) -> dict[str, list[Any]]:
    return {name: column for name, column in bench.columns().items() if name not in ("refused", "commands")}


def acknowledged(bench: UnitBench) -> list[tuple[int, int]]:
    """Taken and acknowledged commands of the PLC, each change once."""
    pairs = [(block.plc_commands, block.plc_acknowledged) for block in bench.blocks]
    return [pair for pair, before in zip(pairs, [None, *pairs], strict=False) if pair != before]


MOTION_COMMANDS: list[tuple[str, dict[str, Any]]] = [
    ("start", {"direction": "cw", "speed_rpm": 2000.0}),
    ("set_speed", {"speed_rpm": 2000.0}),
    ("stop", {}),
    ("orient", {"position_deg": 0.0}),
    ("home", {}),
    ("select_gear", {"stage": 1}),
]


@pytest.mark.parametrize(("command", "arguments"), MOTION_COMMANDS)
def test_two_channels_at_once(command: str, arguments: dict[str, Any]) -> None:
    """The first one has the spindle until its speed is reached; then anybody may have it."""
    bench, undisturbed = spindle_bench(), spindle_bench()
    for each in (bench, undisturbed):
        each.accepted("start", direction="cw", speed_rpm=1000.0, source="one")
    assert bench.refusal(command, **arguments, source="two") == refused(24012, owner="one", source="two")
    for each in (bench, undisturbed):
        each.run(100)
    assert per_cycle(bench) == per_cycle(undisturbed)
    assert [(each.source, each.number) for each in bench.blocks[0].refused] == [("two", 24012)]
    assert bench.blocks[1].refused == []
    assert bench.last.source == "one"
    bench.run(200)
    assert bench.column("speed_reached")[-1] and bench.last.source == ""
    bench.accepted(command, **arguments, source="two")


@pytest.mark.parametrize("source", ["", "plc"])
def test_a_stop_of_plc_and_people_is_never_refused(source: str) -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=1000.0, source="one")
    bench.accepted("orient", position_deg=90.0, source="plc")
    bench.run(50)
    assert bench.accepted("stop", **({"source": source} if source else {})) == ""
    bench.run(200)
    assert bench.state == S.STANDSTILL and bench.last.source == "" and not any(bench.column("in_position"))
    assert acknowledged(bench)[-1][0] == acknowledged(bench)[-1][1]


def test_a_command_of_the_plc_takes_its_turn_after_the_channel() -> None:
    """Page 11: sequentially; the channel has its speed first."""
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=1000.0, source="one")
    waits = "P-WARN-24030 spindle s: orient waits until the speed is reached"
    assert bench.accepted("orient", position_deg=90.0, source="plc") == waits
    assert bench.refusal("start", direction="cw", speed_rpm=5.0, source="two") == refused(
        24012, owner="one", source="two"
    )
    bench.run(800)
    reached = first_cycle(bench, "speed_reached", bool, 5)
    assert bench.column("set_speed_rpm")[reached] == pytest.approx(1000.0, rel=0.05)
    assert bench.column("state").index(S.DISCRETE_MOTION) == 10 * (reached // 10 + 1)
    assert bench.column("in_position")[-1] and acknowledged(bench) == [(1, 0), (1, 1)]


def test_a_channel_waits_for_nobody_behind_the_plc() -> None:
    """What a channel says meanwhile is part of its own work; the PLC still comes after it."""
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=1000.0, source="one")
    bench.accepted("start", direction="ccw", speed_rpm=300.0, source="plc")
    assert bench.accepted("set_speed", speed_rpm=1500.0, source="one") == ""
    bench.run(1000)
    assert max(bench.column("set_speed_rpm")) == 1500.0 and bench.column("set_speed_rpm")[-1] == -300.0


def test_the_same_channel_and_people_may_change_what_is_in_work() -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=1000.0, source="one")
    bench.accepted("start", direction="cw", speed_rpm=1500.0, source="one")
    bench.run(50)
    bench.accepted("stop")
    bench.run(100)
    assert bench.state == S.STANDSTILL and bench.last.source == ""


def test_a_channel_has_the_spindle_until_m19_is_done() -> None:
    bench = spindle_bench()
    bench.accepted("orient", position_deg=90.0, source="one")
    bench.run(100)
    assert bench.refusal("start", direction="cw", speed_rpm=5.0, source="two") == refused(
        24012, owner="one", source="two"
    )
    bench.run(200)
    assert bench.column("in_position")[-1]
    bench.accepted("start", direction="cw", speed_rpm=5.0, source="two")


def test_an_error_frees_the_spindle() -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=1000.0, source="one")
    bench.run(50)
    bench.accepted("upstream_lost", source="clock")
    bench.run(100)
    assert bench.last.source == ""
    bench.accepted("reset")
    bench.accepted("start", direction="cw", speed_rpm=100.0, source="two")


def test_the_plc_is_served_in_order_of_arrival() -> None:
    """Page 11: sequentially, and acknowledged when speed and position are there."""
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=1000.0, source="plc")
    waits = "P-WARN-24030 spindle s: {} waits until {}"
    told = bench.accepted("orient", position_deg=90.0, source="plc")
    assert told == waits.format("orient", "the speed is reached")
    told = bench.accepted("start", direction="ccw", speed_rpm=500.0, source="plc")
    assert told == waits.format("start", "the commands before it are carried out")
    bench.run(1200)
    assert acknowledged(bench) == [(3, 0), (3, 1), (3, 2), (3, 3)]
    states = bench.column("state")
    reached = first_cycle(bench, "speed_reached", bool, 5)
    positioned = first_cycle(bench, "in_position", bool)
    assert states.index(S.DISCRETE_MOTION) == 10 * (reached // 10 + 1)  # with the next block
    assert states.index(S.CONTINUOUS_MOTION, positioned) == 10 * (positioned // 10 + 1)
    assert bench.column("set_speed_rpm")[-1] == -500.0


def test_a_stop_of_the_plc_does_not_wait_and_acknowledges_all() -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=1000.0, source="plc")
    bench.accepted("orient", position_deg=90.0, source="plc")
    bench.run(50)
    bench.accepted("stop", source="plc")
    bench.run(200)
    assert bench.state == S.STANDSTILL and acknowledged(bench)[-1] == (3, 3)


def test_a_reset_forgets_what_waits() -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=1000.0, source="plc")
    bench.accepted("orient", position_deg=90.0, source="plc")
    bench.run(50)
    bench.accepted("reset")
    bench.run(200)
    assert bench.state == S.STANDSTILL and acknowledged(bench)[-1] == (2, 2)


def test_a_command_of_the_plc_that_is_refused_in_its_turn() -> None:
    bench = spindle_bench(feedback="SPEED", open_loop=True, referenced_at_start=False)
    bench.accepted("start", direction="cw", speed_rpm=1000.0, source="plc")
    bench.accepted("orient", position_deg=90.0, source="plc")
    bench.run(400)
    text = (
        "the spindle has no actual position (P-AXIS-00320, P-SIM-00050) and cannot be positioned; nothing was changed"
    )
    assert bench.event_texts() == [f"P-ERR-70252 spindle s: orient refused: {text}"]
    assert acknowledged(bench)[-1] == (2, 2) and bench.column("set_speed_rpm")[-1] == 1000.0
    refused = [entry for block in bench.blocks for entry in block.refused]
    assert refused == [Refusal("plc", 70252, f"spindle s: orient refused: {text}")]


# ---------------------------------------------------------------- whose spindle it is


def of_two_gears() -> UnitBench:
    """Turning at 600 rpm for the channel "one"."""
    bench = bench_of(two_gears())
    bench.accepted("start", direction="cw", speed_rpm=600.0, source="one")
    bench.run(400)
    assert bench.last.source == ""
    return bench


@pytest.mark.parametrize(("command", "arguments"), [("select_gear", {"stage": 1}), ("set_speed", {"speed_rpm": 5.0})])
def test_a_command_without_effect_takes_the_spindle_from_nobody(command: str, arguments: dict[str, Any]) -> None:
    bench = of_two_gears()
    if command == "set_speed":
        bench.accepted("stop", source="one")
        bench.run(400)
    assert "spindle s: " in bench.accepted(command, **arguments, source="plc")
    bench.run(10)
    assert (bench.last.source, bench.last.plc_commands, bench.last.plc_acknowledged) == ("", 1, 1)
    assert bench.accepted("stop", source="one", own=True) == ""


def test_a_rotation_that_goes_on_after_the_plc_has_changed_the_gear_is_stopped_by_the_channel_that_began_it() -> None:
    bench = of_two_gears()
    bench.accepted("select_gear", stage=2, source="plc")
    bench.run(600)
    assert bench.last.gear_request == 2
    bench.accepted("gear_changed")
    bench.run(400)
    assert bench.column("set_speed_rpm")[-1] == pytest.approx(600.0)
    assert bench.accepted("stop", source="one", own=True) == ""
    bench.run(600)
    assert bench.state == S.STANDSTILL


def test_a_stop_of_a_spindle_without_power_is_done_at_once() -> None:
    bench = spindle_bench()
    bench.accepted("power", enabled=False)
    bench.run(10)
    bench.accepted("stop", source="plc")
    bench.run(20)
    assert (bench.last.source, bench.last.plc_commands, bench.last.plc_acknowledged) == ("", 1, 1)


def test_what_came_during_a_gear_change_has_its_turn_in_the_order_of_arrival() -> None:
    """The PLC's orient is carried out to its end, then the start of the channel."""
    bench = bench_of(two_gears())
    bench.accepted("select_gear", stage=2)
    bench.run(600)
    bench.accepted("orient", position_deg=100.0, source="plc")
    bench.accepted("start", direction="cw", speed_rpm=300.0, source="one")
    bench.accepted("gear_changed")
    bench.run(1500)
    positioned = first_cycle(bench, "in_position", bool, 610)
    turning = first_cycle(bench, "state", lambda state: state == S.CONTINUOUS_MOTION, 610)
    assert 600 < positioned < turning
    assert bench.column("actual_position_deg")[turning - 1] == pytest.approx(100.0, abs=0.1)
    assert bench.column("speed_reached")[-1]


@pytest.mark.parametrize(
    ("command", "arguments", "by"), [("stop", {}, "stop"), ("power", {"enabled": False}, "power off")]
)
def test_who_has_commanded_a_gear_change_hears_that_it_was_overtaken(
    command: str, arguments: dict[str, Any], by: str
) -> None:
    bench = of_two_gears()
    bench.accepted("select_gear", stage=2, resume=False, source="one")
    bench.run(600)
    assert bench.last.gear_request == 2
    bench.accepted(command, **arguments)
    bench.run(10)
    text = f"spindle s: {by} while the PLC changes the gear for 'one'; the spindle stays at rest"
    assert bench.last.refused == [Refusal("one", 24017, text)]
    assert bench.events[-1].text == text


def test_a_source_that_the_machine_does_not_have() -> None:
    """The PLC and the channels of the machine are known, nobody else."""
    machine = two_channels()
    disturbed, undisturbed = (MachineBench(machine=machine, end_when_idle=False) for _ in range(2))
    for bench in (disturbed, undisturbed):
        assert bench.give("s", "start", direction="cw", speed_rpm=500.0, source="second").accepted
    for command, arguments in MOTION_COMMANDS:
        assert disturbed.refused("s", command, **arguments, source="third") == (
            f"P-ERR-22001 spindle s: {command} refused: unknown source 'third'; nothing was changed. Known: plc, channel, "
            "second"
        )
    for bench in (disturbed, undisturbed):
        bench.run(0.2)
    for name in ("set_speed_rpm", "status_bits", "state"):
        assert disturbed.column("s", name) == undisturbed.column("s", name)
    assert disturbed.give("s", "stop", source="").accepted
