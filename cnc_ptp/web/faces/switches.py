"""Switches of units as they were last commanded, and tools as last programmed: blocks do not have them."""

from __future__ import annotations

import json
from typing import Any

from cnc_ptp.protocol.blocks import CommandRecord, HandshakeRequest

SWITCHES = ("single_block", "optional_stop", "block_skip", "feed_hold", "suppress_override", "stop_at_program_end")
TOOLS = {"T": "tool", "D": "tool_data"}
"""Kind of a request -> field of the channel."""


class Switches:
    """Unit -> field -> value."""

    def __init__(self) -> None:
        self.fields: dict[str, dict[str, Any]] = {}

    def take_record(self, record: CommandRecord) -> None:
        """A switch that was commanded, by whomever."""
        if record.accepted and record.command in SWITCHES:
            given = json.loads(record.arguments_json)
            enabled = given.get("enabled", given.get("on"))  # its former name
            self.fields.setdefault(record.target, {})[record.command] = bool(enabled)

    def take_request(self, request: HandshakeRequest) -> None:
        """A tool of a program."""
        if request.kind in TOOLS:
            self.fields.setdefault(request.channel, {})[TOOLS[request.kind]] = request.number
