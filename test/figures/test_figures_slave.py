"""The runs behind the figures of TX1250 chapter 3 and of the kinds beyond it: printed numbers, and what rules give."""

from pathlib import Path

import numpy as np
import pytest
from figure_support import CYCLE_TIME, SCENARIOS, largest_step, ramp_time, run_of
from scipy.interpolate import CubicSpline

RAMP = ramp_time(2000.0, 5000.0, 50000.0)
"""0.5 s from rest to 2000 mm/s, 500 mm long."""
CHAPTER_3 = (
    "linear_path_control",
    "factor_negative",
    "factor_change",
    "decoupling_1_0",
    "decoupling_0_5",
    "new_end_0_8",
    "new_end_minus_0_8",
    "new_end_against",
    "compensation_makes_up",
    "compensation_slows_down",
)
FREE = ("decoupling_1_0", "decoupling_0_5", "new_end_0_8", "new_end_minus_0_8", "new_end_against", "flying_saw")


def column(name, axis, field="position"):
    return run_of(f"slave_{name}").column(axis, f"set_{field}")


def cycle_of(name, text):
    """The cycle of the first marker that begins with `text`."""
    marker = next(marker for marker in run_of(f"slave_{name}").markers if marker.text.startswith(text))
    return round(marker.time / CYCLE_TIME)


def error_of(name, factor, part=slice(None)):
    """How far y is from factor · x, in the part; the offset is that of its first cycle."""
    x, y = column(name, "x")[part], column(name, "y")[part]
    return np.abs((y - y[0]) - factor * (x - x[0])).max()


# coupling


def test_linear_path_control_follows_override_and_stop():
    """At 30 % 600 and 450 mm/s, at 100 % 2000 and 1500; the stop is that of the master."""
    name = "linear_path_control"
    assert error_of(name, 0.75) <= 1e-9
    full, stop = cycle_of(name, "x: set override"), cycle_of(name, "x: stop")
    for axis, factor in (("x", 1.0), ("y", 0.75)):
        velocity = column(name, axis, "velocity")
        assert velocity[full - 1] == pytest.approx(600.0 * factor)
        assert velocity[stop - 1] == pytest.approx(2000.0 * factor)
        assert velocity[stop + round(RAMP / CYCLE_TIME) :] == pytest.approx(0.0, abs=1e-9)
    assert column(name, "x")[-1] < 20_000.0


def test_negative_factor():
    assert error_of("factor_negative", -0.5) <= 1e-9
    assert (column("factor_negative", "x")[-1], column("factor_negative", "y")[-1]) == (2000.0, -1000.0)
    assert column("factor_negative", "y", "velocity").min() == -1000.0


def test_change_of_the_factor_keeps_the_position_and_steps_the_velocity():
    name = "factor_change"
    change = cycle_of(name, "y: set coupling factor")
    assert error_of(name, -0.7, slice(0, change)) <= 1e-9
    assert error_of(name, -0.8, slice(change, None)) <= 1e-9
    velocity = column(name, "y", "velocity")
    assert (velocity[change - 1], velocity[change]) == pytest.approx((-1400.0, -1600.0))
    assert largest_step(column(name, "y")) <= 1600.0 * CYCLE_TIME * (1.0 + 1e-9)
    at_change = column(name, "x")[change]
    assert column(name, "y")[-1] == pytest.approx(-0.7 * at_change - 0.8 * (2000.0 - at_change), abs=1e-9)


# decoupling


@pytest.mark.parametrize(("name", "factor"), [("decoupling_1_0", 1.0), ("decoupling_0_5", 0.5)])
def test_decoupled_slave_goes_on_and_stops_alone(name, factor):
    """Its stopping distance is v²/2A + v·A/2J; the master continues and stops in its own."""
    decoupled, stop, last = (cycle_of(name, text) for text in ("y: decouple", "y: stop", "x: stop"))
    assert error_of(name, factor, slice(0, stop)) <= 1e-9
    assert decoupled < stop < last
    v = 2000.0 * factor
    way = 0.5 * v * ramp_time(v, 5000.0, 50000.0)
    assert column(name, "y")[-1] - column(name, "y")[stop] == pytest.approx(way, abs=1e-6)
    assert column(name, "x", "velocity")[stop:last] == pytest.approx(2000.0)
    assert column(name, "x")[-1] - column(name, "x")[last] == pytest.approx(500.0, abs=1e-6)


@pytest.mark.parametrize(
    ("name", "factor", "end"),
    [("new_end_0_8", 0.8, 6000.0), ("new_end_minus_0_8", -0.8, -6000.0), ("new_end_against", 0.75, 500.0)],
)
def test_new_end_position_is_reached(name, factor, end):
    decoupled = cycle_of(name, "y: decouple")
    assert error_of(name, factor, slice(0, decoupled)) <= 1e-9
    assert column(name, "y")[-1] == pytest.approx(end, abs=1e-9)
    assert column(name, "x")[-1] == 10_000.0
    velocity = column(name, "y", "velocity")[decoupled:]
    assert velocity[0] == pytest.approx(2000.0 * factor)
    assert np.abs(velocity).max() == pytest.approx(abs(2000.0 * factor))
    turns = (np.sign(velocity[velocity != 0.0]) != np.sign(velocity[0])).any()
    assert turns == (name == "new_end_against")


def test_way_against_the_direction_is_a_stop_and_a_return():
    """1500 mm/s: stop in 0.4 s and 300 mm, and a positioning from there to 500 mm at 1500 mm/s."""
    name = "new_end_against"
    decoupled, y = cycle_of(name, "y: decouple"), column(name, "y")
    turn = y[decoupled] + 300.0
    assert y.max() == pytest.approx(turn, abs=1e-2)
    seconds = 0.4 + (turn - 500.0) / 1500.0 + 0.4
    arrived = np.flatnonzero(np.abs(y - 500.0) > 1e-6)[-1] + 1
    assert (arrived - decoupled) * CYCLE_TIME == pytest.approx(seconds, abs=0.003)


@pytest.mark.parametrize("name", FREE)
def test_decoupling_makes_no_step(name):
    for axis in "xy":
        assert largest_step(column(name, axis, "acceleration")) <= 50_000.0 * CYCLE_TIME * (1.0 + 1e-9)
        p, v, a = (column(name, axis, field) for field in ("position", "velocity", "acceleration"))
        assert np.diff(v) == pytest.approx(0.5 * CYCLE_TIME * (a[1:] + a[:-1]), abs=0.02)
        assert np.diff(p) == pytest.approx(0.5 * CYCLE_TIME * (v[1:] + v[:-1]), abs=1e-4)


# compensation


@pytest.mark.parametrize(("name", "start", "sign"), [("makes_up", -500.0, 1.0), ("slows_down", 500.0, -1.0)])
def test_compensation_brings_the_slave_to_its_master(name, start, sign):
    """D = T·v - v²/2·(1/A+ + 1/A-) over T = L/VP = 2.5 s: 232.4 mm/s, not above VK = 300; D in full, both end at 10000."""
    name = f"compensation_{name}"
    begin = cycle_of(name, "y: compensation start")
    x, y = column(name, "x"), column(name, "y")
    assert y[begin] - x[begin] == pytest.approx(start, abs=1e-9)
    assert (x[-1], y[-1]) == pytest.approx((10_000.0, 10_000.0), abs=1e-6)
    peak = 2.5 / 0.003 - np.sqrt((2.5 / 0.003) ** 2 - 2.0 * 500.0 / 0.003)
    difference = sign * (column(name, "y", "velocity") - column(name, "x", "velocity"))[begin:]
    assert difference.max() == pytest.approx(peak, abs=1e-6)
    assert np.flatnonzero(np.abs(y - x) > 1e-6)[-1] - begin == pytest.approx(2500, abs=5)
    rates = sign * (column(name, "y", "acceleration") - column(name, "x", "acceleration"))[begin:]
    first, last = (500.0, -1000.0) if sign > 0.0 else (1000.0, -500.0)
    assert (rates.max(), rates.min()) == pytest.approx((first, last), abs=1e-6)


# beyond the manual


def test_cyclic_slave_keeps_its_bound_and_is_linear_between():
    assert np.abs(column("cyclic", "y", "acceleration")).max() == pytest.approx(12_000.0, rel=1e-9)
    assert largest_step(column("cyclic", "y", "velocity")) <= 12.0 * (1.0 + 1e-9)
    for factor, part in (
        (0.5, slice(0, 1000)),
        (1.0, slice(1090, 1700)),
        (-0.5, slice(1960, 2500)),
        (0.0, slice(2590, None)),
    ):
        assert error_of("cyclic", factor, part) <= 1e-9


def test_flying_saw_is_synchronous_from_its_positions_on():
    x, y = column("flying_saw", "x"), column("flying_saw", "y")
    part = (x >= 2000.0) & (np.arange(len(x)) < cycle_of("flying_saw", "y: decouple"))
    assert y[part] == pytest.approx(x[part] - 1600.0, abs=1e-9)
    assert y[-1] == pytest.approx(0.0, abs=1e-9)
    assert part.sum() > 500


def points(file: str) -> np.ndarray:
    return np.loadtxt(Path(SCENARIOS) / file, delimiter=",", skiprows=1)


def test_cam_is_scipys_spline_and_changes_at_the_seam():
    full, half = (CubicSpline(*points(file).T, bc_type="periodic") for file in ("slave_cam.csv", "slave_cam_half.csv"))
    c, y = column("cam", "c"), column("cam", "y")
    handed = cycle_of("cam", "y: change cam")
    assert 360.0 < c[handed] < 720.0
    assert y == pytest.approx(np.where(c < 720.0, full(c % 360.0), half(c % 360.0)), abs=1e-8)
    assert c[-1] == 1080.0


def test_gantry_stops_when_the_difference_is_too_large():
    """y lags v/200 - v/500 more: 3 mm at 1000 mm/s, 5 mm at 1667 mm/s (and later, while v rises, by less than 1/Kv)."""
    run = run_of("slave_gantry")
    difference = np.abs(run.column("x", "actual_position") - run.column("y", "actual_position"))
    first = cycle_of("gantry", "x: move absolute 3000")
    assert difference[:first].max() == pytest.approx(3.0, abs=1e-3)
    fault, spread = cycle_of("gantry", "y: error 23055"), cycle_of("gantry", "x: error 23056")
    assert difference[fault - 1] <= 5.0 < difference[fault]
    assert 1667.0 < column("gantry", "y", "velocity")[fault] < 1667.0 + 5000.0 * 0.01
    assert 0 < spread - fault <= 20


def test_every_figure_of_chapter_3_is_there():
    names = {path.stem.removeprefix("slave_") for path in Path(SCENARIOS).glob("slave_*.yaml")}
    assert names == {*CHAPTER_3, "cyclic", "flying_saw", "cam", "gantry"}
