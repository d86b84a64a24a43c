"""A fitted acceleration curve as one self-contained HTML page."""

from __future__ import annotations

import plotly.graph_objects as go

from cnc_ptp.commands.commissioning.curve_report import RPM, curve_lines, drawn_curve
from cnc_ptp.commands.picture_file import COLOURS, plot_page
from cnc_ptp.commissioning.curve_fit import CurveFit, curve_fault
from cnc_ptp.plots.colours import SOFT

HOVER = "%{x:.1f} °/s (%{customdata:.1f} rpm): %{y:.2f} °/s²"


def curve_page(fit: CurveFit) -> str:
    """The page as text: plot to zoom and to point at, and the table."""
    return plot_page(curve_figure(fit), list(curve_lines(fit, usable=curve_fault(fit) is None)))


def curve_figure(fit: CurveFit) -> go.Figure:
    """Acceleration over speed: the curve as the spindle has it, the points, limit speed and floor."""
    speeds, accelerations = drawn_curve(fit)
    line = go.Scatter(x=speeds, y=accelerations, customdata=speeds / RPM, mode="lines", name=fit.parameters.kind)
    line.update(line={"color": COLOURS[0], "width": 2}, hovertemplate=HOVER)
    at, given = zip(*fit.points, strict=True)
    points = go.Scatter(x=at, y=given, customdata=[speed / RPM for speed in at], mode="markers", name="points")
    points.update(marker={"color": COLOURS[1], "size": 9}, hovertemplate=HOVER)
    figure = go.Figure([line, points])
    figure.add_vline(fit.parameters.limit_speed, line={"color": SOFT, "dash": "dash", "width": 1})
    if fit.parameters.minimum:
        figure.add_hline(fit.parameters.minimum, line={"color": COLOURS[3], "dash": "dot", "width": 1})
    figure.update_layout(
        height=560,
        template="plotly_white",
        xaxis={"title": "speed in °/s", "rangemode": "tozero"},
        yaxis={"title": "acceleration in °/s²", "rangemode": "tozero"},
        legend={"orientation": "h"},
    )
    return figure
