"""How often somebody may do something."""

from __future__ import annotations

import time
from collections.abc import Callable


class Rate:
    """A bucket of `burst` permits, filled with `per_second`."""

    def __init__(self, per_second: float, burst: float, *, now: Callable[[], float] = time.monotonic) -> None:
        self._per_second, self._burst, self._now = per_second, burst, now
        self._left, self._at = burst, now()

    def permits(self) -> bool:
        """Takes one; False when there is none."""
        now = self._now()
        self._left = min(self._burst, self._left + (now - self._at) * self._per_second)
        self._at = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
