"""Where axes go: blocks do not have it, the records of their commands do."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from cnc_ptp.protocol.blocks import AxisBlock, CommandRecord, CycleBlock

ABSOLUTE = frozenset({"move_absolute", "new_target", "new_velocity_and_target"})
ELSEWHERE = frozenset({"move_modulo", "move_velocity", "home", "set_position", "stop", "halt", "emergency_stop", "jog"})
"""Afterwards no target is known."""


class Targets:
    """Axis -> end position of its last positioning (mm, deg); None: not known."""

    def __init__(self, axes: Sequence[str]) -> None:
        self.positions: dict[str, float | None] = dict.fromkeys(axes)

    def take_record(
        self, record: CommandRecord, blocks: Sequence[tuple[str, CycleBlock]], state: Mapping[str, Any]
    ) -> None:
        """A command that was given, by whomever; `blocks` that came with it, `state` of the units before."""
        if not record.accepted or record.target not in self.positions:
            return
        axis, command = record.target, record.command
        given = json.loads(record.arguments_json)
        if command in ABSOLUTE:
            self.positions[axis] = given["target"]
        elif command == "move_additive":
            begin = self.positions[axis]
            self.positions[axis] = None if begin is None else begin + given["distance"]
        elif command == "move_relative":
            begin = set_position_at(axis, record.cycle, blocks, state)
            self.positions[axis] = None if begin is None else begin + given["distance"]
        elif command in ELSEWHERE:
            self.positions[axis] = None

    def fields(self, axis: str) -> dict[str, Any]:
        """Of the state of an axis; empty for other units."""
        return {"target": self.positions[axis]} if axis in self.positions else {}


def set_position_at(
    axis: str, cycle: int, blocks: Sequence[tuple[str, CycleBlock]], state: Mapping[str, Any]
) -> float | None:
    """At the start of a cycle: of its block, or of a standstill; None where it is not known."""
    for unit, block in blocks:
        if unit == axis and isinstance(block, AxisBlock) and 0 <= cycle - 1 - block.first_cycle < block.count:
            return block.set_position[cycle - 1 - block.first_cycle]
    fields = state.get(axis, {})
    return fields.get("set_position") if fields.get("set_velocity") == 0.0 else None
