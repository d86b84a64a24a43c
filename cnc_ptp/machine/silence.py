"""Who has fallen silent: one watch for life signs, topics and blocks, in whatever unit of time it is given."""

from __future__ import annotations

from math import inf


class Silence:
    """Watches sources from the first time that they are heard; one that falls silent is told once, until heard again.

    Times and patience in seconds or cycles, as the caller counts.
    """

    def __init__(self, patience: float, *, rhythm: bool = False) -> None:
        """Nothing for longer than `patience` is silence. `rhythm`: only after two messages within it; one is none."""
        self._patience = patience
        self._rhythm = rhythm
        self._heard: dict[str, float] = {}
        self._watched: set[str] = set()

    def heard(self, source: str, now: float) -> None:
        """Something has come."""
        if not self._rhythm or now - self._heard.get(source, -inf) < self._patience:
            self._watched.add(source)
        self._heard[source] = now

    def forget(self, source: str) -> None:
        """Watches `source` no more, until it is heard again."""
        self._watched.discard(source)

    def is_heard(self, source: str, now: float) -> bool:
        """`source` is watched, and not silent."""
        return source in self._watched and now - self._heard[source] <= self._patience

    def fallen_silent(self, now: float) -> list[str]:
        """Each source once, in the order in which they were heard first."""
        silent = [source for source in self._heard if source in self._watched and not self.is_heard(source, now)]
        self._watched.difference_update(silent)
        return silent
