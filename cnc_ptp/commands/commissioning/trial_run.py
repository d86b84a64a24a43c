"""Offline runs for evaluation: columns of the units are kept as arrays."""

from __future__ import annotations

import os
import sys
from array import array
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import TracebackType

import numpy as np
import numpy.typing as npt
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from cnc_ptp.commands.console import print_faults
from cnc_ptp.commands.run.simulate import Result, interrupted
from cnc_ptp.commissioning import progress_lines
from cnc_ptp.interrupt import EndRequest
from cnc_ptp.machine.offline import Outputs
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import ChannelBlock, ChannelOffsets, CommandRecord, Event, PlcBlock
from cnc_ptp.protocol.notes import Note
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.offline_run import OfflineRun

Columns = Mapping[str, npt.NDArray[np.float64]]


@dataclass
class Trial:
    """A run: its columns by unit and field (one value per cycle), its notes, and all commands, events and offsets."""

    columns: dict[str, Columns] = field(default_factory=dict)
    result: Result = field(default_factory=Result)
    records: list[CommandRecord] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    offsets: list[tuple[str, ChannelOffsets]] = field(default_factory=list)
    """With the channel."""

    @property
    def refusals(self) -> list[Note]:
        """Commands that were not carried out: then the motion is not the intended one."""
        return [note for note in self.result.notes if note.refused]

    @property
    def failed(self) -> bool:
        return bool(self.result.failed or self.result.interrupted or self.result.errors or self.refusals)

    def print_faults(self) -> None:
        """Why the run is no use, and warnings."""
        console = Console(stderr=True, highlight=False, soft_wrap=True)
        if self.result.interrupted:
            console.print(f"failed: {self.result.interrupted}", style="bold red", markup=False)
        stopped = self.result.failed or bool(self.result.interrupted)
        print_faults(console, self.result.errors, self.result.notes, stopped=stopped)


def run_trial(
    machine: MachineParameters,
    job: Sequence[Entry],
    *,
    fields: Mapping[str, Iterable[str]],
    seconds: float,
    label: str,
    record: str | None = None,
    machine_text: str = "",
) -> Trial:
    """Runs `job` offline until all is done, or until something has gone wrong; keeps the `fields` of each unit.

    `seconds` the run is expected to last and `label` are for the progress bar; `record` is an MCAP file to write, for
    which `machine_text` is needed. Raises CncError 26007 to 26009 where it cannot be written.
    """
    units = build_units(machine, scenario=job)
    run = OfflineRun(machine, units, record=record, machine_text=machine_text)
    kept: dict[str, dict[str, array[float]]] = {unit: defaultdict(new_column) for unit in fields}
    trial = Trial()
    cycles = round(seconds * 1e6 / machine.cycle_time_us)
    with TrialProgress(label, cycles) as progress, run, EndRequest() as end:
        for outputs in run.run():
            trial.result.add(outputs)
            _keep(kept, fields, outputs)
            for unit, output in outputs.items():
                trial.records += output.records
                trial.events += output.events
                if isinstance(output.block, ChannelBlock):
                    trial.offsets += [(unit, offsets) for offsets in output.block.offsets]
            progress.show(outputs)
            stopped = end.given and interrupted(run.machine, outputs, trial.result, end)
            if stopped or trial.result.errors or trial.refusals:
                break
    trial.columns = {
        unit: {name: np.array(values, dtype=np.float64) for name, values in columns.items()}
        for unit, columns in kept.items()
    }
    return trial


def new_column() -> array[float]:
    return array("d")


def _keep(kept: dict[str, dict[str, array[float]]], fields: Mapping[str, Iterable[str]], outputs: Outputs) -> None:
    for unit, names in fields.items():
        block, columns = outputs[unit].block, kept[unit]
        for name in names:
            columns[name].extend(getattr(block, name))
        columns["cycle"].extend(range(block.first_cycle, block.first_cycle + block.count))


PERCENT = 5
"""From one line of progress to the next, at least."""


class TrialProgress:
    """A bar over the machine time on a terminal, or lines where a program wants them."""

    def __init__(self, label: str, cycles: int) -> None:
        console = Console(stderr=True)
        self._on = console.is_terminal
        self._lines = progress_lines.WANTED in os.environ
        self._label, self._cycles, self._said = label, max(cycles, 1), 0
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.percentage:3.0f} %"),
            TimeElapsedColumn(),
            console=console,
        )
        self._task = self._progress.add_task(label, total=max(cycles, 1))

    def __enter__(self) -> TrialProgress:
        if self._on:
            self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._on:
            self._progress.stop()

    def show(self, outputs: Outputs) -> None:
        """Progress of the run. (The bar draws itself ten times per second, however often it is updated.)"""
        plc = outputs[PLC].block
        if not isinstance(plc, PlcBlock):
            return
        done = plc.first_cycle + plc.count
        if self._on:
            self._progress.update(self._task, completed=done)
        elif self._lines and (percent := min(100, 100 * done // self._cycles)) >= self._said + PERCENT:
            self._said = percent
            print(progress_lines.line(self._label, percent), file=sys.stderr, flush=True)
