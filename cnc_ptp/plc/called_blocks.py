"""Function blocks that somebody outside calls: the PLC unit calls each of them once a block until it has ended."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from cnc_ptp.parameters import ParameterSet
from cnc_ptp.plc.plcopen.catalogue import BLOCK_TYPES, checked_type
from cnc_ptp.plc.program.plc_io import KINDS
from cnc_ptp.plc.program.references import Reference
from cnc_ptp.protocol.blocks import Command, CycleBlock

HALTS: Mapping[tuple[str, str], tuple[str, ...]] = {
    ("axis", "MC_MoveSuperimposed"): ("halt_superimposed",),
    ("axis", "MC_GearIn"): ("decouple", "halt"),
    ("axis", "MC_CamIn"): ("decouple", "halt"),
    ("spindle", "MC_GearIn"): ("decouple", "stop"),
}
"""Kind of unit and function block -> commands that end it on the ramp, where it is not `HALT`."""
HALT: Mapping[str, tuple[str, ...]] = {"axis": ("halt",), "spindle": ("stop",)}


class BlockCall:
    """A function block from the rising edge of its `execute` to its end; `execute` is true as long as it is open."""

    def __init__(self, unit: Reference, name: str, block: Any, inputs: Mapping[str, Any]) -> None:
        self.unit = unit
        self.name = name
        self.block = block
        """Its outputs."""
        self._inputs = inputs

    @property
    def ended(self) -> bool:
        block = self.block
        return bool(block.done or block.command_aborted or block.error)

    def cycle(self) -> None:
        self.block(True, **self._inputs)

    def let_go(self) -> None:
        """`execute` falls: an MC_Stop holds the unit no longer. Its outputs could be read for a block."""
        self.block(False)


class CalledBlocks:
    """Open calls of all axes and spindles of a machine."""

    def __init__(
        self, kinds: Mapping[str, str], sets: Mapping[str, ParameterSet], is_lost: Callable[[str], bool]
    ) -> None:
        """`kinds` and `sets`: unit -> kind, parameters."""
        self._is_lost = is_lost
        self._commands: list[Command] = []
        self._calls: list[BlockCall] = []
        self._over: list[BlockCall] = []
        self._units = {
            name: KINDS[kind](name, kind, sets[name], self._commands.append)
            for name, kind in kinds.items()
            if kind in BLOCK_TYPES
        }

    def start(self, unit: str, name: str, inputs: Mapping[str, Any]) -> BlockCall:
        """A new call; its command goes out with the next block. Raises CncError 22001, 22002."""
        reference = self._units[unit]
        found = checked_type(reference.kind, unit, name, inputs)
        call = BlockCall(reference, name, found.make(reference), inputs)
        self._calls.append(call)
        return call

    def cancel(self, call: BlockCall) -> None:
        """The unit halts on its ramp, which ends the call as aborted."""
        unit = call.unit
        for command in HALTS.get((unit.kind, call.name), HALT[unit.kind]):
            self._commands.append(Command(unit.name, command, {}))

    def cycle(self, first_cycle: int, blocks: Mapping[str, CycleBlock]) -> list[Command]:
        """All open calls in the order of their starts; `blocks`: what the units have reported. What they command."""
        for call in self._over:
            call.let_go()
        for name in {call.unit.name: None for call in self._calls}:
            self._units[name].take(blocks.get(name), self._is_lost(name))
        for call in self._calls:
            call.cycle()
        self._over = [call for call in self._calls if call.ended]
        self._calls = [call for call in self._calls if not call.ended]
        commands = [*self._commands]
        self._commands.clear()
        return commands
