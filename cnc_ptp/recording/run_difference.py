"""Two recorded runs beside each other: where they part, and what came out of each."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import MachineParameters, load_machine
from cnc_ptp.protocol.channel_states import ChannelStateCode
from cnc_ptp.recording.opened import OpenRecording
from cnc_ptp.recording.selection import NOT_RECORDED
from cnc_ptp.recording.writer import MACHINE_FILE

OTHER_MACHINE: Final = 26158
COMPARED: Final = ("set_position", "actual_position", "following_error", "actual_speed", "path_velocity")
"""Columns of states, as far as a unit has them."""
CYCLE, STATE = "cycle", "state"
RESTING: Final = (int(ChannelStateCode.IDLE), int(ChannelStateCode.READY))
Numbers = npt.NDArray[Any]
Columns = Mapping[str, Numbers]


class Row(NamedTuple):
    """One column of one unit: largest values, largest difference and when the two runs part (s, None: never)."""

    unit: str
    column: str
    first: float
    second: float
    difference: float
    at: float
    parts_at: float | None


class Curve(NamedTuple):
    """A column of both runs in the cycles that both have, at their times (s)."""

    unit: str
    column: str
    times: Numbers
    first: Numbers
    second: Numbers


class RunDifference(NamedTuple):
    """`program_times` of the channels (s with the program running) in both, from `begin` on."""

    rows: list[Row]
    program_times: dict[str, tuple[float, float]]
    begin: float
    end: float

    @property
    def parts_at(self) -> float | None:
        """When the first column parts, s."""
        return min((row.parts_at for row in self.rows if row.parts_at is not None), default=None)


def difference(first: str | Path, second: str | Path) -> RunDifference:
    """In the time that both have. Raises CncError 26001 to 26003, 26158 for recordings of different machines."""
    with Both(first, second) as both:
        return both.difference()


class Both:
    """Two open recordings of one machine; a column is read when it is compared. Raises as `difference`."""

    def __init__(self, first: str | Path, second: str | Path) -> None:
        self._files = [OpenRecording(path) for path in (first, second)]
        try:
            self.machine = same_machine(*self._files)
        except CncError:
            self.close()
            raise
        self._cycle_time = self.machine.cycle_time_us * 1e-6

    @property
    def first_path(self) -> Path:
        return self._files[0].path

    def difference(self) -> RunDifference:
        rows: list[Row] = []
        times: dict[str, tuple[float, float]] = {}
        spans: list[tuple[float, float]] = []
        for unit in units_of(self.machine):
            columns = self._columns(unit, COMPARED)
            if columns is None:
                continue
            cycles, mine, other = columns
            seconds = cycles * self._cycle_time
            spans.append((float(seconds[0]), float(seconds[-1])))
            rows += [row(Curve(unit, name, seconds, mine[name], other[name])) for name in COMPARED if name in mine]
            if unit in self.machine.channels:
                times[unit] = self._program_times(unit, float(seconds[0]))
        begin = min((span[0] for span in spans), default=0.0)
        return RunDifference(rows, times, begin, max((span[1] for span in spans), default=0.0))

    def curves(self, unit: str, *names: str) -> list[Curve]:
        """Those of the columns that a unit has."""
        columns = self._columns(unit, names)
        if columns is None:
            return []
        cycles, mine, other = columns
        seconds = cycles * self._cycle_time
        return [Curve(unit, name, seconds, mine[name], other[name]) for name in names if name in mine]

    def close(self) -> None:
        for file in self._files:
            file.close()

    def __enter__(self) -> Both:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _columns(self, unit: str, names: Sequence[str]) -> tuple[Numbers, Columns, Columns] | None:
        """Cycles that both have and the columns there; None where there are none."""
        topic = f"/{unit}/state"
        if any(topic not in file.topics for file in self._files):
            return None
        fields = self._files[0].topics[topic].fields
        wanted = [CYCLE, *(name for name in names if name in fields)]
        second = self._files[1].columns(topic, *wanted)
        cycles = second[CYCLE]
        span = (
            (float(cycles[0]) * self._cycle_time, float(cycles[-1]) * self._cycle_time) if len(cycles) else (0.0, 0.0)
        )
        try:
            first = self._files[0].columns(topic, *wanted, start=span[0], end=span[1])
        except CncError as error:
            if error.number != NOT_RECORDED:
                raise
            return None
        common, mine, others = np.intersect1d(first[CYCLE], cycles, return_indices=True)
        if not len(common):
            return None
        names = wanted[1:]
        return common, {name: first[name][mine] for name in names}, {name: second[name][others] for name in names}

    def _program_times(self, channel: str, begin: float) -> tuple[float, float]:
        """How long a channel was neither idle nor ready in each run, from `begin` to its own end."""
        states = [file.columns(f"/{channel}/state", STATE, start=begin)[STATE] for file in self._files]
        first, second = (float(np.count_nonzero(~np.isin(of, RESTING))) * self._cycle_time for of in states)
        return first, second


def same_machine(first: OpenRecording, second: OpenRecording) -> MachineParameters:
    """The first one's: the same units and the same cycle time. Raises CncError 26158."""
    machines = [load_machine(file.attached(MACHINE_FILE), f"{file.path}:{MACHINE_FILE}") for file in (first, second)]
    units = [units_of(machine) for machine in machines]
    if units[0] != units[1] or machines[0].cycle_time_us != machines[1].cycle_time_us:
        texts = [
            f"{file.path} has {', '.join(known)}, {machine.cycle_time_us / 1e3:g} ms"
            for file, known, machine in zip((first, second), units, machines, strict=True)
        ]
        reason = f"the recordings are of different machines: {'; '.join(texts)}"
        raise CncError(OTHER_MACHINE, reason, "nothing was compared")
    return machines[0]


def units_of(machine: MachineParameters) -> list[str]:
    return [*machine.channels, *machine.spindles, *machine.axes]


def row(curve: Curve) -> Row:
    one, two = curve.first.astype(float), curve.second.astype(float)
    apart: npt.NDArray[np.float64] = np.abs(two - one)
    parted = np.flatnonzero(one.view(np.uint64) != two.view(np.uint64))
    most = int(np.nanargmax(apart)) if not np.isnan(apart).all() else 0
    parts_at = float(curve.times[parted[0]]) if len(parted) else None
    first, second = largest(one), largest(two)
    return Row(curve.unit, curve.column, first, second, float(apart[most]), float(curve.times[most]), parts_at)


def largest(values: Numbers) -> float:
    """NaN where there is no number."""
    known = values[~np.isnan(values)]
    return float(np.max(np.abs(known))) if len(known) else math.nan
