"""Checkpoints of a run: states of all units in its recording, so that a replay may begin near any time."""

from __future__ import annotations

from typing import Final

from cnc_ptp.errors import CncError
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.recording.reader import Recorded
from cnc_ptp.recording.writer import CHECKPOINT_TEXT, Recording
from cnc_ptp.state.machine_state import MachineState, StateStore

CHECKPOINT_SECONDS: Final = 10.0
"""Machine time between two checkpoints. A replay computes so much more than it was asked for."""


class Checkpoints:
    """Writes a checkpoint into a recording whenever its time has come.

    fault   why there is none from a time on: a program can no longer be made again
    """

    def __init__(self, recording: Recording, parameters: MachineParameters, seconds: float) -> None:
        self.fault: CncError | None = None
        self._recording, self._store = recording, StateStore(parameters)
        self._cycles = max(1, round(seconds * 1e6 / parameters.cycle_time_us))
        self._next = self._cycles
        self._texts: set[str] = set()

    def watch(self, machine: OfflineMachine) -> None:
        """The machine has computed a block."""
        if machine.next_cycle < self._next:
            return
        self._next = machine.next_cycle + self._cycles
        try:
            state = self._store.encode(machine)
        except CncError as error:
            self.fault = self.fault or error
            return
        for digest in self._store.texts.keys() - self._texts:
            self._texts.add(digest)
            self._recording.attachment(f"{CHECKPOINT_TEXT}{digest}", "text/plain", self._store.texts[digest])
        self._recording.checkpoint(machine.next_cycle, state)


def state_before(recorded: Recorded, machine: MachineParameters, cycle: int) -> tuple[MachineState | None, str]:
    """The newest state of a recording at or before `cycle` that this kernel can restore; and why not a newer one."""
    store, why = StateStore(machine), ""
    store.texts.update(recorded.checkpoint_texts)
    for first in sorted((first for first in recorded.checkpoints if first <= cycle), reverse=True):
        try:
            return store.restore(recorded.checkpoints[first]), why
        except CncError as error:
            why = why or str(error)
    return None, why or "the recording has no checkpoint before it"
