"""What a path waits for: reports of spindles and acknowledgements of the PLC, filed under the moment of waiting.

Source: TF5200 spindle 2.5.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from cnc_ptp.channel.spindle_reports import (
    Condition,
    carries_out,
    is_there,
    must_wait,
    turns,
    what_it_does,
    what_it_was_told,
)
from cnc_ptp.errors import CncError
from cnc_ptp.parameters import Synchronisation
from cnc_ptp.protocol.blocks import Block, Command, HandshakeRequest, SpindleBlock
from cnc_ptp.protocol.spindle_states import held_by_override

NOT_COUPLED = 22019
NOT_CARRIED_OUT = 22021

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


@dataclass(slots=True)
class Wait:
    """Something the path waits for: a report of a spindle and, or, the acknowledgement of request `request_id`.

    `value`: speed in rpm (+ = M03), position in ° modulo `turn`, or gear stage; `master`: its node.
    """

    spindle: str = ""
    condition: Condition = Condition.NONE
    value: float = 0.0
    turn: float = 360.0
    master: str = ""
    request_id: int = 0
    sent_cycle: int | None = None
    """First cycle of the block in which the function went out; what was reported for earlier cycles does not count."""
    until_sent: bool = False
    """Axes take the function over at that cycle; nobody has to report anything."""

    def fulfilled(self, cycle: int, spindles: Mapping[str, Block], open_requests: set[int]) -> bool:
        """Raises CncError: 22019 for a coupling that did not come about, 22021 for a spindle that does something else.

        A spindle that does something else is found out while the PLC has not acknowledged, too.
        """
        if self.until_sent:
            return self.sent_cycle is not None
        if not self.sent_before(cycle):
            return False
        acknowledged = self.request_id not in open_requests
        if self.condition is Condition.NONE:
            return acknowledged
        block = spindles.get(self.spindle)
        return isinstance(block, SpindleBlock) and self._reported(block) and acknowledged

    def sent_before(self, cycle: int) -> bool:
        """The spindle has reported since then."""
        return self.sent_cycle is not None and cycle > self.sent_cycle

    def _reported(self, block: SpindleBlock) -> bool:
        if self.condition is Condition.MASTER:
            return self._coupled(block)
        if not carries_out(block, self.condition, self.value, self.turn):
            if must_wait(block):
                return False
            told = what_it_was_told(self.spindle, self.condition, self.value)
            raise CncError(NOT_CARRIED_OUT, f"{told}, {what_it_does(block)}; the path waited for it")
        return is_there(block, self.condition)

    def _coupled(self, block: SpindleBlock) -> bool:
        if block.master != self.master and not block.master_wanted:
            raise CncError(NOT_COUPLED, f"spindle {self.spindle} was not coupled to {self.master}")
        return block.master == self.master

    def renew(self, newer: Wait, *, waits_too: bool) -> None:
        """The spindle was told something else: a new speed is what the path waits for now, all else makes the report
        of the older function meaningless. Before a gear change: what comes after it decides about the speed.
        """
        if self.condition is Condition.SPEED and newer.condition is Condition.GEAR:
            return
        if self.condition is newer.condition is Condition.SPEED and not waits_too:
            self.value, self.sent_cycle = newer.value, None
        else:
            self.condition = Condition.NONE

    def text(self, open_requests: set[int]) -> str:
        """What is waited for; empty before the function has gone out."""
        if self.sent_cycle is None:
            return ""
        if self.request_id in open_requests:
            return f"the acknowledgement of request {self.request_id}"
        return self._report()

    def held(self, cycle: int, spindles: Mapping[str, Block]) -> str:
        """What does not come because override 0 holds the spindle, if so."""
        block = spindles.get(self.spindle)
        waits = self.sent_before(cycle) and self.condition is not Condition.MASTER
        held = waits and isinstance(block, SpindleBlock) and not block.gear_request and held_by_override(block)
        return self._report() if held else ""

    def _report(self) -> str:
        return self.condition.value.format(spindle=self.spindle, value=self.master or self.value)


class StoredSpeed(NamedTuple):
    """An S word for a spindle (node) that the channel has not set turning.

    `master`: node of its master if that one turns.
    """

    spindle: str
    speed_rpm: float
    master: str

    def note(self, spindles: Mapping[str, Block]) -> str:
        """What people should hear of it; empty where the next M03 or M04 is simply to come."""
        words = f"S{self.speed_rpm:g} is without effect on spindle {self.spindle}"
        block = spindles.get(self.spindle)
        if self.master:
            return f"{words}, which stands; M03 or M04 of its master {self.master} sets it turning"
        if isinstance(block, SpindleBlock) and turns(block):
            return f"{words}, which this channel has not set turning; it counts for its next M03 or M04"
        return ""


@dataclass(slots=True)
class Outputs:
    """What is to go out at one moment of a block, and the waits that belong to it.

    waits_motion      for the next motion (feedforward and compensations of axes)
    waits_machining   for the next G01, G02, G03 (MVS_SLM)
    waits_explicit    for the next #EXPL SYN (MVS_SLP)
    told              what the spindles are to report, whether the path waits for it or not
    notes             number and text of warnings
    stored            speeds that command nothing now
    """

    commands: list[Command] = field(default_factory=list)
    requests: list[HandshakeRequest] = field(default_factory=list)
    waits_before: list[Wait] = field(default_factory=list)
    waits_after: list[Wait] = field(default_factory=list)
    waits_motion: list[Wait] = field(default_factory=list)
    waits_machining: list[Wait] = field(default_factory=list)
    waits_explicit: list[Wait] = field(default_factory=list)
    told: list[Wait] = field(default_factory=list)
    stored: list[StoredSpeed] = field(default_factory=list)
    notes: list[tuple[int, str]] = field(default_factory=list)

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
        return self.waits_before + self.waits_after + self.waits_motion + self.waits_machining + self.waits_explicit
