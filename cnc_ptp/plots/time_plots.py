"""Plots over time as a part of a page: with every cycle, and the script that zooms them."""

from __future__ import annotations

import json
from pathlib import Path

from cnc_ptp.plots.page import plot_div
from cnc_ptp.plots.report_figures import rows_figure, time_columns
from cnc_ptp.recording.reader import Recorded
from cnc_ptp.recording.rows import PlotRow

SCRIPT = Path(__file__).with_name("report.js").read_text(encoding="utf-8")
HINT = (
    "Drag sideways to zoom all plots, double click for the whole run; the scales follow. The cursor shows the values "
    "of a cycle: click for a reference, Δt and Δy count from there, Esc takes it away. Click a legend entry to hide it."
)


def time_plots(recorded: Recorded, rows: list[PlotRow]) -> str:
    """The plots with every cycle of their lines, and the script that zooms them."""
    columns = json.dumps(time_columns(recorded, rows), separators=(",", ":"))
    return (
        f"{plot_div(rows_figure(recorded, rows), 'time')}"
        f'<script type="application/json" id="columns">{columns}</script><script>{SCRIPT}</script>'
    )
