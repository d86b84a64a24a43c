"""Control of programs in the channel: block skip, single block by motion, manual blocks with files, time of a program."""

from __future__ import annotations

from pathlib import Path

import pytest
from long_support import long
from machine_support import CYCLE_TIME, MILL, MachineBench, assert_axis_smooth
from replay_support import bits, replay

from cnc_ptp.machine.run_entries import add_manual_files, read_entries
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.protocol.channel_states import ChannelStateCode as C

# block skip

SKIPS = "G00 X1\n/ X2\n/2 Y2\n/10 Z2\n/1 Y3\nM30"


@pytest.mark.parametrize(
    ("levels", "position"),
    [((), (2.0, 3.0, 2.0)), ((1,), (1.0, 2.0, 2.0)), ((2, 10), (2.0, 3.0, 0.0)), ((1, 2, 10), (1.0, 0.0, 0.0))],
)
def test_blocks_with_a_level_that_is_on_are_left_out(levels: tuple[int, ...], position: tuple[float, ...]) -> None:
    bench = MachineBench(SKIPS, start=False, end_when_idle=False).run(0.1)
    for level in levels:
        assert bench.give("channel", "block_skip", enabled=True, level=level).accepted
    assert bench.give("channel", "start").accepted
    bench.run(3.0)
    assert tuple(bench.position(axis) for axis in "xyz") == position


def test_the_level_is_1_unless_another_is_given_and_can_be_switched_off_again() -> None:
    bench = MachineBench(end_when_idle=False).run(0.1)
    for enabled, x in ((True, 1.0), (False, 2.0)):
        assert bench.give("channel", "block_skip", enabled=enabled).accepted
        assert bench.give("channel", "mdi", text="G00 X1\n/ X2").accepted
        bench.run(1.0)
        assert bench.position("x") == x


def test_block_skip_counts_from_the_next_start_on() -> None:
    """The program is interpreted before it starts."""
    bench = MachineBench("G00 X30\n/ Y5\nM30", end_when_idle=False).run(0.05)
    assert bench.give("channel", "block_skip", enabled=True).accepted
    bench.run(2.0)
    assert bench.position("y") == 5.0
    assert bench.give("channel", "mdi", text="G00 Y0").accepted
    bench.run(2.0)
    assert bench.give("channel", "start").accepted
    bench.run(2.0)
    assert bench.position("y") == 0.0


@pytest.mark.parametrize("level", [0, 11, -1])
def test_a_level_that_does_not_exist(level: int) -> None:
    text = (
        f"P-ERR-22001 channel channel: block_skip refused: level = {level} is not within 1 ... 10; nothing was changed"
    )
    assert MachineBench().run(0.05).refused("channel", "block_skip", enabled=True, level=level) == text


def test_what_was_interpreted_ahead_counts_only_with_the_same_levels() -> None:
    bench = MachineBench(end_when_idle=False)
    channel = bench.units["channel"]
    channel.prepare("p.nc", SKIPS)  # type: ignore[attr-defined]
    bench.run(0.1)
    assert bench.give("channel", "load", program="p.nc", text=SKIPS).accepted
    assert bench.give("channel", "block_skip", enabled=True).accepted
    assert bench.give("channel", "start").accepted
    bench.run(3.0)
    assert bench.position("x") == 1.0


# single block

STEPS = "T1\nM3 S500\nX10\nG04 0.1\nM8\nX20 M9\nG02 X30 I5 F3000\nM5\nM30"


def stops(bench: MachineBench) -> list[int]:
    """Lines at whose end the program stops."""
    lines = []
    assert bench.give("channel", "start").accepted
    for _ in range(20):
        bench.run(1.5)
        block = bench.last("channel")
        if block.done:
            return lines
        assert block.state[-1] == C.STOPPED and block.path_velocity[-1] == 0.0
        lines.append(block.line[-1])
        assert bench.give("channel", "start").accepted
    raise AssertionError("no end")


@pytest.mark.parametrize(
    ("mode", "lines"),
    [
        ({"mode": "block"}, [1, 2, 3, 4, 5, 6, 7, 8]),
        ({"mode": "motion"}, [3, 6, 7]),
        ({}, [1, 2, 3, 4, 5, 6, 7, 8]),
    ],
)
def test_single_block_stops_behind_blocks_or_motions(mode: dict[str, str], lines: list[int]) -> None:
    bench = MachineBench(STEPS, start=False, end_when_idle=False).run(0.1)
    assert bench.give("channel", "single_block", enabled=True, **mode).accepted
    assert stops(bench) == lines and bench.errors() == []


def test_single_block_is_switched_on_and_off_in_mid_program() -> None:
    bench = MachineBench("G60 X10\nT1\nX20\nX30\nM30", end_when_idle=False).run(0.05)
    assert bench.give("channel", "single_block", enabled=True, mode="motion").accepted
    bench.run(2.0)
    assert (bench.position("x"), bench.last("channel").state[-1]) == (10.0, C.STOPPED)
    assert bench.give("channel", "single_block", enabled=False).accepted
    assert bench.give("channel", "start").accepted
    bench.run(2.0)
    assert bench.position("x") == 30.0 and bench.last("channel").done


STRAIGHT = 'G01 F3000 X10\nX20\n#MSG ["at 20"]\nX30\nX40\nM30'
"""One path: nothing stops between its blocks."""


@pytest.mark.parametrize("mode", ["block", "motion"])
def test_single_block_halts_a_path_exactly_at_the_ends_of_its_blocks(mode: str) -> None:
    bench = MachineBench(STRAIGHT, end_when_idle=False).run(0.1)
    assert 0.0 < bench.position("x") < 10.0
    assert bench.give("channel", "single_block", enabled=True, mode=mode).accepted
    bench.run(1.0)
    for place, line in ((10.0, 1), (20.0, 2)):
        assert bench.position("x") == pytest.approx(place, abs=1e-9)
        assert (bench.last("channel").state[-1], bench.last("channel").line[-1]) == (C.STOPPED, line)
        assert bench.give("channel", "start").accepted
        bench.run(1.0)
    if mode == "block":  # the message is a block, too
        assert bench.give("channel", "start").accepted
        bench.run(1.0)
    assert [event.text for event in bench.events_of("channel")] == ["at 20"]
    assert bench.position("x") == pytest.approx(30.0, abs=1e-9) and bench.last("channel").line[-1] == 4
    assert bench.give("channel", "single_block", enabled=False).accepted
    assert bench.give("channel", "start").accepted
    bench.run(1.0)
    assert bench.position("x") == 40.0 and bench.last("channel").done
    axis = MILL.axes["x"]
    assert_axis_smooth(bench.blocks["x"], acceleration=axis.deceleration, jerk=axis.jerk * (1 + 1e-6))


def test_single_block_that_comes_too_late_for_a_block_halts_behind_the_next() -> None:
    bench = MachineBench("G01 F6000 X100\nX110\nX200\nX300\nM30", end_when_idle=False).run(1.03)
    assert 96.0 < bench.position("x") < 100.0
    assert bench.give("channel", "single_block", enabled=True).accepted
    bench.run(2.0)
    assert bench.position("x") == pytest.approx(110.0, abs=1e-9) and bench.last("channel").state[-1] == C.STOPPED


@pytest.mark.parametrize("off", [0.2, *long([0.05, 0.4])])
def test_single_block_that_is_switched_off_leaves_no_stop(off: float) -> None:
    """20 mm/s; X10 is reached at about 0.5 s, and the path has begun to brake for it at 0.4 s at most."""
    bench = MachineBench("G01 X10 F1200\nX20\nX30\nM30", end_when_idle=False).run(0.03)
    assert bench.give("channel", "single_block", enabled=True).accepted
    bench.run(off)
    assert bench.give("channel", "single_block", enabled=False).accepted
    bench.run(4.0)
    moving = [
        v
        for v, x in zip(bench.column("channel", "path_velocity"), bench.column("x", "set_position"), strict=True)
        if 5.0 < x < 25.0
    ]
    assert min(moving) == pytest.approx(20.0, abs=1e-6) and bench.last("channel").done


def test_a_path_that_has_halted_can_be_held_and_aborted() -> None:
    bench = MachineBench(STRAIGHT, end_when_idle=False).run(0.1)
    assert bench.give("channel", "single_block", enabled=True).accepted
    bench.run(1.0)
    assert bench.give("channel", "feed_hold", enabled=True).accepted
    assert bench.give("channel", "start").accepted
    bench.run(0.2)
    assert bench.position("x") == pytest.approx(10.0, abs=1e-9)
    assert bench.give("channel", "feed_hold", enabled=False).accepted
    bench.run(1.0)
    assert bench.position("x") == pytest.approx(20.0, abs=1e-9)
    assert bench.give("channel", "reset").accepted
    bench.run(0.5)
    assert bench.position("x") == pytest.approx(20.0, abs=1e-9) and bench.last("channel").state[-1] == C.READY


def test_single_block_that_is_switched_off_again_does_not_stop_the_path() -> None:
    bench = MachineBench("G01 X10 F600\nX20\nX30\nM30", end_when_idle=False).run(0.1)
    assert bench.give("channel", "single_block", enabled=True).accepted
    bench.run(0.02)
    assert bench.give("channel", "single_block", enabled=False).accepted
    bench.run(4.0)
    assert bench.position("x") == 30.0 and bench.last("channel").done


def test_single_block_at_rest_in_feed_hold_counts_from_there() -> None:
    bench = MachineBench(STRAIGHT, end_when_idle=False).run(0.1)
    assert bench.give("channel", "feed_hold", enabled=True).accepted
    bench.run(0.5)
    assert bench.position("x") < 10.0
    assert bench.give("channel", "single_block", enabled=True).accepted
    assert bench.give("channel", "feed_hold", enabled=False).accepted
    bench.run(1.0)
    assert bench.position("x") == pytest.approx(10.0, abs=1e-9) and bench.last("channel").state[-1] == C.STOPPED


def test_a_mode_that_does_not_exist() -> None:
    text = (
        "P-ERR-22001 channel channel: single_block refused: mode = 'step' is not block or motion; nothing was changed"
    )
    assert MachineBench().run(0.05).refused("channel", "single_block", enabled=True, mode="step") == text


# manual blocks

OWN = "G91 X5\nG90\nM29"


def test_manual_blocks_have_the_full_language_and_call_files() -> None:
    bench = MachineBench(end_when_idle=False).run(0.1)
    text = "#VAR\nV.P.N = 3\n#ENDVAR\n$FOR P1 = 1, V.P.N, 1\nL own.nc\n$ENDFOR\n$IF V.P.N == 3\nY[P1]\n$ENDIF"
    assert bench.give("channel", "mdi", text=text, files={"own.nc": OWN}).accepted
    bench.run(4.0)
    assert bench.errors() == [] and bench.position("x") == 15.0 and bench.position("y") == 4.0


def test_a_called_file_goes_before_one_of_the_loaded_program() -> None:
    bench = MachineBench(end_when_idle=False).run(0.1)
    text = "L own.nc\nM30"
    assert bench.give("channel", "load", program="a.nc", text=text, files={"own.nc": "X1\nM29"}).accepted
    for files, x in (({}, 1.0), ({"files": {"own.nc": "X7\nM29"}}, 7.0)):
        assert bench.give("channel", "mdi", text="L own.nc", **files).accepted
        bench.run(1.0)
        assert bench.position("x") == x


def test_faults_in_a_called_file_refuse_manual_blocks() -> None:
    bench = MachineBench(end_when_idle=False).run(0.1)
    refused = bench.refused("channel", "mdi", text="G00 X3\nL own.nc", files={"own.nc": "X[1/0]\nM29"})
    assert (
        refused
        == "P-ERR-20396 own.nc line 1 column 4 'X[1/0]': division by 0, called in mdi line 2; nothing was executed"
    )
    bench.run(0.5)
    assert bench.position("x") == 0.0


def test_files_of_manual_blocks_come_from_the_folder_of_the_program(tmp_path: Path) -> None:
    for folder, x in (("here", 1), ("there", 2)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "own.nc").write_text(f"X{x}\nM29\n")
        (tmp_path / folder / "p.nc").write_text("G04 0.01\nM30\n")
    (tmp_path / "s.yaml").write_text(
        "- {at: 0, to: channel, do: load, program: here/p.nc}\n- {at: 1, to: channel, do: mdi, text: L own.nc}\n"
        "- {at: 2, to: channel, do: load, program: there/p.nc}\n- {at: 3, to: channel, do: mdi, text: L own.nc}\n"
    )
    entries = read_entries(MILL, program=None, scenario=str(tmp_path / "s.yaml"))
    assert [e.command.arguments.get("files") for e in entries if e.command.command == "mdi"] == [
        {"own.nc": "X1\nM29\n"},
        {"own.nc": "X2\nM29\n"},
    ]
    command = Command("channel", "mdi", {"text": "L own.nc"})
    add_manual_files([command], MILL, {"channel": str(tmp_path / "there" / "p.nc")})
    assert command.arguments["files"] == {"own.nc": "X2\nM29\n"}


def test_manual_blocks_with_files_are_replayed() -> None:
    bench = MachineBench(end_when_idle=False).run(0.1)
    assert bench.give("channel", "mdi", text="L own.nc", files={"own.nc": OWN}).accepted
    bench.run(1.0)
    texts, expected = replay(MILL, bench.records, len(bench.blocks["x"])), bits(bench)
    assert [texts[name] for name in ("channel", "x")] == [expected[name] for name in ("channel", "x")]


# time of a program

TIMED = "%P\nG00 X40 Y20\nG01 X10 F4000\nG02 X20 Y30 I10 J0 F2000\nG04 0.75\nG01 Z-10 F800 #SLOPE\nM30".replace(
    " #SLOPE", ""
)


def times(bench: MachineBench) -> list[tuple[int, float, float]]:
    """Cycle behind the block, progress, time left."""
    return [(b.first_cycle + b.count, b.progress, b.time_left) for b in bench.blocks["channel"] if b.path_active]


def test_the_time_left_is_that_of_the_run() -> None:
    """Without waits the program ends at the very cycle that the first block says."""
    bench = MachineBench(TIMED).run()
    program = times(bench)
    moving = [block for block in bench.blocks["channel"] if block.path_active]
    end = moving[-1].first_cycle + moving[-1].count
    first_cycle, _, first = program[0]
    assert first_cycle * CYCLE_TIME + first == pytest.approx(end * CYCLE_TIME, abs=0.011)
    for cycle, share, left in program[:-1]:
        assert cycle * CYCLE_TIME + left == pytest.approx(first_cycle * CYCLE_TIME + first, abs=1e-9)
        assert 0.0 < share < 1.0
    shares = [share for _, share, _ in program]
    assert shares == sorted(shares) and program[-1][1:] == (1.0, 0.0)


def test_the_time_left_is_longer_with_less_override_and_not_known_with_none() -> None:
    scenario = "- {at: 0.0, to: channel, do: set_override, percent: 50}"
    half, full = MachineBench(TIMED, scenario).run(), MachineBench(TIMED).run()
    dwell = 0.75
    first, all_ = (times(bench)[0][2] for bench in (half, full))
    assert first == pytest.approx(2.0 * (all_ - dwell) + dwell, rel=0.05)
    held = MachineBench(TIMED, "- {at: 0.1, to: channel, do: feed_hold, enabled: on}", end_when_idle=False).run(1.0)
    assert held.last("channel").time_left == -1.0 and 0.0 < held.last("channel").progress < 0.2
    assert held.give("channel", "feed_hold", enabled=False).accepted
    held.run(0.1)
    assert 1.0 < held.last("channel").time_left < all_


def test_an_aborted_program_stays_where_it_was() -> None:
    bench = MachineBench(TIMED, end_when_idle=False).run(1.0)
    assert bench.give("channel", "reset").accepted
    bench.run(1.0)
    assert bench.last("channel").done and bench.last("channel").time_left == 0.0
    assert 0.1 < bench.last("channel").progress < 0.9


def test_a_program_without_motions_counts_its_blocks() -> None:
    bench = MachineBench("T1\nT2\nM00\nT3\nM30", end_when_idle=False).run(1.0)
    assert (bench.last("channel").progress, bench.last("channel").time_left) == (3 / 5, 0.0)


def test_a_program_that_depends_on_the_run_counts_its_lines() -> None:
    bench = MachineBench("G00 X10\nP1 = V.A.ACT_POS.X\nX20\nX[P1]\nX30\nM30").run()
    program = times(bench)
    shares = [share for _, share, _ in program]
    assert shares == sorted(shares) and shares[-1] == 1.0
    assert {left for _, _, left in program[:-1]} == {-1.0}
    assert set(shares) <= {line / 6 for line in range(6)} | {1.0} and len(set(shares)) >= 4


def test_the_step_slope_has_its_own_times() -> None:
    bench = MachineBench("#SLOPE [TYPE=STEP]\nG01 X50 F6000\n#SLOPE [TYPE=TRAPEZ]\nX0\nM30").run()
    program = times(bench)
    end = program[-1][0] * CYCLE_TIME
    assert program[0][0] * CYCLE_TIME + program[0][2] == pytest.approx(end, abs=0.011)


def test_the_view_names_the_line_and_who_has_called_it() -> None:
    bench = MachineBench("%L SUB\nN5 X5\nX9\nM29\n%P\nLL SUB\nLL SUB\nM30", end_when_idle=False).run(0.05)
    channel = bench.units["channel"]
    view = channel.program_view  # type: ignore[attr-defined]
    assert view == ("test.nc", False, "test.nc", "N5 X5", ("test.nc line 6",))
    bench.run(3.0)
    assert bench.give("channel", "mdi", text="G00 X1 (back)").accepted
    bench.run(0.02)
    assert channel.program_view == ("test.nc", True, "mdi", "G00 X1 (back)", ())  # type: ignore[attr-defined]
