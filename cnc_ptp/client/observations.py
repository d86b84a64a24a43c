"""What the units of a machine have told: newest blocks, what has become of jobs, faults, requests of channels."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping
from typing import Generic, NamedTuple, TypeVar
from weakref import WeakSet

from cnc_ptp.client.record_arguments import written_parameter
from cnc_ptp.parameters.declare.declarations import ParameterValue
from cnc_ptp.plc.trajectories import BEGIN
from cnc_ptp.protocol.blocks import (
    ChannelBlock,
    CommandRecord,
    CycleBlock,
    Event,
    HandshakeRequest,
    JobEvent,
    PlcBlock,
    Severity,
)
from cnc_ptp.protocol.jobs import JobStatus
from cnc_ptp.protocol.unit import PLC

Item = TypeVar("Item")
JOBS_KEPT = 1000
FAULTS_KEPT = 100
TRAJECTORIES_KEPT = 100
BLOCKS_KEPT = 1000
"""Of a stream that nobody reads: ten seconds of blocks."""
EVENTS_KEPT = 10_000
LONGEST_WAY = 4
"""Blocks after which a command of the PLC is with every unit that is alive."""


class Mailbox(Generic[Item]):
    """What has come for one reader; the oldest is lost when there is too much."""

    def __init__(self, most: int) -> None:
        self.items: deque[Item] = deque(maxlen=most)


class Request(NamedTuple):
    """A request of a channel, and the cycle from which on the PLC knows of it."""

    known_at: int
    request: HandshakeRequest


class Observations:
    """Filled by the link to the machine, block by block; read by everybody else."""

    def __init__(self, units: Iterable[str]) -> None:
        names = [*units]
        self.blocks: dict[str, CycleBlock] = {}
        """The newest of each unit."""
        self.requests: deque[Request] = deque(maxlen=EVENTS_KEPT)
        """Of channels, until somebody takes them."""
        self._jobs: dict[str, dict[int, JobEvent]] = {unit: {} for unit in names}
        self._faults: dict[str, deque[Event]] = {unit: deque(maxlen=FAULTS_KEPT) for unit in names}
        self._gaps: dict[str, int] = {}
        self._trajectories: dict[str, deque[CommandRecord]] = {unit: deque(maxlen=TRAJECTORIES_KEPT) for unit in names}
        self._written: dict[str, dict[str, ParameterValue]] = {unit: {} for unit in names}
        self._block_readers: dict[str, WeakSet[Mailbox[CycleBlock]]] = {unit: WeakSet() for unit in names}
        self._event_readers: WeakSet[Mailbox[Event]] = WeakSet()
        self._record_readers: WeakSet[Mailbox[CommandRecord]] = WeakSet()

    # what comes

    def take_block(self, unit: str, block: CycleBlock) -> None:
        """The next block of a unit; where blocks before it are missing, jobs may have ended unseen."""
        before = self.blocks.get(unit)
        if before is not None and block.first_cycle > before.first_cycle + before.count:
            self._gaps[unit] = block.first_cycle
        if not isinstance(block, PlcBlock):
            self._note_jobs(self._jobs[unit], block.job_events)
        if isinstance(block, ChannelBlock):
            self.requests += (Request(block.first_cycle + block.count, request) for request in block.requests)
        self.blocks[unit] = block
        for reader in [*self._block_readers[unit]]:
            reader.items.append(block)

    @staticmethod
    def _note_jobs(jobs: dict[int, JobEvent], events: Iterable[JobEvent]) -> None:
        for event in events:
            jobs[event.job] = event
        while len(jobs) > JOBS_KEPT:
            del jobs[next(iter(jobs))]

    def take_event(self, event: Event) -> None:
        """An event of a unit, or of anybody else."""
        if event.severity != Severity.INFO and event.error_id and event.source in self._faults:
            self._faults[event.source].append(event)
        for reader in [*self._event_readers]:
            reader.items.append(event)

    def take_record(self, record: CommandRecord) -> None:
        """A command that was carried out or refused, whoever has given it."""
        for reader in [*self._record_readers]:
            reader.items.append(record)
        parameter = written_parameter(record)
        if parameter is not None and record.target in self._written:
            name, value = parameter
            written = self._written[record.target]
            written.pop(name, None)  # the newest is the last one
            written[name] = value
        elif record.command == BEGIN and record.target in self._trajectories:
            self._trajectories[record.target].append(record)

    # what is asked

    def written(self, unit: str) -> Mapping[str, ParameterValue]:
        """Parameters of a unit that were written at run time, by the name with which they were, the newest last."""
        return self._written[unit]

    def trajectory(self, unit: str, cycle: int) -> CommandRecord | None:
        """What an axis has answered to the first trajectory that it got at `cycle` or later; None before it has."""
        return next((record for record in self._trajectories[unit] if record.cycle >= cycle), None)

    def has_gap(self, unit: str, cycle: int) -> bool:
        """Blocks of the unit behind `cycle` have not come."""
        return self._gaps.get(unit, 0) > cycle

    def job_event(self, unit: str, job: int) -> JobEvent | None:
        """The last that is known of a job; None before it has begun."""
        return self._jobs[unit].get(job)

    def ended_unseen(self, unit: str, job: int, cycle: int) -> bool:
        """A job that was accepted at `cycle` has ended in blocks that have not come."""
        block, event = self.blocks.get(unit), self.job_event(unit, job)
        if self._gaps.get(unit, 0) <= cycle or block is None or isinstance(block, PlcBlock):
            return False
        return block.job != job and (event is None or event.status == JobStatus.ACTIVE)

    def is_known_to_all(self, cycle: int) -> bool:
        """Every unit has computed a block after that of a cycle: channels and PLC know then what happened in it."""
        return len(self.blocks) == len(self._jobs) and all(b.first_cycle > cycle for b in self.blocks.values())

    def fault(self, unit: str, error_id: int, cycle: int) -> Event | None:
        """The newest fault of a unit with this number, from a cycle on."""
        faults = [event for event in self._faults[unit] if event.error_id == error_id and event.cycle >= cycle]
        return faults[-1] if faults else None

    def has_arrived(self, cycle: int) -> bool:
        """What the PLC has commanded at `cycle` has reached all units; one that is silent is not waited for long."""
        plc = self.blocks[PLC]
        return self.cycle > cycle or plc.first_cycle > cycle + LONGEST_WAY * plc.count

    @property
    def cycle(self) -> int:
        """The first cycle that not every unit has told of."""
        blocks = self.blocks.values()
        complete = len(blocks) == len(self._jobs)
        return min(block.first_cycle + block.count for block in blocks) if complete else 0

    def known_requests(self) -> Iterable[HandshakeRequest]:
        """Takes the requests that the PLC knows of by now: it would refuse an earlier acknowledgement."""
        while self.requests and self.requests[0].known_at <= self.blocks[PLC].first_cycle:
            yield self.requests.popleft().request

    # who reads along

    def blocks_of(self, unit: str) -> Mailbox[CycleBlock]:
        """The blocks that come from now on, as long as the mailbox is kept."""
        mailbox: Mailbox[CycleBlock] = Mailbox(BLOCKS_KEPT)
        self._block_readers[unit].add(mailbox)
        return mailbox

    def events(self) -> Mailbox[Event]:
        """The events that come from now on, as long as the mailbox is kept."""
        mailbox: Mailbox[Event] = Mailbox(EVENTS_KEPT)
        self._event_readers.add(mailbox)
        return mailbox

    def records(self) -> Mailbox[CommandRecord]:
        """The commands that are carried out or refused from now on, as long as the mailbox is kept."""
        mailbox: Mailbox[CommandRecord] = Mailbox(EVENTS_KEPT)
        self._record_readers.add(mailbox)
        return mailbox
