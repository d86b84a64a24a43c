"""The path of a run in the plane and in space: the actual one, or the set values against the program.

`meta` of a figure says which trace has the places over time, for places.js.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from cnc_ptp.plots.colours import FAINT, GRID, INK, RED
from cnc_ptp.plots.report_figures import compact, style
from cnc_ptp.recording.decimate import path_points
from cnc_ptp.recording.reader import AXIS_STATE, CHANNEL_STATE, Recorded
from cnc_ptp.recording.rows import axis_label, standing
from cnc_ptp.wire.layout import Records

Floats = npt.NDArray[np.float64]
HEIGHT = 520


@dataclass(frozen=True, slots=True)
class Colouring:
    """What the colour of a path shows: values (n,) of its points, with a title and a unit."""

    title: str
    unit: str
    values: Floats
    digits: int = 0

    @property
    def bar(self) -> dict[str, Any]:
        title = "<br>".join(filter(None, (self.title, self.unit)))
        ticks = ",.0f" if self.digits == 0 else ".2~g"
        return {"title": {"text": title}, "thickness": 12, "outlinewidth": 0, "tickformat": ticks}


@dataclass(frozen=True, slots=True)
class Path:
    """Points of a path: coordinates (axes, n), time in s (n,), colourings; `programmed`: (axes, m), the program's path.

    The first colouring is shown first.
    """

    points: Floats
    time: Floats
    colourings: Sequence[Colouring]
    programmed: Floats | None = None


def path_axes(recorded: Recorded, units: Mapping[str, str]) -> list[str]:
    """The axes of the path plot: x, y, z if they move, otherwise the first three linear axes that do."""
    still = standing(recorded)
    axes = recorded.of_type(AXIS_STATE)
    names = [name for name in axes if units.get(name, "mm") == "mm" and name not in still]
    spatial = [name for name in names if name in ("x", "y", "z")]
    spatial.sort()
    return spatial if len(spatial) >= 2 else names[:3]


def actual_path_figures(recorded: Recorded, units: Mapping[str, str]) -> list[go.Figure]:
    """The actual path, coloured by feed or following error. None if no channel moves along a path."""
    axes = path_axes(recorded, units)
    on_path = any(np.any(rows["path_velocity"]) for rows in recorded.of_type(CHANNEL_STATE).values())
    return path_figures(_path(recorded, axes), axes) if len(axes) >= 2 and on_path else []


def _path(recorded: Recorded, axes: Sequence[str], field: str = "actual_position") -> Path:
    """`field`: which positions."""
    states = [
        (recorded.of_type(AXIS_STATE) if recorded.reduced is None else recorded.reduced.paths)[name] for name in axes
    ]
    length = min(len(rows) for rows in states)
    columns = [rows[field][:length] for rows in states]
    chosen = path_points(columns)
    points = np.stack([column[chosen] for column in columns])
    parts = [rows[:length][chosen] for rows in states]
    feed, error = magnitude(parts, "actual_velocity") * 60.0, magnitude(parts, "following_error")
    colourings = [Colouring("feed", "mm/min", feed), Colouring("following error", "mm", error, digits=4)]
    return Path(points, recorded.seconds(states[0]["cycle"][chosen]), colourings)


def magnitude(axes: Sequence[Records], field: str) -> Floats:
    """Of a field over all axes, (n,)."""
    size: Floats = np.sqrt(sum(rows[field] ** 2 for rows in axes))
    return size


def path_figures(path: Path, axes: Sequence[str]) -> list[go.Figure]:
    """The path in the plane of its first two axes and, with a third one, in space."""
    figures = [_plane_figure(path, axes)]
    if len(axes) > 2:
        figures.append(_space_figure(path, axes))
    return figures


def _hover(axes: Sequence[str], colour: str, colouring: Colouring) -> str:
    places = "<br>".join(
        f"{escape(axis_label(axis))} %{{{place}:.3f}}" for axis, place in zip(axes, "xyz", strict=False)
    )
    return f"{places}<br>%{{customdata:.3f}} s<br>%{{{colour}:.{colouring.digits}f}} {colouring.unit}<extra></extra>"


def _coordinates(points: Floats, axes: int, *, precise: bool) -> dict[str, npt.NDArray[Any]]:
    return {place: compact(points[index], precise=precise) for index, place in enumerate("xyz"[:axes])}


def _plane_figure(path: Path, axes: Sequence[str]) -> go.Figure:
    colouring, precise = path.colourings[0], path.programmed is not None
    run = _coordinates(path.points, 2, precise=precise)
    line = go.Scatter(**run, mode="lines", line={"color": FAINT, "width": 1}, hoverinfo="skip", name="run")
    marks = go.Scatter(
        **run,
        mode="markers",
        name="run",
        customdata=compact(path.time, precise=False),
        marker={"color": compact(colouring.values, precise=False), "size": 4, **_scale(colouring)},
        hovertemplate=_hover(axes[:2], "marker.color", colouring),
    )
    figure = go.Figure([line, marks])
    if path.programmed is not None:
        figure.add_trace(go.Scatter(**_coordinates(path.programmed, 2, precise=True), **PROGRAMMED))
    style_plane(figure, axes, [1])
    _add_choice(figure, path, 1, "marker", axes[:2])
    return figure


def _space_figure(path: Path, axes: Sequence[str]) -> go.Figure:
    colouring, precise = path.colourings[0], path.programmed is not None
    line = go.Scatter3d(
        **_coordinates(path.points, 3, precise=precise),
        mode="lines",
        name="run",
        customdata=compact(path.time, precise=False),
        line={"color": compact(colouring.values, precise=False), "width": 4, **_scale(colouring, bar=precise)},
        hovertemplate=_hover(axes, "line.color", colouring),
    )
    figure = go.Figure([line])
    if path.programmed is not None:
        figure.add_trace(go.Scatter3d(**_coordinates(path.programmed, 3, precise=True), **PROGRAMMED))
    style_space(figure, axes, [0])
    _add_choice(figure, path, 0, "line", axes)
    return figure


def style_plane(figure: go.Figure, axes: Sequence[str], places: Sequence[int]) -> None:
    """`places`: traces with the places over time."""
    style(figure, HEIGHT)
    figure.update_layout(showlegend=False, margin={"l": 70, "r": 10, "t": 20, "b": 50}, hovermode="closest")
    figure.update_layout(meta={"places": [*places]})
    figure.update_xaxes(title_text=f"{escape(axis_label(axes[0]))} in mm")
    figure.update_yaxes(title_text=f"{escape(axis_label(axes[1]))} in mm", scaleanchor="x", scaleratio=1)


def style_space(figure: go.Figure, axes: Sequence[str], places: Sequence[int]) -> None:
    """The same in space, with a trace for the places under the cursor."""
    nowhere = [None] * len(places)
    figure.add_trace(go.Scatter3d(x=nowhere, y=nowhere, z=nowhere, **CURSOR))
    style(figure, HEIGHT)
    figure.update_layout(meta={"places": [*places], "cursor": len(figure.data) - 1})
    sides = {
        f"{place}axis": {
            "title": {"text": f"{escape(axis_label(axis))} in mm"},
            "backgroundcolor": "white",
            "gridcolor": GRID,
        }
        for axis, place in zip(axes, "xyz", strict=False)
    }
    camera = {"eye": {"x": -1.1, "y": -1.7, "z": 1.1}}
    figure.update_layout(
        showlegend=False,
        margin={"l": 0, "r": 0, "t": 0, "b": 0},
        scene={"aspectmode": "data", "camera": camera, **sides},
    )


def figures_of_runs(runs: Sequence[tuple[str, Recorded, str, str]], axes: Sequence[str]) -> list[go.Figure]:
    """Paths of recordings, each by name, colour and field, in the plane and, with a third axis, in space."""
    kinds = [go.Scatter, go.Scatter3d][: len(axes) - 1]
    figures = [go.Figure() for _ in kinds]
    for name, recorded, colour, field in runs:
        path = _path(recorded, axes, field)
        for count, (kind, figure) in enumerate(zip(kinds, figures, strict=True), start=2):
            places = "<br>".join(
                f"{escape(axis_label(axis))} %{{{at}:.3f}}" for axis, at in zip(axes[:count], "xyz", strict=False)
            )
            trace = kind(
                **_coordinates(path.points, count, precise=True),
                mode="lines",
                name=name,
                customdata=compact(path.time, precise=False),
                line={"color": colour, "width": 1.6 if count == 2 else 3},
                hovertemplate=f"{name}<br>{places}<br>%{{customdata:.3f}} s<extra></extra>",
            )
            figure.add_trace(trace)
    for figure, dress in zip(figures, (style_plane, style_space), strict=False):
        dress(figure, axes, range(len(runs)))
        legend = {"x": 0.0, "y": 1.0, "xanchor": "left", "yanchor": "bottom", "orientation": "h"}
        figure.update_layout(showlegend=True, legend=legend, margin={"t": 44})
    figures[-1].update_traces(showlegend=False, selector={"name": "cursor"})
    return figures


PROGRAMMED: dict[str, Any] = {
    "mode": "lines",
    "name": "programmed",
    "line": {"color": RED.set, "width": 1.2},
    "hovertemplate": "programmed<extra></extra>",
}
CURSOR: dict[str, Any] = {
    "mode": "markers",
    "name": "cursor",
    "marker": {"color": INK, "size": 7, "line": {"color": "white", "width": 2}},
    "hoverinfo": "skip",
}
"""The place at the time under the cursor; places.js moves it. In the plane it is an element over the plot."""


def _scale(colouring: Colouring, *, bar: bool = True) -> dict[str, Any]:
    scale: dict[str, Any] = {"colorscale": "Turbo", "cmin": 0.0, "cmax": max(float(colouring.values.max()), 1e-9)}
    return {**scale, "colorbar": colouring.bar, "showscale": True} if bar else scale


def _add_choice(figure: go.Figure, path: Path, trace: int, kind: str, axes: Sequence[str]) -> None:
    """A button for each colouring, if there are several."""
    if len(path.colourings) < 2:
        return
    buttons = []
    for colouring in path.colourings:
        given = {"color": compact(colouring.values, precise=False), **_scale(colouring)}
        changes = {f"{kind}.{name}": [value] for name, value in given.items() if name not in ("colorscale", "cmin")}
        changes["hovertemplate"] = [_hover(axes, f"{kind}.color", colouring)]
        buttons.append({"label": colouring.title, "method": "restyle", "args": [changes, [trace]]})
    place = {"type": "buttons", "direction": "right", "x": 0.0, "xanchor": "left", "y": 1.0, "yanchor": "bottom"}
    figure.update_layout(updatemenus=[{**place, "showactive": True, "active": 0, "buttons": buttons}])
    figure.update_layout(margin={"t": 44})
