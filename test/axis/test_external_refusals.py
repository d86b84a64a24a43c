"""Refusals of external setpoints, and faults while they move the axis."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest
from error_support import refused
from machine_support import MachineBench, UnitBench, axis_bench
from superposition_support import (
    EXTERNAL,
    A,
    J,
    SetpointRow,
    column,
    external_axis,
    feed,
    generator,
    has_bit,
    moving_axis,
    settle,
)

from cnc_ptp.protocol.axis_states import AxisStateCode as S


def refusal(bench: UnitBench, command: str, **arguments: Any) -> str:
    """Number and reason of a refusal."""
    text = bench.refused(command, **arguments)
    number, _, rest = text.partition(f" axis x: {command} refused: ")
    reason, _, end = rest.rpartition("; ")
    assert end == "nothing was changed"
    return f"{number.removeprefix('P-ERR-')} {reason}"


def constant(velocity: float, *, first_cycle: int, count: int, start: float = 0.0) -> list[SetpointRow]:
    """Setpoints at a constant velocity from `start` on."""
    direction = 1 if velocity > 0.0 else -1
    return [[first_cycle + k, start + velocity * k * 0.001, velocity, 0.0, direction] for k in range(count)]


# enable


@pytest.mark.parametrize("mode", ["absolute", "relative"])
def test_enable_needs_power(mode: str) -> None:
    bench = axis_bench(powered_at_start=False)
    assert refusal(bench, "external_enable", mode=mode) == "23028 the axis is not enabled; power it on"


def test_enable_in_error() -> None:
    bench = moving_axis()
    bench.accepted("upstream_lost", source="plc")
    bench.run(10)
    assert refusal(bench, "external_enable", mode="relative") == "23029 the axis has error 26101; reset it"
    settle(bench)
    assert refusal(bench, "external_enable", mode="absolute") == "23029 the axis has error 26101; reset it"


def test_enable_while_stopping() -> None:
    bench = moving_axis()
    bench.accepted("stop")
    bench.run(10)
    assert refusal(bench, "external_enable", mode="relative") == "23005 the axis is in Stopping"


def test_enable_on_the_path_of_a_channel() -> None:
    bench = MachineBench("%P\nG01 X100 F6000\nM30", end_when_idle=False).run(0.2)
    assert bench.refusal("x", "external_enable", mode="absolute") == refused(23026)
    assert bench.refusal("x", "external_enable", mode="relative", target=12.5) == refused(23026, target=12.5)


def test_only_relative_beside_a_ptp_motion() -> None:
    bench, twin = moving_axis(), moving_axis()
    assert refusal(bench, "external_enable", mode="absolute") == (
        "23026 absolute setpoints are not permitted during a PTP motion; use relative"
    )
    for each in (bench, twin):
        each.run(1000)
    assert bench.columns() == twin.columns()


@pytest.mark.parametrize(("mode", "other"), [("absolute", "relative"), ("relative", "absolute")])
def test_modes_must_match(mode: str, other: str) -> None:
    bench = external_axis(mode)
    assert refusal(bench, "external_enable", mode=other) == (
        f"23025 external setpoints are enabled as {mode}; {other} does not match"
    )


@pytest.mark.parametrize("mode", ["Absolute", "", "both"])
def test_modes_that_do_not_exist(mode: str) -> None:
    assert refusal(axis_bench(), "external_enable", mode=mode) == f"22001 mode = '{mode}' is not absolute or relative"


@pytest.mark.parametrize("target", [float("nan"), float("inf")])
def test_a_target_that_is_not_finite(target: float) -> None:
    text = f"22001 target = {target} is not finite"
    assert refusal(axis_bench(), "external_enable", mode="absolute", target=target) == text


@pytest.mark.parametrize(
    ("mode", "target", "text"),
    [
        ("absolute", 200.1, "120002 target 200.1 mm lies beyond the positive soft limit 200.0 mm (P-AXIS-00178)"),
        ("absolute", -200.1, "120003 target -200.1 mm lies beyond the negative soft limit -200.0 mm (P-AXIS-00177)"),
        ("relative", 50.5, "120002 target 200.5 mm lies beyond the positive soft limit 200.0 mm (P-AXIS-00178)"),
        ("relative", -350.5, "120003 target -200.5 mm lies beyond the negative soft limit -200.0 mm (P-AXIS-00177)"),
    ],
)
def test_a_target_beyond_the_soft_limits(mode: str, target: float, text: str) -> None:
    limits = {"start_position": 150.0, "soft_limit_negative": -200.0, "soft_limit_positive": 200.0}
    bench = axis_bench(**limits)
    assert refusal(bench, "external_enable", mode=mode, target=target) == text
    bench.run(10)
    assert bench.state == S.STANDSTILL and not has_bit(bench, EXTERNAL).any()


@pytest.mark.parametrize(
    ("command", "arguments"),
    [("move_absolute", {"target": 5.0}), ("move_relative", {"distance": 5.0})],
)
@pytest.mark.parametrize("mode", ["absolute", "relative"])
def test_no_ptp_start_beside_external_setpoints(command: str, arguments: dict[str, float], mode: str) -> None:
    bench = external_axis(mode)
    assert refusal(bench, command, **arguments) == (
        "23027 external setpoints are enabled; a PTP start is not permitted at the same time"
    )


def test_disable_without_enable() -> None:
    bench = axis_bench()
    assert bench.accepted("external_disable") == (
        "axis x: external_disable without effect: external setpoints are not enabled"
    )


# setpoints


FIELDS = "cycle, position, velocity, acceleration, direction"


@pytest.mark.parametrize(
    ("rows", "reason"),
    [
        ([[20, 0.0, 0.0, 0.0]], f"a setpoint needs {FIELDS}; [20, 0.0, 0.0, 0.0] has 4 values"),
        ([[]], f"a setpoint needs {FIELDS}; [] has 0 values"),
        ([[20, 0, 0, 0, 1, 1]], f"a setpoint needs {FIELDS}; [20, 0, 0, 0, 1, 1] has 6 values"),
        ([20], f"a setpoint needs {FIELDS}; 20 is not a list of them"),
        ([None], f"a setpoint needs {FIELDS}; None is not a list of them"),
        (["abcde"], f"a setpoint needs {FIELDS}; 'abcde' is not a list of them"),
        ([{"cycle": 1}], f"a setpoint needs {FIELDS}; {{'cycle': 1}} is not a list of them"),
        ([[20, float("nan"), 0, 0, 1]], "position = nan is not a number within ±1e+12"),
        ([[20, 0, float("inf"), 0, 1]], "velocity = inf is not a number within ±1e+12"),
        ([[20, 0, 0, float("-inf"), 1]], "acceleration = -inf is not a number within ±1e+12"),
        ([[20, 1e300, 0, 0, 1]], "position = 1e+300 is not a number within ±1e+12"),
        ([[10**30, 0, 0, 0, 1]], f"cycle = {10**30} is not a number within ±1e+12"),
        ([[20, True, 0, 0, 1]], "position = True is not a number within ±1e+12"),
        ([[20, 0, "5", 0, 1]], "velocity = '5' is not a number within ±1e+12"),
        ([[20, 0, None, 0, 1]], "velocity = None is not a number within ±1e+12"),
        ([[20.5, 0, 0, 0, 1]], "cycle = 20.5 is not a whole number from 0 on"),
        ([[-1, 0, 0, 0, 1]], "cycle = -1 is not a whole number from 0 on"),
        ([[20, 0, 0, 0, 2]], "setpoint of cycle 20: direction = 2 is not one of -1, 0, 1"),
        ([[20, 0, 0, 0, 0.5]], "setpoint of cycle 20: direction = 0.5 is not one of -1, 0, 1"),
        ([[20, 0, 0, 0, 1], [20, 0, 0, 0, 1]], "setpoint of cycle 20: comes after cycle 20; cycles must ascend"),
        ([[20, 0, 0, 0, 1], [19, 0, 0, 0, 1]], "setpoint of cycle 19: comes after cycle 20; cycles must ascend"),
        (
            [[20, 0, 10_000.1, 0, 1]],
            "setpoint of cycle 20: velocity 10000.1 mm/s is above the maximum 10000.0 mm/s (P-AXIS-00212)",
        ),
        (
            [[20, 0, -10_000.1, 0, 1]],
            "setpoint of cycle 20: velocity -10000.1 mm/s is above the maximum 10000.0 mm/s (P-AXIS-00212)",
        ),
        (
            [[20, 0, 0, 50_001.0, 1]],
            "setpoint of cycle 20: acceleration 50001.0 mm/s² is above the maximum 50000.0 mm/s² (P-AXIS-00008)",
        ),
    ],
)
def test_setpoints_are_refused_as_a_whole(rows: list[Any], reason: str) -> None:
    bench, twin = external_axis(), external_axis()
    good = [[15, 0.5, 0.0, 0.0, 1]]
    assert refusal(bench, "external_setpoints", setpoints=[*good, *rows]) == f"23032 {reason}"
    assert refusal(bench, "external_setpoints", setpoints=rows) == f"23032 {reason}"
    for each in (bench, twin):
        each.run(30)
    assert bench.columns() == twin.columns()


def test_setpoints_that_come_after_newer_ones() -> None:
    """Both those that wait and the one that drives the axis count."""
    bench = external_axis()
    bench.accepted("external_setpoints", setpoints=constant(100.0, first_cycle=12, count=20))
    text = "23032 setpoint of cycle 31: comes after cycle 31; cycles must ascend"
    assert refusal(bench, "external_setpoints", setpoints=[[31, 0, 0, 0, 1]]) == text
    bench.run(25)
    assert refusal(bench, "external_setpoints", setpoints=[[31, 0, 0, 0, 1]]) == text
    bench.accepted("external_setpoints", setpoints=[[32, 2.0, 100.0, 0.0, 1]])


@pytest.mark.parametrize("setpoints", [5, "abc", None, {"a": 1}])
def test_setpoints_that_are_no_list(setpoints: Any) -> None:
    bench = external_axis()
    assert (
        refusal(bench, "external_setpoints", setpoints=setpoints)
        == f"22001 setpoints = {setpoints!r} is not a list of rows"
    )


def test_no_setpoints_at_all() -> None:
    bench = external_axis()
    assert bench.accepted("external_setpoints", setpoints=[]) == ""
    bench.run(10)
    assert not column(bench, "set_position").any()


@pytest.mark.parametrize("powered", [True, False])
def test_setpoints_are_ignored_while_not_enabled(powered: bool) -> None:
    bench = axis_bench(powered_at_start=powered)
    rows = constant(100.0, first_cycle=0, count=50)
    warning = "P-WARN-23031 axis x: external_setpoints ignored: external setpoints are not enabled"
    assert bench.accepted("external_setpoints", setpoints=rows) == warning
    bench.run(100)
    assert not column(bench, "set_position").any() and bench.events == []
    assert not has_bit(bench, EXTERNAL).any()


def test_setpoints_during_a_ptp_motion_are_ignored() -> None:
    bench, twin = moving_axis(), moving_axis()
    assert "P-WARN-23031" in bench.accepted("external_setpoints", setpoints=constant(1.0, first_cycle=1000, count=9))
    for each in (bench, twin):
        each.run(500)
    assert bench.columns() == twin.columns()


# monitoring


def assert_stops_on_its_ramp(bench: UnitBench, fault_cycle: int) -> None:
    """ErrorStop from the cycle of the fault on; no step, nothing of the external setpoints left."""
    settle(bench)
    states = bench.column("state")
    assert states.index(S.ERROR_STOP) == fault_cycle and set(states[fault_cycle:]) == {S.ERROR_STOP}
    a = column(bench, "set_acceleration")[fault_cycle + 1 :]
    assert np.abs(np.diff(a)).max() <= J * 0.001 * (1 + 1e-9)
    v = column(bench, "set_velocity")[fault_cycle:]
    assert np.abs(np.diff(v)).max() <= A * 0.001 * (1 + 1e-9)
    assert not has_bit(bench, EXTERNAL)[fault_cycle:].any()
    assert v[-1] == 0.0


@pytest.mark.parametrize("velocity", [500.0, -500.0])
@pytest.mark.parametrize("timeout", [0.2, 0.05])
def test_silence_in_motion(velocity: float, timeout: float) -> None:
    bench = external_axis(external_timeout=timeout)
    feed(bench, constant(velocity, first_cycle=10, count=100), 1000)
    cycles = 109 + round(timeout * 1000) + 1
    assert column(bench, "set_velocity")[10:cycles] == pytest.approx(velocity)
    assert bench.event_texts() == [
        f"P-ERR-23034 axis x: no external setpoint for {timeout * 1000:g} ms while the axis moves; "
        "the axis stops on its own ramp (ErrorStop)"
    ]
    assert_stops_on_its_ramp(bench, cycles)


def test_silence_does_not_speed_up() -> None:
    """The last setpoint accelerates; its acceleration counts for one usual distance of setpoints only."""
    bench = external_axis()
    rows = [[10 + k, 0.5 * 4000.0 * (0.001 * k) ** 2, 4.0 * k, 4000.0, 1] for k in range(100)]
    feed(bench, rows, 150)
    assert column(bench, "set_velocity")[110:] == pytest.approx(400.0)


@pytest.mark.parametrize(("every", "counts"), [(1, 1), (10, 10), (20, 20), (21, 20), (100, 20)])
def test_the_acceleration_of_a_last_setpoint_counts_for_20_ms_at_most(every: int, counts: int) -> None:
    """One usual distance of setpoints, and what is more than 20 ms is a pause."""
    bench = external_axis()
    rows = [[10 + every * k, 0.5 * 800.0 * (0.001 * every * k) ** 2, 0.8 * every * k, 800.0, 1] for k in range(4)]
    feed(bench, rows, 3 * every + 180)
    v = column(bench, "set_velocity")[10 + 3 * every :]
    assert v == pytest.approx(rows[3][2] + 0.8 * np.minimum(np.arange(len(v)), counts))
    assert bench.events == []


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_sum_above_the_maximum(sign: float) -> None:
    """2000 mm/s and a generator that accelerates with 40,000 mm/s²: 2240 mm/s in the sixth cycle of its ramp."""
    bench = moving_axis(target=sign * 20_000.0, max_velocity=2210.0)
    bench.accepted("external_enable", mode="relative")
    feed(bench, generator(sign * 300.0, first_cycle=1000, velocity=1000.0, a=40_000.0), 200)
    (text,) = bench.event_texts()
    assert text == (
        "P-ERR-23036 axis x: the superimposed motions would add up to 2240 mm/s, above the maximum 2210.0 mm/s "
        "(P-AXIS-00212); the axis stops on its own ramp (ErrorStop)"
    )
    assert_stops_on_its_ramp(bench, 1007)
    assert np.abs(column(bench, "set_velocity")).max() == pytest.approx(2200.0)


@pytest.mark.parametrize("seed", range(8))
def test_the_maximum_is_never_exceeded_before_the_fault(seed: int) -> None:
    """Whatever the generator adds and wherever the axis is on its ramps: |v| stays, the fault takes its one ramp."""
    choice = random.Random(seed)
    sign, added = choice.choice([1.0, -1.0]), choice.uniform(2000.0, 40_000.0)
    highest = choice.uniform(2010.0, 2800.0)
    bench = moving_axis(target=sign * 20_000.0, max_velocity=highest, cycles=10 * choice.randint(30, 90))
    begin = bench.cycle
    bench.accepted("external_enable", mode="relative")
    feed(bench, generator(sign * 800.0, first_cycle=begin, velocity=1000.0, a=added), 900)
    settle(bench)
    assert [text[:11] for text in bench.event_texts()] == ["P-ERR-23036"]
    v = column(bench, "set_velocity")
    assert np.abs(v).max() <= highest * (1.0 + 1e-9)
    assert (np.abs(np.diff(v)) <= (A + added) * 0.001 * (1.0 + 1e-9)).all()
    p = column(bench, "set_position")
    distance = np.diff(p) - 0.0005 * (v[1:] + v[:-1])
    assert (np.abs(distance) <= 0.25 * (A + added) * 1e-6 + 1e-9).all()


def test_silence_at_rest_is_no_fault() -> None:
    bench = external_axis()
    feed(bench, generator(600.0, first_cycle=20)[:-2], 3000)
    assert bench.state == S.CONTINUOUS_MOTION and bench.events == []
    assert bench.column("set_position")[-1] == 600.0


def test_a_setpoint_every_200_ms_is_no_silence() -> None:
    bench = external_axis()
    rows = [[10 + 200 * k, 20.0 * k, 100.0, 0.0, 1] for k in range(10)]
    feed(bench, rows, 1900)
    assert bench.events == []
    assert column(bench, "set_position")[10:1900] == pytest.approx(0.1 * np.arange(1890), abs=1e-9)


@pytest.mark.parametrize("mode", ["absolute", "relative"])
def test_a_first_setpoint_that_is_too_far(mode: str) -> None:
    """10 m/s is 10 mm a cycle."""
    bench = external_axis(mode)
    bench.accepted("external_setpoints", setpoints=[[12, 10.0, 0.0, 0.0, 1]])
    bench.run(5)
    assert bench.column("set_position")[-1] == 10.0
    bench = external_axis(mode)
    bench.accepted("external_setpoints", setpoints=[[12, -10.001, 0.0, 0.0, -1], [13, 0.0, 0.0, 0.0, 1]])
    bench.run(50)
    assert not column(bench, "set_position").any()
    assert bench.event_texts() == [
        "P-ERR-23033 axis x: external setpoint -10.001 mm is 10.001 mm away, more than the axis can move in a cycle at 10000.0 mm/s "
        "(P-AXIS-00212); the axis stops on its own ramp (ErrorStop)"
    ]
    assert bench.column("state")[12] == S.ERROR_STOP


def test_a_jump_in_motion() -> None:
    """The jump itself is not taken over; the axis stops from where it would have gone."""
    bench = external_axis()
    rows = constant(500.0, first_cycle=10, count=50)
    rows += constant(500.0, first_cycle=60, count=50, start=125.0)
    feed(bench, rows, 200)
    (text,) = bench.event_texts()
    assert text.startswith("P-ERR-23033 axis x: external setpoint 125.0 mm is 100.5 mm away, more than ")
    assert_stops_on_its_ramp(bench, 60)
    assert column(bench, "set_position").max() < 25.0 + 0.5 * 500.0 * 0.5


@pytest.mark.parametrize("late", [20, 150])
def test_a_late_setpoint_is_no_way_round_the_jump(late: int) -> None:
    """At 1000 mm/s and more than 10 ms late it would lead the axis on by more than 10 mm in one cycle."""
    bench = external_axis(cycles=200)
    bench.accepted("external_setpoints", setpoints=[[200 - late, 0.0, 1000.0, 0.0, 1]])
    bench.run(10)
    assert "P-ERR-23033 axis x: external setpoint 0.0 mm is" in bench.event_texts()[0]
    assert not column(bench, "set_position").any()


def test_setpoints_far_apart_must_not_jump_either() -> None:
    """50 mm in one step after 50 ms without velocity: more than the axis gets in the cycle in which it comes."""
    bench = external_axis()
    feed(bench, [[10, 0.0, 0.0, 0.0, 1], [60, 50.0, 0.0, 0.0, 1]], 100)
    assert "is 50 mm away" in bench.event_texts()[0]


@pytest.mark.parametrize(("side", "number", "which"), [(1.0, 120002, "positive"), (-1.0, 120003, "negative")])
def test_soft_limits_on_the_fly(side: float, number: int, which: str) -> None:
    """At 300 mm/s beyond ±30 mm in cycle 111: 30.3 mm."""
    bench = external_axis(soft_limit_negative=-30.0, soft_limit_positive=30.0)
    feed(bench, constant(side * 300.0, first_cycle=10, count=300), 300)
    parameter = "P-AXIS-00178" if side > 0.0 else "P-AXIS-00177"
    (text,) = bench.event_texts()
    assert text.startswith(f"P-ERR-{number} axis x: set position {side * 30.3:.1f}")
    assert text.endswith(
        f" mm is beyond the {which} soft limit {side * 30.0} mm ({parameter}); the axis stops on its own ramp (ErrorStop)"
    )
    assert_stops_on_its_ramp(bench, 111)


def test_a_way_back_from_beyond_a_soft_limit_is_permitted() -> None:
    bench = external_axis(start_position=35.0, soft_limit_positive=30.0)
    feed(bench, constant(-100.0, first_cycle=10, count=100, start=35.0), 105)
    assert bench.events == []


def test_soft_limits_of_the_superposition() -> None:
    """Neither of the two alone would get there."""
    bench = moving_axis(target=1000.0, cycles=500, soft_limit_positive=1100.0)
    bench.accepted("external_enable", mode="relative")
    feed(bench, generator(300.0, first_cycle=520, velocity=500.0), 2000)
    assert bench.event_texts()[0].startswith("P-ERR-120002 axis x: set position 1100.")
    assert bench.state == S.ERROR_STOP
    settle(bench)
