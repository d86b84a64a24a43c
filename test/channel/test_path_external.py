"""External setpoints on top of the path of a channel: both move the axis, each ends separately (TX1250 2.6)."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest
from long_support import long, long_sets
from machine_support import MachineBench
from path_superposition_support import PathBench, assert_no_jump, expected, mill, profile
from replay_support import bits, replay
from superposition_support import generator

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

ACCELERATION = 4800.0
"""mm/s²: at most 2400 each of the path and of what is added."""
EXTERNAL = 1 << 14


def on_path(way: float = 60.0, velocity: float = 15.0, *, program: str | None = None, **units: Any) -> PathBench:
    """0.5 s after the start external setpoints are enabled; they begin 10 cycles later."""
    bench = PathBench(**({} if program is None else {"program": program}), **units)
    bench.run(0.5)
    bench.accepted("x", "external_enable", mode="relative")
    profile(bench, way, velocity)
    return bench


# the sum


@pytest.mark.parametrize(("way", "velocity"), [(-45.0, 9.0), *long_sets([(60.0, 15.0), (120.0, 31.25)])])
def test_a_circle_on_a_moving_workpiece(way: float, velocity: float) -> None:
    """Seen from the workpiece, which the external setpoints move, the tool runs the circle of 20 mm."""
    bench, alone = PathBench().run(0.5), PathBench().run(0.51)
    bench.accepted("x", "external_enable", mode="relative")
    rows = profile(bench, way, velocity)
    bench.run(7.0), alone.run(7.0)
    assert bench.errors() == []
    workpiece = expected(rows, bench.cycle)
    x, y = bench.array("x", "set_position") - workpiece, bench.array("y", "set_position")
    circling = bench.array("channel", "line") == 4
    assert np.count_nonzero(circling) > 2500
    assert np.abs(np.hypot(x, y)[circling] - 20.0).max() <= 1e-9
    assert np.ptp(y[circling]) == pytest.approx(40.0, abs=1e-3) and np.ptp(x[circling]) == pytest.approx(40.0, abs=1e-3)
    assert np.abs(x - alone.array("x", "set_position")).max() <= 1e-9
    assert bench.column("y", "set_position") == alone.column("y", "set_position")
    assert np.abs(np.diff(workpiece[circling])).max() == pytest.approx(velocity * 0.001, rel=1e-9)
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_states_and_bits() -> None:
    """The path keeps the axis; when it ends, the external setpoints have it for themselves."""
    bench = on_path(way=200.0, velocity=20.0)
    bench.run(7.0)
    assert bench.states("x") == [S.SYNCHRONIZED_MOTION, S.CONTINUOUS_MOTION]
    assert bench.states("channel") == [C.RUNNING, C.WAITING, C.RUNNING, C.READY]
    assert bench.last("x").status_bits[-1] & EXTERNAL and bench.last("x").set_velocity[-1] == 20.0
    bench.accepted("x", "external_disable")
    bench.run(0.5)
    assert bench.states("x") == [S.SYNCHRONIZED_MOTION, S.CONTINUOUS_MOTION, S.STOPPING, S.STANDSTILL]
    assert_no_jump(bench, acceleration=ACCELERATION)


@pytest.mark.parametrize("milliseconds", [2500, *long([800, 3300])])
def test_disable_brakes_the_contribution_alone(milliseconds: int) -> None:
    """On the ramp of the axis, without the path: 15² / (2·2000) + v·A/(2·J), and what is left stays."""
    bench = on_path()
    bench.run(milliseconds / 1000.0)
    begin = bench.cycle
    bench.accepted("x", "external_disable")
    bench.run(4.0)
    added = bench.added()
    ramp = 15.0 * np.sqrt(15.0 / 50_000.0)
    last = added[begin]
    assert added[begin + 1000] - last == pytest.approx(ramp, abs=1e-9)
    assert np.ptp(added[begin + 1000 :][bench.array("x", "state")[begin + 1000 :] == S.SYNCHRONIZED_MOTION]) <= 1e-12
    assert bench.errors() == [] and bench.column("x", "state")[begin + 500] == S.SYNCHRONIZED_MOTION
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_feed_hold_and_override_act_on_the_path_only() -> None:
    bench = on_path()
    bench.run(2.2)
    assert bench.give("channel", "feed_hold", enabled=True).accepted
    bench.run(0.5)
    assert bench.last("channel").state[-1] == C.HOLD and bench.last("x").set_velocity[-1] == 15.0
    assert bench.give("channel", "feed_hold", enabled=False).accepted
    assert bench.give("channel", "set_override", percent=0.0).accepted
    assert bench.give("x", "set_override", percent=0.0).accepted
    bench.run(0.3)
    assert bench.last("x").set_velocity[-1] == 15.0
    assert bench.give("channel", "set_override", percent=100.0).accepted
    bench.run(5.0)
    assert bench.added()[-1] == 0.0  # the channel has taken over where the axis is
    assert bench.position("x") == pytest.approx(60.0, abs=1e-9)
    assert_no_jump(bench, acceleration=ACCELERATION)


# the channel and what is left


def test_the_next_program_begins_where_the_axis_is() -> None:
    bench = on_path(way=37.5)
    bench.run(3.5)
    bench.accepted("x", "external_disable")
    while not bench.last("channel").done:
        bench.run(0.01)
    assert bench.position("x") == pytest.approx(37.5, abs=1e-9)
    assert bench.send("channel", "start").accepted
    bench.run(6.0)
    assert bench.errors() == [] and bench.position("x") == pytest.approx(0.0, abs=1e-9)
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_a_program_is_done_when_the_channel_knows_where_its_axes_are() -> None:
    """The block in which it lets them go, and the one in which it reads them."""
    bench = on_path(way=37.5)
    bench.run(7.0)
    done = [block.done for block in bench.blocks["channel"]]
    active = [block.path_active for block in bench.blocks["channel"]]
    assert done.index(True) == active.index(False) + 1
    alone = PathBench().run(7.0)
    assert [b.done for b in alone.blocks["channel"]].index(True) == active.index(False) - 1


NOT_AT_END = "axis x was moved away from the end of the previous path"


def test_a_start_before_that_is_refused() -> None:
    bench = on_path(way=37.5)
    bench.run(3.5)
    bench.accepted("x", "external_disable")
    while bench.last("channel").path_active:
        bench.run(0.01)
    assert bench.refused("channel", "start") == (
        f"P-ERR-22004 channel channel: start refused: {NOT_AT_END}; try again when the program is finished; "
        "nothing was changed"
    )
    bench.run(0.02)
    assert bench.give("channel", "start").accepted


def test_a_start_in_the_very_block_in_which_the_axis_leaves_the_path() -> None:
    """Neither channel nor PLC can know it before."""
    length = PathBench().run(7.0)
    last = [block.path_active for block in length.blocks["channel"]].index(False) - 1
    bench = PathBench().run(last / 100.0)
    assert bench.give("x", "external_enable", mode="relative").accepted
    assert bench.give("x", "external_setpoints", setpoints=[[bench.cycle + 5, 0.1, 20.0, 0.0, 1]]).accepted
    bench.run(0.01)
    assert bench.give("channel", "start").accepted
    bench.run(0.1)
    assert bench.errors() == [
        f"P-ERR-22005 channel channel: {NOT_AT_END}; the path stops on its ramp and the program is aborted"
    ]
    assert bench.last("channel").path_active is False


def test_a_start_while_external_setpoints_are_enabled_is_refused() -> None:
    """The manual: the opposite case is not permitted."""
    bench = on_path()
    bench.run(7.0)
    assert bench.refused("channel", "start") == (
        "P-ERR-22005 channel channel: start refused: axis x is in ContinuousMotion, it must be in Standstill; "
        "nothing was changed"
    )


def test_blocks_go_on_beside_the_offset_without_a_jump() -> None:
    """Enabled and disabled in a program of straight lines, twice: the offsets add up."""
    program = "%P\n" + "\n".join(f"G01 X{(n % 2) * 10} Y{n} F3000" for n in range(1, 41)) + "\nM30"
    bench = PathBench(program).run(0.5)
    for way in (3.0, -1.25):
        bench.accepted("x", "external_enable", mode="relative")
        profile(bench, way, 5.0)
        bench.run(1.0)
        bench.accepted("x", "external_disable")
        bench.run(0.2)
    assert bench.added()[-1] == pytest.approx(1.75, abs=1e-9)
    bench.run(8.0)
    assert bench.errors() == [] and bench.position("x") == pytest.approx(1.75, abs=1e-9)
    assert bench.last("channel").set_position[0] == bench.position("x")
    assert_no_jump(bench, acceleration=ACCELERATION)


# what ends it


@pytest.mark.parametrize("milliseconds", [2300, *long([600, 3900])])
def test_a_reset_of_the_channel_leaves_the_external_setpoints(milliseconds: int) -> None:
    """They continue as they do without a path, to their own end."""
    bench = on_path(way=90.0)
    bench.run(milliseconds / 1000.0)
    assert bench.give("channel", "reset").accepted
    bench.run(7.0)
    assert bench.states("x") == [S.SYNCHRONIZED_MOTION, S.CONTINUOUS_MOTION]
    index = bench.column("x", "state").index(S.CONTINUOUS_MOTION)
    left = bench.last("channel").set_position[0]
    assert bench.position("x") == left and bench.last("x").set_velocity[-1] == 0.0
    assert bench.array("x", "set_velocity")[index + 20 : index + 400] == pytest.approx(15.0, abs=1e-9)
    assert bench.errors() == []
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_a_reset_of_the_axis_disables_them() -> None:
    bench = on_path()
    bench.run(2.5)
    bench.accepted("x", "reset")
    bench.run(0.2)
    assert bench.last("x").state[-1] == S.SYNCHRONIZED_MOTION and not bench.last("x").status_bits[-1] & EXTERNAL
    bench.run(5.0)
    assert bench.errors() == [] and bench.states("x") == [S.SYNCHRONIZED_MOTION, S.STANDSTILL]
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_stop_all_stops_both() -> None:
    bench = on_path()
    bench.run(2.5)
    assert bench.give("plc", "stop_all").accepted
    bench.run(0.5)
    assert bench.errors() == []
    assert bench.last("x").state[-1] == S.STANDSTILL and bench.last("x").set_velocity[-1] == 0.0
    assert_no_jump(bench, acceleration=ACCELERATION)


OWN_RAMP = "; the axis stops on its own ramp (ErrorStop)"
PATH_STOPS = "; the path stops on its ramp and the program is aborted"


def assert_stops(bench: PathBench, text: str, error: int, *, acceleration: float = ACCELERATION) -> None:
    bench.run(1.0)
    assert bench.errors() == [
        f"P-ERR-{error} axis x: {text}{OWN_RAMP}",
        f"P-ERR-22012 channel channel: x is in error P-ERR-{error}{PATH_STOPS}",
    ]
    assert bench.last("x").set_velocity[-1] == 0.0 and bench.last("y").state[-1] == S.STANDSTILL
    assert_no_jump(bench, acceleration=acceleration)


@pytest.mark.parametrize("cycle", [3100, 3105, 3109, *long((3101, 3102, 3103, 3104, 3106, 3107, 3108))])
def test_silence(cycle: int) -> None:
    """Wherever in a block it is found, and while both parts move."""
    bench = PathBench().run(2.9)
    bench.accepted("x", "external_enable", mode="relative")
    first = cycle - 120
    rows = [[first + n, 0.5 * 400.0 * (n * 0.001) ** 2, 0.4 * n, 400.0, 1] for n in range(41)]
    assert bench.give("x", "external_setpoints", setpoints=rows).accepted
    bench.run(0.5)
    assert bench.column("x", "error_id").index(23034) == first + 40 + 201
    assert_stops(bench, "no external setpoint for 200 ms while the axis moves", 23034)


@pytest.mark.parametrize("cycle", [3100, 3109, *long([3103, 3106])])
def test_a_jump(cycle: int) -> None:
    bench = PathBench().run(2.9)
    bench.accepted("x", "external_enable", mode="relative")
    assert bench.give("x", "external_setpoints", setpoints=[[cycle, 3.0, 0.0, 0.0, 1]]).accepted
    bench.run(0.5)
    text = "external setpoint 3.0 mm is 3 mm away, more than the axis can move in a cycle at 500.0 mm/s (P-AXIS-00212)"
    assert_stops(bench, text, 23033)


def test_the_sum_beyond_a_soft_limit() -> None:
    """The path alone stays within 20 mm."""
    bench = on_path(x={"soft_limit_positive": 25.0})
    bench.run(4.0)
    x = bench.array("x", "set_position")
    beyond = int(np.flatnonzero(x > 25.0)[0])
    text = f"set position {float(x[beyond])} mm is beyond the positive soft limit 25.0 mm (P-AXIS-00178)"
    assert_stops(bench, text, 120002)
    velocity = bench.column("x", "set_velocity")[beyond]
    assert x.max() - x[beyond] == pytest.approx(velocity * np.sqrt(velocity / 50_000.0), abs=1e-6)


def test_the_sum_above_the_largest_velocity() -> None:
    """50 mm/s of the circle and 20 mm/s are above 65 mm/s: the ramp begins before."""
    bench = on_path(way=200.0, velocity=20.0, x={"max_velocity": 65.0, "rapid_velocity": 65.0})
    bench.run(6.0)
    assert np.abs(bench.array("x", "set_velocity")).max() <= 65.0 * (1.0 + 1e-9)
    event = next(event for event in bench.events if event.severity == 2)
    speed = event.text.split("up to ")[1].split(" mm/s")[0]
    assert 65.0 < float(speed) < 66.0 or speed == "65"
    limit = f"the superimposed motions would add up to {speed} mm/s, above the maximum 65.0 mm/s (P-AXIS-00212)"
    assert_stops(bench, limit, 23036)


def test_the_enable_is_removed() -> None:
    bench = on_path()
    bench.run(2.5)
    assert bench.give("x", "power", enabled=False).accepted
    assert_stops(bench, "the enable was removed during path motion", 23010)


def test_a_fault_of_the_other_axis_aborts_the_path_only() -> None:
    bench = on_path()
    bench.run(2.5)
    assert bench.give("y", "power", enabled=False).accepted
    bench.run(0.4)
    assert bench.last("x").state[-1] == S.CONTINUOUS_MOTION and bench.last("x").set_velocity[-1] == 15.0
    assert_no_jump(bench, acceleration=ACCELERATION)


def test_the_loss_of_the_channel() -> None:
    bench = on_path()
    bench.run(2.5)
    assert bench.give("x", "upstream_lost", source="channel").accepted
    assert_stops(bench, "no block of 'channel' came within the watchdog time", 26101)


# feed releases


def test_external_setpoints_in_a_withheld_direction_are_a_fault_on_a_path_too() -> None:
    """While the program dwells."""
    bench = on_path()
    bench.run(1.0)
    assert bench.give("x", "set_feed_release", forward=False, backward=True).accepted
    bench.run(0.1)
    text = "it is moved forward, which is not released (set_feed_release)"
    assert_stops(bench, text, 23058)


def test_a_path_that_waits_for_its_release_beside_external_setpoints_the_other_way() -> None:
    """The path to X20 is withheld, the workpiece goes back all the same."""
    bench = PathBench("%P\nG04 X1\nG01 X20 F1200\nM30").run(0.2)
    bench.accepted("x", "external_enable", mode="relative")
    rows = profile(bench, -30.0, 10.0)
    assert bench.give("x", "set_feed_release", forward=False, backward=True).accepted
    bench.run(1.5)
    assert bench.last("channel").state[-1] == C.HOLD and bench.last("x").set_velocity[-1] == -10.0
    assert bench.give("x", "set_feed_release", forward=True, backward=True).accepted
    bench.run(4.0)
    assert bench.errors() == [] and bench.position("x") == pytest.approx(20.0 - 30.0, abs=1e-9)
    assert bench.added()[1500] == pytest.approx(expected(rows, 1501)[-1], abs=1e-9)
    assert_no_jump(bench, acceleration=ACCELERATION)


# whatever comes


def things(bench: PathBench, choice: random.Random) -> None:
    """One command at random; refused or not, nothing may jump."""
    deed = choice.randrange(8)
    if deed == 0:
        bench.give("channel", "feed_hold", enabled=choice.random() < 0.5)
    elif deed == 1:
        bench.give("channel", "set_override", percent=choice.choice([0.0, 30.0, 100.0]))
    elif deed == 2:
        bench.give("x", "external_enable", mode="relative")
    elif deed == 3:
        bench.give("x", "external_disable")
    elif deed == 4:
        bench.send("channel", choice.choice(["start", "start", "reset"]))
    elif deed == 5:
        bench.give("x", choice.choice(["stop", "reset", "external_disable"]))
    elif bench.contribution_stands():
        way, velocity = choice.choice([-1, 1]) * choice.uniform(2.0, 15.0), choice.uniform(3.0, 20.0)
        rows = generator(way, first_cycle=bench.cycle + 5, velocity=velocity, a=400.0)
        if (
            bench.give("x", "external_disable").accepted
            and bench.give("x", "external_enable", mode="relative").accepted
        ):
            bench.give("x", "external_setpoints", setpoints=rows)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(8))
def test_at_random_nothing_jumps_and_all_ends(seed: int) -> None:
    choice, bench = random.Random(seed), PathBench()
    bench.run(0.3)
    for _ in range(40):
        things(bench, choice)
        bench.run(0.01 * choice.randrange(1, 30))
    assert bench.give("plc", "stop_all").accepted
    bench.run(1.0)
    assert bench.last("x").set_velocity[-1] == 0.0 and bench.last("x").state[-1] in (S.STANDSTILL, S.ERROR_STOP)
    assert_no_jump(bench, acceleration=ACCELERATION)
    assert_no_jump(bench, "y", acceleration=2200.0)


@pytest.mark.long
def test_the_recorded_commands_reproduce_the_run() -> None:
    bench = on_path(way=37.5)
    bench.run(2.0)
    bench.accepted("x", "external_disable")
    bench.run(0.5)
    assert bench.give("channel", "feed_hold", enabled=True).accepted
    bench.run(0.2)
    assert bench.give("channel", "reset").accepted
    bench.run(0.5)
    units, again = bits(bench), replay(mill(), bench.records, len(bench.blocks["x"]))
    assert [again[unit] for unit in ("channel", "x", "y", "z")] == [units[unit] for unit in ("channel", "x", "y", "z")]


def test_a_run_ends_when_both_have_ended() -> None:
    """From a scenario, without anybody outside."""
    rows = [[900 + n, 0.01 * n, 10.0, 0.0, 1] for n in range(300)] + [[1200, 3.0, 0.0, 0.0, 0]]
    scenario = f"""
- {{at: 0.5, to: x, do: external_enable, mode: relative}}
- {{at: 0.6, to: x, do: external_setpoints, setpoints: {rows}}}
- {{at: 2.0, to: x, do: external_disable}}
"""
    bench = MachineBench("%P\nG01 X20 F1200\nM30", scenario, machine=mill()).run()
    assert bench.errors() == [] and not bench.failed and bench.position("x") == pytest.approx(23.0, abs=1e-9)
