"""The live line of a run on a terminal: program, axes, spindles; its notes and faults at once."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from types import TracebackType
from typing import TYPE_CHECKING

from rich.console import Console

from cnc_ptp.machine.offline import Outputs
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, SpindleBlock
from cnc_ptp.protocol.notes import Note
from cnc_ptp.protocol.unit_view import VIEWS, UnitView, view_of

if TYPE_CHECKING:
    from rich.live import Live

    from cnc_ptp.commands.run.live_line import LiveLine

PERIOD = 0.1
KINDS: dict[type, str] = {AxisBlock: "axis", SpindleBlock: "spindle", ChannelBlock: "channel"}


class ErrorConsole(Console):
    """Raises what rich would end the program for."""

    def on_broken_pipe(self) -> None:
        raise BrokenPipeError


class RunProgress:
    """Shows the progress of a run, at most ten times per second."""

    def __init__(self, *, always_tells: bool = False) -> None:
        """`always_tells`: notes and faults also without a terminal, as in the journal of a service."""
        self._console = ErrorConsole(stderr=True, emoji=False)
        self._on = self._console.is_terminal
        self._tells = self._on or always_tells
        if self._on:
            self._line, self._live = shown_on(self._console)
        self._next = 0.0

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

    def tell(self, notes: Iterable[Note], faults: Iterable[str] = ()) -> None:
        """Shows them above the line: a run that waits for somebody says so immediately.

        Not that an axis stood already when it was to stop: at the end of a run most of them do.
        """
        for note in notes:
            if not note.idle_stop:
                self._print(str(note), "yellow")
        for fault in faults:
            self._print(fault, "bold red")

    def _print(self, text: str, style: str) -> None:
        """A reader that has gone, or a full disk, ends no run."""
        if not self._tells:
            return
        try:
            self._console.print(text, style=style, markup=False, highlight=False, soft_wrap=True)
        except OSError:
            self._tells = False

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


def shown_on(console: Console) -> tuple[LiveLine, Live]:
    """Where there is no terminal, what draws it is not loaded."""
    from rich.live import Live

    from cnc_ptp.commands.run.live_line import LiveLine

    line = LiveLine()
    return line, Live(line, console=console, refresh_per_second=round(1.0 / PERIOD))
