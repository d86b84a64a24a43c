"""Order of execution: pauses for what only the run knows, ends of subroutines, modal calls, limits of time and depth."""

import math

import pytest
from nc_support import lines, run

from cnc_ptp.nc.canonical import LinearMove, WaitForPath
from cnc_ptp.nc.check import check
from cnc_ptp.nc.expressions.values import Values
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.program_text import ProgramText

AXES = ("X", "Y", "Z")


def running(text: str) -> list[object]:
    """Targets and pauses of a program whose actual positions are the programmed ones plus 0.5 at each pause."""
    program = parse_program(text, "a.nc", mdi=True, files={"up.nc": "G91 Y[@P1]\nM29"})
    channel = plain_channel(AXES, ())
    state = ModalState()
    values = Values(channel, state)
    found: list[object] = []
    for block in interpret(program, (0.0,) * 3, channel, state=state, values=values, runs=True):
        if any(isinstance(function, WaitForPath) and function.awaited for function in block.functions):
            values.actual = tuple(position + 0.5 for position in state.position)
            found.append("pause")
        elif isinstance(block.motion, LinearMove):
            found.append(block.motion.target[:2])
    return found


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("G00 X10\n$IF 0\n$ELSEIF V.A.ACT_POS.X > 10\nY1\n$ENDIF", [(10, 0), "pause", (10, 1)]),
        ("G00 X10\n$SWITCH 10.5\n$CASE V.A.ACT_POS.X\nY1\n$ENDSWITCH", [(10, 0), "pause", (10, 1)]),
        ("G00 X3\n#VAR\nV.P.A = V.A.ACT_POS.X\n#ENDVAR\nX[V.P.A]", [(3, 0), "pause", (3.5, 0)]),
        ("G00 X3\n#CS ON [V.A.ACT_POS.X, 0]\nX0", [(3, 0), "pause", (3.5, 0)]),
        ("G00 X3\n#PSET X=V.A.ACT_POS.X\nX0", [(3, 0), "pause", (-0.5, 0)]),
        ("G00 X3\n#SCALE ON X=V.A.ACT_POS.X\nX1", [(3, 0), "pause", (3.5, 0)]),
        ("G00 X3\n#ROTATION ON [ANGLE=V.A.ACT_POS.X + 86.5]\nX1 Y0", [(3, 0), "pause", (0, 1)]),
        ("G00 X3\nP[V.A.ACT_POS.X + 0.5] = 7\nX[P4]", [(3, 0), "pause", (7, 0)]),
        ("$FOR P1 = 0, 2 - V.A.ACT_POS.X, 1\nG00 X[P1 + 0.5]\n$ENDFOR\nY[P1]", ["pause", (0.5, 0), "pause", (1.5, 0), "pause", (1.5, 2)]),
        ("G00 X10 L CYCLE [NAME=up.nc @P1=V.A.ACT_POS.X]", [(10, 0), "pause", (10, 10.5)]),
        ("L CYCLE [NAME=up.nc @P1=V.A.ACT_POS.X MODAL_MOVE]\nX1\nX2", ["pause", (0, 0.5), (1, 0.5), "pause", (1, 2), (2, 2), "pause", (2, 4.5)]),
        ("$WHILE V.A.ACT_POS.X < 3\nG00 X[V.A.ABS.X + 2]\n$ENDWHILE", ["pause", (2, 0), "pause", (4, 0), "pause"]),
    ],
)  # fmt: skip
def test_the_path_stands_each_time_before_what_only_the_run_knows(text, expected):
    assert running(text) == expected


def test_a_flush_is_no_reason_to_check_less():
    assert [error.number for error in check("#FLUSH WAIT\nX[1/0]\nM30", "a.nc", plain_channel(AXES))] == [20396]


def test_the_block_with_m29_belongs_to_its_cycle():
    text = "%L DOWN\nG91 G01 Z-1 F60\nZ1 M29\n%MAIN\nG00 Z5\nLL CYCLE [NAME=DOWN]\nX1\nM30"
    assert lines(text) == [
        "rapid (0, 0, 5)", "line (0, 0, 4) feed 1", "line (0, 0, 5) feed 1", "rapid (1, 0, 5)", "end"
    ]  # fmt: skip
    assert lines("%L UP\nG91 M29\n%MAIN\nLL CYCLE [NAME=UP]\nG00 X1\nX1\nM30")[:2] == ["rapid (1, 0, 0)", "end"]


def test_words_with_expressions_end_programs_and_subroutines():
    text = "%L UP\nX[1] M29\n%MAIN\nP1 = 3\nLL UP\nX[P1] M30"
    assert lines(text) == ["rapid (1, 0, 0)", "rapid (3, 0, 0) | end"]


def test_a_modal_call_follows_motions_and_comes_before_other_calls():
    text = "%L DOT\nG91 Z1\nM29\n%L S\nY9\nM29\n%MAIN\nLL CYCLE [NAME=DOT MODAL_MOVE]\nG04 1\nX1 LL S\nM30"
    assert lines(text) == [
        "rapid (0, 0, 1)", "dwell 1 s", "rapid (1, 0, 1)", "rapid (1, 0, 2)", "rapid (1, 9, 2)", "end"
    ]  # fmt: skip


def test_the_order_of_codes_in_a_block_does_not_matter():
    for first, second in (("G91 G92 X5", "G92 G91 X5"), ("G18 G21", "G21 G18")):
        text = "G92 X10\n{}\nG90 G00 X1 Z1"
        assert lines(text.format(first)) == lines(text.format(second))


def test_loops_over_decimals_have_their_last_turn():
    assert len(run("$FOR P1 = 0, 0.3, 0.1\nG91 X1\n$ENDFOR")) == 4
    assert len(run("$FOR P1 = 0.3, 0, -0.1\nG91 X1\n$ENDFOR")) == 4


def test_declared_parameters_have_their_values():
    (block,) = run("#VAR\nP1 = 5\nP2\nP10[2]\n#ENDVAR\nX[P1] Y[P2 + 1] Z[EXIST[P10]]")
    assert block.motion.target == (5.0, 1.0, 1.0)


@pytest.mark.parametrize("end", ["N30 #ENDVAR", "# ENDVAR", "/ N30 #endvar"])
def test_ends_of_declarations_may_have_block_numbers(end):
    assert lines(f"N10 #VAR\nN20 V.P.A = 5\n{end}\nX[V.P.A]") == ["rapid (5, 0, 0)"]


def test_index_and_offset_agree_within_and_behind_a_coordinate_system():
    text = "V.G.NP[1].V.X=10\nG54 G00\n#CS ON [0, 0]\nY[V.G.NP_AKT.IDX + 5]\nG55 Y[V.G.NP_AKT.IDX]\n#CS OFF\nX0 Y[V.G.NP_AKT.IDX]"
    assert [block.motion.target[:2] for block in run(text)] == [(0.0, 5.0), (0.0, 0.0), (10.0, 1.0)]


def test_types_of_variables_count():
    (block,) = run(
        "#VAR\nV.P.A : UNS08 = 2.6\nV.P.B : BOOLEAN = 0.7\n#ENDVAR\nV.P.C = V.P.A\nV.P.A = 254.6\nX[V.P.A] Y[V.P.B] Z[V.P.C]"
    )
    assert block.motion.target == (255.0, 1.0, 3.0)


def test_long_sums_take_time_in_proportion():
    """22 terms took minutes once: each was evaluated twice."""
    (block,) = run("V.P.A = 1\nX[" + "+".join(["V.P.A"] * 140) + "]")
    assert block.motion.target[0] == 140.0
    (block,) = run("P1 = 65\nX[" + "ORD[CHR[" * 18 + "P1" + "]]" * 18 + "]")
    assert block.motion.target[0] == 65.0


@pytest.mark.parametrize(
    "text", ["S[REV=P1 M3[5]]", "P1=" + "1+" * 1900 + "1", "X" + "P" * 1500 + "1", "$IF " + "1 && " * 700 + "1"]
)
def test_what_took_without_end_or_too_deep_is_a_program_error(text):
    with pytest.raises(ProgramError):
        run(text)


@pytest.mark.parametrize(
    "text",
    [
        "P9=DEXP[308]\n$FOR P1=P9,P9*1.2,P9\n$ENDFOR",
        "G70 G00 X[DEXP[308]]",
        "G92 X[DEXP[308]]",
        "#CS ON [DEXP[308]]",
        "V.G.NP[1].V.X = DEXP[308]",
        "G04 [DEXP[308]]",
        "S[M3 REV=DEXP[308]]",
    ],
)
def test_values_beyond_all_words_are_errors(text):
    with pytest.raises(ProgramError):
        run(text)


def test_targets_are_numbers_after_many_relative_words():
    for block in run("G91 G00\n$FOR P1 = 1, 50, 1\nX[999999999]\n$ENDFOR"):
        assert math.isfinite(block.motion.target[0])


@pytest.mark.parametrize("word", ["$BREAK", "$ELSE", "M29"])
def test_errors_of_structure_behind_the_lines_that_are_kept(word):
    text = "\n" * (ProgramText.kept + 1) + word + "\nM30"
    (error,) = check(text, "a.nc", plain_channel(AXES))
    assert error.line == ProgramText.kept + 2


def test_a_skipped_loop_head_is_an_error_of_the_program():
    with pytest.raises(ProgramError, match="parameter P1 has no value yet"):
        run("/ $FOR P1=1,3,1\nX1\n$ENDFOR", block_skip=1)


def test_the_last_block_number_counts_also_without_words():
    (block,) = run("N10 P1=5\nN20 P2=V.G.BLOCK_NR\nX[P2]")
    assert block.motion.target[0] == 20.0


def test_a_backslash_in_a_comment_continues_nothing():
    assert lines("Z3 ; folder \\\nX4") == ["rapid (0, 0, 3)", "rapid (4, 0, 3)"]


def test_radius_is_read_in_inch():
    moves = [block.motion for block in run("G70 G02 X2 R1 F10\nG01 Z[V.G.R]")]
    assert moves[-1].target[2] == 25.4


@pytest.mark.parametrize(
    "reads",
    [
        "X[@gap]",
        "$IF @ GAP == 5\n$ENDIF",
        "#VAR\nV.L.A = @GAP\n#ENDVAR",
        "#COMMENT BEGIN\n%no header\n#COMMENT END\nX[1 + \\\n@GAP]",
        "$IF EXIST[@GAP]\n$ENDIF",
        "LL CYCLE [NAME=NEXT @GAP=@GAP]",
    ],
)
def test_a_subroutine_may_read_what_its_call_gives_anywhere(reads):
    text = f"%L NEXT\nX[@GAP]\nM29\n%L SUB\n{reads}\nM29\n%MAIN\nG00\nLL CYCLE [NAME=SUB @GAP=5]\nLL CYCLE [NAME=SUB @GAP=6]\nM30"
    assert lines(text)[-1] == "end"


def test_a_subroutine_may_ask_for_parameters_by_their_number():
    text = "%L SUB\n$FOR P1 = 1, 9, 1\n$IF V.G.@P[P1].VALID\nX[P1]\n$ENDIF\n$ENDFOR\nM29\n%MAIN\nG00\nLL CYCLE [NAME=SUB {}]\nM30"
    assert lines(text.format("@P4=1 @P7=1"))[:2] == ["rapid (4, 0, 0)", "rapid (7, 0, 0)"]
    with pytest.raises(ProgramError, match=r"P-ERR-21596 .*: SUB does not read parameter @GAP; parameters .*: @P$"):
        run(text.format("@P4=1 @GAP=1"))


def test_a_line_that_cannot_be_read_is_no_fault_of_its_callers():
    text = "%L SUB\nX[@GAP] )\nM29\n%MAIN\nLL CYCLE [NAME=SUB @GAP=5]\nM30"
    assert [error.number for error in check(text, "a.nc", plain_channel(AXES))] == [21007]
