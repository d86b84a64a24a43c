"""`cnc_ptp replay --from … --set …`: a recorded run computed again with something changed."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console
from rich.table import Table

from cnc_ptp.commands.run.replay import end_of
from cnc_ptp.machine.program_files import read_file, read_program
from cnc_ptp.machine.run_entries import load_arguments, program_search
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.parameters import load_machine
from cnc_ptp.plc.scenario import Entry, parse_scenario
from cnc_ptp.recording.offline_run import write
from cnc_ptp.recording.overwriting import check_recording
from cnc_ptp.recording.reader import Recorded, read_recording
from cnc_ptp.recording.run_difference import RunDifference, difference
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
) -> int:
    """Computes, records to `output`, and prints the difference if there is no output or `diff` asks for it."""
    check_recording(output, recording=recording, NC_program=program, commands=commands)
    recorded = read_recording(recording)
    change = Change(begin, end, parameters, override, load_of(recorded, program), entries_of(recorded, commands))
    run = WhatIf(recorded, change, end_of(recorded))
    with TemporaryDirectory() as folder:
        path = output or str(Path(folder) / "what_if.mcap")
        compute(run, recorded, path)
        print(f"note: {run.note}" if run.note else "computed from 0 s")
        if diff or output is None:
            print_difference(difference(recorded, read_recording(path)))
    return 0


def compute(run: WhatIf, recorded: Recorded, path: str) -> None:
    notes = {"what_if_of": recorded.path.name}
    with Recording(path, run.machine_text, recorded.start_ns, recorded.cycle_time_ns, notes=notes) as recording:
        for outputs in run.run():
            write(recording, outputs)


def load_of(recorded: Recorded, program: str | None) -> dict[str, object] | None:
    """Arguments of `load` for a program file."""
    if program is None:
        return None
    machine = load_machine(recorded.machine_yaml, f"{recorded.path}:machine.yaml")
    text, files = read_program(program, program_search(machine))
    return load_arguments(program, text, files)


def entries_of(recorded: Recorded, commands: str | None) -> list[Entry]:
    """Those of a scenario file, whose times are those of the run."""
    if commands is None:
        return []
    machine = load_machine(recorded.machine_yaml, f"{recorded.path}:machine.yaml")
    folder = Path(commands).parent
    text = read_file("scenario", commands)
    return parse_scenario(text, commands, unit_kinds(machine), lambda what, path: read_file(what, str(folder / path)))


def print_difference(found: RunDifference) -> None:
    """A table of all columns that differ."""
    console = Console(highlight=False, soft_wrap=True)
    parted = [row for row in found.rows if row.parts_at is not None]
    console.print(f"compared from {found.begin:g} s to {found.end:g} s", markup=False)
    for channel, (one, two) in found.program_times.items():
        console.print(f"program time {channel}: {one:.3f} s -> {two:.3f} s ({two - one:+.3f} s)", markup=False)
    if not parted:
        console.print("both runs are equal to the bit")
        return
    console.print(f"the runs part at {found.parts_at:g} s")
    table = Table("unit", "column", "largest", "now", "largest difference", "at s", "parts at s")
    for row in parted:
        numbers = [f"{value:.6g}" for value in (row.first, row.second, row.difference)]
        table.add_row(row.unit, row.column, *numbers, f"{row.at:.3f}", f"{row.parts_at:.3f}")
    console.print(table)
