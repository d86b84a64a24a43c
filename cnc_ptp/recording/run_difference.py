"""Two recorded runs beside each other: where they part, and what came out of each."""

from __future__ import annotations

from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import load_machine
from cnc_ptp.recording.reader import CHANNEL_STATE, Recorded

OTHER_MACHINE: Final = 26158
COMPARED: Final = ("set_position", "actual_position", "following_error", "actual_speed", "path_velocity")
"""Columns of states, as far as a unit has them."""


class Row(NamedTuple):
    """One column of one unit: largest values, largest difference and when the two runs part (s, None: never)."""

    unit: str
    column: str
    first: float
    second: float
    difference: float
    at: float
    parts_at: float | None


class RunDifference(NamedTuple):
    """`program_times` of the channels (s with the program running) in both."""

    rows: list[Row]
    program_times: dict[str, tuple[float, float]]
    begin: float
    end: float

    @property
    def parts_at(self) -> float | None:
        """When the first column parts, s."""
        return min((row.parts_at for row in self.rows if row.parts_at is not None), default=None)


def difference(first: Recorded, second: Recorded) -> RunDifference:
    """In the time that both have. Raises CncError 26158 for recordings of different machines."""
    require_same_machine(first, second)
    cycle_time = first.cycle_time_ns * 1e-9
    rows: list[Row] = []
    times: dict[str, tuple[float, float]] = {}
    begins, ends = [], []
    for topic in [topic for topic in first.states if topic in second.states]:
        mine, other = in_both(first.states[topic], second.states[topic])
        if not len(mine):
            continue
        begins.append(int(mine["cycle"][0]))
        ends.append(int(mine["cycle"][-1]))
        unit = topic.removeprefix("/").removesuffix("/state")
        names = mine.dtype.names or ()
        rows += [row(unit, name, mine, other, cycle_time) for name in COMPARED if name in names]
        if first.topics[topic].type_name == CHANNEL_STATE:
            times[unit] = (running_time(mine, cycle_time), running_time(other, cycle_time))
    begin, end = min(begins, default=0), max(ends, default=0)
    return RunDifference(rows, times, begin * cycle_time, end * cycle_time)


def require_same_machine(first: Recorded, second: Recorded) -> None:
    """The same units and the same cycle time."""
    units = [units_of(recorded) for recorded in (first, second)]
    if units[0] != units[1] or first.cycle_time_ns != second.cycle_time_ns:
        pairs = zip((first, second), units, strict=True)
        texts = [f"{one.path} has {', '.join(known)}, {one.cycle_time_ns / 1e6:g} ms" for one, known in pairs]
        reason = f"the recordings are of different machines: {'; '.join(texts)}"
        raise CncError(OTHER_MACHINE, reason, "nothing was compared")


def units_of(recorded: Recorded) -> list[str]:
    machine = load_machine(recorded.machine_yaml, f"{recorded.path}:machine.yaml")
    return [*machine.channels, *machine.spindles, *machine.axes]


def in_both(first: Any, second: Any) -> tuple[Any, Any]:
    """The rows of the cycles that both have, in their order."""
    _, mine, others = np.intersect1d(first["cycle"], second["cycle"], return_indices=True)
    return first[mine], second[others]


def row(unit: str, name: str, mine: Any, other: Any, cycle_time: float) -> Row:
    one, two = mine[name].astype(float), other[name].astype(float)
    apart: npt.NDArray[np.float64] = np.abs(two - one)
    parted = np.flatnonzero(one.view(np.uint64) != two.view(np.uint64))
    most = int(np.nanargmax(apart)) if not np.isnan(apart).all() else 0
    cycles = mine["cycle"]
    parts_at = float(cycles[parted[0]]) * cycle_time if len(parted) else None
    first, second = (float(np.nanmax(np.abs(values))) for values in (one, two))
    return Row(unit, name, first, second, float(apart[most]), float(cycles[most]) * cycle_time, parts_at)


def running_time(states: Any, cycle_time: float) -> float:
    """How long a channel was neither idle nor ready."""
    from cnc_ptp.protocol.channel_states import ChannelStateCode

    resting = (int(ChannelStateCode.IDLE), int(ChannelStateCode.READY))
    return float(np.count_nonzero(~np.isin(states["state"], resting))) * cycle_time
