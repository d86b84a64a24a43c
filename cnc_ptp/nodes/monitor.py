"""What a run shows of itself: progress, events, statistics; collected from the topics of the graph."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node

from cnc_ptp import msg
from cnc_ptp.machine.blocks import Severity, command_note, event_note, keep_note
from cnc_ptp.machine.program_report import ProgramReport
from cnc_ptp.machine.wiring import PLC
from cnc_ptp.nodes.lateness import Lateness
from cnc_ptp.nodes.topics import BLOCKS, COMMAND, DIAGNOSTICS, EVENT, EVENTS, MONITOR, PLC_INPUT, REPORT, block_topic
from cnc_ptp.parameters import MachineParameters

READY_PERIOD = 0.05
SUPERVISOR = "supervisor"
"""Source of events about node processes, which the supervisor prints itself."""


@dataclass
class Progress:
    """Where the program of the first channel is."""

    line: int = 0
    block_number: int = 0
    blocks_done: int = 0
    blocks_total: int = 0
    feed_mm_per_min: float = 0.0
    position: dict[str, float] = field(default_factory=dict)
    cycle: int = 0


class RunMonitor(Node):
    """Subscriptions: /<channel>/block, /plc/block, /events, /commands, /diagnostics."""

    def __init__(self, machine: MachineParameters) -> None:
        super().__init__(MONITOR, enable_rosout=False, start_parameter_services=False)
        self.progress = Progress()
        self.programs = {channel: ProgramReport() for channel in machine.channels}
        self.errors: list[str] = []
        self.notes: list[str] = []
        self.run_done = False
        self._plc_block = 0
        self._plc_knows_failure = False
        self._last_fault = -1
        self.diagnostics: dict[str, dict[str, str]] = {}
        self.standing: dict[str, bool] = {}
        self._needed = []
        self._report_publisher = self.create_publisher(msg.BlockReport, REPORT, BLOCKS)
        self._ready_timer = self.create_timer(READY_PERIOD, self._report_ready)
        for number, (channel, program) in enumerate(self.programs.items()):
            received = program.add if number else partial(self._on_first_channel, program)
            self._need(msg.ChannelBlock, block_topic(channel), received)
        self._need(msg.PlcBlock, block_topic(PLC), self._on_plc)
        self.create_subscription(msg.Event, EVENT, self._on_event, EVENTS)
        self.create_subscription(msg.CommandRecord, COMMAND, self._on_command, EVENTS)
        self.create_subscription(DiagnosticArray, DIAGNOSTICS, self._on_diagnostics, PLC_INPUT)

    @property
    def run_failed(self) -> bool:
        """The PLC knows of a fault a block later, which may not come any more."""
        return self._plc_knows_failure or self._last_fault >= self._plc_block

    def _need(self, block_type: Any, topic: str, received: Any) -> None:
        self._needed.append(self.create_subscription(block_type, topic, received, BLOCKS))

    def _report_ready(self) -> None:
        if self.progress.cycle:
            self._ready_timer.cancel()
        elif all(subscription.get_publisher_count() for subscription in self._needed):
            self._report_publisher.publish(msg.BlockReport(source=MONITOR, first_cycle=-1))

    def watch_standstill(self, axes: list[str]) -> None:
        """Follows from now on whether `axes` stand (`standing`)."""
        for axis in axes:
            self.standing[axis] = False
            self.create_subscription(msg.AxisBlock, block_topic(axis), self._axis_callback(axis), BLOCKS)

    def _axis_callback(self, axis: str) -> Any:
        def received(message: msg.AxisBlock) -> None:
            self.standing[axis] = message.set_velocity[-1] == 0.0

        return received

    def lateness(self) -> Lateness:
        """Over the blocks of all nodes."""
        total = Lateness()
        for values in self.diagnostics.values():
            total.merge(values["lateness_counts"], int(values["lateness_max_us"]))
        return total

    def _on_first_channel(self, program: ProgramReport, message: msg.ChannelBlock) -> None:
        program.add(message)
        progress = self.progress
        progress.line, progress.block_number = message.line[-1], message.block_number[-1]
        progress.blocks_done, progress.blocks_total = message.blocks_done, message.blocks_total
        progress.feed_mm_per_min = message.path_velocity[-1] * 60.0
        last = range(message.count - 1, len(message.set_position), message.count)
        progress.position = {axis: message.set_position[index] for axis, index in zip(message.axes, last, strict=True)}
        progress.cycle = max(progress.cycle, message.first_cycle + message.count)

    def _on_plc(self, message: msg.PlcBlock) -> None:
        self.progress.cycle = max(self.progress.cycle, message.first_cycle + message.count)
        self.run_done, self._plc_knows_failure = message.run_done, message.run_failed
        self._plc_block = message.first_cycle

    def _on_event(self, message: msg.Event) -> None:
        if message.severity == Severity.ERROR and message.source != SUPERVISOR:
            where = f" (cycle {message.cycle}, line {message.line})" if message.line else f" (cycle {message.cycle})"
            self.errors.append(f"P-ERR-{message.error_id} {message.text}{where}")
            self._last_fault = max(self._last_fault, message.cycle)
        keep_note(self.notes, event_note(message.severity, message.error_id, message.text))

    def _on_command(self, message: msg.CommandRecord) -> None:
        keep_note(self.notes, command_note(message.accepted, message.error_id, message.message))

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.hardware_id == "cnc_ptp":
                self.diagnostics[status.name] = {value.key: value.value for value in status.values}
