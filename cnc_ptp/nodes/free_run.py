"""How fast a free run may go: as fast as those follow for whom it has to wait."""

from __future__ import annotations

import time
from collections.abc import Iterable

from cnc_ptp.nodes.topics import RECORDER
from cnc_ptp.nodes.watchdog import Watchdog
from cnc_ptp.protocol.unit import PLC

RECORDER_BLOCKS = 200
"""Blocks that a free run may be ahead of the recorder, which takes many at a time and loses none up to 1000."""


class FreeRunPace:
    """A tick comes when the PLC has computed the one before: that needs the blocks of all units before that.

    A PLC or recorder that is silent for the watchdog time no longer counts, until it is heard again; without the PLC
    the run continues in real time.
    """

    def __init__(self, names: Iterable[str], *, block_cycles: int, block_time: float, watchdog: Watchdog) -> None:
        """`names`: all that are expected; `block_time` in s."""
        ahead = {PLC: block_cycles, RECORDER: RECORDER_BLOCKS * block_cycles}
        self._ahead = {name: ahead[name] for name in names if name in ahead}
        self._count = block_cycles
        self._block_time = block_time
        self._watchdog = watchdog
        self._newest = dict.fromkeys(self._ahead, -block_cycles)
        self._silent: set[str] = set()
        self._ticked_at = 0.0

    def heard(self, name: str, first_cycle: int) -> None:
        """The PLC has computed this cycle, the recorder has taken its tick."""
        if name in self._newest:
            self._newest[name] = max(self._newest[name], first_cycle)
            self._silent.discard(name)

    def may_tick(self, next_cycle: int) -> bool:
        """`next_cycle`: the first one of the tick."""
        waits = [
            name
            for name, ahead in self._ahead.items()
            if name not in self._silent and next_cycle - self._newest[name] > ahead
        ]
        if waits:
            begun = next_cycle > self._count
            self._silent |= {name for name in waits if self._watchdog.silent([name], begun=begun and name == PLC)}
            return False
        return PLC not in self._silent or time.monotonic() - self._ticked_at >= self._block_time

    def wait_time(self, longest: float) -> float:
        """Seconds, at most `longest`, until a tick may come without a message."""
        if PLC not in self._silent:
            return longest
        return min(longest, max(0.0, self._ticked_at + self._block_time - time.monotonic()))

    def ticked(self) -> None:
        self._ticked_at = time.monotonic()
        self._watchdog.restart()
