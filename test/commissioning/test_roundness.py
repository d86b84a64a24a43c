"""Circle tests with known deviations: ellipse, waves, quadrant peaks, lag; G, G(b), F and the peaks come out."""

import math

import numpy as np
import pytest

from cnc_ptp.commissioning.roundness import bidirectional_deviation, evaluate_circle, quadrant_peaks

TURN = np.linspace(0.0, 360.0, 4712, endpoint=False)


def path(deviation=0.0, radius=25.0, centre=(0.0, 0.0), clockwise=False):
    angles = np.radians(-TURN if clockwise else TURN)
    r = radius + deviation
    return np.column_stack([centre[0] + r * np.cos(angles), centre[1] + r * np.sin(angles)])


def spikes(heights, clockwise=False, width=4.0):
    """After each reversal a spike that rises within 1° of the way and decays over `width` degrees."""
    total = np.zeros_like(TURN)
    for number, height in enumerate(heights):
        since = (TURN + 90.0 * number if clockwise else TURN - 90.0 * number) % 360.0
        total += height * np.where(since < 1.0, since, np.exp(-(since - 1.0) / width)) * (since < 60.0)
    return total


@pytest.mark.parametrize("clockwise", [False, True])
def test_quadrant_peaks_have_their_height_place_and_axis(clockwise):
    heights = (0.012, 0.009, -0.004, 0.007)
    result = evaluate_circle(path(spikes(heights, clockwise), clockwise=clockwise), radius=25.0, clockwise=clockwise)
    assert [peak.angle for peak in result.peaks] == [0.0, 90.0, 180.0, 270.0]
    assert [peak.reversing for peak in result.peaks] == [0, 1, 0, 1]
    for peak, height in zip(result.peaks, heights, strict=True):
        assert peak.height == pytest.approx(height, abs=0.06 * max(heights))
        way = peak.angle - peak.at if clockwise else peak.at - peak.angle
        assert (way + 180.0) % 360.0 - 180.0 == pytest.approx(1.0, abs=0.2)
    assert result.largest_peak == pytest.approx(0.012, rel=0.06)


def test_peaks_are_counted_from_the_shape_of_the_rest():
    """An ellipse off centre with peaks on it: the ellipse is in G, not in the peaks."""
    ellipse = 0.020 * np.cos(2 * np.radians(TURN)) + 0.03 * np.sin(np.radians(TURN))
    peaks = quadrant_peaks(TURN, ellipse + spikes((0.01, 0.01, 0.01, 0.01)), clockwise=False)
    for peak in peaks:
        assert peak.height == pytest.approx(0.01, rel=0.08)
    for peak in quadrant_peaks(TURN, ellipse, clockwise=False):
        assert abs(peak.height) < 1e-12


def test_the_lag_of_equal_axes_makes_the_circle_smaller_not_rounder():
    """Contraction R·(1 - 1/sqrt(1 + (w/Kv)²)) shows in F, G stays 0."""
    shrink = 25.0 * (1.0 - 1.0 / math.hypot(1.0, (33.3 / 25.0) / 50.0))
    result = evaluate_circle(path(-shrink), radius=25.0, clockwise=False)
    assert result.circular_deviation == pytest.approx(0.0, abs=1e-10)
    assert (result.radial_low, result.radial_high) == (pytest.approx(-shrink), pytest.approx(-shrink))
    assert result.fitted.radius == pytest.approx(25.0 - shrink)


def test_different_lags_make_an_ellipse_at_45_degrees_in_both_directions():
    """Phase lags a and b of the axes: |p|² = R²(1 + sin(a - b)·sin(2φ + …)), G = 2R·|sin((a - b)/2)| nearly."""
    a, b = 0.020, 0.026
    turns = []
    for direction in (1.0, -1.0):
        phase = np.radians(direction * TURN)
        turns.append(25.0 * np.column_stack([np.cos(phase - direction * a), np.sin(phase - direction * b)]))
    for points, clockwise in zip(turns, (False, True), strict=True):
        result = evaluate_circle(points, radius=25.0, clockwise=clockwise)
        wanted = 25.0 * (math.sqrt(1 + math.sin(abs(a - b))) - math.sqrt(1 - math.sin(abs(a - b))))
        assert result.circular_deviation == pytest.approx(wanted, rel=1e-4)
    # The long axes of the two ellipses stand across each other, so the ring of both is no narrower.
    assert bidirectional_deviation(turns) >= wanted * (1 - 1e-4)


def test_bidirectional_deviation_of_two_sizes():
    assert bidirectional_deviation([path(0.004), path(-0.003)]) == pytest.approx(0.007, rel=1e-6)


def test_the_centre_does_not_matter():
    deviation = 0.003 * np.cos(3 * np.radians(TURN)) + spikes((0.01, 0.02, 0.01, 0.02))
    here = evaluate_circle(path(deviation), radius=25.0, clockwise=False)
    there = evaluate_circle(path(deviation, centre=(-140.0, 88.0)), radius=25.0, clockwise=False)
    assert there.circular_deviation == pytest.approx(here.circular_deviation, abs=1e-9)
    assert there.radial_high == pytest.approx(here.radial_high, abs=1e-9)
    assert [p.height for p in there.peaks] == pytest.approx([p.height for p in here.peaks], abs=1e-9)


def test_a_quadrant_without_points_has_no_peak():
    kept = (TURN > 100.0) | (TURN < 80.0)
    kept &= (TURN < 85.0) | (TURN > 112.0)
    peaks = quadrant_peaks(TURN[kept], np.zeros(int(kept.sum())), clockwise=False)
    assert [math.isnan(peak.height) for peak in peaks] == [False, True, False, False]
