"""Jogging by a topic: an axis moves while messages come, so that nothing keeps moving when the client is gone."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable

from cnc_ptp import msg
from cnc_ptp.machine.silence import Silence
from cnc_ptp.nodes.topics import jog_topic
from cnc_ptp.plc.sequence import is_newer

JOG_SILENT = 26134
SECOND_JOG = 26144
JOG_IN_FREE_RUN = 26145
PATIENCE = 0.2
"""Seconds without a message after which a jog ends."""
KNOWN_CLIENTS = 1000
"""Whose numbers of messages are known, and who hear that they are ignored: names may be made up."""
SILENCE = f"{PATIENCE * 1000.0:.0f} ms"


class JogTopics:
    """Velocities that clients ask for, axis by axis: their changes, and clients that have fallen silent.

    Only one client jogs an axis, until it ends its jog or falls silent; others are ignored. In free run all are:
    a silence in which the clock of the machine runs ahead would be a long motion.
    """

    def __init__(self, warn: Callable[[int, str], None]) -> None:
        """`warn(number, text)`: publishes what happens to the messages, once for each client."""
        self._warn = warn
        self._reported: defaultdict[tuple[int, str], set[str]] = defaultdict(set)
        """Number and axis -> clients."""
        self._sequence: dict[tuple[str, str], int] = {}
        self._velocity: dict[str, float] = {}
        self._silence = Silence(PATIENCE)
        self._client: dict[str, str] = {}

    def heard(self, axis: str, message: msg.Jog, now: float, *, paced: bool) -> float | None:
        """The velocity (mm/s, deg/s; 0 ends the jog) to command, None when it is unchanged, or does not count.

        A velocity that is no number ends the jog as well: its sender has lost control. `now` in s; `paced`: the
        machine runs in real time.
        """
        client = message.header.frame_id
        if not paced:
            self._report(JOG_IN_FREE_RUN, axis, client, free_run_text(axis))
            return None
        if self._is_foreign(axis, client, now):
            self._report(SECOND_JOG, axis, client, second_client_text(axis, client))
            return None
        if not is_newer(message.sequence, self._sequence.get((axis, client), 0)):
            return None
        self._note_sequence(axis, client, message.sequence)
        self._client[axis] = client
        velocity = message.velocity if message.valid and math.isfinite(message.velocity) else 0.0
        if velocity:
            self._silence.heard(axis, now)
        else:
            self._silence.forget(axis)
        before, self._velocity[axis] = self._velocity.get(axis, 0.0), velocity
        return None if velocity == before else velocity

    def fallen_silent(self, now: float) -> list[str]:
        """Each axis once; its jog ends, and the next message starts a new one."""
        silent = self._silence.fallen_silent(now)
        for axis in silent:
            self._velocity[axis] = 0.0
            self._warn(JOG_SILENT, f"plc: no message on /{jog_topic(axis)} for {SILENCE}; the jog of {axis} ends")
        return silent

    def _is_foreign(self, axis: str, client: str, now: float) -> bool:
        return self._silence.is_heard(axis, now) and client != self._client[axis]

    def _note_sequence(self, axis: str, client: str, sequence: int) -> None:
        self._sequence.pop((axis, client), None)
        self._sequence[axis, client] = sequence
        if len(self._sequence) > KNOWN_CLIENTS:
            del self._sequence[next(iter(self._sequence))]  # the one that was heard longest ago

    def _report(self, error_id: int, axis: str, client: str, text: str) -> None:
        told = self._reported[error_id, axis]
        if client not in told and len(told) < KNOWN_CLIENTS:
            told.add(client)
            self._warn(error_id, text)


def free_run_text(axis: str) -> str:
    """The warning that jogs of an axis have no effect."""
    return f"plc: /{jog_topic(axis)} has no effect in free run, where {SILENCE} may be a long motion"


def second_client_text(axis: str, client: str) -> str:
    """The warning that a client is ignored."""
    return f"plc: /{jog_topic(axis)} has a second client '{client}'; it is ignored while the first one jogs {axis}"
