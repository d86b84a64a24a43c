"""Blocks between nodes of one process: handed over as they are; topics are for the world outside.

Readiness is handed over in the same way: the start of such a run waits for no message.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable

from cnc_ptp.protocol.blocks import CycleBlock
from cnc_ptp.wire.ticks import Tick

TakeBlock = Callable[[CycleBlock], None]


class Handover:
    """Who takes whose blocks, and who then has something to compute.

    A node never computes while another one does: it is called when that one has finished.
    """

    def __init__(self) -> None:
        self._on_tick: list[tuple[Callable[[Tick], None], Callable[[], None]]] = []
        self._readers: dict[str, list[tuple[TakeBlock, Callable[[], None]]]] = {}
        self._newest: dict[str, CycleBlock] = {}
        self._waiting: deque[Callable[[], None]] = deque()
        self.ready: set[str] = set()
        """Nodes that have all that they need to compute."""
        self._running = False

    def on_tick(self, take: Callable[[Tick], None], look: Callable[[], None]) -> None:
        """`look` is called after `take`."""
        self._on_tick.append((take, look))

    def on_block(self, source: str, take: TakeBlock, look: Callable[[], None] | None = None) -> None:
        """The same for the blocks of a unit, from the newest one on if there is one."""
        self._readers.setdefault(source, []).append((take, look or _nothing))
        if source in self._newest:
            take(self._newest[source])

    def tick(self, tick: Tick) -> None:
        """Passes on a tick; when this returns, all has been computed that can be."""
        for take, look in self._on_tick:
            take(tick)
            self._waiting.append(look)
        self._run()

    def block(self, source: str, block: CycleBlock) -> None:
        """Passes on a block of a unit."""
        self._newest[source] = block
        for take, look in self._readers.get(source, ()):
            take(block)
            self._waiting.append(look)
        self._run()

    def have_computed(self, units: Iterable[str], first_cycle: int) -> bool:
        """Each of the units has computed the block of this cycle, or a later one; no block is from before cycle 0."""
        if first_cycle < 0:
            return True
        return all(unit in self._newest and self._newest[unit].first_cycle >= first_cycle for unit in units)

    def _run(self) -> None:
        if self._running:
            return
        self._running = True
        try:
            while self._waiting:
                self._waiting.popleft()()
        finally:
            self._running = False


def _nothing() -> None:
    pass
