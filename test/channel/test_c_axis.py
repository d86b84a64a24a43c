"""#CAX: the main spindle is an axis of the path, and a spindle again (TF5200 spindle 2.3.3, 2.8.8)."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from c_axis_support import LATHE, assert_within_limits, errors, on_path, run
from long_support import long
from machine_support import ROOT, MachineBench
from replay_support import bits, replay

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

PROGRAM = """N10 M19 S.POS=30 S200
N20 #CAX [S, C]
N30 G01 X100 C90 F6000
N40 G00 C-20 Z50
N50 G91 G01 C50 F3000
N60 G90 C400
N70 #CAX OFF
N80 M3 S500
N90 G01 X90 F1000
N95 M5
N99 M30
"""
ROUNDING = 1e-9


def assert_follows(bench: MachineBench) -> None:
    """The spindle is where the C axis is, in every cycle (deg), once the path has taken it over."""
    cycles = on_path(bench)
    angle = np.array(bench.column("s", "set_position_deg"))
    travel = np.array([value for block in bench.blocks["channel"] for value in block.spindle_travel])
    first = next(block.first_cycle for block in bench.blocks["channel"] if block.path_spindles)
    assert cycles
    led = np.array([cycle for cycle in cycles if first <= cycle < first + len(travel)])
    assert angle[led] - angle[cycles[0]] == pytest.approx(travel[led - first], abs=ROUNDING)


def spindle_jerk(bench: MachineBench) -> float:
    """The largest on the path, deg/s³."""
    return max(abs(value) for block in bench.blocks["channel"] for value in block.spindle_jerk)


def test_the_spindle_is_an_axis_of_the_path_and_a_spindle_again() -> None:
    bench = run(PROGRAM)
    assert bench.events == []
    assert_follows(bench)
    angle = bench.column("s", "set_position_deg")
    cycles = on_path(bench)
    assert angle[cycles[0]] == pytest.approx(30.0)
    assert angle[cycles[-1]] == pytest.approx(400.0)
    assert min(angle[cycle] for cycle in cycles) == pytest.approx(-20.0)
    assert max(bench.column("s", "set_speed_rpm")) == 500.0
    assert (bench.position("x"), bench.position("z")) == (90.0, 50.0)


def test_the_c_axis_begins_where_it_stands_each_time() -> None:
    """Nothing is left of the travel of the time before, whatever comes next: another #CAX, a kinematics, tapping."""
    again = (
        "G00 X30 Z5\n#CAX\nG00 C75\n#CAX OFF\nM19 S.POS=0\n#CAX\n#FACE [X, C]\nG01 X20 C10 F3000\n#FACE OFF\n#CAX OFF"
    )
    bench = run(f"{again}\nM19 S.POS=0\nG63 Z-5 F500 S500\nZ5 S-500\nM30\n")
    assert bench.events == []
    assert_limits_of_s(bench)


def assert_limits_of_s(bench: MachineBench) -> None:
    """No step of the set position in a cycle beyond the speed of the spindle."""
    angle, most = bench.column("s", "set_position_deg"), LATHE.spindles["s"].gears[1].max_speed
    assert max(abs(after - before) for before, after in pairwise(angle)) <= most * 0.001


def test_limits_of_the_spindle_hold() -> None:
    bench = run(PROGRAM)
    gear = LATHE.spindles["s"].gears[1]
    assert max(map(abs, bench.column("s", "set_acceleration_deg_s2"))) <= gear.acceleration * (1.0 + 1e-6)
    assert spindle_jerk(bench) <= gear.acceleration / 0.02 * (1.0 + 1e-6)


def test_position_is_that_of_the_spindle_within_a_turn() -> None:
    bench = run("M3 S300\nG01 X149 F600\nM5\n#CAX\nG91 G01 C10 F3000\nM30\n")
    assert bench.events == []
    cycles = on_path(bench)
    angle = bench.column("s", "set_position_deg")
    assert angle[cycles[0]] > 360.0
    assert angle[cycles[-1]] - angle[cycles[0]] == pytest.approx(10.0)
    assert bench.blocks["channel"][-1].programmed_position[2] == pytest.approx(angle[cycles[0]] % 360.0 + 10.0)


def test_blocks_are_run_through() -> None:
    bench = run("#CAX\nG01 C10 X140 F3000\nC20 X130\nC30 X120\nM30\n")
    velocity = [abs(v) for v in bench.column("channel", "path_velocity") if v]
    moving = bench.column("channel", "path_velocity")
    begin = next(n for n, v in enumerate(moving) if v)
    assert all(moving[begin : begin + len(velocity)])


@pytest.mark.parametrize("percent", [30, *long([80])])
def test_override_acts(percent: int) -> None:
    bench = run("#CAX\nG01 C200 F6000\nM30\n", f"- {{at: 0.0, to: channel, do: set_override, percent: {percent}}}")
    assert max(bench.column("s", "set_speed_rpm")) * 6.0 == pytest.approx(percent)
    assert_follows(bench)


def test_feed_hold_and_reset() -> None:
    scenario = """- {at: 1.0, to: channel, do: feed_hold, enabled: true}
- {at: 2.0, to: channel, do: feed_hold, enabled: false}
- {at: 3.0, to: channel, do: reset}"""
    bench = run("#CAX\nG01 C2000 F6000\nM30\n", scenario)
    assert C.HOLD in bench.states("channel")
    assert_follows(bench)
    assert bench.states("s")[-1] == S.STANDSTILL
    assert 100.0 < bench.column("s", "set_position_deg")[-1] < 300.0


def test_single_block() -> None:
    scenario = """- {at: 0.0, to: channel, do: single_block, enabled: true}
- {at: 2.0, to: channel, do: start}
- {at: 4.0, to: channel, do: start}
- {at: 6.0, to: channel, do: start}"""
    bench = run("#CAX\nG01 C20 F6000\nC40\nM30\n", scenario)
    assert bench.events == []
    assert bench.column("s", "set_position_deg")[-1] == pytest.approx(40.0)


def test_manual_block_gives_the_spindle_back_at_its_end() -> None:
    scenario = """- {at: 0.1, to: channel, do: mdi, text: "#CAX\\nG01 C20 F6000"}
- {at: 2.0, to: channel, do: mdi, text: "M3 S100"}
- {at: 4.0, to: channel, do: mdi, text: "M5"}"""
    bench = MachineBench("M30\n", scenario, machine=LATHE).run(6.0)
    assert bench.events == []
    assert max(bench.column("s", "set_speed_rpm")) == 100.0


def test_homes_before_without_a_reference() -> None:
    spindle = replace(LATHE.spindles["s"], referenced_at_start=False)
    bench = run("#CAX\nG01 C20 F6000\nM30\n", machine=replace(LATHE, spindles={**LATHE.spindles, "s": spindle}))
    assert bench.events == []
    assert bench.column("s", "referenced")[-1]
    assert bench.blocks["channel"][-1].programmed_position[2] == pytest.approx(20.0)


def test_no_reference_and_no_automatic_homing() -> None:
    spindle = replace(LATHE.spindles["s"], referenced_at_start=False, automatic_homing=False)
    bench = run("#CAX\nM30\n", machine=replace(LATHE, spindles={**LATHE.spindles, "s": spindle}))
    assert bench.errors() == [
        "P-ERR-22120 channel channel: spindle s has no reference point and does not home automatically (P-AXIS-00015"
        " 0x100); home it before #CAX (G74 S1) in test.nc line 1 '#CAX'; the path stops on its ramp and the program is aborted"
    ]


def test_spindle_that_others_turn_is_refused() -> None:
    bench = run("G00 X100\n#CAX\nM30\n", "- {at: 0.0, to: s, do: start, direction: cw, speed_rpm: 120}")
    assert errors(bench) == [
        "channel channel: spindle s turns at 120 rpm; it must be at a standstill (M05 or M19 before) in test.nc line 2"
        " '#CAX'; the path stops on its ramp and the program is aborted"
    ]


def test_fault_of_the_spindle_stops_the_path() -> None:
    bench = run("#CAX\nG01 C2000 X100 F600\nM30\n", "- {at: 1.0, to: s, do: power, enabled: false}")
    assert_follows(bench)
    assert errors(bench) == [
        "channel channel: s is in error P-ERR-24011; the path stops on its ramp and the program is aborted"
    ]


def test_tapping_before_and_after() -> None:
    bench = run("G63 Z290 F250 S200\nZ300 S-200\n#CAX\nG01 C90 F6000\n#CAX OFF\nG63 Z290 F250 S200\nM30\n")
    assert bench.events == []
    assert bench.column("s", "set_position_deg")[-1] == pytest.approx(90.0 + 10.0 / 1.25 * 360.0)


def test_a_thread_before_and_after() -> None:
    thread = "M03 S500 G00 X40 Z60\nG33 Z48 K1.5\nG00 X50\nM05\n"
    bench = run(f"{thread}#CAX [S, C]\nG00 C90\n#CAX OFF\n{thread}M30\n")
    assert errors(bench) == []
    assert bench.column("z", "set_position")[-1] == pytest.approx(48.0)
    assert bench.blocks["channel"][-1].done


def test_offset_of_the_c_axis() -> None:
    bench = run("#CAX\nG92 C10\nG01 C90 F6000\nM30\n")
    assert bench.column("s", "set_position_deg")[-1] == pytest.approx(100.0)


def test_programs_can_read_the_axis() -> None:
    bench = run('#CAX\nG00 C30\nP1 = V.A.ACT_POS.C P2 = V.A.ABS.C\n#MSG ["%f %f", P1, P2]\nM30\n')
    assert [event.text for event in bench.events_of("channel")] == ["30.000000 30.000000"]


@pytest.mark.long
def test_replay_gives_the_same_again() -> None:
    bench = run(PROGRAM, "- {at: 3.0, to: channel, do: set_override, percent: 40}")
    again, first = replay(bench.machine, bench.records, len(bench.blocks["plc"])), bits(bench)
    for unit in ("channel", "s", "x", "z"):
        assert again[unit] == first[unit]


@pytest.mark.long
def test_example() -> None:
    """Holes, hexagon, groove past the centre, letters; the spindle turns again at its end."""
    program = (ROOT / "examples" / "caxis.nc").read_text()
    bench = MachineBench(program, machine=LATHE).run()
    assert bench.events == []
    assert_within_limits(bench)
    assert max(bench.column("s", "set_speed_rpm")) == 600.0
