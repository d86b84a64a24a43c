"""The polar plot of a circle test as one self-contained HTML page, drawn by Plotly as the reports are."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

import numpy as np
import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from cnc_ptp.commands.circle_report import UM, CircleTest, circle_lines, direction_name, magnification_for
from cnc_ptp.recording.report import CONFIG, SECURITY, STYLE

COLOURS = ("#1d4f9e", "#b0271d", "#17713a", "#c08a00")


def circle_page(test: CircleTest, magnification: float | None) -> str:
    """The page as text: plot to zoom and to point at, and the table."""
    plot = circle_figure(test, magnification).to_html(
        full_html=False, include_plotlyjs=False, config=CONFIG, div_id="circle"
    )
    lines = list(circle_lines(test))
    table = escape("\n".join(lines[1:]))
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta http-equiv="Content-Security-Policy" content="{SECURITY}">'
        f"<title>{escape(lines[0])}</title><style>{STYLE}</style><script>{get_plotlyjs()}</script></head><body>\n"
        f"<header><h1>{escape(lines[0])}</h1></header><main>\n"
        f"<section>{plot}</section><section><pre>{table}</pre></section></main></body></html>\n"
    )


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
    line = {"color": "#1c2430", "width": 1, "dash": "dash"}
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
