"""Switches of units as they were last commanded, and tools as last programmed: blocks do not have them."""

from __future__ import annotations

from typing import Any

from cnc_ptp.client.record_arguments import record_arguments
from cnc_ptp.protocol.blocks import CommandRecord, HandshakeRequest
from cnc_ptp.protocol.unit import PLC

SWITCHES = (
    "single_block",
    "optional_stop",
    "block_skip",
    "feed_hold",
    "suppress_override",
    "stop_at_program_end",
    "auto_acknowledge",
)
EMERGENCY_STOP = "emergency_stop"
"""Of the plc; that of an axis is no switch."""
TOOLS = {"T": "tool", "D": "tool_data"}
"""Kind of a request -> field of the channel."""


class Switches:
    """Unit -> field -> value."""

    def __init__(self) -> None:
        self.fields: dict[str, dict[str, Any]] = {PLC: {EMERGENCY_STOP: False}}
        self._cycles: dict[tuple[str, str], int] = {}
        """Unit and field -> cycle of what is known."""

    def take_record(self, record: CommandRecord) -> None:
        """A switch that was commanded, by whomever."""
        is_switch = record.command in SWITCHES or (record.target, record.command) == (PLC, EMERGENCY_STOP)
        if record.accepted and is_switch:
            given = record_arguments(record)
            enabled = given.get("enabled", given.get("on"))  # its former name
            self._set(record.target, record.command, bool(enabled), record.cycle)

    def take_request(self, request: HandshakeRequest) -> None:
        """A tool of a program."""
        if request.kind in TOOLS:
            self._set(request.channel, TOOLS[request.kind], request.number, request.cycle)

    def _set(self, unit: str, field: str, value: Any, cycle: int) -> None:
        """Unless something newer is known: what was before the server began may come late."""
        if cycle >= self._cycles.get((unit, field), cycle):
            self._cycles[unit, field] = cycle
            self.fields.setdefault(unit, {})[field] = value
