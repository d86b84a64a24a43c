"""Compensation of the tool radius in the interpreter: tips, look-ahead, limits, what is read, where a search begins."""

from __future__ import annotations

import pytest
from nc_support import AXES, SPINDLES, lines, run

from cnc_ptp.nc.block_search import BlockSearch, StartPoint
from cnc_ptp.nc.canonical import BEGIN, BUSY, CircularMove, LanguageWarning, LinearMove, Source
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.radius.radius_state import RadiusSettings
from cnc_ptp.parameters import Tool, ToolTable

END_MILL = ToolTable({1: Tool(radius=5.0)}, True)
CHANNEL = plain_channel(AXES, SPINDLES)._replace(tools=END_MILL)
SQUARE = "D1 G00 X-20 F600\nG42 G01 X0 Y0\nX40\nY40\nX0\nY0\nG40 X-20"


def targets(text: str, **options: object) -> list[tuple[float, ...]]:
    options.setdefault("tools", END_MILL)
    motions = [block.motion for block in run(text, **options)]
    return [motion.target for motion in motions if isinstance(motion, (LinearMove, CircularMove))]


@pytest.mark.parametrize(
    ("tip", "z", "x"),
    [
        (0, 0.0, 0.8), (9, 0.0, 0.8), (1, 0.8, 1.6), (2, -0.8, 1.6), (3, -0.8, 0.0), (4, 0.8, 0.0), (5, 0.8, 0.8),
        (6, 0.0, 1.6), (7, -0.8, 0.8), (8, 0.0, 0.0),
    ],
)  # fmt: skip
def test_the_tip_of_a_turning_tool(tip: int, z: float, x: float) -> None:
    """A cylinder of radius 20 from Z2 to Z-30: the centre is at X20.8, the programmed tip (z, x) from (0, 20)."""
    tools = ToolTable({1: Tool(radius=0.8, orientation=tip, type=1)}, True)
    found = targets("G18 D1 G00 X40 Z10 F100\nG42 G01 X20 Z2\nZ-30\nG40 X40", axes=("X", "Z"), tools=tools)
    assert found[1:3] == [pytest.approx((20.0 + x, 2.0 + z)), pytest.approx((20.0 + x, -30.0 + z))]
    assert found[3] == (40.0, -30.0)


def test_a_milling_tool_has_no_tip() -> None:
    tools = ToolTable({1: Tool(radius=0.8, orientation=3)}, True)
    found = targets("G18 D1 G00 X40 Z10 F100\nG42 G01 X20 Z2\nZ-30\nG40 X40", axes=("X", "Z"), tools=tools)
    assert found[1] == pytest.approx((20.8, 2.0))


def test_wear_changes_the_radius() -> None:
    worn = ToolTable({1: Tool(radius=5.0, wear_radius=-0.02)}, True)
    assert targets(SQUARE, tools=worn)[1] == pytest.approx((0.0, -4.98, 0.0))


def test_a_radius_of_zero_is_the_contour_itself() -> None:
    """For programs whose contour is that of the tool, with the wear alone as its radius."""
    assert targets(SQUARE, tools=ToolTable({1: Tool()}, True)) == targets(SQUARE.replace("G42", "G40"))


def test_elements_are_handed_out_when_so_many_behind_them_are_known() -> None:
    """Motions that were handed out when the interpreter reached each line, with two elements of look-ahead."""
    text = "\n".join([*SQUARE.splitlines(), "X-30", "M30"])
    state, settings = ModalState(), RadiusSettings(look_ahead=2)
    program = parse_program(text, "a.nc")
    read = []
    for block in interpret(program, (0.0,) * 3, CHANNEL._replace(radius=settings), state=state):
        if block.motion is not None:
            read.append((block.source.line, state.programmed[:2]))
    assert read == [
        (1, (-20.0, 0.0)),
        (2, (40.0, 0.0)),
        (3, (0.0, 40.0)),
        (4, (0.0, 0.0)),
        (4, (0.0, 0.0)),
        (5, (-20.0, 0.0)),
        (5, (-20.0, 0.0)),
        (6, (-20.0, 0.0)),
        (6, (-20.0, 0.0)),
        (7, (-20.0, 0.0)),
        (8, (-30.0, 0.0)),
    ]


def test_soft_limits_count_for_the_tool_not_for_the_contour() -> None:
    def limited(target: tuple[float, ...], source: Source) -> None:
        if target[0] > 42.0:
            raise ProgramError(120002, f"X{target[0]:g}", source, 1)

    with pytest.raises(ProgramError) as caught:
        targets(SQUARE, check_target=limited)
    assert str(caught.value) == "P-ERR-120002 test.nc line 4 column 1 'Y40': X45"
    inside = "D1 G00 X20 Y20 F600\nG41 G01 X20 Y0\nX44\nY40\nX0\nY0\nX20\nG40 Y20"
    assert targets(inside, check_target=limited)[2] == pytest.approx((39.0, 5.0, 0.0))


def test_limits_of_a_program_count_for_the_tool() -> None:
    with pytest.raises(ProgramError) as caught:
        targets("G99 X42\n" + SQUARE)
    assert str(caught.value) == (
        "P-ERR-120002 test.nc line 5 column 1 'Y40': axis X: 45 mm lies beyond the software limit 42 mm of G99"
    )


def test_what_only_the_run_knows_is_refused() -> None:
    with pytest.raises(ProgramError) as caught:
        run(SQUARE.replace("Y40\nX0", "Y40\nX[V.A.ACT_POS.Y - 40]"), tools=END_MILL, runs=True)
    assert str(caught.value) == (
        "P-ERR-20651 test.nc line 5 column 1 'X[V.A.ACT_POS.Y - 40]': reading what only the run knows is not possible"
        " while the tool radius is compensated; G40 and a straight line end that before it"
    )


def test_long_computations_are_passed_on() -> None:
    text = SQUARE.replace("\nX0\n", "\n$FOR P1 = 1, 9000, 1\n$ENDFOR\nX0\n")
    blocks = run(text, tools=END_MILL, runs=True)
    assert BUSY in blocks
    assert [block for block in blocks if block is not BUSY] and targets(text)[-1] == (-20.0, 0.0, 0.0)


def test_a_search_begins_beside_the_contour() -> None:
    search = BlockSearch(StartPoint(line=5), "test.nc")
    blocks = run(SQUARE, tools=END_MILL, search=search)
    behind = blocks[blocks.index(BEGIN) + 1 :]
    assert search.position == pytest.approx((45.0, 40.0, 0.0))
    assert isinstance(behind[0].motion, CircularMove) and behind[0].source.line == 5


def test_a_search_before_the_contour_has_no_position_of_its_own() -> None:
    search = BlockSearch(StartPoint(line=2), "test.nc")
    run(SQUARE, tools=END_MILL, search=search)
    assert search.position is None


def test_texts_of_manual_blocks_end_the_compensation() -> None:
    """Each MDI text is a contour of its own."""
    state = ModalState()
    text = "D1 G42 G01 X0 Y0 F600\nX40"
    program = parse_program(text, "mdi", mdi=True)
    blocks = list(interpret(program, (-20.0, 0.0, 0.0), CHANNEL, state=state))
    (warning,) = blocks[-1].functions
    assert warning == LanguageWarning(21689, "the tool radius is still compensated (G42) at the end of the program")
    assert not state.radius_compensation.on
    place = blocks[-2].motion.target  # type: ignore[union-attr]
    second = parse_program("Y10", "mdi", mdi=True)
    (block,) = interpret(second, place, CHANNEL, state=state)
    assert isinstance(block.motion, LinearMove) and block.motion.target == (40.0, 10.0, 0.0)


def test_corners_are_handed_out_with_the_feed_and_transition_of_the_motion_behind_them() -> None:
    text = "D1 G00 X-20 F600\nG42 G01 X0 Y0\nX40\nY40 F1200 G09\nG40 X60"
    assert lines(text, tools=END_MILL)[3:5] == [
        "arc (45, 0, 0) plane 01 center (40, 0) radius 5 sweep 90 feed 20",
        "line (45, 40, 0) feed 20 exact stop",
    ]


def test_the_machine_file_says_how_outer_corners_are() -> None:
    settings = RadiusSettings(by_lines=True)
    assert targets(SQUARE, radius=settings)[2:4] == [(45.0, -5.0, 0.0), (45.0, 45.0, 0.0)]
    assert targets("G26 " + SQUARE, radius=settings) == targets(SQUARE)


def test_a_cycle_of_another_program_leaves_the_side_as_it_was() -> None:
    text = "D1 G00 X-20 F600\nG42 G01 X0 Y0\nX40\nL CYCLE [NAME=up.nc]\nY40\nG40 X60"
    found = targets(text, files={"up.nc": "Z5\nG41\nM29"})
    assert found[2:5] == [(40.0, -5.0, 0.0), (40.0, -5.0, 5.0), (45.0, 0.0, 5.0)]


def test_the_tilted_plane_of_a_coordinate_system() -> None:
    """Plane XY turned by 30° about X: the path keeps the distance of the radius there, with arcs in that plane."""
    flat = [block.motion for block in run(SQUARE, tools=END_MILL) if block.motion is not None]
    tilted = [block.motion for block in run("#CS ON [0, 0, 0, 30, 0, 0]\n" + SQUARE, tools=END_MILL)]
    y, z = 3.0**0.5 / 2.0, 0.5
    moved = [motion for motion in tilted if motion is not None]
    assert len(moved) == len(flat)
    for a, b in zip(moved, flat, strict=True):
        assert isinstance(a, (LinearMove, CircularMove)) and isinstance(b, (LinearMove, CircularMove))
        assert a.target == pytest.approx((b.target[0], b.target[1] * y, b.target[1] * z), abs=1e-9)
        if isinstance(a, CircularMove) and isinstance(b, CircularMove):
            assert (a.center, a.radius, a.sweep) == (
                pytest.approx(b.center, abs=1e-9),
                b.radius,
                pytest.approx(b.sweep),
            )
            assert a.directions == (pytest.approx((1.0, 0.0, 0.0)), pytest.approx((0.0, y, z)))
