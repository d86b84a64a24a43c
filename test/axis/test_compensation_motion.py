"""Position compensation of an axis: what is compensated, when and how smoothly (TX1250 2.5)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from long_support import long
from machine_support import CYCLE_TIME, UnitBench, axis_bench
from scipy.integrate import simpson
from scipy.optimize import brentq
from superposition_support import (
    COMPENSATING,
    HAS_JOB,
    A,
    J,
    assert_no_steps,
    basic_velocity,
    column,
    has_bit,
    moving_axis,
    settle,
    start_ramp,
)

VALUES: dict[str, float] = {
    "length": 4000.0,
    "difference": 250.0,
    "process_velocity": 2000.0,
    "velocity_increase": 300.0,
    "acceleration": 500.0,
    "deceleration": 1000.0,
}
SECONDS = 2.0
SMOOTH = {"acceleration": A * 1.15 + 1000.0, "jerk": J * 1.15 + 2.0 * 1000.0 * A / 2000.0}
"""With w·v/VP on top: a' = a·(1 + w/VP) + AK, j' = j·(1 + w/VP) + 2·AK·a/VP for w <= 300 mm/s, VP = 2000 mm/s."""


def compensate(bench: UnitBench, **changes: float) -> str:
    return bench.accepted("compensation_start", **VALUES | changes)


def shape(
    t: np.ndarray, distance: float, seconds: float, first: float, last: float, increase: float = 1e9
) -> np.ndarray:
    """Velocity w(t) >= 0 of the trapezoid over `seconds` with the area `distance`, its peak found numerically."""

    def lacks(peak: float) -> float:
        return 0.5 * (2.0 * seconds - peak / first - peak / last) * peak - distance

    meet = seconds / (1.0 / first + 1.0 / last)
    top = min(increase, meet if lacks(meet) < 0.0 else brentq(lacks, 0.0, meet, xtol=1e-13, rtol=1e-15))
    return np.maximum(0.0, np.minimum(np.minimum(first * t, top), last * (seconds - t)))


# what is compensated


@pytest.mark.parametrize(
    ("values", "end", "warning"),
    [
        ({"length": 5000.0, "difference": 250.0}, 10_250.0, ""),
        (
            {"length": 2000.0, "difference": 500.0},
            10_165.0,
            "P-WARN-23023 axis x: compensation_start: difference 500 mm cannot be reached over 2000 mm; 165 mm is used",
        ),
        ({"length": 5000.0, "difference": -250.0}, 9750.0, ""),
    ],
)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_examples_of_the_manual(values: dict[str, float], end: float, warning: str, side: float) -> None:
    """Start from 0 to 10000 mm with 2000 mm/s; the partial example as corrected, with VK = 300 mm/s."""
    bench = moving_axis(target=side * 10_000.0)
    assert compensate(bench, **values) == warning
    settle(bench)
    assert bench.column("set_position")[-1] == pytest.approx(side * end, abs=1e-9)
    assert bench.column("actual_position")[-1] == pytest.approx(side * end, abs=1e-6)
    assert bench.events == []
    assert_no_steps(bench, **SMOOTH, corners=4)


@pytest.mark.parametrize("difference", [250.0, -0.5, 400.0, *long([-250.0, 0.5, -400.0])])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_either_sign_in_both_directions(difference: float, side: float) -> None:
    """AK+ belongs to the first ramp for D > 0, to the last one for D < 0; in the direction of travel D > 0 leads."""
    bench = moving_axis(target=side * 10_000.0)
    compensate(bench, difference=difference)
    settle(bench)
    first, last = (500.0, 1000.0) if difference > 0.0 else (1000.0, 500.0)
    t = np.arange(2001) * CYCLE_TIME
    w = np.sign(difference) * shape(t, abs(difference), SECONDS, first, last)
    assert column(bench, "set_velocity")[1000:3001] == pytest.approx(side * (2000.0 + w), abs=1e-8)
    assert bench.column("set_position")[-1] == pytest.approx(side * (10_000.0 + difference), abs=1e-9)
    assert_no_steps(bench, **SMOOTH, corners=4)


@pytest.mark.parametrize("length", [4000.0, 1234.567, 777.7])
def test_the_time_is_that_of_length_by_process_velocity(length: float) -> None:
    """Also where it ends between two cycles; up to the very last cycle something is compensated."""
    bench = moving_axis()
    compensate(bench, length=length, difference=20.0)
    bench.run(2500)
    on = np.flatnonzero(has_bit(bench, COMPENSATING))
    assert on[0] == 1000
    assert on[-1] == 1000 + int(np.ceil(length / 2000.0 / CYCLE_TIME)) - 1
    extra = column(bench, "set_velocity") - 2000.0
    assert (extra[on[1:]] > 0.0).all() and (extra[on[-1] + 1 : 3000] == 0.0).all()


@pytest.mark.parametrize(
    ("values", "reached"),
    [
        ({"velocity_increase": 100.0, "difference": 1000.0}, 100.0 * 2.0 - 100.0**2 * 0.0015),  # held at VK
        ({"velocity_increase": 900.0, "difference": 5000.0}, 4.0 / 0.006),  # the ramps meet: T²/(2·(1/500 + 1/1000))
        ({"velocity_increase": 900.0, "difference": -5000.0}, -4.0 / 0.006),
        ({"velocity_increase": 100.0, "difference": -1000.0}, -185.0),
    ],
)
def test_what_cannot_be_reached_is_cut(values: dict[str, float], reached: float) -> None:
    bench = moving_axis()
    difference = values["difference"]
    assert compensate(bench, **values) == (
        f"P-WARN-23023 axis x: compensation_start: difference {difference:g} mm cannot be reached over 4000 mm; "
        f"{reached:g} mm is used"
    )
    settle(bench)
    assert bench.column("set_position")[-1] == pytest.approx(10_000.0 + reached, abs=1e-9)


def test_a_length_beyond_the_target_is_cut_to_the_rest_of_the_way() -> None:
    """At 1000 ms the axis is at 1500 mm, 8500 mm before its target: those 8500 mm are used, over 4.25 s."""
    bench = moving_axis()
    assert compensate(bench, length=20_000.0, difference=100.0) == (
        "P-WARN-23023 axis x: compensation_start: length 20000 mm is more than the distance to go; 8500 mm is used"
    )
    settle(bench)
    t = np.arange(4001) * CYCLE_TIME  # up to the start of the basic motion's brake phase
    w = shape(t, 100.0, 4.25, 500.0, 1000.0)
    assert column(bench, "set_velocity")[1000:5001] == pytest.approx(2000.0 + w, abs=1e-8)
    ramp = 2000.0 - start_ramp(2000.0, np.arange(501) * CYCLE_TIME)  # the brake phase mirrors the start
    w = shape(4.0 + np.arange(501) * CYCLE_TIME, 100.0, 4.25, 500.0, 1000.0)
    assert column(bench, "set_velocity")[5000:5501] == pytest.approx(ramp + w * ramp / 2000.0, abs=1e-8)
    assert not has_bit(bench, COMPENSATING)[5250:].any()
    assert bench.column("set_position")[-1] < 10_100.0  # the last part ran below VP


def test_both_cuts_in_one_warning() -> None:
    bench = moving_axis(target=3000.0)
    assert compensate(bench, difference=1e4) == (
        "P-WARN-23023 axis x: compensation_start: length 4000 mm is more than the distance to go; 1500 mm is used; "
        "difference 10000 mm cannot be reached over 1500 mm; 93.75 mm is used"  # T = 0.75 s: T²/0.006
    )


def test_accelerations_that_are_left_out_are_those_of_the_axis() -> None:
    """AK± = 5000 mm/s² from config/ptp.yaml: the triangle of 2 s would reach 5000 mm/s, so VK = 300 counts."""
    bench = moving_axis()
    values = {name: value for name, value in VALUES.items() if "celeration" not in name} | {"difference": 1e4}
    assert "582 mm is used" in bench.accepted("compensation_start", **values)  # 300·2 - 300²/5000
    bench.run(100)
    assert column(bench, "set_acceleration")[1000:1060] == pytest.approx(5000.0)
    assert column(bench, "set_velocity")[1061:1100] == pytest.approx(2300.0)


# VP and the real velocity


@pytest.mark.parametrize(("velocity", "share"), [(1000.0, 0.5), (200.0, 0.1), (3000.0, 1.0), (1999.0, 0.9995)])
@pytest.mark.parametrize("difference", [-250.0, *long([250.0])])
def test_a_velocity_below_vp_compensates_less(velocity: float, share: float, difference: float) -> None:
    bench = moving_axis(velocity=velocity, target=20_000.0)
    compensate(bench, difference=difference, length=4000.0)
    bench.run(3000)
    clean = moving_axis(velocity=velocity, target=20_000.0, cycles=4000)
    extra = column(bench, "set_position") - column(clean, "set_position")
    assert extra[-1] == pytest.approx(difference * share, abs=1e-9)
    assert has_bit(bench, COMPENSATING).sum() == 2000


def reference_way(clean: UnitBench, begin: int, w: Any, sign: float, vp: float) -> float:
    """∫ w(τ)·min(1, |v|/VP) dt over the basic motion of `clean`, where τ stops while v = 0."""
    cycles = np.arange(begin, len(clean.column("set_velocity")) - 1)
    fine = np.linspace(0.0, CYCLE_TIME, 21)
    speed = np.abs(basic_velocity(clean)(cycles[:, None] * CYCLE_TIME + fine))
    goes_on = (speed[:, 0] != 0.0) | (speed[:, -1] != 0.0)
    tau = (np.cumsum(goes_on) - goes_on) * CYCLE_TIME
    integrand = w(tau[:, None] + fine) * np.minimum(1.0, speed / vp)
    return sign * float(simpson(integrand, x=fine, axis=1)[goes_on].sum())


@pytest.mark.parametrize(
    ("vp", "changes"),
    [
        (2000.0, [(300, 40.0), (900, 100.0)]),
        (1500.0, [(300, 40.0), (900, 100.0)]),
        (2000.0, [(1, 0.0), (2500, 100.0)]),
        (2000.0, [(700, 0.0), (2500, 100.0)]),
        (2000.0, [(700, 50.0), (900, 0.0), (1600, 10.0), (4000, 100.0)]),
    ],
    ids=["in the middle", "in the middle, VP lower", "0 at once", "0 later", "up and down"],
)
@pytest.mark.parametrize("difference", [-250.0, *long([250.0])])
@pytest.mark.parametrize("side", [1.0, *long([-1.0])])
def test_overrides_during_a_compensation(
    vp: float, changes: list[tuple[int, float]], difference: float, side: float
) -> None:
    benches = []
    for compensated in (True, False):
        bench = moving_axis(target=side * 20_000.0, override_type=3)
        if compensated:
            compensate(bench, difference=difference, process_velocity=vp)
        for after, percent in changes:
            bench.run(1000 + after - bench.cycle)
            bench.accepted("set_override", percent=percent)
        benches.append(settle(bench, 30_000))
    bench, clean = benches
    first, last = (500.0, 1000.0) if difference > 0.0 else (1000.0, 500.0)
    seconds = VALUES["length"] / vp
    distance = reference_way(
        clean, 1000, lambda t: shape(t, 250.0, seconds, first, last), side * float(np.sign(difference)), vp
    )
    assert bench.column("set_position")[-1] - side * 20_000.0 == pytest.approx(distance, abs=1e-4)
    crossings = 0 if vp == 2000.0 else 4  # where v passes VP under acceleration, min(1, v/VP) has a corner
    assert_no_steps(bench, acceleration=A * 1.21 + 1000.0, jerk=J * 1.21 + 2000.0 * A / vp, corners=4 + crossings)


@pytest.mark.parametrize(
    "toggles", [[(1000, 0.0), (3000, 100.0)], [(k * 50, 0.0 if k % 2 else 100.0) for k in range(60)]]
)
@pytest.mark.parametrize("difference", [500.0, -500.0])
@pytest.mark.parametrize(("rise", "fall"), [(500.0, 500.0), (800.0, 200.0)])
def test_below_vp_the_sum_of_the_accelerations_is_that_of_motion_and_compensation(
    rise: float, fall: float, difference: float, toggles: list[tuple[int, float]]
) -> None:
    """VP 200 < v 1000: A = 40,000 takes v from VP to 0 in 10 ms, AK = 500 takes VK = 400 out in 0.8 s."""
    bench = axis_bench(count=50)
    bench.accepted("move_absolute", target=6000.0, velocity=1000.0, acceleration=4e4, deceleration=4e4, jerk=4e6)
    bench.run(500)
    values = {"length": 600.0, "process_velocity": 200.0, "velocity_increase": 400.0}
    bench.accepted("compensation_start", difference=difference, acceleration=rise, deceleration=fall, **values)
    for after, percent in toggles:
        bench.run(max(0, 500 + after - bench.cycle))
        bench.accepted("set_override", percent=percent)
    bench.accepted("set_override", percent=100.0)
    settle(bench, 20_000)
    a, v, p = (column(bench, f"set_{name}") for name in ("acceleration", "velocity", "position"))
    most = 40_000.0 + max(rise, fall)
    assert np.abs(a).max() <= most * (1.0 + 1e-9)
    assert np.abs(np.diff(v)).max() <= most * CYCLE_TIME * (1.0 + 1e-9)
    assert np.abs(np.diff(p) - 0.5 * CYCLE_TIME * (v[1:] + v[:-1])).max() <= 0.25 * most * CYCLE_TIME**2
    assert 0.0 < np.sign(difference) * (p[-1] - 6000.0) < 500.0
    assert bench.state == 1 and not has_bit(bench, COMPENSATING | HAS_JOB)[-1]


def bench_with_an_outlasting_compensation(deceleration: float) -> UnitBench:
    """3 s of it are planned on a motion that ends after 1 s; it begins after half of it."""
    bench = axis_bench(count=10)
    bench.accepted("move_absolute", target=1000.0, velocity=1000.0, acceleration=4e4, deceleration=4e4, jerk=4e6)
    bench.run(500)
    values = {"length": 600.0, "process_velocity": 200.0, "velocity_increase": 400.0}
    bench.accepted("compensation_start", difference=300.0, acceleration=500.0, deceleration=deceleration, **values)
    return bench


def test_a_compensation_that_outlasts_its_basic_motion_ends_on_its_own_ramp() -> None:
    """What is added when the motion ends comes down with AK-, and the job waits."""
    bench = bench_with_an_outlasting_compensation(500.0)
    bench.run(2000)
    arrived = 1035  # 1000 mm at 1000 mm/s, and half of both ramps
    v = column(bench, "set_velocity")
    tail = v[arrived + 1 :][: int(v[arrived + 1] / 500.0 / CYCLE_TIME)]
    assert v[arrived + 1] > 50.0 and np.diff(tail) == pytest.approx(-500.0 * CYCLE_TIME)
    states, bits = bench.column("state"), has_bit(bench, HAS_JOB)
    standing = states.index(1, 1)
    assert v[standing] == 0.0 and v[standing - 2] > 0.0 and bits[standing - 1] and not bits[standing]
    assert np.abs(column(bench, "set_acceleration")).max() <= 40_500.0 * (1.0 + 1e-9)


def test_an_emergency_stop_of_a_compensation_that_outlasts_its_motion() -> None:
    """It takes 0.1 s from 100 mm/s and more, where AK- would take 10 times that."""
    bench = bench_with_an_outlasting_compensation(50.0)
    bench.run(550)
    assert bench.column("set_velocity")[-1] > 5.0
    assert bench.accepted("emergency_stop", deceleration=5e4, jerk=5e6) == ""
    bench.run(50)
    assert bench.state == 1 and bench.column("set_velocity")[-1] == 0.0


def test_override_0_freezes_the_compensation() -> None:
    bench = moving_axis()
    compensate(bench)
    bench.run(700)
    bench.accepted("set_override", percent=0.0)
    bench.run(3000)
    p, v = column(bench, "set_position"), column(bench, "set_velocity")
    assert (v[2200:] == 0.0).all() and (p[2200:] == p[2200]).all()
    bits = np.array(bench.column("status_bits"))[2200:]
    assert (bits & COMPENSATING != 0).all() and (bits & HAS_JOB != 0).all()
    assert bench.state == 3
    bench.accepted("set_override", percent=100.0)
    bench.run(600)
    assert (column(bench, "set_velocity")[5210:5300] > 2000.0).all()
    settle(bench)
    assert bench.column("set_position")[-1] > 10_150.0


def test_the_jerk_is_the_slope_of_the_acceleration() -> None:
    """Under an override that varies v below VP; central differences, which are exact to j'·T."""
    bench = moving_axis(target=20_000.0, override_type=3)
    compensate(bench)
    for percent in (40.0, 90.0, 20.0, 100.0):
        bench.run(400)
        bench.accepted("set_override", percent=percent)
    bench.run(400)
    a, j = column(bench, "set_acceleration")[1000:], column(bench, "set_jerk")[1000:]
    slope = (a[2:] - a[:-2]) / (2.0 * CYCLE_TIME)
    smooth = (np.abs(np.diff(j[:-1])) < 100.0) & (np.abs(np.diff(j[1:])) < 100.0)
    smooth &= np.abs(slope) < 100_000.0  # corners of the trapezoid
    assert np.count_nonzero(smooth & (np.abs(slope) > 40_000.0)) > 300
    assert j[1:-1][smooth] == pytest.approx(slope[smooth], abs=30.0)


# end of path, bits


def test_the_end_of_the_path_ends_the_compensation() -> None:
    """The time L/VP = 5 s would continue after the target is reached (the axis goes at 4·VP first)."""
    bench = moving_axis(target=4000.0)
    compensate(bench, length=2500.0, process_velocity=500.0, difference=100.0)
    settle(bench)
    arrived = 2501  # 4000/2000 s + half of each ramp
    assert not has_bit(bench, COMPENSATING)[arrived:].any()
    assert has_bit(bench, COMPENSATING)[1000 : arrived - 1].all()
    assert not has_bit(bench, HAS_JOB)[arrived:].any()
    assert bench.state == 1
    distance = simpson(
        shape(t := np.arange(1501) * CYCLE_TIME, 100.0, 5.0, 500.0, 1000.0)
        * np.minimum(1.0, np.concatenate([np.full(1000, 2000.0), 2000.0 - start_ramp(2000.0, t[:501])]) / 500.0),
        x=t,
    )
    assert bench.column("set_position")[-1] == pytest.approx(4000.0 + distance, abs=1e-4)
    # min(1, v/VP) gets a corner where v falls below VP under -A: 20·A/VP there
    assert_no_steps(bench, acceleration=A * 1.05 + 500.0, jerk=J * 1.05 + 2.0 * 500.0 * A / 500.0, corners=3)


def test_bits_of_job_and_compensation() -> None:
    bench = moving_axis()
    assert not has_bit(bench, COMPENSATING).any()
    compensate(bench)
    settle(bench)
    compensating = has_bit(bench, COMPENSATING)
    assert np.flatnonzero(compensating).tolist() == list(range(1000, 3000))
    assert np.flatnonzero(has_bit(bench, HAS_JOB)).tolist() == list(range(5500))


# after a compensation


def test_motion_reversal_with_a_large_negative_difference() -> None:
    """2000 mm/s less 3000 mm/s: the axis goes back, twice its direction changes (manual: double motion reversal)."""
    bench = moving_axis(target=20_000.0)
    compensate(
        bench, length=8000.0, difference=-8000.0, velocity_increase=3000.0, acceleration=4000.0, deceleration=4000.0
    )
    settle(bench)
    v = column(bench, "set_velocity")
    w = shape(np.arange(4001) * CYCLE_TIME, 8000.0, 4.0, 4000.0, 4000.0)
    assert w.max() > 2000.0 and w.max() < 3000.0
    assert v[1000:5001] == pytest.approx(2000.0 - w, abs=1e-8)
    assert np.count_nonzero(np.diff(v[1000:5001] > 0.0)) == 2
    assert bench.column("set_position")[-1] == pytest.approx(12_000.0, abs=1e-9)
    assert bench.events == []
    assert_no_steps(bench, acceleration=2.5 * A + 4000.0, jerk=J * 2.5 + 2.0 * 4000.0 * A / 2000.0, corners=4)


def test_a_second_compensation_adds_to_the_first() -> None:
    bench = moving_axis(target=20_000.0)
    compensate(bench)
    bench.run(2000)
    compensate(bench, difference=-100.0)
    bench.run(2000)
    assert has_bit(bench, COMPENSATING)[1000:].all()
    settle(bench)
    assert bench.column("set_position")[-1] == pytest.approx(20_150.0, abs=1e-9)
    assert_no_steps(bench, **SMOOTH, corners=8)


def test_a_new_target_after_a_compensation_is_a_position_of_the_axis() -> None:
    bench = moving_axis()
    compensate(bench)
    bench.run(2001)
    bench.accepted("new_target", target=9000.0)
    settle(bench)
    assert bench.column("set_position")[-1] == pytest.approx(9000.0, abs=1e-9)
    assert_no_steps(bench, **SMOOTH, corners=4)


def test_a_new_velocity_comes_at_a_position_of_the_axis() -> None:
    bench = moving_axis()
    compensate(bench)
    bench.run(2001)
    bench.accepted("new_velocity_and_target", velocity=500.0, target=9000.0, activation_position=7000.0)
    settle(bench)
    p, v = column(bench, "set_position"), column(bench, "set_velocity")
    change = int(np.flatnonzero(v[3000:] < 2000.0 - 1e-6)[0]) + 3000
    assert p[change - 2] <= 7000.0 + 2.0 <= p[change + 1]
    assert p[-1] == pytest.approx(9000.0, abs=1e-9)


@pytest.mark.parametrize("command", ["move_absolute", "move_relative"])
def test_the_next_start_begins_where_the_axis_is(command: str) -> None:
    bench = moving_axis()
    compensate(bench)
    settle(bench)
    begin = bench.column("set_position")[-1]
    arguments = {"move_absolute": {"target": 500.0}, "move_relative": {"distance": 500.0 - begin}}[command]
    bench.accepted(command, **arguments, velocity=2000.0)
    bench.run(1)
    assert bench.column("set_position")[-1] == begin == pytest.approx(10_250.0)
    settle(bench)
    assert bench.column("set_position")[-1] == pytest.approx(500.0, abs=1e-9)
    assert_no_steps(bench, **SMOOTH, corners=4)


def test_a_start_over_no_distance_after_a_compensation() -> None:
    bench = moving_axis()
    compensate(bench)
    settle(bench)
    here = bench.column("set_position")[-1]
    assert "the axis is at its target already" in bench.accepted("move_absolute", target=here)
    bench.run(10)
    assert bench.column("set_position")[-10:] == [here] * 10


@pytest.mark.parametrize("count", [7, *long([1, 1000])])
def test_the_size_of_blocks_changes_no_bit(count: int) -> None:
    """Commands come at the same cycles in blocks of 1, 7, 10 and 1000 cycles."""
    runs = []
    for size in (10, count):
        bench = moving_axis(cycles=993, count=size)
        compensate(bench, length=3000.0)
        for cycles, percent in ((500, 60.0), (501, 0.0), (1003, 100.0)):
            bench.run(cycles)
            bench.accepted("set_override", percent=percent)
        bench.run(300)
        bench.accepted("compensation_stop")
        bench.run(4000)
        runs.append({name: list(map(repr, values)) for name, values in bench.columns().items()})
    assert runs[0] == runs[1]


def test_without_compensation_nothing_changes() -> None:
    """A compensation that was refused, or that has ended where it began, leaves all bits of the basic motion alone."""
    benches = [moving_axis(), moving_axis()]
    benches[0].refused("compensation_start", **VALUES | {"difference": 0.0})
    benches[0].refused("compensation_start", **VALUES | {"length": -1.0})
    for bench in benches:
        bench.run(3000)
    assert benches[0].columns() == benches[1].columns()


def test_compensation_at_a_start_with_override_0_waits() -> None:
    """The axis has a job and is at a standstill; the compensation starts with the motion."""
    bench = axis_bench()
    bench.accepted("set_override", percent=0.0)
    bench.accepted("move_absolute", target=-10_000.0, velocity=2000.0)
    bench.run(50)
    compensate(bench, length=8000.0, process_velocity=1000.0)
    bench.run(450)
    assert has_bit(bench, COMPENSATING)[50:].all() and not column(bench, "set_velocity").any()
    bench.accepted("set_override", percent=100.0)
    settle(bench)
    v = start_ramp(2000.0, t := np.arange(501) * CYCLE_TIME)
    w = shape(t, 250.0, 8.0, 500.0, 1000.0)
    assert -column(bench, "set_velocity")[500:1001] == pytest.approx(v + w * np.minimum(1.0, v / 1000.0), abs=1e-7)
