"""A unit of a client as function blocks see it: commands are given without waiting, and nothing raises."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, TypeVar

from cnc_ptp.client.faults import UNSEEN
from cnc_ptp.client.session import Session
from cnc_ptp.errors import CncError
from cnc_ptp.parameters.declare.declarations import ParameterValue
from cnc_ptp.parameters.view.by_name import parameter_by_name
from cnc_ptp.protocol.blocks import CommandAnswer, CycleBlock
from cnc_ptp.protocol.jobs import JobStatus

KEPT = 1000
"""Answers and jobs that are remembered, the newest ones."""
T = TypeVar("T")


class BlockUnit(ABC):
    """What plc/plcopen UnitReference asks for: `MC_MoveAbsolute(m.x)`."""

    def __init__(self, session: Session, name: str) -> None:
        self._session = session
        self.name = name
        """As in the machine file."""
        self.kind = session.link.kinds[name]
        """axis, spindle, channel or plc."""
        self.stops = 0
        """Number of MC_Stop of this program that hold it."""
        self._tickets = 0
        self._waiting: dict[int, int] = {}
        """Own ticket -> that of the link, until the answer is here."""
        self._answers: dict[int, CommandAnswer] = {}
        self._begun: dict[int, int] = {}
        """Job -> cycle of its command."""

    @abstractmethod
    def _prepared(self, command: str, arguments: dict[str, Any]) -> dict[str, Any]:
        """The arguments as they are sent. Raises CncError for those that cannot be."""

    def give(self, command: str, **arguments: Any) -> int:
        """Gives a command for the next block; the ticket for its answer. Raises CncError 26172 after the end."""
        self._session.require_open(f"{self.kind} {self.name}: {command}")
        self._tickets += 1
        try:
            given = self._prepared(command, arguments)
            self._waiting[self._tickets] = self._session.link.give(self.name, command, given)
        except CncError as error:
            keep(self._answers, self._tickets, CommandAnswer(0, error.number, 0, error.message))
        return self._tickets

    def answer(self, ticket: int) -> CommandAnswer | None:
        """What became of a command; None while there is no answer."""
        if ticket in self._waiting:
            answer = self._answer_of(self._waiting[ticket])
            if answer is None:
                return None
            del self._waiting[ticket]
            keep(self._answers, ticket, answer)
        return self._answers.get(ticket)

    def _answer_of(self, ticket: int) -> CommandAnswer | None:
        try:
            reply = self._session.link.answer(ticket)
        except CncError as error:
            return CommandAnswer(0, error.number, 0, error.message)
        if reply is None:
            return None
        if reply.job:
            keep(self._begun, reply.job, reply.cycle)
        return CommandAnswer(0, reply.error_id, reply.job, reply.message)

    @property
    def block(self) -> CycleBlock | None:
        """Its newest block."""
        return self._session.link.seen.blocks.get(self.name)

    def job_status(self, job: int) -> JobStatus | None:
        """What became of a job; None while it waits for its turn."""
        if self._ended_unseen(job):
            return JobStatus.FAILED
        event = self._session.link.seen.job_event(self.name, job)
        return None if event is None else JobStatus(event.status)

    def job_error(self, job: int) -> int:
        """Error number of a job that has failed; 26175: its end was not seen."""
        event = self._session.link.seen.job_event(self.name, job)
        return UNSEEN if self._ended_unseen(job) else 0 if event is None else event.error_id

    def _ended_unseen(self, job: int) -> bool:
        return self._session.link.seen.ended_unseen(self.name, job, self._begun.get(job, 0))

    def parameter(self, name: str) -> ParameterValue:
        """Value in the unit of its list, by P number or name. Raises CncError 22169, 26136."""
        link = self._session.link
        own = link.parameters_of(self.name)
        found, written = parameter_by_name(own, name), link.seen.written(self.name)
        newer = [value for given, value in written.items() if parameter_by_name(own, given).ros_name == found.ros_name]
        return newer[-1] if newer else found.value


def keep(notes: dict[int, T], number: int, value: T) -> None:
    notes[number] = value
    if len(notes) > KEPT:
        del notes[next(iter(notes))]
