"""What the node of a unit publishes of its work: blocks, records, events, states, checkpoints, diagnostics."""

from __future__ import annotations

from typing import Any

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from rclpy.publisher import Publisher

from cnc_ptp import msg
from cnc_ptp.errors import CncError
from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.nodes import convert
from cnc_ptp.nodes.events import EventPublisher
from cnc_ptp.nodes.handover import Handover
from cnc_ptp.nodes.topics import (
    BLOCK_TYPES,
    BLOCKS,
    COMMAND,
    DIAGNOSTICS,
    EVENTS,
    LATENESS,
    PLC_INPUT,
    REMEMBERED_BLOCKS,
    REPORT,
    STATE_TYPES,
    block_topic,
)
from cnc_ptp.nodes.unit.checkpoints import UnitCheckpoints
from cnc_ptp.nodes.unit.diagnostics import UnitDiagnostics
from cnc_ptp.nodes.unit.live_state import LiveState
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.blocks import CommandRecord, CycleBlock, Event, PlcBlock, Severity
from cnc_ptp.protocol.unit import Unit
from cnc_ptp.wire.block_codec import encode_block
from cnc_ptp.wire.stamps import Stamps

WITHOUT_STATES = (
    "no state was stored, a replay begins at an older checkpoint, or cnc_ptp replay --checkpoints makes them"
)


class UnitPublications:
    """The publishers of a unit's node."""

    def __init__(
        self,
        node: Node,
        machine: MachineParameters,
        unit: Unit,
        stamps: Stamps,
        *,
        state_period: int,
        checkpoint_seconds: float,
        handover: Handover | None,
    ) -> None:
        """`stamps` of the run, as it is known. `state_period`: cycles from one live state to the next, 0 = none.

        `checkpoint_seconds` of machine time, 0 = none. `handover`: to the other nodes of this process.
        """
        self._unit = unit
        self._stamps = stamps
        self._handover = handover
        self._has_told_state = False
        kind = unit.kind
        quality = REMEMBERED_BLOCKS if kind in ("axis", "spindle") else BLOCKS
        self.blocks: Publisher[Any] = node.create_publisher(BLOCK_TYPES[kind], block_topic(unit.name), quality)
        self._events = EventPublisher(node)
        self._records = node.create_publisher(msg.CommandRecord, COMMAND, EVENTS)
        self._reports = node.create_publisher(msg.BlockReport, REPORT, BLOCKS)
        self._diagnostics = node.create_publisher(DiagnosticArray, DIAGNOSTICS, PLC_INPUT)
        self._lateness = node.create_publisher(msg.LatenessHistogram, LATENESS, PLC_INPUT)
        self._live_state: LiveState | None = None
        if state_period and kind in STATE_TYPES:
            self._live_state = LiveState(node, unit.name, kind, state_period)
        self._checkpoints: UnitCheckpoints | None = None
        if checkpoint_seconds > 0.0:
            self._checkpoints = UnitCheckpoints(node, machine, checkpoint_seconds)

    def stamp(self, cycle: int) -> Time:
        return convert.time_message(self._stamps.at(cycle))

    def ready(self) -> None:
        """To the clock."""
        if self._handover is not None:
            self._handover.ready.add(self._unit.name)
        else:
            self._reports.publish(msg.BlockReport(source=self._unit.name, first_cycle=-1))

    def block(self, block: CycleBlock) -> None:
        if self._handover is None or self.blocks.get_subscription_count():
            self.blocks.publish(encode_block(block, self._stamps))
        if self._handover is not None:
            self._handover.block(self._unit.name, block)

    def record(self, record: CommandRecord) -> None:
        self._records.publish(convert.record_to_message(record, self.stamp(record.cycle)))

    def event(self, event: Event) -> None:
        self._events.publish(convert.event_to_message(event, self.stamp(event.cycle)))

    def pass_on(self, event: msg.Event) -> None:
        """A numbered information of a process that may end before others ask for it; alarms are not made for others."""
        if event.severity == msg.Event.INFO and event.error_id:
            self._events.publish(event)

    def tell(self, cycle: int, severity: int, error_id: int, text: str) -> None:
        """An event of the node, not of its unit."""
        self.event(Event(cycle, self._unit.name, severity, error_id, text))

    def live_state(self, block: CycleBlock) -> None:
        if self._live_state is not None and not isinstance(block, PlcBlock):
            self._live_state.publish(block, self._stamps)

    def checkpoint(self, runner: UnitRunner, block: CycleBlock) -> None:
        """If it is time. An event for the first one that cannot be stored; later ones may be of another program."""
        if self._checkpoints is None or not self._checkpoints.is_due(runner.next_cycle):
            return
        try:
            self._checkpoints.publish(runner, block, self._stamps)
        except CncError as error:
            if not self._has_told_state:
                self._has_told_state = True
                text = f"{self._unit.name}: {error.reason}; {WITHOUT_STATES}"
                self.tell(runner.next_cycle, Severity.INFO, error.number, text)

    def diagnostics(self, diagnostics: UnitDiagnostics, *, came_twice: int, next_cycle: int) -> None:
        """`came_twice`: ticks and blocks that did so."""
        message = DiagnosticArray(status=[diagnostics.status(came_twice)])
        message.header.stamp = self.stamp(next_cycle)
        self._diagnostics.publish(message)
        if diagnostics.lateness.counts:
            lateness = diagnostics.lateness.message(self._unit.name)
            lateness.header.stamp = message.header.stamp
            self._lateness.publish(lateness)
