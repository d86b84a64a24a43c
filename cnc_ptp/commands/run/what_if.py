"""`cnc_ptp replay --from … --set …`: a recorded run computed again with something changed."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from itertools import chain, islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from cnc_ptp.commands.look.diff import check_diff_page, show_difference
from cnc_ptp.commands.run.progress import RunProgress
from cnc_ptp.machine.program_files import read_file, read_program
from cnc_ptp.machine.run_entries import load_arguments, program_search
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.plc.scenario import Entry, parse_scenario
from cnc_ptp.recording.offline_run import write
from cnc_ptp.recording.origin import WITHOUT, origin
from cnc_ptp.recording.overwriting import check_recording, replacing
from cnc_ptp.recording.run_inputs import RunInputs
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
        path = output or str(Path(folder) / "what_if.mcap")
        with replacing(path) if Path(path).exists() else nullcontext(path) as place:
            refused = compute(run, recorded, str(place))
        print(f"note: {run.note}" if run.note else "computed from 0 s")
        if recorded.missing:
            print(f"note: {recorded.missing}")
        if recorded.plc_file:
            print(f"note: the PLC {recorded.plc_file} is not executed again; its commands are those of the recording")
        for text in refused.of_recording:
            print(f"note: {text}")
        for text in refused.of_change:
            print(f"error: {text}", file=sys.stderr)
        for channel in run.running:
            print(f"note: the program of {channel} has not ended; --to a later time computes more of it")
        if diff or page or output is None:
            names = (Path(recording).name, Path(output).name if output else "changed")
            show_difference(recording, path, page, names, end=end)
    return int(bool(refused.of_change))


class Refused(NamedTuple):
    """Texts of commands that were refused and had not been in the recorded run."""

    of_recording: list[str]
    of_change: list[str]


@contextmanager
def nothing_collected() -> Iterator[None]:
    """What is read and made before the first block stays: looking for garbage would take a tenth of the time."""
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def compute(run: WhatIf, recorded: RunInputs, path: str) -> Refused:
    """Records the run."""
    known = {(record.cycle, record.target, record.command) for record in recorded.commands if not record.accepted}
    refused = Refused([], [])
    notes = {"what_if_of": recorded.path.name, **origin()}
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
            for record in [record for output in outputs.values() for record in output.records if not record.accepted]:
                what = (record.cycle, record.target, record.command)
                at = record.cycle * recorded.cycle_time_ns * 1e-9
                text = f"{record.command} to {record.target} at {at:g} s is refused: {record.message}"
                if what in run.given:
                    refused.of_change.append(text)
                elif what not in known:
                    refused.of_recording.append(text)
    if run.not_replaced:
        refused.of_change.append(run.not_replaced)
    return refused


def load_of(recorded: RunInputs, program: str | None) -> dict[str, object] | None:
    """Arguments of `load` for a program file."""
    if program is None:
        return None
    machine = recorded.required_machine()
    text, files = read_program(program, program_search(machine))
    return load_arguments(program, text, files)


def entries_of(recorded: RunInputs, commands: str | None) -> list[Entry]:
    """Those of a scenario file, whose times are those of the run."""
    if commands is None:
        return []
    machine = recorded.required_machine()
    folder = Path(commands).parent
    text = read_file("scenario", commands)
    return parse_scenario(text, commands, unit_kinds(machine), lambda what, path: read_file(what, str(folder / path)))
