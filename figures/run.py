"""Runs a figure's scenario offline and keeps what is drawn: the cycles of its axes and the commands."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

from cnc_ptp.errors import CncError
from cnc_ptp.machine.blocks import AxisBlock, CommandRecord, Event, Severity
from cnc_ptp.machine.commands import INTERNAL
from cnc_ptp.machine.job import read_job
from cnc_ptp.machine.offline import OfflineMachine, Outputs
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import MachineParameters, read_machine
from figures.scenario_head import FigureError, FigureScenario

Column = npt.NDArray[np.float64]
OF_BLOCK = ("first_cycle", "count", "master", "target_velocity", "couples_actual")
PER_CYCLE = tuple(field.name for field in fields(AxisBlock) if field.name not in OF_BLOCK)


@dataclass(frozen=True, slots=True)
class Marker:
    """A command that took effect, or an error that is shown: when (s) and what.

    Commands of cycle 0 are the set-up and have none.
    """

    time: float
    text: str


@dataclass(frozen=True, slots=True)
class FigureRun:
    """A run of `cycles` cycles.

    `columns[axis][field]` has one value a cycle, fields as in AxisBlock (mm, s, deg); `units[axis]` is mm or deg.
    """

    cycle_time: float
    columns: Mapping[str, Mapping[str, Column]]
    units: Mapping[str, str]
    markers: tuple[Marker, ...]

    @property
    def cycles(self) -> int:
        return len(next(iter(self.columns.values()))["state"])

    @property
    def time(self) -> Column:
        """Of each cycle, in s."""
        return np.arange(self.cycles, dtype=np.float64) * self.cycle_time

    def column(self, axis: str, field: str) -> Column:
        """`actual_acceleration` is the difference quotient of the actual velocity; all else are fields."""
        if field == "actual_acceleration":
            quotient: Column = np.gradient(self.columns[axis]["actual_velocity"], self.cycle_time)
            return quotient
        return self.columns[axis][field]


def run_figure(figure: FigureScenario) -> FigureRun:
    """Runs until all axes stand. Raises FigureError where an input is wrong, a command refused or a fault occurs."""
    try:
        machine = read_machine(figure.machine_path)
        job = read_job(machine, program=None, scenario=str(figure.path))
    except CncError as error:
        raise FigureError(figure.path, error) from None
    for axis in figure.axes:
        if axis not in machine.axes:
            known = ", ".join(machine.axes)
            raise FigureError(figure.path, f"axis '{axis}' does not exist in {figure.machine}, known are {known}")
    return _collect(figure, machine, list(OfflineMachine(machine, build_units(machine, scenario=job)).run()))


def _collect(figure: FigureScenario, machine: MachineParameters, ticks: list[Outputs]) -> FigureRun:
    outputs = [output for tick in ticks for output in tick.values()]
    records = [record for output in outputs for record in output.records]
    refused = [f"P-ERR-{record.error_id} {record.message}" for record in records if not record.accepted]
    errors = [event for output in outputs for event in output.events if event.severity == Severity.ERROR]
    if refused or (errors and not figure.shows_errors):
        texts = [f"P-ERR-{event.error_id} {event.text}" for event in errors if not figure.shows_errors]
        raise FigureError(figure.path, (texts + refused)[0])
    cycle_time = machine.cycle_time_us * 1e-6
    given = [record for record in records if record.target in figure.axes and record.command not in INTERNAL]
    return FigureRun(
        cycle_time,
        {axis: _columns([tick[axis].block for tick in ticks]) for axis in figure.axes},
        {axis: "deg" if machine.axes[axis].rotary else "mm" for axis in figure.axes},
        (*_markers(given, cycle_time, named=len(figure.axes) > 1), *_error_markers(errors, cycle_time)),
    )


def _markers(records: list[CommandRecord], cycle_time: float, *, named: bool) -> Iterator[Marker]:
    """What is given again and again (setpoints, block by block) is marked where it begins; `named`: with its axis."""
    last = ""
    for record in records:
        text = f"{record.target}: {_text(record)}" if named else _text(record)
        if record.cycle and text != last:
            last = text
            yield Marker(record.cycle * cycle_time, text)


def _error_markers(events: list[Event], cycle_time: float) -> Iterator[Marker]:
    for event in events:
        yield Marker(event.cycle * cycle_time, f"{event.source}: error {event.error_id}")


def _columns(blocks: list[object]) -> dict[str, Column]:
    return {
        name: np.array([value for block in blocks for value in getattr(block, name)], dtype=np.float64)
        for name in PER_CYCLE
    }


SHOWN = {"factor": "", "target": "", "distance": "", "position": "", "percent": " %", "difference": ""}
"""The argument that stands behind the name of a command, and its unit where that is not the axis'."""


def _text(record: CommandRecord) -> str:
    """`move_absolute` with its target 1000.0 becomes 'move absolute 1000'; its dynamics are in the caption."""
    arguments = json.loads(record.arguments_json)
    shown = [f"{arguments[name]:g}{unit}" for name, unit in SHOWN.items() if name in arguments]
    return " ".join([record.command.replace("_", " "), *shown]).replace("-", "−")
