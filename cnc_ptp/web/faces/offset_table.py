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
SET, TEACH = "set_zero_offset", "teach_zero_offset"
OFFSET_COMMANDS = (SET, TEACH)
Rows = Mapping[int, Mapping[str, float | None]]
"""Index -> name of an axis in programs -> its offset in mm (deg); of a facing axis a diameter with P-CHAN-00091.

None: it was taught where its axis stood then, which is not known here, until it is active."""


class OffsetTable:
    """By index and axis, in mm (deg), as they are at the start of the next program; and its clamp position.

    Commands and active offsets may come late, in any order: of each value the newest counts.
    """

    def __init__(self, channel: ParameterSet, sets: Mapping[str, ParameterSet]) -> None:
        view = channel_view(channel, sets, Path())
        tables = view.offsets
        self._axes = view.path_axes
        self._units = {axis.name: axis.node for axis in view.axes}
        """Without the C axis, which is a spindle."""
        doubled = [axis.name for axis in view.axes if view.offsets_in_diameters and is_facing(sets[axis.node])]
        self._factors = dict.fromkeys(doubled, 2.0)
        """That make a radius what the table has."""
        self._names = dict(tables.names)
        self._given = tables.zero
        self.begin_again()
        self._told = (self.rows, self.clamp_index)

    def begin_again(self) -> None:
        """As the parameters have them."""
        self._values: dict[int, dict[str, float | None]] = {
            index: dict(zip(self._axes, values, strict=False)) for index, values in self._given.items()
        }
        self._changed: dict[tuple[int, str], int] = {}
        """Index and axis -> cycle of what its value is from."""
        self._active: ChannelOffsets | None = None
        """The newest that is known."""

    @property
    def rows(self) -> Rows:
        return {index: dict(row) for index, row in self._values.items()}

    @property
    def clamp_index(self) -> int:
        return 0 if self._active is None else self._active.clamp_index

    def take_record(self, record: CommandRecord, blocks: Sequence[tuple[str, CycleBlock]]) -> None:
        """A command that has changed an offset; `blocks` that came lately."""
        if not record.accepted or record.command not in OFFSET_COMMANDS:
            return
        given = record_arguments(record)
        index: Any = given.get("index")
        axis, value = given.get("axis") or "", given.get("value", 0.0)
        if not (is_of_kind(index, "integer") and is_of_kind(axis, "text") and is_of_kind(value, "number")):
            return
        is_taught = record.command == TEACH
        for name in [name for name in self._axes if axis.upper() in ("", name.upper())]:
            taught = self._taught(name, value, record.cycle, blocks) if is_taught else value
            self._set(index, name, taught, record.cycle)

    def _set(self, index: int, name: str, value: float | None, cycle: int) -> None:
        """Unless something newer is known."""
        if cycle >= self._changed.get((index, name), cycle):
            self._changed[index, name] = cycle
            self._values.setdefault(index, dict.fromkeys(self._axes, 0.0))[name] = value

    def _taught(self, name: str, value: float, cycle: int, blocks: Sequence[tuple[str, CycleBlock]]) -> float | None:
        """With which the position at a cycle is `value`; None where it is not known what lies below."""
        below = below_zero_offset(self._active, name)
        position = set_position_at(self._units.get(name, ""), cycle, blocks)
        if position is None or below is None:
            return None
        return (position - below - value) * self._factors.get(name, 1.0)

    def take_active(self, offsets: ChannelOffsets) -> None:
        """What is active from its cycle on. The values of the zero offset are those with which it was selected."""
        before, selected = self._active, selected_values(offsets)
        if before is None or before.cycle <= offsets.cycle:
            self._active = offsets
            selected = dict(selected.items() - selected_values(before).items())
        for (index, name), value in selected.items():
            if index:
                self._set(index, name, value * self._factors.get(name, 1.0), offsets.cycle)

    def news(self) -> dict[str, Any] | None:
        """As `shown`, when it, the C axis or the clamp position has changed since the last call."""
        now = (self.rows, self.clamp_index)
        if now == self._told:
            return None
        self._told = now
        return self.shown()

    def shown(self) -> dict[str, Any]:
        """As `offsets` is answered."""
        rows = [
            {
                "index": index,
                "name": self._names.get(index, code_of(index)),
                "values": {name: value for name, value in self._values[index].items() if name in self._units},
            }
            for index in sorted(self._values)
        ]
        return {"axes": [*self._units], "offsets": rows}


def selected_values(offsets: ChannelOffsets | None) -> dict[tuple[int, str], float]:
    """Index and axis -> value of the zero offset that is selected."""
    if offsets is None:
        return {}
    return {(offsets.zero_index, name): value for name, value in zip(offsets.axes, offsets.zero_offset, strict=False)}


def below_zero_offset(offsets: ChannelOffsets | None, name: str) -> float | None:
    """What clamp position and tool add to an axis; None where that is not known, or axes are not what programs name."""
    if offsets is None or offsets.machine_coordinates or offsets.origin or name not in offsets.axes:
        return None
    place = offsets.axes.index(name)
    if place >= min(len(offsets.clamp_offset), len(offsets.tool_offset)):  # no channel sends that
        return None
    return offsets.clamp_offset[place] + offsets.tool_offset[place]


def code_of(index: int) -> str:
    """G54 … G59; others by their index."""
    code = FIRST_CODE + index
    return f"G{code}" if code <= LAST_CODE else f"G159={index}"
