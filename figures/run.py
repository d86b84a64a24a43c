"""Offline run of a figure's scenario, with the cycles of its axes and the commands for drawing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from operator import attrgetter

import numpy as np

from cnc_ptp.errors import CncError
from cnc_ptp.machine.offline import OfflineMachine, Outputs
from cnc_ptp.machine.plc_file import read_plc
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.parameters.view.encoder import uses_feed_constant
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.plots.over_time import Column, Marker
from cnc_ptp.plots.panels import UNIT_KINDS
from cnc_ptp.protocol.blocks import CommandRecord, Event, Severity
from cnc_ptp.protocol.commands import INTERNAL
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.command_words import brief
from cnc_ptp.recording.units import unit_of
from figures.scenario_head import FigureError, FigureScenario

NOT_SHOWN = INTERNAL | {"reset_feedforward"}
"""Commands that come automatically."""


@dataclass(frozen=True, slots=True)
class DrawnUnit:
    """Kind and units of measurement of a unit: `kind` of cnc_ptp.plots.panels, `length` mm or deg, `torque` N or Nm."""

    kind: str
    length: str
    torque: str

    def unit_of(self, field: str) -> str:
        """`set_velocity` is in mm/s."""
        return unit_of(field, self.length, self.torque)


@dataclass(frozen=True, slots=True)
class FigureRun:
    """A run of `cycles` cycles.

    `columns[unit][field]` has one value per cycle, fields as in the unit's block (mm, s, deg). Commands of
    cycle 0 are the set-up and have no marker.
    """

    cycle_time: float
    columns: Mapping[str, Mapping[str, Column]]
    units: Mapping[str, DrawnUnit]
    markers: tuple[Marker, ...]
    machine: MachineParameters
    ticks: tuple[Outputs, ...]
    """All that all units gave, for pictures that are no time plots."""
    signals: Mapping[str, Column] = field(default_factory=dict)
    """Switched values of a PLC in a file by name, 0 or 1 in each cycle."""

    @property
    def cycles(self) -> int:
        return len(next(iter(self.columns.values()))["state"])

    @property
    def time(self) -> Column:
        """Of each cycle, in s."""
        return np.arange(self.cycles, dtype=np.float64) * self.cycle_time

    def column(self, unit: str, field: str) -> Column:
        """`actual_acceleration` is the difference quotient of the actual velocity; all else are fields."""
        if field == "actual_acceleration":
            quotient: Column = np.gradient(self.columns[unit]["actual_velocity"], self.cycle_time)
            return quotient
        return self.columns[unit][field]

    def motion(self, unit: str) -> Column:
        """The value that is 0 while the unit is at a standstill."""
        return self.columns[unit][UNIT_KINDS[self.units[unit].kind].motion]

    def following_error(self, unit: str) -> Column:
        return self.columns[unit][UNIT_KINDS[self.units[unit].kind].lag]


def run_figure(figure: FigureScenario) -> FigureRun:
    """Runs until all axes are at a standstill. Raises FigureError for a wrong input, a refused command or a fault."""
    program = str(figure.program_path) if figure.program_path else None
    try:
        machine = read_machine(figure.machine_path)
        job = read_entries(machine, program=program, scenario=str(figure.path), may_be_empty=True)
        file = read_plc(str(figure.plc_path)) if figure.plc_path else None
        units = build_units(machine, scenario=job, plc_file=file)
    except CncError as error:
        raise FigureError(figure.path, error) from None
    for name in figure.axes:
        if name not in machine.axes and name not in machine.spindles:
            known = ", ".join([*machine.axes, *machine.spindles])
            raise FigureError(figure.path, f"axis '{name}' does not exist in {figure.machine}, known are {known}")
    samples: list[list[float]] = []
    ticks = []
    for outputs in OfflineMachine(machine, units).run():
        ticks.append(outputs)
        samples.append([_signal(figure, units[PLC], name) for name in figure.signals])
    run = _collect(figure, machine, tuple(ticks))
    columns = np.array(samples, dtype=np.float64).repeat(machine.block_cycles, axis=0)
    return replace(run, signals={name: columns[:, index] for index, name in enumerate(figure.signals)})


def _signal(figure: FigureScenario, plc: object, name: str) -> float:
    """A switched value of the PLC's object by its path: move.busy. Raises FigureError."""
    program = plc.program if isinstance(plc, PlcUnit) else None
    try:
        return float(bool(attrgetter(name)(program.plc if program is not None else None)))
    except AttributeError:
        raise FigureError(figure.path, f"signal '{name}' does not exist in the PLC '{figure.plc}'") from None


def _collect(figure: FigureScenario, machine: MachineParameters, ticks: tuple[Outputs, ...]) -> FigureRun:
    outputs = [output for tick in ticks for output in tick.values()]
    records = [record for output in outputs for record in output.records]
    errors = [event for output in outputs for event in output.events if event.severity == Severity.ERROR]
    shown = {event.error_id for event in errors} if figure.shows_errors else set()
    refused_ones = [] if figure.shows_errors and figure.plc else records
    refusals = [record for record in refused_ones if not record.accepted and record.error_id not in shown]
    refused = [f"P-ERR-{record.error_id} {record.message}" for record in refusals]
    if refused or (errors and not figure.shows_errors):
        texts = [f"P-ERR-{event.error_id} {event.text}" for event in errors if not figure.shows_errors]
        raise FigureError(figure.path, (texts + refused)[0])
    cycle_time = machine.cycle_time_us * 1e-6
    given = [record for record in records if record.target in figure.axes and record.command not in NOT_SHOWN]
    units = {name: drawn_unit(machine, name) for name in figure.axes}
    return FigureRun(
        cycle_time,
        {name: _columns([tick[name].block for tick in ticks], unit.kind) for name, unit in units.items()},
        units,
        (*_markers(given, cycle_time, named=len(figure.axes) > 1), *_error_markers(errors, cycle_time)),
        machine,
        ticks,
    )


def drawn_unit(machine: MachineParameters, name: str) -> DrawnUnit:
    """Torques are Nm at the motor shaft, or N where a linear axis has no feed constant."""
    if name in machine.spindles:
        return DrawnUnit("spindle", "deg", "Nm")
    if machine.axes[name].rotary:
        return DrawnUnit("axis", "deg", "Nm")
    return DrawnUnit("axis", "mm", "Nm" if uses_feed_constant(machine.raw(name)) else "N")


def _markers(records: list[CommandRecord], cycle_time: float, *, named: bool) -> Iterator[Marker]:
    """Repeated commands (setpoints, block by block) are marked at their start; `named`: with their axis."""
    last = ""
    for record in records:
        text = f"{record.target}: {brief(record)}" if named else brief(record)
        if record.cycle and text != last:
            last = text
            yield Marker(record.cycle * cycle_time, text)


def _error_markers(events: list[Event], cycle_time: float) -> Iterator[Marker]:
    for event in events:
        yield Marker(event.cycle * cycle_time, f"{event.source}: error {event.error_id}")


def _columns(blocks: list[object], kind: str) -> dict[str, Column]:
    return {
        name: np.array([value for block in blocks for value in getattr(block, name)], dtype=np.float64)
        for name in UNIT_KINDS[kind].columns
    }
