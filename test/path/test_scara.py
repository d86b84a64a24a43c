"""A kinematics that is one more file: derivatives, bounds, soft limits and a path, checked from outside."""

from __future__ import annotations

import random
from itertools import pairwise
from math import radians

import numpy as np
import pytest
from curves import CYCLE, run
from long_support import long_sets
from path_checker import Axis, Findings, PathChecker, Run
from scara import Scara

from cnc_ptp.nc.canonical import CircularMove, LinearMove, Source
from cnc_ptp.nc.contour import THROUGH
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.machine_points import machine_points, way_of
from cnc_ptp.path.geometry import Arc, AxisLimits, Line
from cnc_ptp.path.lookahead.path_builder import LinkedMotion, PathBuilder
from cnc_ptp.path.lookahead.spans import Span, whole
from cnc_ptp.path.transformed_span import divided, positions

ARM = Scara()
SOURCE = Source("test.nc", 1, 0, "G01")
XYZ = (0, 1, 2)
JOINTS = [AxisLimits(200.0, 2000.0, 2000.0, 40_000.0)] * 2 + [AxisLimits(300.0, 3000.0, 3000.0, 60_000.0)]


def point(x: float, y: float, z: float = 0.0) -> tuple[float, float, float]:
    return x, y, z


def quarter(start: complex, centre: complex, sweep: float) -> tuple[tuple[float, float, float], float]:
    """Target and radius of an arc."""
    target = centre + (start - centre) * 1j ** (sweep / 90.0)
    return point(target.real, target.imag, 5.0), abs(start - centre)


def draw_moves(seed: int) -> list[tuple[tuple[float, float, float], LinearMove | CircularMove]]:
    draw, moves = random.Random(seed), []
    for _ in range(30):
        start = point(draw.uniform(-80, 80), draw.uniform(-80, 80))
        target = point(draw.uniform(-80, 80), draw.uniform(-80, 80), 5.0)
        moves.append((start, LinearMove(target, False, 10.0, kinematics=ARM)))
        centre, sweep = complex(draw.uniform(-40, 40), draw.uniform(-40, 40)), draw.uniform(-350, 350)
        end, radius = quarter(complex(*start[:2]), centre, sweep)
        arc = CircularMove(end, (centre.real, centre.imag), (0, 1), radius, sweep, 10.0)
        moves.append((start, arc._replace(kinematics=ARM)))
    return moves


def span_of(start: tuple[float, float, float], move: LinearMove | CircularMove) -> Span:
    if isinstance(move, LinearMove):
        return whole(Line(start, move.target, XYZ), 0)
    return whole(Arc(start, move.target, move.center, move.plane, move.radius, move.sweep, XYZ), 0)


@pytest.mark.parametrize(("seed", "moves"), [(0, 18), *long_sets((seed, 60) for seed in range(3))])
def test_the_highest_and_lowest_positions_of_all_axes_are_found(seed: int, moves: int) -> None:
    """Against 20,000 places of the inverse on each motion."""
    checked = 0
    for start, move in draw_moves(seed)[:moves]:
        way = way_of(start, move)
        assert way.point(1.0) == pytest.approx(move.target)
        if not ARM.possible(way):
            continue
        found = np.array(machine_points(start, move, SOURCE))
        p = np.array([way.point(u)[:2] for u in np.linspace(0.0, 1.0, 20_001)]) @ [1.0, 1j] + 300.0 + 200.0j
        elbow = np.arccos((np.abs(p) ** 2 - 130_000.0) / 120_000.0)
        shoulder = np.angle(p / (300.0 + 200.0 * np.exp(1j * elbow)))
        for axis, values in enumerate((shoulder, elbow)):
            assert found[:, axis].max() == pytest.approx(np.degrees(values.max()), abs=1e-5)
            assert found[:, axis].min() == pytest.approx(np.degrees(values.min()), abs=1e-5)
        checked += 1
    assert checked > moves * 2 / 3


def test_out_of_reach_is_refused_with_the_words_of_the_kinematics() -> None:
    with pytest.raises(ProgramError) as caught:
        machine_points(point(0, 0), LinearMove(point(250, 0), False, 10.0, kinematics=ARM), SOURCE)
    assert str(caught.value).startswith(
        "P-ERR-21755 test.nc line 1 column 1 'G01': the path of #SCARA goes through places"
    )


@pytest.mark.parametrize("seed", range(2))
def test_bounds_hold_within_each_part(seed: int) -> None:
    for start, move in draw_moves(seed)[:24]:
        if not ARM.possible(way_of(start, move)):
            continue
        span = span_of(start, move)
        for part in divided(span, ARM, ARM.inverse(start, ARM.origin))[0]:
            bounds = part.bounds(0.0, part.length)
            for n in range(5):
                for (_, *values), largest in zip(part.shape(part.length * n / 4), bounds, strict=True):
                    assert all(abs(v) <= b * (1.0 + 1e-9) + 1e-12 for v, b in zip(values, largest, strict=True))


def test_a_path_keeps_to_its_lines_and_the_limits_of_the_joints() -> None:
    """A square with rounded corners and a circle; what the joints do is checked by the path checker."""
    corners = [point(0, 0), point(60, 0), point(60, 60), point(0, 60), point(0, 0)]
    builder, parts = PathBuilder(XYZ, CYCLE, ARM.origin), []
    begin = point(0, 0)
    for block, end in enumerate(corners[1:]):
        parts += builder.add(LinkedMotion(Line(begin, end, XYZ), JOINTS, 100.0, block, THROUGH, kinematics=ARM))
        begin = end
    ring = Arc(begin, begin, (-20.0, 0.0), (0, 1), 20.0, 360.0, XYZ)
    parts += builder.add(LinkedMotion(ring, JOINTS, 100.0, 9, THROUGH, kinematics=ARM))
    parts += builder.finish()
    states, _ = run(parts)
    columns = [np.ascontiguousarray(states[:, :, order]) for order in range(4)]
    axes = [Axis(a.velocity, a.velocity, a.acceleration, a.deceleration, a.jerk) for a in JOINTS]
    found = Findings()
    PathChecker([], axes, steps=False).limits(Run(*columns), found)
    assert found.texts == []
    joints = columns[0]
    a, b = np.radians(joints[:, 0]), np.radians(joints[:, 0] + joints[:, 1])
    tool = 300.0 * np.exp(1j * a) + 200.0 * np.exp(1j * b) - (300.0 + 200.0j)
    sides = [complex(*c[:2]) for c in corners]
    off = np.abs(np.abs(tool + 20.0) - 20.0)
    for one, other in pairwise(sides):
        u = np.clip(((tool - one) / (other - one)).real, 0.0, 1.0)
        off = np.minimum(off, np.abs(tool - one - u * (other - one)))
    assert off.max() < 1e-6
    assert np.abs(np.diff(tool)).max() / CYCLE <= 100.0 * (1.0 + 1e-6)
    assert np.abs(np.diff(tool)).sum() == pytest.approx(240.0 + 2.0 * np.pi * 20.0, rel=1e-3)
    assert positions(ring.shape(ring.length)) == pytest.approx(begin)
    assert radians(360.0) * 20.0 == pytest.approx(ring.length)
