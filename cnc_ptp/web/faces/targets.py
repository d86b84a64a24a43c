"""Where axes go: blocks do not have it, the records of their commands do."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from cnc_ptp.client.record_arguments import record_arguments
from cnc_ptp.protocol.blocks import AxisBlock, CommandRecord, CycleBlock
from cnc_ptp.web.protocol import is_of_kind

ABSOLUTE = frozenset({"move_absolute", "new_target", "new_velocity_and_target"})
ELSEWHERE = frozenset({"move_modulo", "move_velocity", "home", "set_position", "stop", "halt", "emergency_stop", "jog"})
"""Afterwards no target is known."""


class Targets:
    """Axis -> end position of its last positioning (mm, deg); None: not known."""

    def __init__(self, axes: Sequence[str]) -> None:
        self.positions: dict[str, float | None] = dict.fromkeys(axes)

    def take_record(self, record: CommandRecord, blocks: Sequence[tuple[str, CycleBlock]]) -> None:
        """A command that was given, by whomever; `blocks` that came lately."""
        if not record.accepted or record.target not in self.positions:
            return
        axis, command, given = record.target, record.command, record_arguments(record)
        if command in ABSOLUTE:
            self.positions[axis] = sum_of(0.0, given.get("target"))
        elif command == "move_additive":
            self.positions[axis] = sum_of(self.positions[axis], given.get("distance"))
        elif command == "move_relative":
            self.positions[axis] = sum_of(set_position_at(axis, record.cycle, blocks), given.get("distance"))
        elif command in ELSEWHERE:
            self.positions[axis] = None

    def fields(self, axis: str) -> dict[str, Any]:
        """Of the state of an axis; empty for other units."""
        return {"target": self.positions[axis]} if axis in self.positions else {}


def sum_of(begin: float | None, distance: Any) -> float | None:
    return begin + distance if begin is not None and is_of_kind(distance, "number") else None


def set_position_at(axis: str, cycle: int, blocks: Sequence[tuple[str, CycleBlock]]) -> float | None:
    """At the start of a cycle: of its block, or of a standstill before it; None where it is not known."""
    before = [block for unit, block in blocks if unit == axis and block.first_cycle < cycle]
    if not before or not isinstance(block := before[-1], AxisBlock):
        return None
    place = cycle - 1 - block.first_cycle
    if place < block.count:
        return block.set_position[place]
    return block.set_position[-1] if block.set_velocity[-1] == 0.0 else None
