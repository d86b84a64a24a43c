"""Draws programs in a process of its own, so that the server keeps its time; what was drawn is kept."""

from __future__ import annotations

import asyncio
import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool

from cnc_ptp.errors import CncError
from cnc_ptp.web.numbers import NOT_DRAWN
from cnc_ptp.web.programs.backplot import Drawing, draw

KEPT = 4
"""Drawings, the newest ones."""


def try_to_draw(drawing: Drawing) -> bytes | str:
    """As backplot.draw; of a program that is refused the text: its error does not travel between processes."""
    try:
        return draw(drawing)
    except CncError as error:
        return error.full_message
    except Exception as error:  # a mistake of ours is shown as well
        return repr(error)


class DrawingOffice:
    """One drawing at a time; pages that want the same one wait for it together."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None
        self._drawn: dict[tuple[str, ...], asyncio.Task[bytes]] = {}

    async def draw(self, drawing: Drawing) -> bytes:
        """As backplot.draw. Raises CncError 26253 where that is not possible."""
        key = (drawing.channel, drawing.file, drawing.text, str(drawing.files))
        if key not in self._drawn:
            self._drawn[key] = asyncio.create_task(self._draw(drawing))
            while len(self._drawn) > KEPT:
                del self._drawn[next(iter(self._drawn))]
        try:
            return await asyncio.shield(self._drawn[key])
        except Exception:  # whatever has failed may be tried again
            self._drawn.pop(key, None)
            raise

    async def _draw(self, drawing: Drawing) -> bytes:
        loop = asyncio.get_running_loop()
        try:
            drawn = await loop.run_in_executor(self._started(), try_to_draw, drawing)
        except BrokenProcessPool:
            self._pool = None
            reason = f"backplot of {drawing.file}: the process that draws has ended"
            raise CncError(NOT_DRAWN, reason, "ask again") from None
        if isinstance(drawn, str):
            raise CncError(NOT_DRAWN, f"backplot of {drawing.file}: {drawn}", "nothing is shown")
        return drawn

    def _started(self) -> ProcessPoolExecutor:
        if self._pool is None:
            context = multiprocessing.get_context("spawn")  # no thread and no socket of the server in it
            self._pool = ProcessPoolExecutor(1, mp_context=context)
        return self._pool

    def prepare(self) -> None:
        """Its process starts now, so that the first drawing need not wait for that."""
        try:
            self._started().submit(int)
        except BrokenProcessPool:
            self._pool = None  # the next drawing starts another one

    def close(self) -> None:
        if self._pool is not None:
            self._pool.shutdown(wait=False, cancel_futures=True)
            self._pool = None
