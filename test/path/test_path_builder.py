"""Blocks that become parts of a path: where a corner before short blocks may be."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from cnc_ptp.nc.contour import DIST, POS, Contour, Smoothing, Transition
from cnc_ptp.path.geometry import AxisLimits, Line
from cnc_ptp.path.lookahead.parts import PathPart
from cnc_ptp.path.lookahead.path_builder import LinkedMotion, PathBuilder

XYZ = (0, 1, 2)
AXES = [AxisLimits(500.0, 1000.0, 1000.0, 20_000.0)] * 3
PATH_DEV = 0.002
CORNER_DEV = 0.15
CONTOUR = Contour(path_dev=CORNER_DEV)


def parts_of(
    points: list[tuple[float, float, float]], contour_of_short: Contour | None, contour: Contour = CONTOUR
) -> list[PathPart]:
    """The first block is contoured, the others are short blocks of #HSC."""
    first = Transition(exact=False, contour=contour)
    short = Transition(exact=False, contour=contour_of_short, smoothing=Smoothing(PATH_DEV))
    builder, parts = PathBuilder(XYZ, 0.001), []
    builder.begin()
    for block, (begin, end) in enumerate(pairwise(points)):
        parts += builder.add(LinkedMotion(Line(begin, end, XYZ), AXES, 100.0, block, short if block else first))
    return parts + builder.finish()


def places_of(parts: list[PathPart]) -> np.ndarray:
    return np.array(
        [[q for q, *_ in part.geometry.shape(u)] for part in parts for u in np.linspace(0.0, part.length, 60)]
    )


def along_x_then_y(doubled: bool) -> list[tuple[float, float, float]]:
    """10 mm along X, then chords of 0.01 mm along Y; `doubled`: the first of them has no length."""
    corner = [(0.0, 0.0, 0.0)] * (2 if doubled else 1)
    return [(-10.0, 0.0, 0.0), *corner, *((0.0, 0.01 * n, 0.0) for n in range(1, 301))]


@pytest.mark.parametrize("doubled", [False, True])
def test_a_corner_before_short_blocks_is_in_the_first_of_them_alone(doubled: bool) -> None:
    """The tolerance of the corner is not theirs (random program 2135)."""
    parts = parts_of(along_x_then_y(doubled), None)
    places = places_of(parts)
    assert all(part.entry > 0.0 for part in parts[1:]), "the corner is a curve"
    behind = places[places[:, 1] > 0.005]
    assert np.abs(behind[:, 0]).max() <= PATH_DEV
    assert np.abs(places[-1] - (0.0, 3.0, 0.0)).max() < 1e-9


def test_contoured_short_blocks_share_the_corner() -> None:
    """They have its tolerance, so the curve goes on to the half of a piece, over many of them."""
    places = places_of(parts_of(along_x_then_y(False), CONTOUR))
    assert places[np.abs(places[:, 0]) > 1e-9, 1].max() > 0.3


DIST_2_1 = Contour(mode=DIST, pre_dist=2.0, post_dist=1.0)
DIST_SHORT = Contour(mode=DIST, pre_dist=0.2, post_dist=0.1)


@pytest.mark.parametrize(
    ("contour", "of_short", "largest"),
    [
        (CONTOUR, Contour(path_dev=0.02), 0.02),  # random program 7871
        (DIST_2_1, Contour(path_dev=0.02), 0.02),
        (CONTOUR, DIST_SHORT, 0.05),
        (DIST_SHORT, CONTOUR, 0.05),
        (CONTOUR, Contour(path_dev=10.0), CORNER_DEV),
    ],
)
def test_a_corner_over_contoured_short_blocks_keeps_their_tolerance(
    contour: Contour, of_short: Contour, largest: float
) -> None:
    """Half of the smaller distance with DIST. The corner is as large as that permits: over several blocks."""
    parts = parts_of(along_x_then_y(False), of_short, contour)
    places = places_of(parts)
    assert all(part.entry > 0.0 for part in parts[1:])
    apart = np.minimum(np.abs(places[:, 0]), np.abs(places[:, 1]))
    assert apart.max() <= largest + 1e-9
    assert places[np.abs(places[:, 0]) > 1e-6, 1].max() > 0.03


@pytest.mark.parametrize("of_short", [Contour(path_dev=1e-5), Contour(mode=POS, point=(0.0, 0.0, 0.0))])
def test_half_of_the_first_short_block_is_always_free(of_short: Contour) -> None:
    """Its end is met, whatever the tolerance of the corner is."""
    parts = parts_of(along_x_then_y(False), of_short)
    places = places_of(parts)
    assert all(part.entry > 0.0 for part in parts[1:])
    assert places[np.abs(places[:, 0]) > 1e-9, 1].max() == pytest.approx(0.005, abs=1e-3)


def test_an_axis_that_short_blocks_must_follow_has_no_curve_over_them() -> None:
    """The corner may leave the path of A by TRACK_DEV, the short blocks behind it may not."""
    wide = Contour(path_dev=CORNER_DEV, track_dev=1.0)
    axes = [*AXES, AXES[0]]
    builder, parts = PathBuilder(XYZ, 0.001), []
    builder.begin()
    first = Transition(exact=False, contour=wide)
    short = Transition(exact=False, contour=wide._replace(track_dev=0.0), smoothing=Smoothing(PATH_DEV, 0.001))
    points = [(-10.0, 0.0, 0.0, 0.0), *((0.0, 0.01 * n, 0.0, 0.1 * n) for n in range(301))]
    for block, (begin, end) in enumerate(pairwise(points)):
        parts += builder.add(LinkedMotion(Line(begin, end, XYZ), axes, 100.0, block, short if block else first))
    places = places_of(parts + builder.finish())
    behind = places[places[:, 1] > 0.005]
    assert np.abs(behind[:, 3] - 10.0 * behind[:, 1]).max() <= 0.001


@pytest.mark.parametrize("wide", [range(101), range(101, 301), range(100, 101)])
def test_a_corner_of_short_blocks_keeps_the_contour_of_each(wide: range) -> None:
    """The contour changes in the corner; in the last case one block alone has the wider one (G61)."""
    points = [*((0.01 * n - 1.01, 0.0, 0.0) for n in range(102)), *((0.0, 0.01 * n, 0.0) for n in range(1, 201))]
    builder, parts = PathBuilder(XYZ, 0.001), []
    builder.begin()
    for block, (begin, end) in enumerate(pairwise(points)):
        contour = Contour(path_dev=0.03 if block in wide else 0.005)
        transition = Transition(exact=False, contour=contour, smoothing=Smoothing(PATH_DEV))
        parts += builder.add(LinkedMotion(Line(begin, end, XYZ), AXES, 100.0, block, transition))
    places = places_of(parts + builder.finish())
    assert all(part.entry > 0.0 for part in parts[1:]), "no stop"
    apart = np.minimum(np.abs(places[:, 0]), np.abs(places[:, 1]))
    near = (places[:, 0] > -0.005) & (places[:, 1] < 0.005)
    assert apart[~near].max() <= 0.005 + 1e-9
    assert np.abs(places[-1] - (0.0, 2.0, 0.0)).max() < 1e-9
