"""A fitted acceleration curve as SVG or PNG."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from cnc_ptp.commands.commissioning.curve_report import RPM, drawn_curve, title
from cnc_ptp.commands.picture_file import COLOURS, picture_bytes
from cnc_ptp.commissioning.curve_fit import CurveFit
from cnc_ptp.plots.colours import EDGE, INK, SOFT


def curve_picture(fit: CurveFit, kind: str) -> bytes:
    """The picture as the bytes of an `svg` or `png` file, the same for the same fit."""
    return picture_bytes(draw_curve(fit), kind, title=title(fit))


def draw_curve(fit: CurveFit) -> Figure:
    """Acceleration over speed: the curve as the spindle has it, the points, limit speed and floor."""
    figure = Figure(figsize=(8.0, 5.2), facecolor="white", layout="constrained")
    axes = figure.add_subplot()
    axes.plot(*drawn_curve(fit), color=COLOURS[0], linewidth=1.8, label=fit.parameters.kind)
    speeds, accelerations = zip(*fit.points, strict=True)
    axes.plot(speeds, accelerations, linestyle="none", marker="o", color=COLOURS[1], label="points", zorder=3)
    axes.axvline(fit.parameters.limit_speed, color=SOFT, linewidth=0.9, dashes=(5, 3), label="n_grenz")
    if fit.parameters.minimum:
        axes.axhline(fit.parameters.minimum, color=COLOURS[3], linewidth=0.9, dashes=(2, 2), label="a_min")
    axes.set_xlim(0.0, 1.02 * fit.top_speed)
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    axes.set_xlabel("speed in °/s", color=SOFT)
    axes.set_ylabel("acceleration in °/s²", color=SOFT)
    above = axes.secondary_xaxis("top", functions=(in_rpm, in_deg_s))
    above.set_xlabel("speed in rpm", color=SOFT)
    for scale in (axes, above):
        scale.tick_params(colors=SOFT, labelsize=9)
        scale.spines[:].set_color(EDGE)
    axes.grid(color=EDGE, linewidth=0.8)
    axes.legend(frameon=False, labelcolor=INK)
    figure.suptitle(title(fit), color=INK, fontsize=12, fontweight="bold")
    return figure


def in_rpm(speed: Any) -> Any:
    """°/s, a number or an array."""
    return speed / RPM


def in_deg_s(speed: Any) -> Any:
    """rpm, a number or an array."""
    return speed * RPM
