"""Motion at a velocity (MC_MoveVelocity): ramps by Ruckig, its own dynamics, the soft limit, its job."""

from __future__ import annotations

import math

import pytest
from axis_motion_support import assert_follows, motion, run_to_standstill, to_velocity
from axis_states_support import DYNAMICS, STATES, A, J
from error_support import refused
from job_support import ABORTED, ACTIVE, DONE, end_of, job, start_of, told
from machine_support import assert_axis_smooth, axis_bench

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.blocks import JobEvent

ENDLESS = {"modulo": True, "modulo_high": 360.0, "soft_limit_negative": -math.inf, "soft_limit_positive": math.inf}


@pytest.mark.parametrize("velocity", [700.0, -700.0])
@pytest.mark.parametrize("changes", [{}, ENDLESS])
def test_it_ramps_to_the_velocity_with_its_own_dynamics(velocity: float, changes: dict[str, float]) -> None:
    bench = axis_bench(**changes)
    number = job(bench, "move_velocity", velocity=velocity, acceleration=1000.0, deceleration=3000.0, jerk=20_000.0)
    bench.run(2000)
    assert_follows(bench, 0, [to_velocity((0.0, 0.0, 0.0), velocity, 1000.0, 20_000.0)])
    assert bench.state == S.CONTINUOUS_MOTION and told(bench) == [(number, ACTIVE)]
    assert bench.last.target_velocity == 700.0


@pytest.mark.parametrize("changes", [{}, ENDLESS])
@pytest.mark.parametrize("name", ["moving", "halting", "jogging"])
def test_it_aborts_any_motion_and_is_aborted_by_any(name: str, changes: dict[str, float]) -> None:
    bench = axis_bench(**changes)
    STATES[name][0](bench)
    at, first = bench.cycle, job(bench, "move_velocity", velocity=1200.0, buffer_mode="aborting")
    bench.run(1000)
    assert_follows(bench, at, [to_velocity(motion(bench)[at], 1200.0)])
    second = job(bench, "move_absolute", target=5000.0, buffer_mode="aborting", **DYNAMICS)
    run_to_standstill(bench)
    assert end_of(bench, first - 1).status == ABORTED == end_of(bench, first).status
    assert end_of(bench, second).status == DONE and bench.column("set_position")[-1] == 5000.0
    assert_axis_smooth(bench, acceleration=A, jerk=J)


def test_in_the_other_direction_a_linear_axis_comes_to_rest_first() -> None:
    """With the ramp of the motion before, as its own would lead beyond the other soft limit."""
    bench = axis_bench(soft_limit_positive=1000.0)
    bench.accepted("move_velocity", velocity=1000.0)
    bench.run(900)
    bench.accepted("move_velocity", velocity=-100.0, deceleration=100.0, jerk=1000.0, buffer_mode="aborting")
    bench.run(1500)
    assert max(bench.column("set_position")) < 1000.0 and motion(bench)[-1][1] == pytest.approx(-100.0)
    assert_axis_smooth(bench, acceleration=A, jerk=J)


def test_it_ends_at_the_soft_limit_and_its_job_is_aborted() -> None:
    bench = axis_bench(soft_limit_negative=-300.0)
    number = job(bench, "move_velocity", velocity=-500.0)
    run_to_standstill(bench)
    assert motion(bench)[-1] == (-300.0, 0.0, 0.0) and end_of(bench, number).status == ABORTED
    assert bench.event_texts() == [
        "P-ERR-23070 axis x: the motion at a velocity has reached the negative soft limit -300.0 mm (P-AXIS-00177); "
        "the axis is at a standstill"
    ]
    assert bench.refusal("move_velocity", velocity=-5.0) == refused(120003, limit=-300.0)
    bench.accepted("move_velocity", velocity=5.0)


def test_the_job_of_a_jog_at_the_soft_limit_is_aborted_too() -> None:
    bench = axis_bench(soft_limit_positive=30.0)
    number = job(bench, "jog", velocity=500.0)
    run_to_standstill(bench)
    assert end_of(bench, number).status == ABORTED


def test_a_jog_neither_changes_nor_ends_it() -> None:
    """The topic of the jog belongs to whoever jogs."""
    bench = axis_bench()
    bench.accepted("move_velocity", velocity=500.0)
    bench.run(500)
    assert bench.refusal("jog", velocity=100.0) == refused(23005, state="ContinuousMotion")
    bench.accepted("jog", velocity=0.0)
    bench.run(500)
    assert motion(bench)[-1][1] == 500.0 and told(bench) == [(1, ACTIVE)]
    bench.accepted("halt")
    bench.run(10)
    assert bench.state == S.DISCRETE_MOTION and bench.refusal("jog", velocity=100.0)[0] == 23005


def test_it_can_be_halted_and_continued() -> None:
    """A halt does not lock the axis (PLCopen)."""
    bench = axis_bench()
    bench.accepted("move_velocity", velocity=500.0)
    bench.run(500)
    bench.accepted("halt")
    bench.run(60)
    bench.accepted("move_velocity", velocity=400.0, buffer_mode="aborting")
    bench.run(1000)
    assert min(bench.column("set_velocity")[500:]) > 200.0 and motion(bench)[-1][1] == pytest.approx(400.0)
    assert_axis_smooth(bench, acceleration=A, jerk=J)


# ---------------------------------------------------------------- velocity 0 (PLCopen: permitted)


@pytest.mark.parametrize("velocity", [700.0, -700.0])
def test_at_velocity_0_it_comes_to_rest_and_waits(velocity: float) -> None:
    """On the ramp of the command, in ContinuousMotion; the job lasts until another motion."""
    bench = axis_bench()
    first = job(bench, "move_velocity", velocity=velocity)
    bench.run(1000)
    second = job(bench, "move_velocity", velocity=0.0, deceleration=700.0, jerk=7000.0, buffer_mode="aborting")
    bench.run(1500)
    assert_follows(bench, 1000, [to_velocity((motion(bench)[1000][0], velocity, 0.0), 0.0, 700.0, 7000.0)])
    assert motion(bench)[-1][1:] == (0.0, 0.0) and bench.state == S.CONTINUOUS_MOTION
    where = motion(bench)[1000][0] + velocity * 0.5 * (1.0 + 0.1)
    assert motion(bench)[-1][0] == pytest.approx(where, abs=1e-9) and bench.last.target_velocity == 0.0
    assert told(bench) == [(first, ACTIVE), (first, ABORTED), (second, ACTIVE)]
    third = job(bench, "move_absolute", target=5.0, buffer_mode="aborting", **DYNAMICS)
    run_to_standstill(bench)
    assert told(bench)[3:] == [(second, ABORTED), (third, ACTIVE), (third, DONE)] and motion(bench)[-1][0] == 5.0
    assert_axis_smooth(bench, acceleration=A, jerk=J)


def test_at_velocity_0_from_a_standstill() -> None:
    """Neither an override nor a feed release change it; a halt ends it."""
    bench = axis_bench(start_position=7.0)
    number = job(bench, "move_velocity", velocity=0.0)
    bench.accepted("set_override", percent=0.0)
    bench.accepted("set_feed_release", forward=False, backward=False)
    bench.run(50)
    bench.accepted("set_override", percent=50.0)
    bench.accepted("set_feed_release", forward=True, backward=True)
    bench.run(50)
    assert set(bench.column("state")) == {S.CONTINUOUS_MOTION} and set(motion(bench)) == {(7.0, 0.0, 0.0)}
    assert not any(bit & StatusBit.FEED_WITHHELD for bit in bench.column("status_bits"))
    halt = job(bench, "halt")
    bench.run(10)
    assert told(bench) == [(number, ACTIVE), (number, ABORTED), (halt, ACTIVE), (halt, DONE)]
    assert bench.state == S.STANDSTILL


def test_a_motion_that_is_buffered_behind_velocity_0_begins_at_rest() -> None:
    bench = axis_bench()
    bench.accepted("move_velocity", velocity=700.0)
    bench.run(1000)
    first = job(bench, "move_velocity", velocity=0.0, deceleration=700.0, jerk=7000.0, buffer_mode="aborting")
    second = job(bench, "move_absolute", target=0.0, buffer_mode="buffered", **DYNAMICS)
    run_to_standstill(bench)
    assert end_of(bench, first) == JobEvent(first, DONE, 2100) and start_of(bench, second) == 2100
    assert motion(bench)[2100][1] == 0.0 and motion(bench)[-1] == (0.0, 0.0, 0.0)


def test_a_weak_ramp_to_velocity_0_leads_beyond_no_soft_limit() -> None:
    """With 100 mm/s² alone it would need 5 m: the ramp of the motion before counts."""
    bench = axis_bench(soft_limit_positive=1000.0)
    bench.accepted("move_velocity", velocity=1000.0)
    bench.run(900)
    bench.accepted("move_velocity", velocity=0.0, deceleration=100.0, jerk=1000.0, buffer_mode="aborting")
    bench.run(1500)
    assert max(bench.column("set_position")) < 1000.0 and bench.state == S.CONTINUOUS_MOTION
    assert_axis_smooth(bench, acceleration=A, jerk=J)


def test_what_goes_on_at_velocity_0() -> None:
    """A superimposed motion and a new target lead the axis away; there is nothing to compensate."""
    bench = axis_bench()
    bench.accepted("move_velocity", velocity=0.0)
    added = job(bench, "move_superimposed", distance=20.0, velocity_difference=50.0)
    bench.run(2000)
    assert motion(bench)[-1] == (20.0, 0.0, 0.0) and end_of(bench, added).status == DONE
    assert bench.state == S.CONTINUOUS_MOTION
    compensation = {"length": 20.0, "difference": 5.0, "process_velocity": 100.0, "velocity_increase": 100.0}
    assert bench.refusal("compensation_start", **compensation) == refused(23021, state="ContinuousMotion")
    assert bench.refusal("jog", velocity=5.0) == refused(23005, state="ContinuousMotion")
    bench.accepted("new_target", target=3.0)
    run_to_standstill(bench)
    assert motion(bench)[-1] == (3.0, 0.0, 0.0) and bench.state == S.STANDSTILL


@pytest.mark.parametrize("percents", [(50.0,), (0.0, 30.0)])
def test_the_override_acts(percents: tuple[float, ...]) -> None:
    bench = axis_bench()
    bench.accepted("move_velocity", velocity=-800.0)
    for percent in percents:
        bench.run(500)
        bench.accepted("set_override", percent=percent)
    bench.run(1000)
    assert motion(bench)[-1][1] == pytest.approx(-8.0 * percents[-1])
