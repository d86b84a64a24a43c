"""Lateness of blocks as counts in steps of 0.1 ms: cheap to keep, to send and to add up over nodes."""

from __future__ import annotations

from collections import Counter

from cnc_ptp import msg

STEP_US = 100


class Lateness:
    """Distribution of the time from the instant at which a block was due to the instant at which it was ready."""

    def __init__(self) -> None:
        self.counts: Counter[int] = Counter()
        self.largest_us = 0

    @classmethod
    def between(cls, first: msg.LatenessHistogram | None, last: msg.LatenessHistogram) -> Lateness:
        """What the later one of two messages of a node has more; its largest lateness is that since the start."""
        late = cls()
        late.merge(last)
        if first is not None:
            late.counts.subtract(dict(zip(first.step, first.blocks, strict=True)))
        return late

    def add(self, lateness_us: int) -> None:
        self.counts[max(0, lateness_us) // STEP_US] += 1
        self.largest_us = max(self.largest_us, lateness_us)

    def merge(self, message: msg.LatenessHistogram) -> None:
        """Adds the distribution that a node has published."""
        self.counts.update(dict(zip(message.step, message.blocks, strict=True)))
        self.largest_us = max(self.largest_us, message.largest_us)

    def message(self, source: str) -> msg.LatenessHistogram:
        """Without stamp."""
        steps = sorted(self.counts)
        blocks = [self.counts[step] for step in steps]
        return msg.LatenessHistogram(
            source=source, step_us=STEP_US, step=steps, blocks=blocks, largest_us=self.largest_us
        )

    def percentile_us(self, percent: float) -> int:
        """Smallest bound (upper end of its step) that `percent` of the blocks keep; 0 without blocks."""
        wanted = self.counts.total() * percent / 100.0
        seen = 0
        for step in sorted(self.counts):
            seen += self.counts[step]
            if seen >= wanted:
                return (step + 1) * STEP_US
        return 0
