"""A flying saw on top of the path of a channel: machining on a moving workpiece (TX1250 2.6)."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest
from long_support import long, long_sets
from path_superposition_support import PathBench, assert_no_jump, mill, profile
from replay_support import bits, replay

from cnc_ptp.protocol.axis_states import AxisStateCode as S

ACCELERATION = 4800.0
"""mm/s²: at most 2400 each of the path and of what is added."""
PROTECTED = 1 << 5


def conveyor(velocity: float = 8.0, **units: Any) -> PathBench:
    """1 s after the start of path and conveyor z; the program dwells."""
    bench = PathBench(**units)
    bench.accepted("z", "jog", velocity=velocity)
    return bench.run(0.99)


def saw(bench: PathBench, factor: float = 1.0, *, ahead: float = 5.0, slave_position: float = 3.0) -> float:
    """x is to be synchronous when z is `ahead` further in its direction; where z is then."""
    velocity = bench.last("z").set_velocity[-1]
    at = bench.position("z") + np.copysign(ahead, velocity)
    values = {"master_position": at, "slave_position": float(np.copysign(slave_position, factor * velocity))}
    bench.accepted("x", "couple_flying_saw", master="z", factor=factor, **values)
    return float(at)


def on_workpiece(**units: Any) -> PathBench:
    """Synchronous from about 0.6 s on; the circle begins at 2.5 s."""
    bench = conveyor(**units)
    saw(bench)
    return bench.run(2.0)


@pytest.mark.parametrize(("velocity", "factor"), [(9.0, -0.5), *long_sets([(-6.5, 1.0), (8.0, 1.0), (12.0, 1.75)])])
def test_a_circle_on_a_moving_workpiece(velocity: float, factor: float) -> None:
    """Seen from the workpiece, factor · z + offset, the tool runs the circle of 20 mm."""
    bench, alone = conveyor(velocity), PathBench().run(1.0)
    at = saw(bench, factor, ahead=8.0)
    bench.run(5.5), alone.run(5.51)
    assert bench.errors() == []
    z = bench.array("z", "set_position")
    workpiece = np.copysign(3.0, factor * velocity) + factor * (z - at)
    x, y = bench.array("x", "set_position") - workpiece, bench.array("y", "set_position")
    circling = bench.array("channel", "line") == 4
    assert np.count_nonzero(circling) > 2500
    assert np.abs(np.hypot(x, y)[circling] - 20.0).max() <= 1e-9
    assert np.abs(x - alone.array("x", "set_position"))[circling].max() <= 1e-9
    assert bench.column("y", "set_position") == alone.column("y", "set_position")
    assert bench.array("x", "set_position")[:1000].tolist() == alone.column("x", "set_position")[:1000]
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_the_conveyor_may_change_its_speed_under_the_tool() -> None:
    bench = conveyor()
    at = saw(bench)
    bench.run(2.0)
    bench.accepted("z", "set_override", percent=30.0)
    bench.run(0.7)
    bench.accepted("z", "set_override", percent=100.0)
    bench.run(2.0)
    circling = bench.array("channel", "line") == 4
    relative = bench.array("x", "set_position") - 3.0 - (bench.array("z", "set_position") - at)
    assert np.abs(np.hypot(relative, bench.array("y", "set_position"))[circling] - 20.0).max() <= 1e-9
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_states_and_bits() -> None:
    """The path keeps the axis; when it ends, the axis is an ordinary slave until it is decoupled."""
    bench = on_workpiece()
    assert bench.last("x").master == "z" and bench.last("x").status_bits[-1] & PROTECTED
    bench.run(4.5)
    assert bench.states("x") == [S.SYNCHRONIZED_MOTION] and bench.last("channel").done
    assert not bench.last("channel").path_active
    assert bench.last("x").set_velocity[-1] == 8.0 and bench.last("x").master == "z"
    assert bench.refused("channel", "start") == (
        "P-ERR-22005 channel channel: start refused: axis x is in SynchronizedMotion, it must be in Standstill; "
        "nothing was changed"
    )
    bench.accepted("x", "decouple")
    bench.accepted("x", "stop")
    bench.run(0.5)
    assert bench.errors() == [] and bench.last("x").state[-1] == S.STANDSTILL
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_the_path_ends_while_the_saw_still_waits() -> None:
    """The slave runs up later, to its place beside the end of the path."""
    bench = PathBench("%P\nG01 X20 F6000\nM30")
    bench.accepted("z", "jog", velocity=8.0)
    bench.run(0.1)
    at = saw(bench, ahead=16.0)
    bench.run(4.0)
    assert bench.errors() == [] and bench.position("x") == pytest.approx(23.0 + bench.position("z") - at, abs=1e-9)
    assert_no_jump(bench, acceleration=ACCELERATION)


@pytest.mark.parametrize("milliseconds", [450, *long([2500, 300, 1000])])
def test_decoupling_brakes_the_contribution_alone(milliseconds: int) -> None:
    """Before, in and after the run-up; the path continues next to its place."""
    bench = conveyor()
    saw(bench)
    bench.run(milliseconds / 1000.0)
    bench.accepted("x", "decouple")
    bench.run(0.3)
    assert bench.last("x").state[-1] == S.SYNCHRONIZED_MOTION and bench.last("x").master == ""
    left = bench.added()[-1]
    bench.run(1.0)
    assert bench.added()[-1] == pytest.approx(left, abs=1e-12)
    bench.run(4.0)
    assert bench.errors() == [] and bench.states("x") == [S.SYNCHRONIZED_MOTION, S.STANDSTILL]
    assert bench.position("x") == pytest.approx(left, abs=1e-9)
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_once_more_from_where_the_first_one_has_left_it() -> None:
    bench = conveyor()
    saw(bench)
    bench.run(0.8)
    bench.accepted("x", "decouple")
    bench.run(0.2)
    left = bench.added()[-1]
    at = saw(bench, -1.0)
    bench.run(1.5)
    z = bench.position("z")
    assert bench.added()[-1] == pytest.approx(left - 3.0 - (z - at), abs=1e-9)
    assert bench.errors() == []
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_decoupled_and_external_setpoints_after_it() -> None:
    """Not both at once: each other's refusals."""
    bench = conveyor()
    saw(bench)
    assert bench.refused("x", "external_enable", mode="relative") == (
        "P-ERR-23030 axis x: external_enable refused: z is the master of the axis; nothing was changed"
    )
    bench.run(1.0)
    bench.accepted("x", "decouple")
    bench.accepted("x", "external_enable", mode="relative")
    record = bench.send("x", "couple_flying_saw", master="z", factor=1.0, master_position=50.0, slave_position=3.0)
    assert (record.error_id, record.message) == (
        23044,
        "axis x: couple_flying_saw refused: the axis is in SynchronizedMotion, it must be in Standstill; "
        "nothing was changed",
    )
    bench.run(5.0)
    assert bench.errors() == [] and bench.last("x").state[-1] == S.CONTINUOUS_MOTION


REFUSED = {
    "couple": ({"master": "z", "factor": 1.0}, "23044", "the axis is in SynchronizedMotion, it must be in Standstill"),
    "decouple": ({"target": 12.5}, "23054", "target = 12.5 is not permitted on the path of a channel; leave it out"),
    "stop": ({}, "23040", "the axis is a slave of z; stop z or decouple the axis"),
    "compensation_start": (
        {"length": 10.0, "difference": 1.0, "process_velocity": 10.0, "velocity_increase": 5.0},
        "23021",
        "no basic motion is active (the axis is in SynchronizedMotion)",
    ),
}


@pytest.mark.parametrize("command", REFUSED)
def test_refusals(command: str) -> None:
    bench = on_workpiece()
    arguments, number, reason = REFUSED[command]
    record = bench.send("x", command, **arguments)
    assert f"{record.error_id} {record.message}" == (
        f"{number} axis x: {command} refused: {reason}; nothing was changed"
    )
    bench.run(1.0)
    assert bench.errors() == [] and bench.last("x").master == "z"


def test_a_velocity_beside_the_path() -> None:
    bench = on_workpiece()
    text = "velocity = 4 is not permitted on the path of a channel; leave it out"
    assert bench.refused("x", "decouple", velocity=4.0) == (
        f"P-ERR-23054 axis x: decouple refused: {text}; nothing was changed"
    )


OWN_RAMP = "; the axis stops on its own ramp (ErrorStop)"
PATH_STOPS = "; the path stops on its ramp and the program is aborted"


def test_a_saw_that_comes_too_late_is_a_fault() -> None:
    """The path counts on the moving workpiece, so it does not continue without it."""
    bench = conveyor()
    saw(bench, ahead=0.1)
    bench.run(0.5)
    reason = bench.errors()[0].split("in addition to the path: ")[1]
    assert bench.errors() == [
        f"P-ERR-23051 axis x: cannot follow z in addition to the path: {reason}",
        f"P-ERR-22012 channel channel: x is in error P-ERR-23051{PATH_STOPS}",
        "P-ERR-23056 axis z: axis x of its group has error 23051" + OWN_RAMP,
    ]
    assert reason == f"the run-up takes 0.387649 s, the master is there in 0.0115 s{OWN_RAMP}"
    assert bench.last("x").set_velocity[-1] == bench.last("z").set_velocity[-1] == 0.0


def test_a_fault_of_the_master_stops_slave_and_path() -> None:
    bench = on_workpiece()
    assert bench.give("z", "upstream_lost", source="plc").accepted
    bench.run(0.5)
    assert [event.error_id for event in bench.events if event.severity == 2] == [26101, 23056, 22012]
    assert bench.last("x").set_velocity[-1] == bench.last("y").set_velocity[-1] == 0.0
    assert bench.last("x").state[-1] == S.ERROR_STOP
    assert_no_jump(bench, acceleration=ACCELERATION)


@pytest.mark.parametrize("source", ["channel", "z"])
def test_the_loss_of_channel_or_master(source: str) -> None:
    bench = on_workpiece()
    assert bench.give("x", "upstream_lost", source=source).accepted
    bench.run(0.5)
    text = f"no block of '{source}' came within the watchdog time"
    assert bench.errors()[0] == f"P-ERR-26101 axis x: {text}{OWN_RAMP}"
    assert bench.last("x").set_velocity[-1] == 0.0
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_the_sum_beyond_a_soft_limit() -> None:
    bench = on_workpiece(x={"soft_limit_positive": 30.0})
    bench.run(3.0)
    assert bench.errors()[0].startswith("P-ERR-120002 axis x: set position 30.0")
    assert bench.last("x").set_velocity[-1] == 0.0 and bench.position("x") < 32.0
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_a_withheld_direction_of_the_workpiece_is_a_fault() -> None:
    """As soon as the sum goes that way, in the second half of the circle."""
    bench = on_workpiece()
    assert bench.give("x", "set_feed_release", forward=False, backward=True).accepted
    bench.run(2.0)
    text = "it is moved forward, which is not released (set_feed_release)"
    assert bench.errors()[0] == f"P-ERR-23058 axis x: {text}{OWN_RAMP}"
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_feed_hold_and_reset_of_the_channel_leave_the_tool_on_the_workpiece() -> None:
    bench = on_workpiece()
    bench.accepted("channel", "feed_hold", enabled=True)
    bench.run(0.5)
    assert bench.last("x").set_velocity[-1] == 8.0 and bench.last("y").set_velocity[-1] == 0.0
    bench.accepted("channel", "feed_hold", enabled=False)
    bench.run(0.3)
    bench.accepted("channel", "reset")
    bench.run(0.5)
    assert bench.last("x").set_velocity[-1] == 8.0 and bench.last("y").state[-1] == S.STANDSTILL
    assert bench.give("plc", "stop_all").accepted
    bench.run(0.5)
    assert bench.last("x").set_velocity[-1] == 0.0 and bench.errors() == []
    assert_no_jump(bench, acceleration=ACCELERATION)


def things(bench: PathBench, choice: random.Random) -> None:
    deed = choice.randrange(8)
    if deed == 0:
        bench.send("channel", "feed_hold", enabled=choice.random() < 0.4)
    elif deed == 1:
        bench.send("channel", choice.choice(["start", "start", "start", "reset"]))
    elif deed == 2:
        bench.send("z", "jog", velocity=choice.choice([8.0, -5.0]))
    elif deed == 3:
        bench.send("z", "set_override", percent=choice.choice([40.0, 100.0]))
    elif deed == 4:
        bench.send("x", choice.choice(["decouple", "decouple", "reset", "stop"]))
    elif bench.last("z").set_velocity[-1]:
        ahead = choice.choice([-1, 1, 1, 1, 1]) * choice.uniform(0.5, 6.0)
        values = {"master_position": bench.position("z") + np.copysign(ahead, bench.last("z").set_velocity[-1])}
        factor = choice.choice([1.0, -0.5])
        values["slave_position"] = float(np.copysign(choice.uniform(0.2, 3.0), ahead * factor))
        bench.send("x", "couple_flying_saw", master="z", factor=factor, **values)


@pytest.mark.parametrize("seed", [0, *long([1, 2, *range(3, 8)])])
def test_at_random_nothing_jumps_and_all_ends(seed: int) -> None:
    choice, bench = random.Random(seed), conveyor()
    for _ in range(40):
        things(bench, choice)
        bench.run(0.01 * choice.randrange(1, 30))
        if bench.last("z").error_id[-1]:
            break
    assert bench.give("plc", "stop_all").accepted
    bench.run(1.0)
    assert all(bench.last(axis).set_velocity[-1] == 0.0 for axis in ("x", "y", "z"))
    assert_no_jump(bench, acceleration=ACCELERATION)
    assert_no_jump(bench, "y", acceleration=2200.0)


@pytest.mark.long
def test_the_recorded_commands_reproduce_the_run() -> None:
    bench = on_workpiece()
    bench.run(1.0)
    bench.accepted("x", "decouple")
    bench.run(4.0)
    units, again = bits(bench), replay(mill(), bench.records, len(bench.blocks["x"]))
    assert [again[unit] for unit in ("channel", "x", "y", "z")] == [units[unit] for unit in ("channel", "x", "y", "z")]


def test_a_saw_beside_what_external_setpoints_have_left() -> None:
    """And the end of the path below both: the slave keeps the offset, and so does the next program."""
    bench = conveyor()
    bench.accepted("x", "external_enable", mode="relative")
    profile(bench, -4.0, 20.0)
    bench.run(0.4)
    bench.accepted("x", "external_disable")
    at = saw(bench, ahead=6.0)
    bench.run(5.0)
    assert not bench.last("channel").path_active and bench.last("x").master == "z"
    assert bench.position("x") == pytest.approx(-4.0 + 3.0 + bench.position("z") - at, abs=1e-9)
    bench.accepted("z", "stop")
    bench.run(0.3)
    bench.accepted("x", "decouple")
    bench.run(0.02)
    bench.accepted("channel", "start")
    bench.run(6.0)
    assert bench.errors() == [] and bench.position("x") == pytest.approx(0.0, abs=1e-9)
    assert_no_jump(bench, acceleration=ACCELERATION)
