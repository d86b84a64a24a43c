"""Two recorded runs of one machine, compared column by column: of hours, too."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import MachineParameters, load_machine
from cnc_ptp.recording.difference import COMPARED, FieldDifference, field_difference
from cnc_ptp.recording.opened import TIME, OpenRecording
from cnc_ptp.recording.reader import AXIS_STATE, CHANNEL_STATE, SPINDLE_STATE
from cnc_ptp.recording.selection import NOT_RECORDED
from cnc_ptp.recording.statistics import IN_PROGRAM
from cnc_ptp.recording.writer import MACHINE_FILE

OTHER_MACHINE: Final = 26158
CYCLE, STATE = "cycle", "state"
Columns = dict[str, npt.NDArray[Any]]


class RunDifference(NamedTuple):
    """What differs in the time that both have, from `begin` to `end` (s).

    rows           of all fields, also those that do not differ
    program_times  of the channels: s with a program running in each, from `begin` on
    cycle_time     s
    """

    rows: list[FieldDifference]
    program_times: dict[str, tuple[float, float]]
    begin: float
    end: float
    cycle_time: float

    @property
    def parts_at(self) -> float | None:
        """When the first field parts, s."""
        parted = [row.parted for row in self.rows if row.parted >= 0]
        return min(parted) * self.cycle_time if parted else None


def difference(
    first: str | Path, second: str | Path, begin: float | None = None, end: float | None = None
) -> RunDifference:
    """In the time that both have, at most from `begin` to `end` (s).

    Raises CncError 26001 to 26003, 26011 (no recording of cnc_ptp), 26016, 26158 (of different machines).
    """
    with ExitStack() as files:
        pair = [files.enter_context(OpenRecording(path)) for path in (first, second)]
        machine = same_machine(*pair)
        cycle_time = machine.cycle_time_us * 1e-6
        rows: list[FieldDifference] = []
        times: dict[str, tuple[float, float]] = {}
        spans: list[tuple[float, float]] = []
        for unit, fields in fields_of(machine).items():
            columns = common_columns(pair, f"/{unit}/state", fields, begin, end)
            if columns is None:
                continue
            cycles, one, other = columns
            spans.append((float(cycles[0]) * cycle_time, float(cycles[-1]) * cycle_time))
            rows += [field_difference(unit, name, cycles, one[name], other[name]) for name in one]
            if unit in machine.channels:
                times[unit] = program_times(pair, unit, spans[-1][0], end, cycle_time)
        start = min((span[0] for span in spans), default=0.0)
        return RunDifference(rows, times, start, max((span[1] for span in spans), default=0.0), cycle_time)


def fields_of(machine: MachineParameters) -> dict[str, tuple[str, ...]]:
    """The fields to be compared of each unit."""
    return {
        **dict.fromkeys(machine.channels, COMPARED[CHANNEL_STATE]),
        **dict.fromkeys(machine.spindles, COMPARED[SPINDLE_STATE]),
        **dict.fromkeys(machine.axes, COMPARED[AXIS_STATE]),
    }


def common_columns(
    pair: Sequence[OpenRecording], topic: str, fields: Sequence[str], begin: float | None, end: float | None
) -> tuple[npt.NDArray[Any], Columns, Columns] | None:
    """Cycles that both have and the fields there; None where there are none."""
    if any(topic not in file.topics for file in pair):
        return None
    known = [name for name in fields if all(name in file.topics[topic].fields for file in pair)]
    try:
        second = pair[1].columns(topic, TIME, CYCLE, *known, start=begin, end=end)
        span = [float(second[TIME][place]) for place in (0, -1)] if len(second[TIME]) else [0.0, 0.0]
        first = pair[0].columns(topic, CYCLE, *known, start=span[0], end=span[1])
    except CncError as error:
        if error.number != NOT_RECORDED:
            raise
        return None
    common, places, others = np.intersect1d(first[CYCLE], second[CYCLE], return_indices=True)
    if not len(common):
        return None
    return common, {name: first[name][places] for name in known}, {name: second[name][others] for name in known}


def program_times(
    pair: Sequence[OpenRecording], channel: str, begin: float, end: float | None, cycle_time: float
) -> tuple[float, float]:
    """How long a program was being executed in each run, from `begin` to its own end, s."""
    states = [file.columns(f"/{channel}/state", STATE, start=begin, end=end)[STATE] for file in pair]
    first, second = (float(np.count_nonzero(np.isin(of, IN_PROGRAM))) * cycle_time for of in states)
    return first, second


def same_machine(first: OpenRecording, second: OpenRecording) -> MachineParameters:
    """The first one's: the same units and the same cycle time. Raises CncError 26158."""
    machines = [load_machine(file.attached(MACHINE_FILE), f"{file.path}:{MACHINE_FILE}") for file in (first, second)]
    units = [[*fields_of(machine)] for machine in machines]
    if units[0] != units[1] or machines[0].cycle_time_us != machines[1].cycle_time_us:
        texts = [
            f"{file.path} has {', '.join(known)}, {machine.cycle_time_us / 1e3:g} ms"
            for file, known, machine in zip((first, second), units, machines, strict=True)
        ]
        reason = f"the recordings are of different machines: {'; '.join(texts)}"
        raise CncError(OTHER_MACHINE, reason, "nothing was compared")
    return machines[0]
