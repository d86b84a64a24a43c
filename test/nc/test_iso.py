"""The vocabulary iso: headers, cycles against closed forms, offsets, fast and careful reading, random programs."""

import random
from itertools import pairwise
from math import ceil

import pytest
from hypothesis import given
from hypothesis import strategies as st
from nc_support import HERE, TOOLS, lines, run

from cnc_ptp.nc.blocks import plain_block
from cnc_ptp.nc.canonical import Dwell, LinearMove, Source
from cnc_ptp.nc.check import check
from cnc_ptp.nc.contour import Contour, Smoothing, Transition
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow.lines import Line
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.iso.lines import iso_line
from cnc_ptp.nc.iso.vocabulary import ISO
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.vocabulary import TWINCAT
from cnc_ptp.parameters import OffsetTables

AXES = ("X", "Y", "Z")
HEADERS = [
    "G21 G90 G94 G54 G40 G49 G80",
    "G21 G90 G94 G54 G40 G49 G80 G69 G15 G50.1",
    "G17 G20 G90 G94 G54 G64 P0.001",
    "%\nO0001 (PART)\nG21",
    "G0 G17 G40 G49 G80 G90",
    "G00G20G17G90G40G49G80",
    "N100 G21\nN102 G0 G17 G40 G49 G80 G90",
    "G17 G54 G40 G49 G80 G90 G91.1 G61.1 G97 G98",
]


@pytest.mark.parametrize("header", HEADERS)
def test_headers_run_and_do_nothing(header):
    program = parse_program(f"{header}\nM30\n%", "a.nc", vocabulary=ISO)
    assert [block.stop for block in interpret(program, (0.0,) * 3, plain_channel(AXES))] == ["end"]


@pytest.mark.parametrize(
    ("text", "tolerance"),
    [("G64 P0.5", 0.5), ("G64", None), ("G20 G64 P0.001", 0.0254), ("G64 P1\nG61", None), ("G64 P1\nG61.1", None)],
)
def test_the_tolerance_of_g64_is_in_the_state(text, tolerance):
    state = ModalState()
    run(text, dialect="iso", state=state)
    contour = state.transition.contour
    assert (None if contour is None else contour.path_dev) == (tolerance and pytest.approx(tolerance, abs=1e-12))
    assert state.transition.exact == ("G61" in text)


def test_q_of_g64_smooths_short_blocks():
    state = ModalState()
    run("G64 P0.5 Q0.02", dialect="iso", state=state)
    assert state.transition == Transition(exact=False, contour=Contour(path_dev=0.5), smoothing=Smoothing(0.02))
    run("G64 P0.5 Q0.02\nG61", dialect="iso", state=state)
    assert state.transition.stops


levels = st.integers(-9999, 9999).map(lambda value: value / 100.0)
steps = st.integers(100, 5000).map(lambda value: value / 100.0)


@given(levels, steps, steps, steps, st.booleans(), st.integers(1, 4), st.sampled_from([73, 83]))
def test_deep_holes_go_down_by_their_pecks(r, depth, peck, above, to_r, holes, code):
    bottom, initial = r - depth, r + above
    blocks = run(
        f"G0 Z{initial:.2f}\nG91 {'G99' if to_r else 'G98'} G{code} X5 R{-above:.2f} Z{-depth:.2f} Q{peck:.2f} F60 L{holes}",
        dialect="iso",
        start=(0.0, 0.0, initial - 1.0),
    )
    moves = [block.motion for block in blocks if isinstance(block.motion, LinearMove)]
    cuts = [move.target for move in moves if not move.rapid]
    count = ceil(round(depth / peck, 9))
    expected = [max(bottom, r - n * peck) for n in range(1, count + 1)]
    assert [cut[2] for cut in cuts] == pytest.approx(expected * holes, abs=1e-9)
    assert [cut[0] for cut in cuts] == [5.0 * hole for hole in range(1, holes + 1) for _ in range(count)]
    assert moves[-1].target[2] == pytest.approx(r if to_r else initial, abs=1e-9)
    deepest = {5.0 * hole: r + 0.1 for hole in range(holes + 1)}
    for before, move in pairwise(moves):
        x, z = move.target[0], move.target[2]
        if x != before.target[0]:
            assert move.rapid and z >= r - 1e-9
        if move.rapid and z < before.target[2]:
            assert z >= min(r, deepest[x] + 0.254) - 1e-9
        deepest[x] = min(deepest[x], z)


def test_a_cycle_ends_with_a_path_function():
    text = "G81 X1 Z-5 R1 F60\nG0 X2\nG81 X3 Z-5 F60"
    with pytest.raises(ProgramError, match=r"P-ERR-21807 .* G81 without R: the retract plane"):
        run(text, dialect="iso")


def test_the_return_level_stays_when_a_cycle_ends():
    moves = lines("G0 Z9\nG99 G81 X1 Z-5 R1 F60\nG80\nG0 Z9\nG81 X2 Z-5 R1", dialect="iso")
    assert moves[-1] == "rapid (2, 0, 1)"


def test_offsets_of_cycles_and_inch():
    moves = lines("G10 L2 P1 X10 Z100\nG20\nG0 X0 Z2\nG81 X1 Z-1 R1 F10", dialect="iso")
    assert moves == [
        "rapid (10, 0, 150.8)",
        "rapid (35.4, 0, 150.8)",
        "rapid (35.4, 0, 125.4)",
        "line (35.4, 0, 74.6) feed 4.233333",
        "rapid (35.4, 0, 150.8)",
    ]


def test_the_reference_point_is_exact_whatever_the_offsets():
    blocks = run("G10 L2 P1 X0.1 Y0.2 Z0.3\nG92 X77.7\nG1 X1.1 Y2.2 Z3.3 F60\nG91 G28 X0 Y0 Z0", dialect="iso")
    assert blocks[-1].motion == LinearMove((0.0, 0.0, 0.0), True, 0.0)
    blocks = run("G10 L2 P1 X0.1\nG92 X77.7\nG0 X3\nG53 G0 X12.3\nX5", dialect="iso")
    assert blocks[1].motion == LinearMove((12.3, 0.0, 0.0), True, 0.0)
    assert blocks[2].motion.target[0] == pytest.approx(5.0 - 77.7, abs=1e-9)


WITH_G53 = (
    "G49|G43 H0|G43 H1|G43 H2|G54|G55|G56|G57|G58|G59|G59.1|G54.1 P1|G54.1 P90|G17|G18|G19|G21|G61|G64 P1|G90|"
    "T2|T2 M6|M8|G43 H2 G59 G19 T3"
)


@pytest.mark.parametrize("path", ["G0", "G1 F600"])
@pytest.mark.parametrize("codes", WITH_G53.split("|"))
def test_positions_of_g53_are_those_of_the_machine_with_any_code(codes, path):
    """Whatever is in the block, in any order; behind it the codes count as without G53."""
    setup = "".join(f"G10 L2 P{index} X{index} Y{10 * index} Z{100 * index}\n" for index in range(1, 8))
    setup += "G92 X0.1 Z0.7\nG43 H1\nG0 X1 Y1 Z1\n"
    options = {"dialect": "iso", "tools": TOOLS["with_t"]}
    plain = run(f"{setup}{codes}\n{path} X3 Y4 Z5", **options)[-1].motion
    for block in (f"G53 {codes} {path}", f"{codes} G53 {path}", f"{path} {codes} G53", f"{path} G53 {codes}"):
        moves = [each.motion for each in run(f"{setup}{block} X2 Y-3 Z-4\nX3 Y4 Z5", **options) if each.motion]
        assert moves[-2].target == (2.0, -3.0, -4.0)
        assert moves[-1].target == pytest.approx(plain.target, abs=1e-9)


def test_g53_with_one_axis_leaves_the_others_where_they_are():
    moves = lines("G10 L2 P2 X7 Y7 Z7\nG0 X1 Y2 Z3\nG53 G55 Z-6\nG53 G54", dialect="iso")
    assert moves[:2] == ["rapid (1, 2, 3)", "rapid (1, 2, -6)"]


def test_t_never_selects_a_tool_length():
    blocks = run("G43 H1 G0 Z0\nT2 Z1\nT2 M6\nZ2", dialect="iso", tools=TOOLS["with_t"])
    assert [block.motion.target[2] for block in blocks if block.motion] == [74.75, 75.75, 76.75]
    assert [function.letter for block in blocks for function in block.functions] == ["T", "T", "M"]


def test_a_zero_offset_of_the_machine_is_on_at_the_start():
    blocks = run("G0 X1\nG53 X1", dialect="iso", offsets=OffsetTables(zero={1: (10.0, 0.0, 0.0)}))
    assert [block.motion.target[0] for block in blocks] == [11.0, 1.0]


def test_stop_comes_behind_all_motions_of_its_block():
    blocks = run("G0 X5 Z5\nG28 X4 M5 M0\nM30", dialect="iso")
    assert [(block.motion is not None, block.stop) for block in blocks] == [
        *[(True, "")] * 3,
        (False, "M00"),
        (False, "end"),
    ]


def test_subroutines_may_come_first():
    program = parse_program("%\nO7\nG91 G0 X1\nG90 M99\nO1\nM98 P7 L3\nM98 P0007\nM30\n%", "a.nc", vocabulary=ISO)
    assert [
        block.motion.target[0] for block in interpret(program, (0.0,) * 3, plain_channel(AXES)) if block.motion
    ] == [1, 2, 3, 4]


def test_dwell_and_spindle_position():
    assert [block.motion for block in run("G4 P1.5\nG04 X.5", dialect="iso")] == [Dwell(1.5), Dwell(0.5)]
    assert lines("S100 M19 R45", dialect="iso") == ["S[M19 REV100 POS45]"]


def test_other_words_of_the_first_vocabulary_are_untouched():
    assert TWINCAT.g_codes[21.0].group == "mirror" and ISO.g_codes[21.0].group == "units"
    assert not set("PLQ") & (TWINCAT.value_words | TWINCAT.function_words)


values = st.integers(-999_999, 999_999).map(lambda value: value / 1000.0)
CODES = [0, 1, 2, 17, 21, 80, 81, 90, 91, 94, 98, 90.1, 61.1]


@given(st.lists(st.tuples(st.sampled_from("GGXYZABFIJKRSTN"), values), max_size=6), st.integers(0, 2**32))
def test_fast_and_careful_reading_agree(pairs, seed):
    draw = random.Random(seed)
    words = [
        letter + draw.choice(["", " "]) + (str(draw.choice(CODES)) if letter == "G" else f"{value:.3f}")
        for letter, value in pairs
    ]
    source = Source("a.nc", 1, 0, " ".join(words).rstrip())
    fast = plain_block(source.file, source.line, source.text, ISO)
    if fast is not None:
        line = Line(1, source, 2, -1)
        iso_line(line)
        assert fast == (line.block or fast._replace(codes=(), words={}))


WORDS = """
    G0 G1 G2 G3 G4 G10 G15 G16 G50.1 G51 G51.1 G65 G68 G69 G17 G18 G19 G20 G21 G28 G43 G49 G52 G53 G54 G54.1 G55 G59.3 G61 G64 G73 G80 G81 G82 G83 G85 G86
    G89 G90 G91 G90.1 G92 G92.1 G92.2 G92.3 G93 G94 G98 G99 M3 M5 M6 M19 M30 M98 M99 X10 Y-5 Z3 Z-9 R2 R-1 Q1 Q.01 P1 P2
    L2 L20 K3 F100 F0 S500 T1 H0 H1 D1 I5 J-5 N10 O1 O2 % / /2 ( ) ; = #1 [1] . - + é A1
"""
words = st.sampled_from(WORDS.split())
breaks = st.sampled_from(["\n", "\n", " ", "\nM30\nO2\n", "\nM99\n", "\n%\n"])


@given(st.lists(st.one_of(words, breaks)))
def test_random_words_raise_nothing_but_program_errors(parts):
    text = " ".join(parts)
    raised = ""
    try:
        for _ in interpret(parse_program(text, "a.nc", vocabulary=ISO), (0.0,) * 3, plain_channel(AXES)):
            pass
    except ProgramError as error:
        raised = str(error)
        assert error.caret and 1 <= error.column <= len(error.text) + 1
    found = [str(error) for error in check(text, "a.nc", plain_channel(AXES, vocabulary=ISO))]
    assert raised in found if raised else found == []


def test_at_least_twenty_programs_are_in_the_style_of_cam_systems():
    programs = list((HERE / "golden").glob("cam_*.nc"))
    assert len(programs) >= 20 and sum("iso" in path.name for path in programs) >= 10


def test_g28_goes_to_the_reference_point_of_the_axis():
    blocks = run("G0 X5 Y5 Z5\nG91 G28 Z1\nG28 X0 Y0", dialect="iso", references=(1.5, -2.0, 40.0))
    targets = [block.motion.target for block in blocks if block.motion]
    assert targets == [(5.0, 5.0, 5.0), (5.0, 5.0, 6.0), (5.0, 5.0, 40.0), (1.5, -2.0, 40.0)]


@pytest.mark.parametrize("line", ["G69", "G15", "G50.1", "G50.1 X7 Y7", "G69 G15 G50.1 G90"])
def test_the_end_of_what_is_never_on_changes_nothing(line):
    """The stream is that of the program without it."""
    before, behind = "G0 X5 Y5", "G91 X2\nG1 Y3 F100\nG18 G2 X4 Z0 R9\nM30"
    blocks = run(f"{before}\n{line}\n{behind}", dialect="iso")
    plain = run(f"{before}\n\n{behind}", dialect="iso")
    assert [block._replace(source=plain[0].source) for block in blocks] == [
        block._replace(source=plain[0].source) for block in plain
    ]


def test_the_end_of_the_rotation_stands_beside_a_motion():
    assert run("G69 G0 X5", dialect="iso")[0].motion.target == (5.0, 0.0, 0.0)
