"""The polar plot of a circle test as SVG or PNG, drawn by matplotlib."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes

from cnc_ptp.commands.commissioning.circle_report import (
    UM,
    CircleTest,
    VariantResult,
    direction_name,
    magnification_for,
)
from cnc_ptp.commands.picture_file import COLOURS, picture_bytes
from cnc_ptp.commissioning.roundness import CircleResult
from cnc_ptp.plots.colours import EDGE, INK, SOFT

OUTSIDE = -0.35
"""How far the scale goes outwards, over how far it goes inwards."""
MOST_POINTS = 4000
"""Of a curve: no eye and no printer tells more."""


def circle_picture(test: CircleTest, magnification: float | None, kind: str) -> bytes:
    """The picture as the bytes of an `svg` or `png` file, the same for the same test."""
    return picture_bytes(draw_circle(test, magnification), kind, title=test.title)


def draw_circle(test: CircleTest, magnification: float | None = None) -> Figure:
    """Deviations over the angle, magnified: the middle lies at -R / magnification, the nominal circle at 0."""
    magnified = magnification or magnification_for(test)
    figure = Figure(figsize=(8.0, 8.6 + 0.22 * len(test.results)), facecolor="white", layout="constrained")
    axes: Any = figure.add_subplot(projection="polar")
    _scale(axes, test, magnified)
    for number, result in enumerate(test.results):
        for circle in result.circles:
            _curve(axes, result, circle, COLOURS[number % len(COLOURS)])
    figure.suptitle(test.title, color=INK, fontsize=12, fontweight="bold")
    axes.set_title(f"deviations magnified {magnified:g} times, in µm", color=SOFT, fontsize=9, pad=14)
    legend = figure.legend(loc="outside lower center", ncols=1, frameon=False, fontsize=9)
    for text in legend.get_texts():
        text.set_color(INK)
    return figure


def _scale(axes: PolarAxes, test: CircleTest, magnification: float) -> None:
    low = -UM * test.radius / magnification
    axes.set_rlim(low, OUTSIDE * low)
    axes.set_rgrids(_ticks(low), color=SOFT, fontsize=8)
    axes.set_rlabel_position(67.5)
    axes.plot(np.linspace(0.0, 2.0 * np.pi, 361), np.zeros(361), color=INK, linewidth=0.8, dashes=(5, 3), zorder=5)
    names = [f"+{test.axes[0]}", f"+{test.axes[1]}", f"-{test.axes[0]}", f"-{test.axes[1]}"]
    axes.set_thetagrids((0, 45, 90, 135, 180, 225, 270, 315), [names[n // 2] if n % 2 == 0 else "" for n in range(8)])
    axes.tick_params(axis="x", colors=INK)
    axes.grid(color=EDGE, linewidth=0.8)
    axes.spines["polar"].set_visible(False)


def _ticks(low: float) -> list[float]:
    """Up to eleven round values from the middle to a little outside of the nominal circle, 0 among them."""
    step = 10.0 ** np.floor(np.log10(-low / 2.0))
    step *= next(factor for factor in (1.0, 2.0, 5.0, 10.0) if -low / (factor * step) <= 8.0)
    return [float(step * n) for n in range(int(np.ceil(low / step)) + 1, int(np.floor(OUTSIDE * low / step)) + 1)]


def _curve(axes: PolarAxes, result: VariantResult, circle: CircleResult, colour: str) -> None:
    order = np.argsort(circle.angles, kind="stable")
    angles = np.radians(circle.angles[order])
    deviations = UM * circle.deviations[order]
    chosen = np.unique(np.linspace(0, len(order) - 1, min(len(order), MOST_POINTS)).astype(int))
    closed = np.append(chosen, chosen[0])
    turned = angles[closed]
    turned[-1] += 2.0 * np.pi
    axes.plot(
        turned,
        deviations[closed],
        color=colour,
        linewidth=1.2,
        linestyle="--" if circle.clockwise else "-",
        label=f"{result.variant.name}, {direction_name(circle)}: G {UM * circle.circular_deviation:.2f} µm, "
        f"largest peak {UM * circle.largest_peak:.2f} µm",
    )
