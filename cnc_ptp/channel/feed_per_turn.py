"""Feed per turn (G95): how fast the spindle turns, for the path that goes with it.

The newest report is that of the block before. The speed that the spindle will have in the middle of the next block
follows from it and from its change within the block.
"""

from __future__ import annotations

from typing import Final

from cnc_ptp.channel.spindle_functions import SpindleFunctions
from cnc_ptp.path.path_motion import PathMotion
from cnc_ptp.protocol.blocks import SpindleBlock

LEAST_CHANGE: Final = 0.0005
"""Part by which the speed has to change before the path gets another velocity."""
LEAD: Final = 0.6
"""From the end of the block that is reported to the instant that counts, in blocks."""
PATIENCE: Final = 3
"""Blocks for which the path waits for a spindle before there is a warning: it may have been started only just."""


class FeedPerTurn:
    """The spindles of a channel, as the path asks for them."""

    def __init__(self, spindles: SpindleFunctions) -> None:
        self._spindles = spindles
        self._known: dict[str, float] = {}
        """Turns per second as the path knows them."""
        self._waited = 0

    def turns(self, name: str) -> float:
        """Turns per second of a spindle by its name in programs, 0.0 at a standstill; small changes do not count."""
        block = self._spindles[name].block
        now = 0.0 if block is None else speed_ahead(block) / 60.0
        before = self._known.get(name, 0.0)
        if now and abs(now - before) <= LEAST_CHANGE * before:
            return before
        self._known[name] = now
        return now

    def awaited(self, motion: PathMotion) -> str:
        """Once, when the path has waited for a while: the node of the spindle that stands; else empty."""
        name = motion.awaited_spindle
        self._waited = self._waited + 1 if name else 0
        return self._spindles[name].node if self._waited == PATIENCE else ""


def speed_ahead(block: SpindleBlock) -> float:
    """Speed in the middle of the next block, rpm, without sign; 0.0 at a standstill."""
    speeds = block.actual_speed_rpm
    if block.speed_zero[-1]:
        return 0.0
    change = (speeds[-1] - speeds[0]) / (len(speeds) - 1) if len(speeds) > 1 else 0.0
    ahead = speeds[-1] + LEAD * len(speeds) * change
    return abs(ahead) if ahead * speeds[-1] > 0.0 else 0.0
