"""What pages see of a machine, whether it runs or was recorded."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cnc_ptp.client.faults import unknown_unit
from cnc_ptp.client.link import Reply
from cnc_ptp.errors import CncError
from cnc_ptp.parameters import ParameterSet
from cnc_ptp.protocol.blocks import ChannelOffsets, CommandRecord, CycleBlock, Event, HandshakeRequest, Severity
from cnc_ptp.web.faces.program_watch import Load
from cnc_ptp.web.numbers import NO_SNAPSHOT

SOURCE = "web"
"""Of events that say who has done what."""
State = Mapping[str, Mapping[str, Any]]
"""Unit -> its fields, as protocol.py sends them."""


@dataclass(slots=True)
class News:
    """What has come since the last look."""

    events: Sequence[Event] = ()
    requests: Sequence[HandshakeRequest] = ()
    blocks: Sequence[tuple[str, CycleBlock]] = ()
    records: Sequence[CommandRecord] = ()
    diagnostics: Sequence[dict[str, Any]] = ()
    """Of nodes, newly told."""
    offsets: Sequence[tuple[str, ChannelOffsets]] = ()
    """Of channels; blocks have them, too, those that came here."""


@dataclass(slots=True)
class Past:
    """What a recording has from its begin up to the time of its page."""

    events: Sequence[Event]
    offsets: Sequence[tuple[str, ChannelOffsets]]
    """Of channels, in the order of their cycles."""
    diagnostics: Sequence[dict[str, Any]]
    """The last ones of each node."""


def nothing() -> None:
    """Nothing is required."""


class Face(ABC):
    """A machine as pages see it. All is called from the event loop, and returns at once, but for what is `async`."""

    kinds: Mapping[str, str]
    """Unit -> kind, in the order of the machine."""
    cycle_time: float
    """Seconds."""
    sets: Mapping[str, ParameterSet]
    """Parameters of the units, without the plc."""
    machine_set: ParameterSet
    """Those of the machine itself, which the plc has."""
    is_recording = False

    def require_kind(self, unit: str, kind: str) -> None:
        """Raises CncError 26111 where there is no such unit."""
        if self.kinds.get(unit) != kind:
            raise unknown_unit(unit, [name for name, other in self.kinds.items() if other == kind], kind)

    @abstractmethod
    def machine(self) -> dict[str, Any]:
        """Name, units and cycle times, as `hello` has them."""

    @property
    @abstractmethod
    def time(self) -> float:
        """Seconds of the machine."""

    @abstractmethod
    def state(self) -> State:
        """Of all units, now."""

    @abstractmethod
    def news(self) -> News:
        """What has come since the last call."""

    def past(self) -> Past | None:
        """All up to now, once after the page of a recording has begun to look at another time; `news` continues it."""
        return None

    @abstractmethod
    async def ask(
        self, unit: str, command: str, arguments: Mapping[str, Any], *, user: str, require: Callable[[], None] = nothing
    ) -> Reply:
        """Gives a command. `require` is called when it is its turn, and raises why it is not sent then.

        Raises the refusal of the unit, and CncError 22001, 22002, 26111, 26136, 26171, 26218, 26261.
        """

    async def snapshot(self, file: str, seconds: float, until: float) -> int:
        """The recorder writes seconds up to a time of the machine into a file; the first cycle that it has.

        0 seconds: all that is kept. `until` 0: now.

        Raises its refusal, CncError 26136, 26258.
        """
        effect = "nothing was written; run with --keep SECONDS"
        raise CncError(NO_SNAPSHOT, "snapshot: there is no recorder", effect)

    @abstractmethod
    def jog(self, axis: str, velocity: float, *, user: str) -> None:
        """One message of a jog (mm/s, deg/s; 0 ends it); the axis stops 0.2 s after the last one.

        Raises CncError 26218 where the machine file closes the axis to pages, services or topics.
        """

    def loads(self) -> Mapping[str, Load]:
        """Channel -> the program that it has, of a recording; a machine that runs tells it by its records."""
        return {}

    def last_loads(self) -> Mapping[str, Load]:
        """As `loads`, at the end of a recording."""
        return {}

    def for_page(self) -> Face:
        """The face of one page: a recording has another time on each."""
        return self

    def note(self, cycle: int, text: str) -> None:
        """An event for recordings: who has done what."""
        self.publish(Event(cycle, SOURCE, Severity.INFO, 0, text))

    @abstractmethod
    def publish(self, event: Event) -> None:
        """An event of this server, for recordings and other servers."""

    @abstractmethod
    async def run(self) -> None:
        """Keeps the face going until the machine is gone. Raises CncError 26171 then."""

    @abstractmethod
    def close(self) -> None:
        """The end; may take a while."""
