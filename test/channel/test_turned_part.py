"""examples/turned_part.nc on config/lathe.yaml: dimensions of the part from set values, against closed forms and Shapely.

Positions of the tips are calculated here from those of the axes: offsets of the tools by hand, zero 100 mm in front of
the spindle.
"""

from __future__ import annotations

from math import pi, radians, sqrt, tan

import numpy as np
import pytest
import shapely
from example_support import ExampleRun
from machine_support import ROOT
from numpy.typing import NDArray
from shapely import LineString, MultiLineString, Polygon
from thread_support import assert_within_limits, column, texts

pytestmark = pytest.mark.long

Floats = NDArray[np.float64]
MICROMETRE = 1e-3
ZERO = 100.0
NOSE = 0.4
"""mm: radius of the finishing tool."""


@pytest.fixture(scope="module")
def part() -> ExampleRun:
    """As `cnc_ptp simulate config/lathe.yaml --program examples/turned_part.nc` runs it."""
    return ExampleRun(str(ROOT / "config" / "lathe.yaml"), str(ROOT / "examples" / "turned_part.nc"))


def tip(part: ExampleRun, x: float, z: float) -> tuple[Floats, Floats]:
    """X (radius) and Z on the drawing of a tool with these offsets."""
    return column(part, "x", "set_position") - x, column(part, "z", "set_position") - z - ZERO


def blocks(part: ExampleRun, first: int, last: int) -> NDArray[np.bool_]:
    """Cycles of these N numbers of the main program."""
    number = column(part, "channel", "block_number")
    return (number >= first) & (number <= last)


def angle_of(part: ExampleRun) -> Floats:
    """C, deg."""
    return column(part, "s", "set_position_deg")


def test_it_runs_to_its_end_within_all_limits(part: ExampleRun) -> None:
    assert part.events == []
    assert {text.split()[0] for text in texts(part)} == {"22085"}
    assert part.blocks["channel"][-1].blocks_done == part.blocks["channel"][-1].blocks_total
    assert_within_limits(part)
    for name, spindle in part.machine.spindles.items():
        step = np.abs(np.diff(column(part, name, "set_position_deg")))
        assert step.max() <= spindle.gears[1].max_speed * 0.001 * (1.0 + 1e-9)
    assert (part.position("x"), part.position("z")) == (190.0, 380.0)


def test_tools_are_changed_far_from_the_workpiece(part: ExampleRun) -> None:
    x, z = column(part, "x", "set_position"), column(part, "z", "set_position")
    number = column(part, "channel", "block_number")
    for change in (110, 310, 510, 620, 810, 910, 1110):
        behind = np.nonzero((number >= change) & (number < change + 80))[0][0]
        assert (x[behind], z[behind]) == (pytest.approx(190.0, abs=0.1), pytest.approx(380.0, abs=0.1)), change


def test_cutting_speed_of_facing_is_180_m_per_minute(part: ExampleRun) -> None:
    """Within 1 % from 50 mm to 22 mm of diameter in the first cut, with G196 from about 19 mm on."""
    x, z = tip(part, 62.48, 41.01)
    speed = column(part, "s", "set_speed_rpm")
    before = np.arange(x.size) < np.nonzero(blocks(part, 200, 200))[0][0]
    cut = before & (column(part, "x", "set_velocity") < -1.0) & (x < 24.9) & (x > 11.0) & (z > 1.4) & (z < 1.6)
    cut &= column(part, "channel", "programmed_feed") < 100.0
    assert cut.sum() > 1000
    assert (2.0 * pi * x * np.abs(speed) / 1000.0)[cut] == pytest.approx(180.0, rel=0.01)


def finished_contour() -> LineString:
    """(Z, radius) of the drawing; the edge of 2 mm in chords that are within 1e-7 mm of it."""
    edge = [(-34.0 + 2.0 * np.cos(t), 20.0 + 2.0 * np.sin(t)) for t in np.linspace(0.0, pi / 2.0, 5001)]
    corners = [(1.0, 8.0), (-1.0, 10.0), (-6.0, 10.0), (-6.0, 13.0), (-8.0, 15.0), (-32.0, 15.0), (-32.0, 20.0)]
    return LineString([*corners, *edge, (-62.0, 22.0), (-66.0, 26.0)])


def test_finished_diameters(part: ExampleRun) -> None:
    """The nose touches the contour everywhere and is never in it: 20, 30 and 44 mm, chamfers, the edge of 2 mm."""
    x, z = tip(part, 62.0, 40.5)
    cut = blocks(part, 340, 420)
    nose = np.column_stack([z[cut] + NOSE, x[cut] + NOSE])
    away = shapely.distance(finished_contour(), shapely.points(nose))
    assert cut.sum() > 20_000
    assert np.abs(away - NOSE).max() < MICROMETRE
    for begin, end, diameter in ((-5.0, -1.5, 20.0), (-31.0, -9.0, 30.0), (-61.0, -35.0, 44.0)):
        along = cut & (z > begin) & (z < end)
        assert 2.0 * x[along] == pytest.approx(diameter, abs=1e-9)
    outside = shapely.points([(-1.0, 10.0), (-8.0, 15.0), (-33.0, 20.0 + sqrt(3.0))])
    assert shapely.distance(LineString(nose), outside) == pytest.approx(NOSE, abs=MICROMETRE)


def test_the_edge_has_the_feed_per_turn_of_the_lines(part: ExampleRun) -> None:
    """G95 with G42: an arc of the compensated path goes 0.1 mm in each turn, too."""
    velocity, speed = column(part, "channel", "path_velocity"), column(part, "s", "actual_speed_rpm")
    arc = np.nonzero(blocks(part, 400, 400))[0]
    middle = arc[len(arc) // 4 : -len(arc) // 4]
    assert np.median(60.0 * velocity[middle] / np.abs(speed[middle])) == pytest.approx(0.1, rel=5e-3)


def thread_passes(part: ExampleRun) -> list[NDArray[np.int64]]:
    """Cycles of each cut: the tool goes along Z with 2 mm in each turn of 600 rpm."""
    velocity = column(part, "z", "set_velocity")
    number = np.nonzero((np.abs(velocity + 20.0) < 1e-3) & (column(part, "x", "set_velocity") == 0.0))[0]
    runs = np.split(number, np.nonzero(np.diff(number) > 1)[0] + 1)
    return [run for run in runs if len(run) > 500]


def test_thread_has_2_mm_in_each_turn(part: ExampleRun) -> None:
    """Lead by a straight line through each cut; flank infeed; root at 15 - 1.23 mm; last cut and spring pass in one."""
    x, z = tip(part, 60.0, 38.0)
    angle = column(part, "s", "actual_position_deg")
    passes = thread_passes(part)
    cuts = int(np.ceil((1.23 / 0.35) ** 2))
    assert len(passes) == cuts + 1
    phases = []
    for count, cycles in enumerate(passes, start=1):
        turns, places = angle[cycles] / 360.0, z[cycles]
        lead, start = np.polyfit(turns - turns[0], places, 1)
        assert -lead == pytest.approx(2.0, abs=1e-5)
        assert np.abs(places - start - lead * (turns - turns[0])).max() < MICROMETRE
        down = min(0.35 * sqrt(count), 1.23)
        assert x[cycles] == pytest.approx(15.0 - down, abs=1e-9)
        phases.append(start + 2.0 * turns[0] - (1.23 - down) * tan(radians(29.5)))
    groove = np.array(phases) - phases[-1]
    assert np.abs(groove - 2.0 * np.round(groove / 2.0)).max() < MICROMETRE


def test_cross_holes_are_at_0_and_180_deg(part: ExampleRun) -> None:
    """Drilled to the radius 11, then tapped with 1 mm in each turn of the driven tool."""
    x, z = tip(part, 90.0, 45.0)
    angle = angle_of(part) % 360.0
    inside = blocks(part, 680, 690) & (x < 22.0)
    assert z[inside] == pytest.approx(-42.0, abs=1e-9)
    holes = [np.abs(angle[inside] - at) < 1e-6 for at in (0.0, 180.0)]
    assert (holes[0] | holes[1]).all() and all(hole.sum() > 1000 for hole in holes)
    assert x[inside].min() == pytest.approx(11.0, abs=1e-6)
    x, z = tip(part, 85.0, 45.0)
    tap = blocks(part, 860, 870)
    driven = column(part, "s2", "set_position_deg")
    assert z[tap] == pytest.approx(-42.0, abs=1e-9)
    assert x[tap].min() == pytest.approx(13.0, abs=1e-6)
    for at in (0.0, 180.0):
        cycles = np.nonzero(tap & (np.abs(angle - at) < 1e-6))[0]
        way, turns = 24.0 - x[cycles], (driven[cycles] - driven[cycles[0]]) / 360.0
        assert way == pytest.approx(turns + way[0], abs=1e-9)
        assert way.max() == pytest.approx(11.0, abs=1e-6)


def letters() -> MultiLineString:
    """(length of arc, Z) of P, T, P: 6 mm high, from C = 30 deg on a radius of 22 mm, foot at Z-56."""
    begin, half = radians(30.0) * 22.0, np.linspace(-pi / 2.0, pi / 2.0, 2001)
    bow = [(2.0 + 1.5 * np.cos(t), 4.5 - 1.5 * np.sin(t)) for t in half]
    p, t = [(0.0, 0.0), (0.0, 6.0), *bow, (0.0, 3.0)], [(2.0, 0.0), (2.0, 6.0), (0.0, 6.0), (4.0, 6.0)]
    strokes = ((0.0, p), (5.5, t), (11.5, p))
    return MultiLineString([[(begin + at + c, z - 56.0) for c, z in stroke] for at, stroke in strokes])


def test_engraving_on_the_cylinder(part: ExampleRun) -> None:
    """0.2 mm deep on every stroke, and on all of them."""
    x, z = tip(part, 78.0, 45.0)
    turns = np.floor(angle_of(part) / 360.0)
    arc = radians(1.0) * 22.0 * (angle_of(part) - 360.0 * turns)
    after = np.arange(x.size) > np.nonzero(blocks(part, 950, 950))[0][-1]
    cut = after & (np.abs(x - 21.8) < 1e-6) & (np.arange(x.size) < np.nonzero(blocks(part, 1000, 1000))[0][0])
    path = np.column_stack([arc[cut], z[cut]])
    assert shapely.distance(letters(), shapely.points(path)).max() < MICROMETRE
    engraved = shapely.MultiPoint(path).buffer(0.03)
    assert engraved.covers(letters())


def test_hexagon_of_16_mm_on_the_face(part: ExampleRun) -> None:
    """The centre of the mill is 3 mm beside the hexagon everywhere, and around all of it."""
    x, z = tip(part, 55.0, 84.0)
    angle = np.radians(angle_of(part))
    y = x * np.sin(angle)
    cut = blocks(part, 1210, 1263) & ~(blocks(part, 1210, 1210) & (y > 8.0 / sqrt(3.0)))
    assert z[cut] == pytest.approx(-5.0, abs=1e-9)
    path = np.column_stack([(x * np.cos(angle))[cut], y[cut]])
    corner = 16.0 / sqrt(3.0)
    hexagon = Polygon([(corner * np.cos(t), corner * np.sin(t)) for t in np.radians(np.arange(30.0, 390.0, 60.0))])
    assert np.abs(shapely.distance(hexagon, shapely.points(path)) - 3.0).max() < MICROMETRE
    assert x[cut].min() > 0.0
    assert Polygon(path).contains(hexagon)
    assert (np.abs(column(part, "s2", "set_speed_rpm"))[cut] == 4000.0).all()
