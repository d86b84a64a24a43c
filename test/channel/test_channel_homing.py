"""G74 in programs: order, positions afterwards, soft limits, holds, aborts, faults; the same again in a replay."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import pytest
from machine_support import MILL, MachineBench, machine
from replay_support import bits, replay

from cnc_ptp.channel.channel_unit import ChannelUnit
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

HOMING = {"fast": 50.0, "slow": 10.0, "to_zero_pulse": 3.0, "range": 300.0, "required": True}
DOWN = {"cam_position": -40.0, "reference_position": -43.0}
UP = {"direction": 1.0, "cam_position": 60.0, "reference_position": 63.0}


def mill(referenced: bool = False, **homing: Any) -> MachineParameters:
    """x and y are homed downwards, z upwards."""
    axes = {
        name: {
            "referenced_at_start": referenced,
            "homing": replace(MILL.axes[name].homing, **{**HOMING, **place, **homing}),
        }
        for name, place in {"x": DOWN, "y": DOWN, "z": UP}.items()
    }
    return machine(MILL, **axes)


def run(program: str, scenario: str = "", **homing: Any) -> MachineBench:
    return MachineBench(program, scenario, machine=mill(**homing)).run()


def homing_cycles(bench: MachineBench, axis: str) -> tuple[int, int]:
    cycles = [n for n, state in enumerate(bench.column(axis, "state")) if state == S.HOMING]
    return cycles[0], cycles[-1]


def test_axes_home_in_the_order_of_their_values() -> None:
    bench = run("N10 G74 X2 Y2 Z1\nN20 G0 X10 Y10 Z5\nN30 G1 G91 X[V.A.ABS.X / 2] F2000\nM30")
    assert bench.errors() == bench.refusals() == []
    (x, x_end), (y, _), (_, z_end) = (homing_cycles(bench, axis) for axis in "xyz")
    assert x == y and z_end < x < z_end + 30
    assert [bench.position(axis) for axis in "xyz"] == [15.0, 10.0, 5.0]
    assert [bench.last(axis).actual_position[-1] for axis in "xyz"] == pytest.approx([15.0, 10.0, 5.0], abs=1e-3)
    states = [S.SYNCHRONIZED_MOTION, S.STANDSTILL, S.HOMING, S.STANDSTILL, S.SYNCHRONIZED_MOTION, S.STANDSTILL]
    assert bench.states("x") == states
    begin = next(n for n in range(x_end, x_end + 40) if bench.column("x", "state")[n] == S.SYNCHRONIZED_MOTION)
    assert bench.column("x", "set_velocity")[begin] == 0.0


def test_the_program_continues_from_where_the_axes_stand() -> None:
    """G91 and V.A.ABS after G74 count from there; offsets stay."""
    bench = run(
        "N5 G92 X100\nN10 G74 X1\nN20 P1 = V.A.ABS.X\nP2 = V.A.PROG.X\nN30 G91 X5\nN40 G90 Y[P1]\nZ[P1 - P2]\nM30",
        required=False,
    )
    assert bench.errors() == bench.refusals() == []
    stood = bench.position("x") - 5.0
    assert stood == pytest.approx(-43.0, abs=1.0)
    assert bench.position("y") == pytest.approx(stood, abs=1e-6)
    assert bench.position("z") == pytest.approx(100.0, abs=1e-6)


def test_a_program_moves_no_axis_that_is_not_referenced() -> None:
    bench = MachineBench("N10 G0 X10\nM30", machine=mill()).run(1.0)
    assert bench.refusals() == [
        "P-ERR-22034 test.nc line 1 column 8 'N10 G0 X10': axis X is not referenced (P-MACH-00061); G74 X1 first; nothing was started"
    ]
    assert bench.position("x") == 0.0
    bench = run("N10 G74 X1\nN20 X5\nN30 Y10\nM30")
    (text,) = bench.errors()
    assert "P-ERR-22034 channel channel: test.nc line 3 column 5 'N30 Y10': axis Y is not referenced" in text
    assert (bench.position("x"), bench.position("y")) == (5.0, 0.0)
    refused_arc = MachineBench("G74 X1\nG2 I5 F100\nM30", machine=mill()).run()
    assert "axis Y is not referenced" in refused_arc.errors()[0]


def test_without_that_rule_it_moves_them_without_soft_limits() -> None:
    bench = run("N10 G0 X-500\nM30", required=False)
    assert bench.errors() == bench.refusals() == [] and bench.position("x") == -500.0
    bench = run("N10 G0 X-500\nM30", referenced=True)
    assert "P-ERR-120003" in bench.refusals()[0]
    bench = run("N10 G74 X1\nN10 G0 X-500\nM30", required=False)
    assert "P-ERR-120003" in bench.errors()[0]


@pytest.mark.parametrize("prepared", [False, True])
def test_soft_limits_count_for_a_program_that_was_prepared_before_the_plc_homed(prepared: bool) -> None:
    text = "N10 G1 X-500 F20000\nN20 X-1\nM30"
    bench = MachineBench(machine=mill(required=False), end_when_idle=False)
    channel = bench.units["channel"]
    assert isinstance(channel, ChannelUnit)
    if prepared:
        channel.prepare("far.nc", text)
    bench.run(0.1)
    assert all(bench.give(axis, "home").accepted for axis in "xyz")
    bench.run(25.0)
    assert all(bench.give(axis, "move_absolute", target=0.0).accepted for axis in "xyz")
    bench.run(10.0)
    assert [bench.position(axis) for axis in "xyz"] == [0.0] * 3
    assert bench.give("channel", "load", program="far.nc", text=text).accepted
    started = bench.give("channel", "start")
    assert (started.accepted, started.error_id) == (False, 120003)
    assert started.message.endswith(
        "-500 mm lies beyond the negative soft limit -300 mm (P-AXIS-00177); nothing was started"
    )
    assert bench.run(0.5).position("x") == 0.0


def test_homing_by_the_plc_counts_too() -> None:
    scenario = "- {at: 0, to: x, do: home}\n- {at: 4, to: channel, do: start}\n"
    bench = MachineBench("N10 G0 X10\nM30", scenario, machine=mill(), start=False).run()
    assert bench.errors() == bench.refusals() == [] and bench.position("x") == 10.0


def test_mdi() -> None:
    scenario = '- {at: 0, to: channel, do: mdi, text: "G74 X1"}\n- {at: 5, to: channel, do: mdi, text: "G91 X1"}\n'
    bench = MachineBench(None, scenario, machine=mill()).run()
    assert bench.errors() == bench.refusals() == []
    assert bench.position("x") == pytest.approx(-42.0, abs=1.0)


def test_feed_hold_and_override_of_the_channel() -> None:
    scenario = """
- {at: 0.5, to: channel, do: feed_hold, enabled: true}
- {at: 1.5, to: channel, do: feed_hold, enabled: false}
- {at: 1.5, to: channel, do: set_override, percent: 20}
- {at: 2.5, to: channel, do: set_override, percent: 100}
"""
    bench = run("N10 G74 X1\nN20 G0 X10\nM30", scenario)
    assert bench.errors() == [] and bench.position("x") == 10.0
    assert bench.states("channel") == [C.RUNNING, C.HOLD, C.RUNNING, C.READY] or C.HOLD in bench.states("channel")
    held = bench.column("x", "set_velocity")[1200:1490]
    assert set(held) == {0.0} and bench.column("x", "state")[1300] == S.HOMING
    slow = bench.column("x", "set_velocity")[1600:2400]
    assert min(slow) == pytest.approx(-10.0)
    velocities = bench.column("x", "set_velocity")
    assert max(abs(b - a) for a, b in itertools.pairwise(velocities)) < 5.1


def test_an_override_from_before_counts_from_the_start() -> None:
    scenario = "- {at: 0, to: channel, do: set_override, percent: 50}\n"
    bench = run("N10 G74 X1\nM30", scenario)
    assert bench.errors() == [] and min(bench.column("x", "set_velocity")) == pytest.approx(-25.0)


def test_a_reset_stops_the_axes_that_home() -> None:
    bench = run("N10 G74 X1 Y1 Z2\nN20 G0 X10\nM30", "- {at: 0.5, to: channel, do: reset}\n")
    assert bench.errors() == [] and bench.states("z") == [S.SYNCHRONIZED_MOTION, S.STANDSTILL]
    for axis in "xy":
        assert bench.states(axis)[2:] == [S.HOMING, S.STOPPING, S.STANDSTILL]
        assert bench.last(axis).status_bits[-1] & StatusBit.NOT_REFERENCED


def test_a_stop_of_one_axis_aborts_the_program() -> None:
    bench = run("N10 G74 X1 Y1\nN20 G0 X10\nM30", "- {at: 0.5, to: x, do: stop}\n")
    assert bench.errors() == [
        "P-ERR-22035 channel channel: the homing of axis x was aborted, it is in Stopping in test.nc line 1 'N10 G74 X1 Y1'; "
        "the path stops on its ramp and the program is aborted"
    ]
    assert bench.states("y")[-2:] == [S.STOPPING, S.STANDSTILL]


def test_a_cam_that_is_not_there_aborts_the_program() -> None:
    bench = run("N10 G74 X1\nM30", cam_position=-1000.0)
    axis, channel = bench.errors()
    assert axis.startswith("P-ERR-70394 axis x: homing: no reference cam within 300 mm (P-AXIS-00412)")
    assert channel.startswith("P-ERR-22012 channel channel: x is in error P-ERR-70394")


def test_a_refusal_of_an_axis_aborts_the_program() -> None:
    parameters = mill()
    x = parameters.axes["x"]
    on_cam = replace(x, homing=replace(x.homing, without_reversing=True, cam_position=10.0))
    bench = MachineBench("N10 G74 X1\nM30", machine=replace(parameters, axes={**parameters.axes, "x": on_cam})).run()
    assert bench.errors() == [
        "P-ERR-22035 channel channel: axis x has refused to home, it is in Standstill in test.nc line 1 'N10 G74 X1'; "
        "the path stops on its ramp and the program is aborted"
    ]


def test_axes_with_absolute_encoders() -> None:
    bench = run("N10 G74 X1 Y2\nN20 G0 X10\nM30", referenced=True, kind="IGNORE_ABS_POS")
    assert bench.errors() == bench.refusals() == [] and bench.position("x") == 10.0
    assert S.HOMING not in bench.states("x")
    bench = run("N10 G74 X1\nM30", referenced=True, kind="DISABLED")
    assert bench.refusals() == [
        "P-ERR-60313 test.nc line 1 column 9 'N10 G74 X1': axis X cannot be homed (P-AXIS-00299 = DISABLED); nothing was started"
    ]


def test_single_block_stops_behind_it() -> None:
    scenario = "- {at: 0, to: channel, do: single_block, enabled: true}\n- {at: 5, to: channel, do: start}\n"
    bench = run("N10 G74 X1\nN20 G0 X10\nM30", scenario + "- {at: 6, to: channel, do: start}\n")
    assert bench.errors() == [] and bench.position("x") == 10.0
    assert C.STOPPED in bench.states("channel")


@pytest.mark.long
def test_two_runs_and_a_replay_are_bit_identical() -> None:
    program = "N10 G74 X2 Y2 Z1 S1\nN20 G0 X10 Y10 Z5\nN30 G74 X1\nN40 X0\nM30"
    scenario = (
        "- {at: 0.7, to: channel, do: set_override, percent: 40}\n- {at: 0.9, to: y, do: set_override, percent: 70}\n"
    )
    first, second = run(program, scenario), run(program, scenario)
    assert first.errors() == [] and first.position("x") == 0.0
    assert bits(first) == bits(second)
    again = replay(mill(), first.records, len(first.blocks["x"]))
    assert {name: again[name] for name in "xyz"} == {name: bits(first)[name] for name in "xyz"}
    assert again["channel"] == bits(first)["channel"]
