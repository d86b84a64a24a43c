"""The polar plot of a circle test as one self-contained HTML page, drawn by Plotly as the reports are."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

import numpy as np
import plotly.graph_objects as go

from cnc_ptp.commands.commissioning.circle_report import UM, CircleTest, circle_lines, direction_name, magnification_for
from cnc_ptp.commands.picture_file import COLOURS, plot_page
from cnc_ptp.plots.colours import INK


def circle_page(test: CircleTest, magnification: float | None) -> str:
    """The page as text: plot to zoom and to point at, and the table."""
    return plot_page(circle_figure(test, magnification), list(circle_lines(test)))


def circle_figure(test: CircleTest, magnification: float | None) -> go.Figure:
    """Deviations in µm over the angle; the middle lies at -R / magnification."""
    magnified = magnification or magnification_for(test)
    low = -UM * test.radius / magnified
    x, y = test.axes
    figure = go.Figure([*_curves(test)])
    figure.update_layout(
        height=760,
        template="plotly_white",
        title={"text": f"deviations magnified {magnified:g} times, in µm", "font": {"size": 13}},
        polar={
            "radialaxis": {"range": [low, -0.35 * low], "angle": 67.5, "tickangle": 0, "tickfont": {"size": 10}},
            "angularaxis": {"tickvals": [0, 90, 180, 270], "ticktext": [f"+{x}", f"+{y}", f"-{x}", f"-{y}"]},
        },
        legend={"orientation": "h"},
    )
    return figure


def _curves(test: CircleTest) -> Iterator[go.Scatterpolargl]:
    turn = list(range(0, 361, 2))
    line = {"color": INK, "width": 1, "dash": "dash"}
    yield go.Scatterpolar(r=[0.0] * len(turn), theta=turn, mode="lines", line=line, name="nominal", hoverinfo="skip")
    for number, result in enumerate(test.results):
        for circle in result.circles:
            order = np.argsort(circle.angles, kind="stable")
            closed = np.append(order, order[0])
            yield go.Scatterpolar(
                r=np.round(UM * circle.deviations[closed], 4),
                theta=np.round(circle.angles[closed], 3),
                mode="lines",
                line={
                    "color": COLOURS[number % len(COLOURS)],
                    "width": 1.5,
                    "dash": "dot" if circle.clockwise else "solid",
                },
                name=escape(f"{result.variant.name}, {direction_name(circle)}"),
                hovertemplate="%{theta:.2f}°: %{r:.3f} µm",
            )
