"""Many short blocks: points a second that become a smooth curve, and how fast the curve can be run through."""

from __future__ import annotations

import runpy
from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import hypot, sqrt
from typing import Any

from bench.figures import Effort, Figure, ShowProgress, medians_of, stopwatch
from bench.jobs import ROOT
from cnc_ptp.path import AxisLimits
from cnc_ptp.path.lookahead.parts import PathPart, cell_of
from cnc_ptp.path.lookahead.smoothing import Smoother, SmoothPiece

POINTS = 150_000
PATH_DEV = 0.005
FEED = 100.0
AXES = [AxisLimits(500.0, 1000.0, 1000.0, 20_000.0)] * 3
PARTS = 8
"""Parts of a piece for each of which the largest velocity is computed."""


def smooth(points: Sequence[tuple[float, ...]]) -> list[SmoothPiece]:
    smoother = Smoother(points[0], (0, 1, 2), PATH_DEV, 0.0)
    pieces: list[SmoothPiece] = []
    for block, point in enumerate(points[1:], start=1):
        smoother.add(point, block, FEED)
        pieces += smoother.take()
    smoother.finish()
    return pieces + smoother.take()


def time_at_limits(pieces: Sequence[SmoothPiece]) -> float:
    """s with the velocity that the curvature permits everywhere, at most the feed."""
    time = 0.0
    for piece in pieces:
        part = PathPart(piece.geometry, AXES, (0, 1, 2), FEED, piece.block)
        length = part.length / PARTS
        for index in range(PARTS):
            cell = cell_of(part, 0.0, index * length, (index + 1) * length)
            time += length / min(FEED, sqrt(cell.limit))
    return time


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """The contour of examples/contour.py."""
    contour: dict[str, Any] = runpy.run_path(str(ROOT / "examples" / "contour.py"))
    points = list(contour["points"](effort.scaled(POINTS)))
    show(f"{len(points):,} points")

    def per_point() -> float:
        with stopwatch() as watch:
            smooth(points)
        return watch.cpu / len(points)

    (time,) = medians_of(effort.runs, [per_point])
    yield Figure("points of a contour, smoothed", 1.0 / time, "points/s", goal=40_000.0)
    pieces = smooth(points)
    length = sum(hypot(*[b - a for a, b in zip(p, q, strict=True)]) for p, q in pairwise(points))
    yield Figure("points for each piece of the curve", len(points) / len(pieces), "points")
    share = length / FEED / time_at_limits(pieces)
    yield Figure("mean velocity that the curvature permits", 100.0 * share, "% of F6000")
