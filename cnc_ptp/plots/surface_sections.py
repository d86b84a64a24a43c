"""What was machined on the face and on the lateral surface of a workpiece, in the coordinates of its drawing."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from cnc_ptp.plots.page import plot_div, section
from cnc_ptp.plots.path_figures import Colouring, Path, path_figures
from cnc_ptp.plots.program_run import machine_of
from cnc_ptp.recording.decimate import path_points
from cnc_ptp.recording.reader import Recorded
from cnc_ptp.recording.rows import ACTUAL
from cnc_ptp.recording.surfaces import COMMAND, CYLINDER, FACE, Surface, surfaces

MOST = 8
"""Of each kind that are drawn."""
TITLES = {FACE: "Front face", CYLINDER: "Lateral surface, unrolled"}
NOTES = {
    FACE: "{} positions in Cartesian coordinates of the face, as one looks at it; the origin is its zero point.",
    CYLINDER: "{} positions on the cylinder of the command: length of arc over the longitudinal axis.",
}


def surface_sections(recorded: Recorded, values: str = ACTUAL) -> str:
    """A section for each kind, of values SET or ACTUAL; empty for a recording without #FACE and #CYL."""
    if not any(COMMAND.fullmatch(system) for change in recorded.coordinates for system in change.systems):
        return ""
    found = surfaces(recorded, machine_of(recorded), values)
    kinds = {kind: [each for each in found if each.kind == kind] for kind in TITLES}
    return "".join(_section(kind, each, recorded, values) for kind, each in kinds.items())


def _section(kind: str, found: Sequence[Surface], recorded: Recorded, values: str) -> str:
    if not found:
        return ""
    plots = "".join(
        f'<div><p class="note">{escape(when(each, recorded))}</p>{_plot(each, recorded, number)}</div>'
        for number, each in enumerate(found[:MOST])
    )
    style = "paths two" if len(found) > 1 else "paths"
    left_out = f" The first {MOST} of {len(found)}." if len(found) > MOST else ""
    return section(
        TITLES[kind], f'<div class="{style}">{plots}</div>', NOTES[kind].format(values.capitalize()) + left_out
    )


def _plot(each: Surface, recorded: Recorded, number: int) -> str:
    [figure] = path_figures(surface_path(each, recorded), each.axes)
    return plot_div(figure, f"{each.kind[1:].lower()}{number}")


def when(each: Surface, recorded: Recorded) -> str:
    """`#FACE [X, C], 15.749 s to 32.412 s`"""
    begin, end = recorded.seconds(each.cycles[[0, -1]])
    return f"{each.command}, {begin:.3f} s to {end:.3f} s"


def surface_path(each: Surface, recorded: Recorded) -> Path:
    """The points to draw, coloured by the velocity of the path."""
    chosen = path_points(list(each.points))
    feed = Colouring("feed", "mm/min", each.velocity[chosen] * 60.0)
    return Path(each.points[:, chosen], recorded.seconds(each.cycles[chosen]), [feed])
