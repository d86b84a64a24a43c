"""Recordings that begin with a trigger: when a field of a unit comes to a value (as a Scope with a trigger does)."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from cnc_ptp.errors import CncError, nearest_name
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, CycleTick, SpindleBlock
from cnc_ptp.recording.blocks import StateBlock, kind_of
from cnc_ptp.recording.origin import RECORD_WHEN, origin
from cnc_ptp.recording.settings import Settings
from cnc_ptp.recording.writer import AS_USUAL, NO_NOTES, Recording
from cnc_ptp.wire.block_codec import codec_of, head_of
from cnc_ptp.wire.layout import Layout

BAD_CONDITION = 26012
EXAMPLE = "x.set_velocity != 0"
OPERATORS: Mapping[str, Callable[[float, float], bool]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
FORM = re.compile(r"\s*(?P<unit>\w+)[./](?P<field>\w+)\s*(?P<sign>[=!<>]=|[<>])\s*(?P<value>\S+)\s*")
BLOCKS: Mapping[str, type[StateBlock]] = {"axis": AxisBlock, "spindle": SpindleBlock, "channel": ChannelBlock}


class Condition:
    """A comparison of a field of a unit's states with a number."""

    def __init__(self, text: str, kinds: Mapping[str, str]) -> None:
        """`kinds`: unit name -> kind. Raises CncError 26012."""
        self.text = text.strip()
        found = FORM.fullmatch(text)
        if found is None:
            raise self._refusal(f"it is not of the form {EXAMPLE}")
        self.unit, self.field = found["unit"], found["field"]
        units = [name for name, kind in kinds.items() if kind in BLOCKS]
        if self.unit not in units:
            raise self._refusal(f"the machine has no '{self.unit}'. Known: {', '.join(units)}")
        fields = kind_of(BLOCKS[kinds[self.unit]]).columns
        if self.field not in fields:
            raise self._refusal(f"'{self.unit}' has no '{self.field}'{nearest_name(self.field, fields)}")
        self._compare = OPERATORS[found["sign"]]
        self._value = self._number(found["value"])

    def _number(self, text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self._refusal(f"'{text}' is no number")
        return value

    def _refusal(self, reason: str) -> CncError:
        return CncError(BAD_CONDITION, reason, "nothing was started", where=f"--record-when '{self.text}'")

    def holds(self, block: Any) -> bool:
        """Whether it is true in a cycle of a block of the unit."""
        return any(self._compare(value, self._value) for value in getattr(block, self.field))


class TriggeredRecording(Recording):
    """Ticks, blocks and states begin with the block in which a condition is true for the first time.

    Commands and events are recorded from the start of the run, so that it can be computed again. Blocks may come in any
    order: each waits until that of the condition's unit has decided about its cycles.
    """

    def __init__(
        self,
        path: str | Path,
        machine_yaml: str,
        *times: int,
        condition: Condition,
        notes: Mapping[str, str] = NO_NOTES,
        settings: Settings = AS_USUAL,
    ) -> None:
        """`times`: start and cycle time in ns."""
        notes = {RECORD_WHEN: condition.text, **notes}
        super().__init__(path, machine_yaml, *times, notes=notes, settings=settings)
        self._condition = condition
        self.begin: int | None = None
        """The first cycle that is recorded."""
        self._held: list[tuple[int, Callable[[], None]]] = []

    def tick(self, tick: CycleTick, scheduled_monotonic_ns: int = 0) -> None:
        """See Recording."""
        self._keep(tick.first_cycle, partial(super().tick, tick, scheduled_monotonic_ns))

    def checkpoint(self, cycle: int, state: bytes, unit: str = "") -> None:
        """See Recording; none that is older."""
        if self.begin is not None and cycle >= self.begin:
            super().checkpoint(cycle, state, unit)

    def _block(self, name: str, block_class: type, data: bytes, layout: Layout | None = None) -> None:
        first_cycle = head_of(data)[1]
        self._keep(first_cycle, partial(super()._block, name, block_class, data, layout))
        if self.begin is None and name == self._condition.unit:
            self._decide(first_cycle, self._condition.holds(codec_of(block_class).decode(data)))

    def _keep(self, cycle: int, record: Callable[[], None]) -> None:
        if self.begin is None:
            self._held.append((cycle, record))
        elif cycle >= self.begin:
            record()

    def _decide(self, cycle: int, begins: bool) -> None:
        """What is held back for `cycle` and later is recorded, or dropped up to it."""
        held, self._held = self._held, []
        if not begins:
            self._held = [(each, record) for each, record in held if each > cycle]
            return
        self.begin = cycle
        for each, record in sorted(held, key=lambda entry: entry[0]):
            if each >= cycle:
                record()


def make_recording(
    path: str | Path,
    machine_yaml: str,
    start_ns: int,
    cycle_time_ns: int,
    condition: Condition | None,
    settings: Settings = AS_USUAL,
    *,
    notes: Mapping[str, str] = NO_NOTES,
) -> Recording:
    """A recording of the whole run, or one that begins with a condition; `notes` for its metadata."""
    notes = {**origin(), **notes}
    if condition is None:
        return Recording(path, machine_yaml, start_ns, cycle_time_ns, notes=notes, settings=settings)
    return TriggeredRecording(
        path, machine_yaml, start_ns, cycle_time_ns, condition=condition, notes=notes, settings=settings
    )
