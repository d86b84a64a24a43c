"""Draws a run: panels one above the other over time, as the figures of the PTP manual have them."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch
from matplotlib.ticker import MaxNLocator

from cnc_ptp.machine.blocks import StatusBit
from figures.colours import BAND, BLUE, BY_AXIS, EDGE, FAINT, GREEN, GRID, INK, PAPER, RED, SOFT, YELLOW, Pair
from figures.run import Column, FigureRun
from figures.scenario_head import FigureScenario

POINTS_PER_INCH = 72
WIDTH, LEFT, RIGHT = 800.0, 66.0, 66.0
TITLE, CAPTION_LINE, LABEL_LINE, HEADER, GAP, BOTTOM = 40.0, 15.0, 13.0, 32.0, 4.0, 42.0
"""Points."""
TEXT_LEFT, PLOT = 22.0, WIDTH - LEFT - RIGHT
CAPTION_LETTERS = 140
SMALL, NORMAL, LARGE = 8.5, 9.5, 14.0
LETTER = 5.0
"""Width of a small letter, generously: nothing is placed by measured text, so viewers may have other fonts."""


@dataclass(frozen=True, slots=True)
class Panel:
    """One panel: its title, what follows the unit of the axis, its height in points, its fields and their colours.

    `fields` are set value and actual value, or one value alone. `at_end`: the last value is written at the right, and
    not the extremes.
    """

    title: str
    per: str
    height: float
    fields: tuple[str, ...]
    colours: Pair
    at_end: bool = False


POSITION = Panel("position", "", 110.0, ("set_position", "actual_position"), BLUE, at_end=True)
VELOCITY = Panel("velocity", "/s", 130.0, ("set_velocity", "actual_velocity"), GREEN)
ACCELERATION = Panel("acceleration", "/s²", 110.0, ("set_acceleration", "actual_acceleration"), RED)
FOLLOWING_ERROR = Panel("following error", "", 80.0, ("following_error",), YELLOW)
PANELS = (POSITION, VELOCITY, ACCELERATION, FOLLOWING_ERROR)
BANDS = {StatusBit.COMPENSATING: "compensating", StatusBit.EXT_SETPOINT: "external"}
"""What is tinted, by bits of the status."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A line of a panel: its name in the panel's header, its values, its colour, and whether it is a set value."""

    name: str
    values: Column
    colour: str
    is_set: bool


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure."""
    end = shown_cycles(run)
    caption = wrapped(figure.caption)
    labels = label_rows(run, end)
    label_height = LABEL_LINE * (1 + max(label.row for label in labels)) if labels else 0.0
    upper = TITLE + CAPTION_LINE * len(caption)
    height = upper + label_height + sum(HEADER + panel.height + GAP for panel in PANELS) + BOTTOM
    drawing = Figure(figsize=(WIDTH / POINTS_PER_INCH, height / POINTS_PER_INCH), dpi=POINTS_PER_INCH, facecolor="none")
    draw_card(drawing, height)
    write(drawing, TEXT_LEFT, 32.0, figure.title, colour=INK, size=LARGE, weight="bold")
    for number, line in enumerate(caption, start=1):
        write(drawing, TEXT_LEFT, TITLE - 3.0 + number * CAPTION_LINE, line, colour=SOFT)
    for panel in PANELS:
        room = label_height if panel is PANELS[0] else 0.0
        lower = upper + HEADER + room + panel.height
        axes = drawing.add_axes((LEFT / WIDTH, 1.0 - lower / height, PLOT / WIDTH, panel.height / height))
        draw_panel(axes, panel, run, end, header_offset=room + 7.0)
        draw_commands(axes, labels, with_texts=panel is PANELS[0])
        upper = lower + GAP
    axes.tick_params(labelbottom=True)
    write(drawing, LEFT + 0.5 * PLOT, height - 17.0, "time in s", colour=SOFT, align="center")
    return drawing


def wrapped(caption: str) -> list[str]:
    """The lines of a caption; 'J = 50000 mm/s³' and '75 %' stay together."""
    return textwrap.wrap(re.sub(r"(?<=\d) (?=mm|deg|s\b|%)| (?==)|(?<==) ", "\u00a0", caption), CAPTION_LETTERS)


def shown_cycles(run: FigureRun) -> int:
    """How many cycles are shown: until everything stands and all is commanded, and a little longer."""
    moving = [np.flatnonzero(run.column(axis, "set_velocity")) for axis in run.columns]
    events = [int(cycles[-1]) for cycles in moving if len(cycles)]
    events += [round(marker.time / run.cycle_time) for marker in run.markers]
    return min(run.cycles, round(max(events, default=run.cycles) * 1.04) + 1)


def draw_card(drawing: Figure, height: float) -> None:
    """The sheet below everything: the figure brings its own background, whatever page it stands on."""
    inset, corner = 1.0 / POINTS_PER_INCH, 10.0 / POINTS_PER_INCH
    width, tall = WIDTH / POINTS_PER_INCH - 2 * inset, height / POINTS_PER_INCH - 2 * inset
    shape = f"round,pad=0,rounding_size={corner}"
    card = FancyBboxPatch((inset, inset), width, tall, boxstyle=shape, facecolor=PAPER, edgecolor=EDGE, linewidth=1.0)
    card.set_transform(drawing.dpi_scale_trans)
    card.set_zorder(-10)
    drawing.add_artist(card)


def write(
    drawing: Figure,
    x: float,
    y: float,
    words: str,
    *,
    colour: str,
    size: float = NORMAL,
    weight: str = "normal",
    align: str = "left",
) -> None:
    """Text at `x`, `y` in points from the upper left corner."""
    height = drawing.get_size_inches()[1] * POINTS_PER_INCH
    drawing.text(x / WIDTH, 1.0 - y / height, words, color=colour, fontsize=size, fontweight=weight, ha=align)


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


def draw_commands(axes: Axes, labels: Iterable[Label], *, with_texts: bool) -> None:
    """A line down through the panel for each command; in the first panel it reaches up to its text."""
    for label in labels:
        axes.axvline(label.time, color=FAINT, linewidth=0.9, dashes=(3, 2), zorder=0.6)
        if not with_texts:
            continue
        top = 3.0 + label.row * LABEL_LINE
        axes.annotate(
            label.text,
            (label.time, 1.0),
            (-4.0 if label.at_left else 4.0, top),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            ha="right" if label.at_left else "left",
            color=SOFT,
            fontsize=SMALL,
        )
        axes.annotate(
            "",
            (label.time, 1.0),
            (0.0, top + 8.0),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            arrowprops={
                "arrowstyle": "-",
                "color": FAINT,
                "linewidth": 0.9,
                "linestyle": (0, (3, 2)),
                "shrinkA": 0,
                "shrinkB": 0,
            },
        )


# panels


def draw_panel(axes: Axes, panel: Panel, run: FigureRun, end: int, *, header_offset: float) -> None:
    """Curves, header and scales of one panel."""
    time = run.time[:end]
    drawn = list(curves(panel, run, end))
    for curve in sorted(drawn, key=lambda curve: curve.is_set):
        axes.plot(
            time, curve.values, color=curve.colour, linewidth=1.4 if curve.is_set else 3.2, solid_joinstyle="round"
        )
    if panel is VELOCITY:
        draw_override(axes, run, end, drawn)
    style_axes(axes, time)
    keep_peaks_out(axes, drawn)
    draw_bands(axes, run, end, with_texts=panel is POSITION)
    draw_header(axes, panel, run, drawn, header_offset)
    write_values(axes, panel, drawn)


def curves(panel: Panel, run: FigureRun, end: int) -> Iterable[Curve]:
    """The lines of a panel; several axes have a colour each and are named."""
    several = len(run.columns) > 1
    for number, axis in enumerate(run.columns):
        colours = BY_AXIS[number % len(BY_AXIS)] if several else panel.colours
        for field, name, colour in zip(panel.fields, ("set", "actual"), colours, strict=False):
            words = [axis if several else "", name if len(panel.fields) > 1 else ""]
            yield Curve(" ".join(filter(None, words)), run.column(axis, field)[:end], colour, name == "set")


def draw_override(axes: Axes, run: FigureRun, end: int, drawn: list[Curve]) -> None:
    """Override as the velocity that it asks for, where it is not 100 % all the time (one axis only)."""
    percent = run.column(next(iter(run.columns)), "override_percent")[:end]
    if len(run.columns) > 1 or np.all(percent == 100.0):
        return
    highest = max(float(np.max(np.abs(curve.values))) for curve in drawn)
    level = percent * (highest / float(percent.max()))
    steps = np.flatnonzero(np.diff(percent, prepend=-1.0))
    shown = level.copy()
    shown[steps[1:]] = np.nan  # the line of the command stands there
    axes.plot(run.time[:end], shown, color=SOFT, linewidth=1.0, dashes=(5, 3), zorder=1)
    for cycle in steps:
        from_above = max(abs(curve.values[cycle]) for curve in drawn) > level[cycle]  # then the text stands below
        axes.annotate(
            f"override {percent[cycle]:g} %",
            (run.time[cycle], level[cycle]),
            (5.0, -4.0 if from_above else 3.0),
            textcoords="offset points",
            va="top" if from_above else "baseline",
            color=SOFT,
            fontsize=SMALL,
        )


def draw_bands(axes: Axes, run: FigureRun, end: int, *, with_texts: bool) -> None:
    """A tint where the status of an axis says that something else acts on it."""
    for axis in run.columns:
        bits = run.column(axis, "status_bits")[:end].astype(np.int64)
        for bit, text in BANDS.items():
            edges = np.flatnonzero(np.diff((bits & bit) != 0, prepend=False, append=False))
            for first, behind in edges.reshape(-1, 2):
                begin = run.time[first]
                axes.axvspan(begin, begin + (behind - first) * run.cycle_time, color=BAND, linewidth=0.0, zorder=0.1)
                if with_texts:
                    axes.annotate(
                        text,
                        (begin, 1.0),
                        (5.0, -12.0),
                        xycoords=("data", "axes fraction"),
                        textcoords="offset points",
                        color=SOFT,
                        fontsize=SMALL,
                    )


def style_axes(axes: Axes, time: Column) -> None:
    """Scales: a light grid, no frame."""
    axes.patch.set_visible(False)
    axes.set_xlim(time[0], time[-1])
    axes.margins(y=0.1)
    axes.grid(color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    axes.xaxis.set_major_locator(MaxNLocator(10, steps=[1, 2, 2.5, 5, 10]))
    axes.axhline(0.0, color=FAINT, linewidth=0.8, zorder=0.5)
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0, labelsize=SMALL, labelcolor=SOFT, labelbottom=False, pad=5)


def keep_peaks_out(axes: Axes, drawn: list[Curve]) -> None:
    """Where an actual value shoots far beyond all set values (a step of velocity), their scale is kept."""
    sets = [curve.values for curve in drawn if curve.is_set]
    if not sets:
        return
    low, high = min(0.0, *map(np.min, sets)), max(0.0, *map(np.max, sets))
    bottom, top = axes.get_ylim()
    if top - bottom > 3.0 * (high - low) > 0.0:
        axes.set_ylim(low - 0.15 * (high - low), high + 0.15 * (high - low))


def draw_header(axes: Axes, panel: Panel, run: FigureRun, drawn: list[Curve], offset: float) -> None:
    """Title with unit at the left, names of the curves in their colours at the right."""
    units = " or ".join(f"{unit}{panel.per}" for unit in dict.fromkeys(run.units.values()))
    axes.annotate(
        f"{panel.title} in {units}",
        (0.0, 1.0),
        (0.0, offset),
        xycoords="axes fraction",
        textcoords="offset points",
        color=INK,
        fontsize=NORMAL,
        fontweight="bold",
    )
    right = 0.0
    for curve in reversed(drawn):
        axes.annotate(
            curve.name,
            (1.0, 1.0),
            (right, offset),
            xycoords="axes fraction",
            textcoords="offset points",
            ha="right",
            color=curve.colour,
            fontsize=SMALL,
            fontweight="bold",
        )
        right -= LETTER * len(curve.name) + 10.0


def write_values(axes: Axes, panel: Panel, drawn: list[Curve]) -> None:
    """At the right: where the axis ends, or the highest and lowest set value."""
    low, high = axes.get_ylim()
    written: list[float] = []
    for curve in drawn:
        if not curve.is_set:
            continue
        last = float(curve.values[-1])
        for value in [last] if panel.at_end else [float(curve.values.max()), float(curve.values.min())]:
            near = any(abs(value - other) < 0.1 * (high - low) for other in written)
            if near or (not panel.at_end and abs(value) < 0.02 * (high - low)):
                continue
            written.append(value)
            axes.annotate(
                number(value),
                (1.0, value),
                (6.0, 0.0),
                xycoords=("axes fraction", "data"),
                textcoords="offset points",
                color=curve.colour,
                fontsize=SMALL,
                fontweight="bold",
                va="center_baseline",
            )


def number(value: float) -> str:
    """To a tenth, small values to a hundredth, without zeros behind, with a minus sign as the scales have it."""
    rounded = round(value, 1 if abs(value) >= 100.0 else 2) + 0.0
    return f"{rounded:.2f}".rstrip("0").rstrip(".").replace("-", "−")
