"""Queue of external setpoints in the PLC: each goes out with the block of its cycle."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from heapq import heappop, heappush
from itertools import count

from cnc_ptp.axis.external_commands import SETPOINTS
from cnc_ptp.axis.faults import BAD_SETPOINT
from cnc_ptp.errors import Value
from cnc_ptp.plc.setpoint_file import SetpointRow
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.blocks import AxisBlock, Command, CycleBlock

HORIZON = 60.0
"""Seconds that a setpoint of a topic may be ahead."""

Warn = Callable[[int, int, str, Mapping[str, Value]], None]
"""Takes a warning: cycle, number, text, and the numbers of the text by name."""
Waiting = list[tuple[int, int, SetpointRow]]
"""A heap: cycle, order of arrival, row."""


class SetpointQueue:
    """Rows by axis, from scenario files and from topics, in any order of their cycles.

    What waits is dropped when the axis' external setpoints end: nothing of it may move the axis after the next enable.
    """

    def __init__(self, *, cycle_time: float, warn: Warn) -> None:
        """`cycle_time` in s; `warn` gets the rows of topics that are dropped."""
        self._warn = warn
        self._horizon = round(HORIZON / cycle_time)
        self._waiting: dict[str, Waiting] = {}
        self._arrived: dict[str, list[SetpointRow]] = {}
        self._enabled: set[str] = set()
        self._newest_sent: dict[str, int] = {}
        self._numbers = count()

    def __bool__(self) -> bool:
        return any(self._waiting.values()) or any(self._arrived.values())

    def add(self, axis: str, rows: Iterable[SetpointRow]) -> None:
        """Rows of a scenario, with their cycles."""
        for row in rows:
            heappush(self._waiting.setdefault(axis, []), (row[0], next(self._numbers), row))

    def arrive(self, axis: str, row: SetpointRow) -> None:
        """A row of a topic; cycle 0 means the next block: those that come within one block are spread over the next."""
        self._arrived.setdefault(axis, []).append(row)

    def clear(self) -> None:
        self._waiting.clear()
        self._arrived.clear()
        self._newest_sent.clear()

    def watch(self, inputs: Mapping[str, CycleBlock]) -> None:
        """Drops what waits for an axis whose external setpoints have ended."""
        blocks = {name: block for name, block in inputs.items() if isinstance(block, AxisBlock)}
        enabled = {name for name, block in blocks.items() if block.status_bits[-1] & StatusBit.EXT_SETPOINT}
        for axis in self._enabled - enabled:
            self._waiting.pop(axis, None)
            self._newest_sent.pop(axis, None)
        self._enabled = enabled

    def take(self, first_cycle: int, count: int) -> Iterator[Command]:
        """The commands of a block of `count` cycles; late rows go out too.

        A row that was overtaken goes out separately: the axis refuses a command as a whole.
        """
        for axis, arrived in self._arrived.items():
            self._place(axis, arrived, first_cycle, count)
        self._arrived.clear()
        for axis, waiting in self._waiting.items():
            rows: list[SetpointRow] = []
            while waiting and waiting[0][0] < first_cycle + count:
                row = heappop(waiting)[2]
                if row[0] <= self._newest_sent.get(axis, -1):
                    yield Command(axis, SETPOINTS, {"setpoints": [row]})
                    continue
                if rows and rows[-1][0] == row[0]:  # the later of two for one cycle
                    rows.pop()
                rows.append(row)
            if rows:
                self._newest_sent[axis] = rows[-1][0]
                yield Command(axis, SETPOINTS, {"setpoints": rows})

    def _place(self, axis: str, arrived: list[SetpointRow], first_cycle: int, count: int) -> None:
        """An end of the motion withdraws the rows for later cycles; a row too far ahead is dropped."""
        unplaced = [row for row in arrived if not row[0]][-count:]
        spread = {id(row): first_cycle + n * count // len(unplaced) for n, row in enumerate(unplaced)}
        for row in arrived:
            cycle = row[0] or spread.get(id(row))
            if cycle is None:
                continue
            if cycle > first_cycle + self._horizon:
                ahead = f"it lies more than {HORIZON:g} s ahead of cycle {first_cycle}"
                text = f"axis {axis}: external setpoint for cycle {cycle} dropped: {ahead}"
                self._warn(first_cycle, BAD_SETPOINT, text, {"patience": HORIZON})
                continue
            if row[-1] == 0:
                self._waiting[axis] = [entry for entry in self._waiting.get(axis, []) if entry[0] < cycle]
                self._waiting[axis].sort()
            self.add(axis, [[cycle, *row[1:]]])
