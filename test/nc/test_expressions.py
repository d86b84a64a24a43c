"""Expressions against Python's own arithmetic, functions against the math library, rules of variables."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from nc_support import lines, run

from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.program import Limits


def value(expression: str, before: str = "") -> float:
    """The value of an expression, as the target of an axis."""
    return run(f"{before}\nG01 F1 X=[{expression}] + 1000000")[-1].motion.target[0] - 1e6


numbers = st.integers(0, 999).map(float) | st.integers(1, 99999).map(lambda n: n / 1000.0)
BINARY = {"+": "+", "-": "-", "*": "*", "/": "/", "==": "==", "!=": "!=", "<": "<", "<=": "<=", ">": ">", ">=": ">="}


def pair(operands):
    """One expression in the language of NC programs and the same in Python."""
    operator = st.sampled_from(sorted(BINARY))

    def joined(parts):
        (left, left_python), sign, (right, right_python) = parts
        python = f"({left_python}) {BINARY[sign]} ({right_python})"
        return f"[{left}] {sign} [{right}]", f"float({python})"

    negative = operands.map(lambda both: (f"-[{both[0]}]", f"-({both[1]})"))
    return st.tuples(operands, operator, operands).map(joined) | negative


leaves = numbers.map(lambda number: (f"{number:.3f}", f"{number:.3f}"))
expressions = st.recursive(leaves, pair, max_leaves=12)


@given(expressions)
def test_an_expression_has_the_value_that_python_gives_it(both):
    written, python = both
    program = parse_program(f"P1 = {written}\n$IF P1 == P1\nX=P1\n$ENDIF\nM30", "a.nc")
    try:
        expected = eval(python)  # of our own text
    except ZeroDivisionError:
        with pytest.raises(ProgramError, match="division by 0"):
            list(interpret(program, (0.5,), plain_channel("X")))
        return
    targets = [block.motion.target[0] for block in interpret(program, (math.pi,), plain_channel("X")) if block.motion]
    assert targets == [expected]


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("1 + 2 * 3", 7.0), ("[1 + 2] * 3", 9.0), ("2 * 3 ** 2", 18.0), ("-2 ** 2", -4.0), ("2 ** -1", 0.5),
        ("2 ** 3 ** 2", 512.0), ("10 - 4 - 3", 3.0), ("12 / 4 / 3", 1.0), ("11 MOD 3", 2.0), ("[-11] MOD 3", -2.0),
        ("1 < 2 && 3 > 2", 1.0), ("0 || 0", 0.0), ("1 XOR 1", 0.0), ("1 OR 0 AND 0", 1.0), ("1 + 1 == 2", 1.0),
        ("6 & 3", 2.0), ("6 | 3", 7.0), ("6 ^ 3", 5.0), ("1 | 6 & 3", 3.0), ("INV[0]", -1.0), ("NOT[0.4]", 1.0),
        ("NOT[0.5]", 0.0), ("0.4 || 0.4", 0.0), ("'H2FF'", 767.0), ("'B1001'", 9.0), ("TRUE + TRUE", 2.0),
        ("+5 - -3", 8.0), ("- - 3", 3.0), ("SQR[3]", 9.0), ("INT[-2.7]", -2.0), ("FRACT[2.75]", 0.75),
        ("ROUND[2.5]", 3.0), ("ROUND[-2.5]", -3.0), ("FLOOR[-2.5]", -3.0), ("CEIL[-2.5]", -2.0), ("SIGN[-7]", -1.0),
        ("MIN[3, 1, 2]", 1.0), ("MAX[3, 1, 2]", 3.0), ("ABS[-4]", 4.0), ("DEXP[3]", 1000.0), ("LOG[1000]", 3.0),
        ("ATAN2[1, -1]", 135.0), ("ACOT[1]", 45.0), ("TAN[45]", 1.0), ("COT[90]", 0.0), ("COS[60]", 0.5),
        ("COS[90]", 0.0), ("SIN[180]", 0.0), ("SIN[-30]", -0.5), ("SIN[390]", 0.5), ("COS[-120]", -0.5),
        ('LEN["abc"]', 3.0), ('FIND["abc", "c"]', 3.0), ('FIND["abc", "d"]', 0.0), ('ORD["A"]', 65.0),
        ('ORD["AB", 2]', 66.0), ('STR_TO_REAL["2.5"]', 2.5), ('STR_TO_INT["2.5"]', 3.0),
        ('LEFT["Hello", 2] == "He"', 1.0), ('RIGHT["Hello", 2] == "lo"', 1.0), ('RIGHT["Hello", 0] == ""', 1.0),
        ('MID["How are you?", 3, 5] == "are"', 1.0), ('INSERT["ac", "b", 1] == "abc"', 1.0), ('CHR[65] == "A"', 1.0),
        ('DELETE["abcd", 2, 2] == "ad"', 1.0), ('REPLACE["abcd", "x", 2, 2] == "axd"', 1.0), ('"a" + 5 == "a5"', 1.0),
        ('INT_TO_STR[2.6] == "3"', 1.0), ('REAL_TO_STR[2.6] == "2.6"', 1.0), ('"a" == "b"', 0.0), ('"a" != "b"', 1.0),
    ],
)  # fmt: skip
def test_rules_of_operators_and_functions(expression, expected):
    assert value(expression) == expected


@given(st.floats(-720.0, 720.0))
def test_angles_are_degrees(angle):
    turned = math.radians(math.fmod(angle, 360.0))
    assert value(f"1000 * SIN[{angle:.6f}]") == pytest.approx(1000.0 * math.sin(turned), abs=2e-4)
    assert value(f"1000 * COS[{angle:.6f}]") == pytest.approx(1000.0 * math.cos(turned), abs=2e-4)


@pytest.mark.parametrize("function", ["SIN", "COS", "TAN"])
def test_arc_functions_undo_the_functions(function):
    for angle in (1.0, 12.5, 44.0, 80.0):
        assert value(f"A{function}[{function}[{angle}]]") == pytest.approx(angle, abs=1e-9)


@given(st.floats(0.001, 99.0))
def test_powers_and_logarithms(x):
    x = round(x, 6)
    assert value(f"SQRT[{x:.6f}]") == pytest.approx(math.sqrt(x), abs=1e-9)
    assert value(f"LN[{x:.6f}]") == pytest.approx(math.log(x), abs=1e-9)
    assert value(f"EXP[{x / 10.0:.6f}] / 100") == pytest.approx(math.exp(round(x / 10.0, 6)) / 100.0, abs=1e-9)


def test_a_parameter_of_a_parameter_and_arrays_of_parameters():
    before = "#VAR\nP5[2][3] = [1, 2, 3, 4, 5, 6]\n#ENDVAR\nP1 = 2 P2 = 1"
    assert value("PP2", before) == 2.0
    assert value("P[P2]", before) == 2.0
    assert value("P5[1][P1]", before) == 6.0
    assert value("P[5][0][1]", before) == 2.0


def test_combined_assignments():
    assert value("P1", "P1 = 10 P1 += 5 P1 *= 2 P1 -= 6 P1 /= 4") == 6.0


def test_a_line_is_executed_from_left_to_right():
    (first, second) = run("P1 = 5 G00 X=P1 P1 = P1 + 1 Y=P1\nX=P1")
    assert (first.motion.target, second.motion.target) == ((5.0, 6.0, 0.0), (6.0, 6.0, 0.0))


def test_words_with_expressions_are_checked_as_words_with_numbers():
    (block,) = run("P1 = 500 S[M3 REV[P1 * 2]] S2[M4 REV=P1 + 1] T[P1 / 100] M[4 + 4]")
    assert [function[:2] for function in block.functions] == [("T", 5), ("S", 3), ("S2", 4), ("M", 8)]


def test_programs_that_read_what_the_run_knows_wait_for_the_path():
    program = parse_program("G00 X10\nX[V.A.ACT_POS.Y * 2]\nM30", "a.nc")
    with pytest.raises(ProgramError) as refused:
        list(interpret(program, (0.0, 0.0), plain_channel("XY")))
    assert str(refused.value) == (
        "P-ERR-21438 a.nc line 2 column 1 'X[V.A.ACT_POS.Y * 2]': the line reads what is known only while the program runs"
    )


@pytest.mark.parametrize("count", [9, 10])
def test_the_limit_of_repeats_is_a_parameter(count):
    program = parse_program(f"$FOR P1 = 0, {count}, 1\n$ENDFOR\nM30", "a.nc")
    blocks = interpret(program, (0.0,), plain_channel("X")._replace(limits=Limits(repeats=9)))
    if count == 10:
        with pytest.raises(ProgramError, match="repeated lines 9 times"):
            list(blocks)
    else:
        assert [block.stop for block in blocks] == ["end"]


def test_the_unit_of_lengths_is_read():
    assert lines("G71\nX[V.G.MASS_MM + 1]\nG70\nX[V.G.MASS_MM]") == ["rapid (1, 0, 0)", "rapid (25.4, 0, 0)"]


@pytest.mark.parametrize("word", ["F=1000/2", "F=[500]", "F=P1 + 250", "F[1000/2]"])
def test_a_word_takes_an_expression_behind_its_equals_sign(word):
    assert lines(f"P1 = 250\nG01 X1 {word}") == ["line (1, 0, 0) feed 8.333333"]
