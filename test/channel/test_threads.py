"""G33 on a whole lathe: pitch and phase in numbers, chains, disturbances, what breaks a thread off, exact texts."""

from __future__ import annotations

import random
from dataclasses import replace

import numpy as np
import pytest
from long_support import long
from machine_support import MachineBench
from thread_support import HEAD, LATHE, NO_RETRACT, Pass, apart, assert_within_limits, column, cut, lathe, texts

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

BACK = "\nG00 X40\nZ105\nX36\n"
THREAD = "G33 Z48 K1.5"
RUN_UP = "22085 channel channel: thread at 400.0 rpm: run-up 0.141 mm, run-out 0.141 mm (line 4)"


# pitch and phase


def test_the_pitch_is_right_to_a_micrometre_over_50_mm_and_passes_lie_in_one_groove():
    bench = cut(THREAD + BACK + THREAD + BACK + "M03 S730\n" + THREAD)
    passes = [Pass(bench, line, 1.5) for line in (4, 8, 13)]
    assert max(each.error(2.0, 54.0) for each in passes) < 1e-6
    phases = [each.phase(2.0, 54.0) for each in passes]
    assert max(abs(apart(0.0, phase)) for phase in phases) < 0.002
    actual = [Pass(bench, line, 1.5, actual=True) for line in (4, 8, 13)]
    assert max(each.error(2.0, 54.0) for each in actual) < 1e-5
    assert max(abs(apart(0.0, each.phase(2.0, 54.0))) for each in actual) < 0.002


def test_two_starts_are_180_deg_apart():
    bench = cut("G33 Z48 K3" + BACK + "G33 Z48 S.OFFSET=180")
    for actual in (False, True):
        first, second = (Pass(bench, line, 3.0, actual=actual).phase(2.0, 54.0) for line in (4, 8))
        assert apart(180.0, apart(first, second)) == pytest.approx(0.0, abs=0.002)


@pytest.mark.parametrize("offset", [33.0, *long([0.0, 359.5])])
def test_a_thread_begins_at_its_offset_in_the_direction_of_the_spindle(offset):
    bench = cut(f"G33 Z48 K3 S.OFFSET={offset}", head="%T\nN10 G18 G90 M04 S400\nG00 X36 Z105\n")
    sense_less = Pass(bench, 4, 3.0, sense=-1).phase(2.0, 54.0)
    assert apart(-offset, sense_less) == pytest.approx(0.0, abs=0.002)


def test_the_pitch_is_right_behind_the_run_up_and_up_to_the_run_out():
    bench = cut(THREAD)
    assert texts(bench) == [RUN_UP]
    cut_part = Pass(bench, 4, 1.5)
    assert cut_part.error(0.1415, 57.0 - 0.1415) < 1e-6
    assert cut_part.way[-1] == pytest.approx(57.0, abs=1e-3)
    assert bench.column("z", "set_position")[-1] == 48.0


def test_taper_and_face():
    bench = cut("G33 Z75 X26 K1.5\nG00 X40\nG33 X10 I2 S.OFFSET=90")
    taper, along_x = Pass(bench, 4, 1.5), Pass(bench, 4, 0.5, axis="x")
    assert max(taper.error(1.0, 29.0), along_x.error(1.0 / 3.0, 29.0 / 3.0)) < 1e-6
    face = Pass(bench, 6, 2.0, axis="x")
    assert face.error(1.0, 29.0) < 1e-6
    assert apart(90.0, face.phase(1.0, 29.0)) == pytest.approx(0.0, abs=0.002)


# disturbances


@pytest.mark.parametrize("milliseconds", [3, *long([0, 7])])
def test_a_speed_that_dips_by_10_percent(milliseconds):
    at = 3.0 + milliseconds / 1000.0
    scenario = f"- {{at: {at}, to: s, do: set_override, percent: 90}}\n- {{at: {at + 1.5}, to: s, do: set_override, percent: 100}}"
    bench = cut(THREAD, scenario)
    assert Pass(bench, 4, 1.5).error(1.0, 56.0) < 0.005
    assert Pass(bench, 4, 1.5, actual=True).error(1.0, 56.0) < 0.010
    assert column(bench, "s", "actual_speed_rpm")[3400:4400].max() < 361.0


def test_random_overrides_of_the_spindle():
    """Every 50 ms another override from 80 to 115 %: the path stays at the spindle, the axes within their limits."""
    source = random.Random(33)
    changes = [(2.0 + 0.05 * n, source.uniform(80.0, 115.0)) for n in range(60)]
    scenario = "\n".join(f"- {{at: {at:.3f}, to: s, do: set_override, percent: {p:.1f}}}" for at, p in changes)
    bench = cut("G33 Z48 K2", scenario)
    assert Pass(bench, 4, 2.0).error(1.0, 56.0) < 0.01


@pytest.mark.long
@pytest.mark.parametrize("count", [1, 4, 25])
def test_other_block_lengths(count):
    bench = cut(THREAD, machine=replace(LATHE, block_cycles=count))
    assert Pass(bench, 4, 1.5).error(1.0, 56.0) < 1e-6


def test_axes_that_act_later_than_their_setpoints_are_ahead_by_that():
    axes = {n: replace(a, control=replace(a.control, path_delay_cycles=3)) for n, a in LATHE.axes.items()}
    bench = cut(THREAD + BACK + "M03 S800\n" + THREAD, machine=replace(LATHE, axes=axes))
    for line, rpm in ((4, 400.0), (9, 800.0)):
        ahead = -apart(0.0, Pass(bench, line, 1.5).phase(1.0, 56.0))
        assert ahead == pytest.approx(rpm * 6.0 * 0.003, abs=0.002)
        assert abs(apart(0.0, Pass(bench, line, 1.5, actual=True).phase(1.0, 56.0))) < 0.05


# chains


def test_a_chain_with_other_pitches_directions_and_angles_has_no_stop():
    chain = "G33 Z90 K1.5\nZ70 K3\nX40 Z60\nZ20 K1\nX60 Z10 I2\nZ15 K2"
    bench = cut(chain, head=HEAD.replace("S400", "S600"))
    lines = column(bench, "channel", "line")
    moving = np.hypot(column(bench, "x", "set_velocity"), column(bench, "z", "set_velocity"))
    begin, end = np.nonzero(lines == 5)[0][0], np.nonzero(lines == 9)[0][0]
    assert moving[begin:end].min() > 8.0
    # each block on its own: X and Z over the angle of the spindle, without the zones at its ends
    start, angle_before = (36.0, 105.0), 0.0
    angle = column(bench, "s", "actual_position_deg")
    zero = None
    blocks = [(4, 36, 90, 1.5, "z"), (5, 36, 70, 3, "z"), (6, 40, 60, 3, "z"), (7, 40, 20, 1, "z"), (8, 60, 10, 2, "x")]
    for line, x, z, lead, main in blocks:
        turns = abs((x - start[0]) if main == "x" else (z - start[1])) / lead * 360.0
        rows = np.nonzero(lines == line)[0]
        rows = rows[len(rows) // 3 : -len(rows) // 3]
        if zero is None:
            zero = round((angle[rows[0]] - (105.0 - bench.column("z", "set_position")[rows[0]]) / lead * 360.0) / 360.0)
        part = (angle[rows] - zero * 360.0 - angle_before) / turns
        assert column(bench, "z", "set_position")[rows] == pytest.approx(start[1] + (z - start[1]) * part, abs=1e-6)
        assert column(bench, "x", "set_position")[rows] == pytest.approx(start[0] + (x - start[0]) * part, abs=1e-6)
        start, angle_before = (x, z), angle_before + turns


@pytest.mark.parametrize("seed", [1, *long([2])])
def test_random_chains_keep_the_limits_of_the_axes_while_the_speed_changes(seed):
    source = random.Random(seed)
    x, z, blocks = 36.0, 105.0, []
    for _ in range(4):
        x, z = x + source.choice([0.0, source.uniform(-4.0, 4.0)]), z - source.uniform(8.0, 20.0)
        blocks.append(f"G33 Z{z:.3f} X{x:.3f} K{source.uniform(0.8, 3.0):.3f}")
    x += source.uniform(6.0, 12.0)
    blocks.append(f"G33 X{x:.3f} I2")
    changes = [(1.5 + 0.05 * n, source.uniform(80.0, 115.0)) for n in range(150)]
    scenario = "\n".join(f"- {{at: {at:.3f}, to: s, do: set_override, percent: {p:.1f}}}" for at, p in changes)
    bench = cut("\n".join(blocks), scenario, head=HEAD.replace("S400", f"S{source.uniform(300.0, 650.0):.1f}"))
    end = (bench.column("x", "set_position")[-1], bench.column("z", "set_position")[-1])
    assert end == (pytest.approx(x, abs=1e-3), pytest.approx(z, abs=1e-3))


def test_a_chain_of_many_blocks_that_hardly_turn():
    """More blocks than are looked at ahead; their joints are much smaller than the way of a cycle."""
    points = [(36.0 + 0.02 * np.sin(0.2 * n), 105.0 - 0.5 * n) for n in range(1, 101)]
    bench = cut("G33 K1\n" + "\n".join(f"Z{z:.3f} X{x:.4f}" for x, z in points))
    assert [text.split()[0] for text in texts(bench)] == ["22085"]
    moving = abs(column(bench, "z", "set_velocity"))
    lines = column(bench, "channel", "line")
    assert moving[(lines > 6) & (lines < 104)].min() > 6.6
    assert bench.column("z", "set_position")[-1] == 55.0


def test_single_block_stops_behind_a_chain_but_not_within_it():
    scenario = "- {at: 0, to: channel, do: single_block, enabled: true}\n" + "".join(
        f"- {{at: {at}, to: channel, do: start}}\n" for at in (1, 2, 3, 8, 9)
    )
    bench = cut("G33 Z90 K1.5\nZ70 K3\nG00 X40", scenario)
    lines, states = column(bench, "channel", "line"), column(bench, "channel", "state")
    stopped = {int(line) for line, state in zip(lines, states, strict=True) if state == C.STOPPED}
    assert stopped == {2, 3, 5, 6}


def test_exact_stop_of_g60_does_not_stop_within_a_chain():
    bench = cut("G60\nG33 Z90 K1.5\nZ70 K3")
    moving = abs(column(bench, "z", "set_velocity"))[column(bench, "channel", "line") == 6]
    assert moving[:100].min() > 5.0


# override and feed hold


def test_feed_hold_and_path_override_act_behind_the_thread():
    held = "- {at: 3.0, to: channel, do: feed_hold, enabled: true}\n- {at: 9.0, to: channel, do: feed_hold, enabled: false}"
    bench = cut(THREAD + "\nG00 X40", held)
    assert texts(bench) == [
        RUN_UP,
        "22086 channel channel: feed hold has no effect within a thread, it counts behind it (line 4)",
    ]
    assert Pass(bench, 4, 1.5).error(1.0, 56.0) < 1e-6
    x = column(bench, "x", "set_position")
    assert x[8990] == 36.0
    assert x[-1] == 40.0
    half = cut(THREAD, "- {at: 3.0, to: channel, do: set_override, percent: 50}")
    text = "22086 channel channel: path override 50 % has no effect within a thread, it counts behind it (line 4)"
    assert texts(half) == [RUN_UP, text]
    assert half.column("z", "set_position") == cut(THREAD).column("z", "set_position")


def test_a_feed_hold_before_the_start_keeps_the_thread_from_beginning():
    bench = cut(
        THREAD,
        "- {at: 1.2, to: channel, do: feed_hold, enabled: true}\n- {at: 3.0, to: channel, do: feed_hold, enabled: false}",
    )
    assert set(bench.column("z", "set_position")[1300:2990]) == {105.0}
    assert C.HOLD in bench.column("channel", "state")[1300:2990]
    assert bench.column("z", "set_position")[-1] == 48.0


def test_override_0_of_the_spindle_lets_the_thread_wait_before_it_begins():
    scenario = "- {at: 1.0, to: s, do: set_override, percent: 0}\n- {at: 3.0, to: s, do: set_override, percent: 100}"
    bench = cut(THREAD, scenario)
    assert set(bench.column("z", "set_position")[1300:2990]) == {105.0}
    assert bench.column("z", "set_position")[-1] == 48.0


# what breaks a thread off

HELD = "51109 channel channel: spindle s is held by override 0 within a thread (G33) in test.nc line 4 'G33 Z48 K1.5'"
STOPPING = "51109 channel channel: spindle s is in Stopping within a thread (G33) in test.nc line 4 'G33 Z48 K1.5'"
FAILED = "22012 channel channel: s is in error P-ERR-24011"
RESET = "22087 channel channel: reset within a thread"
RETRACTS = "axis X retracts by 5 mm while the path follows spindle s, then the path stops"
FOLLOWS = "the path follows spindle s to its standstill in the thread"
STOPS = "the path stops on its ramp in the thread"


@pytest.mark.parametrize(
    ("command", "reason", "without"),
    [
        ("to: s, do: set_override, percent: 0", HELD, FOLLOWS),
        ("to: s, do: stop", STOPPING, FOLLOWS),
        ("to: s, do: power, enabled: false", FAILED, FOLLOWS),
        ("to: channel, do: reset", RESET, STOPS),
    ],
)
@pytest.mark.parametrize("retracts", [True, False])
def test_what_ends_a_thread_before_its_end(command, reason, without, retracts):
    bench = cut(THREAD, f"- {{at: 3.0, {command}}}", LATHE if retracts else NO_RETRACT)
    effect = (RETRACTS if retracts else without) + ("" if reason is RESET else " and the program is aborted")
    assert texts(bench, [51109, 22012, 22087]) == [f"{reason}; {effect}"]
    assert bench.column("x", "set_position")[-1] == (41.0 if retracts else 36.0)
    z = column(bench, "z", "set_position")
    assert 48.0 < z[-1] < 89.0
    if retracts or without is FOLLOWS:  # in step with the spindle while the tool is in the groove
        x = column(bench, "x", "set_position")
        inside = (column(bench, "channel", "line") == 4) & (105.0 - z > 1.0) & (x < 37.0)
        inside &= abs(column(bench, "s", "actual_speed_rpm")) > 5.0
        phases = column(bench, "s", "actual_position_deg")[inside] - (105.0 - z[inside]) * 240.0
        assert abs(phases - np.median(phases)).max() * 1.5 / 360.0 < 0.005


@pytest.mark.parametrize(("command", "end"), [("X-4", 32.0), ("OFF", 36.0), ("X[2 * 3]", 42.0), ("Z3", 36.0)])
def test_a_program_says_how_the_tool_leaves_its_threads(command, end):
    """In a bore towards the centre; the path follows the spindle meanwhile as with the retract of the machine."""
    bench = cut(f"#THREAD RETRACT {command}\n{THREAD}", "- {at: 3.0, to: channel, do: reset}")
    axis, way = ("Z", 3.0) if command == "Z3" else ("X", end - 36.0)
    does = f"axis {axis} retracts by {way:g} mm while the path follows spindle s, then the path stops"
    if command == "OFF":
        does = STOPS
    assert texts(bench, [22087]) == [f"{RESET}; {does}"]
    assert bench.column("x", "set_position")[-1] == pytest.approx(end, abs=1e-9)
    whole = cut(THREAD)
    gone = column(bench, "z", "set_position")[3050:3060] - column(whole, "z", "set_position")[3050:3060]
    assert abs(gone).max() < 1e-9 or command in ("OFF", "Z3")


def test_a_retract_of_the_program_is_for_its_own_threads():
    """The next program has that of the machine again; a retract of 0 is none."""
    scenario = "- {at: 3.0, to: channel, do: reset}\n- {at: 4.0, to: channel, do: mdi, text: V.P.A = 1}"
    assert texts(cut(f"#THREAD RETRACT X0\n{THREAD}", scenario), [22087]) == [f"{RESET}; {STOPS}"]
    assert refusal("#THREAD RETRACT X-50\n" + THREAD).startswith("22089 test.nc line 5")
    assert texts(cut(THREAD, scenario), [22087]) == [f"{RESET}; {RETRACTS}"]


def test_a_retract_of_an_axis_of_the_thread_keeps_its_limits():
    bench = cut("G33 Z60 X10 K5", "- {at: 1.9, to: channel, do: reset}")
    assert bench.column("x", "set_position")[-1] > 27.0


def test_a_retract_axis_that_has_failed_does_not_retract():
    bench = cut(THREAD, "- {at: 3.0, to: x, do: power, enabled: false}")
    assert texts(bench, [22012]) == [
        f"22012 channel channel: x is in error P-ERR-23010; {STOPS} and the program is aborted"
    ]


LOST_PLC = "no block of 'plc' came within the watchdog time"


def test_a_spindle_that_no_longer_reports():
    """The retract goes on at the last speed that is known."""
    bench = MachineBench(HEAD + THREAD + "\nM30\n", machine=LATHE, end_when_idle=False).run(3.0)
    bench.give("channel", "upstream_lost", source="s")
    for _ in range(100):
        bench.offline._blocks.pop("s")
        bench.run(0.01)
    assert_within_limits(bench)
    lost = "26101 channel channel: no block of 's' came within the watchdog time"
    assert texts(bench)[-1] == f"{lost}; {RETRACTS} and the program is aborted"
    assert bench.column("x", "set_position")[-1] == 41.0
    assert bench.column("z", "set_velocity")[3005:3040] == pytest.approx([-10.0] * 35)


@pytest.mark.parametrize(("lost", "does"), [("x", STOPS), ("z", RETRACTS)])
def test_an_axis_that_no_longer_reports(lost, does):
    """It cannot retract; another one can."""
    bench = MachineBench(HEAD + THREAD + "\nM30\n", machine=LATHE, end_when_idle=False).run(3.0)
    bench.give("channel", "upstream_lost", source=lost)
    bench.run(2.0)
    assert_within_limits(bench)
    text = (
        f"26101 channel channel: no block of '{lost}' came within the watchdog time; {does} and the program is aborted"
    )
    assert texts(bench)[-1] == text
    assert bench.column("x", "set_position")[-1] == (36.0 if lost == "x" else 41.0)


def test_without_a_plc_the_thread_retracts():
    """Its axes stay on the path, which follows the spindle on its ramp."""
    bench = MachineBench(HEAD + THREAD + "\nM30\n", machine=LATHE, end_when_idle=False).run(3.0)
    for unit in ("x", "z", "s", "channel"):
        bench.give(unit, "upstream_lost", source="plc")
    bench.run(2.0)
    assert_within_limits(bench)
    assert bench.column("x", "set_position")[-1] == 41.0
    assert f"26101 channel channel: {LOST_PLC}; {RETRACTS} and the program is aborted" in texts(bench)
    assert [text for text in texts(bench) if " axis x: " in text] == [
        f"26101 axis x: {LOST_PLC}; the axis stops with its path",
        f"26101 axis x: {LOST_PLC}; the axis stops on its own ramp (ErrorStop)",
    ]


def test_a_reset_while_the_thread_waits_moves_nothing():
    bench = cut(THREAD, "- {at: 1.2, to: channel, do: reset}")
    assert texts(bench, [22087]) == []
    assert bench.column("z", "set_position")[-1] == 105.0


# refused before cutting

NOT_BEGUN = "the thread is not begun and the program is aborted"


@pytest.mark.parametrize(
    ("text", "machine", "error"),
    [
        (
            "G33 Z104.9 K1.5",
            LATHE,
            "22083 channel channel: block 1 of the thread is 0.183 mm too short at 400 rpm: run-up 0.141 mm and"
            " run-out 0.141 mm need more than its 0.100 mm in test.nc line 4 'G33 Z104.9 K1.5'",
        ),
        (
            "G33 Z100 K1.5\nZ99.99 K3\nZ90 K1.5",
            LATHE,
            "22083 channel channel: block 2 of the thread is 1.079 mm too short at 400 rpm: joint 0.544 mm and"
            " joint 0.544 mm need more than its 0.010 mm in test.nc line 4 'G33 Z100 K1.5'",
        ),
        (
            "G33 Z48 K3",
            lathe(thread_run_up=0.3),
            "22084 channel channel: the run-up of the thread takes 0.400 mm, 0.100 mm more than the 0.3 mm in which"
            " it may be out of pitch (P-CHAN-90025) in test.nc line 4 'G33 Z48 K3'",
        ),
    ],
)
def test_a_thread_without_room_is_not_begun(text, machine, error):
    """The program does not know the speed of a spindle that the PLC has started."""
    scenario = "- {at: 0, to: s, do: start, speed_rpm: 400, direction: cw}"
    bench = cut(text, scenario, machine=machine, head=HEAD.replace(" M03 S400", "") + "G04 1\n")
    assert texts(bench) == [f"{error.replace('line 4', 'line 5')}; {NOT_BEGUN}"]
    assert bench.column("z", "set_position")[-1] == 105.0


@pytest.mark.parametrize(
    ("text", "machine", "error"),
    [
        (
            "G33 Z104.9 K1.5",
            LATHE,
            "22083 test.nc line 4 column 1 'G33 Z104.9 K1.5': block 1 of the thread is 0.183 mm too short at 400 rpm:"
            " run-up 0.141 mm and run-out 0.141 mm need more than its 0.100 mm",
        ),
        (
            "G33 Z100 K1.5\nZ99.99 K3\nZ90 K1.5\nG00 X40",
            LATHE,
            "22083 test.nc line 4 column 1 'G33 Z100 K1.5': block 2 of the thread is 1.079 mm too short at 400 rpm:"
            " joint 0.544 mm and joint 0.544 mm need more than its 0.010 mm",
        ),
        (
            "G33 Z48 K3",
            lathe(thread_run_up=0.3),
            "22084 test.nc line 4 column 1 'G33 Z48 K3': the run-up of the thread takes 0.400 mm, 0.100 mm more than"
            " the 0.3 mm in which it may be out of pitch (P-CHAN-90025)",
        ),
        (
            "G00 X196\nG33 Z60 K2\nG33 X194 Z50",
            LATHE,
            "22089 test.nc line 5 column 1 'G33 Z60 K2': axis X could not retract by 5 mm from the thread:"
            " 201 mm lies beyond the soft limit 200 mm",
        ),
        (
            "G33 Z60 X-8 K5",
            lathe(thread_retract=-5.0),
            "22089 test.nc line 4 column 1 'G33 Z60 X-8 K5': axis X could not retract by -5 mm from the thread:"
            " -13 mm lies beyond the soft limit -10 mm",
        ),
    ],
)
def test_a_thread_without_room_is_refused_when_the_program_is_read(text, machine, error):
    """By the start of the program, and by `cnc_ptp check`, which goes on behind it."""
    assert refusal(text, machine) == error
    program = f"{HEAD}{text}\nG00 X100\nM30\n"
    assert read_errors(program, machine) == [error]


def test_two_threads_are_read_apart():
    """Each with its own start: what is short in the second one is told of it; without a retract no limit counts."""
    second = "G33 Z48 K1.5\nG00 X40\nZ105\nX36\nG33 Z104.9 K1.5"
    assert refusal(second).startswith("22083 test.nc line 8 column 1 'G33 Z104.9 K1.5': block 1 of the thread")
    offset = "G33 Z90 K1.5\nG33 Z89.9 S.OFFSET=180"
    assert refusal(offset).startswith("22083 test.nc line 5 column 1 'G33 Z89.9 S.OFFSET=180': block 1 of the thread")
    assert texts(cut("G00 X199\nG33 Z60 K2", machine=NO_RETRACT), [22089]) == []


@pytest.mark.parametrize("between", ["M00", "#FLUSH WAIT", "G04 0.1", "#EXPL SYN"])
def test_blocks_behind_which_the_path_may_stop_join_no_threads(between):
    """Together they would be 0.094 mm too short (22083); one after the other each has its room."""
    text = f"G33 Z100 K1.5\n{between}\nG33 Z99.15 K3"
    assert read_errors(f"{HEAD}{text}\nM30\n") == []
    assert read_errors(f"{HEAD}{text.replace(between, '')}\nM30\n")[0].startswith("22083 test.nc line 4 column 1")


def test_an_error_of_one_thread_is_not_one_of_the_next():
    head = HEAD.replace("Z105", "Z200").replace("S400", "S500")
    [error] = read_errors(f"{head}G33 Z100 K100\nG33 Z-20 K30\nM30\n")
    assert error.startswith("22082 test.nc line 4 column 1 'G33 Z100 K100'")


def read_errors(program: str, machine=LATHE) -> list[str]:
    found = ProgramCheck.of_first_channel(machine, "test.nc").errors(program, "test.nc")
    return [f"{each.number} {str(each).partition(' ')[2]}" for each in found]


def test_a_spindle_that_nobody_has_started():
    bench = cut(THREAD, head=HEAD.replace(" M03 S400", ""))
    reason = "spindle s does not turn for the thread (G33), it is in Standstill in test.nc line 4 'G33 Z48 K1.5'"
    assert texts(bench) == [f"22080 channel channel: {reason}; {NOT_BEGUN}"]


def test_a_spindle_that_the_plc_has_started():
    scenario = "- {at: 0, to: s, do: start, speed_rpm: 400, direction: cw}"
    bench = cut(THREAD, scenario, head=HEAD.replace(" M03 S400", ""))
    assert Pass(bench, 4, 1.5).error(1.0, 56.0) < 1e-6


def test_a_spindle_of_the_plc_that_is_too_fast():
    scenario = "- {at: 0, to: s, do: start, speed_rpm: 3000, direction: cw}"
    bench = cut("G33 Z48 K20", scenario, head=HEAD.replace(" M03 S400", "") + "G04 1\n")
    reason = "a thread with 20 mm per revolution at 3000 rpm needs 1000 mm/s of axis Z, its limit is 400 mm/s"
    assert texts(bench) == [
        f"22082 channel channel: {reason} (P-AXIS-00212) in test.nc line 5 'G33 Z48 K20'; {NOT_BEGUN}"
    ]


def refusal(text: str, machine=LATHE) -> str:
    bench = MachineBench(HEAD + text + "\nM30\n", machine=machine).run()
    whole = next(f"{record.error_id} {record.message}" for record in bench.records if not record.accepted)
    assert whole.endswith("; nothing was started")
    return whole.removesuffix("; nothing was started")


def test_what_is_refused_when_the_program_is_read():
    fast = "a thread with 20 mm per revolution at 3000 rpm needs 1000 mm/s of axis Z, its limit is 400 mm/s"
    where = "test.nc line 5 column 1 'G33 Z48 K20'"
    assert refusal("S3000\nG33 Z48 K20") == f"22082 {where}: {fast} (P-AXIS-00212)"
    blind = lathe(spindle={"feedback": "SPEED"})
    assert refusal(THREAD, blind) == (
        "22081 test.nc line 4 column 1 'G33 Z48 K1.5': spindle S has no actual position (P-AXIS-00320, P-SIM-00050)"
        " and cannot lead a thread (G33)"
    )


def test_manual_blocks_are_threads_of_their_own():
    bench = MachineBench(HEAD + THREAD + "\nM30\n", machine=LATHE, end_when_idle=False).run(9.0)
    for text in ("G33 Z30 K2", "M03 S500", "G33 Z20 K2"):
        assert bench.give("channel", "mdi", text=text).accepted
        bench.run(4.0)
    assert bench.column("z", "set_position")[-1] == 20.0
    assert [text.split(":")[1] for text in texts(bench)] == [
        " thread at 400.0 rpm",
        " thread at 400.0 rpm",
        " thread at 500.0 rpm",
    ]


def test_time_of_a_program_with_a_thread():
    bench = cut(THREAD)
    shares = [block.progress for block in bench.blocks["channel"]]
    assert shares == sorted(shares)
    half = next(block for block in bench.blocks["channel"] if block.first_cycle >= 4000)
    last = max(block.first_cycle for block in bench.blocks["channel"] if not block.done)
    assert half.time_left == pytest.approx((last - 4000) * 0.001, abs=0.05)


# a lead that changes


@pytest.mark.parametrize(("code", "lead", "change"), [("G34", 1.5, 0.1), ("G35", 4.0, -0.1)])
def test_a_lead_that_changes_with_each_revolution(code, lead, change):
    bench = cut(f"{code} Z48 K{lead} F{abs(change)}")
    cut_part = Pass(bench, 4, lead)
    inside = (cut_part.way > 2.0) & (cut_part.way < 54.0)
    way = cut_part.way[inside]
    turns = (np.sqrt(lead**2 + 2.0 * change * way) - lead) / change
    phases = cut_part.angle[inside] - 360.0 * turns
    assert phases == pytest.approx(360.0 * round(phases[0] / 360.0), abs=0.002)
    assert bench.column("z", "set_position")[-1] == 48.0


def test_a_chain_with_leads_that_change():
    bench = cut("G33 Z90 K1.5\nG34 Z70 K1.5 F0.3\nG33 Z30 K4\nG35 Z20 K4 F0.5\nG33 X60 I2")
    lines = column(bench, "channel", "line")
    moving = np.hypot(column(bench, "x", "set_velocity"), column(bench, "z", "set_velocity"))
    begin, end = np.nonzero(lines == 5)[0][0], np.nonzero(lines == 8)[0][0]
    assert moving[begin:end].min() > 8.0
    assert (bench.column("x", "set_position")[-1], bench.column("z", "set_position")[-1]) == (60.0, 20.0)


def test_a_lead_that_changes_too_fast():
    """Of a spindle whose speed the program does not know, and when the program is read."""
    change = "a lead that changes by 6 mm per revolution at 1500 rpm needs 3750 mm/s² of axis Z, it may take 600 mm/s²"
    scenario = "- {at: 0, to: s, do: start, speed_rpm: 1500, direction: cw}"
    bench = cut("G34 Z95 K2 F6", scenario, head=HEAD.replace(" M03 S400", "") + "G04 1\n")
    assert texts(bench) == [f"22088 channel channel: {change} in test.nc line 5 'G34 Z95 K2 F6'; {NOT_BEGUN}"]
    assert refusal("S1500\nG34 Z95 K2 F6") == f"22088 test.nc line 5 column 1 'G34 Z95 K2 F6': {change}"
