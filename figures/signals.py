"""Switched values of a PLC in a file over time, one row each, as a logic analyser has them."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from cnc_ptp.plots.colours import BLUE, GRID, PURPLE
from cnc_ptp.plots.sheet import draw_header, note, style_plot
from figures.run import Column, FigureRun

ROW, UP, NAME = 20.0, 0.4, 0.68
"""Points of a row; part of it that a signal takes; height of its name above it."""
TITLE = "PLC"


def height(run: FigureRun) -> float:
    """Points that the rows take; 0 without signals."""
    return ROW * len(run.signals)


def draw_signals(plot: Axes, run: FigureRun, end: int) -> None:
    """Rows from above in the order of the head; inputs have another colour than outputs."""
    style_plot(plot)
    plot.grid(axis="y", visible=False)
    count = len(run.signals)
    for row, (name, values) in enumerate(run.signals.items()):
        draw_row(plot, run.time[:end], values[:end], count - 1 - row, is_input=is_input(name))
        note(plot, name, (0.0, count - 1 - row + NAME), (4.0, 0.0), of=("axes fraction", "data"), va="center")
    plot.set_ylim(-0.2, count)
    plot.set_xlim(run.time[0], run.time[end - 1])
    plot.set_yticks([])
    draw_header(plot, TITLE, [])


def draw_row(plot: Axes, time: Column, values: Column, level: int, *, is_input: bool) -> None:
    """A bar from each rising edge to the falling edge."""
    colour = PURPLE.set if is_input else BLUE.set
    plot.axhline(level, color=GRID, linewidth=0.8, zorder=0.5)
    edges = np.flatnonzero(np.diff(values > 0.0, prepend=False, append=False)).reshape(-1, 2)
    times = [*time, time[-1]]
    bars = [(times[first], times[behind] - times[first]) for first, behind in edges]
    plot.broken_barh(bars, (level, UP), facecolor=colour, alpha=0.75, linewidth=0.0)


def is_input(name: str) -> bool:
    return name.rpartition(".")[2] in ("execute", "enable")
