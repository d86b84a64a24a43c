"""Circle test as a polar plot: how far the actual path is off its circle, magnified, one curve for each pair of turns.

The head names the curves, each with the block numbers of two turns that start opposite each other:

    # turns: without compensation = N50 N80; with compensation = N120 N150

Of each turn the half opposite its start counts (cnc_ptp.commissioning.circle_program).
Source: TF5200 friction, figure 8.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from cnc_ptp.commissioning.circle_program import PLANES, CircleProgram, Turn, measured_turn
from cnc_ptp.commissioning.circles import least_squares_circle
from cnc_ptp.commissioning.roundness import CircleResult, evaluate_circle
from cnc_ptp.errors import CncError
from cnc_ptp.plots.colours import BLUE, GREEN, GRID, INK, RED, SOFT, YELLOW
from cnc_ptp.plots.sheet import LEFT, SMALL, Sheet, number
from cnc_ptp.protocol.blocks import ChannelBlock
from figures.run import Column, FigureRun
from figures.scenario_head import FigureError, FigureScenario

DIAMETER, ROOM = 440.0, 460.0
COLOURS = (BLUE.set, RED.set, GREEN.set, YELLOW.set)
MICROMETRES = 1000.0
INNER = 1.8
"""Distance of the middle of the plot from the circle, in largest deviations."""
POINTS = 1800
"""Of a curve."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A pair of turns: its name and the evaluation of the circle."""

    name: str
    result: CircleResult


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure with two axes and a program. Raises FigureError."""
    curves = list(evaluated(figure, run))
    sheet = Sheet(figure, ROOM)
    plot: Any = sheet.plot(sheet.upper + 24.0, DIAMETER, left=LEFT, width=DIAMETER, polar=True)
    largest = MICROMETRES * max(float(np.abs(curve.result.deviations).max()) for curve in curves)
    style_polar(plot, figure.axes, largest)
    for curve, colour in zip(curves, COLOURS, strict=False):
        draw_curve(plot, curve.result, colour)
    left = LEFT + DIAMETER + 40.0
    sheet.write(left, sheet.upper + 60.0, "deviation from the circle in µm", color=INK, fontweight="bold")
    for row, (curve, colour) in enumerate(zip(curves, COLOURS, strict=False)):
        write_result(sheet, curve, colour, left, sheet.upper + 92.0 + 74.0 * row)
    return sheet.drawing


def evaluated(figure: FigureScenario, run: FigureRun) -> Iterator[Curve]:
    """The curves of the head, from the actual positions of both axes."""
    if len(figure.axes) != 2 or not run.machine.channels:
        raise FigureError(figure.path, "a circle needs two axes of a machine with a channel")
    channel = next(iter(run.machine.channels))
    blocks = [tick[channel].block for tick in run.ticks]
    numbers = np.array([n for block in blocks if isinstance(block, ChannelBlock) for n in block.block_number])
    set_points, points = (
        np.column_stack([run.column(axis, f"{kind}_position") for axis in figure.axes]) for kind in ("set", "actual")
    )
    for name, chosen in named_turns(figure):
        try:
            yield Curve(name, pair_of_turns(numbers, chosen, set_points, points))
        except (CncError, ValueError) as error:
            raise FigureError(figure.path, f"turns '{name}': {error}") from None


def named_turns(figure: FigureScenario) -> Iterator[tuple[str, list[int]]]:
    """Names and block numbers of the curves."""
    for part in filter(None, figure.turns.split(";")):
        name, equals, blocks = part.partition("=")
        words = blocks.split()
        if not equals or not words or not all(word[:1] == "N" and word[1:].isdecimal() for word in words):
            raise FigureError(figure.path, f"'{part.strip()}' in 'turns:' is not 'name = N10 N20'")
        yield name.strip(), [int(word[1:]) for word in words]
    if not figure.turns:
        raise FigureError(figure.path, "a circle needs 'turns: name = N10 N20; ...' in its head")


def pair_of_turns(numbers: Column, chosen: list[int], set_points: Column, points: Column) -> CircleResult:
    """The evaluation of turns, whose circle is that of the set positions. Raises CncError, ValueError."""
    commanded = {block: set_points[numbers == block] for block in chosen}
    missing = [f"N{block}" for block, path in commanded.items() if len(path) < 3]
    if missing:
        raise ValueError(f"the program does not move in {', '.join(missing)}")
    circle = least_squares_circle(np.vstack(list(commanded.values())))
    angles = {block: turned(path - np.array(circle.centre)) for block, path in commanded.items()}
    turns = tuple(Turn(block, bool(path[-1] < path[0]), float(path[0])) for block, path in angles.items())
    program = CircleProgram("", turns, PLANES["XY"], circle.centre, circle.radius)
    clockwise = turns[0].clockwise
    measured = measured_turn(program, clockwise, numbers.astype(np.int64), points)
    return evaluate_circle(points[measured], radius=circle.radius, clockwise=clockwise)


def turned(offsets: Column) -> Column:
    """Angles of points about the middle, without jumps, in degrees."""
    angles: Column = np.degrees(np.unwrap(np.arctan2(offsets[:, 1], offsets[:, 0])))
    return angles


def style_polar(plot: Any, axes: tuple[str, ...], largest: float) -> None:
    """Scale in µm, the circle itself at 0; the directions are those of the axes."""
    plot.set_rlim(-INNER * largest, 1.1 * largest)
    step = next(step for step in steps() if largest / step <= 2.5)
    rings = [step * count for count in range(-4, 3) if -0.8 * INNER * largest < step * count <= 1.1 * largest]
    plot.set_rgrids(rings)
    plot.set_rlabel_position(67.5)
    plot.plot(np.linspace(0.0, 2.0 * np.pi, 181), np.zeros(181), color=SOFT, linewidth=0.9, dashes=(5, 3), zorder=2.0)
    names = (f"+{axes[0]}", "", f"+{axes[1]}", "", f"−{axes[0]}", "", f"−{axes[1]}", "")
    plot.set_thetagrids(range(0, 360, 45), names)
    plot.patch.set_visible(False)
    plot.grid(color=GRID, linewidth=0.8)
    plot.spines[:].set_visible(False)
    plot.tick_params(labelsize=SMALL, labelcolor=SOFT)


def steps() -> Iterator[float]:
    """Round numbers: 0.01, 0.02, 0.05, 0.1 …"""
    for exponent in range(-2, 6):
        for factor in (1.0, 2.0, 5.0):
            yield factor * 10.0**exponent


def draw_curve(plot: Any, result: CircleResult, colour: str) -> None:
    order = np.argsort(result.angles, kind="stable")
    order = order[np.unique(np.linspace(0, len(order) - 1, POINTS).astype(int))]
    closed = np.append(order, order[0])
    angles = np.radians(result.angles[closed])
    angles[-1] += 2.0 * np.pi
    plot.plot(angles, MICROMETRES * result.deviations[closed], color=colour, linewidth=1.5)


def write_result(sheet: Sheet, curve: Curve, colour: str, left: float, top: float) -> None:
    """Name, circular deviation and largest quadrant peak of a curve."""
    sheet.write(left, top, curve.name, color=colour, fontweight="bold")
    for row, (words, value) in enumerate(
        (("circular deviation G", curve.result.circular_deviation), ("largest peak", curve.result.largest_peak)), 1
    ):
        sheet.write(left, top + 18.0 * row, words)
        sheet.write(left + 170.0, top + 18.0 * row, number(MICROMETRES * value), color=INK, ha="right")
