"""A trajectory of several axes as one job, and the halt of all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from cnc_ptp.client.faults import IT_CONTINUES, UNSEEN, check_seconds, error_of
from cnc_ptp.client.job import Job
from cnc_ptp.client.link import Reply, reply_of
from cnc_ptp.client.session import Session, Turns
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.axis_states import REST_STATES
from cnc_ptp.protocol.blocks import AxisBlock, CommandRecord, CycleBlock
from cnc_ptp.protocol.jobs import JobStatus
from cnc_ptp.protocol.unit import PLC


class TrajectoryJob(Job):
    """A trajectory that axes follow together. The PLC gives it to each of them, so that each has a job of its own."""

    def __init__(
        self, session: Session, axes: Sequence[str], command: str, arguments: Mapping[str, Any], reply: Reply
    ) -> None:
        super().__init__(session, PLC, command, arguments, reply)
        self._axes = axes
        self._jobs: dict[str, Job] = {}

    @property
    def jobs(self) -> Mapping[str, Job]:
        """Of the axes that have begun, by name: the records of the axes tell their numbers."""
        for axis, record in self._records().items():
            if axis not in self._jobs and record.accepted:
                self._jobs[axis] = Job(self._session, axis, self.command, {}, reply_of(record))
        return self._jobs

    def _records(self) -> Mapping[str, CommandRecord]:
        """What the axes have answered so far."""
        found = {axis: self._session.link.seen.trajectory(axis, self.cycle) for axis in self._axes}
        return {axis: record for axis, record in found.items() if record is not None}

    @property
    def status(self) -> JobStatus | None:
        """ACTIVE until all have ended; then FAILED if one has failed, ABORTED if one was aborted, DONE.

        FAILED as soon as an axis has refused it. None before all have begun.
        """
        if self._refusal() is not None:
            return JobStatus.FAILED
        jobs = self.jobs.values()
        if len(jobs) < len(self._axes):
            return None
        if not all(job.ended for job in jobs):
            return JobStatus.ACTIVE
        return max(job.status or JobStatus.ACTIVE for job in jobs)

    @property
    def reached(self) -> bool:
        """It has an end of its own."""
        return False

    def cancel(self) -> Job:
        """Stops the axes that have not ended on their ramps (halt): done when all are at rest."""
        for name, job in self.jobs.items():
            if not job.ended:
                self._session.ask(name, "halt", {})
        return StandstillJob(self._session, self._axes)

    def _refusal(self) -> CncError | None:
        for record in self._records().values():
            if not record.accepted:
                return error_of(record.error_id, record.message, record.values)
        return None

    def _unseen(self) -> list[str]:
        """Axes whose answer has not come, and will not."""
        seen, records = self._session.link.seen, self._records()
        return [axis for axis in self._axes if axis not in records and seen.has_gap(axis, self.cycle)]

    def _is_over(self) -> bool:
        """All axes have answered, those that have begun are at rest, and the PLC knows: it may get the next one."""
        if self._unseen():
            return True
        seen, records = self._session.link.seen, self._records()
        told = len(records) == len(self._axes) and all(seen.is_known_to_all(each.cycle) for each in records.values())
        return told and all(job._is_over() for job in self.jobs.values())

    def _to_the_end(self, timeout: float | None) -> Turns:
        """Raises what has gone wrong first: the others were stopped for it."""
        check_seconds(f"{self._what}: wait", "timeout", timeout, IT_CONTINUES)
        yield from self._session.until(self._is_over, timeout, f"{self._what} is not done")
        if (refusal := self._refusal()) is not None:
            raise refusal
        for axis in self._unseen():
            reason = f"axis {axis}: {self.command} was answered in blocks that this client has not got"
            raise CncError(UNSEEN, reason, "how it has ended is not known")
        for job in sorted(self.jobs.values(), key=lambda job: job.status is not JobStatus.FAILED):
            yield from job._to_the_end(None)

    def __repr__(self) -> str:
        status = "not begun" if self.status is None else self.status.name.lower()
        return f"<{self.command} of {', '.join(self._axes)}: {status}>"


class StandstillJob(Job):
    """Axes that come to rest, whatever they were stopped by."""

    def __init__(self, session: Session, axes: Sequence[str]) -> None:
        super().__init__(session, PLC, "halt", {}, Reply(session.link.seen.cycle, 0, "", {}, 0))
        self._axes = axes
        self._rest = -1
        """The cycle in which all were seen at rest; -1: none was."""

    @property
    def status(self) -> JobStatus:
        """DONE when all are at rest."""
        blocks = [self._session.link.seen.blocks[axis] for axis in self._axes]
        if self._rest < 0 and all(self._rests(block) for block in blocks):
            self._rest = max(block.first_cycle for block in blocks)
        return JobStatus.ACTIVE if self._rest < 0 else JobStatus.DONE

    def _rests(self, block: CycleBlock) -> bool:
        return isinstance(block, AxisBlock) and block.first_cycle >= self.cycle and block.state[-1] in REST_STATES

    @property
    def reached(self) -> bool:
        """It has an end of its own."""
        return False

    def cancel(self) -> Job:
        """They stop already."""
        return self

    def _to_the_end(self, timeout: float | None) -> Turns:
        check_seconds(f"{self._what}: wait", "timeout", timeout, IT_CONTINUES)
        yield from self._session.until(self._is_over, timeout, f"{self._what} is not done")

    def _is_over(self) -> bool:
        return self.status is JobStatus.DONE and self._session.link.seen.is_known_to_all(self._rest)

    def __repr__(self) -> str:
        return f"<halt of {', '.join(self._axes)}: {self.status.name.lower()}>"
