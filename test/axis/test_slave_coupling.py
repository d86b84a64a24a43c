"""Linear slaves: coupling at standstill, star and cascade in any order, factors, what is locked and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import permutations
from typing import Any

import numpy as np
import pytest
from error_support import refused
from long_support import long_but, long_sets
from machine_support import position_after, seven_phases
from slave_support import (
    COMPENSATION,
    DYNAMICS,
    HAS_JOB,
    PROTECTED,
    A,
    D,
    J,
    SlaveBench,
    assert_linear,
    axes_named,
)

from cnc_ptp.protocol.axis_states import AxisStateCode as S

FACTORS = {"y": -0.5, "z": 0.8, "c": 2.5}
CASCADE = {"y": "x", "z": "y", "c": "z"}


def couple(slave: str, factor: float, master: str = "x") -> tuple[str, str, dict[str, Any]]:
    return slave, "couple", {"master": master, "factor": factor}


def start(target: float = 2000.0, axis: str = "x") -> tuple[str, str, dict[str, Any]]:
    return axis, "move_absolute", {"target": target, **DYNAMICS}


# one slave


def test_the_offset_is_that_of_the_coupling_positions() -> None:
    """x is at 100, y at -30: offset = -30 - 0.75·100 = -105; the end is 0.75·2000 - 105."""
    bench = SlaveBench()
    bench.send_all([start(100.0), start(-30.0, "y")])
    bench.settle()
    bench.do(*couple("y", 0.75)[:2], master="x", factor=0.75)
    begin = bench.cycle
    assert bench.bits("y", PROTECTED)[-1] and bench.state("y") == S.SYNCHRONIZED_MOTION
    bench.run(0.2)
    assert set(bench.values("y")[begin - 10 :]) == {-30.0}, "coupling alone moves nothing"
    bench.send_all([start()])
    bench.settle()
    assert_linear(bench, "x", "y", 0.75, -105.0, begin=begin)
    assert bench.position("y") == pytest.approx(1395.0, abs=1e-9)
    assert bench.last("y").master == "x" and bench.last("x").master == ""


def test_a_slave_that_is_not_as_late_as_its_master() -> None:
    """P-COMP-00044 of the master alone: the slave is ahead by so many cycles, and says so; equally late it is silent."""
    machine = axes_named("x", "y", "z")
    friction = replace(machine.axes["x"].control.friction, permitted=True, reversal_lookahead=4)
    for name in "xz":
        control = replace(machine.axes[name].control, friction=friction)
        machine = replace(machine, axes={**machine.axes, name: replace(machine.axes[name], control=control)})
    bench = SlaveBench(machine=machine)
    assert bench.do("z", "couple", master="x", factor=1.0) == ""
    assert bench.do("y", "couple", master="x", factor=1.0) == (
        "axis y: couple: its position controller works 0 cycles behind the setpoint, that of the master x 4 "
        "(P-COMP-00044, P-AXIS-00165); in motion they are 4 ms · velocity apart"
    )
    bench.send_all([start()])
    bench.run(1.0)
    x, y = bench.values("x", "actual_position"), bench.values("y", "actual_position")
    assert np.abs(y - x).max() == pytest.approx(0.004 * np.abs(bench.values("x", "set_velocity")).max(), rel=0.05)


def test_the_slave_has_the_profile_of_the_closed_form() -> None:
    """An oracle that knows no master: phases of the manual's start, times the factor -0.5."""
    bench = SlaveBench()
    bench.send_all([couple("y", -0.5), start()])
    bench.run(2.0)
    phases = seven_phases(2000.0, 2000.0, A, A, J)
    expected = np.array([position_after(phases, 0.001 * k) for k in range(2010)])
    for n, name in enumerate(("position", "velocity", "acceleration")):
        assert np.abs(bench.values("y", f"set_{name}")[:2010] + 0.5 * expected[:, n]).max() < 1e-6


def test_override_and_stop_of_the_master_reach_the_slave() -> None:
    """The manual's figure: start at override 30 %, then 100 %, then stop; factor 0.75."""
    bench = SlaveBench(f"""
- {{at: 0, to: x, do: set_override, percent: 30}}
- {{at: 0, to: "y", do: couple, master: x, factor: 0.75}}
- {{at: 0, to: x, do: move_absolute, target: 20000, {D}}}
- {{at: 2, to: x, do: set_override, percent: 100}}
- {{at: 4, to: x, do: stop}}
""")
    bench.run(6.0)
    v = bench.values("y", "set_velocity")
    assert v[1900] == pytest.approx(450.0) and v[3900] == pytest.approx(1500.0) and v[-1] == 0.0
    assert_linear(bench, "x", "y", 0.75)
    job = bench.bits("y", HAS_JOB)
    assert job[10:4000].all() and not job[4010:].any(), "the slave has a job while its master has one"
    assert not bench.bits("y", 1 << 7).any(), "a slave is not stopped itself"


def test_the_target_velocity_is_that_of_the_master_times_the_factors() -> None:
    bench = SlaveBench()
    bench.send_all([couple("y", -0.5), couple("z", 0.8, "y"), start()])
    bench.run(0.1)
    assert [bench.last(axis).target_velocity for axis in "xyz"] == pytest.approx([2000.0, 1000.0, 800.0])


@pytest.mark.parametrize("factor", [1e-6, -1e-3, 1.0, -1.0, 3.7, -4.9])
def test_factors_of_either_sign_and_size(factor: float) -> None:
    bench = SlaveBench()
    bench.send_all([start(77.7, "y")])
    bench.settle()
    begin = bench.cycle
    bench.send_all([couple("y", factor), start()])
    bench.run(0.5)
    bench.send_all([("x", "new_target", {"target": -300.0})])
    bench.settle()
    assert_linear(bench, "x", "y", factor, 77.7, begin=begin)
    assert bench.errors() == []


# star and cascade


@pytest.mark.parametrize("order", list(permutations("yzc")))
def test_a_cascade_is_coupled_in_any_order_of_commands(order: tuple[str, ...]) -> None:
    bench = SlaveBench()
    records = bench.send_all([*(couple(axis, FACTORS[axis], CASCADE[axis]) for axis in order), start()])
    assert all(record.accepted for record in records)
    bench.settle()
    assert_linear(bench, "x", "y", -0.5)
    assert_linear(bench, "x", "z", -0.4)
    assert_linear(bench, "x", "c", -1.0)


ORDERS = list(permutations("xyzc"))


@pytest.mark.parametrize("order", long_but(ORDERS, ORDERS[::5]))
def test_a_cascade_moves_in_the_same_cycle_in_any_order_of_the_machine(order: tuple[str, ...]) -> None:
    """Bits of all orders are equal: nobody is a block behind its master."""

    def positions(names: tuple[str, ...]) -> dict[str, list[float]]:
        bench = SlaveBench(machine=axes_named(*names))
        bench.send_all([couple(slave, FACTORS[slave], CASCADE[slave]) for slave in "czy"])
        bench.send_all([start()])
        bench.run(0.3)
        bench.do("z", "decouple", target=-100.0)
        bench.run(0.5)
        return {axis: bench.column(axis, "set_position") for axis in "xyzc"}

    assert positions(order) == positions(tuple("xyzc"))


@pytest.mark.parametrize("order", list(permutations("yzc")))
def test_a_star(order: tuple[str, ...]) -> None:
    bench = SlaveBench()
    bench.send_all([*(couple(axis, FACTORS[axis]) for axis in order), start()])
    bench.settle()
    for axis in order:
        assert_linear(bench, "x", axis, FACTORS[axis])


def test_a_master_with_a_slave_becomes_a_slave_and_the_group_moves_on_together() -> None:
    """Manual 3: when a master axis is coupled to another one, its slave stays with it."""
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=2.0)
    bench.send_all([start(100.0)])
    bench.settle()
    bench.do("x", "couple", master="z", factor=-1.0)
    begin = bench.cycle
    bench.send_all([start(500.0, "z")])
    bench.settle()
    assert_linear(bench, "z", "x", -1.0, 100.0, begin=begin)
    assert_linear(bench, "x", "y", 2.0)


@pytest.mark.parametrize("cascade", [True, False], ids=["cascade", "star"])
def test_eight_axes_in_random_order(cascade: bool) -> None:
    names = ("a5", "a1", "a7", "a0", "a3", "a6", "a2", "a4")
    factors = [0.0, -1.5, 0.5, 2.0, -0.25, 1.25, -0.8, 0.9]
    bench = SlaveBench(machine=axes_named(*names))
    commands = [couple(f"a{k}", factors[k], f"a{k - 1}" if cascade else "a0") for k in (3, 7, 1, 6, 2, 5, 4)]
    bench.send_all(commands)
    bench.send_all([start(axis="a0")])
    bench.run(0.5)
    bench.send_all([("a0", "set_override", {"percent": 33.0})])
    bench.settle()
    for k in range(1, 8):
        assert_linear(bench, "a0", f"a{k}", float(np.prod(factors[1 : k + 1])) if cascade else factors[k])


@pytest.mark.parametrize(("period", "sizes"), [(1000, (10, 1000)), *long_sets([(700, (1, 7, 10))])])
def test_block_sizes_change_nothing(period: int, sizes: tuple[int, ...]) -> None:
    """Commands in cycles that all blocks begin at: factor change, override, decoupling and stop give equal bits."""
    commands = [
        {"to": "z", "do": "couple", "master": "y", "factor": -0.4, "at": 0},
        {"to": "y", "do": "couple", "master": "x", "factor": 0.75, "at": 0},
        {"to": "x", "do": "move_absolute", "target": 60_000, **DYNAMICS, "at": 0},
        {"to": "y", "do": "set_coupling_factor", "factor": 0.5, "at": 1},
        {"to": "x", "do": "set_override", "percent": 50, "at": 2},
        {"to": "z", "do": "decouple", "at": 2},
        {"to": "z", "do": "stop", "at": 3},
        {"to": "y", "do": "decouple", "target": 100, "at": 3},
    ]
    scenario = "\n".join(f"- {json.dumps({**c, 'at': c['at'] * period / 1000})}" for c in commands)

    def columns(block_cycles: int) -> list[list[Any]]:
        bench = SlaveBench(scenario, machine=axes_named("z", "y", "x", block_cycles=block_cycles))
        while bench.cycle < 5 * period:
            bench.tick()
        fields = ("set_position", "set_velocity", "set_acceleration", "set_jerk", "actual_position", "state")
        return [bench.column(axis, field) for axis in "xyz" for field in fields]

    first, *others = (columns(size) for size in sizes)
    assert all(other == first for other in others)


# factor


def test_a_new_factor_keeps_the_position_and_steps_the_velocity() -> None:
    """The manual's figure: -0.7, then -0.8 in motion; the distance after the change counts with the new factor."""
    bench = SlaveBench()
    bench.send_all([couple("y", -0.7), start()])
    bench.run(0.7)
    change = bench.cycle
    assert bench.do("y", "set_coupling_factor", factor=-0.8) == ""
    bench.settle()
    x = bench.values("x")
    assert_linear(bench, "x", "y", -0.7, end=change)
    assert_linear(bench, "x", "y", -0.8, 0.1 * x[change], begin=change)
    v, vx = bench.values("y", "set_velocity"), bench.values("x", "set_velocity")
    assert v[change] - v[change - 1] == pytest.approx(-0.8 * vx[change] + 0.7 * vx[change - 1])


def test_a_factor_of_the_other_sign_turns_the_slave_around() -> None:
    bench = SlaveBench()
    bench.send_all([couple("y", 0.5), couple("z", 2.0, "y"), start()])
    bench.run(0.7)
    change = bench.cycle
    bench.do("y", "set_coupling_factor", factor=-0.5)
    bench.settle()
    x = bench.values("x")
    assert_linear(bench, "x", "y", -0.5, x[change], begin=change)
    assert_linear(bench, "y", "z", 2.0)
    assert (np.diff(bench.values("y")[change : change + 100]) < 0.0).all()


def test_the_last_of_two_factors_in_one_block_counts_and_a_change_at_standstill_moves_nothing() -> None:
    bench = SlaveBench()
    bench.send_all([couple("y", 0.5), ("y", "set_coupling_factor", {"factor": 3.0})])
    bench.send_all([start(100.0)])
    bench.settle()
    assert bench.position("y") == pytest.approx(300.0, abs=1e-9)
    bench.send_all([("y", "set_coupling_factor", {"factor": f}) for f in (7.0, -0.1)])
    bench.run(0.1)
    assert bench.position("y") == pytest.approx(300.0, abs=1e-9)
    bench.send_all([start(0.0)])
    bench.settle()
    assert bench.position("y") == pytest.approx(310.0, abs=1e-9)


# refusals

FAULTS = {
    "itself": (("y", {"master": "y", "factor": 1.0}), "P-ERR-23041 axis y: couple refused: an axis cannot be its own master; nothing was changed"),
    "unknown": (("y", {"master": "q", "factor": 1.0}), "P-ERR-23042 axis y: couple refused: there is no axis 'q'. Known: x, z, c; nothing was changed"),
    "plc": (("y", {"master": "plc", "factor": 1.0}), "P-ERR-23042 axis y: couple refused: there is no axis 'plc'. Known: x, z, c; nothing was changed"),
    "factor": (("y", {"master": "x", "factor": 0.0}), "P-ERR-23043 axis y: couple refused: factor = 0 must be different from 0; nothing was changed"),
    "minus zero": (("y", {"master": "x", "factor": -0.0}), "P-ERR-23043 axis y: couple refused: factor = 0 must be different from 0; nothing was changed"),
    "integer zero": (("y", {"master": "x", "factor": 0}), "P-ERR-23043 axis y: couple refused: factor = 0 must be different from 0; nothing was changed"),
    "huge": (
        ("y", {"master": "x", "factor": -1e300}),
        "P-ERR-23043 axis y: couple refused: factor = -1e+300 must be between 1e-06 and 1e+06 or the negative of it; nothing was changed",
    ),
    "tiny": (
        ("y", {"master": "x", "factor": 1e-7}),
        "P-ERR-23043 axis y: couple refused: factor = 1e-07 must be between 1e-06 and 1e+06 or the negative of it; nothing was changed",
    ),
    "nan": (("y", {"master": "x", "factor": float("nan")}), "P-ERR-22001 axis y: couple refused: factor = nan is not finite; nothing was changed"),
    "text": (("y", {"master": "x", "factor": "1"}), "P-ERR-22001 axis y: couple refused: factor = '1' is not a number; nothing was changed"),
    "number": (("y", {"master": 1, "factor": 1.0}), "P-ERR-22001 axis y: couple refused: master = 1 is not a text; nothing was changed"),
    "missing": (("y", {"master": "x"}), "P-ERR-22001 axis y: couple refused: argument 'factor' is missing; nothing was changed"),
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_refusals_at_standstill(fault: str) -> None:
    (unit, arguments), text = FAULTS[fault]
    bench = SlaveBench()
    assert bench.denied(unit, "couple", **arguments) == text
    assert bench.state(unit) == S.STANDSTILL and not bench.bits(unit, PROTECTED).any()
    assert bench.last(unit).master == ""


def test_neither_of_the_two_may_move() -> None:
    bench = SlaveBench()
    bench.send_all([start()])
    assert bench.denial("x", "couple", master="y", factor=1.0) == refused(23044, state="DiscreteMotion")
    assert bench.denial("y", "couple", master="x", factor=1.0) == refused(23045, master="x")
    bench.send_all([("x", "set_override", {"percent": 0.0})])
    bench.run(1.0)
    assert bench.last("x").set_velocity[-1] == 0.0
    assert bench.denial("y", "couple", master="x", factor=1.0) == refused(23045, master="x"), (
        "held by override 0 it may start any time"
    )


def test_a_master_whose_own_master_moves_or_is_held_does_not_stand() -> None:
    bench = SlaveBench()
    bench.send_all([couple("y", 1.0), start()])
    assert bench.denial("z", "couple", master="y", factor=1.0) == refused(23045, master="y")
    bench.send_all([("x", "set_override", {"percent": 0.0})])
    bench.run(1.0)
    assert bench.last("y").set_velocity[-1] == 0.0
    assert bench.denial("z", "couple", master="y", factor=1.0) == refused(23045, master="y")


def test_a_start_in_the_same_block_counts_in_the_order_of_the_commands() -> None:
    bench = SlaveBench()
    records = bench.send_all([couple("y", 1.0), start(), couple("z", 1.0), couple("c", 1.0, "y")])
    assert [record.accepted for record in records] == [True, True, False, False]
    assert records[2].message == (
        "axis z: couple refused: move_absolute of x was commanded in the same block, so that the standstill of the "
        "master x is known in the next one only; nothing was changed"
    )
    assert records[3].message == (
        "axis c: couple refused: move_absolute of x was commanded in the same block, so that the standstill of the "
        "master y is known in the next one only; nothing was changed"
    )


def test_a_start_that_is_refused_leaves_the_master_for_the_next_block() -> None:
    """MC_CamIn beside a refused MC_MoveAbsolute: x stands, which nobody knows before its answer."""
    bench = SlaveBench()
    cam = ("y", "couple_cam", {"master": "x", "table": [[0.0, 0.0], [50.0, 30.0], [100.0, 0.0]]})
    beyond, denied = bench.send_all([start(1e6), cam])
    assert beyond.error_id == 120002 and denied.error_id == 23045
    assert denied.message == (
        "axis y: couple_cam refused: move_absolute of x was commanded in the same block, so that the standstill of the "
        "master x is known in the next one only; nothing was changed"
    )
    assert bench.send_all([cam])[0].accepted


def test_circles_are_refused_in_one_block_and_later() -> None:
    bench = SlaveBench()
    records = bench.send_all([couple("y", 1.0, "x"), couple("x", 1.0, "y")])
    loop = "axis x: couple refused: {} is a slave of the axis already ({}); nothing was changed"
    assert (records[0].accepted, records[1].error_id) == (True, 23046)
    assert records[1].message == loop.format("y", "y -> x")
    bench.do("z", "couple", master="y", factor=1.0)
    assert bench.denial("x", "couple", master="z", factor=1.0) == refused(23046, master="z", chain="z -> y -> x")
    assert bench.denial("y", "couple", master="z", factor=1.0) == refused(23044, state="SynchronizedMotion")
    bench.do("y", "decouple")
    bench.do("x", "couple", master="z", factor=1.0)
    bench.send_all([start(10.0, "y")])
    bench.settle()
    assert [bench.position(axis) for axis in "yzx"] == pytest.approx([10.0, 10.0, 10.0])


def test_master_and_slave_change_places_in_one_block() -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=2.0)
    records = bench.send_all([("y", "decouple", {}), couple("x", 0.5, "y")])
    assert all(record.accepted for record in records)
    bench.send_all([start(10.0, "y")])
    bench.settle()
    assert bench.position("x") == pytest.approx(5.0, abs=1e-9)


def test_a_disabled_axis_is_no_slave_but_may_be_a_master() -> None:
    bench = SlaveBench()
    bench.do("y", "power", enabled=False)
    assert bench.denial("y", "couple", master="x", factor=1.0) == refused(23044, state="Disabled")
    bench.do("x", "couple", master="y", factor=1.0)


def test_factors_of_axes_that_are_no_slaves_and_factor_0() -> None:
    bench = SlaveBench()
    assert bench.denial("y", "set_coupling_factor", factor=1.0) == refused(23047, state="Standstill")
    bench.do("y", "couple", master="x", factor=1.0)
    assert bench.denial("y", "set_coupling_factor", factor=0.0) == refused(23043, argument="factor", value=0.0)
    assert bench.denial("y", "set_cyclic_factor", factor=1.0) == refused(23050)
    bench.send_all([start(100.0)])
    bench.settle()
    assert bench.position("y") == pytest.approx(100.0, abs=1e-9)


def test_decoupling_of_an_axis_that_is_no_slave() -> None:
    assert SlaveBench().denial("y", "decouple") == refused(23047, state="Standstill")


@pytest.mark.parametrize("factor", [1e6, -1e6])
def test_factors_that_multiply_out_of_all_range_are_an_error_and_no_crash(factor: float) -> None:
    bench = SlaveBench(machine=axes_named("x", "y", "z", "c", soft_limit_negative=-1e13, soft_limit_positive=1e13))
    bench.send_all([couple(slave, factor, CASCADE[slave]) for slave in "czy"])
    bench.send_all([start()])
    bench.run(0.1)
    assert bench.errors()[:2] == [
        "P-ERR-23002 axis z: its setpoints as a slave of y are out of range; the axis stops on its own ramp (ErrorStop)",
        "P-ERR-23056 axis x: axis z of its group has error 23002; the axis stops on its own ramp (ErrorStop)",
    ]
    assert set(bench.column("z", "set_position")) == set(bench.column("c", "set_position")) == {0.0}


# what is locked and what stays

LOCKED = {
    "move_absolute": ({"target": 1.0}, "23040 axis y: move_absolute refused: the axis is a slave of x; decouple it"),
    "move_relative": ({"distance": 1.0}, "23040 axis y: move_relative refused: the axis is a slave of x; decouple it"),
    "stop": ({}, "23040 axis y: stop refused: the axis is a slave of x; stop x or decouple the axis"),
    "halt": ({}, "23040 axis y: halt refused: the axis is a slave of x; stop x or decouple the axis"),
    "emergency_stop": (
        {"deceleration": 20_000.0, "jerk": 500_000.0},
        "23040 axis y: emergency_stop refused: the axis is a slave of x; stop x or decouple the axis",
    ),
    "new_target": ({"target": 5.0}, "23014 axis y: new_target refused: no positioning is active (the axis is in SynchronizedMotion); start one"),
    "external_enable": ({"mode": "relative"}, "23030 axis y: external_enable refused: x is the master of the axis"),
    "couple": ({"master": "z", "factor": 1.0}, "23044 axis y: couple refused: the axis is in SynchronizedMotion, it must be in Standstill"),
}  # fmt: skip


@pytest.mark.parametrize("moving", [False, True], ids=["standing", "moving"])
@pytest.mark.parametrize("command", LOCKED)
def test_what_is_locked_on_a_slave(command: str, moving: bool) -> None:
    arguments, text = LOCKED[command]
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=0.5)
    if moving:
        bench.send_all([start()])
        bench.run(0.5)
    assert bench.denied("y", command, **arguments) == f"P-ERR-{text}; nothing was changed"
    bench.run(0.2)
    assert_linear(bench, "x", "y", 0.5)
    assert bench.state("y") == S.SYNCHRONIZED_MOTION


def test_compensation_stays_and_the_slaves_own_override_does_not_act() -> None:
    bench = SlaveBench()
    bench.send_all([couple("y", 1.0), start(10_000.0)])
    bench.run(0.6)
    assert bench.do("y", "set_override", percent=10.0) == ""
    bench.run(0.4)
    assert_linear(bench, "x", "y", 1.0)
    assert bench.do("y", "compensation_start", **COMPENSATION) == ""
