"""Programs that are interpreted while they run: what only the run knows, long programs, variables that stay."""

from __future__ import annotations

from dataclasses import replace

import pytest
from machine_support import MILL, MachineBench, machine

from cnc_ptp.channel import program_check
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.protocol.channel_states import ChannelStateCode as C


def test_an_actual_position_is_that_of_the_instant_at_which_the_path_stands() -> None:
    bench = MachineBench("G00 X10\nP1 = V.A.ACT_POS.X\nG04 X0.5\nY[V.A.ACT_POS.X]\nZ[P1 - 10]\nM30").run()
    assert bench.errors() == []
    x, y, z = (bench.position(axis) for axis in "xyz")
    assert x == 10.0
    assert y == pytest.approx(10.0, abs=0.01)  # the drive is there after half a second
    assert -2.0 < z < -1e-3  # at the end of the motion it still lagged behind
    actual = bench.column("x", "actual_position")
    assert z + 10.0 in actual and y in actual


def test_a_program_whose_blocks_are_not_known_shows_no_total_until_its_end() -> None:
    bench = MachineBench("G00 X1\nX[V.A.ACT_POS.X + 1]\nX5\nM30").run()
    totals = [(block.blocks_done, block.blocks_total) for block in bench.blocks["channel"] if block.path_active]
    assert all(done < total < 5 for done, total in totals if done < 5) and totals[0] == (0, 1)
    assert (bench.last("channel").blocks_done, bench.last("channel").blocks_total) == (5, 5)


def test_a_fault_behind_what_only_the_run_knows_stops_the_program_when_it_is_reached() -> None:
    bench = MachineBench("G00 X1\nP1 = V.A.ACT_POS.X\nY5\nX[1/0]\nZ5\nM30").run()
    assert bench.failed
    (text,) = bench.errors()
    assert text.startswith("P-ERR-20396 channel channel: test.nc line 4 column 4 'X[1/0]': division by 0")
    assert (bench.position("x"), bench.position("y"), bench.position("z")) == (1.0, 5.0, 0.0)


def test_a_fault_that_is_known_before_refuses_the_start() -> None:
    bench = MachineBench("G00 X1\nY5\nX[1/0]\nM30").run()
    assert bench.refusals() == ["P-ERR-20396 test.nc line 3 column 4 'X[1/0]': division by 0; nothing was started"]
    assert bench.position("x") == bench.position("y") == 0.0


def test_a_long_computation_takes_its_cycles_and_no_more_at_once() -> None:
    text = "P1 = V.A.ACT_POS.X\nP2 = 0\n$FOR P3 = 1, 100000, 1\nP2 = P2 + P3\n$ENDFOR\nX[P2 / 1E9]\nM30".replace(
        "1E9", "1000000000"
    )
    bench = MachineBench(text).run()
    assert bench.errors() == [] and bench.position("x") == pytest.approx(5.00005, abs=1e-9)
    waiting = [block for block in bench.blocks["channel"] if block.path_active]
    assert len(waiting) >= 200_000 / 5000 / 10


def test_a_long_program_is_interpreted_again_while_it_runs() -> None:
    """With the same cycles as one of which every block is kept; only its time is estimated from those that are."""
    text = "\n".join([*(f"G00 X{n % 7} Y{n % 5}" for n in range(40)), "M30"])
    kept = MachineBench(text).run()
    channel = replace(MILL.channels["channel"], known_blocks=10)
    again = MachineBench(text, machine=replace(MILL, channels={"channel": channel})).run()
    for unit in ("x", "y"):
        assert again.blocks[unit] == kept.blocks[unit]
    known = dict.fromkeys(("progress", "time_left"), 0.0)
    assert [replace(b, **known) for b in again.blocks["channel"]] == [
        replace(b, **known) for b in kept.blocks["channel"]
    ]
    first, exact = again.blocks["channel"][0].time_left, kept.blocks["channel"][0].time_left
    assert first == pytest.approx(exact, rel=0.5) and first != exact
    assert (again.last("channel").progress, again.last("channel").time_left) == (1.0, 0.0)


def test_shared_variables_stay_for_the_next_program_and_others_do_not() -> None:
    bench = MachineBench("P1 = 5 V.P.A = 6 V.S.A = 7\nG00 X1\nM30", end_when_idle=False).run(1.0)
    assert bench.give("channel", "load", program="b.nc", text="G00 X[V.S.A]\nV.S.A = 8\nM30").accepted
    assert bench.give("channel", "start").accepted
    bench.run(1.0)
    assert bench.position("x") == 7.0
    assert bench.give("channel", "mdi", text="Y[V.S.A]").accepted
    bench.run(1.0)
    assert bench.position("y") == 8.0
    for name in ("P1", "V.P.A"):
        assert bench.give("channel", "load", program="c.nc", text=f"X[{name}]\nM30").accepted
        assert "P-ERR-2" in bench.refused("channel", "start")


@pytest.mark.parametrize("ends", ["reset", "error"])
def test_an_aborted_program_leaves_the_shared_variables_as_they_were(ends: str) -> None:
    """It is interpreted ahead of the path, so which of its assignments the path has reached is not known."""
    bench = MachineBench("V.S.A = 1\nM30", end_when_idle=False).run(0.1)
    stop = "" if ends == "reset" else "#ERROR [ID=7]\n"
    text = f"V.S.A = 2 V.S.B = 3\nG00 X1\nV.S.A = 4\n{stop}G01 X100 F100\nV.S.A = 5\nM30"
    assert bench.give("channel", "load", program="b.nc", text=text).accepted
    assert bench.give("channel", "start").accepted
    bench.run(0.5)
    assert bench.position("x") >= 1.0
    assert bench.give("channel", "reset").accepted
    bench.run(0.5)
    assert bench.give("channel", "mdi", text="G00 X0 Y[V.S.A]").accepted
    bench.run(1.0)
    assert bench.position("y") == 1.0
    assert "V.S.B was not declared" in bench.refused("channel", "mdi", text="X[V.S.B]")


def test_variables_of_manual_blocks_stay_for_the_next_ones_unless_they_were_refused() -> None:
    bench = MachineBench(end_when_idle=False).run(0.1)
    assert bench.give("channel", "mdi", text="P1 = 5 V.P.A = 2").accepted
    bench.run(0.1)
    assert "division by 0" in bench.refused("channel", "mdi", text="P1 = 6 V.P.A = 3\nX[1/0]")
    assert bench.give("channel", "mdi", text="X[P1 * V.P.A]").accepted
    bench.run(1.0)
    assert bench.position("x") == 10.0


def test_an_aborted_program_leaves_its_interpreter() -> None:
    bench = MachineBench(
        "P1 = V.A.ACT_POS.X\nP2 = 0\n$WHILE 1\nP2 += 1\nX[P1 + 1]\nX0\n$ENDWHILE\nM30", end_when_idle=False
    ).run(1.0)
    assert bench.last("channel").state[-1] == C.RUNNING
    assert bench.give("channel", "reset").accepted
    bench.run(0.5)
    assert bench.give("channel", "mdi", text="G00 X3").accepted
    bench.run(1.0)
    assert bench.position("x") == 3.0 and bench.errors() == []


def test_a_loop_without_an_end_that_only_the_run_shows_stops_the_path_behind_it() -> None:
    """What the program has read decides that the loop never ends."""
    text = "P1 = V.A.ACT_POS.X\n$WHILE P1 < 1\nG00 X5\nX0\n$ENDWHILE\nM30"
    bench = MachineBench(text, end_when_idle=False).run(2.0)
    reason = "a loop without an end: the program comes back with the same positions and values each time"
    (error,) = bench.errors()
    assert error.startswith(
        f"P-ERR-21583 channel channel: test.nc line 5 column 1 '$ENDWHILE': {reason}; the path stands behind"
    )
    assert bench.position("x") == 0.0


def test_two_runs_of_such_a_program_are_equal() -> None:
    text = "G00 X10\nX[V.A.ACT_POS.X * 2]\n$WHILE V.A.ACT_POS.X > 1\nX[V.A.ABS.X / 2]\n$ENDWHILE\nM30"
    first, second = MachineBench(text, machine=machine()).run(), MachineBench(text, machine=machine()).run()
    assert first.blocks == second.blocks and first.errors() == []


def test_messages_and_ordered_warnings_go_out_when_the_path_reaches_them() -> None:
    text = '#MSG ["begin"]\nG00 X1\nP1 = 2.5\n#MSG SYN HMI ["P1 is %f, or %d; 5 %%"  , P1, P1]\n#ERROR [ID=7 RC=0 PV1=P1]\nX2\nM30'
    bench = MachineBench(text).run()
    assert bench.errors() == []
    told = [(event.severity, event.error_id, event.text, event.line) for event in bench.events_of("channel")]
    assert told == [
        (0, 22028, "begin", 1),
        (0, 22028, "P1 is 2.500000, or 3; 5 %", 4),
        (
            1,
            22029,
            "channel channel: #ERROR 7 of the program: PV1 = 2.5 in test.nc line 5 '#ERROR [ID=7 RC=0 PV1=P1]'",
            5,
        ),
    ]
    first, second, _ = (event.cycle for event in bench.events_of("channel"))
    positions = bench.column("x", "set_position")
    assert positions[first] == pytest.approx(0.0, abs=1e-4) and positions[second - 1] < 1.0 <= positions[second]


def test_an_ordered_error_stops_the_program() -> None:
    bench = MachineBench("G00 X1\n#ERROR [ID=455 PV1=3]\nX2\nM30").run()
    (text,) = bench.errors()
    effect = "the path stops on its ramp and the program is aborted"
    place = "in test.nc line 2 '#ERROR [ID=455 PV1=3]'"
    assert text == f"P-ERR-22029 channel channel: #ERROR 455 of the program: PV1 = 3 {place}; {effect}"
    assert bench.position("x") == 1.0


CALLED = "%%L DEEP\n%s\nM29\n%%L OUTER\nLL DEEP\nM29\n%%\nG00 X1\n%sLL OUTER\nM30"
CALLERS = "called in test.nc line 5, called in test.nc line"


def test_an_ordered_error_names_the_callers() -> None:
    bench = MachineBench(CALLED % ("#ERROR [ID=455 PV1=3]", "")).run()
    (text,) = bench.errors()
    effect = "the path stops on its ramp and the program is aborted"
    place = f"in test.nc line 2 '#ERROR [ID=455 PV1=3]', {CALLERS} 9"
    assert text == f"P-ERR-22029 channel channel: #ERROR 455 of the program: PV1 = 3 {place}; {effect}"


def test_a_fault_that_only_the_run_shows_names_the_callers() -> None:
    bench = MachineBench(CALLED % ("X[1/0]", "P1 = V.A.ACT_POS.X\n")).run()
    (text,) = bench.errors()
    place = f"test.nc line 2 column 4 'X[1/0]': division by 0, {CALLERS} 10"
    effect = "the path stands behind line 9 'P1 = V.A.ACT_POS.X' and the program is aborted"
    assert text == f"P-ERR-20396 channel channel: {place}; {effect}"


def test_a_refused_start_names_the_callers() -> None:
    bench = MachineBench(CALLED % ("X[1/0]", "")).run()
    place = f"test.nc line 2 column 4 'X[1/0]': division by 0, {CALLERS} 9"
    assert bench.refusals() == [f"P-ERR-20396 {place}; nothing was started"]


def test_the_override_of_the_path_is_read_when_the_path_stands() -> None:
    bench = MachineBench("G00 X1\nG00 Y[V.RTG.OVERRIDE.VEL.TOTAL / 10]\nM30", end_when_idle=False)
    assert bench.give("channel", "set_override", percent=57).accepted
    bench.run(4.0)
    assert bench.errors() == [] and bench.position("y") == 5.7


def test_functions_before_an_ordered_error_go_out() -> None:
    bench = MachineBench("G00 X1\nH7\n#ERROR [ID=455]\nX2 H8\nM30").run()
    requests = [(request.kind, request.number) for block in bench.blocks["channel"] for request in block.requests]
    assert requests == [("H", 7)] and len(bench.errors()) == 1 and bench.position("x") == 1.0
    assert "#ERROR 455 of the program in test.nc line 3" in bench.errors()[0]


def test_h_functions_go_to_the_plc_and_the_path_does_not_wait() -> None:
    bench = MachineBench("G00 X1 H5\nH65535\nX2\nM30").run()
    requests = [(request.kind, request.number) for block in bench.blocks["channel"] for request in block.requests]
    assert bench.errors() == [] and requests == [("H", 5), ("H", 65535)]


def test_inch_does_not_scale_rotary_axes_of_the_machine() -> None:
    """The channel tells the interpreter which axes are in degrees."""
    turning = machine(x={"rotary": True})
    check = program_check.ProgramCheck.of_first_channel(turning, "a.nc")
    (block, _) = check.blocks(parse_program("G70 G00 X1 Y1\nM30", "a.nc"), (0.0, 0.0, 0.0))
    assert block.motion is not None and block.motion.target == (1.0, 25.4, 0.0)
    assert check.errors("#SCALE X2\nM30", "a.nc")[0].number == 21607
