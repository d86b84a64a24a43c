"""The same corner with several tolerances: set values against the programmed path, and the path velocity there.

The head names the curves, each with the block numbers before and behind the corner: `turns: 0.1 mm = N10 N11; …`.
The corner is where the largest positions of both axes meet.
"""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from cnc_ptp.plots.colours import BLUE, FAINT, GREEN, RED, YELLOW
from cnc_ptp.plots.sheet import HEADER, LEFT, PLOT, Name, Sheet, draw_header, style_plot
from figures.circle import named_turns
from figures.over_path import MM_PER_MIN, path_columns
from figures.run import FigureRun
from figures.scenario_head import FigureError, FigureScenario

SIZE, SPACE = 300.0, 60.0
COLOURS = (BLUE.set, RED.set, GREEN.set, YELLOW.set)
WINDOW = 0.4
"""mm of the path before and behind the corner that are drawn."""
SHOWN = 4.0
"""mm before and behind the corner whose velocity is drawn."""


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure with two axes and a program. Raises FigureError."""
    path = path_columns(figure, run)
    sheet = Sheet(figure, HEADER + SIZE)
    plan = sheet.plot(sheet.upper + HEADER, SIZE, width=SIZE)
    velocity = sheet.plot(sheet.upper + HEADER, SIZE, left=LEFT + SIZE + SPACE, width=PLOT - SIZE - SPACE)
    for plot in (plan, velocity):
        style_plot(plot)
        plot.tick_params(labelbottom=True)
    places = [run.column(axis, "set_position")[path.moving] for axis in figure.axes[:2]]
    names = []
    for (name, blocks), colour in zip(named_turns(figure), COLOURS, strict=False):
        chosen = np.flatnonzero(np.isin(path.blocks, blocks))
        if len(chosen) == 0:
            raise FigureError(figure.path, f"turns '{name}': the program does not move there")
        x, y = (values[chosen] for values in places)
        nearest = int(np.argmin(np.hypot(x - x.max(), y - y.min())))
        plan.plot(x - x.max(), y - y.min(), color=colour, linewidth=1.6)
        along = path.length[chosen] - path.length[chosen][nearest]
        velocity.plot(along, path.velocity[chosen] * MM_PER_MIN, color=colour, linewidth=1.6)
        names.append(Name(name, colour))
    plan.plot([-WINDOW, 0.0, 0.0], [0.0, 0.0, WINDOW], color=FAINT, linewidth=1.0)
    plan.set(xlim=(-WINDOW, 0.1 * WINDOW), ylim=(-0.1 * WINDOW, WINDOW))
    velocity.set(xlim=(-SHOWN, SHOWN), ylim=(0.0, None))
    draw_header(plan, "y over x in mm, from the corner", names)
    draw_header(velocity, "path velocity in mm/min over mm from the corner", [])
    return sheet.drawing
