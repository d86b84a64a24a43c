"""Waits of a path and their moments: reports of spindles and acknowledgements of the PLC.

Source: TF5200 spindle 2.5 (synchronisation types).
"""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import dataclass, field
from enum import Enum

from cnc_ptp.channel.spindle_reports import (
    NOTHING,
    Condition,
    Expectation,
    current_activity,
    must_wait,
)
from cnc_ptp.errors import CncError
from cnc_ptp.parameters import Synchronisation
from cnc_ptp.protocol.blocks import Command, CycleBlock, HandshakeRequest, SpindleBlock
from cnc_ptp.protocol.spindle_states import held_by_override

NOT_COUPLED = 22019
NOT_CARRIED_OUT = 22021

T = Synchronisation
WAITING = T.MVS_SVS | T.MVS_SNS | T.MNS_SNS | T.MNE_SNS | T.MVS_SLM | T.MVS_SLP
"""Types for which the path waits, and the PLC has to acknowledge."""
OUTPUT = WAITING | T.MOS
"""Types of which the PLC is notified."""


class Moment(Enum):
    """A moment of an NC block at which functions go out, or at which the path waits for them."""

    BEFORE = "before the motion"
    EVENT = "with the measuring event"
    AFTER = "after the motion"
    NEXT_MOTION = "before the next motion"
    NEXT_CUT = "before the next G01, G02 or G03"
    EXPLICIT = "at the next #EXPL SYN"


WAIT_MOMENTS = (
    (T.MVS_SVS, Moment.BEFORE),
    (T.MVS_SNS | T.MNS_SNS | T.MNE_SNS, Moment.AFTER),
    (T.MVS_SLM, Moment.NEXT_CUT),
    (T.MVS_SLP, Moment.EXPLICIT),
)


def goes_out(synchronisation: Synchronisation) -> Moment:
    """When a function of this type goes out."""
    if synchronisation & T.MNS_SNS:
        return Moment.AFTER
    return Moment.EVENT if synchronisation & T.MNE_SNS else Moment.BEFORE


def waits_until(synchronisation: Synchronisation) -> Moment | None:
    """When the path waits for a function of this type; None is never."""
    return next((moment for types, moment in WAIT_MOMENTS if synchronisation & types), None)


@dataclass(slots=True)
class Wait:
    """A wait of the path at the moment `until`: a report of a spindle, the acknowledgement of a request."""

    until: Moment
    expected: Expectation = NOTHING
    request_id: int = 0
    sent_cycle: int | None = None
    """First cycle of the block in which the function went out; what was reported for earlier cycles does not count."""
    until_sent: bool = False
    """Axes take the function over at that cycle; no report is needed."""

    def fulfilled(self, cycle: int, spindles: Mapping[str, CycleBlock], open_requests: Container[int]) -> bool:
        """Raises CncError: 22019 for a coupling that was not made, 22021 for a spindle that does something else.

        A spindle that does something else is noticed also while the PLC has not acknowledged.
        """
        if self.until_sent:
            return self.sent_cycle is not None
        if not self._sent_before(cycle):
            return False
        acknowledged = self.request_id not in open_requests
        if self.expected.condition is Condition.NONE:
            return acknowledged
        block = spindles.get(self.expected.spindle)
        return isinstance(block, SpindleBlock) and self._reported(block) and acknowledged

    def _sent_before(self, cycle: int) -> bool:
        """The spindle has reported since then."""
        return self.sent_cycle is not None and cycle > self.sent_cycle

    def _reported(self, block: SpindleBlock) -> bool:
        expected = self.expected
        if expected.condition is Condition.MASTER:
            return self._coupled(block)
        if expected.carried_out(block):
            return expected.reached(block)
        if must_wait(block):
            return False
        raise CncError(NOT_CARRIED_OUT, f"{expected.missed()}, {current_activity(block)}; the path waited for it")

    def _coupled(self, block: SpindleBlock) -> bool:
        slave, master = self.expected.spindle, self.expected.master
        if block.master != master and not block.master_wanted:
            raise CncError(NOT_COUPLED, f"spindle {slave} was not coupled to {master}")
        return block.master == master

    def renew(self, newer: Expectation, *, waits_too: bool) -> None:
        """The spindle was commanded something else.

        The path now waits for a new speed; any other command makes the report of the older function meaningless.
        Before a gear change: the functions after it decide about the speed.
        """
        if not newer.spindle or self.expected.spindle != newer.spindle:
            return
        speed = self.expected.condition is Condition.SPEED
        if speed and newer.condition is Condition.GEAR:
            return
        if speed and newer.condition is Condition.SPEED and not waits_too:
            self.expected, self.sent_cycle = newer, None
        else:
            self.expected = Expectation(newer.spindle)

    def text(self, open_requests: Container[int]) -> str:
        """What is waited for; empty before the function has gone out."""
        if self.sent_cycle is None:
            return ""
        if self.request_id in open_requests:
            return f"the acknowledgement of request {self.request_id}"
        return self.expected.awaited()

    def held(self, cycle: int, spindles: Mapping[str, CycleBlock]) -> str:
        """The report that does not come because override 0 holds the spindle; empty otherwise."""
        block = spindles.get(self.expected.spindle)
        waits = self._sent_before(cycle) and self.expected.condition is not Condition.MASTER
        held = waits and isinstance(block, SpindleBlock) and not block.gear_request and held_by_override(block)
        return self.expected.awaited() if held else ""


@dataclass(slots=True)
class Outgoing:
    """The output of one moment of an NC block, and the waits that belong to it.

    expected    reports expected of the spindles, whether the path waits for them or not
    notes       number and text of warnings
    """

    commands: list[Command] = field(default_factory=list)
    requests: list[HandshakeRequest] = field(default_factory=list)
    waits: list[Wait] = field(default_factory=list)
    expected: list[Expectation] = field(default_factory=list)
    notes: list[tuple[int, str]] = field(default_factory=list)

    def add_wait(self, synchronisation: Synchronisation, expected: Expectation, request_id: int = 0) -> None:
        """A wait at the moment at which this synchronisation type makes the path wait, if it does."""
        until = waits_until(synchronisation)
        if until is not None:
            self.waits.append(Wait(until, expected, request_id))
