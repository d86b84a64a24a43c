"""Threads: the grooves on the unrolled surface, and the pitch error of each pass over the position along the thread."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cnc_ptp.plots.colours import BY_AXIS
from cnc_ptp.plots.sheet import GAP, HEADER, Name, Sheet, draw_header, style_plot
from cnc_ptp.plots.thread_sections import unrolled
from cnc_ptp.recording.rows import axis_label
from cnc_ptp.recording.thread_passes import TURN, ThreadPass, thread_passes
from figures.recorded import recorded
from figures.run import FigureRun
from figures.scenario_head import FigureError, FigureScenario

SURFACE, ERROR = 220.0, 110.0
MICROMETRES = 1000.0
POINTS = 600
"""Of a curve of errors."""
SMALLEST = 0.5
"""µm; the scale of errors shows at least so much, below it there is nothing but the steps of the encoders."""


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure with a program that cuts threads. Raises FigureError."""
    passes = thread_passes(recorded(figure, run), run.machine)
    if not passes:
        raise FigureError(figure.path, "its program cuts no thread")
    sheet = Sheet(figure, SURFACE + ERROR + 2.0 * HEADER + GAP)
    surface = sheet.plot(sheet.upper + HEADER, SURFACE)
    error = sheet.plot(sheet.upper + 2.0 * HEADER + GAP + SURFACE, ERROR)
    draw_surface(surface, passes)
    draw_error(error, passes)
    error.tick_params(labelbottom=True)
    axes = dict.fromkeys(axis_label(each.axis) for each in passes)
    sheet.write_below(f"actual position of {', '.join(axes)} in mm")
    return sheet.drawing


def draw_surface(plot: Axes, passes: Sequence[ThreadPass]) -> None:
    style_plot(plot)
    names = []
    for number, each in enumerate(passes):
        colour = BY_AXIS[number % len(BY_AXIS)].set
        plot.plot(*unrolled(each.position, each.angle), color=colour, linewidth=1.2)
        names.append(Name(f"pass {number + 1}", colour))
    plot.set(ylim=(0.0, TURN), yticks=np.arange(0.0, TURN + 1.0, 90.0))
    draw_header(plot, "actual angle of the spindle in deg", names)


def draw_error(plot: Axes, passes: Sequence[ThreadPass]) -> None:
    """Actual values alone, thinned out evenly."""
    style_plot(plot)
    largest = SMALLEST
    for number, each in enumerate(passes):
        chosen = np.unique(np.linspace(0, len(each.position) - 1, POINTS).astype(int))
        errors = each.errors["actual_pitch_error"][chosen] * MICROMETRES
        largest = max(largest, each.largest("actual_pitch_error") * MICROMETRES)
        plot.plot(each.position[chosen], errors, color=BY_AXIS[number % len(BY_AXIS)].set, linewidth=1.0)
    plot.set_ylim(-1.1 * largest, 1.1 * largest)
    draw_header(plot, "pitch error in µm: way in the last turn - lead", [])
