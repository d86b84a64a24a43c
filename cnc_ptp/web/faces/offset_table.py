"""The zero offsets of a channel: those of its parameters, and what commands and programs have made of them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cnc_ptp.parameters import ParameterSet
from cnc_ptp.parameters.view.channel_view import channel_view
from cnc_ptp.protocol.blocks import ChannelOffsets, CommandRecord

FIRST_CODE = 53
"""Index 1 is G54."""
LAST_CODE = 59


class OffsetTable:
    """By index and axis, in mm (deg). None: it was taught, and is not known before it is active."""

    def __init__(self, channel: ParameterSet, sets: Mapping[str, ParameterSet]) -> None:
        view = channel_view(channel, sets, Path())
        tables = view.offsets
        self._axes = [axis.name for axis in view.axes]
        self._names = dict(tables.names)
        self._given = tables.zero
        self.begin_again()

    def begin_again(self) -> None:
        """As the parameters have them."""
        self._values: dict[int, dict[str, float | None]] = {
            index: dict(zip(self._axes, values, strict=False)) for index, values in self._given.items()
        }

    def take_record(self, record: CommandRecord) -> None:
        """A command that has changed an offset."""
        if not record.accepted or record.command not in ("set_zero_offset", "teach_zero_offset"):
            return
        given = json.loads(record.arguments_json)
        row = self._values.setdefault(given["index"], dict.fromkeys(self._axes, 0.0))
        taught = record.command == "teach_zero_offset"
        for axis in [given["axis"]] if given.get("axis") else self._axes:
            name = next((each for each in self._axes if each.upper() == axis.upper()), axis)
            row[name] = None if taught else given["value"]

    def take_active(self, offsets: ChannelOffsets) -> None:
        """What is active now."""
        if offsets.zero_index:
            row = self._values.setdefault(offsets.zero_index, {})
            row.update(zip(offsets.axes, offsets.zero_offset, strict=False))

    def shown(self) -> dict[str, Any]:
        """As `offsets` is answered."""
        rows = [
            {"index": index, "name": self._names.get(index, code_of(index)), "values": self._values[index]}
            for index in sorted(self._values)
        ]
        return {"axes": self._axes, "offsets": rows}


def code_of(index: int) -> str:
    """G54 … G59; others by their index."""
    code = FIRST_CODE + index
    return f"G{code}" if code <= LAST_CODE else f"G159={index}"
