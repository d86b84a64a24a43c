"""Power, reset, watchdog and faults of an axis."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from axis_states_support import (
    DYNAMICS,
    disabled,
    error_stop,
    follow_path,
    moving,
    on_path,
    path_block,
    powered_off_in_motion,
    stopping,
)
from machine_support import UnitBench, assert_axis_smooth, axis_bench

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit


@pytest.mark.parametrize("source", ["plc", "clock", "channel"])
def test_watchdog_texts(source: str) -> None:
    bench = axis_bench()
    on_path(bench)
    bench.accepted("upstream_lost", source=source)
    bench.run(200)
    lost = f"P-ERR-26101 axis x: no block of '{source}' came within the watchdog time"
    with_path = [f"{lost}; the axis stops with its path"] if source == "plc" else []
    assert bench.event_texts() == [*with_path, f"{lost}; the axis stops on its own ramp (ErrorStop)"]
    assert_axis_smooth(bench.blocks[2:], acceleration=5000.0, jerk=50_000.0)
    assert set(bench.column("error_id")[30:]) == {26101}


def test_a_path_continues_in_one_cycle_at_its_velocity_before_the_ramp_begins() -> None:
    """The last setpoint of the path is extrapolated by one cycle: c of the fault is on the old motion."""
    bench = axis_bench()
    on_path(bench)  # 100 mm/s, last setpoint 2.9 mm
    bench.accepted("upstream_lost", source="channel")
    bench.run(200)
    assert bench.column("set_position")[29:31] == pytest.approx([2.9, 3.0], abs=1e-12)
    assert bench.column("set_velocity")[30] == pytest.approx(100.0)
    stop_time = 2.0 * math.sqrt(100.0 / 50_000.0)  # A- is not reached
    assert bench.column("set_position")[-1] == pytest.approx(3.0 + 0.5 * 100.0 * stop_time, abs=1e-9)


# ---------------------------------------------------------------- power, reset


def test_power_off_while_moving_ramps_down_and_then_disables() -> None:
    bench = axis_bench(kv=50.0, drive_time_constant=0.003)
    moving(bench)
    bench.accepted("power", enabled=False)
    bench.run(1000)
    states, velocity = bench.column("state"), bench.column("set_velocity")
    end = states.index(S.DISABLED)
    assert set(states[400:end]) == {S.STOPPING} and velocity[end] == 0.0 and velocity[end - 1] > 0.0
    assert set(bench.column("command_velocity")[end:]) == {0.0}
    assert abs(bench.column("command_velocity")[end - 1]) > 0.0
    assert bench.column("actual_velocity")[-1] == pytest.approx(0.0, abs=1e-9)
    assert bench.events == []
    assert_axis_smooth(bench, acceleration=5000.0, jerk=50_000.0)


def test_the_enable_moves_nothing() -> None:
    """What the drive still lacked when the loop was opened is no step of the command velocity later on."""
    bench = axis_bench(kv=50.0, drive_time_constant=0.003)
    moving(bench)
    bench.accepted("power", enabled=False)
    bench.run(1500)
    rest, actual = bench.column("following_error")[-1], bench.column("actual_position")[-1]
    assert abs(rest) > 1e-6
    bench.accepted("power", enabled=True)
    bench.run(100)
    assert set(bench.column("command_velocity")[-100:]) == {0.0}
    assert bench.column("set_position")[-1] == bench.column("actual_position")[-1] == pytest.approx(actual, abs=1e-9)
    assert bench.state == S.STANDSTILL
    bench.accepted("move_absolute", target=0.0, **DYNAMICS)
    bench.run(3000)
    assert bench.column("actual_position")[-1] == pytest.approx(0.0, abs=1e-6)


def test_power_on_again_on_the_ramp_ends_in_standstill() -> None:
    bench = axis_bench()
    powered_off_in_motion(bench)
    bench.accepted("power", enabled=True)
    bench.run(1000)
    assert bench.state == S.STANDSTILL and S.DISABLED not in bench.column("state")
    assert_axis_smooth(bench, acceleration=5000.0, jerk=50_000.0)


@pytest.mark.parametrize("before_the_end", range(4))
def test_power_on_again_at_the_end_of_the_ramp_makes_no_step(before_the_end: int) -> None:
    """The loop has not been open in any cycle: the axis ends where its ramp does, not where its drive lags behind."""
    first = axis_bench(kv=50.0, drive_time_constant=0.003)
    powered_off_in_motion(first)
    first.run(1000)
    velocity = first.column("set_velocity")
    end = next(k for k in range(500, 1450) if velocity[k] == 0.0)
    bench = axis_bench(kv=50.0, drive_time_constant=0.003)
    powered_off_in_motion(bench)
    bench.run(end - before_the_end - bench.cycle)
    bench.accepted("power", enabled=True)
    bench.run(300)
    position = bench.column("set_position")
    assert position[end - 1] == first.column("set_position")[end - 1] and bench.state == S.STANDSTILL
    assert abs(position[end] - position[end - 1]) <= 0.001 * velocity[end - 1]
    assert set(position[end:]) == {position[end]}
    assert bench.column("actual_position")[-1] == pytest.approx(position[end], abs=1e-4)
    assert_axis_smooth(bench, acceleration=5000.0, jerk=50_000.0)


def test_power_off_and_on_between_two_blocks_moves_nothing() -> None:
    """What the drive still lacks stays a following error: the loop was closed all the time."""
    bench = axis_bench(kv=50.0, drive_time_constant=0.003)
    bench.accepted("move_absolute", target=1000.0, **DYNAMICS)
    bench.run(1)
    while bench.state != S.STANDSTILL:
        bench.run(1)
    rest = bench.column("following_error")[-1]
    assert abs(rest) > 1e-6
    bench.accepted("power", enabled=False)
    bench.accepted("power", enabled=True)
    bench.run(300)
    assert set(bench.column("set_position")[-301:]) == {1000.0}
    assert bench.column("actual_position")[-1] == pytest.approx(1000.0, abs=1e-6)


def test_power_off_on_the_path_is_a_fault_and_the_loop_opens_at_standstill() -> None:
    bench = axis_bench(kv=50.0, drive_time_constant=0.003)
    follow_path(bench, blocks=20)
    bench.accepted("power", enabled=False)
    bench.run(1000)
    assert bench.event_texts() == [
        "P-ERR-23010 axis x: the enable was removed during path motion; the axis stops on its own ramp (ErrorStop)"
    ]
    velocity, command = bench.column("set_velocity"), bench.column("command_velocity")
    end = next(k for k in range(200, 1200) if velocity[k] == 0.0)
    assert command[end - 1] != 0.0 and set(command[end + 1 :]) == {0.0}
    bench.accepted("reset")
    bench.run(10)
    assert bench.state == S.DISABLED
    bench.accepted("power", enabled=True)
    bench.run(10)
    assert bench.state == S.STANDSTILL and set(bench.column("command_velocity")[-10:]) == {0.0}


def test_power_on_in_error_stop_closes_the_loop_and_keeps_the_error() -> None:
    bench = axis_bench()
    on_path(bench)
    bench.accepted("power", enabled=False)
    bench.run(500)
    bench.accepted("power", enabled=True)
    bench.run(10)
    assert bench.state == S.ERROR_STOP and bench.column("error_id")[-1] == 23010
    bench.accepted("reset")
    bench.run(10)
    assert bench.state == S.STANDSTILL


def test_an_axis_without_power_at_the_start() -> None:
    bench = axis_bench(powered_at_start=False)
    bench.run(10)
    assert set(bench.column("state")) == {S.DISABLED}
    bench.accepted("power", enabled=True)
    bench.run(10)
    assert set(bench.column("state")[10:]) == {S.STANDSTILL}


def test_reset_clears_error_and_bit() -> None:
    bench = axis_bench()
    error_stop(bench)
    assert bench.column("status_bits")[-1] == StatusBit.ERROR
    bench.accepted("reset")
    bench.run(10)
    assert (bench.state, bench.column("error_id")[-1], bench.column("status_bits")[-1]) == (S.STANDSTILL, 0, 0)
    assert bench.accepted("move_absolute", target=0.0) == ""


# ---------------------------------------------------------------- faults


def test_a_fault_takes_the_stronger_of_own_ramp_and_ramp_of_the_start() -> None:
    """Weak start (500), strong axis (5000): stops within 2000/5000 + 0.1 s; and the other way round."""
    for own, given in ((5000.0, 500.0), (500.0, 5000.0)):
        bench = axis_bench(deceleration=own)
        bench.accepted("move_absolute", target=50_000.0, **{**DYNAMICS, "deceleration": given})
        bench.run(1000)
        bench.accepted("upstream_lost", source="clock")
        bench.run(4500)
        velocity = bench.column("set_velocity")
        stand = next(k for k in range(1000, 5500) if velocity[k] == 0.0)
        assert stand == pytest.approx(1500, abs=1)
        assert_axis_smooth(bench, acceleration=5000.0, jerk=50_000.0)


def test_a_fault_on_a_stop_ramp_does_not_weaken_it() -> None:
    bench = axis_bench(deceleration=500.0)
    bench.accepted("move_absolute", target=50_000.0, **DYNAMICS)
    bench.run(1000)
    bench.accepted("stop")
    bench.run(200)
    bench.accepted("upstream_lost", source="plc")
    bench.run(500)
    assert bench.column("set_velocity").index(0.0, 1000) == pytest.approx(1500, abs=1)


@pytest.mark.parametrize(
    ("prepare", "state"),
    [(moving, "DiscreteMotion"), (stopping, "Stopping"), (disabled, "Disabled")],
)
def test_a_path_that_the_axis_cannot_follow(prepare: Callable[[UnitBench], None], state: str) -> None:
    bench = axis_bench()
    prepare(bench)
    begin = bench.column("set_position")[-1] if bench.blocks else 0.0
    follow_path(bench, begin=begin)
    assert bench.event_texts() == [
        f"P-ERR-23009 axis x: the channel moves the path while the axis is in {state}; the axis stops on its own ramp "
        "(ErrorStop)"
    ]
    bench.run(1000)
    assert bench.state == S.ERROR_STOP and bench.column("set_velocity")[-1] == 0.0
    assert_axis_smooth(bench, acceleration=5000.0, jerk=50_000.0)
    if prepare is disabled:
        assert set(bench.column("command_velocity")) == {0.0}


def test_a_path_that_begins_elsewhere_is_a_fault() -> None:
    """Also after a reset while the channel still ramps down: the axis must not jump onto the path."""
    bench = axis_bench(start_position=1.0)
    follow_path(bench, begin=1.5)
    assert bench.event_texts() == [
        "P-ERR-23009 axis x: the path of the channel starts at 1.5 mm, the axis is at 1.0 mm; the axis "
        "stops on its "
        "own ramp (ErrorStop)"
    ]
    assert set(bench.column("set_position")) == {1.0}


def test_a_channel_that_lets_the_axis_go_while_it_moves() -> None:
    bench = axis_bench()
    on_path(bench)
    bench.run(500)
    assert bench.event_texts() == [
        "P-ERR-23009 axis x: the channel released the axis while it moved; the axis stops on its own ramp (ErrorStop)"
    ]
    assert_axis_smooth(bench.blocks[2:], acceleration=5000.0, jerk=50_000.0)


def test_only_the_block_of_a_channel_that_has_the_axis_counts() -> None:
    bench = axis_bench()
    idle = path_block(0, [5.0] * 10)
    idle.path_active = False
    bench.run(10, {"channel": idle, "other": path_block(0, [9.0] * 10, axis="y")})
    assert set(bench.column("set_position")) == {0.0} and bench.state == S.STANDSTILL


def test_following_error_on_the_path_stops_from_the_setpoint_of_that_cycle() -> None:
    bench = axis_bench(kv=50.0, following_error_monitoring=True, following_error_limit=1.0)
    follow_path(bench, blocks=10)
    bench.run(500)
    cycle = bench.events[0].cycle
    assert bench.event_texts() == [
        "P-ERR-17744 axis x: following error 1.0247 mm exceeds 1.0 mm (P-AXIS-00168); the axis stops on its own ramp "
        "(ErrorStop)"
    ]
    assert bench.column("state")[cycle - 1 : cycle + 1] == [S.SYNCHRONIZED_MOTION, S.ERROR_STOP]
    assert_axis_smooth(bench.blocks[1:], acceleration=5000.0, jerk=50_000.0)
