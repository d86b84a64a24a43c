"""Feed releases: motion in a direction that is not released comes to rest, waits and continues; nothing else is touched."""

from __future__ import annotations

import random
from dataclasses import replace

import numpy as np
import pytest
from error_support import refused
from long_support import long
from machine_support import MILL, MachineBench, UnitBench, assert_axis_smooth, axis_bench
from slave_support import SlaveBench, assert_linear
from superposition_support import A, J, column, external_axis, feed, generator, has_bit, moving_axis

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

WITHHELD, HAS_JOB = 1 << 17, 1 << 8
DYNAMICS = {"velocity": 2000.0, "acceleration": A, "deceleration": A, "jerk": J}


def release(bench: UnitBench, forward: bool = True, backward: bool = True) -> None:
    bench.accepted("set_feed_release", forward=forward, backward=backward)


def withhold(bench: UnitBench, sign: float) -> None:
    """The direction of this sign."""
    release(bench, forward=sign < 0.0, backward=sign > 0.0)


# positioning


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("at", [60, 250, 700, 1330])
def test_the_withheld_direction_is_like_override_0(sign: float, at: int) -> None:
    """Accelerating, at full velocity and just before the brakes: the same bits as override 0 and 100 %."""
    by_release, by_override = (moving_axis(target=sign * 2000.0, velocity=1500.0, cycles=at) for _ in range(2))
    withhold(by_release, sign)
    by_override.accepted("set_override", percent=0.0)
    for bench in (by_release, by_override):
        bench.run(1500)
    assert by_release.state == S.DISCRETE_MOTION
    assert by_release.last.status_bits[-1] & (WITHHELD | HAS_JOB) == WITHHELD | HAS_JOB
    assert by_release.last.set_velocity[-1] == 0.0 and abs(by_release.last.set_position[-1]) < 2000.0
    release(by_release)
    by_override.accepted("set_override", percent=100.0)
    for bench in (by_release, by_override):
        bench.run(3000)
    for name in ("set_position", "set_velocity", "set_acceleration", "set_jerk", "state", "actual_position"):
        assert by_release.column(name) == by_override.column(name), name
    assert by_release.last.set_position[-1] == sign * 2000.0
    assert not has_bit(by_release, WITHHELD)[-1]
    assert_axis_smooth(by_release, acceleration=A, jerk=J)


def test_each_direction_has_its_bit_at_a_standstill_and_in_motion() -> None:
    """2^20 forward, 2^21 backward (AxisState.msg), whether something waits or not."""
    bench = moving_axis(target=2000.0, velocity=1500.0, cycles=50)
    directions, waits = 3 << 20, 1 << 17
    for forward, backward, bits in (
        (True, False, 2 << 20),
        (False, True, 1 << 20 | waits),
        (False, False, 3 << 20 | waits),
    ):
        release(bench, forward, backward)
        bench.run(10)
        assert bench.last.status_bits[-1] & (directions | waits) == bits
    bench.accepted("stop")
    bench.run(2000)
    assert bench.state == S.STANDSTILL and bench.last.status_bits[-1] & (directions | waits) == directions
    release(bench)
    bench.run(1)
    assert bench.last.status_bits[-1] & directions == 0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_other_direction_is_free(sign: float) -> None:
    """Nothing changes for a motion the other way, nor for one in its brake phase."""
    free, other = moving_axis(target=sign * 1000.0, cycles=300), moving_axis(target=sign * 1000.0, cycles=300)
    withhold(other, -sign)
    for bench in (free, other):
        bench.run(500)
    withhold(other, sign)  # in the last ramp
    for bench in (free, other):
        bench.run(1000)
    columns = [
        {name: values for name, values in bench.columns().items() if name != "status_bits"} for bench in (free, other)
    ]
    assert columns[0] == columns[1]
    bits = [bit & ~(3 << 20) for bit in other.column("status_bits")]  # which direction is not released
    assert bits == free.column("status_bits")


@pytest.mark.parametrize("start", ["move_absolute", "move_relative", "move_modulo"])
def test_a_start_waits_for_its_direction(start: str) -> None:
    names = {"move_absolute": "target", "move_relative": "distance", "move_modulo": "position"}
    changes = {"modulo": True, "modulo_low": 0.0, "modulo_high": 360.0} if start == "move_modulo" else {}
    bench = axis_bench(**changes)
    release(bench, forward=False)
    bench.accepted(start, **{names[start]: 90.0}, **DYNAMICS)
    bench.run(300)
    assert not column(bench, "set_position").any() and has_bit(bench, WITHHELD).all()
    assert bench.state == S.DISCRETE_MOTION
    release(bench)
    bench.run(1000)
    assert bench.last.set_position[-1] == 90.0 and bench.state == S.STANDSTILL
    bench.accepted("move_absolute", target=50.0, **DYNAMICS)
    release(bench, forward=False)
    bench.run(1000)
    assert bench.last.set_position[-1] == 50.0


def test_a_target_behind_the_axis_waits_at_the_turning_point() -> None:
    """The stop is the same with and without the release, the return waits."""
    free, held = moving_axis(cycles=1000), moving_axis(cycles=1000)
    release(held, backward=False)
    for bench in (free, held):
        bench.accepted("new_target", target=100.0)
        bench.run(600)
    turning = int(np.argmax(column(free, "set_position")))
    assert column(held, "set_position")[:turning] == pytest.approx(column(free, "set_position")[:turning])
    assert held.last.set_velocity[-1] == 0.0 and held.state == S.DISCRETE_MOTION
    assert has_bit(held, WITHHELD)[-1] and not has_bit(free, WITHHELD).any()
    release(held)
    held.run(4000)
    assert held.last.set_position[-1] == 100.0
    assert_axis_smooth(held, acceleration=A, jerk=J)


def test_a_new_target_the_other_way_frees_the_axis() -> None:
    bench = moving_axis(target=3000.0, cycles=400)
    release(bench, forward=False)
    bench.run(1000)
    bench.accepted("new_target", target=10.0)
    bench.run(10)
    assert not has_bit(bench, WITHHELD)[-1]
    bench.run(3000)
    assert bench.last.set_position[-1] == 10.0


def test_override_and_new_velocity_while_the_axis_waits() -> None:
    """They count when it is released; override 0 keeps it waiting then."""
    bench = moving_axis(target=5000.0, cycles=400)
    release(bench, forward=False)
    bench.run(1000)
    bench.accepted("set_override", percent=50.0)
    bench.run(100)
    assert bench.last.set_velocity[-1] == 0.0
    release(bench)
    bench.run(600)
    assert bench.last.set_velocity[-1] == pytest.approx(1000.0)
    bench.accepted("set_override", percent=0.0)
    release(bench, forward=False)
    bench.run(600)
    bench.accepted("set_override", percent=100.0)
    bench.run(600)
    assert bench.last.set_velocity[-1] == 0.0 and has_bit(bench, WITHHELD)[-1]
    release(bench)
    bench.run(5000)
    assert bench.last.set_position[-1] == 5000.0
    assert_axis_smooth(bench, acceleration=A, jerk=J)


@pytest.mark.parametrize("command", ["stop", "halt", "power"])
def test_what_ends_a_motion_that_waits(command: str) -> None:
    bench = moving_axis(target=5000.0, cycles=400)
    release(bench, forward=False)
    bench.run(30)
    bench.accepted(command, **({"enabled": False} if command == "power" else {}))
    bench.run(1000)
    assert bench.state == (S.DISABLED if command == "power" else S.STANDSTILL)
    assert not has_bit(bench, WITHHELD)[-1] and not has_bit(bench, HAS_JOB)[-1]
    release(bench)
    bench.run(500)
    assert bench.last.set_velocity[-1] == 0.0


def test_a_target_that_waits_for_the_end_of_a_stop() -> None:
    bench = moving_axis(cycles=1000)
    bench.accepted("stop")
    bench.accepted("new_target", target=9000.0)
    release(bench, forward=False)
    bench.run(1500)
    assert bench.last.set_velocity[-1] == 0.0 and has_bit(bench, WITHHELD)[-1] and bench.state == S.DISCRETE_MOTION
    release(bench)
    bench.run(8000)
    assert bench.last.set_position[-1] == 9000.0


@pytest.mark.parametrize("seed", [*range(4), *long(range(4, 12))])
def test_at_random_it_never_drives_into_a_withheld_direction(seed: int) -> None:
    """After it was withheld for longer than a stop takes there is no motion in a direction; all is smooth."""
    choice = random.Random(seed)
    bench = axis_bench()
    bench.accepted("move_absolute", target=choice.uniform(500.0, 4000.0), **DYNAMICS)
    bench.run(10)
    forward, backward = [True] * 10, [True] * 10
    for _ in range(25):
        released = choice.random() < 0.6, choice.random() < 0.6
        release(bench, *released)
        if choice.random() < 0.4 and bench.state != S.STANDSTILL:
            bench.accepted("new_target", target=choice.uniform(-2000.0, 4000.0))
        if choice.random() < 0.3:
            bench.accepted("set_override", percent=choice.choice([0.0, 30.0, 100.0]))
        cycles = 10 * choice.randint(1, 90)
        bench.run(cycles)
        forward += [released[0]] * cycles
        backward += [released[1]] * cycles
    v = column(bench, "set_velocity")
    stop = 620  # cycles: also that of an axis that still accelerates
    for sign, free in ((1.0, np.array(forward)), (-1.0, np.array(backward))):
        long = np.convolve(~free, np.ones(stop), "full")[: len(free)] >= stop
        assert not (sign * v[long] > 1e-6).any()
    assert_axis_smooth(bench, acceleration=A, jerk=J)
    bench.accepted("set_override", percent=100.0)
    release(bench)
    bench.run(8000)
    assert bench.state == S.STANDSTILL and bench.last.set_velocity[-1] == 0.0


# superpositions


def test_a_compensation_stands_and_goes_on_with_its_basic_motion() -> None:
    bench = moving_axis(target=10_000.0, cycles=1000)
    values = {"length": 3000.0, "difference": 100.0, "process_velocity": 2000.0, "velocity_increase": 300.0}
    bench.accepted("compensation_start", acceleration=500.0, deceleration=1000.0, **values)
    bench.run(300)
    release(bench, forward=False)
    bench.run(1500)
    assert bench.last.set_velocity[-1] == 0.0 and bench.events == []
    release(bench)
    bench.run(8000)
    assert bench.state == S.STANDSTILL and 10_050.0 < bench.last.set_position[-1] < 10_100.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_external_setpoints_in_a_withheld_direction_are_a_fault_before_they_move_the_axis(sign: float) -> None:
    bench = external_axis("absolute")
    withhold(bench, sign)
    feed(bench, generator(sign * 300.0, first_cycle=20), 300)
    (text,) = bench.event_texts()
    where = "forward" if sign > 0.0 else "backward"
    reason = f"it is moved {where}, which is not released (set_feed_release)"
    assert text == f"P-ERR-23058 axis x: {reason}; the axis stops on its own ramp (ErrorStop)"
    assert not column(bench, "set_position").any()


def test_external_setpoints_in_motion_stop_on_the_ramp_of_the_axis() -> None:
    bench = external_axis("absolute")
    feed(bench, generator(3000.0, first_cycle=20), 1000)
    release(bench, forward=False)
    bench.run(500)
    assert bench.state == S.ERROR_STOP and bench.last.set_velocity[-1] == 0.0
    v = column(bench, "set_velocity")
    assert (np.abs(np.diff(v)[1005:]) <= A * 0.001 * (1.0 + 1e-9)).all()
    assert v.max() <= 1000.0 * (1.0 + 1e-9)


def test_external_setpoints_the_released_way_on_top_of_a_motion_that_waits() -> None:
    """The basic motion waits in its direction; what comes on top goes back."""
    bench = moving_axis(target=3000.0, cycles=400)
    bench.accepted("external_enable", mode="relative")
    release(bench, forward=False)
    bench.run(1000)
    begin = bench.last.set_position[-1]
    feed(bench, generator(-200.0, first_cycle=bench.cycle + 10), 800)
    assert bench.events == [] and bench.last.set_position[-1] == pytest.approx(begin - 200.0)
    feed(bench, generator(100.0, first_cycle=bench.cycle + 10, start=-200.0), 200)
    assert [text[:11] for text in bench.event_texts()] == ["P-ERR-23058"]
    assert bench.last.set_position[-1] == pytest.approx(begin - 200.0)


def test_external_setpoints_need_both_releases() -> None:
    bench = axis_bench()
    release(bench, backward=False)
    assert bench.refusal("external_enable", mode="relative") == refused(23028)


# masters and slaves


def test_a_master_that_waits_keeps_its_slaves_in_step() -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=-0.5)
    bench.do("x", "move_absolute", target=2000.0, **DYNAMICS)
    bench.run(0.5)
    bench.do("x", "set_feed_release", forward=False, backward=True)
    bench.run(1.0)
    assert bench.last("y").set_velocity[-1] == 0.0
    bench.do("x", "set_feed_release", forward=True, backward=True)
    bench.run(3.0)
    assert bench.last("y").set_position[-1] == -1000.0
    assert_linear(bench, "x", "y", -0.5)


@pytest.mark.parametrize("factor", [0.5, -0.5])
def test_a_slave_in_a_withheld_direction_is_a_fault_of_its_group(factor: float) -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=factor)
    bench.do("y", "set_feed_release", forward=factor < 0.0, backward=factor > 0.0)
    bench.do("x", "move_absolute", target=2000.0, **DYNAMICS)
    bench.run(2.0)
    assert [text[:11] for text in bench.errors()] == ["P-ERR-23058", "P-ERR-23056"]
    assert abs(bench.last("y").set_position[-1]) < 1e-3 and bench.last("x").set_velocity[-1] == 0.0
    assert bench.state("y") == bench.state("x") == S.ERROR_STOP


def test_a_slave_may_go_the_other_way() -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=0.5)
    bench.do("y", "set_feed_release", forward=True, backward=False)
    bench.do("x", "move_absolute", target=500.0, **DYNAMICS)
    bench.run(2.0)
    assert bench.errors() == [] and bench.last("y").set_position[-1] == 250.0


def test_an_axis_that_drives_on_without_an_end_waits_too() -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=1.0)
    bench.do("x", "move_absolute", target=9000.0, **DYNAMICS)
    bench.run(1.0)
    bench.do("y", "decouple")
    bench.do("y", "set_feed_release", forward=False, backward=True)
    bench.run(1.0)
    assert bench.last("y").set_velocity[-1] == 0.0 and bench.state("y") == S.CONTINUOUS_MOTION
    assert bench.bits("y", WITHHELD)[-1]
    bench.do("y", "set_feed_release", forward=True, backward=True)
    bench.run(1.0)
    assert bench.last("y").set_velocity[-1] == pytest.approx(2000.0)


# path

PROGRAM = "%P\nG01 X100 Y50 F6000\nG01 X0\nM30"


@pytest.mark.parametrize(("node", "forward", "backward"), [("x", False, True), ("y", False, False), ("x", True, False)])
def test_a_path_is_held_by_its_axis(node: str, forward: bool, backward: bool) -> None:
    """All its axes come to rest together, and end where an undisturbed run ends; the event names axis and line."""
    bench = MachineBench(PROGRAM, machine=MILL, end_when_idle=False).run(0.5)
    bench.give(node, "set_feed_release", forward=forward, backward=backward)
    bench.run(3.0)
    line = 2 if not forward else 3
    assert [event.text for event in bench.events if event.severity] == [
        f"channel channel: the path stops in line {line} and waits for the feed release of axis {node}"
    ]
    assert [event.error_id for event in bench.events] == [22026]
    assert bench.last("channel").state[-1] == C.HOLD
    assert all(bench.last(axis).set_velocity[-1] == 0.0 for axis in ("x", "y"))
    assert bench.last(node).status_bits[-1] & WITHHELD
    bench.give(node, "set_feed_release", forward=True, backward=True)
    bench.run(6.0)
    assert bench.last("channel").done and bench.position("x") == 0.0 and bench.position("y") == 50.0
    assert not bench.last(node).status_bits[-1] & WITHHELD
    for axis in ("x", "y"):
        assert_axis_smooth(bench.blocks[axis], acceleration=5000.0, jerk=1e5)


def test_a_path_that_starts_in_a_withheld_direction_stops_after_one_block() -> None:
    """It accelerates for the 10 ms of a block and comes to rest with the same jerk J: 2·J·t³."""
    scenario = "- {at: 0, to: x, do: set_feed_release, forward: off, backward: on}"
    bench = MachineBench(PROGRAM, scenario, end_when_idle=False).run(2.0)
    assert bench.last("channel").state[-1] == C.HOLD and 0.0 < bench.position("x") <= 2.0 * 1e5 * 0.01**3
    bench.give("channel", "reset")
    bench.run(0.5)
    assert bench.last("x").state[-1] == S.STANDSTILL and not bench.last("x").status_bits[-1] & WITHHELD


def brakes_for_the_end(bench: MachineBench) -> None:
    """On to where the first element of the path brakes for its end, at most 2 mm before it."""
    while not 0.0 < bench.last("channel").distance_to_go[-1] < 2.0:
        bench.run(0.01)


@pytest.mark.parametrize("block_cycles", [10, *long([1])])
@pytest.mark.parametrize("node", ["x", *long(["y"])])
@pytest.mark.parametrize(
    "way_on",
    ["G01 X100 Y20", "G02 X80 Y50 I-10 J0", *long(["G01 X0", "M07\nG01 X0", "G04 X0.1\nG01 X0"])],
)
def test_an_element_that_brakes_for_its_end_leaves_the_next_one_to_its_direction(
    way_on: str, node: str, block_cycles: int
) -> None:
    """Both axes have gone forward to X100 Y50; what continues backward, or is at a standstill, is not affected."""
    program = f"%P\nG01 X100 Y50 F6000\n{way_on}\nM30"
    mill = replace(MILL, block_cycles=block_cycles)
    free, other = (MachineBench(program, machine=mill, end_when_idle=False).run(0.3) for _ in range(2))
    for bench in (free, other):
        brakes_for_the_end(bench)
    moved_forward = node == "y" and "G02" in way_on
    other.give(node, "set_feed_release", forward=False, backward=True)
    for bench in (free, other):
        bench.run(3.0)
    if moved_forward:
        assert [event.text for event in other.events] == [
            "channel channel: the path stops in line 3 and waits for the feed release of axis y"
        ]
        return
    assert other.events == [] and other.last("channel").done
    for unit, name in (("x", "set_position"), ("y", "set_position"), ("channel", "line"), ("channel", "state")):
        assert other.column(unit, name) == free.column(unit, name), (unit, name)
    assert not other.last(node).status_bits[-1] & WITHHELD


def test_the_next_element_in_the_withheld_direction_is_held_in_its_own_line() -> None:
    """It has moved for a block at most before it brakes (2·J·t³), and continues after the release."""
    program = "%P\nG01 X100 Y50 F6000\nG01 X200\nG01 X0\nM30"
    bench = MachineBench(program, end_when_idle=False).run(0.3)
    brakes_for_the_end(bench)
    bench.give("x", "set_feed_release", forward=False, backward=True)
    bench.run(2.0)
    texts = ["channel channel: the path stops in line 3 and waits for the feed release of axis x"]
    assert [event.text for event in bench.events] == texts and bench.last("channel").state[-1] == C.HOLD
    assert 100.0 < bench.position("x") <= 100.0 + 2.0 * 1e5 * 0.011**3 and bench.last("x").status_bits[-1] & WITHHELD
    bench.give("x", "set_feed_release", forward=True, backward=True)
    bench.run(6.0)
    assert bench.last("channel").done and bench.position("x") == 0.0 and len(bench.events) == 1
    assert_axis_smooth(bench.blocks["x"], acceleration=5000.0, jerk=1e5)


@pytest.mark.parametrize("late", [20, *long([60])])
def test_a_circle_whose_axis_turns_round_while_it_brakes_goes_on(late: int) -> None:
    """x goes backward to X-20, and forward from there: withheld shortly before, the path stops behind the turning."""
    program = "%P\nG01 X20 Y0 F6000\nG02 X20 Y0 I-20 J0 F6000\nM30"
    free, other = (MachineBench(program, machine=MILL, end_when_idle=False) for _ in range(2))
    free.run(4.0)
    turning = int(np.argmin(free.column("x", "set_position")))
    other.run((turning // 10 - late // 10) * 0.01)
    other.give("x", "set_feed_release", forward=True, backward=False)
    other.run(4.0)
    assert [event.error_id for event in other.events] == [22026]
    assert other.last("channel").done and other.position("x") == free.position("x") == 20.0
    for axis in ("x", "y"):
        assert_axis_smooth(other.blocks[axis], acceleration=5000.0, jerk=1e5)


def test_a_path_that_waits_turns_where_a_new_direction_is_free() -> None:
    """After a reset the next program returns immediately."""
    bench = MachineBench(PROGRAM, machine=MILL, end_when_idle=False).run(0.5)
    bench.give("x", "set_feed_release", forward=False, backward=True)
    bench.run(1.0)
    bench.give("channel", "reset")
    bench.run(0.5)
    begin = bench.position("x")
    assert begin > 1.0
    assert bench.give("channel", "mdi", text="G01 X0 F6000").accepted
    bench.run(2.0)
    assert bench.position("x") == 0.0 and bench.last("channel").done and len(bench.events) == 1


# the run


def test_a_run_ends_with_an_axis_that_waits() -> None:
    scenario = "- {at: 0, to: x, do: set_feed_release, forward: off, backward: on}\n"
    bench = MachineBench(scenario=scenario + "- {at: 0.1, to: x, do: move_absolute, target: 10}").run()
    assert bench.position("x") == 0.0 and not bench.failed


def test_a_power_cycle_and_a_reset_release_nothing() -> None:
    bench = axis_bench()
    release(bench, forward=False)
    for enabled in (False, True):
        bench.accepted("power", enabled=enabled)
    bench.accepted("reset")
    bench.accepted("move_absolute", target=10.0)
    bench.run(500)
    assert not column(bench, "set_position").any()
