"""The look-ahead: feed that is reached, blocks a second, memory, cost of a block in short and in long programs."""

from __future__ import annotations

import runpy
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from math import sin, sqrt
from typing import Any

from bench.figures import Effort, Figure, ShowProgress, stopwatch
from bench.jobs import ROOT
from cnc_ptp.motion import Limits, plan_rest_to_rest
from cnc_ptp.nc.contour import Smoothing, Transition
from cnc_ptp.path import AxisLimits, Line
from cnc_ptp.path.lookahead.look_ahead import LookAhead
from cnc_ptp.path.lookahead.parts import PathPart, cell_of
from cnc_ptp.path.lookahead.path_builder import LinkedMotion, PathBuilder

BLOCKS, FEW, MANY = 150_000, 10_000, 10_000_000
FEED, CYCLE = 100.0, 0.001
AXES = [AxisLimits(500.0, 1000.0, 1000.0, 20_000.0)] * 3
XYZ = (0, 1, 2)
TRANSITION = Transition(exact=False, smoothing=Smoothing(0.005))
PARTS = 8
"""Parts of a piece for each of which the largest velocity is computed."""
Point = tuple[float, float, float]


def motions(points: Iterable[Point]) -> Iterator[LinkedMotion]:
    last: Point | None = None
    for block, point in enumerate(points):
        if last is not None:
            yield LinkedMotion(Line(last, point, XYZ), AXES, FEED, block, TRANSITION)
        last = point


def run(points: Iterable[Point], each: Callable[[PathPart], None] = lambda part: None) -> float:
    """Plans and runs short blocks of #HSC as the channel does; s that the path takes."""
    builder, ahead, waiting = PathBuilder(XYZ, CYCLE), LookAhead(1.0, 0.0), motions(points)
    builder.begin()
    cycles = 0
    while not ahead.done:
        while ahead.wants:
            motion = next(waiting, None)
            parts = builder.finish() if motion is None else builder.add(motion)
            for part in parts:
                each(part)
                ahead.append(part)
            if motion is None:
                ahead.closed = True
                break
        rows = ahead.step(10, CYCLE)
        cycles += len(rows)
        if rows:
            ahead.locate(rows[-1][0])
    return cycles * CYCLE


def time_at_limits(part: PathPart) -> float:
    """s with the velocity that feed and axes permit everywhere, with any acceleration along the path."""
    length, time = part.length / PARTS, 0.0
    for index in range(PARTS):
        cell = cell_of(part, 0.0, index * length, (index + 1) * length)
        time += length / sqrt(min(cell.feed, cell.limit))
    return time


def shortest_time(stretch: Sequence[PathPart]) -> float:
    """s that the axes need at least between two stops: the longer one of two bounds.

    As `time_at_limits`; or for a straight line of the same length, with what the axes permit in the best direction.
    """
    directions = [part.geometry.shape(place) for part in stretch for place in (0.0, part.length)]
    best = max(1.0 / max(abs(slope) for _, slope, _, _ in direction) for direction in directions)
    limits = Limits(FEED, AXES[0].acceleration * best, AXES[0].deceleration * best, AXES[0].jerk * best)
    straight = plan_rest_to_rest(0.0, sum([part.length for part in stretch]), limits).duration
    return max(straight, sum([time_at_limits(part) for part in stretch]))


def stretches(parts: Iterable[PathPart]) -> Iterator[list[PathPart]]:
    """What lies between two stops."""
    found: list[PathPart] = []
    for part in parts:
        if part.entry == 0.0 and found:
            yield found
            found = []
        found.append(part)
    yield found


def contour(blocks: int) -> list[Point]:
    """Points of examples/contour.py."""
    example: dict[str, Any] = runpy.run_path(str(ROOT / "examples" / "contour.py"))
    return list(example["points"](blocks))


def cost(points: Sequence[Point]) -> float:
    """CPU s for each block, planned and run."""
    with stopwatch() as watch:
        run(points)
    return watch.cpu / len(points)


def gentle() -> list[Point]:
    """3,000 chords of 0.05 mm along a wave, rounded to 1 µm."""
    return [(round(0.05 * n, 3), round(3.0 * sin(0.05 * n / 12.0), 3), 0.0) for n in range(3001)]


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """The contour of examples/contour.py, 3,000 blocks, many blocks."""
    points = contour(effort.scaled(BLOCKS))
    show(f"{len(points):,} blocks")
    parts: list[PathPart] = []
    percent = 100.0 / run(points, parts.append)
    limits, shortest = sum(map(time_at_limits, parts)), sum(map(shortest_time, stretches(parts)))
    yield Figure("shortest time that the axes permit, over the time of the path", percent * shortest, "%", goal=90.0)
    yield Figure("the same with any acceleration along the path, no ramps at stops", percent * limits, "%")
    long, short = cost(points), cost(points[:FEW])
    yield Figure("blocks planned and run", 1.0 / long, "blocks/s", goal=20_000.0)
    yield Figure(f"cost of a block among {len(points):,} over {FEW:,}", long / short, "×", goal=1.2, at_most=True)
    length = sum([motion.span.length for motion in motions(gentle())])
    straight = plan_rest_to_rest(0.0, length, Limits(FEED, 1000.0, 1000.0, 20_000.0)).duration
    seconds = run(gentle())
    yield Figure("3,000 blocks of 0.05 mm at F6000", seconds, "s", goal=1.9, at_most=True)
    yield Figure("the same over one straight block", seconds / straight, "×", goal=1.1, at_most=True)
    many = effort.scaled(MANY)
    show(f"{many:,} blocks")
    done = subprocess.run(
        [sys.executable, "-m", "bench.long_path", str(many)], cwd=ROOT, check=True, capture_output=True, text=True
    )
    yield Figure(f"largest memory, {many:,} blocks", float(done.stdout), "MiB", goal=300.0, at_most=True)
