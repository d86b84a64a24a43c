"""Checkpoints of a run: states of all units in its recording, so that a replay may begin near any time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, Protocol

from cnc_ptp.errors import CncError
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.recording.mcap_chunks import CORRUPT
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.state.faults import DAMAGED, OTHER_VERSION
from cnc_ptp.state.machine_state import MachineState, StateStore, together

NO_CHECKPOINTS: Final = "the recording has no checkpoints; cnc_ptp replay --checkpoints makes them, once"


class CheckpointKeeper(Protocol):
    """A recording that is being written, or the file beside one."""

    def checkpoint_texts(self, texts: Mapping[str, str]) -> None: ...
    def checkpoint(self, cycle: int, state: bytes) -> None: ...


class Checkpoints:
    """Writes a checkpoint into a recording whenever its time has come."""

    def __init__(self, recording: CheckpointKeeper, parameters: MachineParameters, seconds: float) -> None:
        self._error: CncError | None = None
        self._missing: list[float] = []
        """When there should have been one, s."""
        self._cycle_time = parameters.cycle_time_us * 1e-6
        self._recording, self._store = recording, StateStore(parameters)
        self._cycles = max(1, round(seconds * 1e6 / parameters.cycle_time_us))
        self._next = self._cycles

    @property
    def fault(self) -> str:
        """Why checkpoints are missing, which, and what that means; empty if none is."""
        if self._error is None:
            return ""
        first, last = self._missing[0], self._missing[-1]
        when = f"at {first:g} s" if first == last else f"from {first:g} s to {last:g} s"
        return f"{self._error} {when}: a replay from then on begins at an older checkpoint, or at 0 s"

    def watch(self, machine: OfflineMachine) -> None:
        """The machine has computed a block."""
        if machine.next_cycle < self._next:
            return
        self._next = machine.next_cycle + self._cycles
        try:
            state = self._store.encode(machine)
        except CncError as error:
            self._error = self._error or error
            self._missing.append(machine.next_cycle * self._cycle_time)
            return
        self._recording.checkpoint_texts(self._store.texts)
        self._recording.checkpoint(machine.next_cycle, state)


def state_before(recorded: RunInputs, machine: MachineParameters, cycle: int) -> tuple[MachineState | None, str]:
    """The newest state of a recording at or before `cycle` that this kernel can restore; and why not a newer one."""
    if not recorded.checkpoints:
        return None, recorded.beside or NO_CHECKPOINTS
    store, why = StateStore(machine), ""
    store.texts.update(recorded.checkpoint_texts())
    for read in recorded.states_before(cycle):
        try:
            return together(map(store.restore, read()), machine), why
        except CncError as error:
            if error.number not in (DAMAGED, OTHER_VERSION, CORRUPT):
                raise
            why = why or str(error)
    return None, why or "the recording has no checkpoint before it"
