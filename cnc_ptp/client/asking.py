"""How the methods of units give their commands."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from cnc_ptp.client.block_unit import BlockUnit
from cnc_ptp.client.job import Answer, Job, ProgramJob
from cnc_ptp.client.link import Reply
from cnc_ptp.errors import CncError
from cnc_ptp.machine.command_files import with_table
from cnc_ptp.plain_values import plain
from cnc_ptp.plc.setpoint_file import check_setpoints
from cnc_ptp.protocol.commands import (
    BAD_ARGUMENT,
    COMMANDS,
    FILE_CONTENTS,
    OF_CHANNELS,
    OF_PLC,
    check_arguments,
    check_command,
    check_sendable,
    with_floats,
)

Rows = Sequence[Any]
"""Points of a cam table or a trajectory, external setpoints; names and numbers of several axes."""
CONVERTED: Mapping[str, Callable[[Any], Any]] = {
    "table": lambda rows: [[*row] for row in rows],
    "setpoints": lambda rows: [[*row] for row in rows],
    **dict.fromkeys(("axes", "points", "path_tolerance", "goal_tolerance"), list),
    "files": dict,
    "program": lambda path: str(Path(path).absolute()),
}
"""Arguments of which a client takes more than commands do."""


class Asking(BlockUnit):
    """A unit that takes commands."""

    def _answer(self, command: str, **arguments: Any) -> Answer:
        reply, _ = self._asked(command, arguments)
        return Answer(reply.cycle, reply.message)

    def _job(self, command: str, **arguments: Any) -> Job:
        reply, given = self._asked(command, arguments)
        return Job(self._session, self.name, command, given, reply)

    def _program_job(self, command: str, **arguments: Any) -> ProgramJob:
        reply, given = self._asked(command, arguments)
        return ProgramJob(self._session, self.name, command, given, reply)

    def _asked(self, command: str, arguments: dict[str, Any]) -> tuple[Reply, dict[str, Any]]:
        """Reply and arguments. Raises as `_prepared`, and the refusal of the unit."""
        given = self._prepared(command, arguments)
        return self._session.ask(self.name, command, given), given

    def _prepared(self, command: str, arguments: dict[str, Any]) -> dict[str, Any]:
        """The arguments of a command without those that are left out (None).

        Raises CncError 22001 (arguments), 22002 (the unit has no such command), 26110, 25102, 25103 (files).
        """
        if command not in COMMANDS[self.kind]:
            check_command(self.kind, self.name, command, {})
        given = {name: plain(value) for name, value in arguments.items() if value is not None}
        for name in FILE_CONTENTS & COMMANDS[self.kind][command].keys():
            given = with_table(given, name)
        for name, value in given.items():
            if (convert := CONVERTED.get(name)) is not None:
                given[name] = convert(value)
        self._check(command, given)
        return with_floats(self.kind, command, given)

    def _check(self, command: str, given: dict[str, Any]) -> None:
        """What a service cannot carry is refused here, offline as in the graph. Raises CncError 22001."""
        where = f"{self.kind} {self.name}: {command} refused"
        known = {n: each for n, each in COMMANDS[self.kind][command].items() if n not in OF_PLC | OF_CHANNELS}
        check_arguments(where, known, given)
        check_sendable(where, known, given)
        if "setpoints" in given:
            check_setpoints(self.name, given["setpoints"])
        for number, row in enumerate(given.get("table", ()), 1):
            if len(row) != 2 or not all(isinstance(value, int | float) for value in row):
                reason = f"point {number} of the table, {row}, is no pair of numbers (master, slave)"
                raise CncError(BAD_ARGUMENT, reason, "nothing was sent", where=where)

    def __repr__(self) -> str:
        return f"<{self.kind} {self.name}>"
