"""Functions of programs that wait for an acknowledgement, whoever gives it."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection
from dataclasses import fields
from typing import Any

from cnc_ptp.client.record_arguments import record_arguments
from cnc_ptp.protocol.blocks import ChannelBlock, CommandRecord, HandshakeRequest
from cnc_ptp.web.protocol import is_of_kind

KEPT = 1000
"""Numbers that were acknowledged: as many as a server gets that begins late."""


class Handshakes:
    """Requests and the commands that end them may come in any order: some are from before the server began."""

    def __init__(self, channels: Collection[str]) -> None:
        self._channels = channels
        self.waiting: dict[int, dict[str, Any]] = {}
        """By number, as pages get them."""
        self._acknowledged: deque[int] = deque(maxlen=KEPT)
        self._resets: dict[str, int] = {}
        """Channel -> cycle of its last one."""

    def take_request(self, request: HandshakeRequest) -> bool:
        """Whether it waits for somebody."""
        was_reset = request.cycle < self._resets.get(request.channel, 0)
        if not request.acknowledge_needed or was_reset or request.id in self._acknowledged:
            return False
        self.waiting[request.id] = {each.name: getattr(request, each.name) for each in fields(HandshakeRequest)}
        return True

    def take_record(self, record: CommandRecord) -> list[int]:
        """Numbers that wait no longer: they were acknowledged, or their program was reset."""
        if not record.accepted:
            return []
        if record.command == "acknowledge":
            return self._acknowledge(record_arguments(record).get("id"))
        if record.command == "reset" and record.target in self._channels:
            self._resets[record.target] = max(record.cycle, self._resets.get(record.target, 0))
            return self._drop(record.target, record.cycle)
        return []

    def take_block(self, channel: str, block: ChannelBlock) -> list[int]:
        """Numbers of a program that has ended, or was reset: nobody waits for them."""
        return self._drop(channel, block.first_cycle) if block.done else []

    def _acknowledge(self, number: Any) -> list[int]:
        if not is_of_kind(number, "integer"):
            return []
        self._acknowledged.append(number)
        return [] if self.waiting.pop(number, None) is None else [number]

    def _drop(self, channel: str, before: int) -> list[int]:
        """Those of a channel from before a cycle."""
        over = [
            number
            for number, request in self.waiting.items()
            if request["channel"] == channel and request["cycle"] < before
        ]
        for number in over:
            del self.waiting[number]
        return over
