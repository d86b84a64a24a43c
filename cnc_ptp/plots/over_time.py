"""Curves over time as the figures of the manuals have them: their lines, values at the right, commands above."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes

from cnc_ptp.plots.colours import FAINT
from cnc_ptp.plots.sheet import LETTER, PLOT, RIGHT, note, write_value

Column = npt.NDArray[np.float64]
LABEL_LINE = 13.0
FINE = 0.1
"""mm; smaller values are shown in µm."""


@dataclass(frozen=True, slots=True)
class Marker:
    """A command that took effect, or an error that is shown: time (s) and text."""

    time: float
    text: str


@dataclass(frozen=True, slots=True)
class Curve:
    """A line of a panel: its name in the panel's header, its values, its colour, and whether it is a set value."""

    name: str
    values: Column
    colour: str
    is_set: bool


@dataclass(frozen=True, slots=True)
class Label:
    """The commands of one moment (s); `row` is counted upwards from the panel, so that no two overlap."""

    time: float
    text: str
    row: int
    at_left: bool
    """Distance of a label from its line near the right edge."""


def label_rows(markers: Iterable[Marker], begin: float, end: float) -> list[Label]:
    """The commands of each moment in the lowest row that has room; `begin`, `end`: of the plot in s."""
    texts: dict[float, list[str]] = {}
    for marker in markers:
        texts.setdefault(marker.time, []).append(marker.text)
    labels: list[Label] = []
    row_ends: list[float] = []
    for time, words in texts.items():
        place, text = PLOT * (time - begin) / (end - begin), ", ".join(words)
        length = LETTER * len(text) + 12.0
        at_left = place + length > PLOT + RIGHT
        left = place - length if at_left else place
        row = next((row for row, row_end in enumerate(row_ends) if left >= row_end), len(row_ends))
        row_ends[row : row + 1] = [left + length]
        labels.append(Label(time, text, row, at_left))
    return labels


def label_height(labels: Sequence[Label]) -> float:
    """Room that labels take above the first panel."""
    return LABEL_LINE * (1 + max(label.row for label in labels)) if labels else 0.0


def draw_commands(plot: Axes, labels: Iterable[Label], *, with_texts: bool) -> None:
    """A line down through the panel for each command; in the first panel it reaches up to its text."""
    for label in labels:
        plot.axvline(label.time, color=FAINT, linewidth=0.9, dashes=(3, 2), zorder=0.6)
        if not with_texts or not label.text:
            continue
        top, at = 3.0 + label.row * LABEL_LINE, (label.time, 1.0)
        across, side = (-4.0, "right") if label.at_left else (4.0, "left")
        note(plot, label.text, at, (across, top), of=("data", "axes fraction"), ha=side)
        dashes: dict[str, Any] = {
            "color": FAINT,
            "linewidth": 0.9,
            "linestyle": (0, (3, 2)),
            "shrinkA": 0,
            "shrinkB": 0,
        }
        note(plot, "", at, (0.0, top + 8.0), of=("data", "axes fraction"), arrowprops={"arrowstyle": "-", **dashes})


def draw_curves(plot: Axes, time: Column, drawn: Iterable[Curve]) -> None:
    """Set values thin above their actual values."""
    for curve in sorted(drawn, key=lambda curve: curve.is_set):
        width = 1.4 if curve.is_set else 3.2
        plot.plot(time, curve.values, color=curve.colour, linewidth=width, solid_joinstyle="round")


def in_micrometres(drawn: Sequence[Curve]) -> list[Curve] | None:
    """The curves in µm where all of them stay below FINE mm, otherwise None."""
    if any(np.abs(curve.values).max() >= FINE for curve in drawn):
        return None
    return [replace(curve, values=1000.0 * curve.values) for curve in drawn]


def keep_peaks_out(plot: Axes, drawn: Iterable[Curve]) -> None:
    """Where an actual value shoots far beyond all set values (a step of velocity), their scale is kept."""
    sets = [curve.values for curve in drawn if curve.is_set]
    if not sets:
        return
    low, high = min(0.0, *map(np.min, sets)), max(0.0, *map(np.max, sets))
    bottom, top = plot.get_ylim()
    if top - bottom > 3.0 * (high - low) > 0.0:
        plot.set_ylim(low - 0.15 * (high - low), high + 0.15 * (high - low))


def write_values(plot: Axes, drawn: Iterable[Curve], *, at_end: bool) -> None:
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
