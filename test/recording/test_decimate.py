"""Decimation keeps extremes, ends, flat stretches and gaps."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from cnc_ptp.recording.decimate import line_points, path_points


def cycles(count, start=0):
    return np.arange(start, start + count, dtype=np.uint64)


@given(st.lists(st.sampled_from([0.0, 1.0, -1.0, 2.5]), min_size=1, max_size=300))
def test_short_lines_keep_every_corner(values):
    x, y = line_points(cycles(len(values)), np.array(values), points=1000)
    assert np.array_equal(np.interp(np.arange(len(values)), x, y), values)


@given(seed=st.integers(0, 1000), peak=st.integers(0, 49_999))
def test_long_lines_keep_peaks_and_ends(seed, peak):
    values = np.random.default_rng(seed).normal(size=50_000)
    values[peak] = 100.0
    x, y = line_points(cycles(50_000), values, points=400)
    assert 300 <= len(x) <= 402
    assert (x[y == 100.0] == peak).all()
    assert (y.max(), y.min()) == (100.0, values.min())
    assert (x[0], x[-1]) == (0, 49_999)


def test_nan_and_infinity_do_not_hide_the_rest():
    values = np.sin(np.arange(20_000) / 50.0)
    values[[5000, 6000]] = np.nan, np.inf
    _, y = line_points(cycles(20_000), values, points=1000)
    assert np.isnan(y).sum() >= 1
    assert np.nanmin(y) == np.nanmin(values)


def test_gaps_interrupt_the_line():
    x, y = line_points(np.concatenate([cycles(3), cycles(3, start=10)]), np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0]))
    assert np.array_equal(x, [0, 1, 2, np.nan, 10, 11, 12], equal_nan=True)
    assert np.array_equal(y, [0, 1, 2, np.nan, 3, 4, 5], equal_nan=True)


def test_very_many_gaps_are_drawn_as_one_line():
    x, _ = line_points(cycles(1000) * np.uint64(2), np.arange(1000.0))
    assert not np.isnan(x).any()


def test_empty_line():
    x, y = line_points(cycles(0), np.empty(0))
    assert (len(x), len(y)) == (0, 0)


def test_path_keeps_corners_and_drops_standstill():
    side = np.linspace(0.0, 100.0, 5000)
    stand = np.zeros(5000)
    x = np.concatenate([stand, side, np.full(5000, 100.0)])
    y = np.concatenate([stand, np.zeros(5000), side])
    chosen = path_points([x, y], points=50)
    assert len(chosen) < 60
    corner = np.abs(np.hypot(x[chosen] - 100.0, y[chosen])).min()
    assert corner == 0.0
    assert (chosen[0], chosen[-1]) == (0, 14_999)
    assert (np.diff(np.hypot(x[chosen], y[chosen])) <= 100.0).all()


def test_path_without_motion():
    assert path_points([np.ones(10), np.ones(10)]).tolist() == [0]
    assert path_points([np.empty(0), np.empty(0)]).tolist() == []
