"""Random closed contours, and what Shapely and exact distances say of the path of a tool along them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from random import Random
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from shapely import Polygon

from cnc_ptp.nc.canonical import CanonicalBlock, CircularMove, LinearMove

Point = tuple[float, float]
SAGITTA = 3e-7
"""mm: how far the chords of an arc are from it, where a polygon stands for it."""
Floats = NDArray[np.float64]


class Edge(NamedTuple):
    """A line, or with `centre` an arc by `sweep` (radians)."""

    start: Point
    end: Point
    centre: Point | None = None
    sweep: float = 0.0

    @property
    def radius(self) -> float:
        return 0.0 if self.centre is None else math.dist(self.centre, self.start)

    def points(self, count: int) -> Floats:
        """So many points, evenly from start to end."""
        places = np.linspace(0.0, 1.0, count)[:, None]
        if self.centre is None:
            return np.array(self.start) * (1.0 - places) + np.array(self.end) * places
        begin = math.atan2(self.start[1] - self.centre[1], self.start[0] - self.centre[0])
        angles = begin + self.sweep * places[:, 0]
        return np.array(self.centre) + self.radius * np.column_stack([np.cos(angles), np.sin(angles)])

    def chords(self) -> Floats:
        """Points so near to each other that the chords are within SAGITTA."""
        if self.centre is None:
            return self.points(2)
        return self.points(2 + int(abs(self.sweep) / math.sqrt(8.0 * SAGITTA / self.radius)))

    def distances(self, points: Floats) -> Floats:
        """Of each point to the nearest one of the edge."""
        start, end = np.array(self.start), np.array(self.end)
        if self.centre is None:
            way = end - start
            places = np.clip((points - start) @ way / (way @ way), 0.0, 1.0)
            return np.hypot(*(points - start - places[:, None] * way).T)
        centre = np.array(self.centre)
        begin = math.atan2(*(start - centre)[::-1])
        angles = np.arctan2(*(points - centre).T[::-1])
        passed = np.mod((angles - begin) * math.copysign(1.0, self.sweep), math.tau)
        to_circle = np.abs(np.hypot(*(points - centre).T) - self.radius)
        to_ends = np.minimum(np.hypot(*(points - start).T), np.hypot(*(points - end).T))
        return np.where(passed <= abs(self.sweep), to_circle, to_ends)


def distances(edges: Sequence[Edge], points: Floats) -> Floats:
    """Of each point to the nearest edge."""
    return np.min([edge.distances(points) for edge in edges], axis=0)


def edges_of(blocks: Sequence[CanonicalBlock], start: Point = (0.0, 0.0)) -> list[Edge]:
    """The motions of blocks in the plane of the first two axes."""
    edges, here = [], start
    for block in blocks:
        motion = block.motion
        if not isinstance(motion, (LinearMove, CircularMove)):
            continue
        target = motion.target[0], motion.target[1]
        if isinstance(motion, CircularMove):
            edges.append(Edge(here, target, motion.center, math.radians(motion.sweep)))
        elif target != here:
            edges.append(Edge(here, target))
        here = target
    return edges


def polygon(edges: Sequence[Edge]) -> Polygon:
    """The area that edges enclose."""
    return Polygon(np.vstack([edge.chords()[:-1] for edge in edges]))


def random_contour(random: Random, *, lines_only: bool = False) -> list[Edge] | None:
    """A closed contour around 0 to the left, which begins within a line; None if it crosses itself."""
    corners = random.randint(4, 10)
    angles = sorted(random.uniform(0.0, math.tau) for _ in range(corners))
    if max(b - a for a, b in zip(angles, [*angles[1:], angles[0] + math.tau], strict=True)) > 2.4:
        return None
    points = [(r * math.cos(a), r * math.sin(a)) for a in angles for r in [random.uniform(8.0, 25.0)]]
    first = ((points[-1][0] + points[0][0]) / 2.0, (points[-1][1] + points[0][1]) / 2.0)
    points = [(round(x, 6), round(y, 6)) for x, y in [first, *points, first]]
    ends = pairwise(points[1:-1])
    edges = [Edge(a, b) if lines_only else _edge(random, a, b) for a, b in ends]
    edges = [Edge(points[0], points[1]), *edges, Edge(points[-2], points[-1])]
    return edges if polygon(edges).is_valid else None


def _edge(random: Random, start: Point, end: Point) -> Edge:
    if random.random() < 0.5:
        return Edge(start, end)
    chord, sweep = math.dist(start, end), random.uniform(0.4, 2.6) * random.choice((1.0, -1.0))
    height = chord / 2.0 / math.tan(sweep / 2.0)
    u, v = (end[0] - start[0]) / chord, (end[1] - start[1]) / chord
    middle = (start[0] + end[0]) / 2.0, (start[1] + end[1]) / 2.0
    return Edge(start, end, (middle[0] - height * v, middle[1] + height * u), sweep)


def words(edge: Edge) -> str:
    """An edge as a block."""
    x, y = edge.end
    if edge.centre is None:
        return f"G01 X{x:.6f} Y{y:.6f}"
    i, j = edge.centre[0] - edge.start[0], edge.centre[1] - edge.start[1]
    return f"{'G03' if edge.sweep > 0.0 else 'G02'} X{x:.6f} Y{y:.6f} I{i:.9f} J{j:.9f}"
