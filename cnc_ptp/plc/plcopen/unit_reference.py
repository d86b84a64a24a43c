"""What a function block knows of its unit: it gives commands and reads what has become of them."""

from __future__ import annotations

from typing import Any, Protocol

from cnc_ptp.errors import CncError
from cnc_ptp.parameters.declare.declarations import ParameterValue
from cnc_ptp.protocol.blocks import CommandAnswer, CycleBlock
from cnc_ptp.protocol.commands import BAD_ARGUMENT
from cnc_ptp.protocol.jobs import JobStatus

KINDS = ("axis", "spindle", "channel")


class UnitReference(Protocol):
    """An axis, spindle or channel, in the PLC unit or in a client.

    Commands act with the next cycle block; answers and jobs are those of the newest one.
    """

    stops: int
    """Number of MC_Stop that hold the unit; other blocks do not move it then."""

    @property
    def name(self) -> str: ...

    @property
    def kind(self) -> str:
        """axis, spindle or channel."""

    @property
    def block(self) -> CycleBlock | None:
        """Its newest block, None before the first one."""

    def give(self, command: str, **arguments: Any) -> int:
        """Gives a command; the ticket for its answer."""

    def answer(self, ticket: int) -> CommandAnswer | None:
        """What became of a command; None while there is no answer."""

    def job_status(self, job: int) -> JobStatus | None:
        """What became of a job; None while it waits for its turn."""

    def job_error(self, job: int) -> int:
        """Error number of a job that has failed."""

    def parameter(self, name: str) -> ParameterValue:
        """Value of a parameter in the unit of its list, by P number or name. Raises CncError 22169."""


def unit_of(block: object, unit: UnitReference) -> UnitReference:
    """The unit that a function block gets. Raises CncError 22001 for anything else, such as the name of a unit."""
    if getattr(unit, "kind", "") in KINDS:
        return unit
    reason = f"unit = {unit!r} is no axis, spindle or channel of a machine"
    raise CncError(BAD_ARGUMENT, reason, "nothing was made", where=type(block).__name__)
