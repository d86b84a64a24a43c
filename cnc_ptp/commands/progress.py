"""The progress line of a run: block, position, feed. On a terminal only."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from cnc_ptp.machine.blocks import ChannelBlock
from cnc_ptp.machine.offline import Outputs

PERIOD = 0.1


class RunProgress:
    """Shows where a run is, at most ten times a second."""

    def __init__(self) -> None:
        console = Console(stderr=True)
        self._on = console.is_terminal
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[where]}"),
            TimeElapsedColumn(),
            console=console,
        )
        self._task = self._progress.add_task("program", total=None, where="")
        self._next = 0.0
        self._told: set[str] = set()

    def __enter__(self) -> RunProgress:
        if self._on:
            self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._on:
            self._progress.stop()

    def tell(self, notes: Iterable[str]) -> None:
        """Shows what has come to `notes`, above the progress line: a run that waits for somebody says so at once."""
        for note in notes:
            if self._on and note not in self._told:
                self._told.add(note)
                self._progress.console.print(note, style="yellow", markup=False, highlight=False, soft_wrap=True)

    def show_block(self, outputs: Outputs) -> None:
        """Progress of an offline run."""
        if not self._on or time.monotonic() < self._next:
            return
        for output in outputs.values():
            block = output.block
            if isinstance(block, ChannelBlock):
                last = range(block.count - 1, len(block.set_position), block.count)
                position = {axis: block.set_position[index] for axis, index in zip(block.axes, last, strict=True)}
                self.show(
                    block.blocks_done, block.blocks_total, block.line[-1], position, block.path_velocity[-1] * 60.0
                )
                return

    def show(self, done: int, total: int, line: int, position: Mapping[str, float], feed_mm_per_min: float) -> None:
        """`done` of `total` program blocks, line number, axis positions in mm, feed in mm/min."""
        if not self._on or time.monotonic() < self._next:
            return
        self._next = time.monotonic() + PERIOD
        where = " ".join(f"{axis.upper()}{value:9.3f}" for axis, value in position.items())
        text = f"block {done}/{total} line {line}  {where}  F{feed_mm_per_min:6.0f}"
        text = text if position else "the nodes are starting"
        self._progress.update(self._task, completed=done, total=total or None, where=text)
