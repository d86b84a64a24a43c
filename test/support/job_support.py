"""What the blocks of a bench tell of jobs."""

from __future__ import annotations

from collections import defaultdict
from typing import Any

from machine_support import UnitBench

from cnc_ptp.protocol.blocks import JobEvent
from cnc_ptp.protocol.jobs import JobStatus

ACTIVE, DONE, ABORTED, FAILED = JobStatus


def job_events(bench: UnitBench) -> list[JobEvent]:
    """All job events of a bench, in their order."""
    return [event for block in bench.blocks for event in block.job_events]


def told(bench: UnitBench) -> list[tuple[int, int]]:
    """Job and status of each event."""
    return [(event.job, event.status) for event in job_events(bench)]


def end_of(bench: UnitBench, job: int) -> JobEvent:
    """The event with which a job has ended."""
    (end,) = [event for event in job_events(bench) if event.job == job and event.status != ACTIVE]
    return end


def start_of(bench: UnitBench, job: int) -> int:
    """The cycle in which a job became active."""
    (start,) = [event.cycle for event in job_events(bench) if event.job == job and event.status == ACTIVE]
    return start


def job(bench: UnitBench, command: str, **arguments: Any) -> int:
    """Gives a command that must be accepted; the number of its job."""
    record = bench.give(command, **arguments)
    assert record.accepted, record.message
    return record.job


def assert_each_ends_once(bench: UnitBench, accepted: set[int]) -> None:
    """Each accepted job was active once at most, and has one end, which comes last."""
    events: dict[int, list[int]] = defaultdict(list)
    for event in job_events(bench):
        events[event.job].append(event.status)
    assert set(events) == accepted
    for number, statuses in events.items():
        assert statuses in ([ACTIVE, statuses[-1]], [ABORTED], [FAILED]), (number, statuses)
        assert statuses[-1] != ACTIVE, number
