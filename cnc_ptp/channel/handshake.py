"""Handshake of a channel with the PLC: functions that wait for its acknowledgement (P-MACH-00060)."""

from __future__ import annotations

from collections.abc import Iterable

from cnc_ptp.protocol.blocks import HandshakeRequest

UNSENT = -1
"""Cycle of a request that is still to go out with the next block."""


class Handshake:
    """The open requests by number: sent, or about to be, and not acknowledged."""

    def __init__(self) -> None:
        self._open: dict[int, HandshakeRequest] = {}

    def __contains__(self, request_id: object) -> bool:
        return request_id in self._open

    @property
    def open_ids(self) -> list[int]:
        return sorted(self._open)

    def add(self, requests: Iterable[HandshakeRequest]) -> None:
        """Those that the PLC need not acknowledge are left out."""
        self._open |= {request.id: request for request in requests if request.acknowledge_needed}

    def acknowledge(self, request_id: int) -> HandshakeRequest | None:
        """The PLC has acknowledged; the request, unless it has not gone out yet. KeyError for one that is not open."""
        request = self._open.pop(request_id)
        return None if request.cycle == UNSENT else request

    def overdue(self, cycle: int, limit: int) -> HandshakeRequest | None:
        """The oldest request that the PLC has left unacknowledged for `limit` cycles."""
        sent = (request for request in self._open.values() if request.cycle != UNSENT)
        return next((request for request in sent if cycle - request.cycle >= limit), None)

    def clear(self) -> None:
        """The program has ended: nobody waits any longer."""
        self._open.clear()
