"""The zero offsets of a channel: those of its parameters, and what commands and programs have made of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cnc_ptp.client.record_arguments import record_arguments
from cnc_ptp.parameters import ParameterSet
from cnc_ptp.parameters.view.axis_view import is_facing
from cnc_ptp.parameters.view.channel_view import channel_view
from cnc_ptp.protocol.blocks import ChannelOffsets, CommandRecord, CycleBlock
from cnc_ptp.web.faces.targets import set_position_at
from cnc_ptp.web.protocol import is_of_kind

FIRST_CODE = 53
"""Index 1 is G54."""
LAST_CODE = 59
Rows = Mapping[int, Mapping[str, float | None]]
"""Index -> name of an axis in programs -> its offset in mm (deg); of a facing axis a diameter with P-CHAN-00091.

None: it was taught where its axis stood then, which is not known here, until it is active."""


class OffsetTable:
    """By index and axis, in mm (deg), as they are at the start of the next program."""

    def __init__(self, channel: ParameterSet, sets: Mapping[str, ParameterSet]) -> None:
        view = channel_view(channel, sets, Path())
        tables = view.offsets
        self._units = {axis.name: axis.node for axis in view.axes}
        doubled = [axis.name for axis in view.axes if view.offsets_in_diameters and is_facing(sets[axis.node])]
        self._factors = dict.fromkeys(doubled, 2.0)
        """That make a radius what the table has."""
        self._names = dict(tables.names)
        self._given = tables.zero
        self.begin_again()
        self._told = self.shown()

    def begin_again(self) -> None:
        """As the parameters have them."""
        self._values: dict[int, dict[str, float | None]] = {
            index: dict(zip(self._units, values, strict=False)) for index, values in self._given.items()
        }
        self._below: dict[str, float] = {}
        """What clamp position and tool add to an axis."""

    @property
    def rows(self) -> Rows:
        return {index: dict(row) for index, row in self._values.items()}

    def take_record(self, record: CommandRecord, blocks: Sequence[tuple[str, CycleBlock]]) -> None:
        """A command that has changed an offset; `blocks` that came lately."""
        if not record.accepted or record.command not in ("set_zero_offset", "teach_zero_offset"):
            return
        given = record_arguments(record)
        index: Any = given.get("index")
        axis, value = given.get("axis") or "", given.get("value", 0.0)
        if not (is_of_kind(index, "integer") and is_of_kind(axis, "text") and is_of_kind(value, "number")):
            return
        is_taught = record.command == "teach_zero_offset"
        for name in [name for name in self._units if axis.upper() in ("", name.upper())]:  # not the C axis
            row = self._values.setdefault(index, dict.fromkeys(self._units, 0.0))
            row[name] = self._taught(name, value, record.cycle, blocks) if is_taught else value

    def _taught(self, name: str, value: float, cycle: int, blocks: Sequence[tuple[str, CycleBlock]]) -> float | None:
        """With which the position at a cycle is `value`."""
        position = set_position_at(self._units[name], cycle, blocks)
        if position is None:
            return None
        return (position - self._below.get(name, 0.0) - value) * self._factors.get(name, 1.0)

    def take_active(self, offsets: ChannelOffsets) -> None:
        """What is active now."""
        below = [clamp + tool for clamp, tool in zip(offsets.clamp_offset, offsets.tool_offset, strict=True)]
        self._below = dict(zip(offsets.axes, below, strict=True))
        if offsets.zero_index:
            row = self._values.setdefault(offsets.zero_index, {})
            for name, value in zip(offsets.axes, offsets.zero_offset, strict=False):
                if name in self._units:  # not the C axis, which is a spindle
                    row[name] = value * self._factors.get(name, 1.0)

    def news(self) -> dict[str, Any] | None:
        """As `shown`, when it has changed since the last call."""
        shown = self.shown()
        if shown == self._told:
            return None
        self._told = shown
        return shown

    def shown(self) -> dict[str, Any]:
        """As `offsets` is answered."""
        rows = [
            {"index": index, "name": self._names.get(index, code_of(index)), "values": dict(self._values[index])}
            for index in sorted(self._values)
        ]
        return {"axes": [*self._units], "offsets": rows}


def code_of(index: int) -> str:
    """G54 … G59; others by their index."""
    code = FIRST_CODE + index
    return f"G{code}" if code <= LAST_CODE else f"G159={index}"
