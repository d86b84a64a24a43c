"""The threads of a recording on a page: a line for each pass, its pitch and phase error, and the unrolled thread."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from cnc_ptp.plots.colours import BY_AXIS, INK
from cnc_ptp.plots.page import name_cell, number_cell, plot_div, section, table, text_cell
from cnc_ptp.plots.program_run import machine_of
from cnc_ptp.plots.report_figures import ROW_GAP, compact, style
from cnc_ptp.recording.decimate import line_points
from cnc_ptp.recording.reader import Recorded
from cnc_ptp.recording.rows import axis_label
from cnc_ptp.recording.thread_passes import TURN, Floats, ThreadPass, phase_against, thread_passes

MOST_PASSES = 40
"""That are drawn; the table has all."""
HEIGHT = 240
HEAD = (
    "pass",
    "line",
    "at s",
    "axis",
    "from mm",
    "to mm",
    "lead mm",
    "rpm",
    "pitch error set µm",
    "pitch error actual µm",
    "phase deg",
    "against pass 1 deg",
)
NOTE = (
    "Against the actual angle of the spindle, without run-up and run-out. Pitch error: way in the last turn - lead, "
    "the largest of a pass, for set and actual values of the axis; when tapping, set values are ahead by the following "
    "error of the spindle. Phase: angle of the spindle at which the groove is at the position 0 of the axis, by actual "
    "values."
)
UNROLLED_NOTE = (
    "Actual angle of the spindle within a turn over the actual position of the axis: the lateral surface, unrolled. "
    "Passes in one groove lie on each other, those of several starts side by side."
)


def thread_sections(recorded: Recorded) -> str:
    """Empty for a recording without threads."""
    passes = thread_passes(recorded, machine_of(recorded))
    if not passes:
        return ""
    drawn = passes[:MOST_PASSES]
    notes = (
        [NOTE] if len(passes) == len(drawn) else [NOTE, f"The first {MOST_PASSES} of {len(passes)} passes are drawn."]
    )
    body = table(HEAD, pass_rows(passes)) + plot_div(error_figure(drawn), "threads")
    unrolled = plot_div(unrolled_figure(drawn), "unrolled")
    return section("Threads", body, " ".join(notes)) + section("Unrolled threads", unrolled, UNROLLED_NOTE)


def pass_rows(passes: Sequence[ThreadPass]) -> list[tuple[str, list[str]]]:
    """A line of the table for each pass."""
    return [("", _cells(number, each, passes[0])) for number, each in enumerate(passes, start=1)]


def _cells(number: int, each: ThreadPass, first: ThreadPass) -> list[str]:
    return [
        number_cell(number),
        number_cell(each.line),
        number_cell(each.seconds, 3),
        name_cell(axis_label(each.axis)),
        number_cell(each.position[0], 3),
        number_cell(each.position[-1], 3),
        number_cell(each.lead, 3),
        number_cell(each.rpm, 1),
        _known(each.largest("set_pitch_error") * 1000.0, 3),
        _known(each.largest("actual_pitch_error") * 1000.0, 3),
        number_cell(each.phase, 3),
        _known(phase_against(first, each), 3),
    ]


def _known(value: float, digits: int) -> str:
    return text_cell("–") if isnan(value) else number_cell(value + 0.0, digits)


def error_figure(passes: Sequence[ThreadPass]) -> go.Figure:
    """Pitch error (µm) and phase error (deg) over the position along the thread, a colour for each pass."""
    titles = ["Pitch error in µm", "Phase error in deg"]
    figure = make_subplots(rows=2, cols=1, shared_xaxes="all", subplot_titles=titles, vertical_spacing=0.14)
    for number, each in enumerate(passes):
        colours = BY_AXIS[number % len(BY_AXIS)]
        name = pass_name(number, each)
        for row, field, factor in ((1, "pitch_error", 1000.0), (2, "phase_error_deg", 1.0)):
            _add_line(figure, each, f"actual_{field}", factor, row, f"{name}, actual", colours.actual)
            _add_line(figure, each, f"set_{field}", factor, row, f"{name}, set", colours.set)
    style(figure, 2 * (HEIGHT + ROW_GAP))
    figure.update_layout(margin={"l": 86, "r": 24, "t": 60, "b": 48}, hovermode="closest")
    figure.update_annotations(x=0.0, xanchor="left", font={"size": 13, "color": INK})
    figure.update_xaxes(showticklabels=True)
    figure.update_xaxes(title_text=along(passes), row=2, col=1)
    return figure


def _add_line(figure: go.Figure, each: ThreadPass, field: str, factor: float, row: int, name: str, colour: str) -> None:
    """A field over the position, thinned out; both plots hide it with one entry of the legend."""
    places, values = line_points(np.arange(len(each.position), dtype=np.uint64), each.errors[field])
    figure.add_trace(
        go.Scatter(
            x=compact(each.position[places.astype(np.int64)], precise=False),
            y=compact(values * factor, precise=False),
            mode="lines",
            name=name,
            legendgroup=name,
            showlegend=row == 1,
            line={"color": colour, "width": 1.3},
        ),
        row=row,
        col=1,
    )


def pass_name(number: int, each: ThreadPass) -> str:
    return f"pass {number + 1} (line {each.line})"


def along(passes: Sequence[ThreadPass]) -> str:
    """Title of the scale of positions."""
    axes = ", ".join(dict.fromkeys(axis_label(each.axis) for each in passes))
    return f"{axes} in mm"


def unrolled_figure(passes: Sequence[ThreadPass]) -> go.Figure:
    """The groove of each pass: angle 0 … 360 deg over the position."""
    figure = go.Figure()
    for number, each in enumerate(passes):
        position, angle = unrolled(each.position, each.angle)
        figure.add_trace(
            go.Scatter(
                x=compact(position, precise=False),
                y=compact(angle, precise=False),
                mode="lines",
                name=pass_name(number, each),
                line={"color": BY_AXIS[number % len(BY_AXIS)].set, "width": 1.3},
            )
        )
    style(figure, 2 * HEIGHT)
    figure.update_layout(margin={"l": 70, "r": 24, "t": 20, "b": 50}, hovermode="closest", showlegend=True)
    figure.update_xaxes(title_text=along(passes))
    figure.update_yaxes(title_text="angle of the spindle in deg", range=[0.0, TURN], dtick=90)
    return figure


def unrolled(position: Floats, angle: Floats) -> tuple[Floats, Floats]:
    """Points of a groove with its angle within a turn, interrupted by NaN between turns."""
    turns = np.floor(angle / TURN)
    begins = np.concatenate([[0], np.flatnonzero(np.diff(turns)) + 1])
    parts = [_turn(part) for part in np.split(np.arange(len(angle)), begins[1:])]
    places = np.concatenate([part for each in parts for part in (each, [-1])][:-1])
    within = angle[places] - TURN * turns[places]
    gap = places < 0
    return np.where(gap, np.nan, position[places]), np.where(gap, np.nan, within)


def _turn(part: np.typing.NDArray[np.int64]) -> np.typing.NDArray[np.int64]:
    """Some cycles of a turn, its first and its last one among them."""
    return np.unique(np.linspace(part[0], part[-1], POINTS_OF_A_TURN).astype(np.int64))


POINTS_OF_A_TURN = 5
