"""`cnc_ptp replay`: verify a recording to the bit, or publish it again."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import partial

from cnc_ptp.commands.console import RUN_FAILED
from cnc_ptp.commands.run.progress import RunProgress
from cnc_ptp.machine.offline import Outputs
from cnc_ptp.parameters import load_machine
from cnc_ptp.protocol.blocks import CycleBlock
from cnc_ptp.recording.checkpoint_file import store_checkpoints
from cnc_ptp.recording.computed_again import commands_by_cycle, computed_again, fresh_machine, no_progress
from cnc_ptp.recording.reader import Recorded
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.recording.stored_states import read_stored
from cnc_ptp.recording.verify import verify as verify_recording


def replay(
    recording: str, verify: bool, publish: bool, rate: float, inputs: bool = False, checkpoints: float | None = None
) -> int:
    """Verifies unless only something else is asked for. Status 1 when a setpoint differs.

    `checkpoints`: seconds between those that are written beside the recording.
    """
    status = 0
    if verify or not (publish or checkpoints):
        recorded = read_stored(recording)
        with RunProgress() as progress:
            result = verify_recording(recorded, partial(replay_blocks, show=progress.show_block))
        print(result.text(), file=sys.stdout if result.equal else sys.stderr)
        if not recorded.complete:
            print(f"note: {recorded.missing}")
        status = 0 if result.equal else RUN_FAILED
    if checkpoints and status == 0:
        print_stored(recording, checkpoints)
    if publish:
        from cnc_ptp.nodes.player import publish_recording

        status = publish_recording(recording, rate=rate, inputs=inputs) or status
    return status


def print_stored(recording: str, seconds: float) -> None:
    """Writes the checkpoints and says how many."""
    with RunInputs(recording) as recorded, RunProgress() as progress:
        stored = store_checkpoints(recorded, seconds, progress.show_block)
    print(f"{stored.path}: {stored.number} checkpoints, {seconds:g} s from one to the next")
    if stored.fault:
        print(f"note: {stored.fault}")


def replay_blocks(
    recorded: Recorded, show: Callable[[Outputs], None] = no_progress
) -> Iterator[tuple[str, CycleBlock]]:
    """Re-runs the kernel with the machine file and the commands of a recording; all blocks up to its last cycle.

    `show` takes what was computed.
    """
    machine = load_machine(recorded.machine_yaml, f"{recorded.path}:machine.yaml")
    commands = commands_by_cycle(recorded.commands, machine)
    for outputs in computed_again(fresh_machine(machine), commands, end_of(recorded)):
        show(outputs)
        yield from ((name, output.block) for name, output in outputs.items())


def end_of(recorded: Recorded) -> int:
    """The cycle after the last one. One altered cycle number must not make it endless, so others have to confirm it:

    the ticks, or (units continue to their standstill when the clock is lost) the number of cycles that a unit recorded.
    """
    confirmed = recorded.longest
    if recorded.ticks is not None and len(recorded.ticks):
        confirmed = max(confirmed, int((recorded.ticks["first_cycle"] + recorded.ticks["count"]).max()))
    return min(recorded.last_cycle + 1, confirmed)
