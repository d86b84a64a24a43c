"""Slaves that follow actual values, and gantry pairs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from error_support import refused
from long_support import long
from machine_support import CYCLE_TIME, PTP, machine
from slave_support import DELAYED, DYNAMICS, ERROR, SlaveBench, assert_linear

from cnc_ptp.axis.axis_unit import AxisUnit
from cnc_ptp.control.drives import Drive
from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc.plc_unit import at_rest
from cnc_ptp.protocol.axis_states import AxisStateCode as S

ACTUAL = {"couple_to_actual": True, "velocity_window": 1.0, "velocity_filter_time": 0.0}


class HandDrive(Drive):
    """A drive that obeys its command, and a hand that pushes it when it is open: `push` in mm/s, added."""

    def __init__(self) -> None:
        super().__init__()
        self.push = 0.0

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        self.velocity = command + self.push
        self.position += self.velocity * CYCLE_TIME


def pushed_bench(source: MachineParameters) -> tuple[SlaveBench, HandDrive]:
    """The bench, and the drive of its axis x."""
    bench, drive = SlaveBench(machine=source), HandDrive()
    unit = AxisUnit(source.axes["x"], cycle_time=CYCLE_TIME, drive=drive, axes=source.axes)
    bench.units["x"] = unit
    bench.offline._runners["x"] = UnitRunner(unit, watchdog_cycles=200)
    return bench, drive


def with_actual(**changes: Any) -> MachineParameters:
    return machine(PTP, x={**ACTUAL, **changes})


def push(bench: SlaveBench, drive: HandDrive, velocity: float, seconds: float) -> None:
    drive.push = velocity
    bench.run(seconds)
    drive.push = 0.0


def largest_step(bench: SlaveBench, axis: str) -> float:
    return float(np.abs(np.diff(bench.values(axis))).max())


# main master without enable


def test_followers_follow_a_master_that_is_pushed_by_hand() -> None:
    """Off, pushed by 60 mm and back by 20, on again, a positioning: y = -0.5 x + 0, z follows y all the time."""
    bench, drive = pushed_bench(with_actual())
    bench.do("y", "couple", master="x", factor=-0.5)
    bench.do("z", "couple", master="y", factor=2.0)
    bench.run(0.05)
    bench.do("x", "power", enabled=False)
    bench.run(0.05)
    assert bench.last("x").couples_actual
    push(bench, drive, 200.0, 0.3)
    push(bench, drive, -100.0, 0.2)
    bench.run(0.05)
    x, y, z = (bench.values(axis, "set_position") for axis in "xyz")
    assert x[-1] == 0.0
    assert bench.values("x", "actual_position")[-1] == pytest.approx(40.0)
    assert y == pytest.approx(-0.5 * bench.values("x", "actual_position"), abs=1e-9)
    assert z == pytest.approx(2.0 * y, abs=1e-9)
    assert bench.values("y", "set_velocity").min() == pytest.approx(-100.0)
    bench.do("x", "power", enabled=True)
    bench.run(0.05)
    bench.do("x", "move_absolute", target=140.0, **DYNAMICS)
    bench.settle()
    x, y = bench.values("x"), bench.values("y")
    assert (x[-1], y[-1]) == pytest.approx((140.0, -70.0), abs=1e-9)
    assert largest_step(bench, "y") < 1.0
    assert bench.errors() == []
    assert {bench.state(axis) for axis in "yz"} == {S.SYNCHRONIZED_MOTION}


def test_followers_stand_where_the_parameter_is_off() -> None:
    bench, drive = pushed_bench(with_actual(couple_to_actual=False))
    bench.do("y", "couple", master="x", factor=1.0)
    bench.do("x", "power", enabled=False)
    push(bench, drive, 200.0, 0.3)
    assert not bench.last("x").couples_actual
    assert bench.values("y").tolist() == [0.0] * bench.cycle


def test_switching_over_and_back_makes_no_step_in_spite_of_a_following_error() -> None:
    """A hand that holds the master 0.4 mm off while it is in position control (Kv 500 1/s, 200 mm/s)."""
    bench, drive = pushed_bench(with_actual())
    bench.do("y", "couple", master="x", factor=1.0)
    drive.push = 200.0
    bench.run(0.2)
    assert bench.values("x", "following_error")[-1] == pytest.approx(-0.4)
    drive.push = 0.0
    bench.do("x", "power", enabled=False)
    at_rest = bench.values("y")[-1]
    bench.run(0.1)
    bench.do("x", "power", enabled=True)
    bench.run(0.1)
    assert largest_step(bench, "y") == pytest.approx(0.0, abs=0.001)
    assert bench.values("y")[-1] == pytest.approx(at_rest)
    before = bench.values("y")[-1]
    bench.do("x", "move_relative", distance=50.0, **DYNAMICS)
    bench.settle()
    assert bench.values("y")[-1] - before == pytest.approx(50.0, abs=1e-9)


def test_velocity_window_and_filter_time() -> None:
    """The velocity that followers get: 0 inside the window, else through 1/(1 + s·Tf), 63 % after Tf = 50 ms."""
    bench, drive = pushed_bench(with_actual(velocity_window=5.0, velocity_filter_time=0.05))
    bench.do("y", "couple", master="x", factor=1.0)
    bench.do("x", "power", enabled=False)
    bench.run(0.05)
    push(bench, drive, 4.9, 0.1)
    assert not bench.values("y", "set_velocity").any()
    bench.run(0.01)
    assert bench.position("y") == pytest.approx(0.49)  # positions are followed all the same
    first = bench.cycle
    push(bench, drive, 100.0, 0.5)
    velocity = bench.values("y", "set_velocity")[first:]
    t = np.arange(1, 501) * CYCLE_TIME
    assert velocity == pytest.approx(100.0 * (1.0 - np.exp(-t / 0.05)), abs=2.5)
    assert velocity[-1] == pytest.approx(100.0, abs=0.01)


@pytest.mark.parametrize("window", [0.0, 0.5, 1.0, 20.0])
@pytest.mark.parametrize("filter_time", [0.0, 0.01, 0.2])
@pytest.mark.parametrize("sign", [1.0, *long([-1.0])])
def test_a_slave_comes_to_rest_with_a_master_at_rest(window: float, filter_time: float, sign: float) -> None:
    """From the window on in a straight line that begins as steep as the filter ends: window·T/(T + Tf) a cycle."""
    bench, drive = pushed_bench(with_actual(velocity_window=window, velocity_filter_time=filter_time))
    bench.do("y", "couple", master="x", factor=-0.5)
    bench.do("x", "power", enabled=False)
    push(bench, drive, sign * 150.0, 0.3)
    stopped = bench.cycle
    push(bench, drive, 0.0, 0.05 + 30.0 * filter_time)
    v = -2.0 * sign * bench.values("y", "set_velocity")[stopped:]
    steepest = window * CYCLE_TIME / (CYCLE_TIME + filter_time)
    assert (np.diff(v) <= 0.0).all() and v[-1] == 0.0
    inside = v[v <= window]
    assert (np.abs(np.diff(inside)) <= steepest * (1.0 + 1e-9)).all()
    assert np.count_nonzero(inside) <= (1.0 + filter_time / CYCLE_TIME if window else 30.0 * filter_time / CYCLE_TIME)
    actual = bench.values("x", "actual_position")
    assert bench.values("y") == pytest.approx(-0.5 * actual, abs=1e-9)
    assert not bench.bits("y", 1 << 12)[-1]


def test_a_run_ends_with_a_slave_that_was_pushed() -> None:
    """The slave is at rest, and so the run may end: nothing of the filter is left."""
    bench, drive = pushed_bench(with_actual(velocity_filter_time=0.05))
    bench.do("y", "couple", master="x", factor=1.0)
    bench.do("x", "power", enabled=False)
    push(bench, drive, 100.0, 0.2)
    push(bench, drive, 0.0, 1.0)
    assert at_rest(bench.last("y")) and bench.position("y") == pytest.approx(20.0)


def test_cam_and_cyclic_slaves_follow_by_hand_too() -> None:
    bench, drive = pushed_bench(with_actual())
    table = [[0.0, 0.0], [50.0, 30.0], [100.0, 10.0]]
    bench.do("y", "couple_cam", master="x", table=table, cyclic=False)
    bench.do("z", "couple_cyclic", master="x", acc_bound=1000.0)
    bench.do("z", "set_cyclic_factor", factor=0.5)
    bench.do("x", "power", enabled=False)
    bench.run(0.02)
    push(bench, drive, 100.0, 0.5)
    bench.run(0.1)
    assert bench.position("y") == pytest.approx(30.0, abs=1e-9)
    assert np.abs(np.diff(bench.values("z", "set_velocity"))).max() <= 1.0 + 1e-9
    assert bench.values("z", "set_velocity").max() == pytest.approx(50.0)


# delayed error


def faulty_bench(*, couple_to_actual: bool) -> SlaveBench:
    """z leads y leads x; y loses its enable at 0.8 s, errors are delayed by 1 s."""
    delayed = {"error_propagation_delayed": True, "error_propagation_delay": 1.0}
    actual = ACTUAL if couple_to_actual else {}
    source = machine(PTP, x=delayed, y={**delayed, **actual, "drive_time_constant": 0.02, "kv": 20.0}, z=delayed)
    bench = SlaveBench(machine=source)
    bench.do("y", "couple", master="z", factor=1.0)
    bench.do("x", "couple", master="y", factor=1.0)
    bench.do("z", "move_absolute", target=10_000.0, **DYNAMICS)
    bench.run(0.8)
    bench.do("y", "power", enabled=False)
    bench.run(0.9)
    return bench


@pytest.mark.parametrize("actual", [True, False])
def test_slave_of_an_axis_with_a_delayed_error(actual: bool) -> None:
    """y rolls 100 mm behind its set values (2000 mm/s / Kv 20); x keeps to the one or the other."""
    bench = faulty_bench(couple_to_actual=actual)
    assert (bench.state("y"), bench.state("x"), bench.state("z")) == (S.ERROR_STOP, S.SYNCHRONIZED_MOTION, 3)
    assert bench.bits("y", ERROR)[-1] and bench.bits("y", DELAYED)[-1]
    assert bench.last("y").couples_actual == actual
    fault = int(np.flatnonzero(bench.values("y", "error_id"))[0])
    block = fault - fault % 10
    follows = bench.values("y", "actual_position" if actual else "set_position")
    x = bench.values("x")
    moved = x[fault:] - x[block]
    assert moved == pytest.approx(follows[fault:] - follows[block], abs=1e-9)
    assert largest_step(bench, "x") <= 2.0 * (1.0 + 1e-9)
    bench.run(0.3)
    assert bench.state("x") == bench.state("z") == S.ERROR_STOP
    assert not bench.bits("y", DELAYED)[-1]


# gantry


COMPENSATION = {"acceleration": 1000.0, "deceleration": 1000.0, "process_velocity": 100.0}


def gantry(limit: float, **slave: float) -> SlaveBench:
    """x and y as a pair, y 5 mm away from x, x on its way to 1000 mm."""
    bench = SlaveBench(machine=machine(PTP, y=slave))
    bench.do("y", "move_absolute", target=5.0, **DYNAMICS)
    bench.settle()
    bench.do("y", "couple_gantry", master="x", difference_limit=limit)
    bench.do("x", "move_absolute", target=1000.0, **DYNAMICS)
    return bench


def test_gantry_pair_keeps_its_distance() -> None:
    bench = gantry(0.001)
    bench.settle()
    assert bench.values("y")[-1] == pytest.approx(1005.0, abs=1e-9)
    assert bench.errors() == []
    bench.do("y", "decouple")
    bench.run(0.05)
    assert bench.state("y") == S.STANDSTILL


def test_gantry_fault_stops_both() -> None:
    """y with Kv 100 instead of 500 1/s lags by v/100 - v/500 = 8 ms · v: 0.5 mm at 62.5 mm/s."""
    bench = gantry(0.5, kv=100.0)
    bench.settle()
    first, second = bench.errors()
    head = "P-ERR-23055 axis y: the actual positions of y and its gantry master x differ by "
    assert first.startswith(head)
    assert first.endswith(" mm, more than 0.5 mm; the axis stops with its master x (ErrorStop)")
    assert 0.5 < float(first.removeprefix(head).split()[0]) < 0.55
    text = "axis x: axis y of its group has error 23055; the axis stops on its own ramp (ErrorStop)"
    assert second == f"P-ERR-23056 {text}"
    fault = int(np.flatnonzero(bench.values("y", "error_id"))[0])
    reached = np.flatnonzero(bench.values("x", "set_velocity") >= 62.5)[0]
    assert reached < fault < reached + 20  # the lag comes up with 1/Kv
    assert np.flatnonzero(bench.values("x", "error_id"))[0] - fault <= 20
    assert {bench.state("x"), bench.state("y")} == {S.ERROR_STOP}
    assert (bench.values("y") - bench.values("x"))[-300:] == pytest.approx(5.0, abs=1e-9)  # nothing was torn
    for axis in "xy":
        bench.do(axis, "reset")
    bench.run(0.05)
    assert {bench.state("x"), bench.state("y")} == {S.STANDSTILL}


@pytest.mark.parametrize("master_moves", [False, True])
def test_a_superimposed_motion_ends_with_the_fault_of_its_gantry_slave(master_moves: bool) -> None:
    """It drives the pair apart, and must not outlive the error that this is: found by random commands, seed 70000."""
    bench = gantry(0.5)
    bench.run(0.3 if master_moves else 2.0)
    moved = bench.values("x")[-1]
    bench.do("y", "move_superimposed", distance=32.0, velocity_difference=50.0)
    bench.run(2.0)
    assert bench.errors()[0].startswith("P-ERR-23055 axis y: ")
    assert {bench.state("x"), bench.state("y")} == {S.ERROR_STOP}
    assert bench.values("y", "set_velocity")[-500:].tolist() == [0.0] * 500
    assert (bench.values("x")[-1] > moved + 1.0) == master_moves
    assert 0.5 < bench.values("y")[-1] - bench.values("x")[-1] - 5.0 < 6.0  # nearer than the 32 mm of the command
    for axis in "xy":
        bench.do(axis, "reset")
    bench.run(0.05)
    assert {bench.state("x"), bench.state("y")} == {S.STANDSTILL}


def test_a_compensation_ends_with_the_fault_of_its_gantry_slave() -> None:
    """It drives the pair apart, too, and goes no further than the ramp of both."""
    bench = gantry(0.5)
    bench.run(0.3)
    warned = bench.do("y", "compensation_start", difference=40.0, length=500.0, velocity_increase=100.0, **COMPENSATION)
    assert warned == ""
    bench.run(3.0)
    assert bench.errors()[0].startswith("P-ERR-23055 axis y: ")
    assert {bench.state("x"), bench.state("y")} == {S.ERROR_STOP}
    assert bench.values("y", "set_velocity")[-500:].tolist() == [0.0] * 500
    assert 0.5 < bench.values("y")[-1] - bench.values("x")[-1] - 5.0 < 39.0


def test_gantry_master_that_loses_its_enable_stops_with_its_slave() -> None:
    bench = gantry(5.0)
    bench.run(0.3)
    bench.do("x", "power", enabled=False)
    bench.settle()
    assert bench.errors() == []
    assert bench.values("y")[-1] - bench.values("x")[-1] == pytest.approx(5.0, abs=1e-9)


def test_fault_of_the_gantry_master_stops_the_slave() -> None:
    bench = gantry(100.0)
    bench.run(0.3)
    bench.give("x", "upstream_lost", source="plc")
    bench.settle()
    lost, spread = bench.errors()
    assert lost.startswith("P-ERR-") and "axis x: no block of 'plc' came" in lost
    number = bench.last("x").error_id[-1]
    text = f"axis y: axis x of its group has error {number}; the axis stops with its master x (ErrorStop)"
    assert spread == f"P-ERR-23056 {text}"
    assert np.abs(bench.values("y") - bench.values("x") - 5.0)[-600:].max() <= 1e-9
    assert bench.state("y") == S.ERROR_STOP


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("delayed", [False, True])
def test_a_gantry_slave_without_feed_release_stops_with_its_master(sign: float, delayed: bool) -> None:
    """At 1000 mm/s, whatever the delay of errors: a ramp of its own, weaker than its master's, would tear the pair."""
    late = {"error_propagation_delayed": True, "error_propagation_delay": 5.0} if delayed else {}
    bench = SlaveBench(machine=machine(PTP, x=late, y={"deceleration": 1000.0, **late}))
    bench.do("y", "couple_gantry", master="x", difference_limit=5.0)
    bench.do("x", "move_absolute", target=sign * 5000.0, **(DYNAMICS | {"velocity": 1000.0}))
    bench.run(1.0)
    withdrawn = bench.cycle
    bench.do("y", "set_feed_release", forward=sign < 0.0, backward=sign > 0.0)
    bench.settle()
    where = "forward" if sign > 0.0 else "backward"
    assert bench.errors() == [
        f"P-ERR-23058 axis y: it is moved {where}, which is not released (set_feed_release); the axis stops with its "
        "master x (ErrorStop)",
        "P-ERR-23056 axis x: axis y of its group has error 23058; the axis stops on its own ramp (ErrorStop)",
    ]
    fault = int(np.flatnonzero(bench.values("y", "error_id"))[0])
    assert fault == withdrawn and np.flatnonzero(bench.values("x", "error_id"))[0] - fault <= 20
    assert_linear(bench, "x", "y", 1.0)
    assert bench.state("x") == bench.state("y") == S.ERROR_STOP
    assert abs(bench.values("x")[-1] - bench.values("x")[fault]) <= 1000.0 * 0.02 + 150.0 + 1e-6  # V²/2A- + V·A-/2J


def test_a_gantry_slave_that_is_to_start_without_its_release_keeps_its_place() -> None:
    bench = SlaveBench()
    bench.do("y", "couple_gantry", master="x", difference_limit=5.0)
    bench.do("y", "set_feed_release", forward=False, backward=True)
    bench.do("x", "move_absolute", target=1000.0, **DYNAMICS)
    bench.settle()
    assert [text[:11] for text in bench.errors()] == ["P-ERR-23058", "P-ERR-23056"]
    assert_linear(bench, "x", "y", 1.0)
    assert 0.0 < bench.values("x")[-1] < 1.0 and bench.state("x") == bench.state("y") == S.ERROR_STOP


@pytest.mark.parametrize("limit", [0.0, -1.0])
def test_gantry_limit_must_be_positive(limit: float) -> None:
    bench = SlaveBench()
    assert bench.denial("y", "couple_gantry", master="x", difference_limit=limit) == refused(
        23054, argument="difference_limit", value=limit
    )


def test_gantry_has_no_factor_and_can_be_left_in_motion() -> None:
    bench = gantry(1.0)
    bench.run(0.2)
    assert bench.denial("y", "set_coupling_factor", factor=2.0) == refused(23050)
    bench.do("y", "decouple")
    bench.run(0.2)
    bench.do("y", "stop")
    bench.settle()
    assert bench.errors() == []
