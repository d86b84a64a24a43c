"""The sheet of a picture: card, title and caption, places for plots, and the style of plots and their texts."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable
from typing import Any, NamedTuple, Protocol

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch
from matplotlib.ticker import MaxNLocator

from cnc_ptp.plots.colours import EDGE, FAINT, GRID, INK, PAPER, SOFT

POINTS_PER_INCH = 72
WIDTH, LEFT, RIGHT = 800.0, 66.0, 66.0
TITLE, CAPTION_LINE, HEADER, GAP, BOTTOM = 40.0, 15.0, 32.0, 4.0, 42.0
"""Points."""
TEXT_LEFT, PLOT = 22.0, WIDTH - LEFT - RIGHT
CAPTION_LETTERS = 140
SMALL, NORMAL, LARGE = 8.5, 9.5, 14.0
LETTER = 5.0
"""Width of a small letter, generously: nothing is placed by measured text, so viewers may have other fonts."""
TITLE_OFFSET = 7.0
"""Height of a plot's title above the plot."""


class Titled(Protocol):
    """Height of the texts above the plots."""

    @property
    def title(self) -> str: ...

    @property
    def caption(self) -> str: ...


class Sheet:
    """The card with title and caption; below them `room` points are left for plots, from `upper` on.

    Lengths are points from the upper left corner.
    """

    def __init__(self, figure: Titled, room: float) -> None:
        caption = wrapped(figure.caption)
        self.upper = TITLE + CAPTION_LINE * len(caption)
        self.height = self.upper + room + BOTTOM
        size = (WIDTH / POINTS_PER_INCH, self.height / POINTS_PER_INCH)
        self.drawing = Figure(figsize=size, dpi=POINTS_PER_INCH, facecolor="none")
        self._draw_card()
        self.write(TEXT_LEFT, 32.0, figure.title, color=INK, fontsize=LARGE, fontweight="bold")
        for number, line in enumerate(caption, start=1):
            self.write(TEXT_LEFT, TITLE - 3.0 + number * CAPTION_LINE, line)

    def plot(self, top: float, height: float, *, left: float = LEFT, width: float = PLOT, polar: bool = False) -> Axes:
        """A plot without style at a place of the sheet."""
        place = (left / WIDTH, 1.0 - (top + height) / self.height, width / WIDTH, height / self.height)
        return self.drawing.add_axes(place, projection="polar" if polar else None)

    def write(self, x: float, y: float, words: str, **style: Any) -> None:
        """Text at `x`, `y`; `style` as in Matplotlib."""
        style = {"color": SOFT, "fontsize": NORMAL, **style}
        self.drawing.text(x / WIDTH, 1.0 - y / self.height, words, **style)

    def write_below(self, words: str) -> None:
        """Label of the lowest scale."""
        self.write(LEFT + 0.5 * PLOT, self.height - 17.0, words, ha="center")

    def _draw_card(self) -> None:
        """The figure has its own background, on any page."""
        inset, corner = 1.0 / POINTS_PER_INCH, 10.0 / POINTS_PER_INCH
        width, tall = WIDTH / POINTS_PER_INCH - 2 * inset, self.height / POINTS_PER_INCH - 2 * inset
        shape = f"round,pad=0,rounding_size={corner}"
        card = FancyBboxPatch((inset, inset), width, tall, boxstyle=shape, facecolor=PAPER, edgecolor=EDGE)
        card.set_linewidth(1.0)
        card.set_transform(self.drawing.dpi_scale_trans)
        card.set_zorder(-10)
        self.drawing.add_artist(card)


class Name(NamedTuple):
    """A curve's name in the header of its plot, in the curve's colour."""

    text: str
    colour: str


def wrapped(caption: str) -> list[str]:
    """The lines of a caption; 'J = 50000 mm/s³' and '75 %' stay together."""
    units = r"(?<=\d) (?=[mµ]m|deg|s\b|%|Nm?\b)| (?==)|(?<==) "
    return textwrap.wrap(re.sub(units, "\u00a0", caption), CAPTION_LETTERS)


def style_plot(plot: Axes) -> None:
    """A light grid, no frame, few numbers; those of the x scale are left out."""
    plot.patch.set_visible(False)
    plot.margins(y=0.1)
    plot.grid(color=GRID, linewidth=0.8)
    plot.set_axisbelow(True)
    plot.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    plot.xaxis.set_major_locator(MaxNLocator(10, steps=[1, 2, 2.5, 5, 10]))
    plot.axhline(0.0, color=FAINT, linewidth=0.8, zorder=0.5)
    plot.spines[:].set_visible(False)
    plot.tick_params(length=0, labelsize=SMALL, labelcolor=SOFT, labelbottom=False, pad=5)


def draw_header(plot: Axes, title: str, names: Iterable[Name], *, offset: float = TITLE_OFFSET) -> None:
    """Title at the left, names of the curves at the right, `offset` points above the plot."""
    note(plot, title, (0.0, 1.0), (0.0, offset), of="axes fraction", color=INK, fontsize=NORMAL, fontweight="bold")
    right = 0.0
    for name in reversed(list(names)):
        style: dict[str, Any] = {"ha": "right", "color": name.colour, "fontweight": "bold"}
        note(plot, name.text, (1.0, 1.0), (right, offset), of="axes fraction", **style)
        right -= LETTER * len(name.text) + 10.0


def note(plot: Axes, words: str, at: tuple[float, float], offset: tuple[float, float], **style: Any) -> None:
    """Small words `offset` points from `at`; `of`: what the coordinates of `at` count ("data" if left out)."""
    where = style.pop("of", "data")
    style = {"color": SOFT, "fontsize": SMALL, **style}
    plot.annotate(words, at, offset, xycoords=where, textcoords="offset points", **style)


def write_value(plot: Axes, value: float, colour: str) -> None:
    """A number at the right of a plot, at its height."""
    style: dict[str, Any] = {"color": colour, "fontweight": "bold", "va": "center_baseline"}
    note(plot, number(value), (1.0, value), (6.0, 0.0), of=("axes fraction", "data"), **style)


def number(value: float) -> str:
    """To a tenth, small values to a hundredth, without zeros behind, with a minus sign as the scales have it."""
    rounded = round(value, 1 if abs(value) >= 100.0 else 2) + 0.0
    return f"{rounded:.2f}".rstrip("0").rstrip(".").replace("-", "−")
