"""Draws programs in a process of its own, so that the server keeps its time; what was drawn is kept."""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import threading
from collections.abc import MutableSequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from itertools import count

from cnc_ptp.errors import CncError
from cnc_ptp.web.numbers import NOT_DRAWN
from cnc_ptp.web.programs.backplot import Drawing, draw

KEPT = 4
"""Drawings, the newest ones."""
SLOTS = 16
"""Drawings whose cancelling the process must know: more than there are at a time."""
NOTHING_SHOWN = "nothing is shown"


class Cancelled:
    """Which drawings the process need not go on with: their numbers in memory that it shares with the server."""

    numbers: MutableSequence[int] = [0] * SLOTS

    @classmethod
    def share(cls, numbers: MutableSequence[int]) -> None:
        """In the process that draws, at its begin."""
        cls.numbers = numbers

    @classmethod
    def has(cls, number: int) -> bool:
        return cls.numbers[number % SLOTS] == number


def begin(numbers: MutableSequence[int]) -> None:
    """The process that draws. It ends with its server: of one that was killed it would await drawings for ever."""
    Cancelled.share(numbers)
    threading.Thread(target=end_with_server, daemon=True).start()


def end_with_server() -> None:
    server = multiprocessing.parent_process()
    assert server is not None
    server.join()
    os._exit(1)


def try_to_draw(drawing: Drawing, number: int) -> bytes | str:
    """As backplot.draw; of a program that is refused the text: its error does not travel between processes."""
    if Cancelled.has(number):
        return b""
    try:
        return draw(drawing, is_wanted=lambda: not Cancelled.has(number))
    except CncError as error:
        return error.full_message
    except Exception as error:  # a mistake of ours is shown as well
        return repr(error)


@dataclass(slots=True)
class Order:
    """A drawing that was asked for."""

    number: int
    channel: str
    task: asyncio.Task[bytes]
    is_superseded: bool = False


class DrawingOffice:
    """One drawing at a time; pages that want the same one wait for it together."""

    def __init__(self) -> None:
        self._context = multiprocessing.get_context("spawn")  # no thread and no socket of the server in it
        self._cancelled: MutableSequence[int] = self._context.RawArray("Q", SLOTS)
        self._numbers = count(1)
        self._pool: ProcessPoolExecutor | None = None
        self._orders: dict[tuple[str, ...], Order] = {}

    async def draw(self, drawing: Drawing, *, replaces: bool = True) -> bytes:
        """As backplot.draw. Raises CncError 26253 where that is not possible.

        `replaces`: the channel has this program and these offsets now; what is drawn of others ends.
        """
        offsets = str((drawing.changes, drawing.clamp_index))
        key = (drawing.channel, drawing.file, drawing.text, str(drawing.files), offsets)
        if key not in self._orders:
            if replaces:
                self._cancel(drawing.channel)
            number = next(self._numbers)
            self._orders[key] = Order(number, drawing.channel, asyncio.create_task(self._draw(drawing, number)))
            drawn_before = [each for each, order in self._orders.items() if order.task.done()]
            for old in drawn_before[: 1 - KEPT]:  # the new one is kept besides
                del self._orders[old]
        order = self._orders[key]
        try:
            drawn = await asyncio.shield(order.task)
        except Exception:  # whatever has failed may be tried again
            if self._orders.get(key) is order:
                del self._orders[key]
            raise
        if order.is_superseded:
            reason = f"backplot of {drawing.file}: the channel has another program, or other offsets"
            raise CncError(NOT_DRAWN, reason, NOTHING_SHOWN)
        return drawn

    def _cancel(self, channel: str) -> None:
        """What is drawn of a channel, or waits for that."""
        for key, order in [*self._orders.items()]:
            if order.channel == channel and not order.task.done():
                order.is_superseded = True
                self._cancelled[order.number % SLOTS] = order.number
                del self._orders[key]

    async def _draw(self, drawing: Drawing, number: int) -> bytes:
        loop = asyncio.get_running_loop()
        try:
            drawn = await loop.run_in_executor(self._started(), try_to_draw, drawing, number)
        except BrokenProcessPool:
            self._pool = None
            reason = f"backplot of {drawing.file}: the process that draws has ended"
            raise CncError(NOT_DRAWN, reason, "ask again") from None
        if isinstance(drawn, str):
            raise CncError(NOT_DRAWN, f"backplot of {drawing.file}: {drawn}", NOTHING_SHOWN)
        return drawn

    def _started(self) -> ProcessPoolExecutor:
        if self._pool is None:
            shared = (self._cancelled,)
            self._pool = ProcessPoolExecutor(1, mp_context=self._context, initializer=begin, initargs=shared)
        return self._pool

    def prepare(self) -> None:
        """Its process starts now, so that the first drawing need not wait for that."""
        try:
            self._started().submit(int)
        except BrokenProcessPool:
            self._pool = None  # the next drawing starts another one

    def close(self) -> None:
        """What is being drawn ends."""
        for order in self._orders.values():
            self._cancelled[order.number % SLOTS] = order.number
        if self._pool is not None:
            self._pool.shutdown(wait=False, cancel_futures=True)
            self._pool = None
