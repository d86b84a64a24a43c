"""Outcome of a positioning or a homing, as its action reports it: waiting, active, finished, replaced."""

from __future__ import annotations

from typing import Any

import pytest
from machine_support import UnitBench, spindle_bench
from spindle_support import bench_of, two_gears

ORIENT = ("orient", {"position_deg": 200.0, "speed_rpm": 200.0})
HOME: tuple[str, dict[str, Any]] = ("home", {})
both = pytest.mark.parametrize(("command", "arguments"), [ORIENT, HOME])


def given(bench: UnitBench, command: str, arguments: dict[str, Any]) -> int:
    """Gives the command; its number."""
    number: int = bench.unit.next_number
    bench.accepted(command, **arguments)
    return number


def outcomes(bench: UnitBench, number: int, blocks: int) -> list[bool | None]:
    """After each block, each change once."""
    found: list[bool | None] = []
    for _ in range(blocks):
        bench.run(bench.count)
        outcome = bench.unit.outcome(number)
        if not found or found[-1] is not outcome:
            found.append(outcome)
    return found


@both
def test_one_that_comes_to_its_end(command: str, arguments: dict[str, Any]) -> None:
    bench = spindle_bench()
    number = given(bench, command, arguments)
    assert outcomes(bench, number, 150) == [None, True]
    bench.accepted("start", direction="cw", speed_rpm=500.0)
    bench.run(10)
    assert bench.unit.outcome(number) is True and bench.unit.refusal(number) is None


@both
@pytest.mark.parametrize(
    ("other", "with_words"),
    [
        ("stop", {}),
        ("reset", {}),
        ("power", {"enabled": False}),
        ("upstream_lost", {"source": "clock"}),
    ],
)
def test_one_that_is_overtaken(command: str, arguments: dict[str, Any], other: str, with_words: dict[str, Any]) -> None:
    """On a spindle that has its reference point, and that may be in position later."""
    bench = spindle_bench()
    number = given(bench, command, arguments)
    bench.run(30)
    bench.accepted(other, **with_words)
    assert outcomes(bench, number, 150) == [False]


@pytest.mark.parametrize(
    ("other", "with_words"), [("start", {"direction": "cw", "speed_rpm": 500.0}), ("orient", {"position_deg": 0.0})]
)
def test_a_rotation_and_another_positioning_overtake_a_positioning(other: str, with_words: dict[str, Any]) -> None:
    bench = spindle_bench()
    number = given(bench, *ORIENT)
    bench.run(30)
    bench.accepted(other, **with_words)
    assert outcomes(bench, number, 150) == [False]


@pytest.mark.parametrize("first", [ORIENT, HOME])
def test_a_homing_waits_for_what_is_in_work_and_nothing_but_a_stop_overtakes_it(
    first: tuple[str, dict[str, Any]],
) -> None:
    bench = spindle_bench()
    numbers = [given(bench, *first)]
    bench.run(30)
    numbers += [given(bench, *HOME), given(bench, "start", {"direction": "cw", "speed_rpm": 500.0})]
    assert outcomes(bench, numbers[1], 400) == [None, True] and bench.unit.outcome(numbers[0]) is False
    assert bench.column("speed_reached")[-1] and bench.unit.outcome(numbers[2]) is False


def test_what_does_not_act_overtakes_nothing() -> None:
    bench = spindle_bench()
    number = given(bench, *ORIENT)
    bench.run(30)
    bench.accepted("set_speed", speed_rpm=100.0)
    bench.refused("orient", position_deg=1e12)
    assert outcomes(bench, number, 100) == [None, True]


@both
def test_one_that_waits_for_a_gear(command: str, arguments: dict[str, Any]) -> None:
    bench = bench_of(two_gears())
    bench.accepted("select_gear", stage=2)
    number = given(bench, command, arguments)
    assert outcomes(bench, number, 60) == [None]
    bench.accepted("gear_changed")
    assert outcomes(bench, number, 150) == [None, True]


@both
@pytest.mark.parametrize("other", ["stop", "reset"])
def test_one_that_is_forgotten_while_it_waits(command: str, arguments: dict[str, Any], other: str) -> None:
    bench = bench_of(two_gears())
    bench.accepted("select_gear", stage=2)
    number = given(bench, command, arguments)
    bench.run(600)
    bench.accepted(other)
    assert outcomes(bench, number, 20) == [False] and bench.unit.refusal(number) is None


def test_one_that_is_refused_in_its_turn() -> None:
    bench = bench_of(two_gears(second={"max_speed": 600.0}))
    bench.accepted("select_gear", stage=2)
    number = given(bench, *ORIENT)
    bench.run(600)
    bench.accepted("gear_changed")
    assert outcomes(bench, number, 5) == [False]
    refusal = bench.unit.refusal(number)
    assert (refusal.number, refusal.message) == (
        24002,
        "spindle s: orient refused: speed 200.0 rpm is above the maximum 100 rpm of gear 2 (P-AXIS-00212); nothing was "
        "changed",
    )
