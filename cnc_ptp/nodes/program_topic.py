"""The topic of a channel's program: which one is loaded, which are there, where it is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cnc_ptp import msg
from cnc_ptp.channel.channel_unit import ChannelUnit
from cnc_ptp.machine.program_files import available_programs, folder_of
from cnc_ptp.nodes.topics import LATEST, program_topic
from cnc_ptp.protocol.blocks import ChannelBlock

if TYPE_CHECKING:
    from cnc_ptp.nodes.unit.unit_node import UnitNode

PERIOD = 0.1
"""Seconds of machine time between two messages, at least; the start and the end of a program come at once."""


class ProgramTopic:
    """Publishes /<channel>/program (ProgramState) when it has changed."""

    def __init__(self, node: UnitNode, unit: ChannelUnit, *, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self._node, self._unit = node, unit
        self._period_cycles = max(1, round(PERIOD / cycle_time))
        self._publisher = node.create_publisher(msg.ProgramState, program_topic(unit.name), LATEST)
        self._next_cycle = 0
        self._last: dict[str, Any] = {}
        self._listed: tuple[str, bool] | None = None
        self._available: list[str] = []

    def after_block(self, block: ChannelBlock) -> None:
        """Called with each block that was computed."""
        active = self._last.get("active")
        if block.first_cycle < self._next_cycle and (not block.done) == active:
            return
        fields = self._fields(block)
        if fields != self._last:
            self._last = fields
            self._next_cycle = block.first_cycle + self._period_cycles
            message = msg.ProgramState(**fields)
            message.header.stamp = self._node.stamp(block.first_cycle)
            self._publisher.publish(message)

    def _fields(self, block: ChannelBlock) -> dict[str, Any]:
        view = self._unit.program_view
        return {
            "channel": self._unit.name,
            "program": view.program,
            "available": self._programs(view.program, not block.done),
            "state": block.state[-1],
            "active": not block.done,
            "manual": view.manual,
            "file": view.file,
            "line": block.line[-1],
            "block_number": block.block_number[-1],
            "text": view.text,
            "calls": list(view.calls),
            "blocks_done": block.blocks_done,
            "blocks_total": block.blocks_total,
            "percent": 100.0 * block.progress,
            "time_left": block.time_left,
        }

    def _programs(self, program: str, active: bool) -> list[str]:
        """Looked for again when a program is loaded, starts or ends."""
        if self._listed != (program, active):
            self._listed = program, active
            self._available = available_programs(folder_of(program))
        return self._available
