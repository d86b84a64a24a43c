"""Cam tables and their coupling: against scipy's own splines, finite differences and what the user sees at the seam."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples
from scipy.interpolate import CubicSpline
from slave_support import follow as follow_block

from cnc_ptp.axis.cam import CamCoupling, CamTable
from cnc_ptp.errors import CncError
from cnc_ptp.motion.setpoints import MotionState

QUICK = settings(max_examples=examples(60), deadline=None, derandomize=True, database=None)
T = 0.001
COSINE = [[30.0 * k, 50.0 * (1.0 - cos(pi * k / 6.0))] for k in range(13)]
"""0 … 360: up to 100 mm and back."""
FEED = [[30.0 * k, 20.0 * k + 10.0 * sin(pi * k / 6.0)] for k in range(13)]
"""Lifts by 240 mm a turn."""
STEP = [[100.0, 5.0], [130.0, 8.0], [170.0, 40.0], [200.0, 55.0], [220.0, 55.0]]

STEPS = st.lists(st.tuples(st.floats(1.0, 50.0), st.floats(-20.0, 20.0)), min_size=2, max_size=12)


def points_of(steps: list[tuple[float, float]]) -> list[list[float]]:
    return [list(point) for point in np.cumsum([(-40.0, 3.0), *steps], axis=0).tolist()]


def values(table: CamTable, x: np.ndarray) -> np.ndarray:
    """Columns y, y', y'', y'''."""
    return np.array([table.at(place) for place in x.tolist()])


# tables


@QUICK
@given(STEPS)
def test_periodic_table_is_scipys_periodic_spline(steps: list[tuple[float, float]]) -> None:
    points = np.array(points_of(steps))
    points[-1, 1] = points[0, 1]
    x = np.linspace(points[0, 0], points[-1, 0], 101)[:-1]
    spline = CubicSpline(*points.T, bc_type="periodic")
    got = values(CamTable(points.tolist(), cyclic=True), x)
    for order in range(3):
        assert got[:, order] == pytest.approx(spline(x, order), rel=1e-9, abs=1e-9)


@QUICK
@given(STEPS)
def test_table_with_lift_repeats_itself_higher(steps: list[tuple[float, float]]) -> None:
    points = points_of(steps)
    table = CamTable(points, cyclic=True)
    length, lift = points[-1][0] - points[0][0], points[-1][1] - points[0][1]
    x = np.linspace(points[0][0], points[-1][0], 50)[1:-1]
    once = values(table, x)
    for turns in (-3, 1, 4):
        again = values(table, x + turns * length)
        assert again[:, 0] == pytest.approx(once[:, 0] + turns * lift, abs=1e-8)
        assert again[:, 1:3] == pytest.approx(once[:, 1:3], abs=1e-8)


@QUICK
@given(STEPS, st.booleans())
def test_table_goes_through_its_points_with_continuous_acceleration(
    steps: list[tuple[float, float]], cyclic: bool
) -> None:
    points = np.array(points_of(steps))
    table = CamTable(points.tolist(), cyclic=cyclic)
    x, y = points.T
    assert values(table, x)[:, 0] == pytest.approx(y, abs=1e-9)
    knots = [*x, 0.5 * (x[0] + x[1]), 0.5 * (x[-2] + x[-1])]
    for knot in knots:
        before, after = values(table, knot + np.array([-1e-9, 1e-9]))
        scale = 1.0 + np.abs(values(table, np.linspace(x[0], x[-1], 200))[:, 3]).max()
        assert after[:3] == pytest.approx(before[:3], abs=1e-7 * scale)


@QUICK
@given(STEPS, st.booleans())
def test_derivatives_are_those_of_the_values(steps: list[tuple[float, float]], cyclic: bool) -> None:
    """Central differences of a cubic: exact for y'' and y''' inside a piece, and y' to h²·y'''/6."""
    points = np.array(points_of(steps))
    table = CamTable(points.tolist(), cyclic=cyclic)
    knots = np.sort([*points[:, 0], *(points[:-1, 0] + 0.5 * np.diff(points[:, 0]))])
    middle, h = 0.5 * (knots[1:] + knots[:-1]), 0.05
    low, mid, high = (values(table, middle + step) for step in (-h, 0.0, h))
    assert mid[:, 1] == pytest.approx((high[:, 0] - low[:, 0]) / (2 * h) - h * h * mid[:, 3] / 6.0, abs=1e-7)
    assert mid[:, 2] == pytest.approx((high[:, 1] - low[:, 1]) / (2 * h), abs=1e-7)
    assert mid[:, 3] == pytest.approx((high[:, 2] - low[:, 2]) / (2 * h), abs=1e-7)


def test_single_table_rests_at_its_ends() -> None:
    table = CamTable(STEP, cyclic=False)
    for x, y in ((-1e6, 5.0), (99.9, 5.0), (220.0, 55.0), (1e6, 55.0)):
        assert table.at(x) == (y, 0.0, 0.0, 0.0)
    for x in (100.0, 220.0 - 1e-9):
        assert table.at(x)[1:3] == pytest.approx((0.0, 0.0), abs=1e-6)
    assert [table.turn(x) for x in (-1e6, 150.0, 1e6)] == [0, 0, 0]


def test_single_table_stays_near_scipys_clamped_spline() -> None:
    """A knot more at each end must not bend the table elsewhere: 13 points of a half cosine from 0 to 100."""
    points = np.array([[30.0 * k, 50.0 * (1.0 - cos(pi * k / 12.0))] for k in range(13)])
    table, spline = CamTable(points.tolist(), cyclic=False), CubicSpline(*points.T, bc_type="clamped")
    x = np.linspace(0.0, 359.9, 500)
    away = np.abs(values(table, x)[:, 0] - spline(x))
    assert away.max() < 0.2
    assert away[(x > 90.0) & (x < 270.0)].max() < 0.005


BAD = {
    "few": ([[0, 0], [1, 1]], "a cam table needs 3 points or more, it has 2"),
    "none": ([], "a cam table needs 3 points or more, it has 0"),
    "equal": ([[0, 0], [1, 1], [1, 2]], "master position 1 comes after 1; a cam table must ascend by 1e-06 or more"),
    "falls": (
        [[0, 0], [2.5, 1], [1, 2]],
        "master position 1 comes after 2.5; a cam table must ascend by 1e-06 or more",
    ),
    "short": ([[0, 0], [1], [2, 2]], "each point of a cam table needs two finite numbers, master and slave"),
    "long": ([[0, 0, 0], [1, 1, 1], [2, 2, 2]], "each point of a cam table needs two finite numbers, master and slave"),
    "text": ([[0, 0], ["a", 1], [2, 2]], "each point of a cam table needs two finite numbers, master and slave"),
    "flat": ([0, 1, 2], "each point of a cam table needs two finite numbers, master and slave"),
    "nan": (
        [[0, 0], [1, float("nan")], [2, 2]],
        "each point of a cam table needs two finite numbers, master and slave",
    ),
    "inf": (
        [[0, 0], [1, 1], [float("inf"), 2]],
        "each point of a cam table needs two finite numbers, master and slave",
    ),
    "close": (
        [[0, 0], [1e-8, 1], [1, 0]],
        "master position 1e-08 comes after 0; a cam table must ascend by 1e-06 or more",
    ),
    "huge": ([[0, 0], [1, 1e300], [2, 0]], "the points of a cam table must lie within ±1e+12"),
    "long number": (
        [[0, 0], [1, 10**400], [2, 0]],
        "each point of a cam table needs two finite numbers, master and slave",
    ),
}


@pytest.mark.parametrize("cyclic", [True, False])
@pytest.mark.parametrize("name", BAD)
def test_bad_table(name: str, cyclic: bool) -> None:
    points, text = BAD[name]
    with pytest.raises(CncError) as caught:
        CamTable(points, cyclic=cyclic)
    assert (caught.value.number, caught.value.message) == (23052, text)


# coupling


def coupling(points: list[list[float]], *, cyclic: bool = True, **changes: float | None) -> CamCoupling:
    arguments = {"master_offset": 0.0, "master_scaling": 1.0, "slave_scaling": 1.0, "slave_offset": None} | changes
    return CamCoupling("x", CamTable(points, cyclic=cyclic), **arguments)  # type: ignore[arg-type]


def sweep(begin: float, velocity: float, seconds: float, acceleration: float = 0.0) -> list[MotionState]:
    t = np.arange(round(seconds / T)) * T
    columns = (
        begin + velocity * t + 0.5 * acceleration * t * t,
        velocity + acceleration * t,
        0 * t + acceleration,
        0 * t,
    )
    return list(zip(*(column.tolist() for column in columns), strict=True))


def follow(cam: CamCoupling, states: list[MotionState], position: float = 0.0) -> np.ndarray:
    return np.array(follow_block(cam, position, states))


@pytest.mark.parametrize("velocity", [700.0, -700.0])
@pytest.mark.parametrize("points", [COSINE, FEED])
def test_velocity_acceleration_and_jerk_of_the_slave_are_derivatives_of_its_position(
    points: list[list[float]], velocity: float
) -> None:
    """An accelerated master over several turns; the jerk of a cubic spline steps at its points only."""
    p, v, a, j = follow(coupling(points), sweep(10.0, velocity, 1.5, acceleration=velocity), 0.0).T
    assert v[1:-1] == pytest.approx((p[2:] - p[:-2]) / (2 * T), abs=1e-6 + T * T / 5.0 * np.abs(j).max())
    assert a[1:-1] == pytest.approx((v[2:] - v[:-2]) / (2 * T), abs=100.0 + 0.01 * np.abs(a).max())
    assert np.abs(np.diff(a)).max() <= 1.5 * np.abs(j).max() * T
    calm = np.abs(np.diff(j, append=j[-1])) < 0.01 * np.abs(j).max()
    assert np.median(np.abs(np.gradient(a, T) - j)[calm]) < 0.01 * np.abs(j).max()


def test_scalings_and_offsets() -> None:
    """Slave = 0.5 · y((pm - 90)/2) + 7; y of the table is known at its points."""
    cam = coupling(COSINE, master_offset=90.0, master_scaling=2.0, slave_scaling=0.5, slave_offset=7.0)
    places = [(90.0 + 2.0 * x, 0.0, 0.0, 0.0) for x, _ in COSINE]
    assert follow(cam, places, 7.0)[:, 0] == pytest.approx([0.5 * y + 7.0 for _, y in COSINE], abs=1e-9)


def test_negative_master_scaling_runs_the_table_backwards() -> None:
    cam = coupling(FEED, master_scaling=-1.0)
    places = [(-x, -1.0, 0.0, 0.0) for x, _ in FEED]
    rows = follow(cam, places, 0.0)
    assert rows[:, 0] == pytest.approx([y for _, y in FEED], abs=1e-9)
    assert (rows[:, 1] > 0.0).all()


def test_offset_results_from_the_coupling_positions() -> None:
    rows = follow(coupling(COSINE), sweep(180.0, 360.0, 1.0), 1000.0)
    assert rows[0, 0] == 1000.0
    assert rows[:, 0].min() == pytest.approx(900.0, abs=1e-3)


def test_slave_offset_that_does_not_fit_is_told_and_nothing_begins() -> None:
    cam = coupling(COSINE, slave_offset=7.0)
    with pytest.raises(CncError) as caught:
        follow_block(cam, 7.5, sweep(180.0, 0.0, 0.01))
    text = "the cam table puts the slave at 107 with its slave_offset, the axis is at 7.5"
    assert (caught.value.number, caught.value.message) == (23053, text)
    assert follow_block(cam, 107.0, sweep(180.0, 0.0, 0.01))[0][0] == 107.0


def test_single_cam_holds_its_ends_in_both_directions() -> None:
    cam = coupling(STEP, cyclic=False)
    there = follow(cam, sweep(0.0, 300.0, 1.0), 5.0)
    back = follow(cam, sweep(300.0, -300.0, 1.0), 5.0)
    assert set(there[:333, 0]) == {5.0}
    assert set(there[734:, 0]) == {55.0}
    assert set(back[667:, 0]) == {5.0}
    for rows in (there, back):
        assert np.abs(np.diff(rows[:, 2])).max() <= 1.01 * np.abs(rows[:, 3]).max() * T


SHORT = [[-20.0, 3.0], [10.0, 25.0], [60.0, 30.0], [100.0, 11.0]]
"""Another length, another begin, a lift of 8."""


@pytest.mark.parametrize("first", [COSINE, FEED])
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_new_table_comes_in_at_the_seam(first: list[list[float]], direction: float) -> None:
    """Up to the seam nothing changes; from there on the new table runs from its begin (its end) at the same height."""
    states = sweep(450.0, direction * 360.0, 3.0)
    old, changed = coupling(first), coupling(first)
    plain = follow(old, states, 50.0)
    follow_begin = follow(changed, states[:100], 50.0)
    changed.change_table(CamTable(SHORT, cyclic=True))
    rows = np.concatenate([follow_begin, follow(changed, states[100:], 0.0)])
    place = np.array(states)[:, 0]
    seam = 720.0 if direction > 0.0 else 360.0
    before = (place < seam) if direction > 0.0 else (place >= seam)
    assert rows[before] == pytest.approx(plain[before], abs=1e-9)
    new = CamTable(SHORT, cyclic=True)
    edge = -20.0 if direction > 0.0 else 100.0
    table_first = CamTable(first, cyclic=True)
    height = 50.0 - table_first.at(450.0)[0] + table_first.at(seam)[0]
    expected = [height + new.at(edge + x - seam)[0] - new.at(edge)[0] for x in place[~before].tolist()]
    assert len(expected) > 1000
    assert rows[~before, 0] == pytest.approx(expected, abs=1e-8)
    assert np.abs(np.diff(rows[:, 0])).max() < 1.0  # mm a cycle: no step


def test_new_table_waits_while_the_master_stays_in_its_turn() -> None:
    cam = coupling(COSINE)
    follow_block(cam, 0.0, sweep(100.0, 0.0, 0.01))
    cam.change_table(CamTable(SHORT, cyclic=True))
    there, back = sweep(100.0, 250.0, 1.0), sweep(350.0, -340.0, 1.0)
    rows = follow(cam, [*there, *back])
    table = CamTable(COSINE, cyclic=True)
    offset = -table.at(100.0)[0]
    assert rows[:, 0] == pytest.approx([table.at(state[0])[0] + offset for state in [*there, *back]], abs=1e-9)


def test_change_of_the_source_moves_nothing() -> None:
    states = sweep(100.0, 700.0, 1.0)
    plain, shifted = coupling(FEED, master_scaling=2.0), coupling(FEED, master_scaling=2.0)
    for cam in (plain, shifted):
        follow_block(cam, 0.0, states[:500])
    shifted.change_source(10.0, 35.0)
    moved = follow_block(shifted, 0.0, [(p + 25.0, v, a, j) for p, v, a, j in states[500:]])
    assert np.array(moved) == pytest.approx(np.array(follow_block(plain, 0.0, states[500:])), rel=1e-9, abs=1e-7)
