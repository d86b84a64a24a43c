"""Two recorded runs of one machine, compared column by column: of hours, too."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import MachineParameters, load_machine
from cnc_ptp.protocol.channel_states import IN_PROGRAM
from cnc_ptp.recording.difference import COMPARED, NOT_COMPARABLE, FieldDifference, field_difference
from cnc_ptp.recording.opened import TIME, OpenRecording
from cnc_ptp.recording.origin import foreign
from cnc_ptp.recording.reader import AXIS_STATE, CHANNEL_STATE, SPINDLE_STATE
from cnc_ptp.recording.selection import NOT_RECORDED, asked_time
from cnc_ptp.recording.writer import MACHINE_FILE

OTHER_MACHINE: Final = 26158
CYCLE, STATE = "cycle", "state"
Columns = dict[str, npt.NDArray[Any]]


class RunDifference(NamedTuple):
    """What differs in the time that both have, from `begin` to `end` (s).

    rows           of all fields, also those that do not differ
    program_times  of the channels: in each run s with a program in progress, from `begin` on
    cycle_time     s
    notes          what a recording lacks, that one ends before the other, programs that have not ended
    """

    rows: list[FieldDifference]
    program_times: dict[str, tuple[float, float]]
    begin: float
    end: float
    cycle_time: float
    notes: list[str]

    @property
    def parts_at(self) -> float | None:
        """When the first field parts, s."""
        parted = [row.parted for row in self.rows if row.parted >= 0]
        return min(parted) * self.cycle_time if parted else None


def difference(
    first: str | Path,
    second: str | Path,
    begin: float | None = None,
    end: float | None = None,
    names: tuple[str, str] | None = None,
) -> RunDifference:
    """In the time that both have, at most from `begin` to `end` (s).

    `names`: of both in notes and errors; None: those of the files. Raises CncError 26001 to 26003, 26016, 26017
    (no recording of cnc_ptp), 26022 (nothing in common), 26158 (of different machines).
    """
    with ExitStack() as files:
        pair = [files.enter_context(OpenRecording(path)) for path in (first, second)]
        shown = names or (str(first), str(second))
        machine = same_machine(*pair)
        cycle_time = machine.cycle_time_us * 1e-6
        rows: list[FieldDifference] = []
        times: dict[str, tuple[float, float]] = {}
        spans: dict[str, tuple[float, float]] = {}
        unfinished: list[str] = []
        for unit, fields in fields_of(machine).items():
            columns = common_columns(pair, f"/{unit}/state", fields, begin, end)
            if columns is None:
                continue
            cycles, one, other = columns
            spans[unit] = (float(cycles[0]) * cycle_time, float(cycles[-1]) * cycle_time)
            rows += [field_difference(unit, name, cycles, one[name], other[name]) for name in one]
            if unit in machine.channels:
                programs = [in_program(file, unit, spans[unit][0], end) for file in pair]
                first_time, second_time = (float(np.count_nonzero(each)) * cycle_time for each in programs)
                times[unit] = first_time, second_time
                unfinished += notes_of_programs(unit, programs, shown)
        if not rows:
            times_of = " and ".join(f"{name} {span_text(file)}" for name, file in zip(shown, pair, strict=True))
            reason = f"the recordings have no cycle in common{asked_part(begin, end)}: {times_of}"
            raise CncError(NOT_COMPARABLE, reason, "nothing was compared")
        start, last = min(span[0] for span in spans.values()), max(span[1] for span in spans.values())
        of_units = notes_of_units(machine, spans, start, last)
        notes = [*notes_of_both(pair, shown, cycle_time, end), *of_units, *unfinished]
        return RunDifference(rows, times, start, last, cycle_time, notes)


def notes_of_both(
    pair: Sequence[OpenRecording], names: Sequence[str], cycle_time: float, end: float | None
) -> Iterator[str]:
    yield from (f"{name}: {file.missing}" for name, file in zip(names, pair, strict=True) if file.missing)
    ends = [file.recorded_span()[1] for file in pair]
    if end is None and abs(ends[0] - ends[1]) > cycle_time * 0.5:
        texts = (f"{name} ends at {last:.10g} s" for name, last in zip(names, ends, strict=True))
        yield f"{', '.join(texts)}: what only one has was not compared"


def notes_of_units(
    machine: MachineParameters, spans: Mapping[str, tuple[float, float]], start: float, last: float
) -> Iterator[str]:
    """Units that were not compared, or in a shorter time than from `start` to `last` (s)."""
    left_out = [unit for unit in fields_of(machine) if unit not in spans]
    if left_out:
        yield f"{', '.join(left_out)}: no states that both have, so not compared"
    for unit, (first, end) in spans.items():
        if max(first - start, last - end) > machine.cycle_time_us * 0.5e-6:
            yield f"{unit}: compared from {first:.10g} s to {end:.10g} s alone"


def span_text(file: OpenRecording) -> str:
    if not file.state_topics:
        return "holds no states"
    first, last = file.recorded_span()
    return f"covers {first:.10g} s to {last:.10g} s"


def asked_part(begin: float | None, end: float | None) -> str:
    return "" if begin is None and end is None else f" from {asked_time(begin, end)}"


def fields_of(machine: MachineParameters) -> dict[str, tuple[str, ...]]:
    """The fields to be compared of each unit."""
    return {
        **dict.fromkeys(machine.channels, COMPARED[CHANNEL_STATE]),
        **dict.fromkeys(machine.spindles, COMPARED[SPINDLE_STATE]),
        **dict.fromkeys(machine.axes, COMPARED[AXIS_STATE]),
    }


def kinds_of(machine: MachineParameters) -> dict[str, str]:
    """What each unit is, by name."""
    return {
        **dict.fromkeys(machine.channels, "channel"),
        **dict.fromkeys(machine.spindles, "spindle"),
        **{name: f"{'rotary' if axis.rotary else 'linear'} axis" for name, axis in machine.axes.items()},
    }


def named(unit: str, known: Mapping[str, str], other: Mapping[str, str]) -> str:
    """A unit, and what it is where that of the other machine is something else."""
    return unit if other.get(unit, known[unit]) == known[unit] else f"{unit} ({known[unit]})"


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


def in_program(file: OpenRecording, channel: str, begin: float, end: float | None) -> npt.NDArray[np.bool_]:
    """For each cycle from `begin` to `end`, or to the end of the run (s), whether a program is in progress."""
    return np.isin(file.columns(f"/{channel}/state", STATE, start=begin, end=end)[STATE], IN_PROGRAM)


def notes_of_programs(channel: str, programs: Iterable[npt.NDArray[np.bool_]], names: Iterable[str]) -> Iterator[str]:
    """The runs, by name, in whose last cycle a program is in progress."""
    running = [name for name, cycles in zip(names, programs, strict=True) if len(cycles) and cycles[-1]]
    if running:
        yield f"the program of {channel} has not ended there in {' and '.join(running)}: its time is that so far"


def same_machine(first: OpenRecording, second: OpenRecording) -> MachineParameters:
    """The first one's: the same units and the same cycle time. Raises CncError 26017 and 26158."""
    for file in (first, second):
        if MACHINE_FILE not in file.attachments:
            raise foreign(file.path, "nothing was compared")
    machines = [load_machine(file.attached(MACHINE_FILE), f"{file.path}:{MACHINE_FILE}") for file in (first, second)]
    units = [kinds_of(machine) for machine in machines]
    if units[0] != units[1] or machines[0].cycle_time_us != machines[1].cycle_time_us:
        others = [units[1], units[0]]
        texts = [
            f"{file.path} has {', '.join(named(unit, known, other) for unit in known)}, "
            f"{machine.cycle_time_us / 1e3:g} ms"
            for file, known, other, machine in zip((first, second), units, others, machines, strict=True)
        ]
        reason = f"the recordings are of different machines: {'; '.join(texts)}"
        raise CncError(OTHER_MACHINE, reason, "nothing was compared")
    return machines[0]
