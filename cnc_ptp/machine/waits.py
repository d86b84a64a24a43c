"""What a path waits for: reports of spindles and acknowledgements of the PLC, filed under the moment of waiting.

Source: TF5200 spindle 2.5.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

from cnc_ptp.errors import CncError
from cnc_ptp.machine.blocks import Block, Command, HandshakeRequest, SpindleBlock
from cnc_ptp.parameters import Synchronisation

NOT_COUPLED = 22019

T = Synchronisation
AFTER_MOTION = T.MNS_SNS
"""Goes out after the motion."""
ON_EVENT = T.MNE_SNS
"""Goes out with the measuring event."""
WAIT_BEFORE = T.MVS_SVS
WAIT_AFTER = T.MVS_SNS | T.MNS_SNS | T.MNE_SNS
WAIT_MACHINING = T.MVS_SLM
WAIT_EXPLICIT = T.MVS_SLP
WAITING = WAIT_BEFORE | WAIT_AFTER | WAIT_MACHINING | WAIT_EXPLICIT
OUTPUT = WAITING | T.MOS
"""Types that go out to the PLC."""


class Condition(Enum):
    """What a spindle has to report."""

    NONE = ""
    SPEED = "the speed of spindle {spindle}"
    STANDSTILL = "the standstill of spindle {spindle}"
    POSITION = "the position of spindle {spindle}"
    GEAR = "gear {value} of spindle {spindle}"
    MASTER = "the coupling of spindle {spindle} to {value}"
    ALONE = "the end of the coupling of spindle {spindle}"


@dataclass(slots=True)
class Wait:
    """Something the path waits for: a report of a spindle and, or, the acknowledgement of request `request_id`.

    `value`: the gear stage of GEAR, the node of the master of MASTER.
    """

    spindle: str = ""
    condition: Condition = Condition.NONE
    value: int | str = 0
    request_id: int = 0
    sent_cycle: int | None = None
    """First cycle of the block in which the function went out; what was reported for earlier cycles does not count."""

    def fulfilled(self, cycle: int, spindles: Mapping[str, Block], open_requests: set[int]) -> bool:
        """Raises CncError 22019 for a coupling that did not come about."""
        if self.sent_cycle is None or cycle <= self.sent_cycle or self.request_id in open_requests:
            return False
        if self.condition is Condition.NONE:
            return True
        block = spindles.get(self.spindle)
        return isinstance(block, SpindleBlock) and self._reported(block)

    def _reported(self, block: SpindleBlock) -> bool:
        match self.condition:
            case Condition.SPEED:
                return bool(block.speed_reached[-1])
            case Condition.STANDSTILL:
                return bool(block.speed_zero[-1])
            case Condition.POSITION:
                return bool(block.in_position[-1])
            case Condition.GEAR:
                return block.gear[-1] == self.value and not block.gear_change_active[-1]
            case Condition.ALONE:
                return not block.master
        if block.master != self.value and not block.master_wanted:
            raise CncError(NOT_COUPLED, f"spindle {self.spindle} was not coupled to {self.value}")
        return block.master == self.value

    def text(self, open_requests: set[int]) -> str:
        """What is waited for; empty before the function has gone out."""
        if self.sent_cycle is None:
            return ""
        if self.request_id in open_requests:
            return f"the acknowledgement of request {self.request_id}"
        return self.condition.value.format(spindle=self.spindle, value=self.value)


@dataclass(slots=True)
class Outputs:
    """What is to go out at one moment of a block, and the waits that belong to it.

    waits_machining   for the next G01, G02, G03 (MVS_SLM)
    waits_explicit    for the next #EXPL SYN (MVS_SLP)
    """

    commands: list[Command] = field(default_factory=list)
    requests: list[HandshakeRequest] = field(default_factory=list)
    waits_before: list[Wait] = field(default_factory=list)
    waits_after: list[Wait] = field(default_factory=list)
    waits_machining: list[Wait] = field(default_factory=list)
    waits_explicit: list[Wait] = field(default_factory=list)

    def add_wait(self, synchronisation: Synchronisation, wait: Wait) -> None:
        """Files a wait under the moment at which its synchronisation type makes the path wait."""
        if synchronisation & WAIT_BEFORE:
            self.waits_before.append(wait)
        elif synchronisation & WAIT_AFTER:
            self.waits_after.append(wait)
        elif synchronisation & WAIT_MACHINING:
            self.waits_machining.append(wait)
        elif synchronisation & WAIT_EXPLICIT:
            self.waits_explicit.append(wait)

    @property
    def waits(self) -> list[Wait]:
        """All of them."""
        return self.waits_before + self.waits_after + self.waits_machining + self.waits_explicit
