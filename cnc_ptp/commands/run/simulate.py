"""`cnc_ptp simulate`: the offline run."""

from __future__ import annotations

import gc
import time
from collections import defaultdict
from dataclasses import dataclass, field
from types import FrameType

from rich.console import Console

from cnc_ptp import KERNEL
from cnc_ptp.channel.program_report import ProgramReport, cut_off_notes, time_lines
from cnc_ptp.commands.console import (
    RUN_FAILED,
    print_error,
    print_faults,
    print_missing_folders,
    print_note_of_idle_run,
)
from cnc_ptp.commands.run.progress import RunProgress
from cnc_ptp.errors import CncError
from cnc_ptp.interrupt import EndRequest
from cnc_ptp.machine.offline import OfflineMachine, Outputs
from cnc_ptp.machine.plc_file import read_plc
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import build_units, unit_kinds
from cnc_ptp.nc.block_search import StartPoint
from cnc_ptp.parameters import MachineParameters, machine_text, read_machine
from cnc_ptp.plc.plc_unit import error_of
from cnc_ptp.plc.program.plc_program import PlcFile
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, PlcBlock, Severity
from cnc_ptp.protocol.notes import Note, Notes, error_text
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.offline_run import OfflineRun
from cnc_ptp.recording.overwriting import check_recording
from cnc_ptp.recording.recorder_options import FROM_THE_START, RecorderOptions
from cnc_ptp.recording.trigger import Condition
from cnc_ptp.state.machine_state import CHECKPOINT_SECONDS

LONG_CYCLE = 1.0
"""Seconds after which an interrupt breaks off a cycle of a PLC in a file."""


@dataclass
class Result:
    """Figures for the summary of a run."""

    cycles: int = 0
    programs: dict[str, ProgramReport] = field(default_factory=lambda: defaultdict(ProgramReport))
    failed: bool = False
    interrupted: str = ""
    following_errors: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    errors: list[str] = field(default_factory=list)
    notes: Notes = field(default_factory=Notes)
    refused: int = 0

    def add(self, outputs: Outputs) -> None:
        for name, output in outputs.items():
            block = output.block
            if isinstance(block, AxisBlock):
                largest = max(max(block.following_error), -min(block.following_error))
                self.following_errors[name] = max(self.following_errors[name], largest)
            elif isinstance(block, ChannelBlock):
                self.programs[name].add(block)
            elif isinstance(block, PlcBlock):
                self.cycles = block.first_cycle + block.count
                # The PLC knows of a fault one block later, and that block may no longer come.
                self.failed = block.run_failed or any(error_of(other.block) for other in outputs.values())
            self.errors += [error_text(event) for event in output.events if event.severity == Severity.ERROR]
            self.refused += sum(not record.accepted for record in output.records)
            for note in (*map(Note.of_command, output.records), *map(Note.of_event, output.events)):
                self.notes.add(note)


def simulate(
    machine: str,
    program: str | None,
    scenario: str | None,
    duration: float | None,
    record: str | None,
    strict: bool = False,
    dialect: str | None = None,
    begin: StartPoint | None = None,
    plc: str | None = None,
    checkpoints: float = CHECKPOINT_SECONDS,
    recorder: RecorderOptions = FROM_THE_START,
) -> int:
    """Runs offline; prints a summary. Status 1 when a unit ended in error, with `strict` also for a refused command."""
    check_recording(record, machine_file=machine, NC_program=program, scenario=scenario, PLC_file=plc)
    recorder.require_places(record)
    parameters = read_machine(machine)
    print_missing_folders(parameters)
    job = read_entries(parameters, program=program, scenario=scenario, dialect=dialect, begin=begin)
    condition = None if recorder.when is None else Condition(recorder.when, unit_kinds(parameters))
    settings = recorder.settings()
    file = None if plc is None else read_plc(plc)
    units = build_units(parameters, scenario=job, end_when_idle=duration is None, plc_file=file)
    text = machine_text(machine)
    run = OfflineRun(
        parameters,
        units,
        record=record,
        machine_text=text,
        condition=condition,
        settings=settings,
        checkpoint_seconds=checkpoints,
    )
    cycles = None if duration is None else round(duration * 1e6 / parameters.cycle_time_us)
    result = Result()
    gc.freeze()  # what was loaded stays to the end: nothing to be searched for garbage
    started = time.monotonic()
    try:
        endless = EndlessCycle(file)
        with RunProgress() as progress, run, EndRequest(endless.break_in) as end:
            for outputs in run.run(cycles=cycles):
                endless.ticked_at = time.monotonic()
                result.add(outputs)
                progress.show_block(outputs)
                if end.given and interrupted(run.machine, outputs, result, end):
                    break
    except CncError as error:
        print_error(error)
        result.failed = True
    if run.failure is not None:  # the recording is not whole
        print_error(run.failure)
    print_summary(parameters, result, time.monotonic() - started, duration)
    print_note_of_idle_run(program, scenario, plc, duration)
    print_note_of_trigger(run)
    print_note_of_checkpoints(run)
    return RUN_FAILED if result.failed or run.failure or result.interrupted or (strict and result.refused) else 0


class EndlessCycle:
    """Breaks off a cycle of a PLC in a file that does not end, when the user interrupts the run."""

    def __init__(self, file: PlcFile | None) -> None:
        self._path = None if file is None else file.path
        self.ticked_at = time.monotonic()
        """When the last block was computed."""

    def break_in(self, frame: FrameType | None) -> None:
        """At a signal: raises KeyboardInterrupt if the file has been busy for long."""
        while frame is not None and frame.f_code.co_filename != self._path:
            frame = frame.f_back
        if frame is not None and time.monotonic() - self.ticked_at > LONG_CYCLE:
            raise KeyboardInterrupt


def interrupted(offline: OfflineMachine, outputs: Outputs, result: Result, end: EndRequest) -> bool:
    """Has everything stopped on its ramps after the first signal; True at standstill, or at the second signal."""
    if not result.interrupted:
        result.interrupted = end.text("everything stops on its ramps")
        offline.stop()
        return False
    plc = outputs[PLC].block
    return end.repeated or (isinstance(plc, PlcBlock) and plc.run_done)


def print_note_of_trigger(run: OfflineRun) -> None:
    """A recording that has not begun."""
    if run.waits_for_trigger:
        text = "note: the condition of --record-when was never true; commands and events alone are recorded"
        Console(highlight=False, soft_wrap=True).print(text, style="yellow")


def print_note_of_checkpoints(run: OfflineRun) -> None:
    """Why a replay from the end of the recording computes more than it would have to."""
    if run.checkpoint_fault:
        Console(highlight=False, soft_wrap=True).print(f"note: {run.checkpoint_fault}", style="yellow", markup=False)


def ratio_text(ratio: float) -> str:
    """With two digits at least: 0.57, 3.4, 120."""
    return f"{ratio:.2g}" if ratio < 10.0 else f"{ratio:.0f}"


def print_summary(
    machine: MachineParameters, result: Result, wall_seconds: float, duration: float | None = None
) -> None:
    cycle_time = machine.cycle_time_us * 1e-6
    console = Console(highlight=False, soft_wrap=True)
    seconds = result.cycles * cycle_time
    console.print(
        f"machine time {seconds:.3f} s ({result.cycles} cycles) in {wall_seconds:.2f} s: "
        f"{ratio_text(seconds / max(wall_seconds, 1e-9))} times real time, {KERNEL.kind}"
    )
    for line in time_lines(result.programs, cycle_time):
        console.print(line, markup=False)
    for axis, error in result.following_errors.items():
        console.print(f"largest following error {axis}: {error:.4f} {'deg' if machine.axes[axis].rotary else 'mm'}")
    notes = [*result.notes]
    if result.interrupted:
        console.print(f"failed: {result.interrupted}", style="bold red", markup=False)
    else:
        notes += cut_off_notes(result.programs, duration)
    stopped = result.failed or bool(result.interrupted)
    print_faults(console, result.errors, notes, stopped=stopped, refused=result.refused)
