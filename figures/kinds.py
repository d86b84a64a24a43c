"""Kinds of pictures by the `kind:` of a head, one file a kind."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from matplotlib.figure import Figure

from figures import (
    circle,
    corners,
    friction_curve,
    gear_ranges,
    over_path,
    picture,
    spindle_and_path,
    spindle_curve,
    spindle_states,
    surfaces,
    thread,
    turned_part,
    weights,
)
from figures.run import FigureRun
from figures.scenario_head import OVER_TIME, FigureError, FigureScenario

KINDS: Mapping[str, Callable[[FigureScenario, FigureRun], Figure]] = {
    OVER_TIME: picture.draw,
    "friction_curve": friction_curve.draw,
    "weights": weights.draw,
    "circle": circle.draw,
    "spindle_curve": spindle_curve.draw,
    "spindle_states": spindle_states.draw,
    "spindle_and_path": spindle_and_path.draw,
    "gear_ranges": gear_ranges.draw,
    "over_path": over_path.draw,
    "corners": corners.draw,
    "thread": thread.draw,
    "surfaces": surfaces.draw,
    "turned_part": turned_part.draw,
}


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a run. Raises FigureError if its head asks for something that does not exist."""
    if figure.kind not in KINDS:
        raise FigureError(figure.path, f"kind '{figure.kind}' does not exist, known are {', '.join(KINDS)}")
    return KINDS[figure.kind](figure, run)
