"""Errors in a master/slave group: immediate or delayed, only who is in the group then, bits, reset, lost masters."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from error_support import refused
from long_support import long
from machine_support import PTP, assert_axis_smooth, machine
from slave_support import COMPENSATION, DELAYED, DYNAMICS, ERROR, PROTECTED, A, J, SlaveBench, assert_linear, axes_named

from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.axis_states import AxisStateCode as S

DELAY = 0.3
LATE = {"error_propagation_delayed": True, "error_propagation_delay": DELAY}


def group(source: MachineParameters | None = None, *, moving: bool = True, **axes: dict[str, Any]) -> SlaveBench:
    """x -> y -> z with factors 0.5 and -0.8; c is alone and moves as well; 1 s after the start of x and c."""
    bench = SlaveBench(machine=machine(source or axes_named("x", "y", "z", "c"), **axes))
    bench.send_all([("z", "couple", {"master": "y", "factor": -0.8}), ("y", "couple", {"master": "x", "factor": 0.5})])
    if moving:
        bench.send_all([(axis, "move_absolute", {"target": 20_000.0, **DYNAMICS}) for axis in "xc"])
        bench.run(0.98)
    return bench


def late_group(**kwargs: Any) -> SlaveBench:
    return group(axes_named("x", "y", "z", "c", **LATE), **kwargs)


def states(bench: SlaveBench, axes: str = "xyz") -> list[int]:
    return [bench.state(axis) for axis in axes]


def error_cycle(bench: SlaveBench, axis: str) -> int:
    """The first cycle with an error number."""
    return int(np.argmax(np.array(bench.column(axis, "error_id")) != 0))


def error_of(bench: SlaveBench, axis: str) -> int:
    return int(bench.last(axis).error_id[-1])


REMOVED = (
    "P-ERR-23010 axis y: the enable was removed during synchronous motion; the axis stops on its own ramp (ErrorStop)"
)


def spread(axis: str, source: str = "y", error: int = 23010) -> str:
    return (
        f"P-ERR-23056 axis {axis}: axis {source} of its group has error {error}; the axis stops on its own ramp "
        "(ErrorStop)"
    )


# instantaneous


@pytest.mark.parametrize("block_cycles", [10, *long([100, 1, 7])])
def test_instantaneous_all_of_the_group_stop_on_their_ramps(block_cycles: int) -> None:
    bench = group(axes_named("z", "c", "y", "x", block_cycles=block_cycles))
    failed = bench.cycle
    bench.do("y", "power", enabled=False)
    bench.settle()
    assert bench.errors() == [REMOVED, *(spread(axis) for axis in bench.machine.axes if axis in "xz")]
    assert error_cycle(bench, "y") == failed
    for axis in "xz":
        assert failed < error_cycle(bench, axis) <= failed + 2 * block_cycles
    for axis in "xyz":
        assert_axis_smooth(bench.blocks[axis], acceleration=A, jerk=J)
        assert bench.bits(axis, ERROR)[-1] and not bench.bits(axis, DELAYED).any()
        assert bench.bits(axis, PROTECTED)[-1] == (axis != "x")
    assert states(bench) == [S.ERROR_STOP] * 3
    assert (bench.state("c"), bench.position("c")) == (S.STANDSTILL, 20_000.0), "of no group"


def test_the_faulty_axis_does_not_follow_its_master_any_more() -> None:
    """y stops on its own ramp immediately, not on the relation to x; z follows y until it is notified of the error."""
    bench = group()
    failed = bench.cycle
    bench.do("y", "power", enabled=False)
    bench.settle()
    ramp = 1000.0 / A + A / J
    standing = int(np.argmax(bench.values("y", "set_velocity")[failed:] == 0.0))
    assert standing == pytest.approx(ramp * 1000.0, abs=1.5)
    assert_linear(bench, "y", "z", -0.8, end=error_cycle(bench, "z"))


@pytest.mark.parametrize("faulty", ["x", *long(["z"])])
def test_an_error_of_the_master_or_the_last_slave(faulty: str) -> None:
    """A following error (lag v/Kv = 4 mm of x, 0.8·2 mm of z) beyond its limit."""
    lag = {"following_error_monitoring": True, "following_error_limit": 1.5}
    bench = group(**{faulty: lag})
    bench.settle()
    assert [bench.last(axis).error_id[-1] for axis in "xyz" if axis != faulty] == [23056, 23056]
    assert error_of(bench, faulty) == 0x4550 and bench.state("c") == S.STANDSTILL
    for axis in "xyz":
        assert_axis_smooth(bench.blocks[axis], acceleration=A, jerk=J)


def test_an_error_during_a_compensation_makes_no_step() -> None:
    bench = group()
    bench.do("y", "compensation_start", **{**COMPENSATION, "process_velocity": 1000.0})
    bench.run(0.5)
    bench.do("x", "power", enabled=False)
    bench.run(0.02)
    bench.do("y", "power", enabled=False)
    bench.settle()
    v, p = bench.values("y", "set_velocity"), bench.values("y")
    assert np.abs(np.diff(v)).max() <= 0.001 * (A + 1000.0)
    assert np.abs(np.diff(p) - 0.0005 * (v[1:] + v[:-1])).max() < 1e-4
    assert not bench.bits("y", 1 << 13)[-1]


# delayed


def test_delayed_only_the_faulty_axis_stops_until_the_delay_is_over() -> None:
    bench = late_group()
    failed = bench.cycle
    bench.do("y", "power", enabled=False)
    bench.run(0.2)
    assert states(bench) == [S.DISCRETE_MOTION, S.ERROR_STOP, S.SYNCHRONIZED_MOTION]
    assert bench.last("x").set_velocity[-1] == 2000.0
    assert (bench.bits("y", ERROR) & bench.bits("y", DELAYED))[failed:].all()
    bench.settle()
    delayed = bench.bits("y", DELAYED)
    assert delayed.sum() == DELAY * 1000 and not delayed[failed + 300 :].any() and bench.bits("y", ERROR)[-1]
    assert states(bench) == [S.ERROR_STOP] * 3
    for axis in "xz":
        assert failed + 300 <= error_cycle(bench, axis) <= failed + 300 + 20
        assert not bench.bits(axis, DELAYED).any()
    assert bench.errors() == [REMOVED, spread("x"), spread("z")]
    assert_linear(bench, "y", "z", -0.8)


def test_delayed_the_slave_of_the_faulty_axis_is_decoupled_in_time() -> None:
    """It is no longer of a group with an error: it continues, x does not."""
    bench = late_group()
    bench.do("y", "power", enabled=False)
    bench.run(0.05)
    bench.do("z", "decouple", target=-3000.0)
    bench.settle()
    assert states(bench) == [S.ERROR_STOP, S.ERROR_STOP, S.STANDSTILL]
    assert bench.position("z") == -3000.0


def test_delayed_the_faulty_axis_is_decoupled_in_time() -> None:
    """Two groups: x without error continues, y and its slave z stop."""
    bench = late_group()
    bench.do("y", "power", enabled=False)
    bench.run(0.05)
    assert bench.do("y", "decouple") == ""
    bench.settle()
    assert states(bench) == [S.STANDSTILL, S.ERROR_STOP, S.ERROR_STOP]
    assert bench.position("x") == 20_000.0 and not bench.bits("y", PROTECTED)[-1]
    assert_axis_smooth(bench.blocks["y"], acceleration=A, jerk=J)


def test_delayed_the_master_is_stopped_in_time() -> None:
    """The user's own reaction: x stops on the ramp of its start; the error reaches it all the same."""
    bench = late_group()
    bench.do("y", "power", enabled=False)
    assert bench.do("x", "stop") == ""
    assert bench.state("x") == S.STOPPING
    bench.settle()
    assert states(bench) == [S.ERROR_STOP] * 3
    assert bench.errors() == [REMOVED, spread("x"), spread("z")]


def test_delayed_a_reset_in_time_ends_the_matter() -> None:
    bench = late_group(moving=False)
    bench.do("y", "power", enabled=False)
    bench.run(0.1)
    bench.do("y", "reset")
    bench.run(0.5)
    assert states(bench) == [S.STANDSTILL, S.DISABLED, S.SYNCHRONIZED_MOTION]
    assert not bench.bits("y", ERROR)[-1] and not bench.bits("y", DELAYED)[-1]
    assert bench.errors() == [REMOVED]


def test_delayed_who_joins_the_group_in_time_hears_of_it() -> None:
    bench = late_group(moving=False)
    bench.do("y", "power", enabled=False)
    bench.do("c", "couple", master="x", factor=1.0)
    bench.run(0.5)
    assert states(bench, "xyzc") == [S.ERROR_STOP] * 4


def test_delayed_a_second_error_has_a_delay_of_its_own() -> None:
    bench = late_group()
    bench.do("y", "power", enabled=False)
    bench.run(0.2)
    second = bench.cycle
    bench.do("z", "power", enabled=False)
    bench.settle()
    assert bench.errors() == [REMOVED, REMOVED.replace("axis y", "axis z"), spread("x")]
    assert error_cycle(bench, "x") < second + 130
    assert bench.bits("z", DELAYED).sum() == 300


@pytest.mark.parametrize("faulty", ["x", "y", "z"])
def test_the_mode_of_the_axis_with_the_error_counts(faulty: str) -> None:
    bench = group(moving=False, **{faulty: LATE})
    other = "y" if faulty != "y" else "z"
    bench.do(other, "power", enabled=False)
    bench.run(0.05)
    assert states(bench) == [S.ERROR_STOP] * 3


def test_an_axis_without_a_group_has_nothing_to_delay() -> None:
    bench = late_group()
    bench.send("c", "upstream_lost", source="clock")
    bench.run(0.01)
    assert bench.bits("c", ERROR)[-1] and not bench.bits("c", DELAYED).any()


# reset


def test_reset_of_a_slave_ends_its_coupling() -> None:
    bench = group()
    bench.do("y", "power", enabled=False)
    assert bench.denial("y", "reset") == refused(23008)
    bench.settle()
    for axis in "xyz":
        assert bench.do(axis, "reset") == ""
        assert not bench.bits(axis, PROTECTED)[-1] and bench.last(axis).master == ""
    assert states(bench) == [S.STANDSTILL, S.DISABLED, S.STANDSTILL]
    bench.do("y", "power", enabled=True)
    bench.send_all([("y", "couple", {"master": "x", "factor": 1.0}), ("x", "move_relative", {"distance": 100.0})])
    begin = bench.cycle - 10
    bench.settle()
    offset = bench.position("y") - bench.position("x")
    assert_linear(bench, "x", "y", 1.0, offset, begin=begin)
    assert bench.position("z") == bench.values("z")[begin], "z is no longer a slave of y"


def test_resets_in_any_order_do_not_bring_the_error_back() -> None:
    for order in ("xyz", "zyx", "yxz"):
        bench = group(moving=False)
        bench.do("y", "power", enabled=False)
        bench.run(0.05)
        for axis in order:
            bench.do(axis, "reset")
            bench.run(0.05)
        assert states(bench) == [S.STANDSTILL, S.DISABLED, S.STANDSTILL], order
        assert len(bench.errors()) == 3


def test_what_an_axis_in_error_refuses_and_takes() -> None:
    bench = group(moving=False)
    bench.do("y", "power", enabled=False)
    bench.run(0.05)
    assert bench.denial("y", "couple", master="x", factor=1.0) == refused(23044, state="ErrorStop")
    assert bench.denial("y", "set_coupling_factor", factor=1.0) == refused(23047, state="ErrorStop")
    assert bench.do("z", "decouple") == ""
    assert bench.state("z") == S.ERROR_STOP and not bench.bits("z", PROTECTED)[-1]
    assert bench.denial("z", "decouple") == refused(23047, state="ErrorStop")


def test_an_axis_that_is_off_is_not_told() -> None:
    bench = group(moving=False)
    bench.do("x", "power", enabled=False)
    bench.do("y", "power", enabled=False)
    bench.run(0.1)
    assert states(bench) == [S.DISABLED, S.ERROR_STOP, S.ERROR_STOP]


# a master that is lost


@pytest.mark.parametrize("slave", ["y", *long(["z"])])
def test_a_lost_master(slave: str) -> None:
    """The watchdog of the slave: it stops on its own ramp, and the group with it."""
    master = {"y": "x", "z": "y"}[slave]
    bench = group()
    bench.give(slave, "upstream_lost", source=master)
    bench.settle()
    lost = f"P-ERR-26101 axis {slave}: no block of '{master}' came within the watchdog time; the axis stops on its own ramp (ErrorStop)"
    assert bench.errors() == [lost, *(spread(axis, slave, 26101) for axis in "xyz" if axis != slave)]
    for axis in "xyz":
        assert_axis_smooth(bench.blocks[axis], acceleration=A, jerk=J)


def test_others_may_be_lost() -> None:
    bench = group()
    for lost in ("c", "z", "x"):
        bench.give("z", "upstream_lost", source=lost)
    bench.run(0.2)
    assert bench.errors() == [] and bench.state("z") == S.SYNCHRONIZED_MOTION
    assert_linear(bench, "y", "z", -0.8)


def test_a_master_that_was_lost_before_moves_nobody() -> None:
    """The slave received nothing from it: an error at the first block without it, not a motion without a reason."""
    bench = SlaveBench()
    bench.give("y", "upstream_lost", source="x")
    bench.run(0.05)
    record = bench.send("y", "couple", master="x", factor=1.0)
    bench.run(0.1)
    assert (
        bench.errors()[:1]
        == ["P-ERR-26101 axis y: there is no block of its master 'x'; the axis stops on its own ramp (ErrorStop)"]
        or not record.accepted
    )
    bench.send("x", "move_absolute", target=100.0)
    bench.run(0.5)
    assert set(bench.column("y", "set_position")) == {0.0}


def test_a_master_whose_node_is_lost_is_refused() -> None:
    """The PLC has lost it."""
    bench = SlaveBench()
    bench.give("plc", "upstream_lost", source="x")
    bench.run(0.05)
    record = bench.send("y", "couple", master="x", factor=1.0)
    text = "axis y: couple refused: the node of the master x is lost; nothing was changed"
    assert (record.error_id, record.message) == (23042, text)


def test_the_plc_lost_stops_all_axes_of_a_group() -> None:
    bench = group(PTP)
    for axis in "xyz":
        bench.give(axis, "upstream_lost", source="plc")
    bench.settle()
    assert states(bench) == [S.ERROR_STOP] * 3
    for axis in "xyz":
        assert_axis_smooth(bench.blocks[axis], acceleration=A, jerk=J)
