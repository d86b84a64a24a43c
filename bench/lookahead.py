"""The look-ahead: feed that is reached, blocks a second, memory, cost of a block in short and in long programs."""

from __future__ import annotations

import runpy
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from math import sin
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "test" / "support"))

from curves import feed
from path_bound import bound_of

from bench.figures import Effort, Figure, ShowProgress, fixed_work, medians_of, stopwatch
from bench.jobs import ROOT
from cnc_ptp.motion import Limits, plan_rest_to_rest
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.nc.contour import Smoothing, Transition
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.path import AxisLimits, Line
from cnc_ptp.path.lookahead.look_ahead import LookAhead
from cnc_ptp.path.lookahead.parts import PathPart
from cnc_ptp.path.lookahead.path_builder import LinkedMotion, PathBuilder

BLOCKS, FEW, MANY = 150_000, 10_000, 10_000_000
STRETCHES = 10
FEED, CYCLE = 100.0, 0.001
AXES = [AxisLimits(500.0, 1000.0, 1000.0, 20_000.0)] * 3
XYZ = (0, 1, 2)
TEN_CYCLES = 0.01
TRANSITION = Transition(exact=False, smoothing=Smoothing(0.005))
Point = tuple[float, float, float]


def motions(points: Iterable[Point]) -> Iterator[LinkedMotion]:
    last: Point | None = None
    for block, point in enumerate(points):
        if last is not None:
            yield LinkedMotion(Line(last, point, XYZ), AXES, FEED, block, TRANSITION)
        last = point


def run(
    points: Iterable[Point],
    each: Callable[[PathPart], None] = lambda part: None,
    take: Callable[[list[MotionState]], None] = lambda rows: None,
) -> float:
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
        take(rows)
        if rows:
            ahead.locate(rows[-1][0])
    return cycles * CYCLE


def feed_reached(points: Sequence[Point]) -> tuple[float, float, float]:
    """What the path has of the velocity that the axes permit, by the independent bound of test/support.

    Mean of velocity over feed in the cycles at whose place the axes permit the feed; mean of velocity over the bound in
    all cycles (which is the time at the bound over that of the path); part of the cycles that are such ones.
    """
    parts: list[PathPart] = []
    rows: list[MotionState] = []
    run(points, parts.append, rows.extend)
    bound = bound_of(parts, feed=FEED, acceleration=AXES[0].acceleration, jerk=AXES[0].jerk)
    places, velocity = np.array([row[0] for row in rows]), np.array([row[1] for row in rows])
    permitted = bound.at(places)
    free = bound.free(places)
    moving = permitted > 0.0
    everywhere = float((velocity[moving] / permitted[moving]).mean())
    return float(velocity[free].mean()) / FEED, everywhere, float(free.mean())


def built(motions: Iterable[LinkedMotion]) -> list[PathPart]:
    """Blocks become parts of the path: lines, smooth curve, joints."""
    builder = PathBuilder(XYZ, CYCLE)
    builder.begin()
    parts: list[PathPart] = []
    for motion in motions:
        parts += builder.add(motion)
    return parts + builder.finish()


def planned(parts: Iterable[PathPart], count: int, cycle: float) -> int:
    """Cells and velocity of the parts, and the motion along the path in `count` cycles at a time; number of cycles."""
    ahead, waiting, cycles = LookAhead(1.0, 0.0), iter(parts), 0
    while not ahead.done:
        feed(ahead, waiting)
        for u, v, a, j in ahead.step(count, cycle):
            begin, part = ahead.locate(u)
            part.geometry.evaluate(u - begin, v, a, j)
            cycles += 1
    return cycles


def interpreted(text: str) -> None:
    """Text to end points."""
    for _ in interpret(parse_program(text, "contour.nc"), (0.0, 0.0, 0.0), plain_channel("XYZ")):
        pass


def costs(points: Sequence[Point], text: str, runs: int) -> tuple[list[float], float]:
    """CPU s for each block: interpreted, built, planned, run; and of the fixed piece of work, in the same minutes."""
    parts, blocks = built(motions(points)), len(points)

    def cost(work: Callable[[], object]) -> Callable[[], float]:
        def measure() -> float:
            with stopwatch() as watch:
                work()
            return watch.cpu / blocks

        return measure

    *found, reference = medians_of(
        runs,
        [
            cost(lambda: interpreted(text)),
            cost(lambda: built(motions(points))),
            cost(lambda: planned(parts, 1, TEN_CYCLES)),
            cost(lambda: planned(parts, 10, CYCLE)),
            fixed_work,
        ],
    )
    found[3] -= found[2]  # the plan is the same
    return found, reference


def rates(points: Sequence[Point], text: str, runs: int) -> Iterator[Figure]:
    """A row for each part of the work on a block."""
    (reading, building, planning, running), reference = costs(points, text, runs)

    def row(name: str, seconds: float, goal: float | None = None) -> Figure:
        peer = "fixed pieces of work/s"
        return Figure(name, 1.0 / seconds, "blocks/s", goal=goal, peer=peer, peer_value=1.0 / reference)

    yield row("blocks interpreted: text to end points", reading)
    yield row("blocks planned: elements, smooth curve, cells, velocity", building + planning, 20_000.0)
    yield Figure("of that, elements and smooth curve", 1e6 * building, "µs/block")
    yield Figure("of that, cells and velocity", 1e6 * planning, "µs/block")
    yield Figure("cycles run, for each block", 1e6 * running, "µs/block")
    yield row("blocks interpreted, planned and run", reading + building + planning + running)


def example() -> dict[str, Any]:
    """examples/contour.py."""
    return runpy.run_path(str(ROOT / "examples" / "contour.py"))


def spread(points: Sequence[Point], count: int) -> list[Point]:
    """So many of the points, in ten stretches from all over the contour: a smaller job of the same kind."""
    begins = range(0, len(points), len(points) // STRETCHES)
    return [point for begin in begins for point in points[begin : begin + count // STRETCHES]]


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
    contour = example()
    whole: list[Point] = list(contour["points"](BLOCKS))
    points = spread(whole, effort.scaled(BLOCKS))
    show(f"{len(points):,} blocks, velocity")
    free, everywhere, length = feed_reached(points)
    yield Figure("velocity over the feed, where the axes permit the feed", 100.0 * free, "%", goal=90.0)
    yield Figure("velocity over what the axes permit, everywhere", 100.0 * everywhere, "%", goal=90.0)
    yield Figure("cycles in which the axes permit the feed", 100.0 * length, "%")
    show(f"{len(points):,} blocks, cost")
    yield from rates(points, "\n".join(contour["program"](points)), effort.runs)
    long, short = cost(points), cost(points[:FEW])
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
