"""A check goes on behind an error where what follows does not depend on it, and says where it does."""

import pytest

from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.check import check
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.iso.vocabulary import ISO
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.program import Channel, Spindle, SpindleTable
from cnc_ptp.nc.recovery import DEPENDS, ENOUGH, READS
from cnc_ptp.parameters import Tool, ToolTable

AXES = ("X", "Y", "Z")


def found(text: str, **options) -> list[tuple[int, int, str]]:
    """Number and line of each error, and why nothing behind it was checked."""
    return [
        (error.number, error.line, error.unchecked) for error in check(text, "a.nc", plain_channel(AXES), **options)
    ]


def found_iso(text: str) -> list[tuple[int, int, str]]:
    """The same in the vocabulary iso."""
    channel = plain_channel(AXES)._replace(vocabulary=ISO)
    return [(error.number, error.line, error.unchecked) for error in check(text, "a.nc", channel)]


def test_independent_errors_of_blocks_are_all_found() -> None:
    text = "G01 X10 F-5\nX[1/0]\nY[SQRT[-1]]\nS-100\nG02 X5 K1 F100\n#ROTATION ON [ANGLE=1/0]\nZ[P7]\nM30"
    assert found(text) == [
        (21022, 1, ""),
        (20396, 2, ""),
        (21422, 3, ""),
        (20991, 4, ""),
        (20396, 6, ""),
        (20925, 7, ""),
    ]


def test_what_may_only_follow_from_an_error_is_not_shown() -> None:
    """Line 3 has no feed because line 2 was left out, line 4 begins where line 2 would have ended."""
    assert found("G90\nG01 X10 F-5\nG01 X20\nG02 X40 I-15\nM30") == [(21022, 2, "")]


@pytest.mark.parametrize(
    ("line", "numbers"),
    [
        ("G63 Z-10 F250 S200 K1\nZ5 S-200", [21648]),
        ("G331 Z-10 S200 K0\nG332 Z5 S-200\nZ6 S-100", [21647]),
        ("G01 X10 F-5\nZ5 S-200", [21022, 20991]),
    ],
)
def test_a_negative_speed_may_lead_out_of_a_thread_whose_line_was_left_out(line: str, numbers: list[int]) -> None:
    assert [error.number for error in check(f"{line}\nM30", "a.nc", plain_channel(AXES, spindles=("S",)))] == numbers


def test_a_plane_that_was_left_out_is_missed_by_nobody() -> None:
    """G18 was in the line with the error; the plane XY would need an axis that a lathe has not."""
    lathe = plain_channel("XZ")._replace(tools=ToolTable({1: Tool(radius=1.0)}, True))
    text = "G18 D1 G00 X5 F-1\nG41 G01 Z10 F100\nZ20\nG40 X9\nM30"
    assert [(error.number, error.line) for error in check(text, "a.nc", lathe)] == [(21022, 1)]


@pytest.mark.parametrize(
    ("line", "number"), [("G74 X1.5", 21065), ("#SCALE ON X0", 21605), ("G159=99", 21600), ("G351 X2", 20860)]
)
def test_an_error_that_a_line_has_by_itself_is_shown_behind_another_one(line: str, number: int) -> None:
    assert found(f"G01 X10 F-5\n{line}\nM30") == [(21022, 1, ""), (number, 2, "")]


LIMITED = SpindleTable((Spindle("S", "S", limits=(4000.0,)), Spindle("S2", "S2", 2, limits=(800.0, 2000.0))), "S")
"""S with one maximum, S2 with one for each of two gears."""


def limited(axes: str = "XYZ") -> Channel:
    return plain_channel(axes, LIMITED)


@pytest.mark.parametrize(
    ("line", "number"),
    [
        ("M3 S99999", 22010),
        ("G1 X5 F0", 20008),
        ("G01 F0 X5", 20008),
        ("G63 Z-5 F0 S100", 21643),
        ("G63 Z-5 F100 S0", 21644),
        ("G63 Z-5 F100 S100 K2", 21648),
        ("G63 Z-5 S100 S2=50 F100", 21655),
        ("G63 Z-5 S9999 F100", 22010),
        ("G00 X5 J3", 21013),
        ("#MAIN SPINDLE [77]", 21306),
    ],
)
def test_an_error_of_what_the_line_itself_says_is_shown_behind_another_one(line: str, number: int) -> None:
    errors = check(f"G77\n{line}\nM30", "a.nc", limited())
    assert [(error.number, error.line) for error in errors] == [(20131, 1), (number, 2)]


def test_a_plane_in_the_line_itself_that_the_machine_lacks_is_shown() -> None:
    errors = check("G77\nG17 G02 X5 R5 F100\nM30", "a.nc", limited("XZ"))
    assert [(error.number, error.line) for error in errors] == [(20131, 1), (21031, 2)]


@pytest.mark.parametrize(
    "line", ["G01 X5", "X5 F0", "G63 Z-5 S100", "G63 Z-5 F100", "G63 Z-5 F100 K1", "J3 X5", "S2[M3 REV1000]"]
)
def test_it_is_not_shown_where_the_block_that_was_left_out_may_have_said_the_rest(line: str) -> None:
    """A feed, a speed, the path function, a gear."""
    text = f"G01 X1 F100\nM3 S10\nM5\nS0 F0\nG77\n{line}\nM30"
    assert [(error.number, error.line) for error in check(text, "a.nc", limited())] == [(20131, 5)]


@pytest.mark.parametrize("begin", ["#COMMENT BEGIN", "#VAR"])
def test_what_is_not_closed_is_the_only_error_of_its_lines(begin: str) -> None:
    assert found(f"G00 X1\n{begin}\n\nM30")[0][:2] == (21581, 2)
    assert 21017 not in [number for number, _, _ in found(f"G00 X1\n{begin}\nM30")]


def test_behind_a_line_that_cannot_be_read_the_check_goes_on() -> None:
    assert found("G01 X10 F100\nG01 X20 Q5\nX[1/0]\nM30") == [(20797, 2, ""), (20396, 3, "")]


@pytest.mark.parametrize(
    "line", ["G77 (P2)", "G77 (see #5)", "G77 ; drill P5 M30", "G77 (%) X1", "G77 X=P1", "G77 X = P1"]
)
def test_comments_and_parameters_that_are_read_decide_nothing(line: str) -> None:
    assert found(f"P1 = 1\n{line}\nM77 A1\nM30") == [(20131, 2, ""), (20797, 3, "")]


@pytest.mark.parametrize("line", ["G77 P1 = 5", "G77 (X) LL SUB", "G77 V.P.A = 5", "G77 )P1", "#VR", "#ERROR [FOO=1]"])
def test_a_line_that_cannot_be_read_and_may_decide_ends_the_check(line: str) -> None:
    ((_, line_of_error, unchecked),) = found(f"{line}\nX[1/0]\nM30")
    assert (line_of_error, unchecked) == (1, DEPENDS)


@pytest.mark.parametrize(
    "line",
    [
        *("#HSC ON [FOO=3]", '#MSG ["%n"]', "N10 #HSC ON [FOO=P1]", "#SCALE ONN X2", "#ROTATION ON [FOO=1]"),
        *("#TIMER", "#TIMER FOO", "#SLOPE [TYPE=SIN2] X", "#TOOL DATA X", "#CONTOUR MODE [FOO]", "#CS ON [FOO]"),
    ],
)
def test_a_command_that_sets_no_value_decides_nothing(line: str) -> None:
    """Its faulty arguments end no check."""
    (_, first, unchecked), second = found(f"P1 = 1\n{line}\nX[1/0]\nM30")
    assert (first, unchecked, second) == (2, "", (20396, 3, ""))


@pytest.mark.parametrize("line", ["G77 X5 P1", "G77 (M30)", "G77 ; M99 O1", "G0 X#1", "G77 L2"])
def test_words_of_iso_that_decide_nothing(line: str) -> None:
    (_, first, unchecked), second = found_iso(f"{line}\nG0 A1\nM30")
    assert (first, unchecked, second) == (1, "", (20797, 2, ""))


@pytest.mark.parametrize("line", ["G77 M98 P5", "G77 M30", "N5 O100 SUB", "G77 M099", "IF [#1 EQ 0] GOTO 5"])
def test_words_of_iso_that_decide_which_lines_follow(line: str) -> None:
    assert [found_[1:] for found_ in found_iso(f"G21\n{line}\nG0 A1\nM30")] == [(2, DEPENDS)]


@pytest.mark.parametrize(
    "line", ["P1 = 1/0", "$IF 1/0", "V.P.A = SQRT[-1]", "X1 P2 = 1/0", "LL NOWHERE", "#DELETE V.P.B", "X[1/0] P2 = 5"]
)
def test_it_ends_where_values_or_the_order_of_lines_depend_on_the_error(line: str) -> None:
    closing = "$ENDIF\n" if "$IF" in line else ""
    (error,) = check(f"G00 X1\n{line}\n{closing}X[1/0]\nM30", "a.nc", plain_channel(AXES))
    assert (error.line, error.unchecked) == (2, DEPENDS)


def test_it_ends_where_a_line_reads_the_state() -> None:
    assert found("G00 X[1/0]\nY[1/0]\n$IF V.A.ABS.X > 0\nZ[1/0]\n$ENDIF\nM30") == [(20396, 1, ""), (20396, 2, READS)]


def test_there_are_at_most_20_errors() -> None:
    assert found("X[1/0]\n" * 30 + "M30") == [(20396, line, ENOUGH if line == 20 else "") for line in range(1, 21)]


def test_a_loop_shows_its_error_once() -> None:
    assert found("$FOR P1 = 1, 5, 1\nX[1/0]\n$ENDFOR\nY[1/0]\nM30") == [(20396, 2, ""), (20396, 4, "")]


def test_positions_beyond_a_limit_count_once_and_the_path_goes_on_from_there() -> None:
    def within(target: tuple[float, ...], source: Source) -> None:
        if target[0] > 100.0:
            raise ProgramError(120002, f"X {target[0]:g}", source, 1)

    text = "G00 X200\nY10\nG91 X50\nG90 X0\nG01 X300\nM30"
    assert found(text, check_target=within) == [(120002, 1, ""), (120002, 3, ""), (20008, 5, "")]


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        *(("#HSC ON [FOO=3]", True), ('N10 #msg ["%n"]', True), ("#SLOPE [TYPE=FOO]", True), ("#TIMER", True)),
        *(("#CONTOUR MODE [FOO]", True), ("#SCALE ON X0", False), ("#CS ON [FOO]", False), ("G77", False)),
    ],
)
def test_a_soft_limit_is_shown_behind_what_changes_no_positions(line: str, shown: bool) -> None:
    def within(target: tuple[float, ...], source: Source) -> None:
        if target[0] > 100.0:
            raise ProgramError(120002, f"X {target[0]:g}", source, 1)

    errors = found(f"{line}\nG00 X500\nM30", check_target=within)
    assert [error[1] for error in errors] == ([1, 2] if shown else [1])


def test_an_ordered_error_that_is_reached_is_an_error() -> None:
    text = "%L DEEP\n#ERROR [ID=455 PV1=P1]\nM29\n%\nP1 = 2\n$IF P1 > 1\nLL DEEP\n$ELSE\n#ERROR [ID=7]\n$ENDIF\nM30"
    (error,) = check(text, "a.nc", plain_channel(AXES))
    reason = "#ERROR 455 of the program: PV1 = 2; the program is aborted there"
    assert str(error) == f"P-ERR-22029 a.nc line 2 column 1 '#ERROR [ID=455 PV1=P1]': {reason}"
    assert error.calls == ["a.nc line 7"]


def test_an_ordered_warning_is_none() -> None:
    assert found("#ERROR [ID=455 RC=0]\nM30") == []


def test_an_ordered_error_behind_what_only_the_run_knows_is_not_reported() -> None:
    assert found("P1 = V.A.ACT_POS.X\n#ERROR [ID=455]\nM30") == []


@pytest.mark.parametrize("line", ["G41 G0 X1", "G42\nG01 X1 F100", "G41 G02 X1 Y1 R9 F100"])
def test_behind_a_contour_without_a_tool_the_check_goes_on_as_with_g40(line: str) -> None:
    last = 1 + line.count("\n")
    text = f"{line}\nX[1/0]\nG18\nG40 G02 Y5 Z5 R9 F100\nA1\nM30"
    assert found(text) == [(21683, last, ""), (20396, last + 1, ""), (20797, last + 4, "")]


def test_each_contour_without_a_tool_is_shown() -> None:
    """The radius that D says is not there is missed by the second one, too; the third one has it."""
    channel = plain_channel(AXES)._replace(tools=ToolTable({1: Tool(radius=1.0)}, True))
    text = "G41 G01 X5 F100\nY5\nG40 X9\nG42 X0\nY0\nD9\nD1\nG41 X5\nG03 X6 Y1 R0.8\nG40 G01 X20\nM30"
    errors = [(error.number, error.line, error.unchecked) for error in check(text, "a.nc", channel)]
    assert errors == [(21683, 1, ""), (21683, 4, ""), (20296, 6, ""), (90017, 9, DEPENDS)]
