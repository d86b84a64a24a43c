"""A page of two recorded runs on top of each other: figures first, then the paths, then everything over time."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

import numpy as np
import plotly.graph_objects as go

from cnc_ptp.plots.page import card_grid, name_cell, number_cell, page_head, plot_div, section, table
from cnc_ptp.plots.report_figures import ACTUAL_COLOUR, SET_COLOUR, style
from cnc_ptp.plots.time_plots import HINT, time_plots
from cnc_ptp.recording.decimate import path_points
from cnc_ptp.recording.reader import AXIS_STATE, CHANNEL_STATE, SPINDLE_STATE, Recorded, TopicInfo
from cnc_ptp.recording.rows import ACTUAL, SET, Line, PlotRow, axis_label, moves
from cnc_ptp.recording.run_difference import COMPARED, STATE, Both, Curve, RunDifference
from cnc_ptp.recording.units import unit_of
from cnc_ptp.wire.layout import Records

HEIGHT = 520
HEAD = ("unit", "column", "largest", "now", "largest difference", "at s", "parts at s")


def difference_page(both: Both, found: RunDifference, names: tuple[str, str]) -> str:
    """`names` of the two runs, for the head and the legends."""
    shown = _Shown(both, names)
    parts = [
        page_head(" and ".join(names), [f"{found.begin:g} s to {found.end:g} s"]),
        "<main>",
        _cards(found),
        section("What differs", _table(found), "" if found.parts_at is not None else "Both runs are equal to the bit."),
        _paths(shown, names),
        section("Over time", time_plots(shown.recorded, list(shown.rows())), HINT),
        "</main></body></html>\n",
    ]
    return "\n".join(part for part in parts if part)


class _Shown:
    """The states of both runs, as one recording in which the units of the second one have its name."""

    def __init__(self, both: Both, names: tuple[str, str]) -> None:
        machine, self._names = both.machine, names
        self._distances = {name: "deg" if axis.rotary else "mm" for name, axis in machine.axes.items()}
        self._pairs: dict[str, tuple[Records, Records]] = {}
        kinds = {
            **dict.fromkeys(machine.channels, CHANNEL_STATE),
            **dict.fromkeys(machine.spindles, SPINDLE_STATE),
            **dict.fromkeys(machine.axes, AXIS_STATE),
        }
        times = {"start_ns": "0", "cycle_time_ns": str(machine.cycle_time_us * 1000)}
        self.recorded = Recorded(both.first_path, metadata=times)
        for unit, kind in kinds.items():
            curves = both.curves(unit, STATE, *COMPARED)
            if curves:
                self._pairs[unit] = _records(curves, machine.cycle_time_us * 1e-6)
                for name, rows in zip((unit, f"{unit} ({names[1]})"), self._pairs[unit], strict=True):
                    self.recorded.states[f"/{name}/state"] = rows
                    self.recorded.topics[f"/{name}/state"] = TopicInfo(f"/{name}/state", kind, len(rows))

    def rows(self) -> Iterator[PlotRow]:
        """One plot for each column of a unit that moves in one of the runs."""
        for unit, pair in self._pairs.items():
            if unit not in self.recorded.of_type(CHANNEL_STATE) and not any(moves(rows) for rows in pair):
                continue
            for column in [name for name in COMPARED if name in (pair[0].dtype.names or ())]:
                lines = [
                    Line(name, rows, column, role)
                    for name, rows, role in zip(self._names, pair, (SET, ACTUAL), strict=True)
                ]
                measure = unit_of(column, self._distances.get(unit, ""), "")
                yield PlotRow(axis_label(unit), column.replace("_", " "), measure, lines)

    def paths(self, column: str) -> tuple[list[str], list[list[np.ndarray]]]:
        """The first two linear axes that move, and their positions in both runs."""
        axes = [
            name
            for name, pair in self._pairs.items()
            if self._distances.get(name) == "mm" and any(np.ptp(rows[column]) for rows in pair)
        ][:2]
        return axes, [[self._pairs[name][run][column] for name in axes] for run in (0, 1)]


def _records(curves: list[Curve], cycle_time: float) -> tuple[Records, Records]:
    """The columns of a unit in each of the runs."""
    dtype = [("cycle", np.uint64), *((curve.column, curve.first.dtype) for curve in curves)]
    first, second = (np.zeros(len(curves[0].times), dtype=dtype) for _ in (0, 1))
    for rows in (first, second):
        rows["cycle"] = np.rint(curves[0].times / cycle_time).astype(np.uint64)
    for curve in curves:
        first[curve.column], second[curve.column] = curve.first, curve.second
    return first, second


def _cards(found: RunDifference) -> str:
    parts_at = "never" if found.parts_at is None else f"{found.parts_at:.3f} s"
    cards = [("the runs part at", parts_at, False)]
    for channel, (one, two) in found.program_times.items():
        cards.append((f"program time of {channel}: {one:.3f} s, now", f"{two:.3f} s", False))
    return card_grid(cards)


def _table(found: RunDifference) -> str:
    rows = [
        (
            "",
            [
                name_cell(row.unit),
                name_cell(row.column.replace("_", " ")),
                *(number_cell(value, 6) for value in (row.first, row.second, row.difference)),
                number_cell(row.at, 3),
                number_cell(row.parts_at, 3),
            ],
        )
        for row in found.rows
        if row.parts_at is not None
    ]
    return table(HEAD, rows)


def _paths(shown: _Shown, names: tuple[str, str]) -> str:
    """Set and actual paths in the plane of the first two axes that move."""
    plots = []
    for column, title in (("set_position", "set path"), ("actual_position", "actual path")):
        axes, runs = shown.paths(column)
        if len(axes) == 2:
            figure = _path_figure(runs, axes, names, title)
            plots.append(f"<div>{plot_div(figure, column)}</div>")
    return section("Paths", f'<div class="paths two">{"".join(plots)}</div>') if plots else ""


def _path_figure(runs: list[list[np.ndarray]], axes: list[str], names: tuple[str, str], title: str) -> go.Figure:
    figure = go.Figure()
    for columns, name, colour, width in zip(runs, names, (SET_COLOUR, ACTUAL_COLOUR), (2.6, 1.3), strict=True):
        chosen = path_points(columns)
        x, y = (column[chosen] for column in columns)
        line = {"color": colour, "width": width}
        figure.add_trace(go.Scatter(x=x, y=y, mode="lines", name=escape(name), line=line))
    style(figure, HEIGHT)
    figure.update_layout(title={"text": title, "font": {"size": 13}}, legend={"orientation": "h"}, hovermode="closest")
    figure.update_xaxes(title_text=f"{escape(axis_label(axes[0]))} in mm")
    figure.update_yaxes(title_text=f"{escape(axis_label(axes[1]))} in mm", scaleanchor="x", scaleratio=1)
    return figure
