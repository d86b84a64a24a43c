"""Watch for sources that fall silent: life signs and topics, in any unit of time."""

from __future__ import annotations

from math import inf


def patience_of(milliseconds: float) -> float:
    """Seconds; a parameter of 0 ms switches the watch off: nothing is ever silent."""
    return milliseconds / 1000.0 if milliseconds else inf


class Silence:
    """Watches sources from their first message; one that falls silent is reported once, until its next message.

    Times and patience in seconds or cycles, as the caller counts.
    """

    def __init__(self, patience: float, *, rhythm: bool = False) -> None:
        """Nothing for longer than `patience` is silence. `rhythm`: only after two messages within it; one is none."""
        self._patience = patience
        self._rhythm = rhythm
        self._heard: dict[str, float] = {}
        self._watched: set[str] = set()

    def heard(self, source: str, now: float) -> None:
        """A message has come."""
        if not self._rhythm or now - self._heard.get(source, -inf) < self._patience:
            self._watched.add(source)
        self._heard[source] = now

    def forget(self, source: str) -> None:
        """Stops watching `source` until its next message."""
        self._watched.discard(source)

    def is_heard(self, source: str, now: float) -> bool:
        """`source` is watched, and not silent."""
        return source in self._watched and now - self._heard[source] <= self._patience

    def fallen_silent(self, now: float) -> list[str]:
        """Each silent source once, in the order of their first messages."""
        silent = [source for source in self._heard if source in self._watched and not self.is_heard(source, now)]
        self._watched.difference_update(silent)
        return silent
