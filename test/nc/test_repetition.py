"""Loops without an end: found by a state that comes again, or by the limits; loops with an end are left alone."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from nc_support import run

from cnc_ptp.nc.canonical import CanonicalBlock, WaitForPath
from cnc_ptp.nc.check import check
from cnc_ptp.nc.expressions.values import Values
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.iso.vocabulary import ISO
from cnc_ptp.nc.measuring import Touch
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.program import Limits

FEW = plain_channel("XYZ")._replace(limits=Limits(repeats=50))
ENDLESS = "a loop without an end: the program comes back with the same positions and values each time"


def up_to_the_fault(text: str, **options: object) -> tuple[int, ProgramError]:
    """Blocks that a program makes before its fault."""
    program = parse_program(text + "\nM30", "a.nc", **options)
    made = 0
    with pytest.raises(ProgramError) as caught:
        for _ in interpret(program, (0.0,) * 3, FEW):
            made += 1
    return made, caught.value


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("$WHILE 1\n$ENDWHILE", 2),
        ("$WHILE 1\nG01 X10 F1000\nX20\n$ENDWHILE", 4),
        ("$WHILE 1\nG02 X10 I5 F1000\nG02 X0 I-5\n$ENDWHILE", 4),
        ("N1: G00 X1\nX2\n$GOTO N1", 3),
        ("$DO\nM100\n$ENDDO 1", 3),
        ("$REPEAT\n$UNTIL 0", 2),
        ("P1 = 0\n$WHILE P1 < 5\nG91 X1\nX-1\nP2 = 1\n$ENDWHILE", 6),
        ("$WHILE 1\n$FOR P1 = 1, 3, 1\nG00 X=P1\n$ENDFOR\n$ENDWHILE", 5),
        ("P1 = 0\n$WHILE 1\nP1 = [P1 + 1] MOD 5\nG00 X=P1\n$ENDWHILE", 5),
        ('V.P.A = "A"\n$WHILE 1\n$IF V.P.A == "A"\nV.P.A = "B"\n$ELSE\nV.P.A = "A"\n$ENDIF\n$ENDWHILE', 8),
        ("$WHILE 1\nG92 X1\nG00 X1 Y1\n#ROTATION ON [ANGLE=30]\nG00 X0 Y0\n#ROTATION OFF\n$ENDWHILE", 7),
        ("%L A\nV.L.I = 0\n$WHILE V.L.I < 1\nG00 X1\n$ENDWHILE\nM29\n%MAIN\nLL A", 5),
        ("%L A\nG00 X1\nX2\nM29\n%MAIN\n$WHILE 1\nLL A\n$ENDWHILE", 8),
    ],
)
def test_a_loop_that_comes_back_with_the_same_state_is_found_at_once(text: str, line: int) -> None:
    made, error = up_to_the_fault(text)
    shown = text.splitlines()[line - 1]
    assert str(error) == f"P-ERR-21583 a.nc line {line} column 1 '{shown}': {ENDLESS}"
    assert made <= 20


def test_a_main_program_that_calls_itself_is_no_loop_without_an_end() -> None:
    _, error = up_to_the_fault("O1\nG0 X1\nM98 P2\nM30\nO2\nM98 P2\nM99", vocabulary=ISO)
    assert error.number == 21020


COUNTS = "P1 = 0\n$WHILE 1\nP1 += 1\n{}\n$ENDWHILE"


@pytest.mark.parametrize(
    ("text", "place", "what"),
    [
        (COUNTS.format(""), "line 5 column 1 '$ENDWHILE'", "repeated lines 50 times"),
        (COUNTS.format("G00 X=P1\nX0"), "line 4 column 1 'G00 X=P1'", "made blocks of repeated lines 50 times"),
        (COUNTS.format("P2 = 1\n" * 30), "line 26 column 1 'P2 = 1'", "executed repeated lines 500 times"),
        (
            "%L A\nG00 X1\nX2\nX3\nM29\n%MAIN\n" + "LL A\n" * 20,
            "line 4 column 1 'X3'",
            "made blocks of repeated lines 50 times",
        ),
        ("$FOR P1 = 0, 9, 0.001\n$ENDFOR", "line 2 column 1 '$ENDFOR'", "repeated lines 50 times"),
    ],
    ids=["jumps", "blocks", "lines", "calls", "for"],
)
def test_a_loop_that_counts_ends_at_the_limits(text: str, place: str, what: str) -> None:
    _, error = up_to_the_fault(text)
    reason = f"the program has {what} (P-CHAN-90002): does it have a loop without an end?"
    assert str(error) == f"P-ERR-21578 a.nc {place}: {reason}"


def test_what_is_executed_once_does_not_count() -> None:
    text = "%L A\n" + "G00 X1\nX2\n" * 40 + "M29\n%MAIN\n$FOR P1 = 1, 2, 1\n$ENDFOR\nLL A\n" + "X3\nX4\n" * 40
    assert len(list(interpret(parse_program(text + "M30", "a.nc"), (0.0,) * 3, FEW))) == 161


@given(
    factor=st.integers(0, 6), added=st.integers(0, 6), modulus=st.integers(1, 30), first=st.integers(0, 30),
    wanted=st.integers(0, 29),
)  # fmt: skip
def test_a_sequence_of_numbers_ends_or_comes_again(factor, added, modulus, first, wanted) -> None:
    seen, value = [first], first
    while value != wanted and seen.count(value) < 2:
        value = (factor * value + added) % modulus
        seen.append(value)
    text = f"P1 = {first}\n$WHILE P1 != {wanted}\nP1 = [{factor} * P1 + {added}] MOD {modulus}\nG00 X=P1\n$ENDWHILE"
    if value == wanted:
        targets = [block.motion.target[0] for block in run(text) if block.motion is not None]
        moved = [new for old, new in zip([0, *seen[1:]], seen[1:], strict=False) if new != old]
        assert targets == moved
    else:
        with pytest.raises(ProgramError) as caught:
            run(text)
        assert caught.value.number == 21583


@pytest.mark.parametrize(
    ("text", "targets"),
    [
        ("$FOR P1 = 1, 3, 1\nG00 X1\nX0\n$ENDFOR", [1, 0] * 3),
        ("V.P.N[2]\nV.P.N[1] = 3\n$WHILE V.P.N[1] > 0\nV.P.N[1] -= 1\nG00 X1\nX0\n$ENDWHILE", [1, 0] * 3),
        ("N7 G00 X1\n[A] X5\nX1\n$IF V.G.BLOCK_NR == 7\nN8\n$GOTO [A]\n$ENDIF", [1, 5, 1, 5, 1]),
    ],
)
def test_loops_with_an_end_are_run_to_it(text: str, targets: list[float]) -> None:
    text = text.replace("V.P.N[2]\n", "#VAR\nV.P.N[2]\n#ENDVAR\n")
    assert [block.motion.target[0] for block in run(text) if block.motion is not None] == targets


@pytest.mark.parametrize("waits", ["#FLUSH WAIT", "G74 Y1", "#TIMER READ [ID=0]"])
def test_a_loop_that_reads_the_run_is_none_without_an_end(waits: str) -> None:
    """Ten times the same, and then the run says something else."""
    program = parse_program(f"$WHILE V.A.ACT_POS.X < 1\nG00 Z1\nZ0\n{waits}\n$ENDWHILE\nM30", "a.nc")
    channel, state = plain_channel("XYZ"), ModalState()
    values = Values(channel, state)
    passes = 0
    for block in interpret(program, (0.0,) * 3, channel, state=state, values=values, runs=True):
        if reads_actual(block):
            passes += 1
            values.actual = (float(passes > 10), 0.0, 0.0)
    assert passes == 11


def reads_actual(block: CanonicalBlock) -> bool:
    return block.source.line == 1 and any(isinstance(each, WaitForPath) for each in block.functions)


def test_a_measuring_run_may_be_tried_again() -> None:
    """The signal comes at the tenth attempt."""
    program = parse_program("$REPEAT\nG100 X10 F100\nG00 X0\n$UNTIL V.A.MERF.X\nM30", "a.nc")
    channel, state = plain_channel("XYZ"), ModalState()
    values = Values(channel, state)
    runs = 0
    for block in interpret(program, (0.0,) * 3, channel, state=state, values=values, runs=True):
        if block.motion is not None and block.source.line == 2:
            runs += 1
            at = 10.0 if runs < 10 else 4.0
            values.position = (at, 0.0, 0.0)
            values.touch = Touch((at, 0.0, 0.0) if runs == 10 else None)
    assert runs == 10


def test_a_check_does_not_run_an_endless_program_twice() -> None:
    """The second run collects errors, of which there are none before the end of the first."""
    (error,) = check("G00 X1\n$WHILE 1\nX2\n$ENDWHILE\nX=P9\nM30", "a.nc", FEW)
    assert (error.number, error.line, error.unchecked) == (21583, 4, "what follows depends on it")


def test_large_arrays_are_not_compared_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    """Then the limits find the loop."""
    declared = "#VAR\nV.P.A[90000]\n#ENDVAR\n$WHILE 1\nV.P.A[89999] += 1\n$ENDWHILE\nM30"
    channel = plain_channel("X")._replace(limits=Limits(repeats=2000))
    with pytest.raises(ProgramError) as caught:
        list(interpret(parse_program(declared, "a.nc"), (0.0,), channel))
    assert caught.value.number == 21578
