"""A machine that runs offline and is recorded: each block is computed, then written."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from types import TracebackType

from cnc_ptp.errors import CncError
from cnc_ptp.machine.offline import OfflineMachine, Outputs
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.blocks import CycleTick, Event
from cnc_ptp.protocol.unit import PLC, Unit
from cnc_ptp.recording.checkpoints import Checkpoints
from cnc_ptp.recording.mcap_file import NOT_WRITTEN
from cnc_ptp.recording.on_demand import OnDemand, Snapshots
from cnc_ptp.recording.settings import Settings
from cnc_ptp.recording.trigger import Condition, TriggeredRecording, make_recording
from cnc_ptp.recording.writer import AS_USUAL, Recording
from cnc_ptp.state.machine_state import CHECKPOINT_SECONDS
from cnc_ptp.wire.stamps import Stamps


class OfflineRun:
    """The run of an offline machine, with a recording if one is wanted; it is closed at the end of a `with` block.

    Raises CncError 26007 where the recording cannot be begun. When it cannot be continued the run continues without it;
    `failure` says so.
    """

    failure: CncError | None = None

    def __init__(
        self,
        parameters: MachineParameters,
        units: Mapping[str, Unit],
        *,
        record: str | None = None,
        machine_text: str = "",
        condition: Condition | None = None,
        settings: Settings = AS_USUAL,
        checkpoint_seconds: float = CHECKPOINT_SECONDS,
        snapshots: Snapshots | None = None,
    ) -> None:
        """`units` in the order of computation; `machine_text` is kept in the recording `record`.

        `condition`: with which the recording begins; None: at once. `checkpoint_seconds` of machine time between two
        checkpoints; 0: none. `snapshots`: what is kept by a recorder that also records on demand; None: without one.
        """
        self.machine = OfflineMachine(parameters, units)
        cycle_time_ns = parameters.cycle_time_us * 1000
        self._recording: Recording | None = None
        if record is not None:
            self._recording = make_recording(record, machine_text, 0, cycle_time_ns, condition, settings)
        self.recorder: OnDemand | None = None
        """Records on demand, and has the recording of the run."""
        self.events: list[Event] = []
        """What it has told so far."""
        self.cycle_time = cycle_time_ns * 1e-9
        if snapshots is not None:
            self.recorder = OnDemand(
                machine_text,
                Stamps(0, cycle_time_ns),
                units,
                current=self._recording,
                settings=settings,
                snapshots=snapshots,
                publish=self._note_event,
            )
        self._sink = self.recorder or self._recording
        self._checkpoints: Checkpoints | None = None
        if self._sink is not None and checkpoint_seconds > 0.0:
            self._checkpoints = Checkpoints(self._sink, parameters, checkpoint_seconds)

    def step(self) -> Outputs:
        """The next block of all units."""
        return self._recorded(self.machine.tick())

    def run(self, *, cycles: int | None = None) -> Iterator[Outputs]:
        """Block by block to the end of the run, as OfflineMachine.run."""
        return map(self._recorded, self.machine.run(cycles=cycles))

    @property
    def checkpoint_fault(self) -> str:
        """From when on there is no checkpoint, why, and what that means; empty if none is missing."""
        return "" if self._checkpoints is None else self._checkpoints.fault

    @property
    def waits_for_trigger(self) -> bool:
        """The condition of the recording has not been true yet."""
        return isinstance(self._recording, TriggeredRecording) and self._recording.begin is None

    def close(self) -> None:
        if self._sink is not None:
            with self._going_on():
                self._sink.close()

    @property
    def now(self) -> float:
        """Machine time in s up to which everything is computed."""
        return self.machine.next_cycle * self.cycle_time

    def _recorded(self, outputs: Outputs) -> Outputs:
        sink = self.recorder or (self._recording if self.failure is None else None)
        if sink is not None:
            with self._going_on():
                write(sink, outputs)
                if self._checkpoints is not None and (self.recorder or not self.waits_for_trigger):
                    self._checkpoints.watch(self.machine)
        if self.recorder is not None:
            self.recorder.carry_out(self.now)
        return outputs

    def _note_event(self, event: Event) -> None:
        """Of the recorder, which records it as one of the run."""
        self.events.append(event)
        if self.recorder is not None:
            self.recorder.event(event)

    @contextmanager
    def _going_on(self) -> Iterator[None]:
        """Keeps the first error of a disk that is full."""
        try:
            yield
        except CncError as error:
            if error.number != NOT_WRITTEN:
                raise
            self.failure = self.failure or error
            if self.recorder is not None:
                self.recorder.fail(error, max(0, self.machine.next_cycle - 1))

    def __enter__(self) -> OfflineRun:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def write(recording: Recording | OnDemand, outputs: Outputs) -> None:
    """Records the blocks, events and commands of all units for one tick."""
    plc = outputs[PLC].block
    recording.tick(CycleTick(plc.first_cycle, plc.count))
    for name, output in outputs.items():
        recording.block(name, output.block)
        for event in output.events:
            recording.event(event)
        for record in output.records:
            recording.command(record)
