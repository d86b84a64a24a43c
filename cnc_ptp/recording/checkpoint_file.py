"""Checkpoints of a recording that has none, as one of the graph, in a file beside it.

The run is computed once. The file names the run that it belongs to by all that decides it: machine and commands.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cnc_ptp.errors import CncError
from cnc_ptp.machine.offline import Outputs
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.blocks import CycleBlock
from cnc_ptp.recording.checkpoints import Checkpoints
from cnc_ptp.recording.computed_again import commands_by_cycle, computed_again, fresh_machine, no_progress
from cnc_ptp.recording.difference import field_difference
from cnc_ptp.recording.mcap_file import McapFile
from cnc_ptp.recording.new_recording import in_place_of
from cnc_ptp.recording.opened import OpenRecording
from cnc_ptp.recording.run_difference import CYCLE, fields_of
from cnc_ptp.recording.run_inputs import CHECKPOINTS_OF, RunInputs, checkpoint_file
from cnc_ptp.recording.selection import NOT_RECORDED
from cnc_ptp.recording.writer import CHECKPOINT, write_new_texts

OTHER_RESULT = 26210
NO_CHECKPOINT = 26223
SHORTER = "no file was written, choose a shorter time"


class Stored(NamedTuple):
    """The file, the number of its checkpoints, and why some are missing (empty: none is)."""

    path: Path
    number: int
    fault: str


def store_checkpoints(recorded: RunInputs, seconds: float, show: Callable[[Outputs], None] = no_progress) -> Stored:
    """Computes the run and writes its state every so many seconds of machine time to the file beside the recording.

    At each of them the values of the recording are compared; `show` takes what was computed. Raises CncError 26007
    and 26113 where the file cannot be written, 26018 (not from 0), 26155 (no machine file), 26210 for another result;
    then an older file remains.
    """
    recorded.require_from_0()
    machine = recorded.required_machine()
    path = checkpoint_file(recorded.path)
    with in_place_of(path) as new, OpenRecording(recorded.path) as states, CheckpointFile(new, recorded) as file:
        checkpoints = Checkpoints(file, machine, seconds)
        offline = fresh_machine(machine)
        for outputs in computed_again(offline, commands_by_cycle(recorded.commands, machine), recorded.end):
            show(outputs)
            count = file.count
            checkpoints.watch(offline)
            if file.count > count:
                require_same(states, machine, offline.parts[1])
        if not (file.count or checkpoints.fault):
            reason = (
                f"recording {recorded.path}: has no checkpoint within {recorded.end * machine.cycle_time_us * 1e-6:g} s"
            )
            raise CncError(NO_CHECKPOINT, f"{reason} when they are {seconds:g} s apart", SHORTER)
    return Stored(path, file.count, checkpoints.fault)


class CheckpointFile:
    """The file while it is written."""

    def __init__(self, path: Path, recorded: RunInputs) -> None:
        self.count = 0
        self._texts: set[str] = set()
        self._file = McapFile(path, describe=without_metadata)
        self._file.metadata(CHECKPOINTS_OF, {"run": recorded.run_id()})

    def checkpoint_texts(self, texts: Mapping[str, str]) -> None:
        write_new_texts(self._file, texts, self._texts, 0)

    def checkpoint(self, cycle: int, state: bytes) -> None:
        self._file.attachment(f"{CHECKPOINT}{cycle}", "application/octet-stream", state, 0)
        self.count += 1

    def __enter__(self) -> CheckpointFile:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()


def without_metadata(_path: Path, _information: dict[str, Any]) -> None:
    """The file is no bag."""


def require_same(recorded: OpenRecording, machine: MachineParameters, blocks: Mapping[str, CycleBlock]) -> None:
    """The values of some blocks are those of the recording, as far as it has these cycles. Raises CncError 26210."""
    cycle_time = machine.cycle_time_us * 1e-6
    for unit, fields in fields_of(machine).items():
        block = blocks[unit]
        begin, end = block.first_cycle, block.first_cycle + block.count
        try:
            known = recorded.columns(
                f"/{unit}/state", CYCLE, *fields, start=begin * cycle_time, end=(end - 1) * cycle_time
            )
        except CncError as error:
            if error.number != NOT_RECORDED:
                raise
            continue
        places = known[CYCLE].astype(np.int64) - begin
        for field in fields if len(places) else ():
            computed = np.array(getattr(block, field))[places]
            found = field_difference(unit, field, known[CYCLE], known[field], computed)
            if found.parted >= 0:
                reason = f"{field} of {unit} at {found.parted * cycle_time:g} s is another one when computed again"
                remedy = "no checkpoints were written, `cnc_ptp replay --verify` lists all differences"
                raise CncError(OTHER_RESULT, f"recording {recorded.path}: {reason}", remedy)
