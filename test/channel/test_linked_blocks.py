"""Blocks that the path runs through without a stop: limits, corners within their tolerance, functions, hold, abort."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from long_support import long
from machine_support import CYCLE_TIME, MILL, MachineBench
from machine_support import assert_axes_smooth as smooth
from shapely import LineString, Point

from cnc_ptp.path.linked_path import LinkedPath

AXES = ("x", "y", "z")


def path(bench: MachineBench) -> np.ndarray:
    return np.column_stack([bench.column(name, "set_position") for name in AXES])


def moving(bench: MachineBench) -> np.ndarray:
    """Path velocity between the first and the last cycle with one, without the ramps there (100 cycles)."""
    velocity = np.array(bench.column("channel", "path_velocity"))
    cycles = np.nonzero(velocity)[0]
    return velocity[cycles[0] + 100 : cycles[-1] - 100]


def program(*lines: str) -> str:
    return "\n".join(["%P", *lines, "M30"])


def test_a_line_in_many_blocks_takes_the_time_of_one() -> None:
    one = MachineBench(program("G01 X60 F6000")).run()
    many = MachineBench(program("F6000", *[f"G01 X{6 * n}" for n in range(1, 11)])).run()
    stops = MachineBench(program("G60 F6000", *[f"G01 X{6 * n}" for n in range(1, 11)])).run()
    cycles = [len(bench.column("channel", "line")) for bench in (one, many, stops)]
    assert cycles[1] <= 1.02 * cycles[0] + 2 and cycles[2] > 1.8 * cycles[0]
    assert path(many)[-1] == pytest.approx((60.0, 0.0, 0.0), abs=1e-9)
    assert max(many.column("channel", "path_velocity")) == pytest.approx(100.0)
    smooth(many)


def test_line_and_block_count_follow_the_path() -> None:
    bench = MachineBench(program("G359 F6000", *[f"G01 X{6 * n}" for n in range(1, 11)])).run()
    lines, x = bench.column("channel", "line"), path(bench)[:, 0]
    for line, place in zip(lines, x, strict=True):
        if 0.0 < place < 60.0:
            assert line == 3 + math.floor(place / 6.0 - 1e-12)
    to_go = np.array(bench.column("channel", "distance_to_go"))
    inside = (x > 0.0) & (x < 60.0)
    assert to_go[inside] == pytest.approx(6.0 - x[inside] % 6.0, abs=1e-9)
    assert bench.blocks["channel"][-1].blocks_done == bench.blocks["channel"][-1].blocks_total


@pytest.mark.parametrize("tolerance", [0.01, *long([0.001, 0.1])])
def test_corners_stay_within_the_tolerance(tolerance: float) -> None:
    """Shapely's distance to the programmed polygon; the tolerance is used."""
    corners = [(0, 0), (30, 0), (30, 20), (10, 25), (12, 5), (0, 0)]
    lines = [f"G01 X{x} Y{y}" for x, y in corners[1:]]
    bench = MachineBench(program(f"#CONTOUR MODE [DEV PATH_DEV={tolerance}]", "G261 F6000", *lines)).run()
    programmed = LineString(corners)
    deviations = [programmed.distance(Point(*point[:2])) for point in path(bench)]
    assert 0.5 * tolerance < max(deviations) <= tolerance * (1.0 + 1e-9)
    assert path(bench)[-1] == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    assert moving(bench).min() > 0.0
    smooth(bench)


def test_arcs_and_lines_with_contouring() -> None:
    bench = MachineBench(
        program("#CONTOUR MODE [DEV PATH_DEV=0.02]", "G261 F4000", "G01 X30", "G03 X30 Y20 I0 J10", "G01 X5 Z3", "Y0")
    ).run()
    smooth(bench)
    x, y, _ = path(bench).T
    right = x > 30.0
    assert np.abs(np.hypot(x[right] - 30.0, y[right] - 10.0) - 10.0).max() <= 0.02 + 1e-9
    assert moving(bench).min() > 3.0


TILT = ("#CS ON [0, 0, 10, 30]", "G00 X20 Y0 Z0")
"""The plane is turned by 30 deg about X and shifted along Z."""


def tilted(points: np.ndarray) -> np.ndarray:
    """Points of the machine in the tilted system."""
    c, s = math.cos(math.radians(30.0)), math.sin(math.radians(30.0))
    return (points - [0.0, 0.0, 10.0]) @ np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def test_a_path_ends_whose_cells_do_not_sum_up_to_its_length() -> None:
    """Three quarters of a circle at the end: the sum of the cells was 1.4e-14 mm short, and the path never ended."""
    arcs = ("G261 F4000", "G01 Y10", "G03 X0 Y30 R20", "G01 X-20", "G02 X-30 Y20 J-10")
    bench = MachineBench(program("G00 X20", "#CONTOUR MODE [DEV PATH_DEV=0.02]", *arcs)).run()
    assert path(bench)[-1] == pytest.approx((-30.0, 20.0, 0.0), abs=1e-12)


@pytest.mark.parametrize("transition", ["G60", "G359"])
def test_arcs_in_a_tilted_system_on_their_circle(transition: str) -> None:
    """A full circle and a helix, cycle by cycle on the circle that the system turns."""
    bench = MachineBench(program(*TILT, f"G01 F4000 {transition}", "G03 I-20", "G02 X-20 Z5 I-20")).run()
    x, y, z = tilted(path(bench)[np.array(bench.column("channel", "line")) >= 5]).T
    assert np.abs(np.hypot(x, y) - 20.0).max() <= 1e-9
    rising = z > 1e-9
    angle = np.degrees(np.arctan2(-y[rising], x[rising])) % 360.0
    assert z[rising] == pytest.approx(angle / 36.0, abs=1e-9)
    assert (x[-1], y[-1], z[-1]) == pytest.approx((-20.0, 0.0, 5.0), abs=1e-9)
    assert max(bench.column("channel", "path_velocity")) <= 200.0
    smooth(bench)


def test_linked_arcs_in_a_tilted_system() -> None:
    """The deviation from the programmed contour, in the tilted plane, is within the tolerance; no stop between."""
    contour = (
        "#CONTOUR MODE [DEV PATH_DEV=0.02]",
        "G261 F4000",
        "G01 Y10",
        "G03 X0 Y30 R20",
        "G01 X-20",
        "G03 X-30 Y20 J-10",
    )
    bench = MachineBench(program(*TILT, *contour)).run()
    x, y, z = tilted(path(bench)[np.array(bench.column("channel", "line")) >= 6]).T
    assert np.abs(z).max() <= 1e-9
    angles = np.radians(np.linspace(0.0, 90.0, 2001))
    first = [(20.0 * math.cos(a), 10.0 + 20.0 * math.sin(a)) for a in angles]
    second = [(-20.0 - 10.0 * math.sin(a), 20.0 + 10.0 * math.cos(a)) for a in angles]
    programmed = LineString([(20.0, 0.0), *first, *second])
    deviations = [programmed.distance(Point(*point)) for point in zip(x, y, strict=True)]
    assert max(deviations) <= 0.02 + 1e-5
    on_the_way = np.array(bench.column("channel", "line")) >= 6
    velocity = np.array(bench.column("channel", "path_velocity"))[on_the_way]
    assert velocity[100 : np.nonzero(velocity)[0][-1] - 100].min() > 3.0
    smooth(bench)


def test_exact_stop_reaches_its_corner() -> None:
    lines = ("#CONTOUR MODE [DEV PATH_DEV=0.1]", "G261 F6000", "G01 X20", "G09 Y20", "X0", "G60 Y0", "X5")
    bench = MachineBench(program(*lines)).run()
    points = path(bench)
    for corner in ((20.0, 20.0), (0.0, 0.0)):
        assert np.hypot(*(points[:, :2] - corner).T).min() < 1e-5  # half a cycle from rest
    assert np.hypot(*(points[:, :2] - (20.0, 0.0)).T).min() > 0.01


def test_a_function_that_nobody_waits_for_goes_out_as_the_path_passes() -> None:
    """S is of type MOS here, M8 makes the path wait (MVS_SVS)."""
    passed = MachineBench(program("M3 S100", "G359 F6000", "G01 X20", "S200 X40", "X60")).run()
    stopped = MachineBench(program("M3 S100", "G359 F6000", "G01 X20", "M8 X40", "X60")).run()
    x, v = path(passed)[:, 0], np.array(passed.column("channel", "path_velocity"))
    assert v[(x > 10.0) & (x < 50.0)] == pytest.approx(100.0)
    speeds = [command for block in passed.blocks["channel"] for command in block.commands]
    crossed = int(np.argmax(x > 20.0))
    sent = next(
        block.first_cycle
        for block in passed.blocks["channel"]
        if 200.0 in [value for command in block.commands for value in command.arguments.values()]
    )
    assert speeds and 0 <= sent - crossed <= 2 * MILL.block_cycles
    x, v = path(stopped)[:, 0], np.array(stopped.column("channel", "path_velocity"))
    assert v[np.abs(x - 20.0) < 1e-9].min() == 0.0


@pytest.mark.long
def test_hold_override_and_reset_at_random_moments() -> None:
    lines = ["#CONTOUR MODE [DEV PATH_DEV=0.05]", "G261 F6000"]
    corners = [(0, 0), (30, 0), (30, 20), (10, 25), (12, 5), (0, 10), (0, 0)]
    lines += [f"G01 X{x} Y{y}" for x, y in corners[1:]]
    programmed = LineString(corners)
    for seed in range(20):
        draw = random.Random(seed)
        bench = MachineBench(program(*lines), end_when_idle=False)
        for _ in range(6):
            bench.run(draw.randrange(1, 30) * 0.01)
            if draw.random() < 0.5:
                bench.give("channel", "feed_hold", enabled=draw.random() < 0.5)
            else:
                bench.give("channel", "set_override", percent=draw.choice((0.0, 20.0, 60.0, 100.0, 120.0)))
        if draw.random() < 0.3:
            bench.give("channel", "reset")
        bench.give("channel", "feed_hold", enabled=False)
        bench.give("channel", "set_override", percent=100.0)
        bench.run(4.0)
        assert bench.blocks["channel"][-1].done, seed
        smooth(bench)
        assert max(programmed.distance(Point(*point[:2])) for point in path(bench)) <= 0.05 + 1e-9


def test_an_axis_fault_stops_the_path_within_its_tolerance() -> None:
    """An axis that stands: the others come to rest on the path, in corners and on lines, and it can be met again."""
    corners = [(0, 0), (30, 0), (30, 20), (10, 25), (12, 5), (0, 10), (0, 0)]
    lines = ["#CONTOUR MODE [DEV PATH_DEV=0.05]", "G261 F6000", *(f"G01 X{x} Y{y}" for x, y in corners[1:])]
    programmed = LineString(corners)
    for seed in range(5):
        bench = MachineBench(program(*lines), end_when_idle=False)
        bench.run(random.Random(seed).randrange(10, 140) * 0.01)
        bench.give("z", "upstream_lost", source="plc")
        bench.run(0.5)
        assert [text[:11] for text in bench.errors()] == ["P-ERR-26101", "P-ERR-26101", "P-ERR-22012"], seed
        assert max(programmed.distance(Point(*point[:2])) for point in path(bench)) <= 0.05 + 1e-9
        smooth(bench)
        assert bench.give("z", "reset").accepted and bench.give("channel", "reset").accepted
        bench.run(0.05)
        assert bench.give("channel", "mdi", text="G01 X10 Y20 F6000").accepted
        bench.run(2.0)
        assert bench.position("x") == 10.0 and bench.position("y") == 20.0
        smooth(bench)


def test_a_smoothed_contour_runs_at_feed_rate() -> None:
    """600 chords of 0.05 mm, rounded to 1 µm, on a circle of 30 mm at F6000."""
    angles = np.arange(1, 601) * 0.05 / 30.0
    lines = [f"G01 X{30 * math.sin(t):.3f} Y{30 - 30 * math.cos(t):.3f}" for t in angles]
    bench = MachineBench(program("#HSC ON [BSPLINE PATH_DEV=0.005]", "F3000", *lines, "#HSC OFF")).run()
    velocity = np.array(bench.column("channel", "path_velocity"))
    assert np.count_nonzero(velocity) * CYCLE_TIME <= 1.05 * (30.0 / 50.0 + 50.0 / 2000.0 + 2000.0 / 50_000.0)
    assert moving(bench) == pytest.approx(50.0, rel=1e-3)
    smooth(bench)
    x, y, _ = path(bench).T
    assert np.abs(np.hypot(x, y - 30.0) - 30.0).max() <= 0.006


def test_single_block_stops_at_every_end() -> None:
    bench = MachineBench(program("G359 F6000", "G01 X6", "X12", "X18"), start=False, end_when_idle=False)
    bench.run(0.02)
    bench.give("channel", "single_block", enabled=True)
    bench.give("channel", "start")
    places = []
    for _ in range(3):
        bench.run(1.0)
        places.append(path(bench)[-1][0])
        bench.give("channel", "start")
    assert places == pytest.approx([6.0, 12.0, 18.0], abs=1e-9)


def test_rapid_traverse_shows_the_velocity_that_the_axes_allow() -> None:
    one = MachineBench(program("G00 X60")).run()
    linked = MachineBench(program("G359", "G00 X20", "X40", "X60")).run()
    for bench in (one, linked):
        feeds = {feed for feed in bench.column("channel", "programmed_feed") if feed}
        assert feeds == {MILL.axes["x"].rapid_velocity}
    assert max(linked.column("channel", "path_velocity")) == pytest.approx(max(one.column("channel", "path_velocity")))


def test_slope_step_feeds_no_jerk_forward() -> None:
    lines = ("G01 X20", "X40", "X60")
    bench = MachineBench(program("#SLOPE [TYPE=STEP]", "G359 F6000", *lines)).run()
    limited = MachineBench(program("G359 F6000", *lines)).run()
    assert set(bench.column("x", "set_jerk")) == {0.0} and max(limited.column("x", "set_jerk")) > 0.0
    assert max(bench.column("x", "set_acceleration")) == pytest.approx(MILL.axes["x"].acceleration)
    assert np.count_nonzero(bench.column("channel", "path_velocity")) < np.count_nonzero(
        limited.column("channel", "path_velocity")
    )


def test_offsets_are_reported_as_the_path_passes_their_block() -> None:
    bench = MachineBench(program("G359 F6000", "G01 X20", "G92 X5", "X30", "X45")).run()
    x = path(bench)[:, 0]
    reports = [(report.cycle, report.line) for block in bench.blocks["channel"] for report in block.offsets]
    cycle = next(cycle for cycle, line in reports if line > 3)
    assert abs(cycle - int(np.argmax(x > 20.0))) <= 1
    assert min(bench.column("channel", "path_velocity")[150:400]) > 0.0


def test_rapid_traverse_behind_smoothed_blocks_begins_where_they_end() -> None:
    """Also where contouring links the two."""
    text = program(
        "#HSC ON [BSPLINE PATH_DEV=0.01]", "G261", "G01 X1 F3000", "X2 Y0.1", "X3 Y0.1", "X4", "G00 X10 Z5", "G01 X11"
    )
    bench = MachineBench(text).run()
    assert bench.errors() == []
    steps = np.abs(np.diff(path(bench), axis=0)).max()
    assert steps < 0.6 and path(bench)[-1] == pytest.approx((11.0, 0.1, 5.0), abs=1e-9)
    smooth(bench)


def test_m01_without_optional_stop_is_passed() -> None:
    bench = MachineBench(program("G01 X50 F6000", "M01", "X100")).run()
    assert min(moving(bench)) > 99.0


def test_a_slow_block_behind_a_fast_one_is_divided_as_it_is_needed() -> None:
    bench = MachineBench(program("G01 X100 F20000", "X200 F10"), end_when_idle=False)
    bench.run(0.6)
    linked = bench.units["channel"]._motion._active
    assert isinstance(linked, LinkedPath) and sum(map(len, linked.look_ahead._stretches)) < 1000
