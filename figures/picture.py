"""Draws a run over time: panels one above the other, as the figures of the manuals have them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cnc_ptp.machine.blocks import StatusBit
from figures.colours import BAND, BY_AXIS, FAINT, SOFT
from figures.panels import UNIT_KINDS, Panel
from figures.run import Column, FigureRun
from figures.scenario_head import FigureError, FigureScenario
from figures.sheet import (
    GAP,
    HEADER,
    LETTER,
    PLOT,
    RIGHT,
    TITLE_OFFSET,
    Name,
    Sheet,
    draw_header,
    note,
    style_plot,
    write_value,
)

LABEL_LINE = 13.0
BANDS = {StatusBit.COMPENSATING: "compensating", StatusBit.EXT_SETPOINT: "external"}
"""What is tinted, by bits of the status."""
FINE = 0.1
"""mm; what stays below is shown in µm."""
NEGLIGIBLE = 0.01
"""Of the largest lag; the rest is not waited for."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A line of a panel: its name in the panel's header, its values, its colour, and whether it is a set value."""

    name: str
    values: Column
    colour: str
    is_set: bool


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure: its panels over the time in which something happens. Raises FigureError."""
    end = shown_cycles(run)
    panels = list(chosen_panels(figure, run))
    labels = label_rows(run, end)
    label_height = LABEL_LINE * (1 + max(label.row for label in labels)) if labels else 0.0
    sheet = Sheet(figure, label_height + sum(HEADER + panel.height + GAP for _, panel in panels))
    upper = sheet.upper
    for title, panel in panels:
        first = (title, panel) == panels[0]
        room = label_height if first else 0.0
        plot = sheet.plot(upper + HEADER + room, panel.height)
        draw_panel(plot, title, run, end, room_above=room)
        draw_commands(plot, labels, with_texts=first)
        upper += HEADER + room + panel.height + GAP
    plot.tick_params(labelbottom=True)
    sheet.write_below("time in s")
    return sheet.drawing


def chosen_panels(figure: FigureScenario, run: FigureRun) -> Iterator[tuple[str, Panel]]:
    """Titles and panels in the order of the head; without a choice all that the kinds of the units usually have."""
    known: dict[str, Panel] = {}
    usual: dict[str, None] = {}
    for kind in dict.fromkeys(unit.kind for unit in run.units.values()):
        known = {**UNIT_KINDS[kind].panels, **known}
        usual |= dict.fromkeys(UNIT_KINDS[kind].usual)
    for title in figure.panels or usual:
        if title not in known:
            raise FigureError(figure.path, f"panel '{title}' does not exist, known are {', '.join(known)}")
        yield title, known[title]


def shown_cycles(run: FigureRun) -> int:
    """How many cycles are shown: until everything stands and all is commanded, and a little longer, lags included."""
    moving = [np.flatnonzero(run.motion(unit)) for unit in run.columns]
    events = [int(cycles[-1]) for cycles in moving if len(cycles)]
    events += [round(marker.time / run.cycle_time) for marker in run.markers]
    settled = max(last_above(run.following_error(unit), NEGLIGIBLE) for unit in run.columns)
    return min(run.cycles, max(round(max(events, default=run.cycles) * 1.04), settled) + 1)


def last_above(values: Column, part: float) -> int:
    """The last cycle in which a value is above a part of the largest one."""
    sizes = np.abs(values)
    return int(np.flatnonzero(sizes >= part * sizes.max())[-1])


# commands


@dataclass(frozen=True, slots=True)
class Label:
    """What was commanded at one moment (s); `row` is counted upwards from the panel, so that no two overlap."""

    time: float
    text: str
    row: int
    at_left: bool
    """Of its line, where the right edge is near."""


def label_rows(run: FigureRun, end: int) -> list[Label]:
    """The commands of each moment in the lowest row that has room."""
    texts: dict[float, list[str]] = {}
    for marker in run.markers:
        texts.setdefault(marker.time, []).append(marker.text)
    labels: list[Label] = []
    row_ends: list[float] = []
    for time, words in texts.items():
        place, text = PLOT * time / ((end - 1) * run.cycle_time), ", ".join(words)
        length = LETTER * len(text) + 12.0
        at_left = place + length > PLOT + RIGHT
        begin = place - length if at_left else place
        row = next((row for row, row_end in enumerate(row_ends) if begin >= row_end), len(row_ends))
        row_ends[row : row + 1] = [begin + length]
        labels.append(Label(time, text, row, at_left))
    return labels


def draw_commands(plot: Axes, labels: Iterable[Label], *, with_texts: bool) -> None:
    """A line down through the panel for each command; in the first panel it reaches up to its text."""
    for label in labels:
        plot.axvline(label.time, color=FAINT, linewidth=0.9, dashes=(3, 2), zorder=0.6)
        if not with_texts:
            continue
        top, at = 3.0 + label.row * LABEL_LINE, (label.time, 1.0)
        across, side = (-4.0, "right") if label.at_left else (4.0, "left")
        note(plot, label.text, at, (across, top), of=("data", "axes fraction"), ha=side)
        dashes = {"color": FAINT, "linewidth": 0.9, "linestyle": (0, (3, 2)), "shrinkA": 0, "shrinkB": 0}
        note(plot, "", at, (0.0, top + 8.0), of=("data", "axes fraction"), arrowprops={"arrowstyle": "-", **dashes})


# panels


def draw_panel(plot: Axes, title: str, run: FigureRun, end: int, *, room_above: float) -> None:
    """Curves, header and scales of one panel; the first one has room for the texts of commands above it."""
    time = run.time[:end]
    drawn, unit = fine_unit(title, run, list(curves(title, run, end)))
    for curve in sorted(drawn, key=lambda curve: curve.is_set):
        width = 1.4 if curve.is_set else 3.2
        plot.plot(time, curve.values, color=curve.colour, linewidth=width, solid_joinstyle="round")
    _, panel = next(drawn_panels(title, run))
    if panel.with_override:
        draw_override(plot, run, end, drawn)
    style_plot(plot)
    plot.set_xlim(time[0], time[-1])
    keep_peaks_out(plot, drawn)
    draw_bands(plot, run, end, with_texts=room_above > 0.0)
    names = [Name(curve.name, curve.colour) for curve in drawn]
    draw_header(plot, f"{title} in {unit}", names, offset=room_above + TITLE_OFFSET)
    write_values(plot, drawn, at_end=panel.at_end)


def drawn_panels(title: str, run: FigureRun) -> Iterator[tuple[str, Panel]]:
    """The units that have a panel of this title, each with it."""
    for name, unit in run.units.items():
        panel = UNIT_KINDS[unit.kind].panels.get(title)
        if panel is not None:
            yield name, panel


def curves(title: str, run: FigureRun, end: int) -> Iterator[Curve]:
    """The lines of a panel; several units have a colour each and are named."""
    units = list(run.columns)
    several = len(units) > 1
    for name, panel in drawn_panels(title, run):
        colours = BY_AXIS[units.index(name) % len(BY_AXIS)] if several else panel.colours
        for field, word, colour in zip(panel.fields, ("set", "actual"), colours, strict=False):
            words = [name if several else "", word if len(panel.fields) > 1 else ""]
            yield Curve(" ".join(filter(None, words)), run.column(name, field)[:end], colour, word == "set")


def fine_unit(title: str, run: FigureRun, drawn: list[Curve]) -> tuple[list[Curve], str]:
    """The curves and their unit; where a panel may, small ways in µm."""
    units = [run.units[name].shown(panel.unit) for name, panel in drawn_panels(title, run)]
    fine = all(panel.fine for _, panel in drawn_panels(title, run)) and set(units) == {"mm"}
    if not fine or any(np.abs(curve.values).max() >= FINE for curve in drawn):
        return drawn, " or ".join(dict.fromkeys(units))
    return [Curve(curve.name, 1000.0 * curve.values, curve.colour, curve.is_set) for curve in drawn], "µm"


def draw_override(plot: Axes, run: FigureRun, end: int, drawn: list[Curve]) -> None:
    """Override as the velocity that it asks for, where it is not 100 % all the time (one unit only)."""
    percent = run.column(next(iter(run.columns)), "override_percent")[:end]
    if len(run.columns) > 1 or np.all(percent == 100.0):
        return
    highest = max(float(np.max(np.abs(curve.values))) for curve in drawn)
    level = percent * (highest / float(percent.max()))
    steps = np.flatnonzero(np.diff(percent, prepend=-1.0))
    shown = level.copy()
    shown[steps[1:]] = np.nan  # the line of the command stands there
    plot.plot(run.time[:end], shown, color=SOFT, linewidth=1.0, dashes=(5, 3), zorder=1)
    for cycle in steps:
        from_above = max(abs(curve.values[cycle]) for curve in drawn) > level[cycle]  # then the text stands below
        below, side = (-4.0, "top") if from_above else (3.0, "baseline")
        note(plot, f"override {percent[cycle]:g} %", (run.time[cycle], level[cycle]), (5.0, below), va=side)


def draw_bands(plot: Axes, run: FigureRun, end: int, *, with_texts: bool) -> None:
    """A tint where the status of an axis says that something else acts on it."""
    for name in (name for name, unit in run.units.items() if unit.kind == "axis"):
        bits = run.column(name, "status_bits")[:end].astype(np.int64)
        for bit, text in BANDS.items():
            edges = np.flatnonzero(np.diff((bits & bit) != 0, prepend=False, append=False))
            for first, behind in edges.reshape(-1, 2):
                begin = run.time[first]
                end_time = begin + (behind - first) * run.cycle_time
                plot.axvspan(begin, end_time, color=BAND, linewidth=0.0, zorder=0.1)
                if with_texts:
                    note(plot, text, (begin, 1.0), (5.0, -12.0), of=("data", "axes fraction"))


def keep_peaks_out(plot: Axes, drawn: list[Curve]) -> None:
    """Where an actual value shoots far beyond all set values (a step of velocity), their scale is kept."""
    sets = [curve.values for curve in drawn if curve.is_set]
    if not sets:
        return
    low, high = min(0.0, *map(np.min, sets)), max(0.0, *map(np.max, sets))
    bottom, top = plot.get_ylim()
    if top - bottom > 3.0 * (high - low) > 0.0:
        plot.set_ylim(low - 0.15 * (high - low), high + 0.15 * (high - low))


def write_values(plot: Axes, drawn: list[Curve], *, at_end: bool) -> None:
    """At the right: where the axis ends, or the highest and lowest set value."""
    low, high = plot.get_ylim()
    written: list[float] = []
    for curve in (curve for curve in drawn if curve.is_set):
        last = float(curve.values[-1])
        for value in [last] if at_end else [float(curve.values.max()), float(curve.values.min())]:
            near = any(abs(value - other) < 0.1 * (high - low) for other in written)
            if near or (not at_end and abs(value) < 0.02 * (high - low)):
                continue
            written.append(value)
            write_value(plot, value, curve.colour)
