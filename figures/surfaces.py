"""What a program mills with the C axis: on the face in its Cartesian coordinates, on the lateral surface unrolled."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cnc_ptp.plots.colours import BLUE, RED
from cnc_ptp.plots.program_run import machine_of
from cnc_ptp.plots.sheet import HEADER, LEFT, PLOT, Sheet, draw_header, style_plot
from cnc_ptp.recording.surfaces import CYLINDER, FACE, Surface, surfaces
from figures.recorded import recorded
from figures.run import FigureRun
from figures.scenario_head import FigureError, FigureScenario

SIZE, SPACE = 300.0, 60.0
MARGIN = 0.05
"""Of the size of the path."""


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure whose program uses #FACE and #CYL. Raises FigureError."""
    run_as_recorded = recorded(figure, run)
    found = {each.kind: each for each in surfaces(run_as_recorded, machine_of(run_as_recorded))}
    if len(found) < 2:
        raise FigureError(figure.path, "its program needs #FACE and #CYL")
    sheet = Sheet(figure, HEADER + SIZE)
    face = sheet.plot(sheet.upper + HEADER, SIZE, width=SIZE)
    lateral = sheet.plot(sheet.upper + HEADER, SIZE, left=LEFT + SIZE + SPACE, width=PLOT - SIZE - SPACE)
    draw_path(face, found[FACE].points, BLUE.set)
    draw_path(lateral, found[CYLINDER].points[::-1], RED.set)
    draw_header(face, f"{found[FACE].command}: y over x in mm", [])
    draw_header(lateral, lateral_title(found[CYLINDER]), [])
    return sheet.drawing


def lateral_title(lateral: Surface) -> str:
    return f"{lateral.command}: {lateral.axes[0]} over the circumference in mm"


def draw_path(plot: Axes, points: np.typing.NDArray[np.float64], colour: str) -> None:
    """Both scales are equal."""
    style_plot(plot)
    plot.tick_params(labelbottom=True)
    plot.plot(*points, color=colour, linewidth=1.2)
    middle = 0.5 * (points.min(axis=1) + points.max(axis=1))
    box = plot.get_position()
    drawing = plot.figure.get_size_inches()
    width, height = box.width * drawing[0], box.height * drawing[1]
    reach = np.ptp(points, axis=1) * (0.5 + MARGIN)
    scale = max(reach[0] / width, reach[1] / height)
    plot.set_xlim(middle[0] - scale * width, middle[0] + scale * width)
    plot.set_ylim(middle[1] - scale * height, middle[1] + scale * height)
