"""`cnc_ptp replay --from … --set …`: a recorded run computed again with something changed."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import chain, islice
from pathlib import Path
from tempfile import TemporaryDirectory

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.commands.look.diff import check_diff_page, show_difference
from cnc_ptp.commands.run.progress import RunProgress
from cnc_ptp.errors import CncError
from cnc_ptp.machine.program_files import read_file, read_program
from cnc_ptp.machine.run_entries import load_arguments, program_search
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc.scenario import Entry, parse_scenario
from cnc_ptp.protocol.blocks import CommandRecord
from cnc_ptp.recording.new_recording import in_place_of
from cnc_ptp.recording.offline_run import write
from cnc_ptp.recording.origin import WHAT_IF_OF, WITHOUT, origin
from cnc_ptp.recording.overwriting import check_recording
from cnc_ptp.recording.parts import describe_file
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.recording.selection import NOT_RECORDED
from cnc_ptp.recording.what_if import Change, WhatIf
from cnc_ptp.recording.writer import Recording


def what_if(
    recording: str,
    *,
    begin: float,
    end: float | None,
    parameters: tuple[str, ...],
    override: float | None,
    program: str | None,
    commands: str | None,
    output: str | None,
    diff: bool,
    page: str | None = None,
) -> int:
    """Computes, records to `output`; prints the difference if there is no output, or `diff` or a page asks for it.

    Status 1 where the machine has refused what was to be changed, or the other program has not come in.
    """
    check_recording(output, recording=recording, NC_program=program, commands=commands)
    check_diff_page(page, recording=recording, NC_program=program, commands=commands)
    with nothing_collected(), RunInputs(recording) as recorded, TemporaryDirectory() as folder:
        change = Change(begin, end, parameters, override, load_of(recorded, program), entries_of(recorded, commands))
        run = WhatIf(recorded, change)
        if not recorded.end and (diff or page is not None or output is None):
            reason = f"recording {recording}: holds no states to compare with"
            raise CncError(NOT_RECORDED, reason, "nothing was computed; give --to and --output alone")
        path = Path(output or Path(folder) / "what_if.mcap")
        if path.exists():
            with in_place_of(path) as part:
                compute(run, recorded, part)
            describe_file(path)
        else:
            compute(run, recorded, path)
        print(f"note: {run.note}" if run.note else "computed from 0 s")
        if recorded.missing:
            print(f"note: {recorded.missing}")
        if recorded.plc_file:
            print(f"note: the PLC {recorded.plc_file} is not executed again; its commands are those of the recording")
        if len(run.machine.channels) > 1 and run.replaced:
            print(f"note: {program} takes the place of the program of {run.replaced}")
        for record in run.refused_of_recording:
            print(f"note: {refusal_text(record, recorded.cycle_time_ns)}")
        errors = [refusal_text(record, recorded.cycle_time_ns) for record in run.refused_of_change]
        for text in [*errors, *filter(None, [run.not_replaced])]:
            print(f"error: {text}", file=sys.stderr)
        for channel in run.running:
            print(f"note: the program of {channel} has not ended; --to a later time computes more of it")
        if diff or page or output is None:
            show_difference(recording, str(path), page, (recording, output or "changed"), end=end)
    return int(bool(run.refused_of_change or run.not_replaced))


@contextmanager
def nothing_collected() -> Iterator[None]:
    """What is read and made before the first block stays: looking for garbage would take a tenth of the time."""
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def compute(run: WhatIf, recorded: RunInputs, path: Path) -> None:
    """Records the run."""
    notes = {WHAT_IF_OF: recorded.path.name, **origin()}
    if run.begin:
        notes[WITHOUT] = (
            f"it is what became of {recorded.path.name} from cycle {run.begin} on, what was before is there"
        )
    blocks = run.run()
    first = [*islice(blocks, 1)]  # what refuses the change does it now, before a file is overwritten
    gc.freeze()
    gc.enable()
    with (
        RunProgress() as progress,
        Recording(path, run.machine_text, recorded.start_ns, recorded.cycle_time_ns, notes=notes) as recording,
    ):
        for outputs in chain(first, blocks):
            write(recording, outputs)
            progress.show_block(outputs)


def refusal_text(record: CommandRecord, cycle_time_ns: int) -> str:
    at = record.cycle * cycle_time_ns * 1e-9
    return f"{record.command} to {record.target} at {at:g} s is refused: {record.message}"


def load_of(recorded: RunInputs, program: str | None) -> dict[str, object] | None:
    """Arguments of `load` for a program file. Raises ProgramError where no channel can read it."""
    if program is None:
        return None
    machine = recorded.required_machine()
    text, files = read_program(program, program_search(machine))
    require_syntax(machine, text, program, files)
    return load_arguments(program, text, files)


def require_syntax(machine: MachineParameters, text: str, program: str, files: Mapping[str, str]) -> None:
    """Raises the ProgramError of the first channel if every one has one: each has a vocabulary of its own."""
    faults: list[ProgramError] = []
    for channel in machine.channels.values():
        try:
            ProgramCheck(channel, machine.axes, machine.spindles).parse(text, program, files)
        except ProgramError as fault:
            fault.effect = "nothing was computed"
            faults.append(fault)
    if faults and len(faults) == len(machine.channels):
        raise faults[0]


def entries_of(recorded: RunInputs, commands: str | None) -> list[Entry]:
    """Those of a scenario file, whose times are those of the run."""
    if commands is None:
        return []
    machine = recorded.required_machine()
    folder = Path(commands).parent
    text = read_file("scenario", commands)
    return parse_scenario(text, commands, unit_kinds(machine), lambda what, path: read_file(what, str(folder / path)))
