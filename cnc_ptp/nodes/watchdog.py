"""Watchdog of a node: which of the other nodes have fallen silent."""

from __future__ import annotations

import time
from collections.abc import Iterable
from math import inf

from cnc_ptp.nodes.process import START_PATIENCE


class Pause:
    """How long this process has not come to a place of its loop: it may have been suspended."""

    def __init__(self) -> None:
        self._passed = time.monotonic()

    def take(self) -> float:
        """Seconds since the last time; to be asked regularly."""
        before, self._passed = self._passed, time.monotonic()
        return self._passed - before


class Watchdog:
    """When other nodes were last heard; one that is waited for is silent after the watchdog time."""

    def __init__(self, names: Iterable[str], *, seconds: float) -> None:
        """`seconds`: the watchdog time."""
        self.seconds = seconds
        self._pause = Pause()
        self.paused = 0.0
        """Seconds between the last two questions whether this process was suspended."""
        self._heard = dict.fromkeys(names, time.monotonic())

    def watch(self, name: str) -> None:
        """One more node, which is heard now."""
        self._heard[name] = time.monotonic()

    def heard(self, name: str) -> bool:
        """A message of `name` has come. False for a node that is not watched."""
        if name not in self._heard:
            return False
        self._heard[name] = time.monotonic()
        return True

    def restart(self) -> None:
        """All count as heard now."""
        self._pause.take()
        self._heard = dict.fromkeys(self._heard, time.monotonic())

    def was_suspended(self) -> bool:
        """To be asked regularly: this process itself was suspended since the last time, and heard nobody."""
        self.paused = self._pause.take()
        return self.paused > self.seconds / 2.0

    def silent(self, names: Iterable[str], *, begun: bool, most: float = inf) -> list[str]:
        """Those of the watched `names` that are silent; until the run has `begun` they have longer. `most`: seconds."""
        patience = min(most, self.seconds if begun else max(self.seconds, START_PATIENCE))
        now = time.monotonic()
        return [name for name in names if now - self._heard[name] > patience]
