"""G51, G95 and G96 on a whole lathe: feed per turn and cutting speed, calculated again from the columns."""

from __future__ import annotations

import json
from math import pi

import pytest
from channel_spindle_support import machine_of, three
from long_support import long
from machine_support import ROOT, MachineBench, assert_axes_smooth, machine
from replay_support import bits, replay

from cnc_ptp.parameters import Synchronisation, read_machine
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

LATHE = read_machine(ROOT / "config" / "lathe.yaml")
SHOWN = machine(LATHE, channel={"shows_diameter": True})
FACING = """N10 G18 G51
N20 M03 S100
N30 G00 X100 Z10
N40 G95 F0.1
N50 G196 S3500
N60 G96 S100
N70 G01 X10
N80 G00 X60
N90 G97
N100 M30
"""
TURNING = """N10 G18 G51 G95 F0.2
N20 M03 S1200
N30 G00 X40 Z2
N40 G01 Z-20
N50 X60 Z-30
N60 Z-40
N70 M30
"""


def run(program: str = TURNING, scenario: str = "", parameters=LATHE) -> MachineBench:
    return MachineBench(program, scenario, machine=parameters).run()


def cycles_of(bench: MachineBench, *numbers: int) -> list[int]:
    """Cycles of blocks by their N words."""
    return [cycle for cycle, number in enumerate(bench.column("channel", "block_number")) if number in numbers]


def steady(bench: MachineBench, cycles: list[int]) -> list[int]:
    """Those of `cycles` in which the path is not on a ramp at either end of its motion."""
    return [cycle for cycle in cycles if cycles[0] + 100 < cycle < cycles[-1] - 100]


def feeds(bench: MachineBench, cycles: list[int]) -> list[float]:
    """mm in a turn, from the actual speed of the spindle."""
    velocity, speed = bench.column("channel", "path_velocity"), bench.column("s", "actual_speed_rpm")
    return [60.0 * velocity[cycle] / abs(speed[cycle]) for cycle in cycles]


def cutting_speeds(bench: MachineBench, cycles: list[int]) -> list[float]:
    """m/min, from set values."""
    x, speed = bench.column("x", "set_position"), bench.column("s", "set_speed_rpm")
    return [2.0 * pi * x[cycle] * abs(speed[cycle]) / 1000.0 for cycle in cycles]


def set_speeds(bench: MachineBench) -> list[float]:
    """Commanded to the spindle while it turns."""
    return [json.loads(record.arguments_json)["speed_rpm"] for record in bench.records if record.command == "set_speed"]


# feed per turn


@pytest.mark.long
def test_feed_per_turn() -> None:
    """0.2 mm in each turn; the way against the angle of the spindle over the whole cut as well."""
    bench = run()
    assert bench.events == []
    assert_axes_smooth(bench)
    cut = steady(bench, cycles_of(bench, 40))
    assert feeds(bench, cut) == pytest.approx([0.2] * len(cut), rel=2e-3)
    turns = sum(bench.column("s", "actual_speed_rpm")[cycle] / 60_000.0 for cycle in cut[1:])
    way = bench.column("z", "set_position")[cut[0]] - bench.column("z", "set_position")[cut[-1]]
    assert way / turns == pytest.approx(0.2, rel=1e-3)


def test_the_path_goes_through_several_blocks() -> None:
    """With a cone: the path passes its corners without a stop, as with G94."""
    bench = run(TURNING.replace("G18 ", "G18 G261 "))
    velocity = bench.column("channel", "path_velocity")
    inside = steady(bench, cycles_of(bench, 40, 50, 60))
    assert min(velocity[cycle] for cycle in inside) > 1.0
    assert_axes_smooth(bench)


@pytest.mark.long
def test_the_path_follows_the_actual_speed() -> None:
    """The spindle override acts on the feed through the speed, that of the path on top."""
    scenario = (
        "- {at: 3.0, to: s, do: set_override, percent: 50}\n- {at: 4.0, to: channel, do: set_override, percent: 80}"
    )
    bench = run(scenario=scenario)
    assert_axes_smooth(bench)
    cut = steady(bench, cycles_of(bench, 40))
    before, slow = [cycle for cycle in cut if cycle < 2990], [cycle for cycle in cut if 3500 < cycle < 3990]
    override = [cycle for cycle in cut if cycle > 4200]
    assert feeds(bench, before) == pytest.approx([0.2] * len(before), rel=2e-3)
    assert feeds(bench, slow) == pytest.approx([0.2] * len(slow), rel=2e-3)
    assert feeds(bench, override) == pytest.approx([0.16] * len(override), rel=2e-3)
    ramp = [cycle for cycle in cut if 3020 < cycle < 3200]
    assert feeds(bench, ramp) == pytest.approx([0.2] * len(ramp), rel=0.05)


def test_the_path_waits_for_a_spindle_that_stands() -> None:
    """A warning once; it starts with the spindle and stays smooth."""
    program = TURNING.replace("N20 M03 S1200", "N20 S1200")
    bench = MachineBench(program, "- {at: 5.0, to: s, do: start, direction: cw, speed_rpm: 600}", machine=LATHE).run()
    assert [(event.error_id, event.text) for event in bench.events] == [
        (22140, "channel channel: the path waits in line 4 for spindle s to turn (G95)")
    ]
    assert C.HOLD in bench.states("channel")
    assert_axes_smooth(bench)
    assert bench.position("z") == pytest.approx(-40.0)
    late = steady(bench, cycles_of(bench, 60))
    assert feeds(bench, late) == pytest.approx([0.2] * len(late), rel=2e-3)


def test_what_the_program_waits_for_names_the_spindle() -> None:
    bench = MachineBench(TURNING.replace("N20 M03 S1200", "N20 S1200"), machine=LATHE)
    bench.run(3.0)
    assert bench.units["channel"].waits_for() == "channel channel waits in line 4 for spindle s to turn (G95)"


@pytest.mark.parametrize("at", [4.0, *long([2.5])])
def test_spindle_override_0_and_feed_hold_stop_the_path(at: float) -> None:
    scenario = f"""- {{at: {at}, to: s, do: set_override, percent: 0}}
- {{at: {at + 1.0}, to: s, do: set_override, percent: 100}}
- {{at: {at + 2.0}, to: channel, do: feed_hold, enabled: true}}
- {{at: {at + 2.5}, to: channel, do: feed_hold, enabled: false}}"""
    bench = run(scenario=scenario)
    assert bench.states("channel").count(C.HOLD) == 2
    assert_axes_smooth(bench)
    assert bench.position("z") == pytest.approx(-40.0)


def test_full_override_leaves_the_feed_to_the_spindle() -> None:
    """G166: the override of the path has no effect, the speed of the spindle has."""
    program = TURNING.replace("N40 G01", "N40 G166 G01")
    bench = run(program, "- {at: 0.0, to: channel, do: set_override, percent: 50}")
    cut = steady(bench, cycles_of(bench, 40))
    assert feeds(bench, cut) == pytest.approx([0.2] * len(cut), rel=2e-3)


def test_a_motion_by_minutes_behind_it_has_its_feed() -> None:
    bench = run(TURNING.replace("N60 Z-40", "N60 G94 F600 Z-40"))
    cut = steady(bench, cycles_of(bench, 60))
    velocity = bench.column("channel", "path_velocity")
    assert [velocity[cycle] for cycle in cut] == pytest.approx([10.0] * len(cut))


def test_the_estimate_has_the_commanded_speed() -> None:
    """22 mm at 4 mm/s, the cone of 14.1 mm and 10 mm: as long as the run takes."""
    bench = MachineBench(TURNING, machine=LATHE)
    bench.run(0.02)
    estimate = bench.last("channel").time_left
    bench.run()
    moving = [velocity > 0.0 for velocity in bench.column("channel", "path_velocity")]
    assert estimate == pytest.approx(sum(moving) / 1000.0, abs=0.1)


# constant cutting speed


@pytest.mark.long
def test_cutting_speed_is_constant_on_a_face() -> None:
    """From 100 to 10 mm within 1 %, while the acceleration of the spindle permits; the feed per turn holds."""
    bench = run(FACING)
    assert bench.events == []
    assert_axes_smooth(bench)
    cut = steady(bench, cycles_of(bench, 70))
    assert cutting_speeds(bench, cut) == pytest.approx([100.0] * len(cut), rel=0.01)
    assert feeds(bench, cut) == pytest.approx([0.1] * len(cut), rel=0.01)
    x = bench.column("x", "set_position")
    assert (x[cut[0]], x[cut[-1]]) == (pytest.approx(50.0, abs=0.2), pytest.approx(5.0, abs=0.6))


@pytest.mark.long
def test_rapid_traverse_and_g97_keep_the_speed() -> None:
    bench = run(FACING)
    speed = bench.column("s", "programmed_speed_rpm")
    rapid = cycles_of(bench, 80)
    assert len({speed[cycle] for cycle in rapid[20:]}) == 1
    assert speed[rapid[-1]] == pytest.approx(100_000.0 / (2.0 * pi * 5.0), rel=1e-3)
    assert bench.column("x", "set_position")[-1] == 30.0


@pytest.mark.parametrize(("limit", "largest"), [("N50 G196 S1500", 1500.0), ("N50", 4000.0)])
def test_the_speed_is_limited(limit: str, largest: float) -> None:
    """By G196, and by the gear at the turning centre; the cut begins there, which is a warning."""
    bench = run(FACING.replace("N50 G196 S3500", limit).replace("X10", "X0").replace("F0.1", "F0.5"))
    assert [event.error_id for event in bench.events] == [20633]
    assert max(set_speeds(bench)) == largest
    assert max(bench.column("s", "set_speed_rpm")) == pytest.approx(largest)


def test_the_turning_centre_is_that_of_the_workpiece() -> None:
    """Zero offset and tool count."""
    bench = run("N10 G18 G51 M03 S100\nN20 G92 X20 (radius)\nN30 G00 X60 Z0\nN40 G96 S60 G95 F0.2\nN50 G01 X40\nM30")
    x, speed = bench.column("x", "set_position"), bench.column("s", "set_speed_rpm")
    cut = steady(bench, cycles_of(bench, 50))
    found = [2.0 * pi * (x[cycle] - 20.0) * speed[cycle] / 1000.0 for cycle in cut]
    assert found == pytest.approx([60.0] * len(found), rel=0.01)


@pytest.mark.long
def test_few_commands_where_the_diameter_stays() -> None:
    """Longitudinal turning: one speed."""
    bench = run("N10 G18 G51 M03 S100\nN20 G00 X60 Z0\nN30 G96 S60 G95 F0.2\nN40 G01 Z-30\nM30")
    assert len(set_speeds(bench)) == 2
    assert set_speeds(bench)[0] == pytest.approx(set_speeds(bench)[1])


@pytest.mark.parametrize("synchronisation", ["NO_SYNCH", "MVS_SLM", "MVS_SVS", "MVS_SNS"])
def test_no_synchronisation_stops_the_path_in_the_cut(synchronisation: str) -> None:
    """S of G96 is waited for at most once; what follows the facing axis is not."""
    main, driven = LATHE.channels["channel"].spindles
    spindles = (main._replace(s=Synchronisation[synchronisation]), driven)
    bench = run(FACING.replace("F0.1", "F0.4"), parameters=machine(LATHE, channel={"spindles": spindles}))
    assert bench.errors() == []
    velocity = bench.column("channel", "path_velocity")
    cut = steady(bench, cycles_of(bench, 70))
    assert min(velocity[cycle] for cycle in cut) > 0.5


def test_reset_and_m5_end_it() -> None:
    bench = MachineBench(FACING, "- {at: 12.0, to: channel, do: reset}", machine=LATHE, end_when_idle=False)
    bench.run(14.0)
    assert bench.last("s").set_speed_rpm[-1] == 0.0
    after = [record for record in bench.records if record.command == "set_speed" and record.cycle > 12_100]
    assert after == []
    stopped = run(FACING.replace("N70 G01 X10", "N65 M05\nN70 G94 F600 G01 X10"))
    assert set_speeds(stopped)[1:] == []


@pytest.mark.long
def test_spindle_override_acts() -> None:
    bench = run(FACING, "- {at: 0.0, to: s, do: set_override, percent: 50}")
    cut = steady(bench, cycles_of(bench, 70))
    assert cutting_speeds(bench, cut) == pytest.approx([50.0] * len(cut), rel=0.01)
    assert feeds(bench, cut) == pytest.approx([0.1] * len(cut), rel=0.02)  # feedforward shows each new speed at once


@pytest.mark.long
def test_replay_is_equal_to_the_bit() -> None:
    bench = run(FACING.replace("F0.1", "F0.4"), "- {at: 3.0, to: s, do: set_override, percent: 80}")
    texts, expected = replay(LATHE, bench.records, len(bench.blocks["x"])), bits(bench)
    for name in ("channel", "s", "x", "z"):
        assert texts[name] == expected[name], name


def test_slaves_follow_without_a_warning() -> None:
    """Their speed changes with that of the master, and nobody else has commanded them."""
    axes = {"facing": True, "diameter_absolute": True}
    two = machine(machine_of(*three()), x=axes)
    program = "#SET AX LINK[1, S2=S]\n#ENABLE AX LINK[1]\nN10 G18 G51 M03 S100\nN20 G00 X100 Z10\nN50 G96 S100 G95 F0.5\nN60 G01 X60\nM30"
    bench = run(program, parameters=two)
    assert bench.events == []
    assert bench.column("t", "set_speed_rpm")[-200:] == pytest.approx(bench.column("s", "set_speed_rpm")[-200:])


@pytest.mark.long
def test_a_start_in_mid_program_has_the_cutting_speed() -> None:
    bench = MachineBench(FACING.replace("F0.1", "F0.4"), machine=LATHE, start=False)
    bench.run(0.02)
    assert bench.give("channel", "start", block_number=70).accepted
    bench.run()
    assert bench.errors() == []
    x = bench.column("x", "set_position")
    cut = [cycle for cycle in cycles_of(bench, 70) if 25.0 < x[cycle] < 49.5]  # before: the way to the start
    assert cutting_speeds(bench, cut) == pytest.approx([100.0] * len(cut), rel=0.01)


@pytest.mark.long
def test_manual_blocks_keep_it() -> None:
    bench = MachineBench(machine=LATHE, end_when_idle=False)
    bench.run(0.02)
    for text in ("G18 G51 G00 X100 Z10", "M03 S100", "G95 F0.4 G96 S100", "G01 X84"):
        assert bench.give("channel", "mdi", text=text).accepted
        bench.run(6.0)
    x, speed = bench.position("x"), bench.last("s").set_speed_rpm[-1]
    assert x == 42.0
    assert 2.0 * pi * x * speed / 1000.0 == pytest.approx(100.0, rel=2e-3)


# diameters


@pytest.mark.parametrize(("parameters", "shown"), [(LATHE, 20.0), (SHOWN, 40.0)])
def test_the_programmed_position_is_shown_in_diameters(parameters, shown: float) -> None:
    """P-CHAN-00256; the axis has its radius."""
    bench = run("N10 G18 G51\nN20 G00 X40 Z2\nN30 G04 0.1\nM30", parameters=parameters)
    (cycle,) = {block.programmed_position[0] for block in bench.blocks["channel"] if block.block_number[-1] == 30}
    assert cycle == shown
    assert bench.position("x") == 20.0
