"""Speed of a spindle and feed of the path over time, to show whether the path waits for the speed.

Source: TF5200 spindle, figures 11 and 12.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cnc_ptp.plots.colours import BAND, BLUE, FAINT, GREEN
from cnc_ptp.plots.sheet import GAP, HEADER, Name, Sheet, draw_header, note, style_plot
from cnc_ptp.protocol.blocks import ChannelBlock
from cnc_ptp.protocol.channel_states import ChannelStateCode
from figures.run import Column, FigureRun
from figures.scenario_head import FigureError, FigureScenario
from figures.spindle_states import stretches

HEIGHT = 120.0
SECONDS = 60.0
"""Per minute: feed is shown in mm/min."""


@dataclass(frozen=True, slots=True)
class PathRun:
    """Path velocity (mm/s), and the cycles in which the path waits."""

    velocity: Column
    waits: Column


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure with one spindle and the program of the first channel. Raises FigureError."""
    if not figure.program_path:
        raise FigureError(figure.path, "there is no path without 'program: ...'")
    spindle, path = figure.axes[0], path_of(run)
    sheet = Sheet(figure, 2.0 * (HEADER + HEIGHT + GAP))
    upper = sheet.plot(sheet.upper + HEADER, HEIGHT)
    lower = sheet.plot(sheet.upper + 2.0 * HEADER + HEIGHT + GAP, HEIGHT)
    for field, colour, width in (("actual_speed_rpm", GREEN.actual, 3.2), ("set_speed_rpm", GREEN.set, 1.4)):
        upper.plot(run.time, run.column(spindle, field), color=colour, linewidth=width)
    lower.plot(run.time, path.velocity * SECONDS, color=BLUE.set, linewidth=1.4)
    for plot in (upper, lower):
        style_plot(plot)
        plot.set_xlim(run.time[0], run.time[-1])
        mark_waits(plot, run, path, with_texts=plot is lower)
    mark_speeds(upper, run, spindle)
    draw_header(upper, "spindle speed in rpm", [Name("set", GREEN.set), Name("actual", GREEN.actual)])
    draw_header(lower, "path feed in mm/min", [])
    lower.tick_params(labelbottom=True)
    sheet.write_below("time in s")
    return sheet.drawing


def path_of(run: FigureRun) -> PathRun:
    """The path of the first channel, cycle by cycle."""
    name = next(iter(run.machine.channels))
    blocks = [block for tick in run.ticks if isinstance(block := tick[name].block, ChannelBlock)]
    velocity = np.array([value for block in blocks for value in block.path_velocity])
    state = np.array([value for block in blocks for value in block.state])
    return PathRun(velocity, state == ChannelStateCode.WAITING)


def mark_waits(plot: Axes, run: FigureRun, path: PathRun, *, with_texts: bool) -> None:
    """Tints where the path waits."""
    for begin, last in stretches(path.waits):
        plot.axvspan(run.time[begin], run.time[last], color=BAND, zorder=0.2, linewidth=0.0)
        if with_texts:
            note(plot, "waits", (run.time[begin], 1.0), (3.0, -10.0), of=("data", "axes fraction"))


def mark_speeds(plot: Axes, run: FigureRun, spindle: str) -> None:
    """A line where the spindle reports that its speed is reached."""
    reached = run.column(spindle, "speed_reached")
    moving = run.column(spindle, "programmed_speed_rpm") != 0.0
    for cycle in np.flatnonzero((np.diff(reached) > 0.0) & moving[1:]) + 1:
        plot.axvline(run.time[cycle], color=FAINT, linewidth=0.9, dashes=(3, 2), zorder=0.6)
        note(plot, "speed reached", (run.time[cycle], 0.0), (4.0, 4.0), of=("data", "axes fraction"))
