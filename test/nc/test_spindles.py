"""Words of spindles that golden programs do not show: spelling, stored values, gear selection against its rules."""

from __future__ import annotations

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from nc_support import GEARS, lines, run, three_spindles

from cnc_ptp.nc import gears
from cnc_ptp.nc.canonical import GearChange, SpindleFunction
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.modal_state import ModalState, Pair
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.program import Spindle, SpindleTable


@pytest.mark.parametrize("position", ["S.POS180", "S.POS 180", "S.POS=180", "S. POS = 180.0", "s.pos=+180"])
def test_spelling_of_a_position(position: str) -> None:
    assert lines(f"M19 S100 {position}") == ["S[M19 REV100 POS180]"]
    assert lines(f"{position} S100 M19 M4") == ["S[M19 REV100 POS180 ccw]"]


def test_position_of_a_main_spindle_with_a_longer_name() -> None:
    text = "SPINDLE=300 M3\nM19 SPINDLE.POS=-20.5"
    assert lines(text, spindles=("SPINDLE",)) == ["SPINDLE[M3 REV300]", "SPINDLE[M19 REV300 POS-20.5]"]


def test_positioning_without_any_speed_leaves_it_to_the_spindle() -> None:
    assert lines("M19\nS[M19 POS5]") == ["S[M19 POS0]", "S[M19 POS5]"]


def test_command_takes_its_block_number_comments_and_skip() -> None:
    table = three_spindles()
    text = "/2 N40 #MAIN SPINDLE [S2] (now) ; S2\nM3 S100"
    assert lines(text, spindles=table) == ["S2[M3 REV100]"]
    assert lines(text, spindles=table, block_skip=0b10) == ["S[M3 REV100]"]
    assert run("N70 #EXPL SYN")[0].source.block_number == 70


def test_commands_that_are_not_known_stay_unknown() -> None:
    for text in ("#MAIN", "#EXPL SYNC", "N10 #AX LINKS ON"):
        with pytest.raises(ProgramError) as caught:
            lines(text)
        assert caught.value.number == 21006


def test_a_refused_line_leaves_a_copied_state_alone() -> None:
    state = ModalState()
    lines("M3 S100\n#MAIN SPINDLE [S2]\nM19 S.POS=40", spindles=three_spindles(), state=state)
    copy = state.copy()
    with pytest.raises(ProgramError):
        lines("#MAIN SPINDLE\nM4 S500\nM19 S.POS=7\n#SET AX LINK[1, S3=S]\nX", spindles=three_spindles(), state=copy)
    assert lines("M19\nS1[M19]", spindles=three_spindles(), state=state) == ["S2[M19 POS40]", "S[M19 REV100 POS0]"]


def test_links_end_with_the_program_and_stay_defined() -> None:
    state, table = ModalState(), three_spindles()
    first = lines("#SET AX LINK[3, S2=S]\n#ENABLE AX LINK[3]\nX1 M30", spindles=table, state=state)
    assert first == ["link S2=S", "unlink S2=S | rapid (1, 0, 0) | end"]
    assert lines("#ENABLE AX LINK[3]\n#ENABLE AX LINK[3]\nM3 S9", spindles=table, state=state) == [
        "link S2=S",
        "S[M3 REV9] | S2[M3 REV9]",
    ]


def test_gears_count_for_the_spindle_that_is_the_main_one() -> None:
    table = three_spindles(ranges=GEARS, automatic=True)
    assert lines("#MAIN SPINDLE[S2]\nM3 S9000\nS1[M3 REV9000]\n#MAIN SPINDLE\nS600", spindles=table) == [
        "S2[M3 REV9000]",
        "S[M3 REV9000]",
        "S[gear 2] | S[REV600]",
    ]


@pytest.mark.parametrize(("from_top", "stage"), [(False, 1), (True, 2)])
def test_direction_of_the_search(from_top: bool, stage: int) -> None:
    """P-CHAN-00074: 450 rpm lies in M40 and M41; stage 3 is active, so that one is searched for."""
    spindle = Spindle("S", "S1", 6, GEARS, from_top, True, gear=3)
    assert lines("S450", spindles=SpindleTable((spindle,), "S", True)) == [f"S[gear {stage}] | S[REV450]"]


range_tables = st.lists(
    st.tuples(st.integers(0, 900), st.integers(0, 900)).map(lambda pair: (float(min(pair)), float(max(pair)))),
    min_size=6,
    max_size=6,
)


@given(range_tables, st.lists(st.integers(1, 1000), min_size=1, max_size=12), st.booleans(), st.integers(1, 6))
def test_automatic_selection_keeps_the_gear_or_takes_the_first_that_fits(
    ranges: list[tuple[float, float]], speeds: list[int], from_top: bool, active: int
) -> None:
    """2.8.2: no change while the speed fits, else the first of the table from the given side, else an error."""
    table = SpindleTable((Spindle("S", "S1", 6, tuple(ranges), from_top, True, active),), "S", True)
    program = parse_program("\n".join(f"S{speed}" for speed in speeds), "gears.nc", mdi=True)
    blocks = interpret(program, (0.0,), plain_channel("X", table))
    if all(high == 0.0 for _, high in ranges):
        assert all(len(block.functions) == 1 for block in blocks)
        return
    for speed in speeds:
        fitting = [n for n, (low, high) in enumerate(ranges, start=1) if high and low <= speed <= high]
        if not fitting:
            with pytest.raises(ProgramError, match=f"speed {speed} rpm of spindle S is in no gear stage"):
                next(blocks)
            return
        if active not in fitting:
            active = max(fitting) if from_top else min(fitting)
        assert next(blocks).functions == (GearChange("S", active), SpindleFunction("S", None, float(speed)))


def test_ranges_include_their_limits() -> None:
    spindle = Spindle("S", "S", 0, ((50.0, 560.0), (0.0, 0.0)))
    draw = random.Random(5)
    assert [gears.holds(spindle, 1, speed) for speed in (49.9, 50.0, 560.0, 560.1)] == [False, True, True, False]
    assert not any(gears.holds(spindle, stage, draw.uniform(0.1, 9999.0)) for stage in (2, 3) for _ in range(50))


def test_rotation_before_any_speed_stands_until_the_speed_comes() -> None:
    """The program of TF5200 spindle p.30: M3 first, S with the first cut."""
    assert lines("M3 X1 G0\nX40 G1 F1500 S500\nS2[M4]\nS2[M3]\nS2=70\nX41") == [
        "S[M3 REV0] | rapid (1, 0, 0)",
        "S[REV500] | line (40, 0, 0) feed 25",
        "S2[M4 REV0]",
        "S2[M3 REV0]",
        "S2[REV70]",
        "line (41, 0, 0) feed 25",
    ]
    assert lines("M3\nM5\nG1 X1 F60") == ["S[M3 REV0]", "S[M5]", "line (1, 0, 0) feed 1"]


@pytest.mark.parametrize("rest", ["G1 X1 F60", "G2 X4 Y1 R1 F60", "M30"])
def test_rotation_without_a_speed_does_not_machine(rest: str) -> None:
    with pytest.raises(ProgramError) as caught:
        lines(f"N10 G0 X2 M04\nG0 X3\n{rest}")
    assert str(caught.value) == (
        "P-ERR-21036 test.nc line 1 column 11 'N10 G0 X2 M04': "
        "M04 of spindle S without a speed: none was programmed before"
    )


def test_a_slave_gets_its_speed_with_its_master() -> None:
    table = three_spindles()._replace(default_link=(Pair("S2", "S"),))
    assert lines("#ENABLE AX LINK\nM3\nS500\n#DISABLE AX LINK\nS2[M4]\nG1 X1 F60\nM30", spindles=table)[1:] == [
        "S[M3 REV0] | S2[M3 REV0]",
        "S[REV500] | S2[REV500]",
        "unlink S2=S",
        "S2[M4 REV500]",
        "line (1, 0, 0) feed 1",
        "end",
    ]


@pytest.mark.parametrize("ratio", ["1000000, 1", "-1000000, 1", "1, 1000000", "-1, 1000000"])
def test_the_ratios_at_the_edge_of_the_range(ratio: str) -> None:
    state = ModalState()
    lines(f"#SET AX LINK [1, S2=S, {ratio}]", spindles=three_spindles(), state=state)
    num, den = map(float, ratio.split(","))
    assert state.spindle.links[1] == (Pair("S2", "S", num, den),)
