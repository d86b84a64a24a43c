"""External setpoints: what they do to an axis, alone and on top of a PTP motion (TX1250 2.6)."""

from __future__ import annotations

import numpy as np
import pytest
from long_support import long, long_sets
from machine_support import CYCLE_TIME, UnitBench, seven_phases
from scipy.interpolate import CubicHermiteSpline
from superposition_support import (
    EXTERNAL,
    HAS_JOB,
    A,
    J,
    SetpointRow,
    column,
    external_axis,
    feed,
    generator,
    has_bit,
    moving_axis,
    setpoints,
    settle,
)

# alone


@pytest.mark.parametrize("start", [0.0, -1234.567, *long([0.1])])
@pytest.mark.parametrize("distance", [600.0, -600.0])
@pytest.mark.parametrize("count", [7, 10, *long([1, 1000])])
def test_absolute_setpoints_come_out_to_the_bit(start: float, distance: float, count: int) -> None:
    bench = external_axis(start_position=start, count=count)
    rows = generator(distance, first_cycle=20, start=start)
    feed(bench, rows, 1000)
    assert setpoints(bench, rows) == [tuple(row[1:4]) for row in rows]
    assert bench.column("set_position")[-1] == start + distance
    assert bench.column("actual_position")[-1] == pytest.approx(start + distance, abs=1e-6)
    assert bench.events == [] and bench.state == 4


@pytest.mark.parametrize("start", [0.0, 0.1, -1234.567])
def test_relative_setpoints_count_from_where_the_axis_is(start: float) -> None:
    bench = external_axis("relative", start_position=start)
    rows = generator(600.0, first_cycle=20)
    feed(bench, rows, 1000)
    assert setpoints(bench, rows) == [(start + row[1], row[2], row[3]) for row in rows]


def test_relative_counts_from_the_last_enable() -> None:
    bench = external_axis("relative")
    feed(bench, generator(600.0, first_cycle=20), 1000)
    bench.accepted("external_disable")
    bench.run(10)
    bench.accepted("external_enable", mode="relative")
    feed(bench, generator(-100.0, first_cycle=1100, velocity=400.0), 500)
    assert bench.column("set_position")[-1] == 500.0


def test_states_and_bits() -> None:
    bench = external_axis()
    assert bench.state == 4 and has_bit(bench, EXTERNAL).all() and not has_bit(bench, HAS_JOB).any()
    bench.accepted("external_disable")
    bench.run(10)
    assert not has_bit(bench, EXTERNAL)[10:].any()
    assert bench.column("state")[10:12] == [1, 1]


def test_a_ptp_start_after_external_setpoints_begins_where_they_ended() -> None:
    bench = external_axis()
    feed(bench, generator(600.0, first_cycle=20), 1000)
    bench.accepted("external_disable")
    bench.run(10)
    bench.accepted("move_absolute", target=100.0)
    bench.run(1)
    assert bench.column("set_position")[-1] == 600.0
    settle(bench)
    assert bench.column("set_position")[-1] == pytest.approx(100.0, abs=1e-9)


def test_two_absolute_motions_with_a_ptp_motion_in_between() -> None:
    bench = external_axis(start_position=0.3)
    feed(bench, generator(60.0, first_cycle=20, start=0.3, velocity=400.0), 500)
    bench.accepted("external_disable")
    bench.run(10)
    bench.accepted("move_absolute", target=0.7)
    settle(bench)
    begin = bench.cycle
    bench.accepted("external_enable", mode="absolute")
    rows = generator(-60.0, first_cycle=begin, start=0.7, velocity=400.0)
    feed(bench, rows, 500)
    assert setpoints(bench, rows) == [tuple(row[1:4]) for row in rows]


# superposed


@pytest.mark.parametrize("distance", [300.0, -300.0])
@pytest.mark.parametrize("side", [-1.0, *long([1.0])])
def test_relative_setpoints_on_a_ptp_motion_are_added_exactly(distance: float, side: float) -> None:
    bench, clean = moving_axis(target=side * 10_000.0), moving_axis(target=side * 10_000.0)
    bench.accepted("external_enable", mode="relative")
    rows = generator(distance, first_cycle=1500, velocity=500.0)
    feed(bench, rows, 6000)
    clean.run(6000)
    basic = setpoints(clean, rows)
    assert setpoints(bench, rows) == [
        tuple(b + r for b, r in zip(base, row[1:4], strict=True)) for base, row in zip(basic, rows, strict=True)
    ]
    assert bench.column("set_position")[-1] == side * 10_000.0 + distance
    assert bench.state == 4 and has_bit(bench, EXTERNAL)[1000:].all()
    assert (
        np.flatnonzero(has_bit(bench, HAS_JOB))[[0, -1]].tolist()
        == np.flatnonzero(has_bit(clean, HAS_JOB))[[0, -1]].tolist()
    )


def test_external_setpoints_go_on_after_the_end_of_the_ptp_motion() -> None:
    bench = moving_axis(target=1000.0, cycles=500)
    bench.accepted("external_enable", mode="relative")
    feed(bench, generator(1500.0, first_cycle=520), 3000)
    assert bench.column("set_position")[-1] == 2500.0
    assert set(bench.column("state")[1200:]) == {4}
    bench.accepted("external_disable")
    bench.run(10)
    assert bench.state == 1


def test_override_0_holds_the_basic_motion_only() -> None:
    bench = moving_axis()
    bench.accepted("external_enable", mode="relative")
    bench.accepted("set_override", percent=0.0)
    bench.run(1000)
    assert bench.column("set_velocity")[-1] == 0.0
    here = bench.column("set_position")[-1]
    feed(bench, generator(50.0, first_cycle=bench.cycle, velocity=100.0), 1000)
    assert bench.column("set_position")[-1] == pytest.approx(here + 50.0, abs=1e-9)
    bench.accepted("set_override", percent=100.0)
    settle_to_ptp_end(bench)
    assert bench.column("set_position")[-1] == pytest.approx(10_050.0, abs=1e-9)


def settle_to_ptp_end(bench: UnitBench) -> None:
    bench.run(6000)
    assert not has_bit(bench, HAS_JOB)[-1]


def test_a_new_target_counts_beside_the_contribution() -> None:
    """While enabled the setpoints come on top; after their end a target is a position of the axis again."""
    bench = moving_axis()
    bench.accepted("external_enable", mode="relative")
    feed(bench, generator(50.0, first_cycle=1010, velocity=100.0), 1000)
    bench.accepted("new_target", target=9000.0)
    bench.run(100)
    bench.accepted("external_disable")
    bench.run(1)
    bench.accepted("new_target", target=8000.0)
    settle(bench)
    assert bench.column("set_position")[-1] == pytest.approx(8000.0, abs=1e-9)


@pytest.mark.parametrize("after", [0, 1, 50, 500])
def test_a_new_target_during_the_ramp_after_the_end_is_reached(after: int) -> None:
    """The contribution still comes to rest when the target is given: where it will rest counts."""
    bench = moving_axis()
    bench.accepted("external_enable", mode="relative")
    rows = generator(300.0, first_cycle=1010, velocity=500.0)[:400]
    feed(bench, rows, 400)
    bench.accepted("external_disable")
    if after:
        bench.run(after)
    bench.accepted("new_target", target=8000.0)
    settle(bench)
    assert bench.column("set_position")[-1] == pytest.approx(8000.0, abs=1e-9)


def test_compensation_and_external_setpoints_together() -> None:
    bench = moving_axis()
    bench.accepted("external_enable", mode="relative")
    bench.accepted(
        "compensation_start", length=4000.0, difference=100.0, process_velocity=2000.0, velocity_increase=300.0
    )
    feed(bench, generator(50.0, first_cycle=1200, velocity=100.0), 2500)
    bench.accepted("external_disable")
    settle(bench)
    assert bench.column("set_position")[-1] == pytest.approx(10_150.0, abs=1e-9)
    bench.accepted("move_absolute", target=0.0)
    settle(bench)
    assert bench.column("set_position")[-1] == 0.0


# direction


def test_direction_0_gates() -> None:
    """Before the first -1 or +1 nothing counts; a setpoint with 0 is taken over for its cycle, then nothing does."""
    bench = external_axis(count=1)
    rows: list[SetpointRow] = [[k, 3.0, 0.0, 0.0, 0] for k in range(10, 20)]  # ignored
    rows += [[20, 0.0, 0.0, 0.0, 1], [21, 1.0, 0.0, 0.0, 1], [22, 2.0, 0.0, 0.0, 0]]
    rows += [[k, 5.0, 0.0, 0.0, 0] for k in range(23, 30)]  # ignored
    rows += [[30, 2.5, 0.0, 0.0, -1], [31, 1.5, 0.0, 0.0, -1], [32, 1.0, 0.0, 0.0, 0], [33, 9.0, 0.0, 0.0, 0]]
    feed(bench, rows, 60)
    p = bench.column("set_position")
    assert p[:21] == [0.0] * 21
    assert p[21:34] == [1.0] + [2.0] * 8 + [2.5, 1.5, 1.0, 1.0]
    assert p[33:] == [1.0] * len(p[33:])
    assert bench.events == []


@pytest.mark.parametrize("end", ["disable", "direction 0"])
@pytest.mark.parametrize(
    ("v", "a"), [(1000.0, 0.0), (600.0, -4000.0), (-600.0, -4000.0), *long_sets([(600.0, 4000.0), (-1000.0, 0.0)])]
)
def test_an_end_in_motion_comes_to_rest_on_the_ramp_of_the_axis(end: str, v: float, a: float) -> None:
    """Its acceleration ends immediately: a stop from (v, 0) with A- = 5000 and J = 50000 over v/2·(v/A + A/J)."""
    bench = external_axis(count=1)
    t = np.arange(100) * CYCLE_TIME
    sign = 1.0 if v > 0.0 else -1.0
    begin = v - a * 0.1  # constant acceleration for 100 cycles up to (v, a)
    rows = [[20 + k, begin * x + 0.5 * a * x * x, begin + a * x, a, sign] for k, x in enumerate(t)]
    last = [120, begin * 0.1 + 0.5 * a * 0.01, v, a, sign if end == "disable" else 0]
    feed(bench, [*rows, last], 110 if end == "disable" else 111)
    if end == "disable":
        bench.accepted("external_disable")
    bench.run(1500)
    assert setpoints(bench, [last]) == [(last[1], v, a)]
    seconds = abs(v) / A + A / J
    assert bench.column("set_position")[-1] == pytest.approx(last[1] + 0.5 * v * seconds, abs=1e-8)
    standing = 120 + round(seconds / CYCLE_TIME)
    speeds = column(bench, "set_velocity")
    assert speeds[standing - 1] != 0.0 and not speeds[standing + 1 :].any()
    assert (np.diff(np.abs(speeds[120:])) <= 1e-9).all()
    accelerations = column(bench, "set_acceleration")
    assert accelerations[121] == pytest.approx(-sign * J * CYCLE_TIME)
    assert np.abs(np.diff(accelerations))[121:].max() <= J * CYCLE_TIME * (1 + 1e-9)
    ways = np.diff(column(bench, "set_position"))[120:]
    assert ways == pytest.approx(0.5 * CYCLE_TIME * (speeds[120:-1] + speeds[121:]), abs=J * CYCLE_TIME**3)


@pytest.mark.parametrize("late", [0, 1, 20])
def test_an_end_that_was_overtaken_ends_the_motion_all_the_same(late: int) -> None:
    """Only its values are out of date: the axis comes to rest from where it is, 400 mm/s without a step."""
    bench = external_axis(count=1)
    rows = [[10 + k, 2000.0 * (0.001 * k) ** 2, 4.0 * k, 4000.0, 1] for k in range(101)]
    feed(bench, rows, 101)
    bench.accepted("external_setpoints", setpoints=[[*rows[100 - late][:4], 0]])
    bench.run(1000)
    v = column(bench, "set_velocity")
    assert v[110] == 400.0 and v[111] == pytest.approx(404.0)
    assert v[112] == pytest.approx(404.0 - 0.5 * J * CYCLE_TIME**2)
    assert v.max() == v[111] and v[-1] == 0.0
    assert bench.state == 4 and bench.events == []


def test_an_end_takes_the_place_of_rows_that_wait() -> None:
    bench = external_axis()
    bench.accepted("external_setpoints", setpoints=[[20 + k, 0.1 * k, 100.0, 0.0, 1] for k in range(500)])
    bench.run(20)
    bench.accepted("external_setpoints", setpoints=[[60, 4.0, 100.0, 0.0, 0]])
    bench.accepted("external_setpoints", setpoints=[[400, 5.0, 0.0, 0.0, 1]])
    bench.run(1000)
    v = column(bench, "set_velocity")
    assert v[20:61] == pytest.approx(100.0) and (np.diff(v[60:]) <= 0.0).all()
    seconds = 2.0 * np.sqrt(100.0 / J)
    p = column(bench, "set_position")
    assert p[399] == pytest.approx(4.0 + 0.5 * 100.0 * seconds) and (p[400:] == 5.0).all()


@pytest.mark.parametrize("direction", [1, 0])
def test_a_last_setpoint_without_velocity_stands(direction: int) -> None:
    """The generator's last value of acceleration counts for its cycle and moves nothing more."""
    bench = external_axis()
    rows = [row for row in generator(600.0, first_cycle=20) if row[0] <= 870]
    rows.append([871, 600.0, 0.0, -4000.0, direction])
    feed(bench, rows, 880)
    bench.accepted("external_disable")
    bench.run(500)
    assert bench.column("set_acceleration")[871] == -4000.0
    assert set(bench.column("set_position")[871:]) == {600.0}
    assert not column(bench, "set_velocity")[871:].any() and not column(bench, "set_acceleration")[872:].any()


def test_after_disabling_exactly_one_more_setpoint_counts() -> None:
    """The setpoint of the cycle in which the end is commanded; those of later cycles do not."""
    for rows_first in (True, False):
        bench = external_axis()
        rows = [[20 + k, float(k), 1000.0, 0.0, 1] for k in range(60)]
        feed(bench, rows[:20], 30)
        rows[20][1] = 20.5  # shows whether it was taken over
        if rows_first:
            bench.accepted("external_setpoints", setpoints=rows[20:30])
        bench.accepted("external_disable")
        if not rows_first:
            bench.accepted("external_setpoints", setpoints=rows[20:30])
        bench.run(1)
        assert bench.column("set_position")[-1] == 20.5
        bench.run(1000)
        assert bench.column("set_position")[-1] == pytest.approx(20.5 + 1000.0 * 0.15, abs=1e-9)  # ramp of 0.3 s
        assert bench.state == 1
        assert bench.accepted("external_setpoints", setpoints=[[2000, 0, 0, 0, 1]]) == (
            "P-WARN-23031 axis x: external_setpoints ignored: external setpoints are not enabled"
        )


def test_disabling_and_enabling_in_the_same_cycle_is_smooth() -> None:
    for mode in ("absolute", "relative"):
        bench = external_axis(mode)
        feed(bench, [[10 + k, float(k), 1000.0, 0.0, 1] for k in range(20)], 20)
        bench.accepted("external_disable")
        bench.accepted("external_enable", mode=mode)
        bench.run(1000)
        p = column(bench, "set_position")
        assert np.abs(np.diff(p)).max() <= 1.0 + 1e-9
        assert p[-1] == pytest.approx(20.0 + 150.0, abs=1e-9)


# gaps, dead time


def test_setpoints_every_10_cycles_are_smooth() -> None:
    """A jerk-limited motion of another generator, given every 10 ms: in between the acceleration is held."""
    phases = seven_phases(500.0, 1000.0, 5000.0, 5000.0, 50000.0)
    seconds = sum(duration for duration, _ in phases)
    t = [0.0]
    a = [0.0]
    for duration, j in phases:
        t.append(t[-1] + duration)
        a.append(a[-1] + j * duration)
    fine = np.linspace(0.0, seconds, 80_001)
    acceleration = np.interp(fine, t, a)
    velocity = np.concatenate([[0.0], np.cumsum(0.5 * (acceleration[1:] + acceleration[:-1]) * (fine[1] - fine[0]))])
    distance = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * (fine[1] - fine[0]))])
    bench = external_axis()
    rows = [[20, 0.0, 0.0, 0.0, 1]]
    for k in range(int(seconds / 0.01) + 3):
        x = min(0.01 * k, seconds)
        rows.append(
            [
                30 + 10 * k,
                float(np.interp(x, fine, distance)),
                float(np.interp(x, fine, velocity)),
                float(np.interp(x, fine, acceleration)),
                1,
            ]
        )
    feed(bench, rows, round(seconds / CYCLE_TIME) + 200)
    p, v = column(bench, "set_position"), column(bench, "set_velocity")
    assert p[-1] == pytest.approx(500.0, abs=1e-6)
    true_distance = CubicHermiteSpline(fine, distance, velocity)
    inside = np.arange(30, 30 + round(seconds / CYCLE_TIME))
    # a step of J·T² /2 for T = 10 ms in velocity, J·T³/6 in position is what the held acceleration leaves out
    assert p[inside] == pytest.approx(true_distance((inside - 30) * CYCLE_TIME), abs=J * 0.01**3 / 6.0 + 1e-6)
    assert np.abs(np.diff(v)).max() <= 5000.0 * CYCLE_TIME + J * 0.01**2 / 2.0 + 1e-6
    assert bench.events == []


@pytest.mark.parametrize("dead_time", [0.0, 0.0015, 0.004])
def test_a_dead_time_leads_the_axis_ahead(dead_time: float) -> None:
    """p + v·d + a·d²/2, and never beyond the place where the setpoint comes to rest."""
    bench = external_axis(external_dead_time=dead_time)
    rows = generator(600.0, first_cycle=20)
    feed(bench, rows, 1000)
    _, p, v, a, _ = np.array(rows).T
    d = np.where(
        a * v < 0.0, np.minimum(dead_time, np.divide(-v, a, out=np.full_like(v, dead_time), where=a != 0.0)), dead_time
    )
    expected = p + v * d + 0.5 * a * d * d
    taken = column(bench, "set_position")[[int(row[0]) for row in rows]]
    assert taken == pytest.approx(expected, abs=1e-9)
    assert bench.column("set_position")[-1] == pytest.approx(600.0, abs=1e-9)
    assert bench.events == []


@pytest.mark.parametrize("count", [7, *long([1, 1000])])
@pytest.mark.parametrize("mode", ["absolute", "relative"])
def test_the_size_of_blocks_changes_no_bit(count: int, mode: str) -> None:
    runs = []
    for size in (10, count):
        bench = external_axis(mode, count=size, cycles=7)
        rows = generator(321.5, first_cycle=11, every=3)
        bench.accepted("external_setpoints", setpoints=rows[:100])
        bench.run(500)
        bench.accepted("external_setpoints", setpoints=rows[100:])
        bench.run(93)
        bench.accepted("external_disable")
        bench.run(1200)
        runs.append({name: list(map(repr, values)) for name, values in bench.columns().items()})
    assert runs[0] == runs[1]


def test_late_setpoints_count_from_when_they_come() -> None:
    """Three cycles late at 100 mm/s: the axis is led to where it would be by now."""
    bench = external_axis(cycles=10)
    bench.accepted("external_setpoints", setpoints=[[7, 0.0, 100.0, 0.0, 1]])
    bench.run(5)
    assert bench.column("set_position")[10:] == pytest.approx([0.3, 0.4, 0.5, 0.6, 0.7])
    assert bench.events == []


@pytest.mark.parametrize("position", [0.0, 99_000.0, -99_000.0])
def test_setpoints_at_the_largest_velocity_are_taken_far_from_zero_too(position: float) -> None:
    """At 1 mm/s a cycle is 0.001 mm: at 99,000 mm the last place of a position is 1e-11 mm, 1e-8 of that."""
    bench = external_axis(max_velocity=1.0, reference_velocity=1.0, start_position=position)
    distance = [position + 0.001 * k for k in range(500)]
    rows = [[bench.cycle + k, p, 1.0, 0.0, 1] for k, p in enumerate(distance)]
    feed(bench, [*rows, [bench.cycle + 500, distance[-1], 0.0, 0.0, 0]], 600)
    assert bench.events == [] and bench.column("set_position")[-1] == distance[-1]
