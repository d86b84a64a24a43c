"""Jogs of a page: each of its messages is passed on once, none is repeated, and late ones do not count."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Protocol

from cnc_ptp.client.faults import unknown_unit
from cnc_ptp.errors import CncError
from cnc_ptp.nodes.bridge.jog_topics import PATIENCE
from cnc_ptp.web.access.rights import require_role
from cnc_ptp.web.numbers import JOG_ENDED, ROUND_TRIP
from cnc_ptp.web.page import Page
from cnc_ptp.web.protocol import Message, error_fields, field

LATE = 0.15
"""Seconds that a message may be late, measured against the quickest one of its page …"""
DRIFT = 1e-3
"""… which counts less with time, by more than clocks differ: s per s."""
LONGEST_ROUND_TRIP = 0.15
"""Seconds to the server and back, as the page measures it with `ping`."""
STANDS = "the axis stops; press the key again"


class Timer(Protocol):
    """What asyncio gives for a call that is due later."""

    def cancel(self) -> None: ...


def call_later(seconds: float, call: Callable[[], None]) -> Timer:
    return asyncio.get_running_loop().call_later(seconds, call)


@dataclass(slots=True)
class Press:
    """A key that is held."""

    sequence: int
    until: float
    """When the next message must be here."""
    silence: Timer


class Jogs:
    """The keys that are held on a page, by axis.

    A jog begins with `sequence` 1. Each message must be here 0.2 s after the one before was sent, however long that one
    was on its way. Otherwise the jog ends: what comes then belongs to the past (a socket that has stalled delivers
    everything at once), so that a new one needs a new press of the key.
    """

    def __init__(
        self,
        session: Page,
        *,
        now: Callable[[], float] = time.monotonic,
        later: Callable[[float, Callable[[], None]], Timer] = call_later,
    ) -> None:
        self._session = session
        self._now, self._later = now, later
        self._held: dict[str, Press] = {}
        self._quickest = float("inf")
        self._quickest_at = 0.0
        self._round_trip = 0.0

    def take(self, message: Message) -> None:
        """`jog`: axis, velocity (mm/s, deg/s), sequence, time (ms, of the page's clock).

        Raises CncError 26111, 26218, 26233, 26235, 26236; one message says that a jog has ended, or does not begin
        (26243, 26259).
        """
        axis, velocity = self._axis(message), field(message, "velocity", "number")
        sequence, sent = field(message, "sequence", "integer"), field(message, "time", "number")
        if velocity == 0.0:
            self._stop(axis)
            return
        self._require_right(axis)
        late = self._lateness(sent * 1e-3)
        if sequence != 1 and axis not in self._held:
            return  # of a jog that has ended
        left = PATIENCE - late - 0.5 * self._round_trip
        reason = self._objection(axis, sequence, late, left)
        if reason is not None:
            self._break_off(axis, reason)
            return
        self._session.hub.require_face().jog(axis, velocity, user=self._session.user)
        self._hold(axis, velocity, sequence, left)

    def _objection(self, axis: str, sequence: int, late: float, left: float) -> CncError | None:
        """Why a message does not count; `late` and how long it counts, in s."""
        press = self._held.get(axis)
        if self._round_trip > LONGEST_ROUND_TRIP:
            text = f"axis {axis}: {self._round_trip * 1e3:.0f} ms to the server and back"
            return CncError(ROUND_TRIP, f"{text}, a jog takes at most {LONGEST_ROUND_TRIP * 1e3:.0f} ms", STANDS)
        if sequence == 1:
            text = f"axis {axis}: the jog came {late:.2f} s late"
            return CncError(JOG_ENDED, text, STANDS) if late > LATE or left <= 0.0 else None
        assert press is not None
        if late > LATE or left <= 0.0 or sequence <= press.sequence or self._now() > press.until:
            return too_late(axis)
        return None

    def _hold(self, axis: str, velocity: float, sequence: int, left: float) -> None:
        before = self._held.get(axis)
        if before is not None:
            before.silence.cancel()
        silence = self._later(left, partial(self._fall_silent, axis))
        self._held[axis] = Press(sequence, self._now() + left, silence)
        if sequence == 1:
            self._note(axis, f"jog with {velocity:g} begins")

    def _fall_silent(self, axis: str) -> None:
        """The next message is not here in time."""
        self._break_off(axis, too_late(axis))

    def take_ping(self, message: Message) -> float:
        """`ping`: time (ms, of the page's clock), round_trip (ms) of the one before. Raises CncError 26233."""
        sent: float = field(message, "time", "number")
        round_trip = field(message, "round_trip", "number", None)
        self._lateness(sent * 1e-3)
        if round_trip is not None:
            self._round_trip = max(0.0, round_trip * 1e-3)
        return sent

    def take_stop(self, message: Message) -> None:
        """`jog_stop`: of an axis."""
        self._stop(self._axis(message))

    def end(self) -> None:
        """Of all axes, now."""
        for axis in [*self._held]:
            self._stop(axis)

    def _axis(self, message: Message) -> str:
        face = self._session.hub.require_face()
        axis: str = field(message, "axis", "text")
        if face.kinds.get(axis) != "axis":
            raise unknown_unit(axis, [name for name, kind in face.kinds.items() if kind == "axis"], "axis")
        return axis

    def _require_right(self, axis: str) -> None:
        what = f"axis {axis}: jog"
        require_role(what, self._session.user, self._session.role, "operator")
        self._session.hub.right.require(self._session, what)

    def _lateness(self, sent: float) -> float:
        """Seconds; `sent` by the page's clock, whose difference to ours is at most that of its quickest message."""
        now = self._now()
        self._quickest += DRIFT * (now - self._quickest_at)
        self._quickest_at = now
        self._quickest = min(self._quickest, now - sent)
        return now - sent - self._quickest

    def _break_off(self, axis: str, error: CncError) -> None:
        self._stop(axis)
        self._session.send({"type": "jog_ended", "axis": axis, **error_fields(error)})

    def _stop(self, axis: str) -> None:
        face = self._session.hub.face
        press = self._held.pop(axis, None)
        if press is not None:
            press.silence.cancel()
        if press is not None and face is not None:
            face.jog(axis, 0.0, user=self._session.user)
            self._note(axis, "jog ends")

    def _note(self, axis: str, what: str) -> None:
        """For the recording: who jogs."""
        face = self._session.hub.require_face()
        face.note(round(face.time / face.cycle_time), f"{self._session.user}: axis {axis}: {what}")


def too_late(axis: str) -> CncError:
    return CncError(JOG_ENDED, f"axis {axis}: the messages of the jog came too late", STANDS)
