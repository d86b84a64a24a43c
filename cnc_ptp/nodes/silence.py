"""Topics whose sender has fallen silent."""

from __future__ import annotations


class SilentTopics:
    """Watches topics on which messages come in a rhythm; a single message by hand is none."""

    def __init__(self, patience: float) -> None:
        """`patience` in s: two messages within it are a rhythm, nothing for longer is silence."""
        self._patience = patience
        self._heard: dict[str, float] = {}
        self._rhythmic: set[str] = set()

    def heard(self, topic: str, now: float) -> None:
        """A message has come; `now` in s."""
        if now - self._heard.get(topic, -self._patience) < self._patience:
            self._rhythmic.add(topic)
        self._heard[topic] = now

    def fallen_silent(self, now: float) -> list[str]:
        """Each topic once."""
        silent = [topic for topic in sorted(self._rhythmic) if now - self._heard[topic] > self._patience]
        self._rhythmic.difference_update(silent)
        return silent
