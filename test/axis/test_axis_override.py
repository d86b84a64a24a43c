"""Override of PTP motion: levels, types, brake phase, filter. Source: TX1250 2.2."""

from __future__ import annotations

import random

import pytest
from axis_motion_support import (
    motion,
    ramp_time,
    ramp_way,
    reachable,
    run_to_standstill,
    start,
    started,
    time_of_arrival,
)
from axis_states_support import A, J, V
from error_support import refused
from long_support import long
from machine_support import CYCLE_TIME, UnitBench, assert_axis_smooth, axis_bench, position_after, seven_phases

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit

JOB = StatusBit.HAS_JOB
IDLE = "axis x: override {} % does not change the active motion ({})"
OUT_OF_REACH = "brake phase or level out of reach"

# ---------------------------------------------------------------- override


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_override_20_to_100_takes_the_closed_form_time(kind: int) -> None:
    """TX1250 2.2: V 2000, 0 to 5000 mm, start with 20 %, 100 % in the cruise after 2 s."""
    bench = axis_bench(override_type=kind)
    bench.accepted("set_override", percent=20.0)
    start(bench, 5000.0)
    bench.run(2000)
    velocity = bench.column("set_velocity")
    assert velocity[1000] == pytest.approx(400.0) and max(velocity) <= 400.0 * (1 + 1e-12)
    bench.accepted("set_override", percent=100.0)
    bench.run(4000)
    slow = 0.5 * 400.0 * 2.0 * (400.0 / J) ** 0.5  # A is not reached up to 400 mm/s
    before = slow + 400.0 * (2.0 - 2.0 * (400.0 / J) ** 0.5)
    rest = 5000.0 - before - ramp_way(400.0, V) - ramp_way(V, 0.0)
    expected = 2.0 + ramp_time(1600.0) + rest / V + ramp_time(V)
    assert time_of_arrival(bench) == pytest.approx(expected, abs=1.1 * CYCLE_TIME)
    assert max(bench.column("set_velocity")) == pytest.approx(V)
    assert bench.column("set_position")[-1] == 5000.0
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("target", [-5000.0, *long([5000.0])])
def test_override_100_75_100_takes_the_closed_form_time(kind: int, target: float) -> None:
    bench = axis_bench(override_type=kind)
    start(bench, target)
    bench.run(1000)
    bench.accepted("set_override", percent=75.0)
    bench.run(700)
    assert abs(bench.column("set_velocity")[-1]) == pytest.approx(1500.0)
    bench.accepted("set_override", percent=100.0)
    bench.run(3000)
    before = ramp_way(0.0, V) + V * 0.5 + ramp_way(V, 1500.0) + 1500.0 * (0.7 - ramp_time(500.0))
    rest = 5000.0 - before - ramp_way(1500.0, V) - ramp_way(V, 0.0)
    assert rest > 0.0
    expected = 1.7 + ramp_time(500.0) + rest / V + ramp_time(V)
    assert time_of_arrival(bench) == pytest.approx(expected, abs=1.1 * CYCLE_TIME)
    assert bench.column("set_position")[-1] == target
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_override_0_at_the_start_keeps_the_job_and_waits(kind: int) -> None:
    bench = axis_bench(override_type=kind)
    bench.accepted("set_override", percent=0.0)
    start(bench, 1000.0)
    bench.run(500)
    assert set(bench.column("set_position")) == {0.0} and set(bench.column("state")) == {S.DISCRETE_MOTION}
    assert all(bits & JOB for bits in bench.column("status_bits"))
    bench.accepted("set_override", percent=100.0)
    bench.run(1500)
    phases = seven_phases(1000.0, V, A, A, J)
    position = bench.column("set_position")
    for k in range(1500):
        assert abs(position[500 + k] - position_after(phases, k * CYCLE_TIME)[0]) <= 1e-8
    assert time_of_arrival(bench) == pytest.approx(1.5, abs=2 * CYCLE_TIME)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("cycle", [700, *long([250, 30, 470, 1100])])
def test_override_0_in_motion_holds_and_100_goes_on(kind: int, cycle: int) -> None:
    bench = axis_bench(override_type=kind)
    start(bench, 3000.0)
    bench.run(cycle)
    bench.accepted("set_override", percent=0.0)
    bench.run(1000)
    assert bench.column("set_velocity")[-1] == 0.0 and bench.column("set_position")[-1] < 3000.0
    assert bench.column("status_bits")[-1] & JOB and bench.state == S.DISCRETE_MOTION
    bench.accepted("set_override", percent=100.0)
    bench.run(4000)
    assert bench.state == S.STANDSTILL and bench.column("set_position")[-1] == 3000.0
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_a_hold_that_is_taken_back_during_its_ramp_still_ends_at_the_target(kind: int) -> None:
    """Also where the level is out of reach from there: a hold is no table that could be kept."""
    bench = axis_bench(override_type=kind)
    start(bench, 800.0)  # V is not reached
    bench.run(350)
    bench.accepted("set_override", percent=0.0)
    bench.run(50)
    bench.accepted("set_override", percent=100.0)
    bench.run(3000)
    assert bench.state == S.STANDSTILL and bench.column("set_position")[-1] == 800.0
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("percent", [0.0, 10.0, 99.0])
def test_override_in_the_brake_phase_counts_for_the_next_start_only(kind: int, percent: float) -> None:
    bench, undisturbed = axis_bench(override_type=kind), axis_bench(override_type=kind)
    for each in (bench, undisturbed):
        start(each, 1000.0)
        each.run(700)
    warning = bench.accepted("set_override", percent=percent)
    assert warning == (
        f"axis x: override {percent} % does not change the active motion (brake phase or level out of reach)"
    )
    bench.run(100)
    bench.accepted("set_override", percent=50.0)
    bench.run(700)
    undisturbed.run(800)
    assert bench.column("set_position") == undisturbed.column("set_position")
    assert bench.state == S.STANDSTILL


@pytest.mark.parametrize(("kind", "level"), [(1, 0.5 * 1765.56), (2, 1000.0), (3, 0.5 * 1765.56), (4, 1000.0)])
def test_override_refers_to_the_reduced_or_to_the_users_velocity(kind: int, level: float) -> None:
    """800 mm reach 1765.56 mm/s: v²/A + v·A/J = 800; types 1 and 3 halve this, 2 and 4 the 2000 of the user."""
    reduced = A * (-A / J + ((A / J) ** 2 + 4.0 * 800.0 / A) ** 0.5) / 2.0
    assert reduced == pytest.approx(1765.56, abs=0.01)
    bench = axis_bench(override_type=kind)
    bench.accepted("set_override", percent=50.0)
    start(bench, 800.0)
    bench.run(3000)
    assert max(bench.column("set_velocity")) == pytest.approx(level, rel=1e-5)
    assert bench.column("set_position")[-1] == 800.0


def test_original_override_has_no_effect_while_the_velocity_is_out_of_reach() -> None:
    """Asked 2000 mm/s, reachable 1765: type 2 acts below 88 % only, from a start and from a change."""
    full, ninety = axis_bench(override_type=2), axis_bench(override_type=2)
    ninety.accepted("set_override", percent=90.0)
    for bench in (full, ninety):
        start(bench, 800.0)
        bench.run(2000)
    assert full.column("set_position") == ninety.column("set_position")


@pytest.mark.parametrize(("kind", "acts"), [(1, False), (2, False), (3, True), (4, True)])
def test_a_level_out_of_reach_keeps_the_old_table_or_takes_the_highest_that_is_left(kind: int, acts: bool) -> None:
    bench, undisturbed = axis_bench(override_type=kind), axis_bench(override_type=kind)
    for each in (bench, undisturbed):
        each.accepted("set_override", percent=20.0)
        start(each, 1000.0)
        each.run(1500)
    warning = bench.accepted("set_override", percent=100.0)
    for each in (bench, undisturbed):
        each.run(2500)
    if acts:
        assert warning == ""
        assert 400.0 < max(bench.column("set_velocity")) < V
        assert time_of_arrival(bench) < time_of_arrival(undisturbed)
    else:
        reason = "does not change the active motion (brake phase or level out of reach)"
        assert warning == f"axis x: override 100.0 % {reason}"
        assert bench.column("set_position") == undisturbed.column("set_position")
    assert bench.column("set_position")[-1] == 1000.0
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize(
    ("percent", "shown"),
    [(0.0001, 0.0001), (0.00009, 0.0001), (0.00004, 0.0), (100.0, 100.0), (33.33333, 33.3333), (66.66666, 66.6667)],
)
def test_override_steps(percent: float, shown: float) -> None:
    """One step is 1/1,000,000; less than half of it is 0 and holds the axis."""
    bench = axis_bench()
    bench.accepted("set_override", percent=percent)
    start(bench, 1000.0)
    bench.run(100)
    assert bench.column("override_percent")[-1] == shown
    assert (bench.column("set_position")[-1] == 0.0) is (shown == 0.0)


def test_override_acts_on_very_slow_moves_too() -> None:
    """A level below what a table can be made for (1e-9 mm/s) is raised to it; nothing is refused."""
    bench = axis_bench()
    bench.accepted("set_override", percent=0.01)
    start(bench, 1000.0, velocity=1e-6)
    bench.run(100)
    bench.accepted("set_override", percent=0.02)
    bench.run(100)
    assert bench.state == S.DISCRETE_MOTION and 0.0 < bench.column("set_position")[-1] < 1e-6


@pytest.mark.parametrize("percent", [-0.1, 100.01])
def test_override_outside_0_to_100_is_refused(percent: float) -> None:
    bench = axis_bench()
    start(bench, 1000.0)
    bench.run(100)
    assert bench.refusal("set_override", percent=percent) == refused(23006, percent=percent, limit=100.0)
    bench.run(10)
    assert set(bench.column("override_percent")) == {100.0}


# ---------------------------------------------------------------- types


REACHED = 700.0
SHORT = REACHED * (REACHED / A + A / J)
"""A distance that reaches 700 of the 1000 mm/s asked for: 168 mm."""


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("percent", [100.0, 90.0, 71.0, 69.0, 50.0, 10.0])
def test_asked_1000_reachable_700_at_the_start(kind: int, percent: float) -> None:
    """Reduced scales from 700; Original has no effect until below 70 %."""
    bench = axis_bench(count=100, override_type=kind)
    bench.accepted("set_override", percent=percent)
    start(bench, SHORT, velocity=1000.0)
    run_to_standstill(bench)
    level = 0.01 * percent * REACHED if kind in (1, 3) else min(0.01 * percent * 1000.0, REACHED)
    assert max(bench.column("set_velocity")) == pytest.approx(level, rel=1e-4)
    assert bench.column("set_position")[-1] == SHORT


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("percent", [90.0, 71.0, 60.0])
def test_asked_1000_reachable_700_on_the_way(kind: int, percent: float) -> None:
    """At 50 ms the axis has 62.5 mm/s and is on its way to 700."""
    bench, undisturbed = (started(SHORT, 50, override_type=kind, velocity=1000.0) for _ in range(2))
    answer = bench.accepted("set_override", percent=percent)
    for each in (bench, undisturbed):
        run_to_standstill(each)
    level = 0.01 * percent * REACHED if kind in (1, 3) else min(0.01 * percent * 1000.0, REACHED)
    assert max(bench.column("set_velocity")) == pytest.approx(level, rel=1e-4)
    if kind == 2 and percent > 70.0:
        assert answer == IDLE.format(percent, OUT_OF_REACH) and motion(bench) == motion(undisturbed)
    else:
        assert answer == ""
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize("kind", [1, 3])
@pytest.mark.parametrize("cycle", [1, 50, 100, 139])
def test_down_and_up_again_before_the_axis_has_changed_anything(kind: int, cycle: int) -> None:
    """Types 1 and 3: 60 % and 100 % in the same cycle are 100 %, also where the reduced velocity is only touched."""
    bench, undisturbed = (started(SHORT, cycle, override_type=kind, velocity=1000.0) for _ in range(2))
    bench.accepted("set_override", percent=60.0)
    assert bench.accepted("set_override", percent=100.0) == ""
    for each in (bench, undisturbed):
        each.run(700 - cycle)
    for ours, theirs in zip(motion(bench), motion(undisturbed), strict=True):
        assert ours == pytest.approx(theirs, abs=1e-3) and ours[0] == pytest.approx(theirs[0], abs=1e-7)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("cycle", [141, 200, 239, 300])
@pytest.mark.parametrize("percent", [0.0, 60.0])
def test_without_a_stretch_nothing_can_be_changed_once_the_acceleration_falls(
    kind: int, cycle: int, percent: float
) -> None:
    """From 140 ms on (450 mm/s, rising to 700) a stop would end at the target as well: no level acts."""
    bench, undisturbed = (started(SHORT, cycle, override_type=kind, velocity=1000.0) for _ in range(2))
    assert bench.accepted("set_override", percent=percent) == IDLE.format(percent, OUT_OF_REACH)
    for each in (bench, undisturbed):
        each.run(700 - cycle)
    assert motion(bench) == motion(undisturbed) and bench.state == S.STANDSTILL


def test_the_type_can_be_changed_and_counts_from_the_next_override_on() -> None:
    """800 mm reach 1765: half of it is 882 (1), half of the user's velocity 1000 (2)."""
    bench = axis_bench(count=100, override_type=1)
    bench.accepted("set_override", percent=50.0)
    start(bench, 2000.0 + 800.0, velocity=V)
    bench.run(10)
    bench.accepted("new_target", target=800.0)
    bench.accepted("set_override_type", type=2)
    bench.run(300)
    first = max(bench.column("set_velocity"))
    bench.accepted("set_override", percent=50.0)
    run_to_standstill(bench)
    assert first == pytest.approx(0.5 * reachable(800.0), rel=1e-3)
    assert max(bench.column("set_velocity")) == pytest.approx(1000.0)


@pytest.mark.parametrize("kind", [0, 5, -1, 10**9])
def test_there_are_four_types(kind: int) -> None:
    bench, undisturbed = started(3000.0, 100), started(3000.0, 100)
    assert bench.refusal("set_override_type", type=kind) == refused(23035, type=kind)
    for each in (bench, undisturbed):
        each.accepted("set_override", percent=50.0)
        each.run(100)
    assert bench.columns() == undisturbed.columns()


def test_a_type_is_a_whole_number() -> None:
    assert axis_bench().refusal("set_override_type", type=1.5) == refused(22001, argument="type")


# ---------------------------------------------------------------- stop, toggling


@pytest.mark.parametrize("command", ["stop", "halt", "emergency_stop"])
@pytest.mark.parametrize("percent", [0.0, 10.0, 100.0])
def test_in_a_stop_the_override_changes_nothing(command: str, percent: float) -> None:
    arguments = {"deceleration": 20_000.0, "jerk": 500_000.0} if command == "emergency_stop" else {}
    bench, undisturbed = started(3000.0, 700), started(3000.0, 700)
    for each in (bench, undisturbed):
        each.accepted(command, **arguments)
        each.run(20)
    assert bench.accepted("set_override", percent=percent) == IDLE.format(percent, "the axis stops")
    for each in (bench, undisturbed):
        each.run(1000)
    assert motion(bench) == motion(undisturbed)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("levels", [(0.0, 100.0), (0.0001, 100.0), *long([(100.0, 20.0), (60.0, 61.0)])])
@pytest.mark.parametrize("pause", [1, *long([7, 90])])
def test_rapid_toggling_never_steps_and_ends_at_the_target(kind: int, levels: tuple[float, float], pause: int) -> None:
    bench = started(2000.0, 50, override_type=kind)
    for n in range(200):
        bench.accepted("set_override", percent=levels[n % 2])
        bench.run(pause)
    bench.accepted("set_override", percent=0.0)
    bench.run(1200)
    assert bench.column("set_velocity")[-1] == 0.0
    bench.accepted("set_override", percent=100.0)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 2000.0
    assert max(bench.column("set_velocity")) <= V * (1 + 1e-12) and min(bench.column("set_velocity")) >= -1e-9
    assert_axis_smooth(bench, acceleration=A, jerk=J)


# ---------------------------------------------------------------- filter


def filtered(count: int = 10, **changes: float) -> UnitBench:
    """200 steps, 150 ms."""
    return axis_bench(count=count, **{"override_steps": 200, "override_interval": 0.15, **changes})


def test_a_filtered_override_comes_after_the_interval_and_on_a_step() -> None:
    bench = filtered()
    start(bench, 5000.0)
    bench.run(600)
    for percent in (50.2, 40.0, 33.3):
        assert bench.accepted("set_override", percent=percent) == ""
        bench.run(10)
    bench.run(600)
    percents = bench.column("override_percent")
    assert percents[:600] == [100.0] * 600
    assert percents[600:750] == [50.0] * 150 and set(percents[750:]) == {33.5}
    assert bench.column("set_velocity")[-1] == pytest.approx(0.335 * V)
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize(("percent", "velocity"), [(0.0, 0.0), (100.0, V)])
def test_0_and_100_pass_the_filter_at_once(percent: float, velocity: float) -> None:
    bench = filtered()
    start(bench, 5000.0)
    bench.run(600)
    bench.accepted("set_override", percent=60.0)
    bench.run(10)
    bench.accepted("set_override", percent=70.0)
    bench.accepted("set_override", percent=percent)
    bench.run(700)
    assert set(bench.column("override_percent")[610:]) == {percent}
    assert bench.column("set_velocity")[-1] == velocity


@pytest.mark.parametrize("count", [7, *long([1, 150, 1000])])
def test_the_filter_counts_cycles_and_not_blocks(count: int) -> None:
    benches = []
    for size in (10, count):
        bench, rng = filtered(size), random.Random(5)
        start(bench, 20_000.0)
        for _ in range(30):
            bench.accepted("set_override", percent=rng.choice([0.0, 100.0, rng.uniform(1.0, 99.0)]))
            bench.run(rng.randrange(400))
        benches.append(bench)
    assert benches[0].columns() == benches[1].columns()
    assert_axis_smooth(benches[1], acceleration=A, jerk=J)


def test_a_waiting_override_counts_for_a_start_after_its_cycle_only() -> None:
    bench = filtered()
    bench.accepted("set_override", percent=80.0)
    bench.accepted("set_override", percent=20.0)
    bench.run(140)
    start(bench, 5000.0)
    bench.run(1500)
    percents = bench.column("override_percent")
    assert percents[149] == 80.0 and percents[150] == 20.0
    assert max(bench.column("set_velocity")) == pytest.approx(0.2 * V)
