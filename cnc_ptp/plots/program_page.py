"""What a page shows of a program's run: its path against the programmed one, over its length, and its blocks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from cnc_ptp.plots.colours import BY_AXIS, INK, PURPLE, SOFT
from cnc_ptp.plots.page import (
    MOST_ROWS,
    card_grid,
    number_cell,
    page_head,
    plot_div,
    section,
    table,
    text_cell,
)
from cnc_ptp.plots.path_figures import Colouring, Path, magnitude, path_axes, path_figures
from cnc_ptp.plots.program_run import BlockPass, Floats, ProgramRun, program_run
from cnc_ptp.plots.report_figures import ROW_GAP, ROW_HEIGHT, compact, style
from cnc_ptp.plots.surface_sections import surface_sections
from cnc_ptp.plots.time_plots import HINT, time_plots
from cnc_ptp.recording.decimate import line_points, path_points
from cnc_ptp.recording.reader import CHANNEL_STATE, Recorded
from cnc_ptp.recording.rows import ACTUAL, SET, Line, PlotRow, axis_label
from cnc_ptp.recording.statistics import axis_units

COLOURS = ("feed", "acceleration", "block")
POINTS = 20_000
"""Of a path that is drawn; longer ones are thinned out."""
LENGTHS = 3000
"""Times of the length that the cursor knows."""
MM_PER_MIN = 60.0
PATH_NOTE = (
    "Set values of the run; the red line is the programmed path. Zoom into the plane to see how corners are rounded. "
    "Acceleration: of the path axes together."
)
LENGTH_NOTE = "Set values over the length that was run; dotted: limits of the axes."


def program_page(recorded: Recorded, run: ProgramRun, *, title: str, details: Sequence[str], colour: str) -> str:
    """The page of a program that was run offline."""
    blocks = f"{len(run.blocks)}" if run.total is None else f"{run.total}"
    cards = [
        ("program time", f"{run.seconds:.3f} s", False),
        ("length of the path", f"{run.length[-1]:.2f} mm", False),
        ("largest path velocity", f"{run.channel['path_velocity'].max() * MM_PER_MIN:.0f} mm/min", False),
        ("blocks with a motion" if run.total is not None else "blocks", blocks, False),
    ]
    over_time = time_plots(recorded, list(program_rows(recorded, run)))
    body = [
        page_head(title, details),
        "<main>",
        card_grid(cards),
        program_sections(run, colour),
        surface_sections(recorded, SET),
        section("Over time", over_time, HINT),
        "</main></body></html>\n",
    ]
    return "\n".join(body)


def recorded_program(recorded: Recorded) -> str:
    """The same sections of a recording; empty if no channel moves along a path."""
    run = program_run(recorded, path_axes(recorded, axis_units(recorded)))
    return "" if run is None else program_sections(run, "feed")


def program_sections(run: ProgramRun, colour: str) -> str:
    figures = path_figures(run_path(run, colour), run.nodes)
    plots = "".join(f"<div>{plot_div(figure, f'program{number}')}</div>" for number, figure in enumerate(figures))
    drawn = f'<div class="paths{" two" if len(figures) > 1 else ""}">{plots}</div>'
    return "\n".join(
        [
            section("Path of the program", drawn, path_note(run)),
            section("Over the path", plot_div(length_figure(run), "length"), LENGTH_NOTE),
            section("Blocks", block_table(run), table_note(run)),
        ]
    )


def path_note(run: ProgramRun) -> str:
    """What the plots show, and what was left out."""
    notes = [PATH_NOTE if run.programmed is not None else PATH_NOTE.partition(";")[0] + "."]
    if len(run.length) > POINTS:
        notes.append(f"Of {len(run.length)} cycles about {POINTS} are drawn, most of them where the path turns.")
    if run.programmed is not None and run.programmed.shape[1] > POINTS:
        notes.append(f"Of {run.programmed.shape[1]} programmed points about {POINTS} are drawn.")
    return " ".join(notes)


def run_path(run: ProgramRun, colour: str) -> Path:
    """Set values of the run, thinned out; `colour` is the colouring that is shown first."""
    positions = run.column("set_position")
    chosen = thinned(positions)
    axes = [rows[chosen] for rows in run.axes]
    order = np.zeros(len(run.length))
    for block in run.blocks[1:]:
        order[block.begin] = 1.0
    colourings = {
        "feed": Colouring("feed", "mm/min", run.channel["path_velocity"][chosen] * MM_PER_MIN),
        "acceleration": Colouring("acceleration", "mm/s²", magnitude(axes, "set_acceleration")),
        "block": Colouring("block", "", (1.0 + np.cumsum(order))[chosen]),
    }
    first = colourings.pop(colour)
    time = run.channel["cycle"][chosen] * run.cycle_time
    programmed = None if run.programmed is None else run.programmed[:, thinned(run.programmed)]
    return Path(positions[:, chosen], time, [first, *colourings.values()], programmed)


def thinned(points: Floats) -> np.typing.NDArray[np.int64]:
    """Indices of the points to draw: all, or about POINTS of them."""
    count = points.shape[1]
    return np.arange(count) if count <= POINTS else path_points(list(points), POINTS)


def length_figure(run: ProgramRun) -> go.Figure:
    """Path velocity, and acceleration and jerk of each axis with its limits, over the length of the path."""
    titles = ["Feed in mm/min", "Velocity in mm/s", "Acceleration in mm/s²", "Jerk in mm/s³"]
    height = len(titles) * (ROW_HEIGHT + ROW_GAP)
    figure = make_subplots(
        rows=len(titles), cols=1, shared_xaxes="all", vertical_spacing=ROW_GAP / height, subplot_titles=titles
    )
    feeds = run.channel["programmed_feed"] * MM_PER_MIN, run.channel["path_velocity"] * MM_PER_MIN
    for name, values, look in zip(("programmed", "path"), feeds, (SOFT, PURPLE.set), strict=True):
        _add_line(figure, run, values, 1, name, look, legend=True)
    for row, field in enumerate(("set_velocity", "set_acceleration", "set_jerk"), start=2):
        for index, node in enumerate(run.nodes):
            colour = BY_AXIS[index % len(BY_AXIS)].set
            _add_line(figure, run, run.axes[index][field], row, axis_label(node), colour, legend=row == 2)
        for limit in sorted(set(limits(run, field))):
            for side in (-limit, limit):
                figure.add_hline(side, row=row, col=1, line={"color": SOFT, "width": 1, "dash": "dot"})
    style(figure, height + 110)
    figure.update_layout(margin={"l": 86, "r": 24, "t": 70, "b": 48}, hovermode="x")
    figure.update_layout(legend={"orientation": "h", "x": 0.0, "xanchor": "left", "y": 1.05, "yanchor": "bottom"})
    figure.update_annotations(x=0.0, xanchor="left", font={"size": 13, "color": INK})
    figure.update_xaxes(showticklabels=True)
    figure.update_xaxes(title_text="length in mm", row=len(titles), col=1)
    chosen = np.unique(np.linspace(0, len(run.length) - 1, LENGTHS).astype(np.int64))
    times = run.channel["cycle"][chosen] * run.cycle_time
    figure.update_layout(meta={"lengths": run.length[chosen].round(4).tolist(), "times": times.round(6).tolist()})
    return figure


def _add_line(
    figure: go.Figure, run: ProgramRun, values: Floats, row: int, name: str, colour: str, *, legend: bool
) -> None:
    """A line over the length, thinned out as those over time."""
    places, shown = line_points(np.arange(len(values), dtype=np.uint64), values)
    figure.add_trace(
        go.Scatter(
            x=compact(run.length[places.astype(np.int64)], precise=False),
            y=compact(shown, precise=False),
            mode="lines",
            name=name,
            legendgroup=name,
            showlegend=legend,
            line={"color": colour, "width": 1.3},
        ),
        row=row,
        col=1,
    )


def limits(run: ProgramRun, field: str) -> Iterator[float]:
    """Those of the axes for a field of their set values; none without a machine file."""
    for node in run.nodes:
        axis = None if run.machine is None else run.machine.axes.get(node)
        if axis is not None and field == "set_acceleration":
            yield max(axis.acceleration, axis.deceleration)
        elif axis is not None and field == "set_jerk":
            yield axis.jerk


def block_table(run: ProgramRun) -> str:
    """Line, text, length, time and reached feed of each block, in the order of the run."""
    head = ["line", "N", "block", "length in mm", "time in s", "F in mm/min", "reached in mm/min"]
    return table(head, (("", _cells(block)) for block in run.blocks[:MOST_ROWS]))


def _cells(block: BlockPass) -> list[str]:
    return [
        number_cell(block.line),
        number_cell(block.number) if block.number else text_cell(""),
        text_cell(block.text),
        number_cell(block.length, 3),
        number_cell(block.seconds, 3),
        number_cell(block.feed * MM_PER_MIN),
        number_cell(block.reached * MM_PER_MIN),
    ]


def table_note(run: ProgramRun) -> str:
    """Total time, and which blocks the table has."""
    notes = [f"{run.seconds:.3f} s in all, waiting included; a block that takes less than a cycle is not listed."]
    if len(run.blocks) > MOST_ROWS:
        notes.append(f"The first {MOST_ROWS} of {len(run.blocks)} blocks.")
    return " ".join(notes)


def program_rows(recorded: Recorded, run: ProgramRun) -> Iterator[PlotRow]:
    """Feed, and set values of each axis of the path, over time."""
    name, states = next(
        (name, rows) for name, rows in recorded.of_type(CHANNEL_STATE).items() if np.any(rows["path_velocity"])
    )
    feed = [Line("set", states, "programmed_feed", SET, MM_PER_MIN)]
    feed.append(Line("actual", states, "path_velocity", ACTUAL, MM_PER_MIN))
    yield PlotRow(name, "feed", "mm/min", feed)
    for quantity, unit in (("position", "mm"), ("velocity", "mm/s"), ("acceleration", "mm/s²"), ("jerk", "mm/s³")):
        lines = [Line(axis_label(node), recorded.states[f"/{node}/state"], f"set_{quantity}") for node in run.nodes]
        yield PlotRow("", quantity, unit, lines, legend=True)
