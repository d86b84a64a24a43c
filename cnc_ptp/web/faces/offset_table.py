"""The zero offsets of a channel: those of its parameters, and what commands and programs have made of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cnc_ptp.nc.coordinates.coordinates import NO_CHANGES, OffsetChanges
from cnc_ptp.parameters import ParameterSet
from cnc_ptp.parameters.view.axis_view import is_facing
from cnc_ptp.parameters.view.channel_view import channel_view
from cnc_ptp.protocol.blocks import ChannelOffsets

FIRST_CODE = 53
"""Index 1 is G54."""
LAST_CODE = 59


class OffsetTable:
    """By index and axis, in mm (deg), as they are at the start of the next program; and its clamp position."""

    def __init__(self, channel: ParameterSet, sets: Mapping[str, ParameterSet]) -> None:
        view = channel_view(channel, sets, Path())
        self._tables = view.offsets
        self._axes = view.path_axes
        self._shown_axes = [axis.name for axis in view.axes]
        """Without the C axis, which is a spindle."""
        doubled = [axis.name for axis in view.axes if view.offsets_in_diameters and is_facing(sets[axis.node])]
        self._factors = dict.fromkeys(doubled, 2.0)
        """That make a radius what the table has."""
        self.changes, self.clamp_index = NO_CHANGES, 0
        self._cycle = -1
        """Of what is known."""
        self._told = (self.changes, self.clamp_index)

    def begin_again(self) -> None:
        """As the parameters have them."""
        self.changes, self.clamp_index = NO_CHANGES, 0
        self._cycle = -1

    def take(self, offsets: ChannelOffsets) -> None:
        """What the channel has told; it may come late, the newest counts."""
        if offsets.cycle >= self._cycle and is_whole(offsets, self._axes):
            self._cycle = offsets.cycle
            self.changes, self.clamp_index = changes_of(offsets), offsets.clamp_index
            if self.changes.default == self._tables.default:
                self.changes = self.changes._replace(default=-1)

    def news(self) -> dict[str, Any] | None:
        """As `shown`, when it, the C axis or the clamp position has changed since the last call."""
        now = (self.changes, self.clamp_index)
        if now == self._told:
            return None
        self._told = now
        return self.shown()

    def shown(self) -> dict[str, Any]:
        """As `offsets` is answered."""
        given, changed = self._tables.zero, self.changes
        indices = sorted({*given, *self._tables.inactive, *changed.values, *changed.inactive})
        default = self._tables.default if changed.default < 0 else changed.default
        return {"axes": self._shown_axes, "default": default, "offsets": [self._row(index) for index in indices]}

    def _row(self, index: int) -> dict[str, Any]:
        off = self._tables.inactive.get(index, frozenset())
        inactive = {self._axes[place] for place in self.changes.inactive.get(index, off)}
        values = self._values(index)
        return {
            "index": index,
            "name": self._tables.names.get(index, code_of(index)),
            "values": {name: values[name] for name in self._shown_axes},
            "inactive": [name for name in self._shown_axes if name in inactive],
        }

    def _values(self, index: int) -> dict[str, float]:
        """As a machine file has them."""
        if (changed := self.changes.values.get(index)) is not None:
            return {name: value * self._factors.get(name, 1.0) for name, value in zip(self._axes, changed, strict=True)}
        return dict(zip(self._axes, self._tables.zero.get(index, (0.0,) * len(self._axes)), strict=False))


def is_whole(offsets: ChannelOffsets, axes: Sequence[str]) -> bool:
    """False for what no channel with these axes sends."""
    wanted = len(offsets.changed_indices) * len(axes)
    return [*offsets.axes] == [*axes] and len(offsets.changed_offsets) == len(offsets.changed_inactive) == wanted


def changes_of(offsets: ChannelOffsets) -> OffsetChanges:
    """As the interpreter has them; radii."""
    count = len(offsets.axes)
    values, inactive = {}, {}
    for number, index in enumerate(offsets.changed_indices):
        row = slice(number * count, (number + 1) * count)
        values[index] = tuple(offsets.changed_offsets[row])
        inactive[index] = frozenset(place for place, off in enumerate(offsets.changed_inactive[row]) if off)
    return OffsetChanges(values, inactive, offsets.default_index)


def code_of(index: int) -> str:
    """G54 … G59; others by their index."""
    code = FIRST_CODE + index
    return f"G{code}" if code <= LAST_CODE else f"G159={index}"
