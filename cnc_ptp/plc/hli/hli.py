"""The HLI of a machine: all its objects, between the messages of external PLCs and the blocks of the PLC unit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from cnc_ptp.plc.hli.messages import ControlMessage
from cnc_ptp.plc.hli.object_control import NOT_HIS, ObjectControl
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.protocol.blocks import Command, CycleBlock, PlcBlock, Severity
from cnc_ptp.protocol.unit import PLC


class Hli:
    """Takes messages at any time; each block of the PLC gets the commands that they stand for."""

    def __init__(
        self,
        plc: PlcUnit,
        *,
        kinds: Mapping[str, str],
        largest_overrides: Mapping[str, float],
        timeout: float,
        numbers: Mapping[str, int],
    ) -> None:
        """`kinds` and logical `numbers` of the units by name, `largest_overrides` in percent.

        `timeout` as ObjectControl.
        """
        self._plc = plc
        self._notes: list[tuple[int, str]] = []
        self._served: set[str] = set()
        self.objects = {
            name: ObjectControl(
                name,
                kind,
                largest_override=largest_overrides[name],
                timeout=timeout,
                tell=self._note,
                masters={number: unit for unit, number in numbers.items() if kinds[unit] == kind},
            )
            for name, kind in kinds.items()
            if kind != "plc"
        }
        plc.outside.append(self.commands)

    def _note(self, number: int, text: str) -> None:
        self._notes.append((number, text))

    def take(self, name: str, message: ControlMessage, now: float) -> bool:
        """A message for an object, at `now` in s; as ObjectControl."""
        return self.objects[name].take(message, now)

    def watch(self, now: float) -> None:
        """Objects whose PLC has fallen silent become free."""
        for control in self.objects.values():
            control.watch(now)

    def commands(self, cycle: int, inputs: Mapping[str, CycleBlock]) -> Iterable[Command]:
        """The commands for the block that begins at `cycle`, from what has come and what objects have reported."""
        commands: list[Command] = []
        for name, control in self.objects.items():
            block = inputs.get(name)
            if block is not None and not isinstance(block, PlcBlock):
                control.read(block)
            self._serve(cycle, name, serves=control.serves_functions)
            self._acknowledge(cycle, control)
            commands += control.commands()
        for number, text in self._taken_notes():
            self._plc.event(cycle, Severity.WARNING, number, text)
        return commands

    def _taken_notes(self) -> Iterator[tuple[int, str]]:
        notes, self._notes = self._notes, []
        yield from notes

    def _serve(self, cycle: int, name: str, *, serves: bool) -> None:
        """The PLC unit must know who answers functions."""
        if serves == (name in self._served):
            return
        (self._served.add if serves else self._served.discard)(name)
        self._plc.command(Command(PLC, "serve", {"unit": name, "enabled": serves}), cycle)

    def _acknowledge(self, cycle: int, control: ObjectControl) -> None:
        """Refused (22013) where no such request waits, and where it is that of another channel."""
        for number in control.take_acknowledgements():
            channel = self._plc.channel_of(number)
            if channel not in (None, control.name):
                control.tell(NOT_HIS, f"request {number} is one of {channel}; nothing was changed")
            else:
                self._plc.command(Command(PLC, "acknowledge", {"id": number}), cycle)
