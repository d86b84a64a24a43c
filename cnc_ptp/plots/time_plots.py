"""Plots over time as a part of a page: with every cycle, and the scripts that zoom, measure and print them."""

from __future__ import annotations

import json
from html import escape
from pathlib import Path

import plotly.graph_objects as go

from cnc_ptp.plots.page import plot_div
from cnc_ptp.plots.report_figures import legend_entries, rows_figure, time_columns
from cnc_ptp.recording.reader import Recorded
from cnc_ptp.recording.rows import PlotRow

SCRIPTS = [
    Path(__file__).with_name(name).read_text(encoding="utf-8") for name in ("report.js", "places.js", "paper.js")
]
HINT = (
    "Drag sideways to zoom all plots, double click for the whole run; the scales follow. The cursor shows the values "
    "of a cycle, and its place on the paths; a place under the cursor on a path is a time here. Click for a first "
    "mark A, again for a second one B: Δt, Δ of each line and its slope count from A. Esc takes the marks away."
)


def time_plots(recorded: Recorded, rows: list[PlotRow]) -> str:
    """The plots with every cycle of their lines, and the scripts of the page."""
    figure = rows_figure(recorded, rows)
    columns = json.dumps(time_columns(recorded, rows), separators=(",", ":"))
    return (
        f'{legend(figure)}<div id="measured" hidden></div>{plot_div(figure, "time")}'
        f'<script type="application/json" id="columns">{columns}</script>'
        + "".join(f"<script>{script}</script>" for script in SCRIPTS)
    )


def legend(figure: go.Figure) -> str:
    """A button for each group of lines and marks, that hides and shows them; it wraps where a page is narrow."""
    buttons = "".join(
        f'<button type="button" data-group="{escape(group)}"><i style="background:{colour}"></i>{name}</button>'
        for group, name, colour in legend_entries(figure)
    )
    return f'<div class="legend">{buttons}</div>'
