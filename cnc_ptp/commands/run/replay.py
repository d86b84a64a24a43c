"""`cnc_ptp replay`: verify a recording to the bit, or publish it again."""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Iterator

from cnc_ptp.commands.console import RUN_FAILED
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import load_machine
from cnc_ptp.protocol.blocks import Command, CycleBlock
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.reader import Recorded, read_recording
from cnc_ptp.recording.verify import verify as verify_recording
from cnc_ptp.recording.what_if import is_refused_coupling


def replay(recording: str, verify: bool, publish: bool, rate: float, inputs: bool = False) -> int:
    """Verifies unless only publishing is asked for. Status 1 when a setpoint differs."""
    status = 0
    if verify or not publish:
        recorded = read_recording(recording)
        result = verify_recording(recorded, replay_blocks)
        print(result.text(), file=sys.stdout if result.equal else sys.stderr)
        if not recorded.complete:
            print(f"note: {recorded.missing}")
        status = 0 if result.equal else RUN_FAILED
    if publish:
        from cnc_ptp.nodes.player import publish_recording

        status = publish_recording(recording, rate=rate, inputs=inputs) or status
    return status


def replay_blocks(recorded: Recorded) -> Iterator[tuple[str, CycleBlock]]:
    """Re-runs the kernel with the machine file and the commands of a recording; all blocks up to its last cycle."""
    machine = load_machine(recorded.machine_yaml, f"{recorded.path}:machine.yaml")
    offline = OfflineMachine(machine, build_units(machine, end_when_idle=False))
    commands: dict[int, dict[str, list[Command]]] = defaultdict(lambda: defaultdict(list))
    for record in recorded.commands:
        if record.target != PLC and not is_refused_coupling(record, machine):
            commands[record.cycle][record.target].append(Command.from_record(record))
    for first_cycle in range(0, end_of(recorded), machine.block_cycles):
        outputs = offline.replay_tick(commands.get(first_cycle, {}))
        yield from ((name, output.block) for name, output in outputs.items())


def end_of(recorded: Recorded) -> int:
    """The cycle after the last one. One altered cycle number must not make it endless, so others have to confirm it:

    the ticks, or (units continue to their standstill when the clock is lost) the number of cycles that a unit recorded.
    """
    confirmed = max((len(rows) for rows in recorded.states.values()), default=0)
    if recorded.ticks is not None and len(recorded.ticks):
        confirmed = max(confirmed, int((recorded.ticks["first_cycle"] + recorded.ticks["count"]).max()))
    return min(recorded.last_cycle + 1, confirmed)
