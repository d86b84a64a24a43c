"""Feedforward and compensation in programs: any spelling, order and company gives the same functions and no motion."""

import random

from hypothesis import given
from hypothesis import strategies as st
from nc_support import lines, run

from cnc_ptp.nc.canonical import AxisFeedforward, CompensationSwitch, LinearMove, SpindleFeedforward
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel

AXES = ("X", "Y", "Z")
percents = st.integers(0, 100_000).map(lambda value: value / 1000.0)
selections = st.sampled_from([None, True, False])
seeds = st.integers(0, 2**32)
WORDS = {True: "G135", False: "G137"}


@given(selections, st.dictionaries(st.sampled_from(AXES), percents), seeds)
def test_axes_in_any_order_and_spelling(on, weights, seed):
    draw = random.Random(seed)
    words = [WORDS[on]] if on is not None else []
    words += ["G136"] * bool(weights) + [f"{axis}{value}" for axis, value in weights.items()]
    draw.shuffle(words)
    text = "".join(draw.choice([word, word.lower()]) + draw.choice([" ", "", " (note) "]) for word in words)
    functions = [function for block in run(text + "\nG0 X1") for function in block.functions]
    if not words:
        assert functions == []
        return
    (function,) = functions
    assert isinstance(function, AxisFeedforward)
    assert function.on == on and dict(function.weights) == weights


@given(st.dictionaries(st.sampled_from(AXES), percents, min_size=1), st.sampled_from(["G0", "G1 F60", "G2 F60"]))
def test_weights_move_nothing_whatever_path_function_is_active(weights, path):
    words = " ".join(f"{axis}{value}" for axis, value in weights.items())
    blocks = run(f"{path}\nG91 G136 {words}\nG00 X0 Y0 Z0", start=(1.0, 2.0, 3.0))
    assert len(blocks) == 1 and blocks[0].motion is None


@given(st.sampled_from(["S", "S2"]), selections, st.one_of(st.none(), percents), seeds)
def test_spindles_in_any_order_and_spelling(spindle, on, weight, seed):
    draw = random.Random(seed)
    words = [WORDS[on]] if on is not None else []
    words += [f"G136{draw.choice(['=', ' = '])}{weight}"] if weight is not None else []
    draw.shuffle(words)
    text = f"{spindle}[{draw.choice(['', ' '])}{' '.join(words)}{draw.choice(['', ' '])}]"
    if words:
        (block,) = run(draw.choice([text, text.lower()]))
        assert block.functions == (SpindleFeedforward(spindle, on, weight),) and block.motion is None


@given(st.permutations(["ON", "FRICT"]), st.sampled_from(AXES), st.sampled_from(["", " ", "\t "]))
def test_words_behind_comp_have_no_order(words, axis, blank):
    (block,) = run(f"{axis}[{blank}COMP {' '.join(words)}{blank}]")
    assert block.functions == (CompensationSwitch(axis, True, ("FRICT",)),)


def test_feedforward_beside_a_motion_does_not_take_its_words():
    (block,) = run("G01 F60 X10 G135 Y[COMP OFF FRICT]")
    assert block.motion == LinearMove((10.0, 0.0, 0.0), False, 1.0)


def test_feed_beside_weights_is_kept():
    assert lines("G136 X50 F120\nG01 X1") == ["G136 X50", "line (1, 0, 0) feed 2"]


def test_channels_name_their_axes_and_spindles():
    names = {"axes": ("X1", "Y_ACHSE"), "spindles": ("S1",)}
    assert lines("G136 Y_ACHSE=50 X1=0\nX1[COMP ON FRICT] S1[G137]", **names) == [
        "G136 Y_ACHSE=50 X1=0",
        "X1[COMP ON FRICT] | S1[G137]",
    ]


def test_functions_of_manual_blocks_leave_the_modal_state_alone():
    state = ModalState(position=(0.0, 0.0, 0.0), path=1, feed=5.0, programmed=(0.0, 0.0, 0.0))
    before = state.copy()
    program = parse_program("G135 G136 X50 S[G135] X[COMP OFF FRICT]", "mdi", mdi=True)
    list(interpret(program, (0.0, 0.0, 0.0), plain_channel(AXES), state=state))
    assert state == before


def test_skipped_blocks_switch_nothing():
    assert lines("/G135\n/2 S[G135]\nG137", block_skip=0b11) == ["G137"]
