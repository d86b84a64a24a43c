"""How late blocks are ready, as counts in steps of 0.1 ms: cheap to keep, to send and to add up over nodes."""

from __future__ import annotations

import json
from collections import Counter

STEP_US = 100


class Lateness:
    """Distribution of the time from the instant at which a block was due to the instant at which it was ready."""

    def __init__(self) -> None:
        self.counts: Counter[int] = Counter()
        self.largest_us = 0

    def add(self, lateness_us: int) -> None:
        self.counts[max(0, lateness_us) // STEP_US] += 1
        self.largest_us = max(self.largest_us, lateness_us)

    def merge(self, text: str, largest_us: int) -> None:
        """Adds a distribution that `to_text` has written."""
        self.counts.update({int(step): count for step, count in json.loads(text).items()})
        self.largest_us = max(self.largest_us, largest_us)

    def to_text(self) -> str:
        return json.dumps(self.counts)

    def percentile_us(self, percent: float) -> int:
        """Smallest bound (upper end of its step) that `percent` of the blocks keep; 0 without blocks."""
        wanted = self.counts.total() * percent / 100.0
        seen = 0
        for step in sorted(self.counts):
            seen += self.counts[step]
            if seen >= wanted:
                return (step + 1) * STEP_US
        return 0
