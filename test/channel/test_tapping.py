"""G63, G331, G332: the spindle turns with the path in every cycle, whatever happens (TF5200 spindle 2.8.6)."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from long_support import long
from machine_support import MILL, MachineBench, spindle_bench
from replay_support import bits, replay

from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import ChannelBlock
from cnc_ptp.protocol.channel_states import ChannelStateCode as C
from cnc_ptp.protocol.spindle_states import SpindleBit

EXAMPLES = Path(__file__).parents[2] / "examples"
PITCH = 1.25
DEGREES_PER_MM = 360.0 / PITCH
TAP = """N10 G00 Z5
N20 M19 S.POS=90 S300
N30 G63 Z-15 F250 S200
N40 Z5 S-200
N50 G01 X10 F2000
N60 M30
"""
FOLLOWS = 1e-9
"""deg by which the spindle may leave the path; the issue asks for 0.01."""


def run(program: str = TAP, scenario: str = "") -> MachineBench:
    return MachineBench(program, scenario).run()


def on_path(bench: MachineBench) -> list[int]:
    """Cycles in which the path moves the spindle."""
    return [cycle for cycle, bit in enumerate(bench.column("s", "status_bits")) if bit & SpindleBit.ON_PATH]


def assert_follows(bench: MachineBench, degrees_per_mm: float = DEGREES_PER_MM) -> None:
    """Where the path moves the spindle, its angle is that of the path, downwards positive."""
    angle, speed = (np.array(bench.column("s", name)) for name in ("set_position_deg", "set_speed_rpm"))
    depth, velocity = (np.array(bench.column("z", name)) for name in ("set_position", "set_velocity"))
    cycles = on_path(bench)
    assert cycles
    stretches = [0, *[n + 1 for n, (one, other) in enumerate(pairwise(cycles)) if other != one + 1], len(cycles)]
    for begin, end in pairwise(stretches):
        inside, first = cycles[begin:end], cycles[begin]
        turned = angle[inside] - angle[first]
        assert turned == pytest.approx(-degrees_per_mm * (depth[inside] - depth[first]), abs=FOLLOWS)
        assert speed[inside] * 6.0 == pytest.approx(-degrees_per_mm * velocity[inside], abs=FOLLOWS)


def tapping_speed(bench: MachineBench) -> float:
    """The largest, rpm."""
    speeds = bench.column("s", "set_speed_rpm")
    return max(speeds[cycle] for cycle in on_path(bench))


def assert_spindle_in_limits(bench: MachineBench) -> None:
    """Speed and acceleration of the gear."""
    gear = MILL.spindles["s"].gears[1]
    assert max(map(abs, bench.column("s", "set_speed_rpm"))) * 6.0 <= gear.max_speed * (1.0 + 1e-9)
    limit = max(gear.acceleration, gear.deceleration) * (1.0 + 1e-6)
    assert max(map(abs, bench.column("s", "set_acceleration_deg_s2"))) <= limit


def test_spindle_follows_the_path() -> None:
    bench = run()
    assert bench.events == []
    assert_follows(bench)
    assert_spindle_in_limits(bench)
    depth, angle = bench.column("z", "set_position"), bench.column("s", "set_position_deg")
    assert min(depth) == pytest.approx(-15.0, abs=1e-4)
    assert bench.position("z") == 5.0
    assert angle[-1] == pytest.approx(90.0, abs=FOLLOWS)
    assert bench.column("s", "state").count(S.SYNCHRONIZED_MOTION) == len(on_path(bench))


@pytest.mark.parametrize("percent", [120, *long([30, 100])])
def test_path_override_acts_on_both(percent: int) -> None:
    bench = run(scenario=f"- {{at: 0.0, to: channel, do: set_override, percent: {percent}}}")
    assert_follows(bench)
    assert tapping_speed(bench) == pytest.approx(200.0 * percent / 100.0, rel=1e-9)


def test_spindle_override_acts_on_both() -> None:
    scenario = (
        "- {at: 0.0, to: s, do: set_override, percent: 50}\n- {at: 0.0, to: channel, do: set_override, percent: 80}"
    )
    bench = run(scenario=scenario)
    assert_follows(bench)
    assert tapping_speed(bench) == pytest.approx(80.0, rel=1e-9)


@pytest.mark.parametrize("at", [3.3, *long([2.0, 5.5, 8.0])])
def test_feed_hold_stops_both_and_lets_both_continue(at: float) -> None:
    scenario = f"""- {{at: {at}, to: channel, do: feed_hold, enabled: true}}
- {{at: {at + 1.0}, to: channel, do: feed_hold, enabled: false}}"""
    bench = run(scenario=scenario)
    assert C.HOLD in bench.states("channel")
    assert_follows(bench)
    assert bench.position("z") == 5.0


@pytest.mark.parametrize("spindle", ["s", "channel"])
def test_override_0_stops_both(spindle: str) -> None:
    scenario = f"""- {{at: 3.0, to: {spindle}, do: set_override, percent: 0}}
- {{at: 4.0, to: {spindle}, do: set_override, percent: 100}}"""
    bench = run(scenario=scenario)
    assert_follows(bench)
    held = [block for block in bench.blocks["channel"] if block.state[-1] == C.HOLD]
    assert held
    assert bench.position("z") == 5.0


def test_reset_stops_both_in_step() -> None:
    bench = run(scenario="- {at: 3.0, to: channel, do: reset}")
    assert_follows(bench)
    assert -15.0 < bench.position("z") < 5.0
    assert bench.states("s")[-1] == S.STANDSTILL
    assert bench.column("s", "set_speed_rpm")[-1] == 0.0


def test_fault_of_the_spindle_stops_both_in_step() -> None:
    bench = run(scenario="- {at: 3.0, to: s, do: power, enabled: false}")
    assert_follows(bench)
    assert bench.states("s")[-1] == S.ERROR_STOP
    assert [event.text for event in bench.events_of("s") if event.severity == 2] == [
        "spindle s: the enable was removed in motion; the spindle stops with the path (ErrorStop)"
    ]
    assert [event.text for event in bench.events_of("channel") if event.severity == 2] == [
        "channel channel: s is in error P-ERR-24011; the path stops on its ramp and the program is aborted"
    ]


def test_fault_of_an_axis_stops_both_in_step() -> None:
    bench = run(scenario="- {at: 3.0, to: x, do: power, enabled: false}")
    assert_follows(bench)
    assert bench.states("s")[-1] == S.STANDSTILL
    assert bench.states("channel")[-1] == C.ERROR


def test_path_that_gives_no_setpoints_any_more_stops_the_spindle() -> None:
    bench = MachineBench(TAP).run(3.0)
    bench.give("s", "upstream_lost", source="channel")
    bench.offline.runner("s").unit.lost.add("channel")
    bench.run(0.5)
    assert [event.text for event in bench.events_of("s") if event.severity == 2] == [
        "spindle s: no block of 'channel' came within the watchdog time; the spindle stops in step with the axes of the"
        " path (ErrorStop)"
    ]
    assert bench.column("s", "set_speed_rpm")[-1] == 0.0
    assert_spindle_in_limits(bench)


def test_dwell_at_depth() -> None:
    bench = run("G63 Z-10 F250 S200\nG04 0.5\nZ5 S-200\nM30\n")
    assert_follows(bench)
    at_depth = [cycle for cycle, z in enumerate(bench.column("z", "set_position")) if z == -10.0]
    assert len(at_depth) == 500


def test_left_hand_thread() -> None:
    bench = run("G63 Z-10 F250 S-200\nZ5 S200\nM30\n")
    assert_follows(bench, -DEGREES_PER_MM)


@pytest.mark.parametrize(("pitch", "sense"), [("K1.25", 1.0), ("K-1.25", -1.0)])
def test_pitch_instead_of_feed(pitch: str, sense: float) -> None:
    bench = run(f"G331 Z-10 {pitch} S200\nG332 Z5 {pitch}\nM30\n")
    assert_follows(bench, sense * DEGREES_PER_MM)


def test_speed_of_the_last_spindle_function_counts() -> None:
    bench = run("M19 S.POS=0 S100\nG01 F200\nG63 Z-4\nM30\n")
    assert_follows(bench, 360.0 / 2.0)


def test_other_path_function_gives_the_spindle_back() -> None:
    bench = run("G63 Z-4 F250 S200\nZ0 S-200\nG01 X5 F1000\nM3 S500\nG01 X10\nM5\nM30\n")
    assert bench.events == []
    assert_follows(bench)
    assert max(bench.column("s", "set_speed_rpm")) == 500.0


def test_acceleration_of_the_spindle_limits_the_path() -> None:
    bench = run("G63 Z-30 F6000 S3000 \nZ0 S-3000\nM30\n")
    assert_follows(bench, 360.0 * 3000.0 / 6000.0)
    assert_spindle_in_limits(bench)


def test_spindle_that_others_turn_is_refused() -> None:
    bench = run("G00 X20\nG63 Z-4 F250 S200\nM30\n", "- {at: 0.0, to: s, do: start, direction: cw, speed_rpm: 120}")
    assert bench.failed
    assert bench.errors() == [
        "P-ERR-22060 channel channel: spindle s turns at 120 rpm; it must be at a standstill (M05 or M19 before) in test.nc line 2"
        " 'G63 Z-4 F250 S200'; the path stops on its ramp and the program is aborted"
    ]


@pytest.mark.parametrize(
    ("command", "arguments"),
    [
        ("start", {"direction": "cw", "speed_rpm": 100.0}),
        ("stop", {}),
        ("orient", {"position_deg": 0.0}),
        ("home", {}),
        ("reset", {}),
    ],
)
def test_commands_to_a_spindle_on_the_path_are_refused(command: str, arguments: dict[str, object]) -> None:
    bench = MachineBench(TAP).run(3.0)
    assert bench.refused("s", command, **arguments) == (
        f"P-ERR-24031 spindle s: {command} refused: the path of channel 'channel' moves the spindle; reset the channel to"
        " stop it; nothing was changed"
    )
    bench.run()
    assert bench.position("z") == 5.0
    assert_follows(bench)


def test_spindle_that_leaves_the_path_stops_it() -> None:
    bench = MachineBench(TAP).run(3.0)
    assert bench.give("s", "leave_path", source="channel").accepted
    bench.run()
    assert bench.errors() == [
        "P-ERR-22061 channel channel: spindle s no longer follows the path in test.nc line 3 'N30 G63 Z-15 F250 S200';"
        " the path stops on its ramp and the program is aborted"
    ]
    assert bench.column("s", "set_speed_rpm")[-1] == 0.0
    assert_spindle_in_limits(bench)


def test_path_without_setpoints_stops_the_spindle_on_its_ramp() -> None:
    bench = spindle_bench()
    assert bench.accepted("follow_path", source="channel") == ""
    bench.run(10, {"channel": ChannelBlock(bench.cycle, 10)})
    travel = [0.5 * n for n in range(10)]
    block = ChannelBlock(bench.cycle, 10, path_spindles=["s"], spindle_travel=travel, spindle_speed=[500.0] * 10)
    block.spindle_acceleration = block.spindle_jerk = [0.0] * 10
    bench.run(10, {"channel": block})
    bench.run(10, {"channel": ChannelBlock(bench.cycle, 10)})
    assert bench.event_texts() == [
        "P-ERR-24033 spindle s: the path of channel 'channel' no longer gives setpoints; the spindle stops on its ramp"
        " (ErrorStop)"
    ]
    bench.run(1000)
    assert bench.column("set_speed_rpm")[-1] == 0.0


def test_leave_without_a_path() -> None:
    bench = MachineBench(TAP).run(0.1)
    record = bench.give("s", "leave_path", source="channel")
    assert record.accepted
    assert record.message.endswith("spindle s: leave_path without effect, no path of 'channel' moves it")


def test_spindle_in_motion_cannot_be_taken_over() -> None:
    bench = MachineBench("M19 S.POS=200 S60\nM30\n").run(0.2)
    assert bench.refused("s", "follow_path", source="channel") == (
        "P-ERR-24032 spindle s: follow_path refused: the spindle is in DiscreteMotion at -60 rpm; it must be at a"
        " standstill; nothing was changed"
    )


def test_spindle_taps_while_it_turns_with_the_workpiece() -> None:
    """TF5200 spindle p.52: the tool spindle is coupled to that of the workpiece, and taps on top of that."""
    machine = read_machine(EXAMPLES / "spindles" / "synchronous.yaml")
    program = """#ENABLE AX LINK [0]
M03 S300
G01 X10 F3000
N40 G63 X-10 F250 S2=200
N50 X10 S2=-200
G01 X20 F2000
M05
#DISABLE AX LINK [0]
M30
"""
    bench = MachineBench(program, machine=machine).run()
    assert bench.events == []
    numbers = bench.column("channel", "block_number")
    tool, workpiece = (np.array(bench.column(spindle, "set_position_deg")) for spindle in ("s2", "s1"))
    x = np.array(bench.column("x", "set_position"))
    cycles = [cycle for cycle, number in enumerate(numbers) if number in (40, 50)]
    begin = cycles[0]
    turned = (tool - workpiece)[cycles] - (tool - workpiece)[begin]
    assert turned == pytest.approx(-DEGREES_PER_MM * (x[cycles] - x[begin]), abs=FOLLOWS)
    assert min(bench.column("s2", "set_speed_rpm")[begin : cycles[-1]]) == pytest.approx(100.0)
    assert max(bench.column("s2", "set_speed_rpm")[begin : cycles[-1]]) == pytest.approx(500.0)


@pytest.mark.long
def test_replay_gives_the_same_again() -> None:
    bench = run(scenario="- {at: 3.0, to: channel, do: set_override, percent: 40}")
    again, first = replay(bench.machine, bench.records, len(bench.blocks["plc"])), bits(bench)
    for unit in ("channel", "s", "x", "y", "z"):
        assert again[unit] == first[unit]


@pytest.mark.parametrize("behind", ["", "G63 Z-2 F250 S200\nZ5 S-200\n", *long(["G01 X10 F2000\n", "G04 0.1\n"])])
@pytest.mark.parametrize("feed", [333, *long([125, 250])])
def test_the_spindle_ends_where_the_path_does(feed: int, behind: str) -> None:
    """Also where the path comes to rest within the last cycle of a block: hole after hole begins at the same angle."""
    bench = run(f"G00 Z5\nM19 S.POS=90 S300\nG63 Z-5 F{feed} S{feed * 0.8}\nZ5 S-{feed * 0.8}\n{behind}M30")
    assert bench.errors() == []
    assert bench.column("s", "set_position_deg")[-1] == pytest.approx(90.0, abs=FOLLOWS)
