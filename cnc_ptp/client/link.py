"""The link of a client to its machine: commands to it, what comes of it, time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from contextlib import AbstractContextManager
from typing import Any, NamedTuple

from cnc_ptp.client.observations import Observations
from cnc_ptp.errors import Value
from cnc_ptp.interrupt import HeldSignals
from cnc_ptp.parameters import ParameterSet
from cnc_ptp.protocol.blocks import CommandRecord


class Reply(NamedTuple):
    """What a unit answers to a command; `error_id` 0: it was carried out, and `message` may hold a warning."""

    cycle: int
    error_id: int
    message: str
    values: Mapping[str, Value]
    job: int


def reply_of(record: CommandRecord) -> Reply:
    return Reply(record.cycle, record.error_id, record.message, record.values, record.job)


class Link(ABC):
    """What an offline machine and one of the graph have in common."""

    seen: Observations
    kinds: Mapping[str, str]
    """Unit -> kind, in the order of the machine."""
    cycle_time: float
    """Seconds."""
    clock: str
    """Whose seconds a timeout counts."""
    has_recorder: bool = True
    """False: it is known to have none."""

    @property
    @abstractmethod
    def now(self) -> float:
        """Seconds of that clock."""

    @property
    def stalled(self) -> str | None:
        """Where only this client could move the machine and nothing has moved for long: why; else None."""
        return None

    @abstractmethod
    def give(self, unit: str, command: str, arguments: Mapping[str, Any]) -> int:
        """Sends a command; the number of its ticket."""

    @abstractmethod
    def give_recorder(self, command: str, arguments: Mapping[str, Any]) -> int:
        """The same to the recorder: start, stop or snapshot."""

    @abstractmethod
    def answer(self, ticket: int) -> Reply | None:
        """The answer, once; None while it has not come. Raises CncError when none will."""

    @abstractmethod
    def parameters_of(self, unit: str) -> ParameterSet:
        """As the machine file has them. Raises CncError 26136."""

    def hold(self) -> None:  # noqa: B027  # offline nothing comes between two turns
        """What comes is not seen before `release` or the next turn: all function blocks of a PLC cycle see the same."""

    def release(self) -> None:  # noqa: B027
        """What has come since `hold` is seen."""

    @abstractmethod
    def turn(self, timeout: float) -> None:
        """Lets something come, at most for `timeout` seconds of the clock. Raises CncError 26171."""

    @abstractmethod
    async def turn_async(self, timeout: float) -> None:
        """As `turn`, while others of the event loop run."""

    @abstractmethod
    def waiting(self) -> AbstractContextManager[HeldSignals | None]:
        """Around the turns of a wait."""

    @abstractmethod
    def close(self) -> None:
        """The end; nothing else is called after it."""
