"""A job: what a command has begun, and how it ends."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from cnc_ptp.client.faults import ABORTED, IT_CONTINUES, UNSEEN, check_seconds, error_of, fault_of
from cnc_ptp.client.goals import GOALS
from cnc_ptp.client.link import Reply
from cnc_ptp.client.session import Session, Turns
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import ChannelBlock
from cnc_ptp.protocol.jobs import JobStatus
from cnc_ptp.protocol.unit_view import UnitView, view_of

SelfJob = TypeVar("SelfJob", bound="Job")
TEXT_TIMEOUT = 1.0
"""Seconds that the text of a fault may come later than its number."""
CANCEL = {"axis": "halt", "spindle": "stop", "channel": "reset"}


@dataclass(frozen=True, slots=True)
class Answer:
    """A command was carried out; it acts at `cycle`. `warning`: what the unit says to it, "" nothing."""

    cycle: int
    warning: str = ""


class Job:
    """A motion or program of a unit, from the command that has begun it to its end."""

    def __init__(self, session: Session, unit: str, command: str, arguments: Mapping[str, Any], reply: Reply) -> None:
        self._session = session
        self.unit = unit
        self.command = command
        self.arguments = arguments
        self.number = reply.job
        """As in the blocks of the unit; 0: there was nothing to do."""
        self.cycle = reply.cycle
        """At which it acts."""
        self.warning = reply.message
        """What the unit says to its command, "" nothing."""

    @property
    def status(self) -> JobStatus | None:
        """ACTIVE, DONE (in full), ABORTED (another job, or a loss of power, has ended it) or FAILED.

        None before it has begun: with the next block, or when its turn comes.
        """
        if not self.number:
            return JobStatus.DONE
        event = self._session.link.seen.job_event(self.unit, self.number)
        return None if event is None else JobStatus(event.status)

    @property
    def done(self) -> bool:
        """It was finished in full."""
        return self.status is JobStatus.DONE

    @property
    def ended(self) -> bool:
        """It was finished, aborted, or has failed."""
        return self.status in (JobStatus.DONE, JobStatus.ABORTED, JobStatus.FAILED)

    @property
    def reached(self) -> bool:
        """An endless job does what was commanded: the speed is reached, the axis follows its master."""
        goal = GOALS.get((self._session.link.kinds[self.unit], self.command))
        block = self._session.link.seen.blocks.get(self.unit)
        is_active = self.status is JobStatus.ACTIVE and getattr(block, "job", 0) == self.number
        return goal is not None and is_active and goal(self._session.link.seen.blocks, self.unit, self.arguments)

    def wait(self: SelfJob, timeout: float | None = None) -> SelfJob:
        """Waits until it is done; an endless one (rotation, jog, coupling) until it has `reached` what was commanded.

        `timeout` in s: of machine time offline, of this computer's time in the graph. Raises the error of a unit that
        has failed, and CncError 26170 (timeout), 26171 (the machine is gone), 26172 (closed), 26173 (aborted), 26174
        (offline: nothing moves), 26175 (its end was not seen), 22001 (a timeout that is no number).
        """
        self._session.run(self._to_the_end(timeout))
        return self

    async def wait_async(self: SelfJob, timeout: float | None = None) -> SelfJob:
        """As `wait`, in an event loop; `await job` is the same without a timeout."""
        await self._session.run_async(self._to_the_end(timeout))
        return self

    def __await__(self: SelfJob) -> Generator[Any, None, SelfJob]:
        return self.wait_async().__await__()

    def cancel(self) -> Job:
        """Stops the unit on its ramp (halt, stop of a spindle, reset of a channel): the job of that."""
        command = CANCEL[self._session.link.kinds[self.unit]]
        return Job(self._session, self.unit, command, {}, self._session.ask(self.unit, command, {}))

    @property
    def _what(self) -> str:
        return f"{self._session.link.kinds[self.unit]} {self.unit}: {self.command}"

    def _to_the_end(self, timeout: float | None) -> Turns:
        check_seconds(f"{self._what}: wait", "timeout", timeout, IT_CONTINUES)
        seen = self._session.link.seen
        yield from self._session.until(self._is_over, timeout, f"{self._what} is not done")
        if self.status is JobStatus.FAILED:
            yield from self._failure()
        elif self.status is JobStatus.ABORTED:
            event = seen.job_event(self.unit, self.number)
            reason = f"{self._what} was aborted{f' at cycle {event.cycle}' if event else ''}"
            raise CncError(ABORTED, reason, "another command, or a loss of power, has ended it")
        elif not (self.done or self.reached):
            reason = f"{self._what} has ended in blocks that this client has not got"
            raise CncError(UNSEEN, reason, "how it has ended is not known")

    def _is_over(self) -> bool:
        """It has ended and everybody knows: the next command may be for a unit that would still take it for active."""
        seen = self._session.link.seen
        event = seen.job_event(self.unit, self.number)
        if self.ended:
            return event is None or seen.is_known_to_all(event.cycle)
        return self.reached or seen.ended_unseen(self.unit, self.number, self.cycle)

    def _failure(self) -> Turns:
        """Raises the error of the unit with its text, which may come after its number."""
        link = self._session.link
        event = link.seen.job_event(self.unit, self.number)
        number = event.error_id if event else 0
        begin = link.now
        while (fault := link.seen.fault(self.unit, number, self.cycle)) is None and link.now - begin < TEXT_TIMEOUT:
            yield TEXT_TIMEOUT
        if fault is None:
            raise error_of(number, f"{self._what} has failed", {})
        raise fault_of(fault)

    def __repr__(self) -> str:
        status = "not begun" if self.status is None else self.status.name.lower()
        return f"<job {self.number} of {self.unit}: {self.command}, {status}>"


class ProgramJob(Job):
    """A program of a channel, or its manual blocks."""

    @property
    def progress(self) -> float:
        """0 … 1, of its time."""
        return 1.0 if self.done else self._view.progress

    @property
    def time_left(self) -> float:
        """Seconds to its end at the present override; below 0 if that is not known."""
        return 0.0 if self.ended else self._view.time_left

    @property
    def line(self) -> int:
        """The active line."""
        return self._view.line

    @property
    def _view(self) -> UnitView:
        block = self._session.link.seen.blocks[self.unit]
        assert isinstance(block, ChannelBlock)
        return view_of(self.unit, "channel", block)
