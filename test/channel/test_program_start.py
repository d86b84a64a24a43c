"""Start at a line or block: what is computed up to it, what goes out, how the axes get there, what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from channel_spindle_support import machine_of, three
from long_support import long
from machine_support import MILL, MachineBench
from replay_support import bits, replay

from cnc_ptp.channel.skipped_functions import SkippedFunctions
from cnc_ptp.nc.canonical import (
    AuxiliaryFunction,
    AxisFeedforward,
    CanonicalBlock,
    CompensationSwitch,
    Dwell,
    ExplicitSynchronisation,
    Function,
    GearChange,
    Message,
    Source,
    SpindleCommand,
    SpindleFeedforward,
    SpindleFunction,
    SpindleLink,
)

PART = """%L EDGE
N210 G91 G01 Y5
N220 G01 X1 G90
N230 M29
%PART
N10 T5 D0 M8 G135
N20 M3 S1000
N30 G54 G00 X10 Y10
N40 G01 X20 F3000 M9
P1 = 3
N50 S2000 H7
N60 $FOR P2 = 1, 3, 1
N70 G01 X[20+P2*P1] F1200
N80 $ENDFOR
N90 G04 X0.5
N100 LL EDGE
/3 N105 Z5
N110 G92 X30
N120 G01 X5
$IF P1 > 100
N130 Z9
$ENDIF
N140 M30
"""
LINES = PART.splitlines()


def line_of(number: int) -> int:
    return next(index for index, line in enumerate(LINES, 1) if f"N{number} " in f"{line} ")


def loaded(text: str = PART, **options: object) -> MachineBench:
    bench = MachineBench(text, start=False, end_when_idle=False, **options).run(0.1)  # type: ignore[arg-type]
    assert bench.errors() == []
    return bench


def begin(bench: MachineBench, **place: object) -> list[str]:
    """Starts; the steps that come before the block."""
    record = bench.give("channel", "start", **place)
    assert record.accepted, record.message
    bench.run(0.01)
    return steps(bench)


def steps(bench: MachineBench) -> list[str]:
    return [event.text for event in bench.all_events if event.error_id == 22045]


def told(bench: MachineBench, *, cycle: int = 100) -> set[tuple[str, str, int]]:
    """Handshake requests: letter, spindle, number, from `cycle` on."""
    blocks = [block for block in bench.blocks["channel"] if block.first_cycle >= cycle]
    return {(request.kind, request.spindle, request.number) for block in blocks for request in block.requests}


def test_everything_before_is_computed_and_the_last_function_of_each_group_goes_out() -> None:
    bench = loaded()
    assert begin(bench, block_number=70, pass_number=2) == [
        "line 6: T5 D0 G135",
        "line 9: M9",
        "line 11: S[M3 REV2000] H7",
        "G00: X 0 to 23, Y 0 to 10",
        "continues with line 13 'N70 G01 X[20+P2*P1] F1200'",
    ]
    assert {event.cycle for event in bench.all_events if event.error_id == 22045} == {100}
    bench.run(20.0)
    assert bench.errors() == [] and bench.last("channel").done
    assert [bench.position(axis) for axis in "xyz"] == [35.0, 15.0, 5.0]
    assert ("M", "", 8) not in told(bench) and ("M", "", 9) in told(bench) and ("H", "", 7) in told(bench)
    assert bench.last("s").programmed_speed_rpm[-1] == 2000.0


def test_the_rest_of_the_path_is_that_of_a_whole_run() -> None:
    """From the beginning of the block on, every setpoint of a run of the whole program comes again."""
    whole, part = MachineBench(PART).run(), loaded()
    assert part.give("channel", "start", line=line_of(120)).accepted
    part.run(10.0)
    ways = []
    for bench in (whole, part):
        lines, xs = bench.column("channel", "line"), bench.column("x", "set_position")
        ways.append([x for line, x in zip(lines, xs, strict=False) if line == line_of(120)][-400:])
    moving = [[x for x in way if 30.0 < x < 34.9] for way in ways]
    assert len(moving[0]) > 50
    assert min(moving[1]) == pytest.approx(min(moving[0]), abs=0.1)
    assert whole.position("x") == part.position("x") == 35.0


def test_the_approach_is_one_straight_line_at_rest_at_both_ends() -> None:
    bench = loaded()
    assert bench.give("channel", "mdi", text="G00 X-20 Y-5 Z-2").accepted
    bench.run(3.0)
    first = len(bench.column("x", "set_position"))
    assert begin(bench, line=line_of(40))[-2] == "G00: X -20 to 10, Y -5 to 10"  # Z was never programmed
    bench.run(3.0)
    xs, ys = (bench.column(axis, "set_position")[first:] for axis in "xy")
    x, y = np.array([(x, y) for x, y in zip(xs, ys, strict=True) if x < 10.0]).T
    assert len(x) > 50
    assert (x + 20.0) / 30.0 == pytest.approx((y + 5.0) / 15.0, abs=1e-9)
    assert min(y for x, y in zip(xs, ys, strict=True) if x > 10.0) == 10.0


@pytest.mark.parametrize(
    ("plane", "stands", "way"),
    [
        ("G17", "X0 Y0 Z0", ["G00: Z 0 to 5", "G00: X 0 to 10, Y 0 to 20"]),
        ("G17", "X0 Y0 Z9", ["G00: X 0 to 10, Y 0 to 20", "G00: Z 9 to 5"]),
        ("G17", "X10 Y20 Z0", ["G00: Z 0 to 5"]),
        ("G17", "X10 Y0 Z5", ["G00: Y 0 to 20"]),
        ("G18", "X0 Y0 Z9", ["G00: Y 0 to 20", "G00: X 0 to 10, Z 9 to 5"]),
        ("G19", "X30 Y0 Z9", ["G00: Y 0 to 20, Z 9 to 5", "G00: X 30 to 10"]),
        ("G17", "X10 Y20 Z5", []),
    ],
)
def test_the_tool_axis_goes_up_before_the_others_and_down_after_them(plane: str, stands: str, way: list[str]) -> None:
    bench = loaded(f"{plane} G00 X10 Y20 Z5\nX11\nM30")
    assert bench.give("channel", "mdi", text=f"G00 {stands}").accepted
    bench.run(2.0)
    assert begin(bench, line=2) == [*way, "continues with line 2 'X11'"]
    bench.run(2.0)
    assert [bench.position(axis) for axis in "xyz"] == [11.0, 20.0, 5.0]


def test_single_block_stops_before_the_approach_and_behind_it() -> None:
    bench = loaded()
    assert bench.give("channel", "single_block", enabled=True).accepted
    assert bench.give("channel", "start", line=line_of(40)).accepted
    seen = []
    for _ in range(4):
        bench.run(2.0)
        seen.append((bench.position("x"), bench.last("channel").blocks_done))
        assert bench.give("channel", "start").accepted
    assert seen == [(0.0, 1), (0.0, 2), (10.0, 3), (20.0, 4)]


@pytest.mark.parametrize(
    ("place", "text"),
    [
        ({"line": 99}, "22040 test.nc: there is no line 99: the last one is 23"),
        ({"block_number": 75}, "22040 test.nc: there is no block N75; there are N70 and N80 next to it"),
        ({"block_number": 500}, "22040 test.nc: there is no block N500; there is N230 next to it"),
        ({"block_number": 130}, "22040 test.nc: block N130 is not executed; executed are N120 and N140 next to it"),
        ({"line": 21}, "22040 test.nc: line 21 is not executed; executed are 20 and 23 next to it"),
        ({"line": 5}, "22040 test.nc: line 5 is not executed; executed are 4 and 6 next to it"),
        ({"block_number": 70, "pass_number": 4}, "22041 test.nc: block N70 is passed 3 times, there is no pass 4"),
        ({"line": 9, "pass_number": 2}, "22041 test.nc: line 9 is passed once, there is no pass 2"),
        (
            {"line": 9, "in_program": "edge.nc"},
            "22043 test.nc: the program does not call a program 'edge.nc'. Known: test.nc",
        ),
    ],
)
def test_a_place_that_is_not_reached(place: dict[str, object], text: str) -> None:
    bench = loaded()
    assert bench.refused("channel", "start", **place) == f"P-ERR-{text}; nothing was started"
    bench.run(0.1)
    assert bench.last("channel").done and bench.position("x") == 0.0 and steps(bench) == []


@pytest.mark.parametrize(
    ("place", "reason"),
    [
        ({"line": 0}, "line = 0 must be at least 1"),
        ({"block_number": -3}, "block_number = -3 must be at least 1"),
        ({"line": 3, "pass_number": 0}, "pass_number = 0 must be at least 1"),
        ({"line": 3, "block_number": 10}, "line = 3 and block_number = 10 are both given"),
        ({"pass_number": 2}, "pass_number is given without line or block_number"),
        ({"in_program": "edge.nc"}, "in_program is given without line or block_number"),
    ],
)
def test_arguments_that_contradict(place: dict[str, object], reason: str) -> None:
    text = f"P-ERR-22001 channel channel: start refused: {reason}; nothing was changed"
    assert loaded().refused("channel", "start", **place) == text


def test_a_program_that_is_stopped_is_only_resumed() -> None:
    bench = MachineBench("X1\nM00\nX2\nM30", end_when_idle=False).run(1.0)
    text = "channel channel: start refused: the program is stopped in line 2 and can only be resumed there"
    assert bench.refused("channel", "start", line=1) == f"P-ERR-22004 {text}; nothing was changed"


def test_what_only_the_run_knows_may_come_behind_the_start_but_not_before_it() -> None:
    text = "X5\nN20 P1 = V.A.ACT_POS.X\nN30 Y[P1 + 1]\nM30"
    bench = loaded(text)
    reason = "line 2 'N20 P1 = V.A.ACT_POS.X' reads what only the run knows, and it is before block N30"
    assert bench.refused("channel", "start", block_number=30) == f"P-ERR-22042 test.nc: {reason}; nothing was started"
    assert bench.give("channel", "start", block_number=20).accepted
    bench.run(3.0)
    assert bench.position("x") == 5.0 and bench.position("y") == pytest.approx(5.8, abs=0.1)  # the drive lags behind
    assert steps(bench) == ["G00: X 0 to 5", "continues with line 2 'N20 P1 = V.A.ACT_POS.X'"]


def test_an_error_that_the_program_orders_ends_it_before_the_start() -> None:
    bench = loaded("X5\n#ERROR [ID=7 RC=2]\nX6\nM30")
    assert bench.refused("channel", "start", line=3) == (
        "P-ERR-22044 test.nc: #ERROR 7 of the program in line 2 ends it before line 3; nothing was started"
    )


def test_faults_before_and_behind_the_start_refuse_it() -> None:
    for line in (1, 2, 3):
        bench = loaded("X5\nX[1/0]\nX6\nM30")
        assert bench.refused("channel", "start", line=line).startswith("P-ERR-20396 test.nc line 2 column 4 'X[1/0]'")


def test_the_way_to_the_start_point_is_within_the_limits() -> None:
    """Those of the axis lists and of G98, G99; an axis that stays may be beyond a limit that came later."""
    bench = loaded("G00 X50 Y20\nG99 X40\nN10 G00 Y30\nM30")
    assert bench.refused("channel", "start", block_number=10) == (
        "P-ERR-120002 test.nc line 3 column 1 'N10 G00 Y30': axis X: 50 mm lies beyond the software limit 40 mm of G99; "
        "nothing was started"
    )
    assert bench.give("channel", "start").accepted
    bench.run(3.0)
    assert [bench.position(axis) for axis in ("x", "y")] == [50.0, 30.0]
    assert bench.give("channel", "start", block_number=10).accepted  # X stands there
    bench = loaded("G92 X1000\nG98 Z-1\n#PSET X1000\nG74 Z1\nN10 G00 Y30\nM30")
    assert bench.refused("channel", "start", block_number=10).startswith("P-ERR-22042")


def test_an_axis_without_reference_does_not_go_to_the_start_point() -> None:
    machine = replace(MILL, axes=dict(MILL.axes))
    x = machine.axes["x"]
    machine.axes["x"] = replace(x, homing=replace(x.homing, required=True), referenced_at_start=False)
    bench = MachineBench("G00 X5\nG00 Y5\nM30", machine=machine, start=False, end_when_idle=False).run(0.1)
    text = "axis X is not referenced (P-MACH-00061); G74 X1 first"
    assert bench.refused("channel", "start", line=2) == (
        f"P-ERR-22034 test.nc line 1 column 5 'G00 X5': {text}; nothing was started"
    )


def test_a_called_program_and_a_place_in_it() -> None:
    bench = MachineBench(end_when_idle=False).run(0.1)
    text, side = "G00 X1\nL side.nc\nL side.nc\nM30", "G91 Y2\nN7 Y3\nG90"
    assert bench.give("channel", "load", program="/p/a.nc", text=text, files={"side.nc": side + "\nM29"}).accepted
    assert begin(bench, block_number=7, in_program="side.nc", pass_number=2) == [
        "G00: X 0 to 1, Y 0 to 7",
        "continues with line 2 'N7 Y3'",
    ]
    view = bench.units["channel"].program_view  # type: ignore[attr-defined]
    bench.run(0.05)
    bench.run(3.0)
    view = bench.units["channel"].program_view  # type: ignore[attr-defined]
    assert bench.position("y") == 10.0 and (view.program, view.file) == ("/p/a.nc", "/p/a.nc")
    reason = "the program does not call a program 'b.nc'. Known: a.nc, side.nc"
    text = f"P-ERR-22043 /p/a.nc: {reason}; nothing was started"
    assert bench.refused("channel", "start", line=1, in_program="b.nc") == text


def test_a_long_program_is_searched_again_while_it_runs() -> None:
    text = "\n".join(["M3 S500", *(f"G00 X{n % 7} Y{n % 5}" for n in range(40)), "M30"])
    runs = []
    for most in (100_000, 10):
        channel = replace(MILL.channels["channel"], known_blocks=most)
        bench = loaded(text, machine=replace(MILL, channels={"channel": channel}))
        assert bench.give("channel", "start", line=31).accepted
        bench.run(6.0)
        assert bench.last("channel").done and bench.errors() == []
        runs.append([bench.blocks[unit] for unit in ("x", "y", "s")])
    assert runs[0] == runs[1]


def test_homing_may_come_behind_the_start_but_not_before_it() -> None:
    bench = loaded("X5\nN20 G74 X1\nN30 X6\nM30")
    reason = "line 2 'N20 G74 X1' homes axes, and it is before block N30"
    assert bench.refused("channel", "start", block_number=30) == f"P-ERR-22042 test.nc: {reason}; nothing was started"
    assert begin(bench, block_number=20) == ["G00: X 0 to 5", "continues with line 2 'N20 G74 X1'"]


@pytest.mark.parametrize("line", [3, *long([2, 4])])
def test_offsets_count_from_the_start_on(line: int) -> None:
    bench = loaded("G92 X30\nG00 X0\nX1\nX2\nM30")
    begin(bench, line=line)
    bench.run(3.0)
    reports = [offsets for block in bench.blocks["channel"] for offsets in block.offsets]
    assert next(offsets for offsets in reports if offsets.reference_offset[0] == 30.0).cycle <= 101
    assert bench.position("x") == 32.0


@pytest.mark.long
def test_two_runs_and_a_replay_are_bit_identical() -> None:
    scenario = """
    - {at: 0.1, to: channel, do: block_skip, enabled: on, level: 3}
    - {at: 0.2, to: channel, do: start, block_number: 70, pass_number: 2}
    - {at: 0.3, to: channel, do: single_block, enabled: on, mode: motion}
    - {at: 4.0, to: channel, do: single_block, enabled: off}
    - {at: 4.0, to: channel, do: start}
    """
    first = MachineBench(PART, scenario, start=False).run()
    second = MachineBench(PART, scenario, start=False).run()
    assert first.errors() == [] and first.position("z") == 0.0 and first.position("x") == 35.0
    assert bits(first) == bits(second)
    texts, expected = replay(MILL, first.records, len(first.blocks["x"])), bits(first)
    for name in ("channel", "x", "y", "z", "s"):
        assert texts[name] == expected[name], name


# what is left of functions


def block(number: int, *functions: Function) -> CanonicalBlock:
    return CanonicalBlock(Source("p.nc", number, 0, ""), functions, None, "")


def left(*blocks: CanonicalBlock) -> list[tuple[int, tuple[Function, ...]]]:
    skipped = SkippedFunctions()
    for each in blocks:
        skipped.add(each)
    return [(each.source.line, each.functions) for each in skipped.blocks()]


def turn(speed: float | None, m: int | None = 3, **words: object) -> SpindleFunction:
    return SpindleFunction("S", m, speed, **words)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("before", "then", "result"),
    [
        (turn(1000.0), turn(2000.0, None), turn(2000.0)),
        (turn(1000.0), turn(None, 5), turn(None, 5)),
        (turn(None, 5), turn(500.0, None), turn(None, 5)),
        (turn(1000.0), turn(1000.0, 4), turn(1000.0, 4)),
        (turn(None, 19, position_deg=90.0), turn(500.0, None), turn(None, 19, position_deg=90.0)),
        (turn(500.0, None), turn(600.0, None), turn(600.0, None)),
        (turn(500.0), turn(None, None, full_override=True), turn(500.0, full_override=True)),
        (turn(500.0, full_override=True), turn(600.0, None), turn(600.0)),
        (AxisFeedforward(True, (("X", 50.0), ("Y", 60.0))), AxisFeedforward(None, (("Y", 70.0),)), AxisFeedforward(True, (("X", 50.0), ("Y", 70.0)))),
        (SpindleFeedforward("S", True, 80.0), SpindleFeedforward("S", False, None), SpindleFeedforward("S", False, 80.0)),
        (CompensationSwitch("X", True, ("FRICT",)), CompensationSwitch("X", False, ("FRICT",)), CompensationSwitch("X", False, ("FRICT",))),
        (SpindleLink("S2", "S", True), SpindleLink("S2", "S", False), SpindleLink("S2", "S", False)),
        (GearChange("S", 1), GearChange("S", 2), GearChange("S", 2)),
        (AuxiliaryFunction("M", 7), AuxiliaryFunction("M", 9), AuxiliaryFunction("M", 9)),
        (AuxiliaryFunction("H", 1), AuxiliaryFunction("H", 2), AuxiliaryFunction("H", 2)),
        (AuxiliaryFunction("T", 1), AuxiliaryFunction("T", 2), AuxiliaryFunction("T", 2)),
        (SpindleCommand("S", "home"), SpindleCommand("S", "home"), SpindleCommand("S", "home")),
    ],
)  # fmt: skip
def test_a_function_replaces_one_of_its_group(before: Function, then: Function, result: Function) -> None:
    assert left(block(1, before), block(2, then)) == [(2, (result,))]


def test_functions_of_different_groups_stay_in_their_order() -> None:
    first = (AuxiliaryFunction("T", 3), GearChange("S", 2), turn(100.0), AuxiliaryFunction("M", 130))
    other = SpindleFunction("S2", 4, 50.0)
    link, message = SpindleLink("S2", "S", True), Message("hello")
    last = AuxiliaryFunction("M", 131)
    blocks = (block(1, *first), block(2, other, message), block(3, link, ExplicitSynchronisation()), block(4, last))
    assert left(*blocks) == [(1, first), (2, (other,)), (3, (link,)), (4, (last,))]
    assert left(block(1, message), CanonicalBlock(Source("p.nc", 2, 0, ""), (), Dwell(3.0), "M00")) == []
    assert left(*blocks, block(5, AuxiliaryFunction("M", 130))) == [
        (1, first[:3]), (2, (other,)), (3, (link,)), (4, (last,)), (5, first[3:])
    ]  # fmt: skip


T1, T2, T3 = (AuxiliaryFunction("T", number) for number in (1, 2, 3))
M6, M7, M8, M9 = (AuxiliaryFunction("M", number) for number in (6, 7, 8, 9))


@pytest.mark.parametrize(
    ("program", "result"),
    [
        ([(T1, M6), (T2,)], [(1, (T1, M6)), (2, (T2,))]),
        ([(T1,), (M6,), (T2,)], [(1, (T1,)), (2, (M6,)), (3, (T2,))]),
        ([(T1,), (M8,), (M6,)], [(1, (T1,)), (2, (M8,)), (3, (M6,))]),
        ([(T1, M6), (T2,), (T3,)], [(1, (T1, M6)), (3, (T3,))]),
        ([(T1, M6), (T2,), (M6,), (T3,)], [(2, (T2,)), (3, (M6,)), (4, (T3,))]),
        ([(T1, M6), (M6,)], [(1, (T1,)), (2, (M6,))]),
        ([(M6,), (T1,)], [(1, (M6,)), (2, (T1,))]),
        ([(T1,), (T2,)], [(2, (T2,))]),
        ([(M7,), (M8,)], [(1, (M7,)), (2, (M8,))]),
        ([(M8,), (M7,), (M9,)], [(3, (M9,))]),
        ([(M8,), (M9,), (M7,)], [(2, (M9,)), (3, (M7,))]),
        ([(AuxiliaryFunction("M", 8, "S2"),), (M9,)], [(1, (AuxiliaryFunction("M", 8, "S2"),)), (2, (M9,))]),
    ],
)
def test_the_tool_in_the_spindle_and_the_next_one_and_coolant(
    program: list[tuple[Function, ...]], result: list[tuple[int, tuple[Function, ...]]]
) -> None:
    assert left(*(block(number, *functions) for number, functions in enumerate(program, 1))) == result


def test_a_start_behind_the_selection_of_the_next_tool_loads_the_one_before() -> None:
    bench = loaded("T1 M6\nT2\nS1000 M3\nM7\nM8\nG01 X5 F600\nX6\nM30")
    assert begin(bench, line=7)[:5] == [
        "line 1: T1 M6",
        "line 2: T2",
        "line 3: S[M3 REV1000]",
        "line 4: M7",
        "line 5: M8",
    ]
    bench.run(5.0)
    assert bench.errors() == [] and bench.position("x") == 6.0
    blocks = [block for block in bench.blocks["channel"] if block.first_cycle >= 100]
    out = [(request.kind, request.number) for block in blocks for request in block.requests]
    assert [each for each in dict.fromkeys(out) if each in {("T", 1), ("T", 2), ("M", 6)}] == [
        ("T", 1),
        ("M", 6),
        ("T", 2),
    ]


def test_couplings_and_gears_are_made_before_the_block() -> None:
    text = "S M3 S300\nX1\n#SET AX LINK[1, S2=S]\n#ENABLE AX LINK[1]\nX2\nS500\nX3\nM30".replace("S M3", "M3")
    bench = loaded(text, machine=machine_of(*three()))
    assert begin(bench, line=7)[:3] == [
        "line 4: link S2=S",
        "line 6: S[M3 REV500] S2[REV500]",
        "G00: X 0 to 2",
    ]
    bench.run(5.0)
    assert bench.errors() == [] and bench.position("x") == 3.0
