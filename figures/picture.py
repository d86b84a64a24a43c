"""Draws a run over time: panels one above the other, as the figures of the manuals have them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cnc_ptp.plots import over_time
from cnc_ptp.plots.colours import BAND, BY_AXIS, SOFT
from cnc_ptp.plots.over_time import (
    Curve,
    Label,
    draw_commands,
    draw_curves,
    in_micrometres,
    keep_peaks_out,
    label_height,
    write_values,
)
from cnc_ptp.plots.panels import UNIT_KINDS, Panel
from cnc_ptp.plots.sheet import (
    GAP,
    HEADER,
    TITLE_OFFSET,
    Name,
    Sheet,
    draw_header,
    note,
    style_plot,
)
from cnc_ptp.protocol.axis_states import StatusBit
from figures.run import Column, FigureRun
from figures.scenario_head import FigureError, FigureScenario
from figures.signals import draw_signals
from figures.signals import height as signal_height

BANDS = {StatusBit.COMPENSATING: "compensating", StatusBit.EXT_SETPOINT: "external"}
"""Tints by bits of the status."""
NEGLIGIBLE = 0.01
"""Part of the largest lag that is not waited for."""


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure: its panels over the time in which something happens. Raises FigureError."""
    end = shown_cycles(run)
    panels = list(chosen_panels(figure, run))
    labels = label_rows(run, end)
    above = label_height(labels)
    signals = HEADER + signal_height(run) + GAP if run.signals else 0.0
    sheet = Sheet(figure, above + sum(HEADER + panel.height + GAP for _, panel in panels) + signals)
    upper = sheet.upper
    for title, panel in panels:
        first = (title, panel) == panels[0]
        room = above if first else 0.0
        plot = sheet.plot(upper + HEADER + room, panel.height)
        draw_panel(plot, title, run, end, room_above=room)
        draw_commands(plot, labels, with_texts=first)
        upper += HEADER + room + panel.height + GAP
    if run.signals:
        plot = sheet.plot(upper + HEADER, signal_height(run))
        draw_signals(plot, run, end)
        draw_commands(plot, labels, with_texts=False)
    plot.tick_params(labelbottom=True)
    sheet.write_below("time in s")
    return sheet.drawing


def chosen_panels(figure: FigureScenario, run: FigureRun) -> Iterator[tuple[str, Panel]]:
    """Titles and panels in the order of the head; without a choice all usual ones of the kinds of the units."""
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
    """Number of cycles shown: until all is commanded and at a standstill, and a little longer, lags included."""
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


def label_rows(run: FigureRun, end: int) -> list[Label]:
    """The commands of each moment in the lowest row that has room."""
    return over_time.label_rows(run.markers, 0.0, (end - 1) * run.cycle_time)


# panels


def draw_panel(plot: Axes, title: str, run: FigureRun, end: int, *, room_above: float) -> None:
    """Curves, header and scales of one panel; the first one has room for the texts of commands above it."""
    time = run.time[:end]
    drawn, unit = fine_unit(title, run, list(curves(title, run, end)))
    draw_curves(plot, time, drawn)
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
    """The curves and their unit; small distances in µm if the panel permits."""
    units = [run.units[name].unit_of(panel.fields[0]) for name, panel in drawn_panels(title, run)]
    fine = all(panel.fine for _, panel in drawn_panels(title, run)) and set(units) == {"mm"}
    micrometres = in_micrometres(drawn) if fine else None
    return (drawn, " or ".join(dict.fromkeys(units))) if micrometres is None else (micrometres, "µm")


def draw_override(plot: Axes, run: FigureRun, end: int, drawn: list[Curve]) -> None:
    """Override as the velocity that it asks for, if it is not 100 % all the time (one unit only)."""
    percent = run.column(next(iter(run.columns)), "override_percent")[:end]
    if len(run.columns) > 1 or np.all(percent == 100.0):
        return
    highest = max(float(np.max(np.abs(curve.values))) for curve in drawn)
    level = percent * (highest / float(percent.max()))
    steps = np.flatnonzero(np.diff(percent, prepend=-1.0))
    shown = level.copy()
    shown[steps[1:]] = np.nan  # the line of the command is there
    plot.plot(run.time[:end], shown, color=SOFT, linewidth=1.0, dashes=(5, 3), zorder=1)
    for cycle in steps:
        from_above = max(abs(curve.values[cycle]) for curve in drawn) > level[cycle]  # then the text is below
        below, side = (-4.0, "top") if from_above else (3.0, "baseline")
        note(plot, f"override {percent[cycle]:g} %", (run.time[cycle], level[cycle]), (5.0, below), va=side)


def draw_bands(plot: Axes, run: FigureRun, end: int, *, with_texts: bool) -> None:
    """A tint where the status of an axis shows that something else acts on it."""
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
