"""Properties of the language: any spelling gives the same path, the parsers agree, only ProgramError comes out."""

import random

from hypothesis import given
from hypothesis import strategies as st
from nc_support import run

from cnc_ptp.nc.blocks import careful_line, plain_block
from cnc_ptp.nc.canonical import LinearMove, Source
from cnc_ptp.nc.canonical_text import format_block
from cnc_ptp.nc.check import check
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow.lines import Line
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.vocabulary import TWINCAT

AXES = ("X", "Y", "Z")
values = st.integers(-999_999, 999_999).map(lambda value: value / 1000.0)
points = st.lists(st.tuples(values, values, values), min_size=1, max_size=20)
VOCABULARY = """
    G0 G1 G01 G2 G3 G04 G4 G17 G18 G19 G90 G91 G161 G162 G165 G54 M0 M3 M4 M5 M8 M29 M30 M19 N10 X10 X-5.5 Y3 Z.5 C1 X=3
    X1=2 I5 J-5 K1 R10 R-3 F100 F0 S500 S[M3 S[M3] S2[M5] S2[REV10] T1 D0 D1.5 / /2 % %L %UP LL UP ( ) ; = - . 12 #IF E3
    [ ] é G135 G136 G137 S[G135 G136=90 G136=90] S2[G137] S2[G136=101] X[COMP Y[COMP ON OFF FRICT FRICT] X[] Z[COMP]
    [ ] é S.POS=5 S.POS POS9 S[M19 G74] REV1 S1 G74 G167 M19 M41 #EXPL SYN] #MAIN SPINDLE [S2] [S9] #AX LINK ON OFF ALL
    [1, S2=S] #ENABLE #DISABLE #SET S[DEFAULT_DYNAMIC_DATA] DEFAULT_DYNAMIC_DATA
"""
words = st.sampled_from(VOCABULARY.split())
breaks = st.sampled_from(["\n", "\n", " ", "\t", "%L UP\n", "\n%MAIN\n", "\nM30", "LL UP\n"])
programs = st.lists(st.one_of(words, breaks))


def spelled(letter: str, value: float, draw: random.Random) -> str:
    """One word in a random spelling."""
    text = draw.choice(
        [f"{value:.3f}", f"{value:+.4f}", f"{value!r}", f"{abs(value):09.4f}" if value >= 0 else f"{value:.3f}"]
    )
    letter = draw.choice([letter, letter.lower()])
    return letter + draw.choice(["", " ", "=", " = "]) + text + draw.choice(["", " ", "\t", " (note) "])


@given(points, st.integers(0, 2**32))
def test_any_spelling_gives_the_same_end_points(path, seed):
    draw = random.Random(seed)
    rows = []
    for number, point in enumerate(path, start=1):
        row = [spelled(axis, value, draw) for axis, value in zip(AXES, point, strict=True)]
        row += [draw.choice(["G1", "g01 ", "G 1"]), spelled("F", 60.0 * number, draw)]
        draw.shuffle(row)
        rows.append(
            draw.choice(["", f"N{number}0", " n7 "]) + draw.choice([" ", "  "]) + "".join(row) + draw.choice(["", ";"])
        )
    program = parse_program("\n".join([*rows, "m30"]), "path.nc")
    blocks = list(interpret(program, (0.5e-3, 0.0, 0.0), plain_channel(AXES)))
    assert [block.motion for block in blocks[:-1]] == [
        LinearMove(point, False, float(number))
        for number, (before, point) in enumerate(zip([None, *path], path, strict=False), start=1)
        if before != point
    ]
    assert blocks[-1].stop == "end"


@given(st.lists(st.tuples(st.sampled_from("GXYZABFIJKRSTDN"), values), max_size=6), st.integers(0, 2**32))
def test_fast_and_careful_parser_agree(pairs, seed):
    draw = random.Random(seed)
    text = "".join(
        letter
        + draw.choice(["", " ", "="])
        + (str(draw.choice([0, 1, 17, 90, 135, 136, 137])) if letter == "G" else f"{value:g}")
        + " "
        for letter, value in pairs
    )
    source = Source("a.nc", 1, 0, text.rstrip())
    fast = plain_block(source.file, source.line, source.text, TWINCAT)
    if fast is not None:
        line = Line(1, source, 2, -1)
        careful_line(line)
        assert fast == (line.block or fast._replace(codes=(), words={}))


@given(st.text())
def test_random_text_raises_nothing_but_program_errors(text):
    survives(text)


@given(programs)
def test_random_words_raise_nothing_but_program_errors(parts):
    survives(" ".join(parts))


@given(programs)
def test_check_finds_the_error_that_a_run_raises(parts):
    text = " ".join(parts)
    raised = first_error(text)
    found = [str(error) for error in check(text, "a.nc", plain_channel(AXES))]
    assert (raised is None) == (found == [])
    if raised is not None:
        assert raised in found


def first_error(text: str) -> str | None:
    try:
        for _ in interpret(parse_program(text, "a.nc"), (0.0, 0.0, 0.0), plain_channel(AXES)):
            pass
    except ProgramError as error:
        return str(error)
    return None


def survives(text: str) -> None:
    """Both as a program and as manual blocks; everything that comes out can be formatted and is finite."""
    try:
        for block in run(text):
            assert format_block(block)
            assert "nan" not in format_block(block) and "inf" not in format_block(block)
    except ProgramError as error:
        assert error.caret
        assert 1 <= error.column <= len(error.text) + 1
        assert 1 <= error.line <= text.count("\n") + text.count("\r") + 1
    for error in check(text, "a.nc", plain_channel(AXES)):
        assert str(error).startswith(f"P-ERR-{error.number} a.nc line {error.line} column {error.column} ")
