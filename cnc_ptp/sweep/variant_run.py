"""One variant: the machine with its values, run offline; its goals, or why there are none."""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from hashlib import blake2b
from importlib.metadata import version

import numpy as np

from cnc_ptp.channel.program_report import ProgramReport, cut_off_notes
from cnc_ptp.compiled.sources import hashes, sources
from cnc_ptp.errors import CncError
from cnc_ptp.machine.offline import OfflineMachine, Outputs
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import MachineParameters, load_machine
from cnc_ptp.plc.plc_unit import error_of
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import ChannelBlock, Command, PlcBlock, Severity
from cnc_ptp.sweep.faults import BROKEN_OFF, UNFIT_WORKERS
from cnc_ptp.sweep.goals import Floats, Goal, Signal, read_goals
from cnc_ptp.sweep.results import Row, Variant
from cnc_ptp.sweep.variation import changes_of


@dataclass(frozen=True, slots=True)
class Job:
    """All that variants have in common, as it goes to the workers.

    `machine_text` with the files that the machine names; `commands` with their times
    in s; `varied` (unit, parameter) in the order of a variant's
    values; `seconds`: end of each run, None: when all is finished; `kernel`: that of whoever has made the job.
    """

    machine_text: str
    machine_file: str
    commands: tuple[tuple[float, Command], ...]
    varied: tuple[tuple[str, str], ...]
    goals: tuple[str, ...]
    seconds: float | None
    kernel: str


class Failure(Exception):
    """Why a run has no goals."""

    def __init__(self, number: int, text: str) -> None:
        super().__init__(number, text)
        self.number = number
        self.text = text


@cache
def kernel_id() -> str:
    """What decides the results to the bit: version of the package, and sources of the kernel."""
    digest = blake2b(repr(sorted(hashes(sources()).items())).encode(), digest_size=8).hexdigest()
    return f"{version('cnc_ptp')} {digest}"


def compute(job: Job, variant: Variant) -> Row:
    """Runs a variant. What goes wrong in it becomes its row; raises CncError 26186 in a worker of another kernel."""
    if job.kernel != kernel_id():
        raise CncError(UNFIT_WORKERS, f"a worker has cnc_ptp {kernel_id()}, this is {job.kernel}")
    try:
        return Row(*variant, measure(job, variant))
    except Failure as failure:
        return failed(job, variant, failure.number, failure.text)
    except CncError as error:
        return failed(job, variant, error.number, error.meaning("the variant was not computed").message)
    except Exception as error:
        return failed(job, variant, BROKEN_OFF, f"the run broke off, {type(error).__name__}: {error}")


def failed(job: Job, variant: Variant, number: int, message: str) -> Row:
    return Row(*variant, (math.nan,) * len(job.goals), number, message)


def measure(job: Job, variant: Variant) -> tuple[float, ...]:
    """The goals of a variant. Raises Failure and CncError for one that has none."""
    changes = changes_of(job.varied, variant.values)
    machine = load_machine(job.machine_text, job.machine_file, changes=changes)
    goals = read_goals(job.goals, machine)
    run = Run(machine, goals)
    cycles = None if job.seconds is None else round(job.seconds * 1e6 / machine.cycle_time_us)
    entries = [Entry(at, deepcopy(command)) for at, command in job.commands]
    units = build_units(machine, scenario=entries, end_when_idle=cycles is None)
    for outputs in OfflineMachine(machine, units).run(cycles=cycles):
        run.add(outputs)
    run.require_whole(job.seconds)
    return run.goals()


class Run:
    """The columns of an offline run that goals need."""

    def __init__(self, machine: MachineParameters, goals: Sequence[Goal]) -> None:
        self._goals = goals
        self._cycle_time = machine.cycle_time_us * 1e-6
        signals = {signal for goal in goals for signal in goal.signals.values()}
        self._columns: dict[Signal, array[float]] = {signal: array("d") for signal in sorted(signals)}
        self._programs: dict[str, ProgramReport] = {}
        self._cycles = 0
        self._failed = False

    def add(self, outputs: Outputs) -> None:
        """The next block of all units. Raises Failure for the first error, or a command that was refused."""
        require_sound(outputs)
        for signal, column in self._columns.items():
            column.extend(getattr(outputs[signal.unit].block, signal.field))
        for name, output in outputs.items():
            block = output.block
            if isinstance(block, ChannelBlock):
                self._programs.setdefault(name, ProgramReport()).add(block)
            elif isinstance(block, PlcBlock):
                self._cycles = block.first_cycle + block.count
                self._failed = block.run_failed

    def require_whole(self, seconds: float | None) -> None:
        """Raises Failure for a program that the duration has cut off, and a run that failed without an error."""
        for note in cut_off_notes(self._programs, seconds):
            raise Failure(note.number, note.text)
        if self._failed:
            raise Failure(BROKEN_OFF, "the run failed")

    def goals(self) -> tuple[float, ...]:
        """Raises CncError 26179 for one that is not finite."""
        columns: Mapping[Signal, Floats] = {name: np.array(column) for name, column in self._columns.items()}
        longest = max((program.cycles for program in self._programs.values()), default=0)
        times = {"program_time": longest * self._cycle_time, "run_time": self._cycles * self._cycle_time}
        return tuple(goal.value(columns, times) for goal in self._goals)


def require_sound(outputs: Outputs) -> None:
    """Raises Failure for an error, and for a command that was refused: the motion is not the intended one."""
    for output in outputs.values():
        for record in output.records:
            if not record.accepted:
                raise Failure(record.error_id, record.message)
        for event in output.events:
            if event.severity == Severity.ERROR:
                raise Failure(event.error_id, event.text)
    for name, output in outputs.items():
        if number := error_of(output.block):
            raise Failure(number, f"{name} is in an error")
