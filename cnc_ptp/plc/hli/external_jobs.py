"""Motions that a PLC has begun by external commands of the HLI: they end with it, and anybody may stop them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, Command, SpindleBlock
from cnc_ptp.protocol.jobs import JobStatus

HALT = {"axis": "halt", "spindle": "stop"}
"""What ends a motion on its ramp, by kind of unit."""


SUPERIMPOSED = "move_superimposed"


class ExternalJobs:
    """Jobs of one axis or spindle that PLCs have begun, by their numbers, until they have ended."""

    def __init__(self, name: str, kind: str) -> None:
        self._name = name
        self._halt = HALT.get(kind, "")
        self._running: set[int] = set()
        self._abandoned: set[int] = set()
        """Those whose PLC is gone: each is halted when it is active."""
        self._next_is_abandoned = False
        self._superimposed: set[int] = set()
        """Those that are active beside another one."""
        self._commands: list[Command] = []

    @property
    def active(self) -> bool:
        """A job of a PLC that is there has not ended, or waits for its turn."""
        return bool(self._running)

    def begin(self, job: int, command: str) -> None:
        """An external command was answered; 0: it is no job, or was refused. A coupling outlives its PLC."""
        if job and command == SUPERIMPOSED:
            self._superimposed.add(job)
        if job and command != "couple":
            (self._abandoned if self._next_is_abandoned else self._running).add(job)
        self._next_is_abandoned = False

    def abandon(self, *, unanswered: bool) -> None:
        """The PLC is gone. `unanswered`: the number of a job that it has commanded is still to come."""
        self._abandoned |= self._running
        self._running.clear()
        self._next_is_abandoned = unanswered

    def stop(self, command: str, arguments: dict[str, Any]) -> None:
        """Somebody stops the unit."""
        self._commands.append(Command(self._name, command, arguments))

    def read(self, block: AxisBlock | SpindleBlock | ChannelBlock) -> None:
        """What has become of the jobs; an abandoned one that is active is halted, once."""
        for event in block.job_events:
            if event.status != JobStatus.ACTIVE:
                self._running.discard(event.job)
                self._abandoned.discard(event.job)
                self._superimposed.discard(event.job)
        if block.job in self._abandoned:
            self._abandoned.discard(block.job)
            self._commands.append(Command(self._name, self._halt, {}))
        if beside := self._abandoned & self._superimposed:
            self._abandoned -= beside
            self._commands.append(Command(self._name, "halt_superimposed", {}))

    def commands(self) -> Iterator[Command]:
        """For the next block."""
        commands, self._commands = self._commands, []
        yield from commands
