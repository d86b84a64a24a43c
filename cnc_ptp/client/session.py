"""Gives commands, waits, passes on what comes: the same for an offline machine and the graph."""

from __future__ import annotations

from collections.abc import Callable, Generator
from math import inf
from typing import Any

from cnc_ptp.client.faults import CLOSED, IT_CONTINUES, NOTHING_MOVES, TIMEOUT, error_of, no_recorder
from cnc_ptp.client.link import Link, Reply
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import HandshakeRequest
from cnc_ptp.protocol.unit import PLC

Turns = Generator[float, None, None]
"""What waits: each value is the number of seconds that it can wait for something to come."""
Answering = Callable[[HandshakeRequest], object]


class Session:
    """Everything that units, jobs and streams of a machine share."""

    def __init__(self, link: Link) -> None:
        self.link = link
        self.closed = False
        self.in_plc_cycle = False
        """A cycle of `plc_cycles` is served: no time passes in it."""
        self._answering: Answering | None = None
        self._dispatches = False

    @property
    def time(self) -> float:
        """Seconds of the machine, of which every unit has told."""
        return self.link.seen.cycle * self.link.cycle_time

    # commands

    def ask(self, unit: str, command: str, arguments: dict[str, Any]) -> Reply:
        """Gives a command and waits for its answer. Raises the unit's refusal, and CncError 26171, 26172."""
        self.require_open(f"{self.link.kinds[unit]} {unit}: {command}")
        return self._answered(self.link.give(unit, command, arguments))

    def _answered(self, ticket: int) -> Reply:
        while (reply := self.link.answer(ticket)) is None:
            self.link.turn(inf)
        if reply.error_id:
            raise error_of(reply.error_id, reply.message, reply.values)
        return reply

    def ask_recorder(self, command: str, arguments: dict[str, Any]) -> Reply:
        """The same to the recorder, which is no unit. Raises its refusal, and CncError 26136, 26171, 26172, 26221."""
        self.require_open(f"recorder: {command}")
        if not self.link.has_recorder:
            raise no_recorder(command)
        return self._answered(self.link.give_recorder(command, arguments))

    def require_open(self, what: str) -> None:
        if self.closed:
            raise CncError(CLOSED, f"{what}: the machine was closed", "nothing was sent")

    # waiting

    def until(
        self,
        condition: Callable[[], bool],
        timeout: float | None,
        what: str,
        *,
        effect: str = IT_CONTINUES,
        may_stall: bool = False,
    ) -> Turns:
        """Ends when the condition has come true.

        Raises CncError 26170 after `timeout` seconds; without one 26174 where it would wait for ever, unless that
        `may_stall`.
        """
        begin = self.link.now
        while not condition():
            self.require_open(what)
            left = inf if timeout is None else timeout - (self.link.now - begin)
            if left <= 0.0:
                raise CncError(TIMEOUT, f"{what} after {timeout:g} s{self.link.clock}", effect)
            reason = None if may_stall or timeout is not None else self.link.stalled
            if reason is not None:
                raise CncError(NOTHING_MOVES, f"{what}: {reason}", effect)
            yield left
            self._dispatch()

    def run(self, turns: Turns) -> None:
        """Waits in this thread; a signal acts between two turns, and the wait continues if it does not end it."""
        while not self._run_to_signal(turns):
            pass

    def _run_to_signal(self, turns: Turns) -> bool:
        """True when the wait has ended."""
        with self.link.waiting() as held:
            for seconds in turns:
                self.link.turn(seconds)
                if held is not None and held.given:
                    return False
        return True

    async def run_async(self, turns: Turns) -> None:
        """Waits as a part of an event loop."""
        for seconds in turns:
            await self.link.turn_async(seconds)

    # requests of channels

    def on_handshake(self, answering: Answering | None) -> None:
        """Who gets the requests of channels from now on."""
        self._answering = answering
        if answering is not None:
            self.link.seen.requests.clear()

    def _dispatch(self) -> None:
        """Hands on what has come; a wait within that does not do so again."""
        if self._answering is None or self._dispatches:
            return
        self._dispatches = True
        try:
            for request in self.link.seen.known_requests():
                if self._answering(request) is True and request.acknowledge_needed:
                    self.ask(PLC, "acknowledge", {"id": request.id})
        finally:
            self._dispatches = False
