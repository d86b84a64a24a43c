"""The page of a sweep: parallel coordinates, Pareto front or goals over the parameters, all variants as a table.

Lines are drawn as SVG and not by WebGL: they print sharply, and the page's policy permits no code that is made at run
time, which plotly's own parallel coordinates need.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import combinations

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from cnc_ptp.parameters.declare.declarations import ParameterValue
from cnc_ptp.plots.colours import BLUE, FAINT, PAPER, RED, SOFT
from cnc_ptp.plots.page import (
    MOST_ROWS,
    card_grid,
    count_note,
    name_cell,
    number_cell,
    page_head,
    plot_div,
    section,
    table,
)
from cnc_ptp.sweep.results import Results, Row

CLASSES = 8
"""Colours of parallel coordinates, by the first goal."""
SCALE = ("#1d4f9e", "#2a7fb8", "#35a5a0", "#5cb85c", "#a6c13c", "#e5b93d", "#e08a3c", "#b0271d")
"""From the best variants to the worst."""
WIDTH = 125
"""Pixels that an axis of parallel coordinates needs on a phone."""
LINE = 16
"""Characters of its label in a line."""


def sweep_page(results: Results, title: str, plan: str) -> str:
    """The page as text, to be opened without a network."""
    parts = [
        page_head(
            title, [plan, *(f"{'largest' if goal.maximise else 'least'} {goal.label}" for goal in results.goals)]
        ),
        "<main>",
        cards(results),
        coordinates(results),
        fronts(results),
        over_parameters(results),
        variants(results),
        "</main></body></html>\n",
    ]
    return "\n".join(part for part in parts if part)


def cards(results: Results) -> str:
    found = [("variants", str(len(results.rows)), False), ("failed", str(len(results.failed)), bool(results.failed))]
    for place, goal in enumerate(results.goals):
        if (row := results.best(place)) is not None:
            word = "largest" if goal.maximise else "least"
            found.append((f"{word} {goal.label}, variant {row.number}", f"{row.goals[place]:.6g}", False))
    return card_grid(found)


def coordinates(results: Results) -> str:
    """A line for each variant through the values of its parameters and its goals."""
    sound = results.sound
    if not sound:
        return ""
    labels = [*results.names, *(goal.label for goal in results.goals)]
    columns = [column([row.values[place] for row in sound]) for place in range(len(results.names))]
    columns += [Column(np.array([row.goals[place] for row in sound])) for place in range(len(results.goals))]
    order = np.argsort([results.goals[0].sign * row.goals[0] for row in sound], kind="stable")
    figure = go.Figure()
    for number in reversed(range(CLASSES)):  # the best ones last, above the others
        members = order[number * len(order) // CLASSES : (number + 1) * len(order) // CLASSES]
        if len(members):
            figure.add_trace(lines(columns, members, sound, SCALE[number]))
    for place, axis in enumerate(columns):
        figure.add_vline(place, line={"color": SOFT, "width": 1})
        for height, text in axis.marks():
            figure.add_annotation(
                x=place, y=height, text=text, showarrow=False, xanchor="left", xshift=3, bgcolor=PAPER
            )
    figure.update_layout(height=460, template="plotly_white", showlegend=False, margin={"l": 10, "r": 10, "t": 30})
    figure.update_xaxes(tickvals=[*range(len(labels))], ticktext=[wrapped(label) for label in labels], showgrid=False)
    figure.update_xaxes(range=[-0.5, len(labels) - 0.4], tickangle=0, zeroline=False)
    figure.update_yaxes(visible=False, range=[-0.08, 1.08])
    note = f"Blue: the best for {results.goals[0].label}; red: the worst. Failed variants have no line."
    wide = f'<div style="min-width: {WIDTH * len(labels)}px">{plot_div(figure, "coordinates")}</div>'
    return section("Parallel coordinates", f'<div class="scroll">{wide}</div>', note)


class Column:
    """Numbers (n,) as heights from 0 to 1."""

    def __init__(self, values: npt.NDArray[np.float64], names: Sequence[str] = ()) -> None:
        self._low, self._high = float(values.min()), float(values.max())
        self._names = names
        self.heights = (values - self._low) / (self._high - self._low) if self._high > self._low else values * 0.0 + 0.5

    def marks(self) -> list[tuple[float, str]]:
        """Heights of the axis with what they are."""
        if self._names:
            most = max(len(self._names) - 1, 1)
            return [(number / most if len(self._names) > 1 else 0.5, name) for number, name in enumerate(self._names)]
        if self._low == self._high:
            return [(0.5, f"{self._low:.5g}")]
        return [(-0.05, f"{self._low:.5g}"), (1.05, f"{self._high:.5g}")]


def column(values: Sequence[ParameterValue]) -> Column:
    """Of a parameter: numbers, or texts in their order."""
    if all(isinstance(value, (int, float)) for value in values):
        return Column(np.array(values, dtype=np.float64))
    names = sorted({str(value) for value in values})
    return Column(np.array([float(names.index(str(value))) for value in values]), names)


def lines(columns: Sequence[Column], members: npt.NDArray[np.int64], rows: Sequence[Row], colour: str) -> go.Scatter:
    """The lines of some variants as one trace, with gaps between them."""
    x: list[float | None] = []
    y: list[float | None] = []
    texts: list[str] = []
    for member in members.tolist():
        x += [*map(float, range(len(columns))), None]
        y += [*(float(axis.heights[member]) for axis in columns), None]
        texts += [f"variant {rows[member].number}"] * (len(columns) + 1)
    line = {"color": colour, "width": 1.2}
    return go.Scatter(
        x=x, y=y, text=texts, mode="lines", line=line, opacity=0.75, hovertemplate="%{text}<extra></extra>"
    )


def wrapped(label: str) -> str:
    """A label in lines as short as its dots and brackets permit."""
    lines = [""]
    for word in re.findall(r"[^.(]*[.(]?", label):
        if len(lines[-1] + word) > LINE:
            lines.append("")
        lines[-1] += word
    return "<br>".join(line for line in lines if line)


def fronts(results: Results) -> str:
    """Two goals against each other, of each pair of them, with the variants that no other one beats."""
    if len(results.goals) < 2 or not results.sound:
        return ""
    best = results.pareto_front()
    plots = [
        plot_div(front_figure(results, best, one, other), f"front{one}-{other}")
        for one, other in combinations(range(len(results.goals)), 2)
    ]
    numbers = ", ".join(str(row.number) for row in best[:MOST_ROWS])
    note = f"Red: the Pareto front. No other variant is better in one goal and as good in all others: {numbers}."
    return section("Pareto front", grid_of(plots), note)


def front_figure(results: Results, best: Sequence[Row], one: int, other: int) -> go.Figure:
    figure = go.Figure([points(results, results.sound, one, other, FAINT, "markers")])
    front = sorted(best, key=lambda row: (row.goals[one], row.goals[other]))
    mode = "lines+markers" if len(results.goals) == 2 else "markers"
    figure.add_trace(points(results, front, one, other, RED.set, mode))
    figure.update_xaxes(title=results.goals[one].label)
    figure.update_yaxes(title=results.goals[other].label)
    return plain(figure)


def points(results: Results, rows: Sequence[Row], one: int, other: int, colour: str, mode: str) -> go.Scatter:
    return go.Scatter(
        x=[row.goals[one] for row in rows],
        y=[row.goals[other] for row in rows],
        text=[described(results, row) for row in rows],
        mode=mode,
        marker={"color": colour, "size": 7},
        line={"color": colour, "width": 1},
        hovertemplate="%{text}<br>%{x:.6g}, %{y:.6g}<extra></extra>",
    )


def over_parameters(results: Results) -> str:
    """Each goal over each parameter."""
    if not results.sound:
        return ""
    plots = [
        plot_div(parameter_figure(results, place, goal), f"goal{goal}-{place}")
        for goal in range(len(results.goals))
        for place in range(len(results.names))
    ]
    return section("Goals over the parameters", grid_of(plots))


def parameter_figure(results: Results, place: int, goal: int) -> go.Figure:
    sound = results.sound
    figure = go.Figure(
        go.Scatter(
            x=[row.values[place] for row in sound],
            y=[row.goals[goal] for row in sound],
            text=[described(results, row) for row in sound],
            mode="lines+markers" if len(results.names) == 1 and is_number(sound[0].values[0]) else "markers",
            marker={"color": BLUE.set, "size": 6},
            hovertemplate="%{text}<br>%{y:.6g}<extra></extra>",
        )
    )
    if len(results.names) == 1:
        figure.update_traces(**in_order(figure))
    figure.update_xaxes(title=results.names[place])
    figure.update_yaxes(title=results.goals[goal].label)
    return plain(figure)


def in_order(figure: go.Figure) -> dict[str, list[object]]:
    """The points of the only trace from left to right, so that its line does not turn back."""
    trace = figure.data[0]
    order = sorted(range(len(trace.x)), key=lambda number: (str(type(trace.x[number])), trace.x[number]))
    return {name: [trace[name][number] for number in order] for name in ("x", "y", "text")}


def is_number(value: ParameterValue) -> bool:
    return isinstance(value, (int, float))


def plain(figure: go.Figure) -> go.Figure:
    figure.update_layout(height=380, template="plotly_white", showlegend=False, margin={"l": 60, "r": 20, "t": 20})
    return figure


def grid_of(plots: Sequence[str]) -> str:
    style = "paths two" if len(plots) > 1 else "paths"
    return f'<div class="{style}">{"".join(f"<div>{plot}</div>" for plot in plots)}</div>'


def described(results: Results, row: Row) -> str:
    values = [f"{name} = {shown(value)}" for name, value in zip(results.names, row.values, strict=True)]
    return "<br>".join([f"variant {row.number}", *values])


def shown(value: ParameterValue) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def variants(results: Results) -> str:
    """The first of all variants; failed ones with their error."""
    head = ["variant", *results.names, *(goal.label for goal in results.goals), "error"]
    rows = [("error" if row.error else "", cells(row)) for row in results.rows[:MOST_ROWS]]
    return section("Variants", table(head, rows), count_note(len(results.rows), "variant"))


def cells(row: Row) -> list[str]:
    values = [name_cell(shown(value)) for value in row.values]
    goals = [name_cell("") if row.error else name_cell(f"{goal:.6g}") for goal in row.goals]
    return [
        number_cell(row.number),
        *values,
        *goals,
        name_cell(f"P-ERR-{row.error} {row.message}" if row.error else ""),
    ]
