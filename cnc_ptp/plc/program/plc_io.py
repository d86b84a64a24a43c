"""What a PLC in a file sees and does: units, handshakes, inputs, events, the end of the run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, TypeVar

from cnc_ptp.errors import nearest_name
from cnc_ptp.parameters import ParameterSet
from cnc_ptp.plc.program.references import (
    WRITE_PARAMETER,
    AxisReference,
    ChannelReference,
    Reference,
    Send,
    SpindleReference,
)
from cnc_ptp.protocol.blocks import ChannelBlock, Command, CycleBlock, CycleTick, HandshakeRequest
from cnc_ptp.protocol.unit import PLC

KINDS: Mapping[str, type[Reference]] = {
    "axis": AxisReference,
    "spindle": SpindleReference,
    "channel": ChannelReference,
}
R = TypeVar("R", bound=Reference)


class PlcIo:
    """The machine in one PLC cycle. What the PLC commands acts in the cycle block that begins with `cycle`."""

    def __init__(
        self,
        kinds: Mapping[str, str],
        sets: Mapping[str, ParameterSet],
        *,
        cycle_time: float,
        requests: Mapping[int, HandshakeRequest],
        inputs: Mapping[str, float],
        finished: bool,
    ) -> None:
        """`kinds` and `sets`: unit name -> kind, parameters. `cycle_time` in s. `requests` that wait, and `inputs`:
        views of what the PLC unit has. `finished`: the run may end without a word of the PLC.
        """
        self.cycle = 0
        """First cycle of the block for which the PLC is called."""
        self.block_cycles = 0
        """Cycles of that block."""
        self.cycle_time = cycle_time
        """Seconds of a cycle."""
        self.functions: tuple[HandshakeRequest, ...] = ()
        """M, S, T, D and H functions that the channels have sent with the last block."""
        self.inputs = MappingProxyType(inputs)
        """Values from outside by name (`set_input`)."""
        self.finished = finished
        self._requests = requests
        self._commands: list[Command] = []
        self._events: list[str] = []
        send: Send = self._commands.append
        self.units = {name: KINDS[kind](name, kind, sets[name], send) for name, kind in kinds.items() if kind in KINDS}
        """All axes, spindles and channels by name."""

    # what it sees

    @property
    def time(self) -> float:
        """Seconds of the machine since the start of the run."""
        return self.cycle * self.cycle_time

    @property
    def requests(self) -> tuple[HandshakeRequest, ...]:
        """Functions that wait for an acknowledgement, in their order."""
        return tuple(self._requests.values())

    def axis(self, name: str) -> AxisReference:
        """Raises LookupError when the machine has no axis of this name; `spindle` and `channel` likewise."""
        return self._unit(name, AxisReference, "axis")

    def spindle(self, name: str) -> SpindleReference:
        return self._unit(name, SpindleReference, "spindle")

    def channel(self, name: str) -> ChannelReference:
        return self._unit(name, ChannelReference, "channel")

    def _unit(self, name: str, kind: type[R], word: str) -> R:
        unit = self.units.get(name)
        if isinstance(unit, kind):
            return unit
        known = [each for each, unit in self.units.items() if isinstance(unit, kind)]
        near = nearest_name(str(name), known)
        raise LookupError(f"the machine has no {word} '{name}'{near}. Known: {', '.join(known) or 'none'}")

    # what it does

    def acknowledge(self, id: int) -> None:
        """Acknowledges a request."""
        self._commands.append(Command(PLC, "acknowledge", {"id": id}))

    def auto_acknowledge(self, enabled: bool) -> None:
        """Whether all requests and gear changes are acknowledged without the PLC in the file; on without a word."""
        self._commands.append(Command(PLC, "auto_acknowledge", {"enabled": enabled}))

    def follow_trajectory(self, axes: Sequence[str], points: Sequence[Sequence[Any]], **options: Any) -> None:
        """Axes follow a trajectory together, as the command of the same name; a refusal is an event of the PLC."""
        self._commands.append(Command(PLC, "follow_trajectory", {"axes": [*axes], "points": [*points], **options}))

    def event(self, text: str) -> None:
        """An event on /events and in the recording."""
        self._events.append(str(text))

    def done(self, finished: bool = True) -> None:
        """The run may end as soon as everything is at a standstill; False: it may not, whatever has ended."""
        self.finished = bool(finished)

    # for the PLC unit

    def begin(self, tick: CycleTick, blocks: Mapping[str, CycleBlock], lost: Iterable[str]) -> None:
        """The machine as it is for the block of `tick`."""
        self.cycle, self.block_cycles = tick
        lost = set(lost)
        for name, unit in self.units.items():
            unit.take(blocks.get(name), name in lost)
        channels = [block for block in blocks.values() if isinstance(block, ChannelBlock)]
        self.functions = tuple(request for channel in channels for request in channel.requests)

    def take_commands(self) -> list[Command]:
        """What has been commanded since the last call."""
        commands = [*self._commands]
        self._commands.clear()
        return commands

    def release_stops(self) -> list[Command]:
        """The PLC is not called again: what its MC_Stop hold is released."""
        held = [unit for unit in self.units.values() if unit.stops]
        for unit in held:
            unit.stops = 0
        return [Command(unit.name, "hold_stop", {"enabled": False}) for unit in held]

    def take_events(self) -> list[str]:
        events, self._events = self._events, []
        return events

    def note_writes(self, commands: Iterable[Command]) -> None:
        """Parameters that a scenario writes."""
        for command in commands:
            if command.command == WRITE_PARAMETER and command.target in self.units:
                self.units[command.target].note_write(command)
