"""Refusals of a position compensation; the active motion is unchanged, to the bit."""

from __future__ import annotations

from typing import Any

import pytest
from error_support import refused
from machine_support import UnitBench, axis_bench
from superposition_support import moving_axis, settle

VALUES: dict[str, float] = {
    "length": 4000.0,
    "difference": 250.0,
    "process_velocity": 2000.0,
    "velocity_increase": 300.0,
    "acceleration": 500.0,
    "deceleration": 1000.0,
}


def refusal(bench: UnitBench, **changes: Any) -> str:
    """The text between "compensation_start refused: " and "; nothing was changed", with its number in front."""
    text = bench.refused("compensation_start", **VALUES | changes)
    number, _, rest = text.partition(" axis x: compensation_start refused: ")
    reason, _, end = rest.rpartition("; ")
    assert end == "nothing was changed"
    return f"{number.removeprefix('P-ERR-')} {reason}"


def twins(**arguments: Any) -> tuple[UnitBench, UnitBench]:
    return moving_axis(**arguments), moving_axis(**arguments)


def assert_untouched(bench: UnitBench, twin: UnitBench, cycles: int = 2000) -> None:
    for each in (bench, twin):
        each.run(cycles)
    assert bench.columns() == twin.columns()


# values


@pytest.mark.parametrize("name", ["length", "process_velocity", "velocity_increase", "acceleration", "deceleration"])
@pytest.mark.parametrize("value", [0.0, -0.0, -1.0, -1e300])
def test_values_that_must_be_positive(name: str, value: float) -> None:
    bench, twin = twins()
    assert refusal(bench, **{name: value}) == f"23018 {name} = {value} must be greater than 0"
    assert_untouched(bench, twin, 50)


@pytest.mark.parametrize("name", ["length", "process_velocity", "velocity_increase", "acceleration", "deceleration"])
@pytest.mark.parametrize("value", [5e-324, 1e-300, 9.99e-10, 1.01e12, 1e300])
def test_absurd_scales(name: str, value: float) -> None:
    bench, twin = twins()
    assert refusal(bench, **{name: value}) == f"23018 {name} = {value} must be between 1e-09 and 1e+12"
    assert_untouched(bench, twin, 50)


@pytest.mark.parametrize("name", VALUES)
@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_values_that_are_not_finite(name: str, value: float) -> None:
    bench, twin = twins()
    assert refusal(bench, **{name: value}) == f"22001 {name} = {value} is not finite"
    assert_untouched(bench, twin, 50)


@pytest.mark.parametrize("value", [True, "5", None, [1.0]])
def test_values_that_are_no_numbers(value: Any) -> None:
    assert refusal(moving_axis(), difference=value) == f"22001 difference = {value!r} is not a number"


def test_values_that_are_missing() -> None:
    bench = moving_axis()
    values = {name: value for name, value in VALUES.items() if name != "process_velocity"}
    assert bench.refusal("compensation_start", **values) == refused(22001, argument="process_velocity")


def test_a_difference_of_zero() -> None:
    bench, twin = twins()
    assert refusal(bench, difference=0.0) == "23018 difference = 0 must be different from 0"
    assert_untouched(bench, twin)


@pytest.mark.parametrize("name", ["acceleration", "deceleration"])
def test_accelerations_above_the_maximum(name: str) -> None:
    bench, twin = twins()
    assert (
        refusal(bench, **{name: 50_000.1})
        == f"23013 {name} 50000.1 mm/s² is above the maximum 50000.0 mm/s² (P-AXIS-00008)"
    )
    assert_untouched(bench, twin)


@pytest.mark.parametrize("difference", [1e-320, 5e-324, -5e-324, 1e-15, -1e300, 1.7e308])
def test_absurd_differences_are_spread_or_cut_like_others(difference: float) -> None:
    bench = moving_axis(soft_limit_negative=-1e9, soft_limit_positive=1e9)
    bench.accepted("compensation_start", **VALUES | {"difference": difference})
    settle(bench)
    assert abs(bench.column("set_position")[-1] - 10_000.0) <= 465.0 + 1e-6  # 300·2 - 300²·0.0015
    assert bench.state == 1 and bench.events == []


@pytest.mark.parametrize("name", ["length", "process_velocity", "velocity_increase"])
@pytest.mark.parametrize("value", [1e-9, 1e12])
def test_the_ends_of_the_permitted_range(name: str, value: float) -> None:
    bench = moving_axis()
    bench.accepted("compensation_start", **VALUES | {name: value})
    settle(bench)
    assert abs(bench.column("set_position")[-1] - 10_000.0) <= 250.0 + 1e-6
    assert bench.state == 1 and bench.events == []


# limits of the axis


def test_the_velocity_must_stay_below_the_maximum() -> None:
    bench, twin = twins(max_velocity=2299.0)
    assert refusal(bench, difference=500.0) == (
        "23004 the axis would get up to 2300 mm/s, above the maximum 2299.0 mm/s (P-AXIS-00212)"
    )
    assert_untouched(bench, twin)
    assert "465 mm is used" in moving_axis(max_velocity=2300.0).accepted(
        "compensation_start", **VALUES | {"difference": 500.0}
    )


def test_the_velocity_backwards_too() -> None:
    """w = 8000 - √(64e6 - 36e6) = 2708.5 mm/s is needed for 9000 mm in 4 s: what is left when the basic motion stops."""
    values = {
        "length": 4000.0,
        "difference": -9000.0,
        "process_velocity": 1000.0,
        "velocity_increase": 5000.0,
        "acceleration": 4000.0,
        "deceleration": 4000.0,
    }
    bench, twin = twins(velocity=1000.0, target=50_000.0, max_velocity=2700.0)
    assert refusal(bench, **values) == (
        "23004 the axis would get up to 2708.5 mm/s, above the maximum 2700.0 mm/s (P-AXIS-00212)"
    )
    assert_untouched(bench, twin)
    wide = moving_axis(velocity=1000.0, target=50_000.0, max_velocity=2708.6)
    wide.accepted("compensation_start", **values)
    settle(wide, 60_000)
    assert min(wide.column("set_velocity")) == pytest.approx(-1708.497, abs=1e-3)
    assert wide.column("set_position")[-1] == pytest.approx(41_000.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_velocity_that_the_way_allows_counts(side: float) -> None:
    """v²/A + v·A/J = 200 mm gives 780.776 mm/s, whatever was asked for; w - w²/A = 50 gives w = 50.51 mm/s."""
    values = {"length": 100.0, "difference": 50.0, "process_velocity": 100.0, "velocity_increase": 80.0}
    short = {"target": side * 200.0, "cycles": 50}
    bench = moving_axis(velocity=1000.0, max_velocity=1000.0, **short)
    bench.accepted("compensation_start", **values)
    settle(bench)
    assert 800.0 < max(map(abs, bench.column("set_velocity"))) < 831.3 and bench.events == []
    bench = moving_axis(velocity=830.0, max_velocity=831.2, **short)
    assert bench.refusal("compensation_start", **values) == refused(23004, velocity=831.2866636212369, limit=831.2)


def test_a_velocity_that_is_being_left_counts_too() -> None:
    """A new velocity of 500 mm/s has just been given at 2000 mm/s."""
    bench = moving_axis(max_velocity=2200.0)
    bench.accepted("new_velocity_and_target", velocity=500.0, target=10_000.0, activation_position=0.0)
    assert refusal(bench, difference=500.0) == (
        "23004 the axis would get up to 2300 mm/s, above the maximum 2200.0 mm/s (P-AXIS-00212)"
    )


def test_a_velocity_that_is_to_come_counts_too() -> None:
    """2200 mm/s from 5000 mm on; the compensation would still run there."""
    bench = moving_axis(velocity=1000.0, max_velocity=2400.0)
    change = {"velocity": 2200.0, "target": 10_000.0, "activation_position": 1500.0}
    bench.accepted("new_velocity_and_target", **change)
    assert refusal(bench, difference=2000.0, process_velocity=1000.0) == (
        "23004 the axis would get up to 2500 mm/s, above the maximum 2400.0 mm/s (P-AXIS-00212)"
    )
    bench.accepted("new_target", target=9000.0)  # takes the new velocity back
    bench.accepted("compensation_start", **VALUES | {"difference": 2000.0, "process_velocity": 1000.0})


@pytest.mark.parametrize(
    ("limit", "target", "difference", "text"),
    [
        (
            10_249.0,
            10_000.0,
            250.0,
            "120002 target 10250.0 mm lies beyond the positive soft limit 10249.0 mm (P-AXIS-00178)",
        ),
        (
            -10_249.0,
            -10_000.0,
            250.0,
            "120003 target -10250.0 mm lies beyond the negative soft limit -10249.0 mm (P-AXIS-00177)",
        ),
        (-10.0, 240.0, -300.0, "120003 target -60.0 mm lies beyond the negative soft limit -10.0 mm (P-AXIS-00177)"),
    ],
)
def test_the_end_must_lie_within_the_soft_limits(limit: float, target: float, difference: float, text: str) -> None:
    side = "soft_limit_positive" if limit > 0.0 else "soft_limit_negative"
    cycles, vp = (1000, 2000.0) if abs(target) > 1000.0 else (400, 50.0)
    bench, twin = twins(target=target, velocity=vp, cycles=cycles, **{side: limit})
    assert refusal(bench, difference=difference, process_velocity=vp) == text
    assert_untouched(bench, twin)


def test_the_offset_of_an_earlier_compensation_counts_for_the_soft_limit() -> None:
    bench = moving_axis(target=20_000.0, soft_limit_positive=20_400.0)
    bench.accepted("compensation_start", **VALUES)
    bench.run(2000)
    text = refusal(bench)
    assert text.startswith(("120002 target 20500", "120002 target 20499.9999"))


def test_a_soft_limit_on_the_way_stops_the_axis() -> None:
    """The end lies inside, but the reversal leads beyond the limit: this shows on the way only."""
    bench = moving_axis(target=5000.0, velocity=100.0, cycles=3000, soft_limit_negative=-5.0)
    bench.accepted(
        "compensation_start",
        length=400.0,
        difference=-2000.0,
        process_velocity=100.0,
        velocity_increase=2000.0,
        acceleration=2000.0,
        deceleration=2000.0,
    )
    settle(bench)
    assert bench.state == 7
    (text,) = bench.event_texts()
    assert text.startswith("P-ERR-120003 axis x: set position -5.")
    assert text.endswith(
        " mm is beyond the negative soft limit -5.0 mm (P-AXIS-00177); the axis stops on its own ramp (ErrorStop)"
    )


# states


def test_no_motion() -> None:
    bench = axis_bench()
    assert refusal(bench) == "23021 no basic motion is active (the axis is in Standstill)"
    assert_untouched(bench, axis_bench(), 100)


def test_disabled() -> None:
    assert refusal(axis_bench(powered_at_start=False)) == "23021 no basic motion is active (the axis is in Disabled)"


def test_after_the_motion() -> None:
    bench = settle(moving_axis(target=100.0))
    assert refusal(bench) == "23021 no basic motion is active (the axis is in Standstill)"


def test_error_stop() -> None:
    bench = moving_axis()
    bench.accepted("upstream_lost", source="plc")
    bench.run(10)
    assert refusal(bench) == "23021 no basic motion is active (the axis is in ErrorStop)"


def test_external_setpoints_alone_are_no_basic_motion() -> None:
    bench = axis_bench()
    bench.accepted("external_enable", mode="absolute")
    bench.run(10)
    assert refusal(bench) == "23021 no basic motion is active (the axis is in ContinuousMotion)"


@pytest.mark.parametrize("command", ["stop", "halt"])
def test_in_a_stop_phase(command: str) -> None:
    bench, twin = twins()
    for each in (bench, twin):
        each.accepted(command)
        each.run(100)
    assert refusal(bench) == "23020 the axis is stopping or in its brake phase"
    assert_untouched(bench, twin)


def test_while_a_new_target_waits_for_the_end_of_the_stop() -> None:
    bench, twin = twins()
    for each in (bench, twin):
        each.accepted("stop")
        each.run(100)
        each.accepted("new_target", target=5000.0)
    assert refusal(bench) == "23020 the axis is stopping or in its brake phase"
    assert_untouched(bench, twin)


def test_in_the_natural_brake_phase() -> None:
    """The last 0.5 s of 10000 mm at 2000 mm/s, from cycle 5000 on."""
    bench, twin = twins(cycles=4990)
    assert bench.give("compensation_start", **VALUES | {"difference": 0.001}).accepted
    bench, twin = twins(cycles=5010)
    assert refusal(bench) == "23020 the axis is stopping or in its brake phase"
    assert_untouched(bench, twin)


@pytest.mark.parametrize("after", [0, 200, 499])
def test_in_the_stop_of_a_reversal(after: int) -> None:
    """A new target behind the axis: it stops automatically; during the return a compensation is possible."""
    bench, twin = twins(cycles=2000)
    for each in (bench, twin):
        each.accepted("new_target", target=1000.0)
        each.run(after) if after else None
    assert refusal(bench) == "23020 the axis stops in order to return to its target"
    assert_untouched(bench, twin)


def test_in_the_stop_before_a_target_that_is_too_near() -> None:
    """100 mm ahead of the axis at 2000 mm/s: it passes the target and comes back."""
    bench = moving_axis(cycles=2000)
    bench.accepted("new_target", target=3600.0)
    assert refusal(bench) == "23020 the axis stops in order to return to its target"


def test_on_the_way_back() -> None:
    bench = moving_axis(cycles=2000)
    bench.accepted("new_target", target=-5000.0)
    bench.run(1000)
    assert bench.column("set_velocity")[-1] < -1000.0
    bench.accepted("compensation_start", **VALUES | {"difference": 50.0, "length": 2000.0})
    settle(bench)
    assert bench.column("set_position")[-1] == pytest.approx(-5050.0, abs=1e-9)


def test_while_one_is_active() -> None:
    bench, twin = twins()
    for each in (bench, twin):
        each.accepted("compensation_start", **VALUES)
        each.run(700)
    assert refusal(bench) == "23019 a position compensation is active; it cannot be started again"
    assert_untouched(bench, twin)


def test_a_virtual_axis() -> None:
    bench, twin = twins(virtual=True)
    assert refusal(bench) == "23022 a virtual axis cannot compensate (P-AXIS-00020)"
    assert_untouched(bench, twin)


@pytest.mark.parametrize(
    ("command", "arguments"),
    [
        ("new_target", {"target": 5000.0}),
        ("new_velocity_and_target", {"velocity": 500.0, "target": 5000.0, "activation_position": 4000.0}),
    ],
)
def test_no_new_target_during_a_compensation(command: str, arguments: dict[str, float]) -> None:
    bench, twin = twins()
    for each in (bench, twin):
        each.accepted("compensation_start", **VALUES)
        each.run(700)
    assert bench.refusal(command, **arguments) == refused(23015)
    assert_untouched(bench, twin)


@pytest.mark.parametrize("cycles", [0, 200])
def test_stop_without_a_compensation(cycles: int) -> None:
    bench, twin = axis_bench(), axis_bench()
    for each in (bench, twin):
        each.run(10)
        if cycles:
            each.accepted("move_absolute", target=1000.0)
            each.run(cycles)
    assert bench.accepted("compensation_stop") == (
        "axis x: compensation_stop without effect: no compensation is active"
    )
    assert_untouched(bench, twin, 500)
