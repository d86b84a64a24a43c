"""Samples of every cycle for a page: columns of blocks, unit by unit, brought together by their cycles."""

from __future__ import annotations

import struct
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from cnc_ptp.client.states import AxisState, ChannelState, SpindleState
from cnc_ptp.errors import CncError, nearest_name
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, CycleBlock, SpindleBlock
from cnc_ptp.recording.units import unit_of
from cnc_ptp.web.numbers import NO_SIGNAL, TOO_MANY_SIGNALS
from cnc_ptp.web.protocol import NOTHING

MOST_SIGNALS = 32
"""Of a page."""
HEAD = struct.Struct("<5I")
"""Stream, first cycle (low, high), signals n, samples m; then n columns of m values, little endian."""
COLUMNS: Mapping[str, tuple[str, ...]] = {
    kind: tuple(name for name in state._fields if name in block.__dataclass_fields__)
    for kind, state, block in (
        ("axis", AxisState, AxisBlock),
        ("spindle", SpindleState, SpindleBlock),
        ("channel", ChannelState, ChannelBlock),
    )
}
"""Kind of unit -> fields of its blocks with a value for each cycle."""
Samples = npt.NDArray[np.float64]


class Signal(NamedTuple):
    """A column of a unit."""

    unit: str
    field: str

    @property
    def name(self) -> str:
        return f"{self.unit}.{self.field}"


def signals_of(kinds: Mapping[str, str], lengths: Mapping[str, str]) -> dict[str, list[dict[str, str]]]:
    """Unit -> its columns with their units; `lengths`: axis -> mm or deg."""
    return {
        unit: [{"field": name, "unit": unit_of(name, lengths.get(unit, "mm"), "Nm")} for name in COLUMNS[kind]]
        for unit, kind in kinds.items()
        if kind in COLUMNS
    }


def read_signals(names: Iterable[object], kinds: Mapping[str, str]) -> list[Signal]:
    """Signals by their names, `x.set_position`. Raises CncError 26250, 26251."""
    signals = [read_signal(name, kinds) for name in names]
    if len(signals) > MOST_SIGNALS:
        text = f"scope: {len(signals)} signals are more than {MOST_SIGNALS}"
        raise CncError(TOO_MANY_SIGNALS, text, NOTHING, signals=len(signals), limit=MOST_SIGNALS)
    return signals


def read_signal(name: object, kinds: Mapping[str, str]) -> Signal:
    """Raises CncError 26250."""
    unit, _, field = str(name).partition(".")
    known = COLUMNS.get(kinds.get(unit, ""), ())
    if field not in known:
        names = [f"{each}.{column}" for each, kind in kinds.items() for column in COLUMNS.get(kind, ())]
        raise CncError(
            NO_SIGNAL, f"scope: there is no signal '{str(name)[:60]}'{nearest_name(str(name), names)}", NOTHING
        )
    return Signal(unit, field)


class Stream:
    """The signals of one page, from its making on."""

    def __init__(self, number: int, signals: Sequence[Signal], *, bits: int = 32) -> None:
        """`bits` of a value: 32 or 64."""
        self.number, self.signals = number, signals
        self._type = np.dtype("<f8") if bits == 64 else np.dtype("<f4")
        self._waiting: dict[str, deque[CycleBlock]] = {signal.unit: deque() for signal in signals}
        self.lost = 0
        """Blocks of some unit that have not come."""

    def take(self, blocks: Iterable[tuple[str, CycleBlock]]) -> list[bytes]:
        """Frames of all cycles of which every unit has told by now."""
        for unit, block in blocks:
            if unit in self._waiting:
                self._waiting[unit].append(block)
        return [self._frame(run) for run in runs(self._complete())]

    def _complete(self) -> list[dict[str, CycleBlock]]:
        """The blocks of all units with the same cycles, in their order."""
        found = []
        while self._waiting and all(self._waiting.values()):
            first = max(blocks[0].first_cycle for blocks in self._waiting.values())
            behind = [unit for unit, blocks in self._waiting.items() if blocks[0].first_cycle < first]
            if behind:
                for unit in behind:
                    self._waiting[unit].popleft()
                self.lost += 1
            else:
                found.append({unit: blocks.popleft() for unit, blocks in self._waiting.items()})
        return found

    def _frame(self, run: Sequence[Mapping[str, CycleBlock]]) -> bytes:
        first = next(iter(run[0].values())).first_cycle
        columns = [self._column(run, signal) for signal in self.signals]
        head = HEAD.pack(self.number, first & 0xFFFFFFFF, first >> 32, len(columns), len(columns[0]))
        return head + np.concatenate(columns).tobytes()

    def _column(self, run: Sequence[Mapping[str, CycleBlock]], signal: Signal) -> npt.NDArray[np.generic]:
        values = [value for blocks in run for value in getattr(blocks[signal.unit], signal.field)]
        return np.array(values, dtype=self._type)


def runs(rows: Iterable[dict[str, CycleBlock]]) -> list[list[dict[str, CycleBlock]]]:
    """Rows of blocks whose cycles follow each other, so that a frame has no gap."""
    found: list[list[dict[str, CycleBlock]]] = []
    end = -1
    for row in rows:
        block = next(iter(row.values()))
        if block.first_cycle != end:
            found.append([])
        found[-1].append(row)
        end = block.first_cycle + block.count
    return found
