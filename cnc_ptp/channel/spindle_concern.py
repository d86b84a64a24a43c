"""Which spindles a channel has to stop with its program: what it has set in motion and what does not stand yet.

A function counts from the block on with which it goes out; it may be refused, overtaken or withdrawn, so only a report
of the spindle ends it. Source: TF5200 spindle 2.4.3 (a reset always stops the spindles).
"""

from __future__ import annotations

from collections.abc import Iterator

from cnc_ptp.channel.spindle_reports import stands
from cnc_ptp.protocol.blocks import SpindleBlock


class SpindleConcern:
    """Spindles by name, in the order in which the channel has commanded them."""

    def __init__(self, channel: str) -> None:
        """`channel`: name of the channel, as spindles report for whom they are at work."""
        self._channel = channel
        self._queued: dict[str, bool] = {}
        """False for a function that ends the concern."""
        self._sent: dict[str, int] = {}
        """First cycle of the block with the last function."""

    def __iter__(self) -> Iterator[str]:
        return iter(list(self._sent))

    def add(self, name: str) -> None:
        """A function for the spindle goes out with the next block."""
        self._queued[name] = True

    def keep(self, name: str) -> None:
        """The spindle may be in motion already."""
        self._sent.setdefault(name, -1)

    def end(self, name: str) -> None:
        """With the next block the spindle is told to stop, and nobody but the PLC knows when it stands."""
        self._queued[name] = False

    def withdraw(self) -> None:
        """What has not gone out does not go out any more."""
        self._queued.clear()

    def send(self, first_cycle: int) -> None:
        """The functions go out with the block that begins at `first_cycle`."""
        for name, stays in self._queued.items():
            if stays:
                self._sent[name] = first_cycle
            else:
                self._sent.pop(name, None)
        self._queued.clear()

    def drop(self, name: str) -> None:
        """The spindle was told to stop, or is somebody else's concern."""
        self._queued.pop(name, None)
        self._sent.pop(name, None)

    def read(self, cycle: int, name: str, block: SpindleBlock) -> None:
        """What a spindle has reported before `cycle`."""
        if cycle > self._sent.get(name, cycle) and stands(block, self._channel):
            del self._sent[name]
