"""One line for units and programs, as long as its terminal is wide."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence

from rich.console import Console, ConsoleOptions, RenderResult
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from cnc_ptp.protocol.unit_view import UnitView

SMALLEST_BAR = 10
LARGEST_BAR = 30
QUIET = ("Standstill", "SynchronizedMotion")
"""States of an axis that are left out first when there is little room."""


class LiveLine:
    """One line that fits its terminal: if there is no room, the least important parts are left out first."""

    def __init__(self) -> None:
        self.views: Sequence[UnitView] = ()
        self._started = time.monotonic()

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        text = line_text(self.views, time.monotonic() - self._started, options.max_width)
        room = min(LARGEST_BAR, options.max_width - len(text) - 1)
        programs = [view for view in self.views if view.blocks_total]
        if not programs or room < SMALLEST_BAR:
            yield Text(text, no_wrap=True, overflow="crop")
            return
        row = Table.grid(padding=(0, 1, 0, 0))
        done = sum(view.progress for view in programs)
        row.add_row(ProgressBar(total=len(programs), completed=done, width=room), Text(text, no_wrap=True))
        yield row


def line_text(views: Sequence[UnitView], seconds: float, width: int) -> str:
    """The most detailed text about the units, `seconds` after the start, of at most `width` characters."""
    if not views:
        return f"the nodes are starting  {clock_text(seconds)}"[:width]
    channels = [view for view in views if view.kind == "channel"]
    movers = [view for view in views if view.kind != "channel"]
    short = [f"{view.name if channels[1:] else 'block'} {view.blocks_done}/{view.blocks_total}" for view in channels]
    long = [f"{text} line {view.line} F{view.speed or 0.0:.0f}" for text, view in zip(short, channels, strict=True)]
    times: tuple[list[str], ...] = ([clock_text(seconds), *left_text(channels)], [clock_text(seconds)], [])
    texts = (
        "  ".join([*programs, *(mover_text(view, decimals, states) for view in movers), *time])
        for programs in (long, short)
        for time in times
        for decimals, states in ((3, "all"), (3, "moving"), (3, "none"), (2, "none"))
    )
    fitting = next((text for text in texts if len(text) <= width), None)
    shortest = [*short, *(mover_text(view, 1, "none") for view in movers)]
    return fitting if fitting is not None else as_many_as_fit(shortest, width)


def left_text(channels: Sequence[UnitView]) -> list[str]:
    """The time that the longest program still takes, if that is known."""
    left = max((view.time_left for view in channels if view.busy), default=0.0)
    known = all(view.time_left >= 0.0 for view in channels)
    return [f"{clock_text(math.ceil(left))} left"] if known and left > 0.0 else []


def as_many_as_fit(texts: Sequence[str], width: int) -> str:
    """The first of the texts, and how many there are besides."""
    for number in range(len(texts), 0, -1):
        more = [f"+{len(texts) - number}"] if number < len(texts) else []
        text = "  ".join([*texts[:number], *more])
        if len(text) <= width:
            return text
    return texts[0][:width]


def mover_text(view: UnitView, decimals: int, states: str) -> str:
    """`states`: all, moving (those worth a word), none."""
    value = view.speed if view.kind == "spindle" else view.position
    text = f"{view.name.upper()}{value or 0.0:{6 + decimals}.{decimals}f}"
    if view.kind == "spindle":
        text = f"{view.name.upper()}{value or 0.0:8.1f} rpm"
    if states == "all" or (states == "moving" and view.state not in QUIET):
        text += f" {view.state}"
    return text


def clock_text(seconds: float) -> str:
    """h:mm:ss"""
    minutes, second = divmod(int(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{second:02d}"
