"""Acceleration over speed: spindles in a run, against the laws of their acceleration curves.

The head may say over what the curve is drawn and which interpolation points are marked (°/s:°/s²):

    # over: n - n_limit
    # points: 12000:16000, 24000:8000

Source: TF5200 spindle, figures 15 to 21.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from cnc_ptp.commissioning.curve_points import CurvePoint, parse_point
from cnc_ptp.errors import CncError
from cnc_ptp.parameters import CurveParameters
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.plots.colours import BLUE, FAINT, INK, RED, SOFT
from cnc_ptp.plots.sheet import HEADER, LEFT, PLOT, Name, Sheet, draw_header, note, style_plot
from cnc_ptp.spindle.acceleration_curves import raw_pieces
from figures.run import Column, FigureRun
from figures.scenario_head import FigureError, FigureScenario

HEIGHT, BETWEEN = 300.0, 56.0
PLACES = 300
"""Of a drawn law."""
SMALL_STEP = 40.0
"""°/s between two drawn cycles: finer than anybody sees."""


class Scale(NamedTuple):
    """The scale of a curve: the place of a speed, given the limit speed, and where the scale begins."""

    place: Callable[[Any, float], Any]
    words: str
    begin: float


SCALES: Mapping[str, Scale] = {
    "n": Scale(lambda speed, limit: speed, "speed n in deg/s", 0.0),
    "n - n_limit": Scale(lambda speed, limit: speed - limit, "speed above the limit n − n_limit in deg/s", 0.0),
    "n / n_limit": Scale(lambda speed, limit: speed / limit, "relative speed n / n_limit", 1.0),
}
RUN_UP, BRAKING = 1.0, -1.0
NAMES = (Name("run-up", BLUE.actual), Name("braking", BLUE.set), Name("law", INK))
CONSTANT = {"hyperbola": "a_const", "polynomial": "a_const", "asynchronous": "a_max"}


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure with spindles that turn on a curve, one beside the other. Raises FigureError."""
    scale = scale_of(figure)
    points = marked_points(figure)
    curves = {name: curve_of(figure, run, name) for name in figure.axes}
    sheet = Sheet(figure, HEADER + HEIGHT)
    wide = (PLOT - BETWEEN * (len(curves) - 1)) / len(curves)
    for number, (name, curve) in enumerate(curves.items()):
        left = LEFT + number * (wide + BETWEEN)
        plot = sheet.plot(sheet.upper + HEADER, HEIGHT, left=left, width=wide)
        draw_run(plot, run, name, curve, scale)
        style_curve(plot, curve, scale)
        draw_points(plot, points, limit_of(curve), scale)
        if not points:
            label_law(plot, curve, scale)
        title = f"{name}, " if len(curves) > 1 else ""
        draw_header(plot, f"{title}acceleration a in deg/s²", NAMES if number == len(curves) - 1 else [])
        sheet.write(left + 0.5 * wide, sheet.height - 17.0, scale.words, ha="center")
    return sheet.drawing


# ---------------------------------------------------------------- choices of the head


def scale_of(figure: FigureScenario) -> Scale:
    over = figure.over or "n"
    if over not in SCALES:
        raise FigureError(figure.path, f"'over: {over}' in the head is not one of {', '.join(SCALES)}")
    return SCALES[over]


def marked_points(figure: FigureScenario) -> list[CurvePoint]:
    """The points of the head."""
    try:
        return [parse_point(text, "deg/s") for text in figure.points]
    except CncError as error:
        raise FigureError(figure.path, error) from None


def curve_of(figure: FigureScenario, run: FigureRun, name: str) -> CurveParameters:
    """Of the gear in which the spindle turned."""
    spindle = run.machine.spindles.get(name)
    curve = spindle.gears[spindle.gear].curve if spindle else None
    if curve is None:
        raise FigureError(figure.path, f"'{name}' has no acceleration curve (P-AXIS-00202)")
    if not np.any(run.column(name, "set_acceleration_deg_s2")):
        raise FigureError(figure.path, f"spindle '{name}' never accelerates")
    return curve


def limit_of(curve: CurveParameters) -> float:
    """Up to here the acceleration is constant, °/s."""
    return curve.n1 if curve.kind == "asynchronous" else curve.limit_speed


def constant_of(curve: CurveParameters) -> float:
    return curve.maximum if curve.kind == "asynchronous" else curve.constant


# ---------------------------------------------------------------- curves


def measured(run: FigureRun, name: str, leg: float) -> tuple[Column, Column]:
    """Amounts of set speed (°/s) and set acceleration of the cycles that run up (`leg` 1) or brake (-1), by speed."""
    speed = DEG_S_PER_RPM * run.column(name, "set_speed_rpm")
    acceleration = run.column(name, "set_acceleration_deg_s2")
    direction = 1.0 if speed.max() >= -speed.min() else -1.0
    cycles = np.flatnonzero(acceleration * direction * leg > 0.0)
    order = cycles[np.argsort(np.abs(speed[cycles]), kind="stable")]
    return np.abs(speed[order]), np.abs(acceleration[order])


def law(curve: CurveParameters, top_speed: float) -> tuple[Column, Column]:
    """Speeds and accelerations up to `top_speed` without the floor."""
    pieces = raw_pieces(curve, top_speed)
    speeds = [np.linspace(piece.low, piece.high, PLACES) for piece in pieces]
    values = [[piece.acceleration(n) for n in part] for piece, part in zip(pieces, speeds, strict=True)]
    return np.concatenate(speeds), np.concatenate(values)


def draw_run(plot: Axes, run: FigureRun, name: str, curve: CurveParameters, scale: Scale) -> None:
    """The spindle's motion up and down, and the law above it as a thin line."""
    limit = limit_of(curve)
    for leg, colour, width in ((RUN_UP, BLUE.actual, 6.0), (BRAKING, BLUE.set, 2.6)):
        speed, acceleration = measured(run, name, leg)
        shown = thinned(speed)
        plot.plot(scale.place(speed[shown], limit), acceleration[shown], color=colour, linewidth=width)
    speeds, values = law(curve, float(speed.max()))
    plot.plot(scale.place(speeds, limit), values, color=INK, linewidth=0.8, dashes=(6, 3), zorder=3.0)


def thinned(speed: Column) -> Column:
    """Indices of ascending speeds, at least SMALL_STEP apart, with the first and the last."""
    steps = np.floor(speed / SMALL_STEP)
    chosen: Column = np.flatnonzero(np.diff(steps, prepend=-1.0) > 0.0)
    return np.union1d(chosen, [len(speed) - 1])


# ---------------------------------------------------------------- words and marks


def style_curve(plot: Axes, curve: CurveParameters, scale: Scale) -> None:
    """Scales, where the law changes, and its floor."""
    style_plot(plot)
    plot.xaxis.set_major_locator(MaxNLocator("auto", steps=[1, 2, 5, 10]))
    plot.tick_params(labelbottom=True)
    plot.set_xlim(scale.begin)
    plot.set_ylim(0.0, 1.12 * constant_of(curve))
    line: dict[str, Any] = {"color": FAINT, "linewidth": 0.9, "zorder": 0.6}
    plot.axhline(curve.minimum, dashes=(2, 2), **line)
    note(plot, f"a_min {curve.minimum:g}", (0.0, curve.minimum), (4.0, 3.0), of=("axes fraction", "data"))
    if scale is SCALES["n"]:
        for name, speed in borders(curve).items():
            plot.axvline(speed, dashes=(4, 3), **line)
            note(plot, f"{name} {speed:g}", (speed, 1.0), (4.0, -11.0), of=("data", "axes fraction"))


def borders(curve: CurveParameters) -> dict[str, float]:
    """Where the law changes."""
    return {"N1": curve.n1, "N2": curve.n2} if curve.kind == "asynchronous" else {"n_limit": curve.limit_speed}


def label_law(plot: Axes, curve: CurveParameters, scale: Scale) -> None:
    """The constant, and the formulas above N1 and above N2."""
    limit, top = limit_of(curve), constant_of(curve)
    note(plot, f"{CONSTANT[curve.kind]} {top:g}", (scale.place(limit, limit), top), (7.0, 5.0), color=INK)
    if curve.kind != "asynchronous":
        return
    texts = (("a_max · N1/n", 1.35 * curve.n1), ("a_max · N1·N2/n²", 1.15 * curve.n2))
    for (text, speed), piece in zip(texts, raw_pieces(curve, inf)[1:], strict=True):
        note(plot, text, (scale.place(speed, curve.n1), piece.acceleration(speed)), (8.0, 6.0), color=INK)


def draw_points(plot: Axes, points: list[CurvePoint], limit: float, scale: Scale) -> None:
    """Interpolation points with their accelerations and lines down to their speeds."""
    dots: dict[str, Any] = {"color": SOFT, "linewidth": 0.8, "dashes": (2, 2), "zorder": 0.7}
    mark: dict[str, Any] = {"color": RED.set, "linestyle": "none", "marker": "o", "markersize": 6.0, "zorder": 4.0}
    for number, point in enumerate(points, start=1):
        place, level = scale.place(point.speed, limit), point.acceleration
        plot.plot([place, place], [0.0, level], **dots)
        plot.plot([place], [level], clip_on=False, **mark)
        note(plot, f"a(n{number}) = {level:g}", (place, level), (7.0, 5.0), color=RED.set)
