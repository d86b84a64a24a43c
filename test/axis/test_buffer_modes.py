"""Buffer modes of PLCopen: motions that abort the active one, wait for its end, or are blended with it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
from axis_motion_support import assert_follows, legs_to, motion, run_to_standstill
from axis_states_support import DYNAMICS, STATES, A, J
from error_support import refused
from job_support import ABORTED, ACTIVE, DONE, FAILED, end_of, job, start_of, told
from machine_support import CYCLE_TIME, UnitBench, assert_axis_smooth, axis_bench

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.blocks import JobEvent

IN_MOTION = ("moving", "braking", "held", "returning", "halting", "jogging", "jog_ended")
MODES = ("aborting", "buffered", "blending_low", "blending_previous", "blending_next", "blending_high")
MODULO = {"modulo": True, "modulo_high": 360.0, "soft_limit_negative": -math.inf, "soft_limit_positive": math.inf}
POSITIONINGS = {"move_absolute": {"target": 900.0}, "move_relative": {"distance": 500.0}}


def situation(name: str, count: int = 10, **changes: Any) -> UnitBench:
    """An axis in motion, see axis_states_support."""
    bench = axis_bench(count=count, **changes)
    STATES[name][0](bench)
    return bench


def assert_smooth(bench: UnitBench) -> None:
    assert_axis_smooth(bench, acceleration=A, jerk=J)


# ---------------------------------------------------------------- aborting


@pytest.mark.parametrize("target", [3500.0, 300.0, -800.0])
@pytest.mark.parametrize("name", [name for name in IN_MOTION if name != "held"])
def test_an_aborting_motion_plans_from_the_state_of_its_cycle(name: str, target: float) -> None:
    """As Ruckig does, by a stop where it has to return (TX1250 2.3)."""
    bench = situation(name)
    at = bench.cycle
    number = job(bench, "move_absolute", target=target, buffer_mode="aborting", **DYNAMICS)
    run_to_standstill(bench)
    state = motion(bench)[at]
    assert_follows(bench, at, legs_to(state, target))
    assert bench.column("state")[at] == S.DISCRETE_MOTION and bench.column("set_position")[-1] == target
    assert end_of(bench, number).status == DONE and end_of(bench, number - 1).status == ABORTED
    assert not bench.last.status_bits[-1] & StatusBit.HAS_BEEN_STOPPED
    assert_smooth(bench)


def test_the_new_dynamics_count() -> None:
    """From 2000 mm/s down to 500, with the A- and J of the new motion."""
    bench = axis_bench()
    bench.accepted("move_absolute", target=9000.0, **DYNAMICS)
    bench.run(700)
    slow = {"velocity": 500.0, "acceleration": 1000.0, "deceleration": 1000.0, "jerk": 10_000.0}
    at = bench.cycle
    bench.accepted("move_absolute", target=5000.0, buffer_mode="aborting", **slow)
    run_to_standstill(bench)
    assert_follows(bench, at, legs_to(motion(bench)[at], 5000.0, 500.0, 1000.0, 10_000.0))
    assert bench.column("set_velocity")[at + 2000] == pytest.approx(500.0)
    assert_smooth(bench)


@pytest.mark.parametrize("target", [1300.0, 1000.0, 200.0])
def test_weak_dynamics_brake_as_strongly_as_the_motion_before_where_they_would_lead_past(target: float) -> None:
    """At 2000 mm/s and 700 mm: A- 100 would need 20 m and leave the soft limits; the return is weak again."""
    limits = {"soft_limit_negative": -100.0, "soft_limit_positive": 2000.0}
    bench = axis_bench(**limits)
    bench.accepted("move_absolute", target=2000.0, **DYNAMICS)
    bench.run(600)
    at, weak = bench.cycle, {"velocity": 2000.0, "acceleration": 100.0, "deceleration": 100.0, "jerk": 1000.0}
    bench.accepted("move_absolute", target=target, buffer_mode="aborting", **weak)
    run_to_standstill(bench)
    positions = bench.column("set_position")
    assert positions[-1] == target
    stop = positions[at] + 0.5 * 2000.0 * (2000.0 / A + A / J)
    assert max(positions) <= max(target, stop) + 2.0
    turned = positions.index(max(positions))
    back = bench.column("set_acceleration")[turned + 2 :]
    assert max(map(abs, back), default=0.0) <= 100.0 * (1.0 + 1e-9)
    assert_smooth(bench)


def test_a_strong_ramp_holds_when_the_override_comes_meanwhile() -> None:
    """The axis stops no later than without override, and ends in its target."""
    bench = axis_bench(soft_limit_positive=2000.0)
    bench.accepted("move_absolute", target=2000.0, **DYNAMICS)
    bench.run(700)
    bench.accepted(
        "move_absolute", target=1450.0, velocity=2000.0, deceleration=200.0, jerk=2000.0, buffer_mode="aborting"
    )
    bench.run(100)
    bench.accepted("set_override", percent=0.0)
    bench.run(1000)
    assert bench.column("set_position")[-1] <= 1450.0 and bench.column("set_velocity")[-1] == 0.0
    bench.accepted("set_override", percent=100.0)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 1450.0 == max(bench.column("set_position"))
    assert_smooth(bench)


def test_a_motion_that_override_0_holds_is_aborted_too() -> None:
    bench = situation("held")
    number = job(bench, "move_absolute", target=1.0, buffer_mode="aborting", **DYNAMICS)
    bench.run(100)
    assert bench.column("set_velocity")[-1] == 0.0 and bench.state == S.DISCRETE_MOTION
    bench.accepted("set_override", percent=100.0)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 1.0 and end_of(bench, number).status == DONE


def test_an_aborting_relative_motion_counts_from_the_set_position_and_an_additive_one_from_the_target() -> None:
    relative, additive = situation("moving"), situation("moving")
    at = relative.cycle
    relative.accepted("move_relative", distance=2000.0, buffer_mode="aborting", **DYNAMICS)
    additive.accepted("move_additive", distance=-500.0, buffer_mode="aborting", **DYNAMICS)
    for bench in (relative, additive):
        run_to_standstill(bench)
        assert_smooth(bench)
    assert relative.column("set_position")[-1] == relative.column("set_position")[at] + 2000.0
    assert additive.column("set_position")[-1] == 3000.0 - 500.0


@pytest.mark.parametrize(
    ("before", "counts_from"),
    [("standing", 0.0), ("halting", 3000.0), ("jogging", None), ("returning", 100.0)],
)
def test_additive_motion_counts_from_the_last_target_whatever_has_become_of_it(
    before: str, counts_from: float | None
) -> None:
    """After a motion at a velocity there is none; then it counts from the set position."""
    bench = situation(before)
    at = bench.cycle
    bench.accepted("move_additive", distance=50.0, buffer_mode="aborting", **DYNAMICS)
    run_to_standstill(bench)
    start = bench.column("set_position")[at] if counts_from is None else counts_from
    assert bench.column("set_position")[-1] == start + 50.0


def test_additive_motion_counts_from_a_target_that_a_stop_has_prevented() -> None:
    bench = situation("stopping")
    run_to_standstill(bench)
    bench.accepted("move_additive", distance=-100.0, **DYNAMICS)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 2900.0


# ---------------------------------------------------------------- buffered


@pytest.mark.parametrize("count", [1, 7, 10])
@pytest.mark.parametrize("command", POSITIONINGS)
def test_a_buffered_motion_begins_in_the_cycle_in_which_the_active_one_ends(command: str, count: int) -> None:
    """From rest, bit by bit as from Standstill; no cycle is lost."""
    bench = axis_bench(count=count)
    first = job(bench, "move_absolute", target=400.0, **DYNAMICS)
    bench.run(100)
    second = job(bench, command, buffer_mode="buffered", **POSITIONINGS[command], **DYNAMICS)
    run_to_standstill(bench)
    end = end_of(bench, first)
    assert end == JobEvent(first, DONE, end.cycle) and start_of(bench, second) == end.cycle
    assert motion(bench)[end.cycle] == (400.0, 0.0, 0.0) != motion(bench)[end.cycle - 1]
    assert S.STANDSTILL not in bench.column("state")[1 : end_of(bench, second).cycle]
    alone = axis_bench(start_position=400.0, count=count)
    alone.accepted("move_absolute", target=900.0, **DYNAMICS)
    run_to_standstill(alone)
    ours, theirs = motion(bench)[end.cycle :], motion(alone)
    assert ours[: len(theirs) - 200] == theirs[: len(theirs) - 200]
    assert ours[-1] == (900.0, 0.0, 0.0)
    assert_smooth(bench)


def test_it_begins_immediately_from_standstill() -> None:
    bench = axis_bench()
    number = job(bench, "move_absolute", target=400.0, buffer_mode="buffered", **DYNAMICS)
    run_to_standstill(bench)
    assert told(bench) == [(number, ACTIVE), (number, DONE)]


@pytest.mark.parametrize("name", ["halting", "jog_ended"])
def test_it_waits_for_the_end_of_a_halt(name: str) -> None:
    """A relative one counts from where the halt ends."""
    bench = situation(name)
    number = job(bench, "move_relative", distance=-30.0, buffer_mode="buffered", **DYNAMICS)
    run_to_standstill(bench)
    end = end_of(bench, number - 1)
    assert end.status == DONE and start_of(bench, number) == end.cycle
    assert bench.column("set_position")[-1] == bench.column("set_position")[end.cycle] - 30.0
    assert_smooth(bench)


def test_it_waits_until_a_motion_at_a_velocity_has_it() -> None:
    """Only then, without a stop; the ramp to 500 mm/s takes 0.2 s."""
    bench = axis_bench()
    first = job(bench, "move_velocity", velocity=500.0)
    bench.run(50)
    second = job(bench, "move_velocity", velocity=800.0, buffer_mode="buffered")
    bench.run(2000)
    end = end_of(bench, first)
    assert (end.status, end.cycle) == (DONE, start_of(bench, second)) and end.cycle == 200
    assert motion(bench)[200][1:] == (500.0, 0.0) and motion(bench)[-1][1] == pytest.approx(800.0)
    third = job(bench, "move_relative", distance=1000.0, buffer_mode="buffered", **DYNAMICS)
    at = bench.cycle
    run_to_standstill(bench)
    assert start_of(bench, third) == at == end_of(bench, second).cycle
    assert bench.column("set_position")[-1] == bench.column("set_position")[at] + 1000.0
    assert_smooth(bench)


def test_a_motion_at_a_velocity_that_never_has_it_is_followed_at_the_soft_limit() -> None:
    bench = axis_bench(soft_limit_positive=50.0)
    first = job(bench, "move_velocity", velocity=2000.0)
    bench.run(20)
    second = job(bench, "move_absolute", target=10.0, buffer_mode="buffered", **DYNAMICS)
    run_to_standstill(bench)
    assert end_of(bench, first).cycle == start_of(bench, second)
    assert bench.column("set_position")[end_of(bench, first).cycle] == 50.0
    assert bench.column("set_position")[-1] == 10.0


def test_a_modulo_motion_counts_from_the_target_of_the_one_before() -> None:
    bench = axis_bench(**MODULO)
    bench.accepted("move_modulo", position=350.0, **DYNAMICS)
    bench.run(10)
    bench.accepted("move_modulo", position=-340.0, buffer_mode="buffered", **DYNAMICS)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == pytest.approx(340.0, abs=1e-9)
    bench.accepted("move_velocity", velocity=100.0)
    bench.run(10)
    bench.accepted("move_modulo", position=10.0, buffer_mode="buffered", **DYNAMICS)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == pytest.approx(370.0, abs=1e-9)


def test_it_waits_as_long_as_override_0_holds_the_active_motion() -> None:
    bench = situation("held")
    number = job(bench, "move_relative", distance=5.0, buffer_mode="buffered", **DYNAMICS)
    bench.run(3000)
    assert end_of.__name__ and told(bench)[-1] == (number - 1, ACTIVE)
    bench.accepted("set_override", percent=100.0)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 3005.0 and end_of(bench, number).status == DONE


def test_a_compensation_comes_to_rest_before() -> None:
    """With VP far below the velocity it lags behind the basic motion."""
    bench = axis_bench()
    first = job(bench, "move_absolute", target=600.0, velocity=600.0, deceleration=A, jerk=J)
    bench.run(300)
    compensation = {"length": 500.0, "difference": 20.0, "process_velocity": 10.0, "velocity_increase": 200.0}
    bench.accepted("compensation_start", **compensation, acceleration=300.0, deceleration=100.0)
    second = job(bench, "move_relative", distance=100.0, buffer_mode="buffered", **DYNAMICS)
    run_to_standstill(bench)
    end = end_of(bench, first).cycle
    assert end == start_of(bench, second) and bench.column("set_velocity")[end] == 0.0
    assert bench.column("set_position")[-1] == pytest.approx(bench.column("set_position")[end] + 100.0, abs=1e-9)


# ---------------------------------------------------------------- the end of waiting

ENDS: dict[str, tuple[Callable[[UnitBench], Any], int]] = {
    "stop": (lambda bench: bench.accepted("stop"), DONE),
    "halt": (lambda bench: bench.accepted("halt"), DONE),
    "emergency_stop": (lambda bench: bench.accepted("emergency_stop", deceleration=9000.0, jerk=90_000.0), DONE),
    "aborting": (lambda bench: bench.accepted("move_absolute", target=-50.0, buffer_mode="aborting", **DYNAMICS), DONE),
    "new target": (lambda bench: bench.accepted("new_target", target=-60.0), DONE),
    "reset": (lambda bench: bench.accepted("reset"), ABORTED),
    "power off": (lambda bench: bench.accepted("power", enabled=False), ABORTED),
    "fault": (lambda bench: bench.accepted("upstream_lost", source="plc"), FAILED),
}


@pytest.mark.parametrize("mode", ["buffered", "blending_high"])
@pytest.mark.parametrize("end", ENDS)
def test_what_ends_the_active_motion_drops_the_one_that_waits(end: str, mode: str) -> None:
    bench = situation("moving")
    waiting = job(bench, "move_absolute", target=3500.0, buffer_mode=mode, **DYNAMICS)
    bench.run(100)
    at = bench.cycle
    ENDS[end][0](bench)
    run = 6000
    bench.run(run)
    assert end_of(bench, waiting) == JobEvent(waiting, ABORTED, at)
    assert (waiting, ACTIVE) not in told(bench)
    first = end_of(bench, waiting - 1)
    assert first.status in (ABORTED, FAILED) and first.cycle == at
    assert bench.column("set_velocity")[-1] == 0.0 and bench.column("set_position")[-1] < 3000.0
    assert not bench.accepted("power", enabled=True) if end == "power off" else True


def test_only_one_motion_waits() -> None:
    bench = situation("moving")
    bench.accepted("move_absolute", target=3500.0, buffer_mode="buffered", **DYNAMICS)
    for mode in MODES[1:]:
        assert bench.refusal("move_absolute", target=1.0, buffer_mode=mode) == refused(23063, job=2)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 3500.0


def test_a_motion_that_leads_beyond_a_limit_is_refused_when_that_is_known() -> None:
    bench = axis_bench(soft_limit_positive=100.0)
    bench.accepted("move_absolute", target=80.0)
    bench.run(10)
    for arguments in ({"buffer_mode": "buffered"}, {"buffer_mode": "blending_low"}):
        assert bench.refusal("move_relative", distance=20.5, **arguments) == refused(120002, target=100.5, limit=100.0)


def test_a_motion_that_is_refused_at_its_turn_has_failed() -> None:
    """Where a motion at a velocity has it is not known before; it continues."""
    bench = axis_bench(soft_limit_positive=1000.0)
    first = job(bench, "move_velocity", velocity=500.0)
    bench.run(10)
    second = job(bench, "move_relative", distance=980.0, buffer_mode="buffered", **DYNAMICS)
    bench.run(1000)
    assert told(bench) == [(first, ACTIVE), (second, FAILED)]
    assert end_of(bench, second) == JobEvent(second, FAILED, 200, 120002)
    assert bench.event_texts() == [
        "P-ERR-120002 axis x: move_relative refused: target 1030.0 mm lies beyond the positive soft limit 1000.0 mm "
        "(P-AXIS-00178); nothing was changed"
    ]
    assert motion(bench)[-1][1] == pytest.approx(500.0) and bench.state == S.CONTINUOUS_MOTION


def test_a_blended_motion_that_is_refused_at_its_turn_halts_the_axis() -> None:
    """External setpoints are enabled meanwhile."""
    bench = axis_bench()
    first = job(bench, "move_absolute", target=500.0, **DYNAMICS)
    bench.run(10)
    second = job(bench, "move_relative", distance=400.0, buffer_mode="blending_previous", **DYNAMICS)
    bench.accepted("external_enable", mode="relative")
    bench.run(3000)
    assert end_of(bench, first).status == DONE
    assert end_of(bench, second) == JobEvent(second, FAILED, end_of(bench, first).cycle, 23027)
    assert 500.0 < bench.column("set_position")[-1] <= 900.0 and bench.column("set_velocity")[-1] == 0.0
    assert bench.last.status_bits[-1] & StatusBit.HAS_BEEN_STOPPED


# ---------------------------------------------------------------- blending

SLOW, FAST = 400.0, 900.0
EXPECTED = {
    "blending_low": (SLOW, SLOW),
    "blending_previous": (SLOW, FAST),
    "blending_next": (FAST, SLOW),
    "blending_high": (FAST, FAST),
}
"""Velocity in the first target when the first motion is the slow one, and when it is the fast one."""


def blended(mode: str, first: float, second: float, *, at: int = 100, **more: Any) -> UnitBench:
    """500 mm, then to 1200 mm; the second motion is given after `at` cycles."""
    bench = axis_bench(count=more.pop("count", 10))
    bench.accepted("move_absolute", target=500.0, **DYNAMICS | {"velocity": first})
    bench.run(at)
    bench.accepted("move_absolute", target=1200.0, buffer_mode=mode, **DYNAMICS | {"velocity": second} | more)
    run_to_standstill(bench)
    return bench


@pytest.mark.parametrize("fast_first", [False, True])
@pytest.mark.parametrize("mode", EXPECTED)
def test_the_first_target_is_passed_at_the_velocity_of_the_mode(mode: str, fast_first: bool) -> None:
    first, second = (FAST, SLOW) if fast_first else (SLOW, FAST)
    bench = blended(mode, first, second)
    turn = end_of(bench, 1).cycle
    assert start_of(bench, 2) == turn and end_of(bench, 1).status == DONE
    position, velocity, acceleration = motion(bench)[turn]
    assert velocity == pytest.approx(EXPECTED[mode][fast_first], rel=1e-12) and acceleration == 0.0
    assert 500.0 <= position < 500.0 + velocity * CYCLE_TIME
    assert_follows(bench, turn, legs_to(motion(bench)[turn], 1200.0, second))
    assert bench.column("set_position")[-1] == 1200.0 and S.STANDSTILL not in bench.column("state")[1:turn]
    assert_smooth(bench)


def test_a_motion_in_the_other_direction_stops_in_the_first_target() -> None:
    bench = axis_bench()
    bench.accepted("move_absolute", target=500.0, **DYNAMICS)
    bench.run(100)
    bench.accepted("move_absolute", target=100.0, buffer_mode="blending_high", **DYNAMICS)
    run_to_standstill(bench)
    assert motion(bench)[end_of(bench, 1).cycle] == (500.0, 0.0, 0.0)
    assert max(bench.column("set_position")) == 500.0 and bench.column("set_position")[-1] == 100.0


@pytest.mark.parametrize("distance", [0.05, 1.0, 20.0, 60.0])
def test_a_short_second_motion_is_entered_so_slowly_that_it_can_end(distance: float) -> None:
    """From 2000 mm/s the stop takes 500 mm; the axis never passes the second target."""
    bench = axis_bench()
    bench.accepted("move_absolute", target=1500.0, **DYNAMICS)
    bench.run(100)
    bench.accepted("move_relative", distance=distance, buffer_mode="blending_high", **DYNAMICS)
    run_to_standstill(bench)
    positions = bench.column("set_position")
    assert max(positions) == positions[-1] == 1500.0 + distance
    assert bench.column("set_velocity")[end_of(bench, 1).cycle] > 0.0
    assert_smooth(bench)


@pytest.mark.parametrize("at", [540, 570, 599])
def test_a_motion_that_comes_too_late_is_blended_as_well_as_possible(at: int) -> None:
    """In the brake phase of the first one, while it still lowers its acceleration; it ends after 0.7 s."""
    bench = axis_bench()
    bench.accepted("move_absolute", target=250.0, **DYNAMICS | {"velocity": 500.0})
    bench.run(at)
    bench.accepted("move_absolute", target=1200.0, buffer_mode="blending_previous", **DYNAMICS | {"velocity": 500.0})
    run_to_standstill(bench)
    assert 0.0 < bench.column("set_velocity")[end_of(bench, 1).cycle] <= 500.0 * (1.0 + 1e-12)
    assert bench.column("set_position")[-1] == 1200.0
    assert_smooth(bench)


@pytest.mark.parametrize("percents", [(50.0,), (50.0, 100.0), (0.0, 100.0), (20.0, 0.0, 60.0, 100.0)])
def test_the_override_acts_on_both_and_on_the_velocity_between(percents: tuple[float, ...]) -> None:
    bench = axis_bench()
    bench.accepted("move_absolute", target=500.0, **DYNAMICS | {"velocity": SLOW})
    bench.run(100)
    bench.accepted("move_absolute", target=1200.0, buffer_mode="blending_next", **DYNAMICS | {"velocity": FAST})
    for percent in percents:
        bench.run(150)
        bench.accepted("set_override", percent=percent)
    run_to_standstill(bench)
    turn = end_of(bench, 1).cycle
    assert bench.column("set_velocity")[turn] == pytest.approx(FAST * percents[-1] / 100.0, rel=1e-9)
    assert bench.column("set_position")[-1] == 1200.0
    assert_smooth(bench)


def test_override_0_may_stop_the_axis_behind_the_first_target() -> None:
    """Then the second motion is the active one, and is held."""
    bench = axis_bench()
    bench.accepted("move_absolute", target=500.0, **DYNAMICS)
    bench.run(100)
    bench.accepted("move_absolute", target=3000.0, buffer_mode="blending_high", **DYNAMICS)
    bench.run(400)
    bench.accepted("set_override", percent=0.0)
    bench.run(1000)
    assert bench.column("set_position")[-1] > 500.0 and end_of(bench, 1).status == DONE
    assert bench.column("set_velocity")[-1] == 0.0 and bench.last.status_bits[-1] & StatusBit.HAS_JOB
    bench.accepted("set_override", percent=100.0)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 3000.0
    assert_smooth(bench)


def test_a_velocity_that_becomes_active_on_the_way_leaves_the_blending_alone() -> None:
    bench = axis_bench()
    bench.accepted("move_absolute", target=900.0, **DYNAMICS | {"velocity": SLOW})
    bench.run(100)
    bench.accepted("new_velocity_and_target", velocity=FAST, target=1000.0, activation_position=300.0)
    bench.accepted("move_absolute", target=2000.0, buffer_mode="blending_low", **DYNAMICS | {"velocity": SLOW})
    run_to_standstill(bench)
    turn = start_of(bench, 3)
    assert bench.column("set_velocity")[turn] == pytest.approx(SLOW, rel=1e-12)
    assert max(bench.column("set_velocity")) == pytest.approx(FAST) and bench.column("set_position")[-1] == 2000.0
    assert_smooth(bench)


def test_a_motion_at_a_velocity_may_be_blended_behind_a_positioning() -> None:
    bench = axis_bench()
    bench.accepted("move_absolute", target=500.0, **DYNAMICS | {"velocity": SLOW})
    bench.run(100)
    bench.accepted("move_velocity", velocity=FAST, buffer_mode="blending_next")
    bench.run(2000)
    turn = end_of(bench, 1).cycle
    assert bench.column("set_velocity")[turn] == pytest.approx(FAST) and bench.state == S.CONTINUOUS_MOTION
    assert bench.column("set_velocity")[-1] == pytest.approx(FAST)
    assert_smooth(bench)


@pytest.mark.parametrize("mode", [*MODES[1:]])
def test_the_turn_does_not_depend_on_the_size_of_blocks(mode: str) -> None:
    benches = [blended(mode, SLOW, FAST, count=count) for count in (1000, 1, 7)]
    lengths = min(len(bench.column("state")) for bench in benches)
    columns = [{name: column[:lengths] for name, column in bench.columns().items()} for bench in benches]
    assert columns[0] == columns[1] == columns[2]
    assert len({tuple(told(bench)) for bench in benches}) == 1


# ---------------------------------------------------------------- states


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", ["disabled", "stopping", "waiting", "powered_off_in_motion", "on_path", "error_stop"])
def test_a_locked_axis_refuses_every_mode(name: str, mode: str) -> None:
    bench = situation(name)
    state = "".join(part.capitalize() for part in STATES[name][1].name.split("_"))
    assert bench.refusal("move_absolute", target=1.0, buffer_mode=mode) == refused(23005, state=state)


def test_without_a_mode_a_motion_starts_from_standstill_only() -> None:
    for name in IN_MOTION:
        bench = situation(name)
        for command, arguments in (
            *POSITIONINGS.items(),
            ("move_additive", {"distance": 1.0}),
            ("move_velocity", {"velocity": 1.0}),
        ):
            assert bench.refusal(command, **arguments)[0] == 23005
