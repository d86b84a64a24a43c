"""The language rule by rule: spelling of words, modal state, functions and their order, structure, skip, MDI, veto."""

import re

import pytest
from nc_support import lines, run

from cnc_ptp.errors import CncError
from cnc_ptp.nc.canonical import AuxiliaryFunction, CanonicalBlock, LinearMove, Source
from cnc_ptp.nc.canonical_text import format_block
from cnc_ptp.nc.check import check
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.program import Limits
from cnc_ptp.nc.transitions import CONTOUR
from cnc_ptp.nc.vocabulary import TWINCAT

AXES = ("X", "Y", "Z")
CHANNEL = plain_channel(AXES)


def test_the_syntax_of_contour_mode_is_what_it_takes():
    """Each word of each bracket that the texts show, and no other one, is permitted there."""
    shown = {mode: words.split() for mode, words in re.findall(r"\[(\w+) ?(.*?)\]", CONTOUR)}
    assert list(shown) == ["DEV", "DIST", "POS", "OFF"]
    known = {word for words in shown.values() for word in words}
    for mode, words in shown.items():
        assert lines(f"#CONTOUR MODE [{' '.join([mode, *words])}]\nG01 X1 F600")
        point = ["X10"] if mode == "POS" else []
        for word in known - set(point):
            text = f"#CONTOUR MODE [{' '.join([mode, *point, word])}]"
            assert (check(f"{text}\nM30", "t.nc", CHANNEL) == []) == (word in words), text


@pytest.mark.parametrize(
    "text",
    [
        "G01 X10 Y-2.5 F600",
        "G1X10Y-2.5F600",
        "g1x10y-2.5f600",
        "N0010 G01 X+010. Y-02.50 F0600",
        " \tG 1 X 10 Y -2.5 F 600 ",
        "X=10 G=1 F = 600 Y= -2.5",
        "G01 (first) X10 (nested (twice) ; no end) Y-2.5 F600 ; last",
        "G01 X10 Y-2.5 F600 (open to the end",
        "G01 X10 Y-2.5 F600\r",
        "\ufeffG01 X10 Y-2.5 F600",
        "G01 X10 Y-2.5 F600 (Bohrung ø6)",
    ],
)
def test_spelling_does_not_matter(text):
    assert lines(text) == ["line (10, -2.5, 0) feed 10"]


def test_numbers_may_lack_digits_on_one_side():
    assert lines("G0 X.5 Y-.25 Z7.") == ["rapid (0.5, -0.25, 7)"]


def test_source_names_file_line_block_number_and_text():
    (block,) = run("\n\n  N120 G00 X1 ; go \n")
    assert block.source[:4] == ("test.nc", 3, 120, "  N120 G00 X1 ; go")
    assert [block.source.column(word) for word in ("N", "G0", "G00", "X", "Y")] == [3, 8, 8, 12, 1]


def test_long_axis_names_need_an_equals_sign():
    axes = ("X1", "Y_ACHSE", "Z")
    assert lines("G1X1=10 Y_ACHSE=-5.5Z3F60", axes=axes) == ["line (10, -5.5, 3) feed 1"]


def test_absolute_and_relative():
    assert lines("G00 X10 Y10\nG91 X5\nX5 Z-1\nG90 X1") == [
        "rapid (10, 10, 0)",
        "rapid (15, 10, 0)",
        "rapid (20, 10, -1)",
        "rapid (1, 10, -1)",
    ]


def test_relative_acts_in_its_own_block_wherever_it_stands():
    assert lines("G00 X10\nX5 G91") == ["rapid (10, 0, 0)", "rapid (15, 0, 0)"]


def test_path_function_and_feed_are_modal():
    assert lines("F1200\nG01 X10\nY10\nG00 X0\nG01 Y0 F60") == [
        "line (10, 0, 0) feed 20",
        "line (10, 10, 0) feed 20",
        "rapid (0, 10, 0)",
        "line (0, 0, 0) feed 1",
    ]


def test_initial_state_is_the_documented_one():
    state = ModalState()
    assert (TWINCAT.g_codes[state.path].name, f"G{state.plane}") == ("G00", "G17")
    assert state.absolute and not state.centre_absolute  # G90, G162


def test_blocks_without_anything_to_do_give_nothing():
    assert lines("N10\nG90\nG01 F100\nF200\n(comment)\nG02 R5\nG00 X0 Y0") == []


def test_dwell_forms():
    text = "G04 5.5\nG04 X4.5\nG4F0.25\nG04 .5\nG04 X0\nS200\nG04 S10"
    expected = ["dwell 5.5 s", "dwell 4.5 s", "dwell 0.25 s", "dwell 0.5 s", "dwell 0 s", "S[REV200]", "dwell 3 s"]
    assert lines(text) == expected


def test_dwell_in_a_channel_without_axes():
    assert lines("G04 F1\nG04 2", axes=()) == ["dwell 1 s", "dwell 2 s"]


def test_dwell_changes_neither_path_function_nor_feed_nor_speed():
    assert lines("G01 X1 F600 S100\nG04 F2\nG04 S50\nX2\nM03") == [
        "S[REV100] | line (1, 0, 0) feed 10",
        "dwell 2 s",
        "dwell 30 s",
        "line (2, 0, 0) feed 10",
        "S[M3 REV100]",
    ]


def test_functions_stand_before_the_motion_in_a_fixed_order():
    assert lines("M08 S2[M4 REV500] G01 X10 M03 F600 S1000 M77 D2 T1") == [
        "T1 | D2 | S[M3 REV1000] | S2[M4 REV500] | M8 | M77 | line (10, 0, 0) feed 10"
    ]


def test_speed_is_kept_for_the_next_rotation():
    """The sequence of the vendor's description of M03, M04, M05."""
    text = "S1000\nM03\nM04\nS500\nM05 S300\nM04\nM05\nM03 S1000\nM30"
    assert lines(text) == [
        "S[REV1000]",
        "S[M3 REV1000]",
        "S[M4 REV1000]",
        "S[REV500]",
        "S[M5]",
        "S[M4 REV300]",
        "S[M5]",
        "S[M3 REV1000]",
        "end",
    ]


def test_several_spindles_in_one_block():
    assert lines("S[M03 REV=1000]  S2[M04 REV2000]\nS[M05]S2[REV1500]\nS[M04]\nS2=300") == [
        "S[M3 REV1000] | S2[M4 REV2000]",
        "S[M5] | S2[REV1500]",
        "S[M4 REV1000]",
        "S2[REV300]",
    ]


def test_bracket_follows_a_word_without_blank():
    assert lines("G1X10F60S2[M3REV100]") == ["S2[M3 REV100] | line (10, 0, 0) feed 1"]


def test_main_spindle_is_the_first_whatever_its_name():
    assert lines("M03 S1000", spindles=("SPINDLE", "S2")) == ["SPINDLE[M3 REV1000]"]


def test_stops_act_behind_the_motion_of_their_block():
    assert lines("G00 X10 M00\nM01\nX20 M30\nX30") == ["rapid (10, 0, 0) | M00", "M01", "rapid (20, 0, 0) | end"]


def test_subroutines_nest_and_keep_the_modal_state():
    text = "%L a\nG91 X1 LL B\nM29\n%L b (deeper)\nN7 Y1\nM17\n%MAIN ; here\nG00 X10 ll a\nG90 X5 LL A\nM02"
    assert lines(text) == [
        "rapid (10, 0, 0)",
        "rapid (11, 0, 0)",
        "rapid (11, 1, 0)",
        "rapid (5, 1, 0)",
        "rapid (6, 1, 0)",
        "rapid (6, 2, 0)",
        "end",
    ]


def test_subroutine_may_end_the_program():
    assert lines("%L a\nX1 M30\n%MAIN\nLL a\nX2\nM30") == ["rapid (1, 0, 0) | end"]


def test_subroutine_called_in_a_loop_of_blocks_returns_to_the_right_place():
    text = "%L UP\nG91 X1\nM29\n%\n" + "LL UP\n" * 25 + "G90 X0\nM30"
    assert lines(text)[-2:] == ["rapid (0, 0, 0)", "end"]
    assert len(lines(text)) == 27


def test_return_with_motion():
    assert lines("%L UP\nX1 M29\nX2\nM29\n%\nLL UP\nX3\nM30") == ["rapid (1, 0, 0)", "rapid (3, 0, 0)", "end"]


def test_call_depth_is_a_parameter():
    text = "%L A\nM29\n%L B\nLL A\nM29\n%\nLL B\nG00 X1\nM30"
    assert lines(text, limits=Limits(call_depth=2)) == ["rapid (1, 0, 0)", "end"]
    with pytest.raises(ProgramError, match="call of subroutine A at depth 2, the limit is 1"):
        lines(text, limits=Limits(call_depth=1))


def test_block_skip_by_level():
    text = "/ X1\n/1 X2\n/2 N10 X3\n/10X4\nX5"
    assert len(lines(text)) == 5
    assert lines(text, block_skip=0b01) == ["rapid (3, 0, 0)", "rapid (4, 0, 0)", "rapid (5, 0, 0)"]
    assert lines(text, block_skip=0b10_0000_0010) == ["rapid (1, 0, 0)", "rapid (2, 0, 0)", "rapid (5, 0, 0)"]


def test_error_column_behind_a_block_skip():
    with pytest.raises(ProgramError) as caught:
        lines("/2 N10 G01 C5")
    assert (caught.value.column, caught.value.reason) == (
        12,
        "axis C is not in the machine; axes of this channel: X, Y, Z",
    )


def test_skipped_end_in_mdi_style_text_just_ends():
    assert lines("X1\n/M30", block_skip=1) == ["rapid (1, 0, 0)"]


def test_caret_stands_under_the_column():
    with pytest.raises(ProgramError) as caught:
        lines("\tG01 X1 F-5")
    error = caught.value
    assert (error.file, error.line, error.column, error.text) == ("test.nc", 1, 9, "\tG01 X1 F-5")
    assert error.caret == "\tG01 X1 F-5\n\t       ^"
    assert error.reason == "feed F-5 is negative"


def test_program_name_and_structure():
    program = parse_program("%L up1\nM29\n% 100 (main)\nM30", "a.nc")
    assert (program.file, program.name, list(program.subroutines)) == ("a.nc", "100", ["UP1"])


def test_empty_text_is_no_program():
    with pytest.raises(ProgramError) as caught:
        parse_program("\n ; nothing\n", "a.nc")
    assert str(caught.value) == "P-ERR-21014 a.nc line 2 column 1 '; nothing': no main program"
    with pytest.raises(ProgramError) as caught:
        parse_program("", "a.nc")
    assert str(caught.value) == "P-ERR-21014 a.nc line 1 column 1 '': no main program"


def test_mdi_continues_from_its_state():
    state = ModalState()
    first = list(interpret(parse_program("G01 X10 F600 S100", "mdi", mdi=True), (0.0,) * 3, CHANNEL, state=state))
    second = list(interpret(parse_program("Y5 M03", "mdi", mdi=True), state.position, CHANNEL, state=state))
    assert [format_block(block) for block in first + second] == [
        "1:N0 | S[REV100] | line (10, 0, 0) feed 10",
        "1:N0 | S[M3 REV100] | line (10, 5, 0) feed 10",
    ]


def test_mdi_starts_where_the_axes_stand():
    state = ModalState(position=(1.0, 2.0, 3.0), path=1, feed=2.0)
    blocks = list(interpret(parse_program("G91 X1", "mdi", mdi=True), (7.0, 8.0, 9.0), CHANNEL, state=state))
    assert blocks[0].motion == LinearMove((8.0, 8.0, 9.0), False, 2.0)


def test_state_copy_is_independent():
    state = ModalState(position=(0.0,), speeds={"S": 100.0})
    trial = state.copy()
    trial.speeds["S"] = 5.0
    trial.feed = 1.0
    assert (state.speeds, state.feed) == ({"S": 100.0}, 0.0)


def test_interpreter_is_lazy():
    """Blocks before an error come out, so a channel that wants to know before it moves must read ahead or check."""
    stream = interpret(parse_program("G00 X1\nG01 X2\nM30", "a.nc"), (0.0,) * 3, CHANNEL)
    assert next(stream).motion == LinearMove((1.0, 0.0, 0.0), True, 0.0)
    with pytest.raises(ProgramError, match="G01 without a feed"):
        next(stream)


def veto(limit: float):
    def check_target(target, source):
        if max(target) > limit:
            raise CncError(22001, f"{source.text}: {max(target):g} mm is beyond {limit:g} mm")

    return check_target


def test_veto_of_a_target_names_the_line():
    with pytest.raises(CncError) as caught:
        lines("G00 X10\nN20 G01 X301 F600", check_target=veto(300.0))
    assert str(caught.value) == "P-ERR-22001 N20 G01 X301 F600: 301 mm is beyond 300 mm"


def test_veto_of_an_arc_between_its_ends():
    assert lines("G00 X299\nG03 Y4 X299 I0 J2 F60", check_target=veto(301.0)) == [
        "rapid (299, 0, 0)",
        "arc (299, 4, 0) plane 01 center (299, 2) radius 2 sweep 180 feed 1",
    ]
    with pytest.raises(CncError) as caught:
        lines("G00 X299\nG03 Y4 X299 I0 J2 F60", check_target=veto(300.0))
    assert str(caught.value) == "P-ERR-22001 G03 Y4 X299 I0 J2 F60: 301 mm is beyond 300 mm"


def test_check_collects_syntax_errors_and_the_modal_error_before_them():
    text = "G01 X1\nG0 X2 E5 E6\nG05\nX3 X4\n#VAR\nM30"
    assert [(error.line, error.number) for error in check(text, "a.nc", CHANNEL)] == [
        (1, 20008),
        (2, 21002),
        (3, 20131),
        (4, 20203),
        (5, 21581),
        (6, 20908),
    ]


def test_check_does_not_guess_behind_a_syntax_error():
    assert [error.line for error in check("G01 X1 F60O\nX2\nM30", "a.nc", CHANNEL)] == [1]


def test_check_reports_structure_and_line_once():
    text = "%L UP\nLL NOWHERE\n%MAIN\nLL UP\nM29"
    found = [(error.line, error.number) for error in check(text, "a.nc", CHANNEL)]
    assert found == [(2, 21017), (5, 21018)]


def test_check_takes_start_limits_and_veto():
    text = "G91 G00 X1\nM30"
    assert check(text, "a.nc", CHANNEL, start=(1.0, 0.0, 0.0), check_target=veto(2.0)) == []
    with pytest.raises(CncError):
        check(text, "a.nc", CHANNEL, start=(1.5, 0.0, 0.0), check_target=veto(2.0))
    arc = "G02 X10 I5.01 F60\nM30"
    assert check(arc, "a.nc", CHANNEL) == []
    assert [error.number for error in check(arc, "a.nc", CHANNEL._replace(centre_offset=0.005))] == [21035]
    assert [error.number for error in check(arc, "a.nc", CHANNEL._replace(centre_offset_ratio=0.001))] == [21035]


def test_format_block_rounds_to_six_decimals():
    functions, move = (AuxiliaryFunction("M", 9),), LinearMove((0.1 + 0.2, -1e-9, 1e6), True, 0.0)
    block = CanonicalBlock(Source("a.nc", 4, 30, "N30"), functions, move, "M00")
    assert format_block(block) == "4:N30 | M9 | rapid (0.3, 0, 1000000) | M00"
