"""Positions with tools by closed form: length, wear, offsets, zero offset and coordinate systems together."""

from __future__ import annotations

import math
from math import cos, radians, sin

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples
from nc_support import MILLING, TOOLS, run

from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.program import Channel, SpindleTable
from cnc_ptp.nc.tools.compensation import cancel_length, select_length
from cnc_ptp.nc.vocabulary import TWINCAT
from cnc_ptp.parameters import OffsetTables, Tool, ToolTable

LENGTHS = st.floats(-200.0, 200.0).map(lambda value: round(value, 4))
ANGLES = st.floats(-180.0, 180.0).map(lambda value: round(value, 3))


def last(text: str, tools: ToolTable, **options: object) -> tuple[float, ...]:
    motions = [block.motion for block in run(text, tools=tools, **options) if block.motion is not None]
    return motions[-1].target


@settings(max_examples=examples(60), deadline=None, derandomize=True)
@given(st.tuples(*[LENGTHS] * 9), st.tuples(ANGLES, ANGLES, ANGLES), st.booleans(), st.sampled_from((17, 18, 19)))
def test_a_tool_under_a_zero_offset_and_a_coordinate_system(values, angles, fixed, plane):  # type: ignore[no-untyped-def]
    """machine = zero + R·p + t, or zero + R·(p + t) for a tool that turns; R = Rz·Ry·Rx, written out by hand."""
    length, wear, ox, oy, oz, zx, zz, px, py = values
    tool = Tool(1, length, 1.0, (ox, oy, oz), wear, fixed=fixed)
    vector = [ox, oy, oz]
    vector[{17: 2, 18: 1, 19: 0}[plane]] += length + wear
    a, b, c = (radians(angle) for angle in angles)
    rotation = (
        (cos(c) * cos(b), cos(c) * sin(b) * sin(a) - sin(c) * cos(a), cos(c) * sin(b) * cos(a) + sin(c) * sin(a)),
        (sin(c) * cos(b), sin(c) * sin(b) * sin(a) + cos(c) * cos(a), sin(c) * sin(b) * cos(a) - cos(c) * sin(a)),
        (-sin(b), cos(b) * sin(a), cos(b) * cos(a)),
    )
    inner = [px, py, 3.0] if fixed else [px + vector[0], py + vector[1], 3.0 + vector[2]]
    turned = [sum(row[k] * inner[k] for k in range(3)) for row in rotation]
    outer = vector if fixed else [0.0, 0.0, 0.0]
    zero = (zx, 0.0, zz)
    expected = [turned[k] + zero[k] + outer[k] for k in range(3)]
    text = f"V.G.NP[1].V.X = {zx:.4f}\nV.G.NP[1].V.Z = {zz:.4f}\nG54 G{plane} D1\n"
    text += f"#CS ON [0, 0, 0, {angles[0]:.3f}, {angles[1]:.3f}, {angles[2]:.3f}]\nG00 X{px:.4f} Y{py:.4f} Z3"
    assert last(text, ToolTable({1: tool}, True)) == pytest.approx(expected, abs=1e-9)


@settings(max_examples=examples(60), deadline=None, derandomize=True)
@given(st.lists(st.sampled_from(("D1", "D2", "D3", "D13", "D0", "G17", "G18", "G19", "X1 Y2 Z3", "G91 X1 Z-1 G90"))))
def test_only_the_last_selection_counts(words):  # type: ignore[no-untyped-def]
    """Whatever was selected before: an absolute point has the offsets of the last D in the last plane, no others."""
    text = "\n".join(word.replace("G91 X1 Z-1 G90", "G91 X1 Z-1\nG90") for word in ["G00", *words])
    chosen = next((word for word in reversed(words) if word.startswith("D")), "D0")
    plane = next((word for word in reversed(words) if word.startswith("G1")), "G17")
    tool = MILLING.get(int(chosen[1:]), Tool())
    expected = [7.0, 8.0, 9.0]
    for axis, offset in enumerate(tool.offsets):
        expected[axis] += offset
    expected[{"G17": 2, "G18": 1, "G19": 0}[plane]] += tool.length + tool.wear_length
    assert last(f"{text}\nX20 Y20 Z20\nX7 Y8 Z9", TOOLS["milling"]) == pytest.approx(expected, abs=1e-9)


@settings(max_examples=examples(60), deadline=None, derandomize=True)
@given(st.tuples(*[LENGTHS] * 8), st.booleans(), st.sampled_from((17, 18, 19)), st.booleans())
def test_a_tool_and_machine_coordinates(values, fixed, plane, inside):  # type: ignore[no-untyped-def]
    """machine = p between #MCS ON and #MCS OFF, behind it zero + clamp + p + t, wherever D and the plane stand."""
    length, wear, offset, zero, clamp, *point = values
    tool = Tool(1, length, 1.0, (offset, 0.0, 0.0), wear, fixed=fixed)
    tables = OffsetTables(zero={1: (zero, 0.0, 0.0)}, clamp={0: (0.0, clamp, 0.0)})
    selected = f"G{plane} D1"
    before, between = ("D2", selected) if inside else (selected, "")
    target = "X{:.4f} Y{:.4f} Z{:.4f}".format(*point)
    text = f"G54 G00 {before}\nX1 Y1 Z1\n#MCS ON\n{between}\n{target}"
    of_tables = ToolTable({1: tool, 2: MILLING[2]}, True)
    assert last(text, of_tables, offsets=tables) == pytest.approx(point, abs=1e-9)
    expected = [point[0] + zero + offset, point[1] + clamp, point[2]]
    expected[{17: 2, 18: 1, 19: 0}[plane]] += length + wear
    assert last(f"{text}\n#MCS OFF\n{target}", of_tables, offsets=tables) == pytest.approx(expected, abs=1e-9)


def test_tools_at_once_do_not_move_the_axes_between_mcs_on_and_off() -> None:
    """P-CHAN-00100: the axes make up for a tool of #MCS with their next absolute word."""
    blocks = run("D1 G00 Z0\n#MCS ON\nD2\nX5\n#MCS OFF\nX5", tools=TOOLS["at_once"])
    assert [block.motion.target for block in blocks if block.motion is not None] == [
        (0.0, 0.0, 74.75),
        (5.0, 0.0, 74.75),
        (5.5, 0.0, 74.75),
    ]


def test_the_report_of_offsets_has_the_tool() -> None:
    """In the block of the D word, with zero offset and clamp position beside it; in #MCS there is none."""
    tables = OffsetTables(zero={1: (10.0, 0.0, 0.0)}, clamp={0: (0.0, 0.5, 0.0)})
    blocks = run("G54 D2\nG00 X0\n#MCS ON\nX1", tools=TOOLS["milling"], offsets=tables)
    reports = [block.offsets for block in blocks if block.offsets is not None]
    assert [report.tool for report in reports] == [(0.5, -0.25, 110.5), (0.0, 0.0, 0.0)]
    assert [report.shift for report in reports] == [(10.5, 0.25, 110.5), (0.0, 0.0, 0.0)]


def test_relative_motions_do_not_make_up_for_a_tool() -> None:
    """The vendor's example: N10 D16, N20 G00 X0 G91 moves nothing."""
    blocks = run("G00 X5 Z5\nD3\nG91 X0 Z0\nG90 Z5", tools=TOOLS["milling"])
    assert [block.motion.target for block in blocks if block.motion is not None] == [(5.0, 0.0, 5.0), (5.0, 0.0, 45.0)]


def test_inch_does_not_scale_the_tool() -> None:
    assert last("D1 G70 G00 Z1", TOOLS["milling"])[2] == pytest.approx(25.4 + 74.75, abs=1e-12)


def channel() -> Channel:
    names = ("X", "Y", "Z")
    places = {name: place for place, name in enumerate(names)}
    return Channel(names, places, SpindleTable((), "S"), 0, 0, TWINCAT, tools=TOOLS["milling"])


def test_length_by_an_h_number() -> None:
    """For G43 H and G49 of the other vocabulary."""
    nc, state = channel(), ModalState(position=(0.0, 0.0, 100.0))
    source = Source("a.nc", 1, 0, "G43 H1", ("G43", "H"), (1, 5))
    select_length(nc, state, source, 1)
    assert (state.tool.d, state.tool.t, state.programmed) == (1, 0, (0.0, 0.0, 100.0 - 74.75))
    with pytest.raises(ProgramError) as caught:
        select_length(nc, state, source, 5)
    assert str(caught.value) == (
        "P-ERR-20296 a.nc line 1 column 5 'G43 H1': H5: the tool table has no compensation data D5; "
        "known are: D1, D2, D3, D7, D13"
    )
    assert state.tool.d == 1
    cancel_length(nc, state, source)
    assert (state.tool.d, state.programmed) == (0, (0.0, 0.0, 100.0))


def test_a_copy_of_the_state_is_independent() -> None:
    nc, state = channel(), ModalState(position=(0.0, 0.0, 100.0))
    source = Source("a.nc", 1, 0, "D1", ("D",), (1,))
    before = state.copy()
    select_length(nc, state, source, 2)
    state.tool.changed = {2: Tool()}
    assert (before.tool.d, before.tool.changed, before.coordinates.tool) == (0, None, ())
    assert before != state


def test_a_line_of_manual_blocks_may_follow_one_that_wrote_the_tool() -> None:
    """20738 is for one block; both texts have their line 1."""
    state, channel = ModalState(), plain_channel("XYZ")._replace(tools=TOOLS["milling"])
    for text in ("V.G.WZ_AKT.L = 5", "D1", "G00 Z0"):
        program = parse_program(text, "mdi", mdi=True)
        blocks = list(interpret(program, state.position or (0.0,) * 3, channel, state=state))
    assert math.isclose(blocks[-1].motion.target[2], 74.75)
