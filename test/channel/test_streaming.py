"""Programs that are read, checked and interpreted while they run: faults ahead, a slow interpreter, progress, memory."""

from __future__ import annotations

import math
import random
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from long_support import long
from machine_support import MachineBench, assert_axes_smooth, machine
from replay_support import bits, replay
from shapely import LineString

from cnc_ptp.channel.block_stream import BUFFER
from cnc_ptp.channel.channel_unit import ChannelUnit
from cnc_ptp.errors import CncError
from cnc_ptp.machine.run_entries import check_program, read_entries
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.protocol.blocks import Event

CHORDS = 1500
"""Of 0.05 mm on a circle of 30 mm, at F6000."""
BEGIN = ["#HSC ON [BSPLINE PATH_DEV=0.005]", "F6000"]
GOOD = 703
"""Line of the last good block before the bad one."""


def streaming(**channel: Any) -> MachineParameters:
    """The mill; every program is read while it runs."""
    return machine(channel={"checked_text": 0, **channel})


def chord(n: int) -> tuple[float, float]:
    angle = n * 0.05 / 30.0
    return round(30.0 * math.sin(angle), 3), round(30.0 - 30.0 * math.cos(angle), 3)


def contour(*, bad: str = "", begin: list[str] | None = None, chords: int = CHORDS) -> str:
    lines = [f"G01 X{x:.3f} Y{y:.3f}" for x, y in map(chord, range(1, chords + 1))]
    if bad:
        lines.insert(700, bad)
    return "\n".join(["%P", *(begin or BEGIN), *lines, "#HSC OFF", "M30"])


def path(bench: MachineBench) -> list[tuple[float, float]]:
    return list(zip(bench.column("x", "set_position"), bench.column("y", "set_position"), strict=True))


def warnings(bench: MachineBench) -> list[Event]:
    return [event for event in bench.events if event.error_id == 22036]


@pytest.mark.parametrize(
    ("bad", "text"),
    [
        ("X[1/0]", "20396 {place}4 'X[1/0]': division by 0"),
        ("X1 Q", "21003 {place}4 'X1 Q': 'Q' is not a letter with a number"),
        ("$ENDIF", "20218 {place}1 '$ENDIF': $ENDIF without $IF before it"),
        ("LL DOWN", "21019 {place}1 'LL DOWN': unknown subroutine DOWN; known are: none"),
        (
            "$IF 1\nG01 X300.1\nX1 Q\n$ENDIF",
            "21003 test.nc line 708 column 4 'X1 Q': 'Q' is not a letter with a number",
        ),
        (
            "G01 Y-900",
            "120003 {place}1 'G01 Y-900': axis Y: -900 mm lies beyond the negative soft limit -200 mm (P-AXIS-00177)",
        ),
        (
            "#HSC ON [BSPLINE PATH_DEV=[P1 - 1]]",
            "120129 {place}31 '#HSC ON [BSPLINE PATH_DEV=[P1 - 1]]': PATH_DEV=-1 must be above 0",
        ),
        (
            "#CONTOUR MODE [DEV PATH_DEV=0]",
            "120129 {place}29 '#CONTOUR MODE [DEV PATH_DEV=0]': PATH_DEV=0 must be above 0",
        ),
        ("G02 X1 Y1 I0 J0", "20036 {place}11 'G02 X1 Y1 I0 J0': the radius of the circle is 0"),
        ("G93 G01 X1", "20008 {place}5 'G93 G01 X1': G01 without a feed: no F greater than 0 was programmed"),
        (
            "G01 X1 M55",
            "22011 {place}8 'G01 X1 M55': M55 does not exist on this machine (P-CHAN-00041). "
            "Known: M0, M1, M2, M3, M4, M5, M6, M7, M8, M9, M17, M19, M29, M30",
        ),
    ],
)
def test_a_fault_ahead_stops_the_path_at_the_end_of_the_last_good_block(bad: str, text: str) -> None:
    """On its ramp, from 100 mm/s; the functions of the good blocks have gone out."""
    begin = ["P1 = 0", *BEGIN[:1], "F6000"]
    bench = MachineBench(contour(bad=f"H7\n{bad}", begin=begin), machine=streaming()).run()
    x, y = chord(700)
    (error,) = bench.errors()
    where = f"the path stands behind line {GOOD + 2} 'H7' and the program is aborted"
    place = f"test.nc line {GOOD + 3} column "
    number, _, reason = text.format(place=place).partition(" ")
    assert error == f"P-ERR-{number} channel channel: {reason}; {where}"
    assert (bench.position("x"), bench.position("y")) == (x, y)
    assert max(bench.column("channel", "path_velocity")) == pytest.approx(100.0)
    assert bench.last("channel").blocks_done == 701 and bench.last("channel").done
    requests = [(request.kind, request.number) for block in bench.blocks["channel"] for request in block.requests]
    assert requests == [("H", 7)]
    assert_axes_smooth(bench)


def test_a_function_behind_the_last_good_motion_is_acknowledged_before_the_fault_counts() -> None:
    bench = MachineBench("G01 X5 F6000 M9\nX1 Q\nM30", machine=streaming(), end_when_idle=False).run(1.0)
    (request,) = [request for block in bench.blocks["channel"] for request in block.requests]
    assert (request.kind, request.number) == ("M", 9) and bench.position("x") == 5.0
    if request.acknowledge_needed and not bench.errors():
        assert bench.give("channel", "acknowledge", id=request.id).accepted
        bench.run(0.1)
    assert len(bench.errors()) == 1 and "the path stands behind line 1 'G01 X5 F6000 M9'" in bench.errors()[0]


def test_a_fault_in_the_first_block() -> None:
    bench = MachineBench("%P\nX1 Q\nM30", machine=streaming()).run()
    reason = "column 4 'X1 Q': 'Q' is not a letter with a number"
    effect = "nothing has moved and the program is aborted"
    assert bench.errors() == [f"P-ERR-21003 channel channel: test.nc line 2 {reason}; {effect}"]
    without_name = MachineBench("X1 Q\nM30", machine=streaming()).run()
    assert without_name.refusals()[0] == f"P-ERR-21003 test.nc line 1 {reason}; nothing was changed"


def test_after_a_fault_and_reset_the_next_program_runs() -> None:
    bench = MachineBench(contour(bad="X1 Q"), machine=streaming(), end_when_idle=False).run(2.0)
    assert len(bench.errors()) == 1
    assert bench.give("channel", "reset").accepted
    assert bench.give("channel", "load", program="b.nc", text="G00 X1 Y1\nM30").accepted
    assert bench.give("channel", "start").accepted
    bench.run(2.0)
    assert (bench.position("x"), bench.position("y")) == (1.0, 1.0) and len(bench.errors()) == 1


def test_a_million_blocks_start_at_once_and_the_missing_feed_stops_the_path() -> None:
    """F is missing in line 1002, behind rapid motions."""
    rapid = [f"G00 X{0.01 * (n % 2):.2f}" for n in range(1, 1001)]
    text = "\n".join(["%P", *rapid, *["G01 X10"] * 1_000_000, "M30"])
    bench = MachineBench(text, machine=machine(channel={"checked_text": 1_000_000}), start=False, end_when_idle=False)
    bench.run(0.01)
    assert bench.give("channel", "start").accepted
    unit = bench.units["channel"]
    assert isinstance(unit, ChannelUnit)
    bench.run(0.01)
    assert bench.last("channel").line[-1] == 2
    while not bench.errors():
        bench.run(1.0)
    reason = "line 1002 column 1 'G01 X10': G01 without a feed: no F greater than 0 was programmed"
    effect = "the path stands behind line 1001 'G00 X0.00' and the program is aborted"
    assert bench.errors() == [f"P-ERR-20008 channel channel: test.nc {reason}; {effect}"]
    assert bench.position("x") == 0.0


# the interpreter is slow


@pytest.mark.parametrize("blocks_per_cycle", [1, *long([2])])
def test_a_path_that_gets_too_few_blocks_is_the_same_and_slower(blocks_per_cycle: int) -> None:
    """Every point is on the path of a run that knows all blocks; 0.05 mm per cycle and block are 50 mm/s."""
    fast = MachineBench(contour()).run()
    slow = MachineBench(contour(), machine=streaming(blocks_per_cycle=blocks_per_cycle)).run()
    assert slow.errors() == [] and warnings(fast) == []
    assert_axes_smooth(slow)
    whole = LineString(path(fast))
    assert shapely.distance(whole, shapely.points(path(slow))).max() <= 1e-4
    assert path(slow)[-1] == chord(CHORDS) and slow.last("channel").blocks_done == CHORDS + 1
    moving = np.count_nonzero(slow.column("channel", "path_velocity"))
    assert moving >= (CHORDS / blocks_per_cycle) * 0.7
    assert max(slow.column("channel", "path_velocity")) <= 100.0 * (1.0 + 1e-6)


def test_a_slow_interpreter_is_told_once_until_it_has_caught_up() -> None:
    """Two contours, between them a dwell in which the buffer becomes full."""
    once = MachineBench(contour(), machine=streaming(blocks_per_cycle=1)).run()
    (warning,) = warnings(once)
    reason = "blocks for 1.59 mm are known, P-CHAN-90006 gives 1 in a cycle"
    assert warning.text == f"channel channel: the path is slower in line {warning.line}: {reason}"
    twice = MachineBench(contour(bad="G04 X2", chords=4000), machine=streaming(blocks_per_cycle=1)).run()
    assert len(warnings(twice)) == 2


@pytest.mark.parametrize("transition", ["G261", "G359"])
def test_a_line_in_many_blocks_waits_for_them(transition: str) -> None:
    """0.02 mm per cycle are 20 mm/s; F6000 asks for 100 mm/s."""
    lines = [f"G01 X{0.02 * n:.2f}" for n in range(1, 1001)]
    text = "\n".join(["#CONTOUR MODE [DEV PATH_DEV=0.01]", f"{transition} F6000", *lines, "M30"])
    bench = MachineBench(text, machine=streaming(blocks_per_cycle=1)).run()
    assert bench.errors() == [] and len(warnings(bench)) == 1
    assert bench.position("x") == 20.0
    assert_axes_smooth(bench)
    assert 950 <= np.count_nonzero(bench.column("channel", "path_velocity")) <= 1400


@pytest.mark.long
def test_override_hold_and_reset_while_the_interpreter_is_slow() -> None:
    for seed in range(10):
        draw = random.Random(seed)
        bench = MachineBench(contour(), machine=streaming(blocks_per_cycle=1), end_when_idle=False)
        for _ in range(6):
            bench.run(draw.randrange(1, 30) * 0.01)
            if draw.random() < 0.5:
                bench.give("channel", "feed_hold", enabled=draw.random() < 0.5)
            else:
                bench.give("channel", "set_override", percent=draw.choice((0.0, 20.0, 60.0, 100.0)))
        if draw.random() < 0.3:
            bench.give("channel", "reset")
        bench.give("channel", "feed_hold", enabled=False)
        bench.give("channel", "set_override", percent=100.0)
        bench.run(4.0)
        assert bench.blocks["channel"][-1].done, seed
        assert_axes_smooth(bench)


def test_the_buffer_is_filled_while_the_path_is_busy() -> None:
    bench = MachineBench(contour(), machine=streaming(), end_when_idle=False)
    unit = bench.units["channel"]
    assert isinstance(unit, ChannelUnit)
    fills, known = [], []
    for _ in range(120):
        bench.run(0.01)
        fills.append(unit.blocks_ahead[0])
        known.append(unit.blocks_ahead[1])
    assert 0.0 < max(fills[:20]) <= 100 * 20 / BUFFER and fills[-1] == 1.0
    assert all(b - a <= 100 / BUFFER + 1e-12 for a, b in pairwise(fills) if b < 1.0)
    assert 30.0 < max(known) < 60.0 and known[0] == 0.0


# the same everywhere


def test_exact_stops_take_the_same_cycles_as_when_all_is_known() -> None:
    text = "\n".join([*(f"G00 X{n % 7} Y{n % 5}" for n in range(40)), "M30"])
    known, streamed = MachineBench(text).run(), MachineBench(text, machine=streaming(blocks_per_cycle=1)).run()
    for unit in ("x", "y"):
        assert streamed.blocks[unit] == known.blocks[unit]


@pytest.mark.long
def test_two_runs_and_a_replay_are_equal_to_the_bit() -> None:
    scenario = "- {at: 0.5, to: channel, do: set_override, percent: 40}\n- {at: 0.9, to: channel, do: set_override, percent: 100}"
    parameters = streaming(blocks_per_cycle=1)
    first, second = (MachineBench(contour(), scenario, machine=parameters).run() for _ in range(2))
    assert bits(first) == bits(second) and first.events == second.events
    again = replay(parameters, first.records, len(first.blocks["plc"]))
    assert again["channel"] == bits(first)["channel"] and again["x"] == bits(first)["x"]


def test_a_motion_that_starts_late_is_told() -> None:
    """Behind it is a computation of 30,000 turns, and the path may continue in what comes then."""
    text = "%P\nF6000\nP1 = 0\nG01 X10\n$WHILE P1 < {turns}\nP1 = P1 + 1\n$ENDWHILE\nG01 X20\nM30"
    bench = MachineBench(text.format(turns=30_000), machine=streaming()).run()
    (warning,) = warnings(bench)
    reason = "the next block is still computed, P-CHAN-90006 gives 10 in a cycle"
    assert warning.text == f"channel channel: the path stands before line 4: {reason}" and warning.line == 4
    assert bench.errors() == [] and bench.position("x") == 20.0
    assert warnings(MachineBench(text.format(turns=10), machine=streaming()).run()) == []


# progress


def test_progress_is_the_share_of_the_text_and_time_left_is_not_known() -> None:
    bench = MachineBench(contour(), machine=streaming()).run()
    running = [block for block in bench.blocks["channel"] if 0 < block.blocks_done <= CHORDS]
    shares = [block.progress for block in bench.blocks["channel"]]
    assert shares == sorted(shares) and shares[0] == 0.0 and shares[-1] == 1.0
    text = contour().split("\n")
    for block in running:
        ends = len("\n".join(text[: block.blocks_done + 3])) + 1
        assert block.progress == pytest.approx(ends / len(contour()), abs=1e-9)
        assert block.time_left == -1.0 and block.blocks_total == block.blocks_done + 1
    assert bench.last("channel").time_left == 0.0 and bench.last("channel").blocks_total == CHORDS + 1


def test_in_a_loop_progress_waits_for_the_first_new_line() -> None:
    text = "G00 X1\n$FOR P1 = 1, 5, 1\nX2\nX1\n$ENDFOR\nX5\nM30"
    bench = MachineBench(text, machine=streaming()).run()
    shares = [block.progress for block in bench.blocks["channel"]]
    assert shares == sorted(shares) and shares[-1] == 1.0 and bench.position("x") == 5.0


# start at a block, files


def test_a_start_at_a_block_reads_as_far_as_that_block() -> None:
    text = "\n".join(["G00 X1", "N20 X2", "N30 X3", "X1 Q", "M30"])
    bench = MachineBench(text, machine=streaming(), start=False, end_when_idle=False).run(0.01)
    assert "there is no block N77" in MachineBench(
        "G00 X1\nM30", machine=streaming(), start=False, end_when_idle=False
    ).run(0.01).refused("channel", "start", block_number=77)
    assert bench.give("channel", "start", block_number=30).accepted
    bench.run(1.0)
    told = [event.text for event in bench.all_events if event.error_id == 22045]
    assert told == [
        "the program has more than 0 characters (P-CHAN-90005): it is checked while it runs",
        "G00: X 0 to 2",
        "continues with line 3 'N30 X3'",
    ]
    assert bench.position("x") == 3.0 and len(bench.errors()) == 1


def test_the_whole_program_is_checked_up_to_the_size_that_the_machine_permits() -> None:
    text = "G00 X1\nX1 Q\nM30"
    with pytest.raises(CncError, match=r"line 2 column 4 'X1 Q'"):
        check_program(machine(channel={"checked_text": len(text)}), text, "a.nc")
    check_program(machine(channel={"checked_text": len(text) - 1}), text, "a.nc")


def test_a_file_that_vanishes_or_changes_behind_the_load_has_no_effect(tmp_path: Path) -> None:
    """The load carries the text; a file that cannot be read, or is no text, is refused before the start."""
    file = tmp_path / "part.nc"
    file.write_text(contour())
    parameters = streaming()
    kept, gone = (read_entries(parameters, program=str(file), scenario=None) for _ in range(2))
    file.write_text("X1 Q")
    file.unlink()
    with pytest.raises(CncError) as caught:
        read_entries(parameters, program=str(file), scenario=None)
    assert str(caught.value) == (
        f"P-ERR-26110 NC program {file} cannot be read: No such file or directory; nothing was started"
    )
    file.write_bytes(b"X1 \xff\xfe")
    with pytest.raises(
        CncError, match=r"P-ERR-26110 .* cannot be read: it is not UTF-8 text, byte .* nothing was started"
    ):
        read_entries(parameters, program=str(file), scenario=None)
    assert [entry.command.arguments for entry in kept] == [entry.command.arguments for entry in gone]
    bench = MachineBench(kept[0].command.arguments["text"], machine=parameters).run()
    assert bench.errors() == [] and path(bench)[-1] == chord(CHORDS)


def test_an_axis_without_velocity_is_refused_in_the_machine_file(tmp_path: Path) -> None:
    """So no block is impossible because of a limit."""
    file = tmp_path / "m.yaml"
    mill = (Path(__file__).parents[2] / "config" / "mill.yaml").read_text()
    file.write_text(mill.replace("vb_max: 500000, a_max: 4000", "vb_max: 0, a_max: 0", 1))
    with pytest.raises(CncError) as caught:
        read_machine(file)
    for name in ("P-AXIS-00212 getriebe[0].dynamik.vb_max", "P-AXIS-00008 getriebe[0].dynamik.a_max"):
        assert f"{name} of /x: value 0 is below the minimum 1" in str(caught.value)
