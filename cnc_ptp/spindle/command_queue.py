"""Commands of a spindle in order of arrival, for one source at a time, with acknowledgements to the PLC.

A channel gives its name as `source`, the PLC's external commanding "plc"; commands of users and scenarios have none.
A homing is finished first: the state graphs lead from it to a rotation through standstill only.
Source: TF5200 spindle 2.1 (several channels), 2.2.1.1 (sequential in order of arrival, acknowledgements), 2.3, 2.7.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any, NamedTuple

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.spindle.faults import AT_WORK, SLAVE_LOCKED
from cnc_ptp.spindle.spindle import Spindle

MOTION = frozenset({"start", "set_speed", "stop", "orient", "home", "select_gear"})
"""Commands that make the spindle work for their source."""
AWAITED = {
    S.HOMING: "the homing is finished",
    S.DISCRETE_MOTION: "the positioning is finished",
    S.CONTINUOUS_MOTION: "the speed is reached",
}


class QueuedCommand(NamedTuple):
    """A command that waits for its turn."""

    name: str
    arguments: Mapping[str, Any]
    source: str
    number: int = 0
    """Identifies the command when its outcome is queried."""
    job: int = 0
    """Number of its job (protocol/jobs.py), 0 if it is none."""
    master_source: str | None = None
    """Of a slave: who has commanded its master, empty for users. None for a command to the spindle itself."""

    @property
    def commander(self) -> str:
        """Who has commanded the spindle, directly or through its master; empty for users."""
        return self.source if self.master_source is None else self.master_source


class CommandQueue:
    """Commands that wait, and the source for which the spindle works."""

    def __init__(self, spindle: Spindle) -> None:
        self._spindle = spindle
        spindle.when_faulted = self.clear
        self.waiting: deque[QueuedCommand] = deque()
        self.source = ""
        """The source for which the spindle works, until its speed, position, reference or gear is reached."""
        self.commander = ""
        """Who has commanded the spindle last, directly or through its master; empty for users."""
        self.obeys_master = False
        """The active command was given to the master of the spindle."""
        self.taken = 0
        """Number of commands of the PLC so far."""

    @property
    def acknowledged(self) -> int:
        """Number of commands of the PLC that are finished, or aborted by a stop, a reset or an error."""
        pending = sum(command.source == PLC for command in self.waiting)
        return self.taken - pending - (self.source == PLC)

    def check(self, command: str, source: str, master: str) -> None:
        """Raises 24012 while the spindle works for another source, 24022 for a slave.

        Commands of the PLC wait for their turn, except a stop; nor does a stop wait of the source whose rotation a gear
        change has interrupted.
        """
        if master and command != "stop":
            reason = f"the spindle is a slave of {master}; command {master} or decouple the spindle"
            self._spindle.refuse(command, SLAVE_LOCKED, reason, master=master)
        stops_its_own = command == "stop" and source == self.commander
        if source and source != PLC and self.source and source != self.source and not stops_its_own:
            reason = f"the spindle works for '{self.source}', '{source}' must wait until that is finished"
            self._spindle.refuse(command, AT_WORK, reason, owner=self.source, source=source)

    def must_wait(self, command: str, source: str) -> bool:
        """True if something must finish first; commands of the PLC wait for all that is active, a stop never waits."""
        if command == "stop":
            return False
        if self._finished_before(command) or (self.waiting and source != PLC and self.waiting[0].source != PLC):
            return True
        return source == PLC and bool(self.waiting or self.source)

    def awaited(self) -> str:
        """What a command that is added now waits for."""
        if self.waiting:
            return "the commands before it are carried out"
        if self._spindle.work.changes_gear:
            return "the gear change is finished"
        return AWAITED.get(self._spindle.state, "the spindle is at a standstill")

    def _finished_before(self, command: str) -> bool:
        """A gear change precedes all commands, a homing all that move the spindle, a positioning a homing."""
        state = self._spindle.state
        if self._spindle.work.changes_gear:
            return True
        return (state == S.HOMING and command != "set_speed") or (state == S.DISCRETE_MOTION and command == "home")

    def add(self, command: QueuedCommand) -> None:
        self.waiting.append(command)
        self._spindle.unsettled = True

    def begin(self, source: str) -> None:
        """The spindle works for `source` from now on; a rotation after a gear change keeps its commander."""
        procedure = self._spindle.work.procedure
        self.source = source
        if procedure is None or not procedure.resume:
            self.commander, self.obeys_master = source, False
        self._spindle.unsettled = True

    def next(self) -> QueuedCommand | None:
        """The command whose turn it is."""
        if not self.waiting or self._finished_before(self.waiting[0].name):
            return None
        source = self.waiting[0].source
        if self.source and source and (source == PLC or source != self.source):
            return None
        return self.waiting.popleft()

    def forget(self, source: str) -> None:
        """Drops waiting commands of `source`, given directly or through the master."""
        self.waiting = deque(command for command in self.waiting if command.commander != source)

    def obey(self, command: QueuedCommand) -> None:
        """True while the spindle carries out a command of its master."""
        self.commander, self.obeys_master = command.commander, True

    def forget_master(self) -> None:
        """Drops waiting commands that came through the master."""
        self.waiting = deque(command for command in self.waiting if command.master_source is None)

    def leave_master(self, owner: str) -> None:
        """The coupling has ended: whoever has coupled is responsible for a motion that came through the master."""
        self.forget_master()
        if self.obeys_master:
            self.commander, self.obeys_master = owner, False

    def clear(self) -> None:
        """A stop, a reset or an error: drops all waiting commands."""
        self.waiting.clear()
        self.source = ""

    def watch(self) -> None:
        """Ends the work for a source when it is finished."""
        spindle = self._spindle
        if not self.source or spindle.work.procedure is not None:
            return
        turns_as_commanded = spindle.state == S.CONTINUOUS_MOTION and spindle.speed_was_reached
        if turns_as_commanded or spindle.state in (S.STANDSTILL, S.DISABLED):
            self.source = ""
