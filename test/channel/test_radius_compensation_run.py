"""Programs with a compensated tool radius on the machine: setpoints, streaming, start at a line, single block, MDI."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from contour_support import Edge, distances
from machine_support import MILL, MachineBench

COVER = Path(__file__).parents[2] / "examples" / "cover.nc"
PART = """T1 D1
V.G.WZ_AKT.R = 5
G00 X-20 Y0
G42 G01 X0 Y0 F3000
X40
Y40
M8
X0
Y0
G40 X-20
M30
"""
EDGES = [
    Edge((0.0, 0.0), (40.0, 0.0)),
    Edge((40.0, 0.0), (40.0, 40.0)),
    Edge((40.0, 40.0), (0.0, 40.0)),
    Edge((0.0, 40.0), (0.0, 0.0)),
]


def points_of(bench: MachineBench, first: int, last: int) -> np.ndarray:
    """Setpoints of X and Y in the cycles of these program lines."""
    of_channel = bench.column("channel", "line")
    xs, ys = bench.column("x", "set_position"), bench.column("y", "set_position")
    rows = zip(of_channel, xs, ys, strict=False)
    return np.array([(x, y) for line, x, y in rows if first <= line <= last])


def test_the_setpoints_keep_the_distance_of_the_radius() -> None:
    bench = MachineBench(PART).run()
    assert bench.errors() == [] and (bench.position("x"), bench.position("y")) == (-20.0, 0.0)
    points = points_of(bench, 5, 9)
    assert len(points) > 1000
    assert np.abs(distances(EDGES, points) - 5.0).max() < 1e-6


@pytest.mark.long
def test_the_example_runs() -> None:
    bench = MachineBench(COVER.read_text()).run()
    assert bench.errors() == [] and bench.last("channel").done


def test_a_program_that_is_interpreted_while_it_runs_has_the_same_path() -> None:
    kept = MachineBench(PART).run()
    channel = replace(MILL.channels["channel"], known_blocks=3)
    again = MachineBench(PART, machine=replace(MILL, channels={"channel": channel})).run()
    for unit in ("x", "y"):
        assert again.blocks[unit] == kept.blocks[unit]


def test_a_start_within_the_contour_begins_beside_it() -> None:
    """With the function before the line, from the point at which the arc around its corner begins."""
    bench = MachineBench(PART, start=False, end_when_idle=False).run(0.1)
    assert bench.give("channel", "start", line=8).accepted
    bench.run(0.01)
    steps = [event.text for event in bench.all_events if event.error_id == 22045]
    assert steps == [
        "line 1: T1 D1",
        "line 7: M8",
        "G00: X 0 to 45, Y 0 to 40",
        "continues with line 8 'X0'",
    ]
    bench.run(10.0)
    assert bench.errors() == [] and bench.position("x") == -20.0
    assert np.abs(distances(EDGES, points_of(bench, 9, 9)) - 5.0).max() < 1e-6


def test_a_start_within_the_contour_of_a_long_program() -> None:
    channel = replace(MILL.channels["channel"], known_blocks=3)
    bench = MachineBench(
        PART, machine=replace(MILL, channels={"channel": channel}), start=False, end_when_idle=False
    ).run(0.1)
    assert bench.give("channel", "start", line=8).accepted
    bench.run(10.0)
    assert bench.errors() == [] and bench.position("x") == -20.0


def test_single_block_stops_behind_each_piece_of_the_path() -> None:
    bench = MachineBench(PART, start=False, end_when_idle=False).run(0.1)
    assert bench.give("channel", "single_block", enabled=True, mode="motion").accepted
    places = []
    for _ in range(8):
        assert bench.give("channel", "start").accepted
        bench.run(3.0)
        places.append((round(bench.position("x"), 6), round(bench.position("y"), 6)))
    assert places == [(-20, 0), (0, -5), (40, -5), (45, 0), (45, 40), (40, 45), (0, 45), (-5, 40)]


def test_a_contour_by_mdi() -> None:
    bench = MachineBench(end_when_idle=False).run(0.1)
    text = "D1\nV.G.WZ_AKT.R = 5\nG42 G01 X10 Y0 F3000\nX40\nG40 X60 Y5"
    assert bench.give("channel", "mdi", text=text).accepted
    bench.run(5.0)
    assert bench.errors() == [] and (bench.position("x"), bench.position("y")) == (60.0, 5.0)
    assert bench.give("channel", "mdi", text="G42 X10 Y0\nX0").accepted
    bench.run(5.0)
    assert (bench.position("x"), bench.position("y")) == (0.0, 5.0)
    warnings = [event.text for event in bench.all_events if event.error_id == 21689]
    text = "the tool radius is still compensated (G42) at the end of the program"
    assert len(warnings) == 1 and text in warnings[0]


def test_a_corner_that_is_too_small_refuses_the_start() -> None:
    bench = MachineBench(PART.replace("Y40\nM8", "G03 X36 Y4 R4").replace("G42", "G41")).run()
    (refusal,) = bench.refusals()
    assert refusal == (
        "P-ERR-90017 test.nc line 6 column 1 'G03 X36 Y4 R4': the tool with radius 5 mm is on the inside of an arc with"
        " radius 4 mm: it does not fit into it; nothing was started"
    )
    assert bench.position("x") == pytest.approx(0.0)
