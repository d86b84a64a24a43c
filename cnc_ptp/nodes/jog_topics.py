"""Jogging by a topic: an axis moves while messages come, so that a client that is gone leaves nothing moving."""

from __future__ import annotations

import math

PATIENCE = 0.2
"""Seconds without a message after which a jog ends."""


class JogTopics:
    """Velocities that clients ask for, axis by axis: what of them is a change, and who has fallen silent."""

    def __init__(self) -> None:
        self._velocity: dict[str, float] = {}
        self._heard: dict[str, float] = {}
        self._client: dict[str, str] = {}

    def heard(self, axis: str, velocity: float, now: float) -> float | None:
        """A message has come; the velocity (mm/s, deg/s; 0 ends the jog) to command, None when it is the same still.

        A velocity that is no number ends the jog as well: who sends it has lost control.
        """
        velocity = velocity if math.isfinite(velocity) else 0.0
        self._heard[axis] = now
        if velocity == self._velocity.get(axis, 0.0):
            return None
        self._velocity[axis] = velocity
        return velocity

    def is_foreign(self, axis: str, client: str, now: float) -> bool:
        """True while another client jogs the axis: only one has it in hand, until it ends the jog or falls silent."""
        held = bool(self._velocity.get(axis)) and now - self._heard[axis] <= PATIENCE
        if held and client != self._client[axis]:
            return True
        self._client[axis] = client
        return False

    def fallen_silent(self, now: float) -> list[str]:
        """Each axis once; its jog ends, and the next message begins a new one."""
        jogged = [axis for axis, velocity in self._velocity.items() if velocity]
        silent = [axis for axis in jogged if now - self._heard[axis] > PATIENCE]
        for axis in silent:
            self._velocity[axis] = 0.0
        return silent
