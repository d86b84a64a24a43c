"""Arcs in space against the plane arc whose states are multiplied by the matrix that turns it."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from cnc_ptp.nc.contour import DEV, Contour
from cnc_ptp.path import Arc, AxisLimits, Line
from cnc_ptp.path.lookahead.corners import corner
from cnc_ptp.path.lookahead.spans import whole

XYZ = (0, 1, 2)


def turned(arc: Arc, turn: np.ndarray, center: tuple[float, float]) -> Arc:
    """The arc with all its points turned about the origin."""
    first, second = (tuple(turn[:, axis]) for axis in arc.plane)
    start, target = turn @ arc.start, turn @ arc.target
    return Arc(start, target, center, arc.plane, arc.radius, arc.sweep_deg, XYZ, (first, second))


def test_states_and_shapes_are_those_of_the_plane_arc_turned(draw_arc, draw_rotation):
    draw = random.Random(71)
    for _ in range(500):
        plane = draw_arc(draw, 10 ** draw.uniform(-1, 3), tilted=False)
        turn = draw_rotation(draw)
        space = turned(plane, turn, plane.center)
        size = plane.length + 1000.0
        assert space.length == pytest.approx(plane.length, rel=1e-12)
        for part in (0.0, draw.random(), 1.0):
            s = part * plane.length
            expected = turn @ np.array(plane.evaluate(s, 30.0, 20.0, 10.0))
            scale = np.abs(expected).max(axis=0) + size
            assert (np.abs(np.array(space.evaluate(s, 30.0, 20.0, 10.0)) - expected) <= 1e-9 * scale).all()
            shape = turn @ np.array(plane.shape(s))
            assert (np.abs(np.array(space.shape(s)) - shape) <= 1e-9 * (np.abs(shape).max(axis=0) + 1.0)).all()


def test_equal_axes_give_a_circle_the_limits_of_its_plane_or_better():
    """In space no axis has more of a circle than in its plane, so that nothing is lost; a helix adds both parts."""
    axes = [AxisLimits(200.0, 2000.0, 1500.0, 30000.0)] * 3
    tilt = math.radians(30.0)
    turn = np.array([[1, 0, 0], [0, math.cos(tilt), -math.sin(tilt)], [0, math.sin(tilt), math.cos(tilt)]])
    plane = Arc((10.0, 0.0, 0.0), (10.0, 0.0, 0.0), (0.0, 0.0), (0, 1), 10.0, 360.0, XYZ)
    space = turned(plane, turn, (0.0, 0.0))
    assert space.limits(math.inf, axes) == pytest.approx(plane.limits(math.inf, axes), rel=1e-12)
    weak_z = [*axes[:2], AxisLimits(1.0, 1.0, 1.0, 1.0)]
    assert plane.limits(math.inf, weak_z) == plane.limits(math.inf, axes)
    assert space.limits(math.inf, weak_z).velocity == pytest.approx(1.0 / 0.5, rel=1e-12)
    helix = turned(Arc((10.0, 0.0, 0.0), (10.0, 0.0, 20.0), (0.0, 0.0), (0, 1), 10.0, 360.0, XYZ), turn, (0.0, 0.0))
    fast = [AxisLimits(1e3, 1e9, 1e9, 1e12), AxisLimits(10.0, 1e9, 1e9, 1e12), AxisLimits(1e3, 1e9, 1e9, 1e12)]
    circle, rise = 20.0 * math.pi / helix.length, 20.0 / helix.length
    most = math.cos(tilt) * circle + math.sin(tilt) * rise
    assert helix.limits(math.inf, fast).velocity == pytest.approx(10.0 / most, rel=1e-12)


def test_a_corner_with_an_arc_in_space_is_that_of_the_plane_turned(draw_rotation):
    """In space the tolerance counts as in the plane: the curve is at most as long, and within the tolerance."""
    draw = random.Random(73)
    contour = Contour(mode=DEV, path_dev=0.05)
    for _ in range(100):
        turn = draw_rotation(draw)
        begin = np.array([0.0, -10.0 - draw.random(), 0.0])
        line = Line(tuple(turn @ begin), tuple(turn @ [0.0, 0.0, 0.0]), XYZ)
        arc = Arc((0.0, 0.0, 0.0), (20.0, 0.0, 0.0), (10.0, 0.0), (0, 1), 10.0, draw.choice([180.0, -180.0]), XYZ)
        space = turned(arc, turn, (10.0, 0.0))
        found = corner(whole(line, 0), whole(space, 1), contour, XYZ)
        flat = corner(whole(Line(tuple(begin), (0.0, 0.0, 0.0), XYZ), 0), whole(arc, 1), contour, XYZ)
        if flat is None:
            assert found is None
            continue
        assert found is not None
        a, pieces, b = found
        assert (a.length, b.length) == pytest.approx((flat[0].length, flat[2].length), rel=0.3)
        for piece in pieces:
            for u in np.linspace(0.0, piece.length, 20):
                q = turn.T @ np.array(piece.shape(u))[:, 0]
                on_line = math.hypot(q[0], q[2]) if q[1] <= 0.0 else math.inf
                on_arc = math.hypot(math.hypot(q[0] - 10.0, q[1]) - 10.0, q[2])
                assert min(on_line, on_arc) <= 0.05 + 1e-9
