"""The live line of a run: program, axes, spindles. On a terminal only."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Sequence
from types import TracebackType

from rich.console import Console, ConsoleOptions, RenderResult
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from cnc_ptp.machine.offline import Outputs
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, SpindleBlock
from cnc_ptp.protocol.notes import Note
from cnc_ptp.protocol.unit_view import VIEWS, UnitView, view_of

PERIOD = 0.1
SMALLEST_BAR = 10
LARGEST_BAR = 30
QUIET = ("Standstill", "SynchronizedMotion")
"""States of an axis that are left out first when there is little room."""
KINDS: dict[type, str] = {AxisBlock: "axis", SpindleBlock: "spindle", ChannelBlock: "channel"}


class RunProgress:
    """Shows the progress of a run, at most ten times per second."""

    def __init__(self) -> None:
        console = Console(stderr=True)
        self._on = console.is_terminal
        self._line = LiveLine()
        self._live = Live(self._line, console=console, refresh_per_second=round(1.0 / PERIOD))
        self._next = 0.0
        self._reported: set[Note] = set()

    def __enter__(self) -> RunProgress:
        if self._on:
            self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._on:
            self._live.stop()

    @property
    def visible(self) -> bool:
        """True on a terminal."""
        return self._on

    @property
    def due(self) -> bool:
        """True on a terminal when the line is a tenth of a second old."""
        return self._on and time.monotonic() >= self._next

    def tell(self, notes: Iterable[Note]) -> None:
        """Shows new `notes` above the line: a run that waits for somebody says so immediately."""
        for note in notes:
            if self._on and note not in self._reported:
                self._reported.add(note)
                self._live.console.print(str(note), style="yellow", markup=False, highlight=False, soft_wrap=True)

    def show_block(self, outputs: Outputs) -> None:
        """Progress of an offline run."""
        if self.due:
            blocks = {name: output.block for name, output in outputs.items()}
            kinds = {name: KINDS.get(type(block), "") for name, block in blocks.items()}
            self.show([view_of(n, shown, blocks[n]) for shown in VIEWS for n, kind in kinds.items() if kind == shown])

    def show(self, views: Sequence[UnitView]) -> None:
        """Units in their order in the line."""
        if self.due:
            self._next = time.monotonic() + PERIOD
            self._line.views = views


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
