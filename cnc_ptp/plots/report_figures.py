"""The figures of a report: everything over time on linked axes, and the path."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from enum import IntEnum
from html import escape
from typing import Any

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from cnc_ptp.plots.colours import BY_AXIS, EDGE, FAINT, GRID, INK, PURPLE, RED
from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.blocks import CommandRecord, Event, Severity
from cnc_ptp.protocol.channel_states import ChannelStateCode
from cnc_ptp.recording.columns import packed
from cnc_ptp.recording.command_words import command_words, shortened
from cnc_ptp.recording.decimate import line_points
from cnc_ptp.recording.reader import AXIS_STATE, CHANNEL_STATE, SPINDLE_STATE, Recorded
from cnc_ptp.recording.rows import ACTUAL, OTHER, SET, PlotRow
from cnc_ptp.recording.statistics import axis_units
from cnc_ptp.wire.layout import Records

SET_COLOUR, ACTUAL_COLOUR = "#5b93d6", "#d9480f"
"""No two of the figures' colours are as easy to tell apart, the thin actual value above the wide set value."""
COLOURS = [*(pair.set for pair in BY_AXIS), *(pair.actual for pair in BY_AXIS)]
PRECISE = ("position", "angle", "following error")
"""Keep all digits."""
ROW_HEIGHT, ROW_GAP, TOP, BOTTOM = 150, 54, 34, 48
BAND_HEIGHT = 24
MOST_BANDS = 4000
MOST_MARKS = 100
LETTERS = 300
STATE_COLOURS = {
    "DISABLED": "#c9ced6",
    "IDLE": "#dfe3e9",
    "STANDSTILL": "#dfe3e9",
    "READY": "#b9d3ee",
    "HOMING": "#9d7bd8",
    "DISCRETE_MOTION": "#2f7fd1",
    "CONTINUOUS_MOTION": "#2aa198",
    "SYNCHRONIZED_MOTION": "#3f9b4f",
    "RUNNING": "#3f9b4f",
    "WAITING": "#7fb2e5",
    "HOLD": "#f2b63c",
    "STOPPED": "#f0d37a",
    "STOPPING": "#e07b00",
    "ERROR": "#c62828",
    "ERROR_STOP": "#c62828",
}
SEVERITY_COLOURS = {Severity.INFO: "#5b6b7f", Severity.WARNING: "#e0a100", Severity.ERROR: "#c62828"}


def rows_figure(recorded: Recorded, rows: Sequence[PlotRow]) -> go.Figure:
    """States, events and commands, and below them the rows; zooming one of them zooms all.

    The lines are thinned out; report.js replaces them by those of `time_columns` as the page is zoomed.
    """
    count = len(rows) + 1
    first = max(ROW_HEIGHT, BAND_HEIGHT * (2 + len(recorded.states)))
    height = first + len(rows) * (ROW_HEIGHT + ROW_GAP)
    figure = make_subplots(
        rows=count,
        cols=1,
        shared_xaxes="all",
        vertical_spacing=ROW_GAP / height if count > 1 else 0.0,
        row_heights=[first, *[ROW_HEIGHT] * len(rows)],
        subplot_titles=["States, events and commands", *(escape(row.heading) for row in rows)],
    )
    _add_states(figure, recorded)
    serial = 0
    for number, row in enumerate(rows, start=2):
        _add_lines(figure, recorded, row, number, serial)
        serial += len(row.lines)
    style(figure, height + TOP + BOTTOM)
    figure.update_layout(
        margin={"l": 86, "r": 24, "t": TOP, "b": BOTTOM}, hovermode="closest", barmode="overlay", bargap=0.25
    )
    figure.update_xaxes(showticklabels=True, hoverformat=".3f")
    figure.update_yaxes(fixedrange=True)  # they follow
    figure.update_xaxes(title_text="time in s", row=count, col=1)
    figure.update_xaxes(range=time_range(recorded))
    figure.update_annotations(x=0.0, xanchor="left", font={"size": 13, "color": INK})
    _mark_commands(figure, recorded)
    legend = {"orientation": "h", "traceorder": "normal", "x": 0.0, "xanchor": "left"}
    for number, row in enumerate(rows, start=2):
        if row.legend:
            top = figure.layout[f"yaxis{number}"].domain[1]
            place = {"x": 1.0, "xanchor": "right", "y": top, "yanchor": "bottom"}
            figure.update_layout({f"legend{number}": {**legend, **place}})
    return figure


def legend_entries(figure: go.Figure) -> list[tuple[str, str, str]]:
    """Group, name and colour of what has no legend beside its plot: states, marks, set and actual values."""
    found: dict[str, tuple[str, str, str]] = {}
    for trace in figure.data:
        if not trace.showlegend and (isinstance(trace.meta, str) or trace.type == "bar" or trace.name in (SET, ACTUAL)):
            colour = trace.line.color if trace.name in (SET, ACTUAL) else trace.marker.color
            plain = colour if isinstance(colour, str) else INK
            found.setdefault(trace.legendgroup, (trace.legendgroup, trace.name, plain))
    return list(found.values())


def time_range(recorded: Recorded) -> list[float]:
    """Start and end of the states in s."""
    first = min((int(rows["cycle"].min()) for rows in recorded.states.values()), default=0)
    cycle_time = recorded.cycle_time_ns * 1e-9
    return [first * cycle_time, max((recorded.last_cycle + 1) * cycle_time, first * cycle_time + 1e-3)]


def time_columns(recorded: Recorded, rows: Iterable[PlotRow]) -> dict[str, Any]:
    """Every cycle of every line of the figure, for report.js: cycles of each unit once, values of each line."""
    cycles: dict[int, int] = {}
    packed_cycles: list[dict[str, Any]] = []
    values = []
    for line in (line for row in rows for line in row.lines):
        place = cycles.get(id(line.rows))
        if place is None:
            place = cycles[id(line.rows)] = len(packed_cycles)
            packed_cycles.append(packed(line.rows["cycle"]))
        values.append({"cycles": place, "factor": line.factor, "values": packed(line.rows[line.field])})
    return {
        "cycle_time": recorded.cycle_time_ns * 1e-9,
        "stride": recorded.stride,
        "cycles": packed_cycles,
        "lines": values,
    }


def _add_lines(figure: go.Figure, recorded: Recorded, row: PlotRow, number: int, serial: int) -> None:
    """The lines of a row; `meta` says which of all lines of the figure it is."""
    for index, line in enumerate(row.lines):
        cycles, values = line_points(line.rows["cycle"], line.rows[line.field], stride=recorded.stride)
        figure.add_trace(
            go.Scatter(
                x=compact(cycles * (recorded.cycle_time_ns * 1e-9), precise=recorded.last_cycle > 2_000_000),
                y=compact(values * line.factor, precise=row.title in PRECISE),
                mode="lines",
                name=escape(line.name),
                legendgroup=line.name,
                showlegend=row.legend,
                legend=f"legend{number}" if row.legend else "legend",
                line={"color": colour_of(row, index), "width": 2.6 if line.role == SET and len(row.lines) > 1 else 1.3},
                hoverinfo="skip",
                connectgaps=False,
                meta=serial + index,
            ),
            row=number,
            col=1,
        )


def colour_of(row: PlotRow, index: int) -> str:
    """Set and actual values have theirs; other lines of a row one each."""
    line = row.lines[index]
    if line.colour:
        return line.colour
    if line.role != OTHER:
        return SET_COLOUR if line.role == SET else ACTUAL_COLOUR
    if line.name == "following error":
        return RED.set
    return COLOURS[index % len(COLOURS)] if len(row.lines) > 1 else PURPLE.set


def _mark_commands(figure: go.Figure, recorded: Recorded) -> None:
    """A thin line through all plots at each command; of very many none."""
    times = sorted({command.cycle * recorded.cycle_time_ns * 1e-9 for command in recorded.commands})
    if len(times) > MOST_MARKS:
        return
    line = {"color": FAINT, "width": 1, "dash": "dot"}
    shapes = [
        {"type": "line", "xref": "x", "yref": "paper", "x0": time, "x1": time, "y0": 0, "y1": 1, "line": line}
        for time in times
    ]
    figure.update_layout(shapes=[{**shape, "layer": "below"} for shape in shapes])


def compact(values: npt.NDArray[np.float64], *, precise: bool) -> npt.NDArray[Any]:
    """Seven digits are enough for the eye."""
    return values if precise else values.astype(np.float32)


def _add_states(figure: go.Figure, recorded: Recorded) -> None:
    units: list[tuple[str, Records, type[IntEnum]]] = []
    state_codes: list[tuple[str, type[IntEnum]]] = [
        (AXIS_STATE, AxisStateCode),
        (SPINDLE_STATE, AxisStateCode),
        (CHANNEL_STATE, ChannelStateCode),
    ]
    for type_name, codes in state_codes:
        units += [(name, rows, codes) for name, rows in recorded.of_type(type_name).items()]
    names = [*(["commands"] if recorded.commands else []), "events", *(name for name, _, _ in reversed(units))]
    bands: dict[str, list[tuple[str, float, float]]] = {}
    for name, rows, codes in units:
        for state, begin, end in state_bands(rows, codes, recorded.cycle_time_ns * 1e-9, recorded.stride):
            bands.setdefault(state, []).append((name, begin, end))
    for state in sorted(bands, key=list(STATE_COLOURS).index):
        _add_bands(figure, state, bands[state])
    _add_events(figure, recorded)
    _add_commands(figure, recorded)
    figure.update_yaxes(
        categoryorder="array", categoryarray=[escape(name) for name in names[::-1]], autorange="reversed", row=1, col=1
    )
    figure.update_yaxes(showgrid=False, row=1, col=1)


def _add_bands(figure: go.Figure, state: str, bands: list[tuple[str, float, float]]) -> None:
    label = state.replace("_", " ").lower()
    figure.add_trace(
        go.Bar(
            y=[escape(name) for name, _, _ in bands],
            base=[begin for _, begin, _ in bands],
            x=[end - begin for _, begin, end in bands],
            customdata=[[begin, end] for _, begin, end in bands],
            orientation="h",
            name=label,
            legendgroup=state,
            showlegend=False,
            marker={"color": STATE_COLOURS[state], "line": {"width": 0}},
            hovertemplate=f"%{{y}}: {label}<br>%{{customdata[0]:.3f}} s to %{{customdata[1]:.3f}} s<extra></extra>",
        ),
        row=1,
        col=1,
    )


def state_bands(
    rows: Records, codes: type[IntEnum], cycle_time: float, stride: int = 1
) -> Iterator[tuple[str, float, float]]:
    """Stretches of one state: name, start and end in s. Of more than MOST_BANDS the shortest are left out."""
    if len(rows) == 0:
        return
    states = rows["state"]
    starts = np.concatenate([[0], np.flatnonzero(states[1:] != states[:-1]) + 1])
    ends = np.concatenate([starts[1:], [len(states)]]) - 1
    lengths = ends - starts
    kept = np.sort(np.argsort(lengths)[-MOST_BANDS:])
    known = {int(code): code.name for code in codes}
    for start, end in zip(starts[kept], ends[kept], strict=True):
        name = known.get(int(states[start]), "DISABLED")
        yield name, float(rows["cycle"][start]) * cycle_time, (float(rows["cycle"][end]) + stride) * cycle_time


def _add_events(figure: go.Figure, recorded: Recorded) -> None:
    """A mark for each event, in the colour of its severity; report.js writes number and text where there is room."""
    for severity, colour in SEVERITY_COLOURS.items():
        events = [event for event in recorded.events if event.severity == severity]
        if not events:
            continue
        figure.add_trace(
            go.Scatter(
                x=[event.cycle * recorded.cycle_time_ns * 1e-9 for event in events],
                y=["events"] * len(events),
                mode="markers+text",
                name=severity.name.lower(),
                legendgroup=f"event {severity.name}",
                showlegend=False,
                meta="events",
                marker={"color": colour, "size": 11, "symbol": "diamond", "line": {"color": "white", "width": 1}},
                text=[""] * len(events),
                textposition="middle right",
                textfont={"size": 10, "color": colour},
                customdata=[escape(shortened(event_words(event), LETTERS)) for event in events],
                hovertemplate="%{x:.3f} s %{customdata}<extra></extra>",
            ),
            row=1,
            col=1,
        )


def event_words(event: Event) -> str:
    """`P-ERR-23020 y: following error …`"""
    number = f"P-ERR-{event.error_id} " if event.error_id and not event.text.startswith("P-") else ""
    source = "" if event.source in event.text else f"{event.source}: "
    return f"{number}{source}{event.text}"


def _add_commands(figure: go.Figure, recorded: Recorded) -> None:
    """A mark for each moment with a command; report.js writes the words where there is room."""
    moments: dict[int, list[CommandRecord]] = {}
    for command in recorded.commands:
        moments.setdefault(command.cycle, []).append(command)
    if not moments:
        return
    units = {**dict.fromkeys(recorded.of_type(SPINDLE_STATE), "deg"), **axis_units(recorded)}
    words = [
        ", ".join(f"{command.target} {command_words(command, units)}" for command in of) for of in moments.values()
    ]
    refused = [not all(command.accepted for command in of) for of in moments.values()]
    colours = [SEVERITY_COLOURS[Severity.ERROR] if no else INK for no in refused]
    figure.add_trace(
        go.Scatter(
            x=[cycle * recorded.cycle_time_ns * 1e-9 for cycle in moments],
            y=["commands"] * len(moments),
            mode="markers+text",
            name="command",
            legendgroup="command",
            showlegend=False,
            meta="commands",
            marker={"color": colours, "size": 9, "symbol": "triangle-down"},
            text=[""] * len(words),
            textposition="middle right",
            textfont={"size": 10},
            customdata=[escape(shortened(text, LETTERS)) for text in words],
            hovertemplate="%{x:.3f} s %{customdata}<extra></extra>",
        ),
        row=1,
        col=1,
    )


def style(figure: go.Figure, height: int) -> None:
    """What all figures of a page have in common."""
    figure.update_layout(
        template="plotly_white",
        height=height,
        font={"family": "system-ui, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif", "size": 12, "color": INK},
        paper_bgcolor="white",
        plot_bgcolor="white",
        hoverlabel={"font": {"size": 12}},
        separators=".\u202f",
    )
    figure.update_xaxes(gridcolor=GRID, zeroline=False, linecolor=GRID, showline=True)
    figure.update_yaxes(
        gridcolor=GRID,
        zerolinecolor=EDGE,
        linecolor=GRID,
        showline=True,
        exponentformat="none",
        separatethousands=True,
    )
