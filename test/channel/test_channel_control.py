"""Feed hold, override, reset, refusals and faults of a running channel."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from long_support import long
from machine_support import CYCLE_TIME, MILL, MachineBench, assert_axis_smooth, assert_smooth, machine, seven_phases

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

UP, DOWN, J = 2000.0, 2400.0, 50_000.0
LINE = "%P\nN10 G01 X100 F6000\nM30"
CIRCLE = "%P\nG03 I20 J0 F3000\nM30"


def path(bench: MachineBench) -> tuple[list[float], list[float]]:
    """Path velocity and distance to go."""
    return bench.column("channel", "path_velocity"), bench.column("channel", "distance_to_go")


def running(program: str, seconds: float, scenario: str = "", **options: Any) -> MachineBench:
    return MachineBench(program, scenario, end_when_idle=False, **options).run(seconds)


def assert_all_smooth(bench: MachineBench) -> None:
    for name in ("x", "y", "z"):
        p = MILL.axes[name]
        assert_axis_smooth(bench.blocks[name], acceleration=max(p.acceleration, p.deceleration), jerk=p.jerk)


# ---------------------------------------------------------------- feed hold and override


def test_feed_hold_ramps_down_holds_and_goes_on() -> None:
    """From 100 mm/s A- 2400 is not reached: 2·√(v/J) and half of v·t; then the rest in the closed-form time."""
    bench = running(LINE, 0.5)
    bench.give("channel", "feed_hold", enabled=True)
    bench.run(0.5)
    velocity, to_go = path(bench)
    assert velocity[500] == pytest.approx(100.0)
    ramp = 2.0 * math.sqrt(100.0 / J)
    assert velocity.index(0.0, 500) * CYCLE_TIME == pytest.approx(0.5 + ramp, abs=1.1 * CYCLE_TIME)
    state = bench.column("channel", "state")
    assert set(state[:500]) == {C.RUNNING} and set(state[500 : velocity.index(0.0, 500)]) == {C.RUNNING}
    assert set(state[velocity.index(0.0, 500) :]) == {C.HOLD}
    assert to_go[500] - to_go[-1] == pytest.approx(50.0 * ramp, abs=1e-6)
    rest = to_go[-1]
    bench.give("channel", "feed_hold", enabled=False)
    bench.run(1.5)
    assert bench.position("x") == 100.0
    end = sum(d for d, _ in seven_phases(rest, 100.0, UP, DOWN, J))
    assert bench.states("channel") == [C.RUNNING, C.HOLD, C.RUNNING, C.READY]
    begin = bench.column("channel", "state").index(C.RUNNING, 900)
    assert bench.column("channel", "state").index(C.READY) - begin == pytest.approx(end / CYCLE_TIME, abs=1.1)
    assert_all_smooth(bench)


@pytest.mark.parametrize("milliseconds", [*range(10, 900, 330), *long(range(120, 900, 110))])
def test_feed_hold_stays_on_the_geometry(milliseconds: int) -> None:
    bench = running(CIRCLE, milliseconds / 1000.0)
    bench.give("channel", "feed_hold", enabled=True)
    bench.run(0.3)
    assert bench.column("channel", "path_velocity")[-1] == 0.0
    bench.give("channel", "feed_hold", enabled=False)
    bench.run(4.0)
    x, y = (np.array(bench.column(axis, "set_position")) for axis in "xy")
    assert np.hypot(x - 20.0, y) == pytest.approx(20.0, abs=1e-9)
    assert (bench.position("x"), bench.position("y")) == (0.0, 0.0) and bench.states("channel")[-1] == C.READY
    assert_all_smooth(bench)


def test_feed_hold_before_the_start_holds_at_the_first_motion() -> None:
    bench = MachineBench(LINE, end_when_idle=False, start=False).run(0.05)
    bench.give("channel", "feed_hold", enabled=True)
    bench.give("channel", "start")
    bench.run(0.5)
    assert bench.states("channel") == [C.IDLE, C.READY, C.HOLD] or bench.states("channel")[-1] == C.HOLD
    assert bench.position("x") == 0.0 and bench.column("channel", "distance_to_go")[-1] == 100.0
    bench.give("channel", "feed_hold", enabled=False)
    bench.run(2.0)
    assert bench.position("x") == 100.0


def test_feed_hold_in_the_brake_phase_lets_the_block_end_and_holds_the_next() -> None:
    bench = running("%P\nG09 G01 X100 F6000\nG01 X200\nM30", 1.07)
    assert 0.0 < bench.column("channel", "path_velocity")[-1] < 100.0
    bench.give("channel", "feed_hold", enabled=True)
    bench.run(0.5)
    assert bench.position("x") == 100.0 and bench.last("channel").state[-1] == C.HOLD
    assert bench.last("channel").line[-1] == 3


def test_feed_hold_does_not_stretch_a_dwell() -> None:
    bench = running("%P\nG04 0.3\nG01 X10 F3000\nM30", 0.1)
    bench.give("channel", "feed_hold", enabled=True)
    bench.run(1.0)
    assert bench.states("channel") == [C.RUNNING, C.WAITING, C.HOLD]
    assert bench.column("channel", "state").index(C.HOLD) == pytest.approx(300, abs=1)


@pytest.mark.parametrize(("percent", "velocity"), [(50.0, 50.0), (150.0, 150.0), (12.5, 12.5), (1, 1.0)])
def test_override_scales_the_feed(percent: float, velocity: float) -> None:
    bench = running(LINE, 0.4)
    record = bench.give("channel", "set_override", percent=percent)
    assert record.accepted and record.cycle == 400
    bench.run(0.3)
    assert bench.column("channel", "path_velocity")[-1] == pytest.approx(velocity)
    assert bench.column("channel", "override_percent")[399:401] == [100.0, percent]
    assert bench.column("channel", "programmed_feed")[-1] == 100.0
    bench.give("channel", "set_override", percent=100.0)
    bench.run(2.0)
    assert bench.position("x") == 100.0
    assert_all_smooth(bench)


def test_override_and_feed_hold_together() -> None:
    bench = running(LINE, 0.3, "- {at: 0, to: channel, do: set_override, percent: 50}")
    bench.give("channel", "feed_hold", enabled=True)
    bench.run(0.3)
    bench.give("channel", "set_override", percent=80.0)
    bench.run(0.2)
    assert bench.column("channel", "path_velocity")[-1] == 0.0
    bench.give("channel", "feed_hold", enabled=False)
    bench.run(0.3)
    assert bench.column("channel", "path_velocity")[-1] == pytest.approx(80.0)


def test_override_0_is_a_hold() -> None:
    bench = running(LINE, 0.3)
    bench.give("channel", "set_override", percent=0.0)
    bench.run(0.3)
    assert bench.last("channel").state[-1] == C.HOLD and bench.last("channel").path_velocity[-1] == 0.0


def test_override_of_rapid_traverse_never_exceeds_the_axes() -> None:
    bench = running("%P\nG00 X250\nM30", 0.0, "- {at: 0, to: channel, do: set_override, percent: 150}").run(3.0)
    assert max(bench.column("x", "set_velocity")) == pytest.approx(300.0) and bench.position("x") == 250.0
    slow = running("%P\nG00 X250\nM30", 0.0, "- {at: 0, to: channel, do: set_override, percent: 50}").run(3.0)
    assert max(slow.column("x", "set_velocity")) == pytest.approx(150.0)


@pytest.mark.parametrize("percent", [-0.5, 150.5])
def test_override_out_of_range(percent: float) -> None:
    assert running(LINE, 0.1).refused("channel", "set_override", percent=percent) == (
        f"P-ERR-22006 channel channel: set_override refused: percent = {percent} is not within 0 ... 150 "
        "(P-CHAN-00056); nothing was changed"
    )


def test_a_largest_override_below_100_percent_holds_from_the_start() -> None:
    bench = running(LINE, 0.5, machine=machine(channel={"max_override_percent": 60.0}))
    assert bench.column("channel", "path_velocity")[-1] == pytest.approx(60.0)
    assert set(bench.column("channel", "override_percent")) == {60.0}


# ---------------------------------------------------------------- reset


@pytest.mark.parametrize("milliseconds", [*range(10, 1200, 270), *long(range(100, 1200, 90))])
def test_reset_ramps_down_on_the_geometry(milliseconds: int) -> None:
    bench = running(CIRCLE, milliseconds / 1000.0)
    assert bench.give("channel", "reset").accepted
    bench.run(0.5)
    x, y = (np.array(bench.column(axis, "set_position")) for axis in "xy")
    assert np.hypot(x - 20.0, y) == pytest.approx(20.0, abs=1e-9)
    assert bench.last("channel").done and bench.last("channel").state[-1] == C.READY
    assert C.STOPPING in bench.states("channel")
    assert bench.errors() == []
    assert_all_smooth(bench)
    assert bench.give("channel", "mdi", text="G01 X0 Y0 Z0 F3000").accepted
    bench.run(2.0)
    assert (bench.position("x"), bench.position("y")) == (0.0, 0.0)


def test_a_second_reset_on_the_ramp_does_not_cut_it() -> None:
    bench = running(LINE, 0.5)
    for _ in range(5):
        bench.give("channel", "reset")
        bench.run(0.01)
    bench.run(0.5)
    assert bench.errors() == [] and bench.last("channel").done
    assert_all_smooth(bench)


def test_reset_in_the_brake_phase_ends_at_the_target_of_the_block() -> None:
    bench = running(LINE, 1.07)
    bench.give("channel", "reset")
    bench.run(0.5)
    assert bench.position("x") == 100.0 and bench.last("channel").state[-1] == C.READY
    assert_all_smooth(bench)


def test_reset_while_the_path_is_held() -> None:
    bench = running(LINE, 0.5)
    bench.give("channel", "feed_hold", enabled=True)
    bench.run(0.5)
    held = bench.position("x")
    bench.give("channel", "reset")
    bench.run(0.1)
    assert bench.position("x") == held and bench.last("channel").done
    bench.give("channel", "start")
    bench.run(0.1)
    assert bench.last("channel").state[-1] == C.HOLD  # the feed hold is still on
    bench.give("channel", "feed_hold", enabled=False)
    bench.run(2.0)
    assert bench.position("x") == 100.0


@pytest.mark.parametrize("program", ["%P\nG04 5\nG01 X10 F3000\nM30", "%P\nM08\nG01 X10 F3000\nM30", "%P\nM00\nM30"])
def test_reset_while_the_program_waits_and_another_program_at_once(program: str) -> None:
    """A dwell, a handshake, a programmed stop: nothing of them is left for the next program."""
    bench = running(program, 0.5, "- {at: 0, to: plc, do: auto_acknowledge, enabled: off}")
    bench.give("channel", "reset")
    bench.run(0.01)
    assert bench.last("channel").done and bench.last("channel").state[-1] == C.READY
    assert bench.give("channel", "mdi", text="G01 X3 F3000").accepted
    bench.run(0.5)
    assert bench.errors() == [] and bench.position("x") == 3.0


def test_reset_between_queueing_a_function_and_sending_it_withdraws_the_function() -> None:
    bench = MachineBench("%P\nM03 S600\nM30", end_when_idle=False).run(0.01)  # M03 goes out with block 1
    bench.give("channel", "reset")
    bench.run(0.5)
    commands = [r.command for r in bench.records if r.target == "s"]
    assert "start" not in commands and set(bench.column("s", "set_speed_rpm")) == {0.0}


def test_reset_between_m05_and_its_output_still_stops_the_spindle() -> None:
    """The blocks' functions go out with the next block; a stop must not get lost with the program."""
    program = "%P\nM03 S600\nG04 0.5\nM05\nG01 X10 F3000\nM30"
    probe = running(program, 2.0)
    stop = next(r.cycle for r in probe.records if r.target == "s" and r.command == "stop")
    bench = running(program, stop / 1000.0)
    assert [r.command for r in bench.records if r.target == "s"] == ["reset_feedforward", "start"]
    bench.give("channel", "reset")
    bench.run(0.5)
    assert bench.last("s").set_speed_rpm[-1] == 0.0


def test_a_fault_on_the_ramp_of_a_reset_stops_the_spindle_in_spite_of_p_axis_00455() -> None:
    bench = running("%P\nM03 S1200\nG01 X100 F6000\nM30", 0.8, machine=machine(s={"stops_at_reset": False}))
    bench.give("channel", "reset")
    bench.run(0.02)
    bench.give("channel", "upstream_lost", source="plc")
    bench.run(1.0)
    assert bench.last("s").set_speed_rpm[-1] == 0.0
    assert_all_smooth(bench)


def test_reset_stops_the_spindle_after_the_path() -> None:
    bench = running("%P\nM03 S1200\nG01 X100 F6000\nM30", 0.8)
    assert bench.last("channel").path_velocity[-1] > 0.0
    bench.give("channel", "reset")
    bench.run(1.0)
    velocity = bench.column("channel", "path_velocity")
    stop = next(r for r in bench.records if r.target == "s" and r.command == "stop")
    assert velocity[stop.cycle] == 0.0 and velocity[stop.cycle - 12] > 0.0
    assert bench.last("s").set_speed_rpm[-1] == 0.0


def test_reset_stops_a_spindle_that_an_earlier_program_left_turning() -> None:
    bench = running("%P\nM03 S1200\nM30", 1.0)
    assert bench.last("channel").done and bench.last("s").set_speed_rpm[-1] == 1200.0
    bench.give("channel", "reset")
    bench.run(0.5)
    assert bench.last("s").set_speed_rpm[-1] == 0.0


@pytest.mark.parametrize("idle", [True, False])
def test_p_axis_00455_keeps_the_spindle_turning_at_reset(idle: bool) -> None:
    program = "%P\nM03 S1200\nM30" if idle else "%P\nM03 S1200\nG01 X100 F6000\nM30"
    bench = running(program, 0.8, machine=machine(s={"stops_at_reset": False}))
    bench.give("channel", "reset")
    bench.run(1.0)
    assert bench.last("s").set_speed_rpm[-1] == 1200.0 and bench.last("channel").done
    bench.give("channel", "mdi", text="S600")  # and it still belongs to the channel
    bench.run(0.5)
    assert bench.last("s").set_speed_rpm[-1] == 600.0


def test_reset_of_an_idle_channel_does_nothing() -> None:
    bench = MachineBench(end_when_idle=False).run(0.05)
    assert bench.give("channel", "reset").accepted
    bench.run(0.05)
    assert bench.states("channel") == [C.IDLE] and not bench.last("channel").path_active


# ---------------------------------------------------------------- refusals


def busy(command: str) -> str:
    return f"P-ERR-22004 channel channel: {command} refused: a program is running (line 2); nothing was changed"


@pytest.mark.parametrize(
    ("command", "arguments"),
    [("start", {}), ("load", {"program": "b.nc", "text": "%B\nM30"}), ("mdi", {"text": "G01 X1 F100"})],
)
def test_while_a_program_runs(command: str, arguments: dict[str, str]) -> None:
    bench, undisturbed = running(LINE, 0.3), running(LINE, 0.3)
    assert bench.refused("channel", command, **arguments) == busy(command)
    for each in (bench, undisturbed):
        each.run(1.5)
    assert bench.column("x", "set_position") == undisturbed.column("x", "set_position")


def test_without_a_program() -> None:
    bench = MachineBench(end_when_idle=False).run(0.01)
    assert bench.refused("channel", "start") == (
        "P-ERR-22003 channel channel: start refused: no program is loaded; nothing was changed"
    )
    assert bench.refused("channel", "load", program="a.nc") == (
        "P-ERR-22009 channel channel: load refused: no text came with program 'a.nc'; nothing was changed"
    )
    assert bench.refused("channel", "warm_up") == (
        "P-ERR-22002 channel channel: unknown command 'warm_up'; nothing was changed. Known: acknowledge, "
        "block_skip, feed_hold, load, "
        "mdi, measuring_event, optional_stop, overlay, reset, set_clamp_position, set_override, "
        "set_zero_offset, single_block, start, teach_zero_offset"
    )
    assert bench.refused("channel", "acknowledge", id=1.5) == (
        "P-ERR-22001 channel channel: acknowledge refused: id = 1.5 is not an integer; nothing was changed"
    )


def test_a_broken_program_keeps_the_old_one() -> None:
    bench = MachineBench("%P\nG01 X3 F3000\nM30", start=False, end_when_idle=False).run(0.01)
    refused = bench.refused("channel", "load", program="bad.nc", text="%P\nG01 X1.2.3\nM30")
    assert (
        refused
        == "P-ERR-21003 bad.nc line 2 column 5 'G01 X1.2.3': 'X1.2.3' is not a letter with a number; nothing was changed"
    )
    bench.give("channel", "start")
    bench.run(1.0)
    assert bench.position("x") == 3.0


@pytest.mark.parametrize(
    ("line", "error"),
    [
        (
            "N10 G01 X300.5 F3000",
            "120002 {}: axis X: 300.5 mm lies beyond the positive soft limit 300 mm (P-AXIS-00178)",
        ),
        ("N10 G00 Y-201", "120003 {}: axis Y: -201 mm lies beyond the negative soft limit -200 mm (P-AXIS-00177)"),
        (
            "N10 M33",
            "22011 {}: M33 does not exist on this machine (P-CHAN-00041). Known: M0, M1, M2, M3, M4, M5, M6, "
            "M7, M8, M9, "
            "M17, M19, M29, M30",
        ),
        ("N10 M03 S12001", "22010 {}: spindle S: 12001 rpm is above the maximum 12000 rpm (P-AXIS-00212)"),
        ("N10 S[M04 REV12000.5]", "22010 {}: spindle S: 12000.5 rpm is above the maximum 12000 rpm (P-AXIS-00212)"),
    ],
)
def test_vetoes_come_before_anything_moves_and_show_the_line(line: str, error: str) -> None:
    bench = MachineBench(f"%P\nG01 X10 F3000\n{line}\nM30").run()
    column = {"120": 1, "220": line.index("S") + 1 if "S" in line else 5}[error[:3]]
    place = f"test.nc line 3 column {column} '{line}'"
    assert bench.refusals()[0] == f"P-ERR-{error.format(place)}; nothing was started"
    assert set(bench.column("x", "set_position")) == {0.0}


def test_an_arc_beyond_a_soft_limit_between_its_end_points() -> None:
    near = MachineBench("%P\nG00 X290\nG02 X290 Y-20 I0 J-10 F3000\nM30").run()
    assert near.refusals() == [] and max(near.column("x", "set_position")) == pytest.approx(300.0, abs=1e-3)
    far = MachineBench("%P\nG00 X290\nG02 X290 Y-40 I0 J-20 F3000\nM30").run()
    assert far.refusals()[0] == (
        "P-ERR-120002 test.nc line 3 column 1 'G02 X290 Y-40 I0 J-20 F3000': axis X: 310 mm lies beyond the "
        "positive soft "
        "limit 300 mm (P-AXIS-00178); nothing was started"
    )


@pytest.mark.parametrize(
    ("prepare", "state"),
    [
        ("- {at: 0, to: y, do: power, enabled: off}", "Disabled"),
        ("- {at: 0, to: y, do: move_absolute, target: 50, velocity: 10}", "DiscreteMotion"),
    ],
)
def test_a_start_while_an_axis_is_not_ready(prepare: str, state: str) -> None:
    bench = MachineBench(LINE, prepare, start=False, end_when_idle=False).run(0.05)
    for command, arguments in (("start", {}), ("mdi", {"text": "G01 X1 F100"})):
        assert bench.refused("channel", command, **arguments) == (
            f"P-ERR-22005 channel channel: {command} refused: axis y is in {state}, it must be in Standstill; "
            "nothing was changed"
        )
    bench.run(0.1)
    assert not bench.last("channel").path_active


def test_a_machine_whose_axis_has_no_power_refuses_the_start_at_cycle_0() -> None:
    bench = MachineBench(LINE, machine=machine(z={"powered_at_start": False})).run()
    assert bench.refusals() == [
        "P-ERR-22005 channel channel: start refused: axis z is in Disabled, it must be in Standstill; nothing "
        "was changed"
    ]


@pytest.mark.parametrize("command", ["power, on: off", "move_absolute, target: 5"])
def test_an_axis_that_gets_a_command_in_the_very_block_of_the_start(command: str) -> None:
    """The channel cannot know yet: axis and channel fault, everything stops where it is."""
    scenario = f"- {{at: 0.1, to: channel, do: start}}\n- {{at: 0.1, to: y, do: {command}}}"
    bench = MachineBench(LINE, scenario, start=False).run()
    errors = bench.errors()
    state = "Disabled" if "power" in command else "DiscreteMotion"
    assert errors[0] == (
        f"P-ERR-23009 axis y: the channel moves the path while the axis is in {state}; the axis stops on its own ramp "
        "(ErrorStop)"
    )
    assert errors[1] == (
        "P-ERR-22012 channel channel: y is in error P-ERR-23009; the path stops on its ramp and the program is aborted"
    )
    assert bench.failed and bench.position("x") < 1.0
    assert_all_smooth(bench)


def test_a_start_right_after_a_move_that_the_channel_has_not_heard_of() -> None:
    bench = MachineBench(LINE, start=False, end_when_idle=False).run(0.1)
    bench.give("y", "move_absolute", target=5.0)
    bench.run(0.01)
    bench.give("channel", "start")
    bench.run(0.5)
    assert bench.errors() == [
        "P-ERR-22005 channel channel: axis y moved or was switched off while the program was started; the path "
        "stops on "
        "its ramp and the program is aborted"
    ]
    assert bench.position("x") == 0.0 and bench.position("y") == 5.0
    bench.give("channel", "reset")
    bench.give("channel", "start")
    bench.run(2.0)
    assert bench.position("x") == 100.0


def test_ptp_commands_while_the_program_runs_are_refused() -> None:
    bench, undisturbed = running(LINE, 0.3), running(LINE, 0.3)
    for name in ("x", "z"):
        assert bench.refused(name, "move_absolute", target=1.0) == (
            f"P-ERR-23005 axis {name}: move_absolute refused: the axis is in SynchronizedMotion, it must be in "
            "Standstill; nothing was changed"
        )
        bench.refused(name, "stop")
    for each in (bench, undisturbed):
        each.run(1.5)
    assert bench.column("x", "set_position") == undisturbed.column("x", "set_position")


# ---------------------------------------------------------------- faults


def test_an_axis_fault_stops_path_and_other_axes_together() -> None:
    """x loses its enable at 0.5 s: x stops on its own ramp, y on the path's; the spindle stops; reset and continue."""
    bench = running("%P\nM03 S600\nG01 X100 Y50 F6000\nM30", 0.6)
    bench.give("x", "power", enabled=False)
    bench.run(1.5)
    assert bench.errors() == [
        "P-ERR-23010 axis x: the enable was removed during path motion; the axis stops on its own ramp (ErrorStop)",
        "P-ERR-22012 channel channel: x is in error P-ERR-23010; the path stops on its ramp and the program is aborted",
    ]
    event = next(event for event in bench.events if event.error_id == 22012)
    assert (event.cycle, event.line, event.source) == (610, 3, "channel")
    assert [bench.last(name).state[-1] for name in ("x", "y", "z")] == [S.ERROR_STOP, S.STANDSTILL, S.STANDSTILL]
    assert bench.last("channel").state[-1] == C.ERROR and bench.last("channel").error_id[-1] == 22012
    assert bench.last("channel").done and bench.last("s").set_speed_rpm[-1] == 0.0
    assert_all_smooth(bench)
    assert bench.refused("channel", "start") == (
        "P-ERR-22004 channel channel: start refused: the channel is in error P-ERR-22012; reset it first; "
        "nothing was changed"
    )
    bench.give("x", "power", enabled=True)
    bench.give("x", "reset")
    bench.give("channel", "reset")
    bench.run(0.05)
    bench.give("channel", "mdi", text="G01 X10 Y10 Z0 F3000")
    bench.run(2.0)
    assert bench.position("x") == 10.0 and bench.position("y") == 10.0


def test_reset_is_refused_on_the_error_ramp() -> None:
    bench = running(LINE, 0.5)
    bench.give("y", "upstream_lost", source="plc")
    bench.run(0.03)
    assert bench.refused("channel", "reset") == (
        "P-ERR-22008 channel channel: reset refused: the path still moves on its error ramp; wait for standstill; "
        "nothing was changed"
    )
    bench.run(0.5)
    assert bench.give("channel", "reset").accepted
    assert_all_smooth(bench)


def test_an_axis_that_is_reset_while_the_channel_ramps_down_does_not_jump_onto_the_path() -> None:
    """z is at a standstill, its fault ends immediately: its reset brings it back onto the path while x still ramps down there."""
    bench = running("%P\nG01 X100 F30000\nM30", 0.5)
    bench.give("z", "power", enabled=False)
    bench.give("z", "power", enabled=True)
    bench.give("z", "reset")
    bench.run(1.0)
    assert_all_smooth(bench)
    assert bench.last("channel").done


def test_an_axis_that_does_not_follow_stops_the_path() -> None:
    """It has given the channel up for a stall; without this check the others would cut a wrong part."""
    bench = MachineBench(LINE, "- {at: 0.1, to: channel, do: start}", start=False, end_when_idle=False).run(0.05)
    bench.give("y", "upstream_lost", source="channel")
    bench.run(1.0)
    assert bench.errors() == [
        "P-ERR-22015 channel channel: y does not follow the path, it is in Standstill; the path stops on its "
        "ramp and the "
        "program is aborted"
    ]
    assert bench.last("channel").done and 0.0 < bench.position("x") < 0.1
    assert_all_smooth(bench)


def test_a_fault_in_the_last_block_of_a_program_is_noticed() -> None:
    """The path has ended when the channel is notified; an axis that did not reach its target is an error."""
    program = "%P\nG01 X1 F6000\nM30"
    last = next(block.first_cycle for block in running(program, 1.0).blocks["channel"] if block.done)
    bench = running(program, last / 1000.0)
    bench.give("x", "upstream_lost", source="plc")
    bench.run(0.05)
    assert bench.errors()[-1] == "P-ERR-22012 channel channel: x is in error P-ERR-26101; nothing moves"


def test_a_spindle_fault_stops_the_path() -> None:
    bench = running("%P\nM03 S600\nG01 X100 F6000\nM30", 0.6)
    bench.give("s", "upstream_lost", source="plc")
    bench.run(1.0)
    assert bench.errors()[1] == (
        "P-ERR-22012 channel channel: s is in error P-ERR-26101; the path stops on its ramp and the program is aborted"
    )
    assert_all_smooth(bench)


@pytest.mark.parametrize("source", ["plc", "clock", "y", "s"])
def test_the_watchdog_of_the_channel(source: str) -> None:
    bench = running(LINE, 0.5)
    bench.give("channel", "upstream_lost", source=source)
    bench.run(0.5)
    way = "its axes stop without it" if source == "clock" else "the path stops on its ramp"
    assert bench.errors() == [
        f"P-ERR-26101 channel channel: no block of '{source}' came within the watchdog time; {way} and the program is "
        "aborted"
    ]
    assert_all_smooth(bench)
    assert bench.last("channel").done
    bench.give("channel", "upstream_lost", source=source)  # once is enough
    bench.run(0.1)
    assert len(bench.errors()) == 1
    bench.give("channel", "reset")
    if source in ("y", "s"):
        assert bench.refused("channel", "start") == (
            f"P-ERR-22005 channel channel: start refused: '{source}' no longer publishes; nothing was changed"
        )
    else:
        assert bench.give("channel", "start").accepted


LOST = "no block of 'plc' came within the watchdog time"


def test_without_a_plc_the_axes_stop_with_their_path() -> None:
    bench = running("%P\nG01 X100 Y30 F6000\nM30", 0.5)
    for unit in ("x", "y", "channel"):
        bench.give(unit, "upstream_lost", source="plc")
    bench.run(1.0)
    x, y = (bench.column(axis, "set_position") for axis in "xy")
    assert [0.3 * each for each in x] == pytest.approx(y, abs=1e-9)
    assert x[-1] > x[500] + 1.0
    errors = [text for text in bench.errors() if " axis x: " in text]
    assert errors == [
        f"P-ERR-26101 axis x: {LOST}; the axis stops with its path",
        f"P-ERR-26101 axis x: {LOST}; the axis stops on its own ramp (ErrorStop)",
    ]
    assert bench.states("x")[-1] == S.ERROR_STOP
    assert_all_smooth(bench)


def test_an_axis_that_misses_the_plc_alone_stops_on_its_own_ramp() -> None:
    bench = running("%P\nG01 X100 Y30 F6000\nM30", 0.5)
    bench.give("x", "upstream_lost", source="plc")
    bench.run(1.0)
    assert bench.errors() == [
        f"P-ERR-26101 axis x: {LOST}; the axis stops with its path",
        f"P-ERR-26101 axis x: {LOST}; the axis stops on its own ramp (ErrorStop)",
        "P-ERR-22012 channel channel: x is in error P-ERR-26101; the path stops on its ramp and the program is aborted",
    ]
    assert_all_smooth(bench)


def test_an_axis_whose_channel_is_lost_as_well_stops_on_its_own_ramp() -> None:
    bench = running("%P\nG01 X100 Y30 F6000\nM30", 0.5)
    for source in ("plc", "channel"):
        bench.give("x", "upstream_lost", source=source)
    bench.run(1.0)
    assert bench.errors()[:2] == [
        f"P-ERR-26101 axis x: {LOST}; the axis stops with its path",
        f"P-ERR-26101 axis x: {LOST.replace('plc', 'channel')}; the axis stops on its own ramp (ErrorStop)",
    ]
    assert_all_smooth(bench)


def test_a_fault_of_an_idle_channel() -> None:
    bench = MachineBench(end_when_idle=False).run(0.05)
    bench.give("channel", "upstream_lost", source="plc")
    bench.run(0.05)
    assert bench.errors() == [
        "P-ERR-26101 channel channel: no block of 'plc' came within the watchdog time; nothing moves"
    ]
    assert bench.states("channel") == [C.IDLE, C.ERROR] and bench.events[-1].line == 0
    bench.give("channel", "reset")
    bench.run(0.02)
    assert bench.states("channel") == [C.IDLE, C.ERROR, C.IDLE]


def test_a_fault_while_the_program_is_stopped_or_waits() -> None:
    for program in ("%P\nM00\nG01 X5 F3000\nM30", "%P\nG04 9\nG01 X5 F3000\nM30"):
        bench = running(program, 0.1)
        bench.give("y", "upstream_lost", source="plc")
        bench.run(0.1)
        assert bench.last("channel").state[-1] == C.ERROR and bench.last("channel").done
        assert bench.position("x") == 0.0


def test_a_motion_that_cannot_be_planned_is_a_fault_with_its_line() -> None:
    bench = MachineBench("%P\nG01 X10 F3000\nN20 G01 X20 F0.00000001\nM30").run()
    assert bench.errors() == [
        "P-ERR-23001 channel channel: motion limit velocity = 2.4999999999999996e-10 must be between 1e-09 and "
        "1e+12; the "
        "motion is refused in test.nc line 3 'N20 G01 X20 F0.00000001'; the path stops on its ramp and the program is aborted"
    ]
    assert bench.failed and bench.position("x") == 10.0 and bench.events[-1].line == 3
    assert_all_smooth(bench)


def test_a_channel_without_spindles_and_one_without_axes() -> None:
    channel = MILL.channels["channel"]
    without = replace(MILL, channels={"channel": replace(channel, spindles=(), main_spindle="")})
    bench = MachineBench("%P\nG01 X5 F3000\nM30", machine=without).run()
    assert bench.position("x") == 5.0
    nothing = replace(MILL, channels={"channel": replace(channel, axes=(), spindles=(), main_spindle="")})
    bench = MachineBench("%P\nG04 0.1\nM30", machine=nothing).run()
    assert bench.errors() == [] and bench.last("channel").set_position == []


@pytest.mark.long
def test_commands_at_random_cycles_never_step_the_axes() -> None:
    """Seeded: feed hold, override, reset, start and axis faults on a program of lines and arcs."""
    program = "%P\nG01 X30 F6000\nG03 X30 Y20 I0 J10\nG01 X0 Y0 Z5\nG02 X10 Y10 I10 J0\nG00 X0 Y0 Z0\nM30"
    for seed in range(12):
        draw = random.Random(seed)
        bench = MachineBench(program, end_when_idle=False)
        for _ in range(15):
            bench.run(draw.randrange(1, 30) * 0.01)
            unit, command, arguments = draw.choice(
                [
                    ("channel", "feed_hold", {"enabled": draw.random() < 0.3}),
                    (
                        "channel",
                        "set_override",
                        {"percent": draw.choice([0.0, 30.0, 100.0, 150.0, draw.uniform(0, 150)])},
                    ),
                    ("channel", "reset", {}),
                    ("channel", "start", {}),
                    ("channel", "start", {}),
                    ("x", "reset", {}),
                    ("y", "upstream_lost", {"source": "plc"}),
                    ("y", "reset", {}),
                    ("z", "stop", {}),
                ]
            )
            bench.give(unit, command, **arguments)
        bench.run(1.0)
        bench.give("channel", "reset")
        bench.run(1.0)
        assert bench.last("channel").done, seed
        for name in ("x", "y", "z"):
            p = MILL.axes[name]
            columns = [bench.column(name, f"set_{what}") for what in ("position", "velocity", "acceleration")]
            assert_smooth(*columns, acceleration=max(p.acceleration, p.deceleration), jerk=p.jerk * (1 + 1e-6))
