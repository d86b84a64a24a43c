"""Monitor of a run: progress, events, statistics; collected from the topics of the graph."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.subscription import Subscription

from cnc_ptp import msg
from cnc_ptp.channel.program_report import ProgramReport
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes import process
from cnc_ptp.nodes.client.latest_blocks import LatestBlocks
from cnc_ptp.nodes.convert import event_of, message_of
from cnc_ptp.nodes.handover import Handover
from cnc_ptp.nodes.polling_node import PollingNode, chain
from cnc_ptp.nodes.topics import (
    BLOCK_CLASSES,
    BLOCK_TYPES,
    BLOCKS,
    COMMAND,
    DIAGNOSTICS,
    EVENT,
    EVENTS,
    LATENESS,
    MONITOR,
    PLC_INPUT,
    REPORT,
    block_topic,
)
from cnc_ptp.nodes.unit.lateness import Lateness
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, Event, PlcBlock, Severity, SpindleBlock
from cnc_ptp.protocol.notes import Note, Notes, error_text
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.protocol.unit_view import UnitView
from cnc_ptp.recording.on_demand import begun_file
from cnc_ptp.wire.block_codec import codec_of
from cnc_ptp.wire.unreadable import unreadable

SUPERVISOR = "supervisor"
"""Source of events about node processes, which the supervisor prints itself."""


class RunMonitor(PollingNode):
    """Subscriptions: /<channel>/block, /plc/block, /events, /commands, /diagnostics, /lateness.

    With `watch_units` the blocks of all units as well.
    """

    def __init__(self, machine: MachineParameters, *, handover: Handover | None = None) -> None:
        """`handover`: from the other nodes of this process."""
        super().__init__(MONITOR, enable_rosout=False, start_parameter_services=False)
        self.cycle = 0
        """The last cycle of the run so far."""
        self.programs = {channel: ProgramReport() for channel in machine.channels}
        self.errors: list[str] = []
        self._new_faults: list[str] = []
        self.notes = Notes()
        self.refused = 0
        self.run_done = False
        self.ending = ""
        """How a run that stays was ended, with everything at a standstill."""
        self.on_demand = ""
        """The newest recording on demand: file or folder; empty without one."""
        self._latest: LatestBlocks | None = None
        self._machine = machine
        self._plc_block = 0
        self._plc_knows_failure = False
        self._last_fault = -1
        self.diagnostics: dict[str, dict[str, float]] = {}
        """The newest figures of each node (recording/node_figures.py)."""
        self._histograms: dict[str, msg.LatenessHistogram] = {}
        self.standing: dict[str, bool] = {}
        self._needed: list[Subscription[Any]] = []
        self._handover = handover
        self._report_publisher = self.create_publisher(msg.BlockReport, REPORT, BLOCKS)
        self._ready_timer = process.timer(self, process.READY_PERIOD, self._report_ready)
        for channel, program in self.programs.items():
            self._need(ChannelBlock, msg.ChannelBlock, channel, program.add)
        self._need(PlcBlock, msg.PlcBlock, PLC, self._on_plc)
        # polled: the executor of these wheels did not call for some of the last events of a run
        command_of = partial(message_of, message_type=msg.CommandRecord)
        self.poll(msg.Event, EVENT, chain(event_of, self._on_event), EVENTS)
        self.poll(msg.CommandRecord, COMMAND, chain(command_of, self._on_command), EVENTS)
        received = self.readable(DIAGNOSTICS, self._on_diagnostics)
        self.create_subscription(DiagnosticArray, DIAGNOSTICS, received, PLC_INPUT, raw=True)
        received = self.readable(LATENESS, self._on_lateness)
        self.create_subscription(msg.LatenessHistogram, LATENESS, received, PLC_INPUT, raw=True)

    @property
    def run_failed(self) -> bool:
        """The PLC knows of a fault one block later, and that block may no longer come."""
        return self._plc_knows_failure or self._last_fault >= self._plc_block

    def _need(self, block_class: type, message_type: Any, unit: str, received: Callable[[Any], None]) -> None:
        """Blocks that come when `take_polled` is called, many times per second."""
        if self._handover is not None:
            self._handover.on_block(unit, received)
            return
        take = chain(codec_of(block_class).decode, received)
        self._needed.append(self.poll(message_type, block_topic(unit), take, BLOCKS))

    def _report_ready(self) -> None:
        if self.cycle:
            self._ready_timer.cancel()
        elif self._handover is not None:
            self._handover.ready.add(MONITOR)
        elif all(subscription.get_publisher_count() for subscription in self._needed):
            self._report_publisher.publish(msg.BlockReport(source=MONITOR, first_cycle=-1))

    def watch_standstill(self, units: list[str]) -> None:
        """Follows from now on whether `units`, axes and spindles, are at a standstill (`standing`)."""
        for unit in units:
            self.standing[unit] = False
            kind = "axis" if unit in self._machine.axes else "spindle"
            take = chain(codec_of(BLOCK_CLASSES[kind]).decode, partial(self._note_standstill, unit))
            self.poll(BLOCK_TYPES[kind], block_topic(unit), take, BLOCKS)

    def watch_units(self) -> None:
        """Keeps the newest view of all units from now on."""
        rotary = [name for name, axis in self._machine.axes.items() if axis.rotary]
        kinds = unit_kinds(self._machine)
        self._latest = LatestBlocks(self, kinds, rotary=rotary, from_the_start=True, handover=self._handover)

    def views(self) -> list[UnitView]:
        """The newest view of each unit, while they are watched."""
        return [] if self._latest is None else self._latest.views()

    def busy_units(self) -> list[str]:
        """Units that move, turn or run a program."""
        return [view.name for view in self.views() if view.busy]

    def note_ending(self, signal_name: str) -> bool:
        """A run that stays gets a signal to end: no failure (True) if all units have reported a standstill."""
        views = self.views()
        if len(views) < len(unit_kinds(self._machine)) - 1 or self.busy_units():
            return False
        self.ending = f"the machine was ended ({signal_name}) with all units at a standstill"
        return True

    def _note_standstill(self, unit: str, block: AxisBlock | SpindleBlock) -> None:
        velocities = block.set_velocity if isinstance(block, AxisBlock) else block.set_speed_rpm
        self.standing[unit] = velocities[-1] == 0.0

    def lateness(self) -> Lateness:
        """Over the blocks of all nodes."""
        total = Lateness()
        for histogram in self._histograms.values():
            total.merge(histogram)
        return total

    def _on_plc(self, message: PlcBlock) -> None:
        self.cycle = max(self.cycle, message.first_cycle + message.count)
        self.run_done, self._plc_knows_failure = message.run_done, message.run_failed
        self._plc_block = message.first_cycle

    def _on_event(self, message: Event) -> None:
        if message.severity == Severity.ERROR and message.source != SUPERVISOR:
            self.errors.append(error_text(message))
            self._new_faults.append(f"error: {self.errors[-1]}")
            self._last_fault = max(self._last_fault, message.cycle)
        self.on_demand = begun_file(message.error_id, message.text) or self.on_demand
        self.notes.add(Note.of_event(message))

    def note_failure(self, text: str) -> None:
        """Of a process, which the supervisor has noticed."""
        self._new_faults.append(f"failed: {text}")

    def take_faults(self) -> list[str]:
        """Errors and failures since the last call, as a run prints them."""
        new, self._new_faults = self._new_faults, []
        return new

    def _on_command(self, message: msg.CommandRecord) -> None:
        self.refused += not message.accepted
        self.notes.add(Note.of_command(message))

    def _on_lateness(self, data: bytes) -> None:
        """Raises CncError 26184 for one whose steps and numbers of blocks are no pairs."""
        message = message_of(data, msg.LatenessHistogram)
        steps, blocks = len(message.step), len(message.blocks)
        if steps != blocks:
            raise unreadable("LatenessHistogram", data, f"step holds {steps} values, and blocks {blocks}")
        self._histograms[message.source] = message

    def _on_diagnostics(self, data: bytes) -> None:
        """Raises CncError 26184 for figures that are no numbers."""
        for status in message_of(data, DiagnosticArray).status:
            if status.hardware_id == "cnc_ptp":
                try:
                    self.diagnostics[status.name] = {value.key: float(value.value) for value in status.values}
                except ValueError as error:
                    raise unreadable("DiagnosticArray", data, f"{status.name}: {error}") from error
