"""Slaves and their masters at soft limits, without enable, and moved by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from machine_support import PTP, machine
from slave_support import DYNAMICS, SlaveBench, assert_linear

from cnc_ptp.protocol.axis_states import AxisStateCode as S


def couple(slave: str, factor: float, master: str = "x") -> tuple[str, str, dict[str, Any]]:
    return slave, "couple", {"master": master, "factor": factor}


def start(target: float = 2000.0, axis: str = "x") -> tuple[str, str, dict[str, Any]]:
    return axis, "move_absolute", {"target": target, **DYNAMICS}


def test_a_slave_that_leaves_its_soft_limits_stops_and_takes_the_group_along() -> None:
    limits = {"soft_limit_negative": -1000.0, "soft_limit_positive": 300.0}
    bench = SlaveBench(machine=machine(PTP, y=limits))
    bench.send_all([couple("y", 0.5), start()])
    bench.settle()
    texts = bench.errors()
    y = bench.values("y")
    passed = int(np.argmax(y > 300.0))
    assert texts[0] == (
        f"P-ERR-120002 axis y: set position {y[passed]} mm is beyond the positive soft limit 300.0 mm (P-AXIS-00178); "
        "the axis stops on its own ramp (ErrorStop)"
    )
    assert texts[1] == (
        "P-ERR-23056 axis x: axis y of its group has error 120002; the axis stops on its own ramp (ErrorStop)"
    )
    assert bench.state("x") == bench.state("y") == S.ERROR_STOP
    assert_linear(bench, "x", "y", 0.5, end=passed + 1)


def test_a_standing_master_that_comes_back_from_elsewhere_does_not_take_its_slave_along() -> None:
    """Without enable x was pushed by 250 mm; the slave stays where it is, and its offset follows."""
    bench = SlaveBench()
    bench.send_all([couple("y", 2.0), couple("z", -1.0, "y"), start(100.0)])
    bench.settle()
    bench.do("x", "power", enabled=False)
    drive = bench.units["x"]._loop.drive
    drive._true_position = 350.0
    bench.run(0.05)
    bench.do("x", "power", enabled=True)
    begin = bench.cycle
    bench.run(0.05)
    assert bench.position("x") == pytest.approx(350.0)
    bench.send_all([start(400.0)])
    bench.settle()
    assert_linear(bench, "x", "y", 2.0, 200.0 - 700.0, begin=begin)
    assert_linear(bench, "y", "z", -1.0)
    assert np.abs(np.diff(bench.values("y"))).max() < 1.0


def test_power_off_and_on_of_a_standing_and_of_a_moving_master() -> None:
    bench = SlaveBench()
    bench.send_all([couple("y", 0.5), start()])
    bench.run(0.5)
    bench.do("x", "power", enabled=False)
    bench.settle()
    assert (bench.state("x"), bench.state("y")) == (S.DISABLED, S.SYNCHRONIZED_MOTION)
    bench.run(0.1)
    begin = bench.cycle
    bench.do("x", "power", enabled=True)
    bench.send_all([start(0.0)])
    bench.settle()
    assert_linear(bench, "x", "y", 0.5, end=begin)
    assert_linear(bench, "x", "y", 0.5, begin=begin, offset=bench.values("y")[begin] - 0.5 * bench.values("x")[begin])
    assert bench.errors() == []


def test_power_off_of_a_slave_is_an_error_of_the_group_even_at_standstill() -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=0.5)
    bench.do("y", "power", enabled=False)
    bench.run(0.1)
    assert bench.errors() == [
        "P-ERR-23010 axis y: the enable was removed during synchronous motion; the axis stops on its own ramp (ErrorStop)",
        "P-ERR-23056 axis x: axis y of its group has error 23010; the axis stops on its own ramp (ErrorStop)",
    ]
    for axis in "xy":
        bench.do(axis, "reset")
    bench.do("y", "power", enabled=True)
    bench.do("y", "couple", master="x", factor=1.0)
    bench.send_all([start(50.0)])
    bench.settle()
    assert bench.position("y") == pytest.approx(50.0, abs=1e-9)
