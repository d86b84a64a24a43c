"""Least squares circle and narrowest ring against closed forms, another optimiser and random properties."""

import itertools

import numpy as np
import pytest
from long_support import long
from scipy.optimize import least_squares, minimize

from cnc_ptp.commissioning.circles import least_squares_circle, minimum_zone

TURN = np.linspace(0.0, 2 * np.pi, 3600, endpoint=False)


def closed(radius, deviation=0.0, centre=(0.0, 0.0), angles=TURN):
    r = radius + deviation
    return np.column_stack([centre[0] + r * np.cos(angles), centre[1] + r * np.sin(angles)])


def rough(seed, size=1e-3, radius=25.0):
    """A circle with random waves of up to 40 per turn, on random angles, off centre."""
    draw = np.random.default_rng(seed)
    angles = np.sort(draw.uniform(0.0, 2 * np.pi, 700))
    deviation = sum(
        draw.normal() * size / wave * np.cos(wave * angles + draw.uniform(0.0, 6.28)) for wave in range(1, 41)
    )
    return closed(radius, deviation, draw.normal(size=2), angles)


def ring_width(points, centre):
    radii = np.hypot(points[:, 0] - centre[0], points[:, 1] - centre[1])
    return np.ptp(radii)


def test_a_circle_is_found_wherever_it_lies():
    for centre, radius in (((0.0, 0.0), 25.0), ((-180.0, 95.0), 0.3), ((1e4, 1e4), 200.0)):
        circle = least_squares_circle(closed(radius, centre=centre))
        assert circle.centre == pytest.approx(centre, rel=1e-9, abs=1e-9)
        assert circle.radius == pytest.approx(radius, rel=1e-9)
        assert minimum_zone(closed(radius, centre=centre)).width < 1e-9 * max(1.0, *map(abs, centre))


@pytest.mark.parametrize("seed", range(10))
def test_least_squares_against_scipy(seed):
    points = rough(seed, size=0.5)
    found = least_squares_circle(points)

    def residuals(x):
        return np.hypot(points[:, 0] - x[0], points[:, 1] - x[1]) - x[2]

    peer = least_squares(residuals, [0.0, 0.0, 20.0], xtol=1e-15, ftol=1e-15, gtol=1e-15).x
    assert (*found.centre, found.radius) == pytest.approx(peer, rel=1e-7)


def test_an_ellipse_has_its_axes_as_ring():
    """Points of an ellipse about its centre lie between b and a, touching either twice, alternating: the minimum."""
    points = np.column_stack([25.010 * np.cos(TURN) + 3.0, 24.990 * np.sin(TURN) - 7.0])
    zone = minimum_zone(points)
    assert zone.width == pytest.approx(0.020, abs=1e-9)
    assert (zone.inner, zone.outer) == (pytest.approx(24.990), pytest.approx(25.010))
    assert zone.centre == pytest.approx((3.0, -7.0), abs=1e-6)


@pytest.mark.parametrize("lobes", [2, 3, 4, 5, 9])
def test_a_lobed_circle_has_twice_the_amplitude(lobes):
    assert minimum_zone(closed(25.0, 0.004 * np.cos(lobes * TURN))).width == pytest.approx(0.008, rel=1e-6)


def test_a_single_peak_counts_with_all_of_its_height():
    """A ring that moves towards the peak leaves the points beside it as far inside."""
    deviation = np.where(np.arange(3600) == 0, 0.010, 0.0)
    assert minimum_zone(closed(25.0, deviation)).width == pytest.approx(0.010, rel=1e-5)


@pytest.mark.parametrize("seed", [*range(4), *long(range(4, 12))])
def test_no_centre_has_a_narrower_ring(seed):
    points = rough(seed)
    zone = minimum_zone(points)
    assert zone.width == pytest.approx(ring_width(points, zone.centre), abs=1e-12)
    start = least_squares_circle(points).centre
    peer = minimize(
        lambda c: 1e3 * ring_width(points, c), start, method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-9}
    )
    assert zone.width <= 1e-3 * peer.fun + 1e-9
    draw = np.random.default_rng(100 + seed)
    for _ in range(200):
        assert ring_width(points, zone.centre + draw.normal(size=2) * 10 ** draw.uniform(-7, -2)) >= zone.width - 1e-12


@pytest.mark.parametrize("seed", [*range(2), *long(range(2, 6))])
def test_the_ring_is_the_best_of_all_that_four_points_define(seed):
    """For few points: two lie on the outer and two on the inner circle (or 3 and 1); all such rings are tried."""
    points = rough(seed, size=0.2)[::70]
    zone = minimum_zone(points)
    best = min(
        ring_width(points, centre)
        for pair in itertools.combinations(itertools.combinations(range(len(points)), 2), 2)
        if (centre := crossing(points, *pair)) is not None
    )
    assert zone.width == pytest.approx(best, rel=1e-6)


def crossing(points, first, second):
    """Where the perpendicular bisectors of two pairs of points cross."""
    normals = np.array([points[b] - points[a] for a, b in (first, second)])
    middles = np.array([0.5 * (points[b] + points[a]) for a, b in (first, second)])
    if abs(np.linalg.det(normals)) < 1e-9:
        return None
    return np.linalg.solve(normals, np.sum(normals * middles, axis=1))
