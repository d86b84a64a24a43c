"""Other coordinates (MC_SetPosition): the axis moves as it would have moved without, and shows other positions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from axis_motion_support import run_to_standstill
from axis_states_support import DYNAMICS, STATES
from error_support import refused
from job_support import told
from long_support import long
from machine_support import MILL, MachineBench, UnitBench, axis_bench, machine
from slave_support import SlaveBench
from superposition_support import column

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit

LAGGING = {"kv": 20.0, "drive_time_constant": 0.01}
"""A drive with a following error that everybody sees."""
SHIFTED = StatusBit.COORDINATES_SHIFTED
DRIVE = ("set_velocity", "set_acceleration", "following_error", "command_velocity", "actual_velocity", "state")


def pair(name: str, **changes: Any) -> tuple[UnitBench, UnitBench]:
    benches = axis_bench(**LAGGING | changes), axis_bench(**LAGGING | changes)
    for bench in benches:
        STATES[name][0](bench)
    return benches


def assert_moves_alike(bench: UnitBench, alone: UnitBench, at: int, distance: float) -> None:
    """The drive gets the same commands; both positions are `distance` greater from `at` on."""
    for name in DRIVE:
        assert np.abs(column(bench, name) - column(alone, name)).max() < 1e-7, name
    for name in ("set_position", "actual_position"):
        shift = column(bench, name) - column(alone, name)
        assert np.abs(shift[:at]).max(initial=0.0) == 0.0 and np.abs(shift[at:] - distance).max() < 1e-9


@pytest.mark.parametrize("distance", [-12.345, *long([1000.0])])
@pytest.mark.parametrize(
    "name",
    [name for name in STATES if name not in ("external", "external_beside", "on_path")],
)
def test_the_motion_is_the_same(name: str, distance: float) -> None:
    bench, alone = pair(name)
    at = bench.cycle
    assert bench.accepted("set_position", position=distance, relative=True) == ""
    for each in (bench, alone):
        each.run(4000)
    assert_moves_alike(bench, alone, at, distance)
    assert told(bench) == told(alone), "it is no job"
    bits = column(bench, "status_bits").astype(int) & SHIFTED != 0
    assert not bits[:at].any() and bits[at:].all()


def test_the_actual_position_gets_the_value_and_the_following_error_stays() -> None:
    bench = axis_bench(**LAGGING)
    bench.accepted("move_absolute", target=3000.0, **DYNAMICS)
    bench.run(600)
    bench.accepted("set_position", position=-50.0)
    bench.run(10)
    lag = bench.column("following_error")[600]
    assert bench.column("actual_position")[600] == pytest.approx(-50.0, abs=1e-9) and lag > 90.0
    assert bench.column("set_position")[600] == pytest.approx(-50.0 + lag, abs=1e-9)


def test_what_is_commanded_keeps_its_place_and_new_targets_are_in_the_new_coordinates() -> None:
    """Active and waiting motion, a new velocity from a position on, the last target."""
    bench = axis_bench()
    bench.accepted("move_absolute", target=1000.0, **DYNAMICS)
    bench.run(100)
    bench.accepted("move_absolute", target=1200.0, buffer_mode="buffered", **DYNAMICS)
    bench.accepted("set_position", position=5000.0, relative=True)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 6200.0
    bench.accepted("move_additive", distance=-100.0, **DYNAMICS)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 6100.0
    bench.accepted("set_position", position=-5000.0, relative=True)
    bench.accepted("move_absolute", target=1000.0, **DYNAMICS)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 1000.0 and not bench.last.status_bits[-1] & SHIFTED


def test_a_pending_velocity_becomes_active_at_the_same_place() -> None:
    benches = axis_bench(), axis_bench()
    for bench in benches:
        bench.accepted("move_absolute", target=3000.0, **DYNAMICS | {"velocity": 1000.0})
        bench.run(500)
        bench.accepted("new_velocity_and_target", velocity=2000.0, target=4000.0, activation_position=1000.0)
        bench.run(100)
    benches[0].accepted("set_position", position=77.0, relative=True)
    for bench in benches:
        run_to_standstill(bench)
    assert_moves_alike(*benches, 600, 77.0)


def test_soft_limits_stay_where_they_are_on_the_machine() -> None:
    bench = axis_bench(soft_limit_negative=-100.0, soft_limit_positive=100.0)
    bench.accepted("set_position", position=1000.0)
    message = bench.refused("move_absolute", target=1100.5)
    assert message == (
        "P-ERR-120002 axis x: move_absolute refused: target 1100.5 mm lies beyond the positive soft limit 100.0 mm "
        "(P-AXIS-00178), which is at 1100.0 mm now; nothing was changed"
    )
    assert bench.refusal("move_absolute", target=0.0) == refused(120003, target=0.0, limit=900.0)
    bench.accepted("move_absolute", target=1100.0)
    run_to_standstill(bench)
    bench.accepted("move_velocity", velocity=-300.0)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 900.0


def test_a_jog_that_is_under_way_ends_at_the_limit_of_the_machine() -> None:
    bench = axis_bench(soft_limit_positive=100.0)
    bench.accepted("jog", velocity=50.0)
    bench.run(500)
    bench.accepted("set_position", position=-30.0, relative=True)
    run_to_standstill(bench)
    assert bench.column("set_position")[-1] == 70.0
    assert bench.event_texts() == [
        "P-ERR-23070 axis x: the jog has reached the positive soft limit 100.0 mm (P-AXIS-00178), which is at 70.0 mm "
        "now; the axis is at a standstill"
    ]


@pytest.mark.parametrize(("name", "number"), [("external", 23027), ("external_beside", 23027), ("on_path", 23005)])
def test_where_it_is_refused(name: str, number: int) -> None:
    bench = axis_bench()
    STATES[name][0](bench)
    assert bench.refusal("set_position", position=1.0)[0] == number


def test_neither_a_slave_nor_a_master_is_shifted() -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=1.0)
    bench.run(0.1)
    assert bench.denial("y", "set_position", position=1.0) == refused(23040, master="x")
    assert bench.denial("x", "set_position", position=1.0) == refused(23071, slaves="y")


def test_a_position_out_of_range_is_refused() -> None:
    bench = axis_bench()
    assert bench.refused("set_position", position=2e12) == (
        "P-ERR-23002 axis x: set_position refused: position 2000000000000.0 mm is not within ±1e+12 mm; nothing was "
        "changed"
    )


@pytest.mark.parametrize("command", ["start", "mdi"])
def test_a_channel_does_not_move_an_axis_with_other_coordinates(command: str) -> None:
    bench = MachineBench("%P\nG01 X1 F6000\nM30", start=False, end_when_idle=False).run(0.05)
    assert bench.give("x", "set_position", position=5.0, relative=True).accepted
    bench.run(0.05)
    arguments = {"text": "G01 X1 F6000"} if command == "mdi" else {}
    assert bench.refused("channel", command, **arguments) == (
        f"P-ERR-22037 channel channel: {command} refused: the coordinates of axis x are not those of the machine "
        "(set_position); shift them back or home the axis; nothing was changed"
    )
    assert bench.give("x", "set_position", position=-5.0, relative=True).accepted
    bench.run(0.05)
    assert bench.give("channel", command, **arguments).accepted
    bench.run(1.0)
    assert bench.position("x") == 1.0 and bench.errors() == []


def test_a_program_that_starts_in_the_same_block_is_a_fault_before_anything_moves() -> None:
    bench = MachineBench("%P\nG01 X1 F6000\nM30", start=False, end_when_idle=False).run(0.05)
    assert bench.give("channel", "start").accepted
    assert bench.give("x", "set_position", position=5.0, relative=True).accepted
    bench.run(0.5)
    assert bench.errors() and max(map(abs, bench.column("x", "set_velocity"))) == 0.0


def test_a_virtual_axis_shows_its_new_position() -> None:
    bench = MachineBench(None, machine=machine(MILL, x={"virtual": True}), end_when_idle=False).run(0.05)
    assert bench.give("x", "set_position", position=5.0).accepted
    bench.run(0.05)
    assert bench.last("x").actual_position[-1] == bench.last("x").set_position[-1] == 5.0
    assert bench.last("x").state[-1] == S.STANDSTILL
