"""Along a path, over its length: path velocity and feed, acceleration and jerk of each axis with its limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cnc_ptp.parameters import AxisParameters
from cnc_ptp.plots.colours import BY_AXIS, FAINT, PURPLE
from cnc_ptp.plots.sheet import GAP, HEADER, Name, Sheet, draw_header, style_plot
from cnc_ptp.protocol.blocks import ChannelBlock
from figures.run import Column, FigureRun
from figures.scenario_head import FigureError, FigureScenario

HEIGHT = 110.0
MM_PER_MIN = 60.0


@dataclass(frozen=True, slots=True)
class PathColumns:
    """Of the cycles in which the path moves: its length, mm, velocity and programmed feed, mm/s, block numbers."""

    moving: Column
    length: Column
    velocity: Column
    feed: Column
    blocks: Column


def path_columns(figure: FigureScenario, run: FigureRun) -> PathColumns:
    """Those of the first channel. Raises FigureError without a program and fewer than two axes."""
    if not figure.program_path or len(figure.axes) < 2:
        raise FigureError(figure.path, "a path needs 'program: ...' and two axes")
    name = next(iter(run.machine.channels))
    blocks = [block for tick in run.ticks if isinstance(block := tick[name].block, ChannelBlock)]

    def column(field: str) -> Column:
        return np.array([value for block in blocks for value in getattr(block, field)], dtype=np.float64)

    places = np.stack([run.column(axis, "set_position") for axis in figure.axes])
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(places[:2], axis=1)))])
    velocity = column("path_velocity")
    moving = np.flatnonzero(velocity)
    if len(moving) == 0:
        raise FigureError(figure.path, "its program does not move along a path")
    shown = np.arange(moving[0], moving[-1] + 1)
    columns = (length, velocity, column("programmed_feed"), column("block_number"))
    return PathColumns(shown, *(values[shown] for values in columns))


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure with axes and the program of the first channel. Raises FigureError."""
    path = path_columns(figure, run)
    sheet = Sheet(figure, 3.0 * (HEADER + HEIGHT + GAP))
    plots = [sheet.plot(sheet.upper + HEADER + row * (HEADER + HEIGHT + GAP), HEIGHT) for row in range(3)]
    for plot in plots:
        style_plot(plot)
        plot.set_xlim(path.length[0], path.length[-1])
    draw_velocity(plots[0], path)
    axes = [run.machine.axes[name] for name in figure.axes]
    accelerations = [max(axis.acceleration, axis.deceleration) for axis in axes]
    draw_axes(plots[1], figure, run, path, "acceleration in mm/s²", accelerations)
    draw_axes(plots[2], figure, run, path, "jerk in mm/s³", jerks(axes))
    plots[2].tick_params(labelbottom=True)
    sheet.write_below("length of the path in mm")
    return sheet.drawing


def jerks(axes: Sequence[AxisParameters]) -> list[float]:
    return [axis.jerk for axis in axes]


def draw_velocity(plot: Axes, path: PathColumns) -> None:
    plot.plot(path.length, path.feed * MM_PER_MIN, color=FAINT, linewidth=1.2)
    plot.plot(path.length, path.velocity * MM_PER_MIN, color=PURPLE.set, linewidth=1.4)
    draw_header(plot, "path velocity in mm/min", [Name("feed", FAINT), Name("path velocity", PURPLE.set)])


def draw_axes(
    plot: Axes, figure: FigureScenario, run: FigureRun, path: PathColumns, title: str, limits: Sequence[float]
) -> None:
    """A set value of each axis with its limits; the title begins with the name of the field."""
    names = []
    for name, colours, limit in zip(figure.axes, BY_AXIS, limits, strict=False):
        values = run.column(name, f"set_{title.split(maxsplit=1)[0]}")[path.moving]
        plot.plot(path.length, values, color=colours.set, linewidth=1.2)
        for side in (-limit, limit):
            plot.axhline(side, color=FAINT, linewidth=0.9, dashes=(3, 2))
        names.append(Name(name, colours.set))
    draw_header(plot, title, names)
