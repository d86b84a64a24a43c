"""A recording as a picture of panels over time, in the style of the figures of the documentation."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cnc_ptp.plots.colours import BLUE, BY_AXIS
from cnc_ptp.plots.over_time import (
    Column,
    Curve,
    Label,
    Marker,
    draw_commands,
    draw_curves,
    in_micrometres,
    keep_peaks_out,
    label_height,
    label_rows,
    write_values,
)
from cnc_ptp.plots.panels import AXIS, SPINDLE, Panel
from cnc_ptp.plots.sheet import GAP, HEADER, TITLE_OFFSET, Name, Sheet, draw_header, style_plot
from cnc_ptp.recording.command_words import brief, shortened
from cnc_ptp.recording.decimate import line_points
from cnc_ptp.recording.fields import quantity
from cnc_ptp.recording.reader import Recorded
from cnc_ptp.recording.rows import SET, Line, PlotRow

POINTS = 3000
MOST_LABEL_ROWS = 4
MOST_MARKS = 60
LETTERS = 34
OTHER = Panel(90.0, (), BLUE)
BY_QUANTITY = {quantity(field)[0]: panel for panel in (*SPINDLE.values(), *AXIS.values()) for field in panel.fields}


@dataclass(frozen=True, slots=True)
class Heading:
    """The text above the plots."""

    title: str
    caption: str


def draw_rows(recorded: Recorded, rows: Sequence[PlotRow], heading: Heading, span: Sequence[float]) -> Figure:
    """The rows one above the other; `span`: start and end in s."""
    labels = command_labels(recorded, span)
    above = label_height(labels)
    panels = [panel_of(row) for row in rows]
    sheet = Sheet(heading, above + sum(HEADER + panel.height + GAP for panel in panels))
    upper = sheet.upper
    for row, panel in zip(rows, panels, strict=True):
        room = above if row is rows[0] else 0.0
        plot = sheet.plot(upper + HEADER + room, panel.height)
        draw_row(plot, row, panel, recorded.cycle_time_ns * 1e-9, room_above=room)
        plot.set_xlim(*span)
        draw_commands(plot, labels, with_texts=row is rows[0])
        upper += HEADER + room + panel.height + GAP
    plot.tick_params(labelbottom=True)
    sheet.write_below("time in s")
    return sheet.drawing


def panel_of(row: PlotRow) -> Panel:
    """Height and colours of the quantity, as the figures have them."""
    return BY_QUANTITY.get(quantity(row.lines[0].field)[0], OTHER)


def draw_row(plot: Axes, row: PlotRow, panel: Panel, cycle_time: float, *, room_above: float) -> None:
    """Curves, header and scales of one panel."""
    lines = [(line, *line_points(line.rows["cycle"], line.rows[line.field], POINTS)) for line in row.lines]
    drawn = list(curves(row, panel, ((line, values * line.factor) for line, _, values in lines)))
    measure = row.measure
    if panel.fine and measure == "mm" and (fine := in_micrometres(drawn)):
        drawn, measure = fine, "µm"
    for curve, (_, cycles, _) in sorted(zip(drawn, lines, strict=True), key=lambda pair: pair[0].is_set):
        draw_curves(plot, cycles * cycle_time, [curve])
    style_plot(plot)
    whole = [replace(curve, values=curve.values[np.isfinite(curve.values)]) for curve in drawn]
    whole = [curve for curve in whole if len(curve.values)]
    keep_peaks_out(plot, whole)
    names = [Name(curve.name, curve.colour) for curve in drawn if curve.name]
    draw_header(plot, replace(row, measure=measure).heading, names, offset=room_above + TITLE_OFFSET)
    write_values(plot, whole, at_end=panel.at_end)


def curves(row: PlotRow, panel: Panel, lines: Iterable[tuple[Line, Column]]) -> Iterator[Curve]:
    """The colours of the quantity; one colour per unit if several share a row."""
    units: dict[int, int] = {}
    for line in row.lines:
        units.setdefault(id(line.rows), len(units))
    for line, values in lines:
        pair = BY_AXIS[units[id(line.rows)] % len(BY_AXIS)] if len(units) > 1 else panel.colours
        paired = len(row.lines) > len(units)
        is_set = line.role == SET or not paired
        yield Curve(line.name if len(row.lines) > 1 else "", values, pair.set if is_set else pair.actual, is_set)


def command_labels(recorded: Recorded, span: Sequence[float]) -> list[Label]:
    """The commands, in few rows: one without room has only its line; very many have not even that."""
    cycle_time = recorded.cycle_time_ns * 1e-9
    targets = {command.target for command in recorded.commands}
    markers = [
        Marker(
            command.cycle * cycle_time, f"{command.target}: {brief(command)}" if len(targets) > 1 else brief(command)
        )
        for command in recorded.commands
        if command.accepted
    ]
    if len({marker.time for marker in markers}) > MOST_MARKS:
        return []
    joined: dict[float, list[str]] = {}
    for marker in markers:
        joined.setdefault(marker.time, []).append(marker.text)
    short = [Marker(time, shortened(", ".join(texts), LETTERS)) for time, texts in joined.items()]
    return [
        label if label.row < MOST_LABEL_ROWS else replace(label, row=0, text="")
        for label in label_rows(short, span[0], span[1])
    ]
