"""Smooth curves as parts of a path, what runs them, and a checker that knows nothing of the planner."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from cnc_ptp.path.cubic import Cubic
from cnc_ptp.path.geometry import AxisLimits
from cnc_ptp.path.lookahead.look_ahead import LookAhead
from cnc_ptp.path.lookahead.parts import PathPart

CYCLE = 0.001
Array = NDArray[np.float64]


def spline(points: Array) -> CubicSpline:
    """A cubic spline over the length of its chords."""
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return CubicSpline(np.concatenate(([0.0], np.cumsum(chords))), points, bc_type="natural")


def smooth_curve(seed: int, axes: int = 3, knots: int = 600) -> CubicSpline:
    """A closed motion of a few low frequencies, about 250 mm long, over its length."""
    draw = np.random.default_rng(seed)
    t = np.linspace(0.0, 1.0, 4 * knots + 1)
    waves = [
        sum(draw.normal() / k * np.sin(2.0 * np.pi * k * t + draw.uniform(0.0, 6.3)) for k in (1, 2, 3))
        for _ in range(axes)
    ]
    points = np.array(waves).T
    points *= 250.0 / np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    length = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    even = np.linspace(0.0, length[-1], knots + 1)
    return spline(CubicSpline(length, points)(even))


def parts_of(curve: CubicSpline, limits: Sequence[AxisLimits], feed: float) -> list[PathPart]:
    """Each piece of the spline is a block."""
    parts = []
    for index in range(len(curve.x) - 1):
        third, second, first, zeroth = curve.c[:, index, :]
        start = [
            (float(q), float(q1), 2.0 * float(q2), 6.0 * float(q3))
            for q, q1, q2, q3 in zip(zeroth, first, second, third, strict=True)
        ]
        piece = Cubic(start, float(curve.x[index + 1] - curve.x[index]))
        parts.append(PathPart(piece, limits, range(len(limits)), feed, index))
    return parts


def feed(ahead: LookAhead, waiting: Iterator[PathPart]) -> None:
    """Gives the look-ahead what it wants; closes it behind the last part."""
    while ahead.wants:
        part = next(waiting, None)
        if part is None:
            ahead.closed = True
            break
        ahead.append(part)


def run(
    parts: Iterable[PathPart], script: Sequence[tuple[int, float]] = (), block: int = 10, longest: int = 200_000
) -> tuple[Array, Array]:
    """States (cycles, axes, 4) and rows (u, u', u'', u''') of a path from rest; `script`: override from a cycle on."""
    ahead = LookAhead(1.0, 0.0)
    waiting = iter(parts)
    overrides = list(script)
    states, rows = [], []
    while not ahead.done:
        while overrides and overrides[0][0] <= len(states):
            ahead.set_override(overrides.pop(0)[1])
        feed(ahead, waiting)
        for u, v, a, j in ahead.step(block, CYCLE):
            rows.append((u, v, a, j))
            begin, part = ahead.locate(u)
            states.append(part.geometry.evaluate(u - begin, v, a, j))
        assert len(states) < longest
    return np.array(states), np.array(rows)


def assert_within(states: Array, limits: Sequence[AxisLimits], tolerance: float = 1e-6) -> None:
    """No axis exceeds a limit, by its states and by the differences of its positions; states fit to each other."""
    for axis, limit in enumerate(limits):
        p, v, a, j = states[:, axis].T
        for values, largest in ((v, limit.velocity), (a, limit.acceleration), (j, limit.jerk)):
            assert np.abs(values).max() <= largest * (1.0 + tolerance), axis
        assert np.abs(np.diff(a)).max() <= limit.jerk * CYCLE * (1.0 + tolerance)
        assert np.abs(np.diff(v) - CYCLE * (a[1:] + a[:-1]) / 2.0).max() <= 0.25 * limit.jerk * CYCLE**2 * 1.001 + 1e-9
        bend = CYCLE * (v[1:] + v[:-1]) / 2.0 - CYCLE**2 * (a[1:] - a[:-1]) / 12.0
        assert np.abs(np.diff(p) - bend).max() <= limit.jerk * CYCLE**3 / 20.0 + 1e-9
