"""Homing is finished before later commands, and reported when it is aborted; the states are those of the graphs."""

from __future__ import annotations

import random
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest
from channel_spindle_support import moves, told, two_channels
from long_support import long
from machine_support import ROOT, MachineBench, UnitBench, changed_gear, spindle_bench, spindle_parameters
from spindle_support import RPM, assert_reached_in_windows, bench_of, first_cycle, states, two_gears

from cnc_ptp.parameters import MachineParameters, SpindleParameters, read_machine
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.spindle_states import SpindleBit

WAITS = "P-WARN-24030 spindle s: {} waits until {}"
HOMED, IN_TURN = "the homing is finished", "the commands before it are carried out"
NO_REFERENCE, OLD_REFERENCE = "there is no reference point", "the previous reference point remains valid"


def given_up(by: str, number: int, reference: str = NO_REFERENCE, spindle: str = "s") -> str:
    return (
        f"P-ERR-24028 spindle {spindle}: {by} before the zero pulse, homing (command {number}) is aborted; {reference}"
    )


def unreferenced(**changes: Any) -> UnitBench:
    return spindle_bench(referenced_at_start=False, zero_pulse=33.25, **changes)


# ---------------------------------------------------------------- programs


def machine_of(name: str, referenced: bool) -> MachineParameters:
    """An example machine with an axis to wait for the spindle."""
    machine = read_machine(ROOT / "examples" / "spindles" / f"{name}.yaml")
    spindle = replace(machine.spindles["s1"], referenced_at_start=referenced, zero_pulse=120.0)
    return replace(machine, spindles={"s1": spindle})


@pytest.mark.parametrize("machine", ["nc_spindle", "position_feedback"])
@pytest.mark.parametrize("referenced", [True, False])
@pytest.mark.parametrize("between", ["", "N15 G04 0.1\n"])
@pytest.mark.parametrize("words", ["M3 S100", *long(["M4 S250"])])
def test_g74_and_the_rotation_after_it(machine: str, referenced: bool, between: str, words: str) -> None:
    """The issue: without a dwell G74 never came into Homing, with one Homing went straight to ContinuousMotion."""
    program = f"%P\nN10 G74 S1\n{between}N20 {words}\nN30 G01 Z1 F1000\nN40 M5\nM30"
    bench = MachineBench(program, machine=machine_of(machine, referenced)).run()
    assert not bench.failed and bench.events == []
    assert not any(record.message for record in bench.records)
    expected = [S.HOMING, S.STANDSTILL, S.CONTINUOUS_MOTION, S.STOPPING, S.STANDSTILL]
    assert [state for k, state in enumerate(bench.states("s1")) if k or state != S.STANDSTILL] == expected
    assert bench.last("s1").referenced[-1]
    (first, _) = moves(bench)[0]
    assert bench.column("s1", "speed_reached")[first - 1] and bench.column("s1", "state")[first] == S.CONTINUOUS_MOTION


@pytest.mark.parametrize("words", ["M19 S60 S.POS45", "M19 S60 S.POS45 M4", "M5"])
def test_g74_and_other_functions_after_it(words: str) -> None:
    machine = machine_of("nc_spindle", False)
    bench = MachineBench(f"%P\nN10 G74 S1\nN15 G04 0.05\nN20 {words}\nN30 G01 Z1 F1000\nM30", machine=machine).run()
    assert not bench.failed
    after = [S.STOPPING] if words == "M5" else [S.STANDSTILL, S.DISCRETE_MOTION]
    passed = bench.states("s1")
    assert passed[passed.index(S.HOMING) :] == [S.HOMING, *after, S.STANDSTILL]
    assert [event.error_id for event in bench.events] == ([24028] if words == "M5" else [])
    if words.startswith("M19"):
        assert bench.last("s1").actual_position_deg[-1] % 360.0 == pytest.approx(45.0, abs=0.05)


def test_a_digital_spindle_homes_first_and_then_goes_to_m19() -> None:
    """Before, M19 found no reference point and was an error (24007)."""
    machine = machine_of("nc_spindle", False)
    spindles = {"s1": replace(machine.spindles["s1"], automatic_homing=False)}
    bench = MachineBench("%P\nG74 S1\nM19 S60 S.POS45\nM30", machine=replace(machine, spindles=spindles)).run()
    assert not bench.failed and bench.errors() == []
    assert [s for s in bench.states("s1") if s != S.STANDSTILL] == [S.HOMING, S.DISCRETE_MOTION]


@pytest.mark.parametrize("at", [0.05, 0.12])
def test_a_reset_tells_that_the_homing_is_lost(at: float) -> None:
    """And the rotation that waits for it no longer begins."""
    scenario = f"- {{at: {at}, to: channel, do: reset}}\n"
    bench = MachineBench(
        "%P\nG74 S1\nM3 S100\nG01 Z1 F1000\nM30", scenario, machine=machine_of("nc_spindle", False)
    ).run()
    texts = [f"P-ERR-{event.error_id} {event.text}" for event in bench.events if event.error_id == 24028]
    assert texts == [given_up("stop", 1, spindle="s1")]
    assert bench.states("s1")[-2:] == [S.STOPPING, S.STANDSTILL] and S.CONTINUOUS_MOTION not in bench.states("s1")
    assert moves(bench) == [] and [command for command, _ in told(bench, "s1")] == ["home", "start", "stop"]


def test_another_channel_is_told_whose_the_spindle_is() -> None:
    machine = two_channels()
    parts = {name: replace(spindle, referenced_at_start=False) for name, spindle in machine.spindles.items()}
    bench = MachineBench("%P\nG74 S1\nM3 S100\nM5\nM30", machine=replace(machine, spindles=parts)).run(0.05)
    assert bench.refused("s", "start", direction="cw", speed_rpm=5.0, source="second").startswith(
        "P-ERR-24012 spindle s: "
    )
    bench.run()
    assert S.CONTINUOUS_MOTION in bench.states("s")


# ---------------------------------------------------------------- the spindle alone


COMMANDS: list[tuple[str, dict[str, Any], list[S]]] = [
    ("start", {"direction": "cw", "speed_rpm": 300.0}, [S.CONTINUOUS_MOTION]),
    ("orient", {"position_deg": 12.0}, [S.DISCRETE_MOTION, S.STANDSTILL]),
    ("home", {}, [S.HOMING, S.STANDSTILL]),
    ("select_gear", {"stage": 2}, [S.DISCRETE_MOTION, S.STANDSTILL]),
]


@pytest.mark.parametrize("source", ["", "one", "plc"])
@pytest.mark.parametrize("automatic", [True, False])
@pytest.mark.parametrize(("command", "arguments", "after"), COMMANDS)
def test_what_comes_during_a_homing_waits(
    command: str, arguments: dict[str, Any], after: list[S], automatic: bool, source: str
) -> None:
    parameters = two_gears(referenced_at_start=False, zero_pulse=33.25, automatic_homing=automatic)
    bench = bench_of(parameters)
    by = {"source": source} if source else {}
    bench.accepted("home", **by)
    bench.run(50)
    assert bench.accepted(command, **arguments, **by) == ("" if source == "one" else WAITS.format(command, HOMED))
    bench.run(10)
    assert bench.state == S.HOMING and bench.last.status_bits[-1] & SpindleBit.ORDERS_WAIT
    bench.run(2500)
    assert states(bench) == [S.HOMING, S.STANDSTILL, *after] and bench.last.referenced[-1] and bench.events == []


def test_a_speed_alone_has_no_effect_on_a_homing_and_counts_behind_the_m3_that_waits() -> None:
    bench = unreferenced()
    bench.accepted("home")
    bench.run(10)
    assert bench.accepted("set_speed", speed_rpm=50.0) == "spindle s: set_speed without effect in Homing"
    bench.accepted("start", direction="cw", speed_rpm=300.0)
    assert bench.accepted("set_speed", speed_rpm=400.0) == WAITS.format("set_speed", IN_TURN)
    bench.run(1800)
    assert states(bench) == [S.HOMING, S.STANDSTILL, S.CONTINUOUS_MOTION]
    assert bench.column("set_speed_rpm")[-1] == 400.0


def test_m3_during_an_automatic_homing_lets_it_find_its_pulse() -> None:
    """M19 without reference: the homing is finished, the positioning after it is overtaken as figure 9 has it."""
    bench = unreferenced()
    bench.accepted("orient", position_deg=100.0, speed_rpm=200.0)
    bench.run(50)
    assert bench.accepted("start", direction="cw", speed_rpm=300.0) == WAITS.format("start", HOMED)
    bench.run(2000)
    assert states(bench) == [S.HOMING, S.DISCRETE_MOTION, S.CONTINUOUS_MOTION] and bench.last.referenced[-1]


def test_g74_waits_for_a_positioning() -> None:
    """No graph has an arrow from DiscreteMotion to Homing."""
    for automatic in (True, False):
        bench = spindle_bench(automatic_homing=automatic)
        bench.accepted("orient", position_deg=170.0, speed_rpm=200.0)
        bench.run(30)
        assert bench.accepted("home") == WAITS.format("home", "the positioning is finished")
        bench.run(2000)
        assert states(bench) == [S.DISCRETE_MOTION, S.STANDSTILL, S.HOMING, S.STANDSTILL]


def test_under_an_open_loop_the_homing_of_m19_is_homing_from_its_begin() -> None:
    """Before: DiscreteMotion, Homing, DiscreteMotion."""
    open_loop = {"open_loop": True, "feedback": "POSITION", "digits_per_deg_s": 60 / 0.036}
    switched = {"velocity_control_on": 1200.0 * RPM, "velocity_control_off": 300.0 * RPM}
    for changes in (open_loop, switched):
        bench = unreferenced(**changes)
        bench.accepted("start", direction="cw", speed_rpm=2000.0)
        bench.run(500)
        bench.accepted("orient", position_deg=100.0, speed_rpm=200.0)
        bench.run(3500)
        assert states(bench) == [S.CONTINUOUS_MOTION, S.HOMING, S.DISCRETE_MOTION, S.STANDSTILL]
        assert bench.last.in_position[-1]


@pytest.mark.parametrize("by", ["stop", "reset"])
def test_what_gives_a_homing_up_is_told(by: str) -> None:
    for referenced, reference in ((False, NO_REFERENCE), (True, OLD_REFERENCE)):
        bench = spindle_bench(referenced_at_start=referenced, zero_pulse=33.25)
        bench.accepted("start", direction="cw", speed_rpm=60.0)
        bench.accepted("home")
        bench.run(20)
        bench.accepted(by)
        bench.run(200)
        assert bench.event_texts() == [given_up(by, 2, reference)]
        assert states(bench)[-3:] == [S.HOMING, S.STOPPING, S.STANDSTILL]
        assert bench.last.referenced[-1] is referenced


def test_homings_that_wait_are_told_too_and_one_whose_pulse_has_come_is_not() -> None:
    bench = bench_of(two_gears(zero_pulse=33.25))
    bench.accepted("select_gear", stage=2)
    bench.accepted("home")
    bench.accepted("home", source="plc")
    bench.accepted("stop")
    bench.run(300)
    assert bench.event_texts() == [given_up("stop", 2, OLD_REFERENCE), given_up("stop", 3, OLD_REFERENCE)]
    bench = unreferenced()
    bench.accepted("home")
    while not bench.unit.spindle.referenced:
        bench.run(1)
    bench.accepted("stop")
    bench.run(300)
    assert bench.events == [] and bench.last.referenced[-1]


def test_a_slave_tells_its_own_loss() -> None:
    bench = MachineBench(
        "%P\n#SET AX LINK [1, S2=S]\n#ENABLE AX LINK [1]\nG74 S1\nG04 0.05\nM5\nM30", machine=coupled()
    ).run()
    texts = [f"P-ERR-{event.error_id} {event.text}" for event in bench.events]
    assert sorted(texts) == [given_up("stop", 1, spindle="s"), given_up("stop", 0, spindle="t")]


def coupled() -> MachineParameters:
    machine = two_channels()
    parts = {name: replace(spindle, referenced_at_start=False) for name, spindle in machine.spindles.items()}
    return replace(machine, spindles=parts)


# ---------------------------------------------------------------- a fault frees the spindle at once


def test_a_fault_ends_the_work_for_a_source_at_once() -> None:
    """Not with the next cycle: a command in the same block is notified of the error, not of a work that has ended (24012)."""
    for fault, words in (("upstream_lost", {"source": "clock"}), ("power", {"enabled": False})):
        bench = spindle_bench()
        bench.accepted("start", direction="cw", speed_rpm=1000.0, source="one")
        bench.accepted("orient", position_deg=5.0, source="plc")
        bench.run(50)
        bench.accepted(fault, **words)
        assert bench.refused("start", direction="cw", speed_rpm=5.0, source="two").startswith("P-ERR-24003 ")
        bench.run(bench.count)
        assert (bench.blocks[-1].source, bench.blocks[-1].plc_acknowledged) == ("", 1)
        assert not bench.blocks[-1].status_bits[0] & SpindleBit.ORDERS_WAIT


def test_a_refusal_with_an_error_frees_the_spindle_at_once() -> None:
    bench = spindle_bench(preferred_direction=1)
    bench.accepted("start", direction="cw", speed_rpm=1000.0, source="one")
    assert bench.refused("start", direction="ccw", speed_rpm=5.0, source="one").startswith("P-ERR-60254 ")
    assert bench.refused("start", direction="cw", speed_rpm=5.0, source="two").startswith("P-ERR-24003 ")
    assert bench.unit.step.__self__._queue.source == ""


def test_a_fault_in_a_cycle_frees_the_spindle_in_it() -> None:
    limits = {"following_error_monitoring": True, "following_error_limit": 10.0}
    bench = spindle_bench(count=1, **limits)
    bench.accepted("start", direction="cw", speed_rpm=3000.0, source="one")
    while bench.unit.spindle.state != S.ERROR_STOP:
        assert not bench.blocks or bench.last.source == "one"
        bench.run(1)
    assert bench.last.source == ""


# ---------------------------------------------------------------- any mix of commands


ANALOGUE: dict[S, set[S]] = {
    S.STANDSTILL: {S.CONTINUOUS_MOTION, S.DISCRETE_MOTION, S.HOMING, S.STOPPING, S.DISABLED},
    S.CONTINUOUS_MOTION: {S.STOPPING, S.DISCRETE_MOTION, S.HOMING},
    S.STOPPING: {S.STANDSTILL, S.CONTINUOUS_MOTION, S.DISCRETE_MOTION, S.HOMING},
    S.DISCRETE_MOTION: {S.CONTINUOUS_MOTION, S.STANDSTILL, S.STOPPING},
    S.HOMING: {S.DISCRETE_MOTION, S.STANDSTILL, S.STOPPING},
    S.ERROR_STOP: {S.STANDSTILL, S.DISABLED},
    S.DISABLED: {S.STANDSTILL},
}
"""Figure 9. Stopping is the way of M5 to Standstill, with the arrows of Standstill; a fault leads to ErrorStop."""
DIGITAL = {
    **ANALOGUE,
    S.CONTINUOUS_MOTION: {S.STOPPING, S.DISCRETE_MOTION},
    S.STOPPING: {S.STANDSTILL, S.CONTINUOUS_MOTION, S.DISCRETE_MOTION},
    S.HOMING: {S.STANDSTILL, S.STOPPING},
}
"""Figure 10: homing from standstill to standstill."""


def of_two_gears(parameters: SpindleParameters) -> SpindleParameters:
    first = parameters.gears[1]
    return replace(parameters, gears={1: first, 2: changed_gear(first, stage=2, max_speed=600.0 * RPM, kv=40.0)})


KINDS: dict[str, tuple[dict[S, set[S]], dict[str, Any]]] = {
    "analogue": (ANALOGUE, {"control_limit": 1000.0 * RPM}),
    "digital": (
        DIGITAL,
        {"automatic_homing": False, "velocity_control_on": 900.0 * RPM, "velocity_control_off": 300.0 * RPM},
    ),
    "controlled": (ANALOGUE, {"open_loop": True, "feedback": "POSITION", "digits_per_deg_s": 60 / 0.036}),
    "preferred": (ANALOGUE, {"preferred_direction": 1, "control_limit": 500.0 * RPM}),
}


OTHERS = ("set_override", "reset", "power", "upstream_lost")


def any_command(draw: random.Random) -> tuple[str, dict[str, Any]]:
    name = draw.choice(
        (
            "start",
            "start",
            "orient",
            "orient",
            "home",
            "home",
            "stop",
            "set_speed",
            "select_gear",
            "gear_changed",
            *OTHERS,
        )
    )
    arguments: dict[str, dict[str, Any]] = {
        "start": {"direction": draw.choice(("cw", "cw", "ccw")), "speed_rpm": draw.uniform(0.0, 1500.0)},
        "orient": {"position_deg": draw.uniform(0, 360), "speed_rpm": draw.uniform(20.0, 400.0)},
        "set_speed": {"speed_rpm": draw.uniform(0.0, 1500.0)},
        "select_gear": {"stage": draw.choice((1, 2))},
        "set_override": {"percent": draw.choice((0.0, 50.0, 100.0, 100.0))},
        "power": {"enabled": draw.random() < 0.8},
        "upstream_lost": {"source": "clock"},
    }
    given = arguments.get(name, {})
    if name in ("start", "orient", "home", "stop", "set_speed", "select_gear") and draw.random() < 0.5:
        given = {**given, "source": draw.choice(("one", "two", "plc"))}
    return name, given


def followed(bench: UnitBench, draw: random.Random, commands: int) -> list[S]:
    """The states after each command and each cycle, in their order."""
    passed = [bench.unit.spindle.state]
    for _ in range(commands):
        name, arguments = any_command(draw)
        bench.give(name, **arguments)
        passed.append(bench.unit.spindle.state)
        for _ in range(draw.choice((0, 1, 30, 200, 600))):
            bench.run(1)
            passed.append(bench.unit.spindle.state)
        if bench.unit.spindle.state == S.ERROR_STOP and draw.random() < 0.7:
            bench.run(400)
            bench.give("reset")
            passed.append(bench.unit.spindle.state)
        if bench.unit.spindle.state == S.DISABLED:
            bench.give("power", enabled=True)
            passed.append(bench.unit.spindle.state)
    return passed


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [0, *long([1, 2])])
def test_seeded_commands_go_along_the_arrows_only(kind: str, seed: int) -> None:
    table, changes = KINDS[kind]
    draw = random.Random(f"{kind} {seed}")
    parameters = of_two_gears(
        spindle_parameters(
            referenced_at_start=draw.random() < 0.5,
            zero_pulse=draw.uniform(0, 360),
            zero_speed=RPM,
            drive_time_constant=draw.choice((0.0, 0.004, 0.01)),
            kv=draw.uniform(30.0, 60.0),
            encoder_increment=0.0,
            **changes,
        )
    )
    bench = bench_of(parameters, count=1)
    passed = followed(bench, draw, 20)
    for before, after in pairwise(passed):
        assert before == after or after == S.ERROR_STOP or after in table[before], (S(before).name, S(after).name)
    assert_reached_in_windows(bench, window=0.05, zero_rpm=1.0, hold=20)
    assert first_cycle(bench, "state", lambda state: state != S.STANDSTILL) >= 0
