"""The node around a unit: store messages, compute a block when all its inputs are there, publish."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import SetParametersResult
from rclpy.subscription import Subscription

from cnc_ptp import msg
from cnc_ptp.errors import CncError
from cnc_ptp.machine.gate import BlockGate
from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.machine.wiring import Inputs, unit_kinds, wiring
from cnc_ptp.nodes import convert, process
from cnc_ptp.nodes.events import EventPublisher
from cnc_ptp.nodes.handover import Handover
from cnc_ptp.nodes.polling_node import PollingNode, chain
from cnc_ptp.nodes.topics import (
    BLOCK_CLASSES,
    BLOCK_TYPES,
    BLOCKS,
    COMMAND,
    DIAGNOSTICS,
    DRIVE_STOPS,
    EVENTS,
    HEARTBEAT,
    LATENESS,
    PLC_INPUT,
    RECORDER,
    REMEMBERED_BLOCKS,
    REPORT,
    SERVICES,
    STATE_TYPES,
    TICK,
    block_topic,
)
from cnc_ptp.nodes.unit.checkpoints import UnitCheckpoints
from cnc_ptp.nodes.unit.claim import claim_unit
from cnc_ptp.nodes.unit.diagnostics import UnitDiagnostics
from cnc_ptp.nodes.unit.live_state import LiveState, period_cycles
from cnc_ptp.nodes.unit.parameters import declare_parameters, refusal, refused_change, write_command, written_parameter
from cnc_ptp.nodes.unit.requests import NOT_BEGUN, RUN_OVER, given_arguments, objection
from cnc_ptp.nodes.watchdog import Watchdog
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.parameters.view.authority import OF_SERVICES
from cnc_ptp.protocol.authority import closed_to
from cnc_ptp.protocol.blocks import Command, CommandRecord, CycleBlock, CycleTick, Event, PlcBlock, Severity
from cnc_ptp.protocol.commands import BAD_ARGUMENT, COMMANDS
from cnc_ptp.protocol.unit import CLOCK, PLC, Unit
from cnc_ptp.state.machine_state import CHECKPOINT_SECONDS
from cnc_ptp.wire.block_codec import codec_of, encode_block, has_plain_header, head_of
from cnc_ptp.wire.stamps import Stamps
from cnc_ptp.wire.ticks import Tick, decode_tick
from cnc_ptp.wire.unreadable import UNREADABLE_MESSAGE

EMERGENCY_STOP = "emergency_stop"
MACHINE = "machine"
"""The PLC node shows the parameters of the machine."""
BLOCK_SKIPPED = 26102
CAME_TWICE = 26142
TOO_LATE = 26116
DRIVE_GONE = 26267
SOON = 0.0005
"""Seconds between two looks of a node that waits for the rest of a block."""
LOOK_PERIOD = 0.005
"""Seconds between two looks of a node that has lost a source."""
LONGEST_COMMAND = 2.0
"""Seconds that a command or block may take; after that the node counts as silent."""
DIAGNOSTICS_PERIOD = 1.0
WITHOUT_STATES = (
    "no state was stored, a replay begins at an older checkpoint, or cnc_ptp replay --checkpoints makes them"
)


class UnitNode(PollingNode):
    """Runs one unit of the machine as a ROS node of the unit's name.

    Subscriptions: /clock/tick (CycleTick), /heartbeat (BlockReport), /<unit>/block of every upstream and feedback unit
    and of the master of a coupled axis; of axes and spindles /drive_stops (DriveStop).
    Publishers: /<name>/block, /events and /rosout, /commands, /clock/report, /heartbeat; once per second /diagnostics
    and /lateness; while somebody subscribes /<name>/state.
    Services: /<name>/<command> for the commands of its kind (topics.SERVICES).
    Parameters: all of its list, with range, unit and P number as descriptor; what can change while the unit runs
    (docs/parameters.md) can be set, the others are read-only.
    """

    def __init__(
        self,
        machine: MachineParameters,
        unit: Unit,
        *,
        recorders: int = 0,
        state_rate: float | None = None,
        checkpoints: float = CHECKPOINT_SECONDS,
        free_run: bool = False,
        handover: Handover | None = None,
    ) -> None:
        """Only a name in the graph; it takes part after `setup`.

        `recorders`: with 1, a recorder must have found the blocks too before the node is ready. `state_rate`: live
        states per second, None = as the machine file says. `checkpoints`: seconds of machine time between two
        states for a recorder, 0 = none. `free_run`: the clock does not wait for the wall clock.
        `handover`: to and from the other nodes of this process.
        """
        super().__init__(unit.name, enable_rosout=False)
        self._kinds = unit_kinds(machine)
        watchdog_cycles = machine.watchdog_ms * 1000 // machine.cycle_time_us
        self._runner = UnitRunner(unit, watchdog_cycles=watchdog_cycles, closed=machine.closed.get(unit.name, ()))
        wires = wiring(machine)
        self._inputs: Inputs = wires[unit.name]
        self._readers = {name for name, needs in wires.items() if unit.name in (*needs.upstream, *needs.feedback)}
        self._readers |= {RECORDER} if recorders else set()
        self._gate = BlockGate(self._inputs)
        self._cycle_ns = machine.cycle_time_us * 1000
        self._count = machine.block_cycles
        self._stamps = Stamps(0, self._cycle_ns)
        rotary = unit.kind == "spindle" or (unit.kind == "axis" and machine.axes[unit.name].rotary)
        block_ms = machine.block_cycles * machine.cycle_time_us / 1000.0
        self.diagnostics = UnitDiagnostics(unit, block_ms=block_ms, length_unit="deg" if rotary else "mm")
        self._state_period = period_cycles(machine, state_rate)
        self._checkpoint_seconds = checkpoints
        self._checkpoints: UnitCheckpoints | None = None
        self._has_told_state = False
        self._scheduled_ns: dict[int, int] = {}
        self._told_twice: set[str] = set()
        self._masters: set[str] = set()
        self._looking: process.SteadyTimer | None = None
        self._free_run = free_run
        self._handover = handover
        self._running = False
        self.paced = False
        """The clock runs in real time."""
        self._alone = False
        self._ended = False
        self._busy = False
        self.failure: CncError | None = None
        """Why the node cannot continue."""
        self._watchdog = Watchdog((CLOCK, *self._gate.sources), seconds=machine.watchdog_ms / 1000.0)
        self._heartbeat_at = time.monotonic()
        self._claim: socket.socket | None = None
        self._machine = machine
        self._own_name = MACHINE if unit.kind == PLC else unit.name
        self._shows_written = False
        """ROS takes over what the unit has already, or is about to have."""

    def setup(self) -> None:
        """Claims the unit, declares its parameters, makes topics, services and timers.

        Raises CncError 26141 when another process has the unit, 26130 for a refused ROS argument.
        """
        try:
            self._claim = claim_unit(self, self.unit.name)
        except CncError:
            super().destroy_node()
            raise
        declare_parameters(self, self._machine, self._own_name)
        self.add_on_set_parameters_callback(self._write_parameters)
        self._make_publishers()
        self._make_subscriptions()
        self._make_services()
        self._ready_timer = process.timer(self, process.READY_PERIOD, self._report_ready)
        process.timer(self, self._watchdog.seconds / 4.0, self._watch)
        process.timer(self, DIAGNOSTICS_PERIOD, self._publish_diagnostics)
        threading.Thread(target=self._heartbeat_while_busy, daemon=True).start()

    @property
    def unit(self) -> Unit:
        return self._runner.unit

    # set-up

    def _make_publishers(self) -> None:
        name = self.unit.name
        quality = REMEMBERED_BLOCKS if self.unit.kind in ("axis", "spindle") else BLOCKS
        self._block_publisher = self.create_publisher(BLOCK_TYPES[self.unit.kind], block_topic(name), quality)
        self._event_publisher = EventPublisher(self)
        self._record_publisher = self.create_publisher(msg.CommandRecord, COMMAND, EVENTS)
        self._report_publisher = self.create_publisher(msg.BlockReport, REPORT, BLOCKS)
        self._heartbeat_publisher = self.create_publisher(msg.BlockReport, HEARTBEAT, BLOCKS)
        self._diagnostics_publisher = self.create_publisher(DiagnosticArray, DIAGNOSTICS, PLC_INPUT)
        self._lateness_publisher = self.create_publisher(msg.LatenessHistogram, LATENESS, PLC_INPUT)
        self._live_state = None
        if self._state_period and self.unit.kind in STATE_TYPES:
            self._live_state = LiveState(self, name, self.unit.kind, self._state_period)
        if self._checkpoint_seconds > 0.0:
            self._checkpoints = UnitCheckpoints(self, self._machine, self._checkpoint_seconds)

    def _make_subscriptions(self) -> None:
        """The last source of a block wakes the node, which then looks for those of the others.

        In a free run the tick of the PLC comes before the blocks that it needs.
        """
        self.create_subscription(msg.BlockReport, HEARTBEAT, self._on_heartbeat, BLOCKS)
        if self.unit.kind in ("axis", "spindle") and self._handover is None:
            self.create_subscription(msg.DriveStop, DRIVE_STOPS, self._on_drive_stop, EVENTS)
        if self._handover is not None:
            self._needed: list[Subscription[Any]] = []
            self._handover.on_tick(self._take_tick, self.look)
            for source in self._gate.sources:
                self._handover.on_block(source, partial(self._take_block, source), self.look)
            return
        waking = {self._inputs.upstream[-1] if self._inputs.upstream else CLOCK}
        if self._free_run and not self._inputs.upstream:
            waking = {*self._inputs.feedback} or {CLOCK}
        take_tick = chain(decode_tick, self._take_tick)
        self._needed = [self._subscribe(msg.CycleTick, TICK, take_tick, wakes=CLOCK in waking)]
        for source in self._gate.sources:
            kind = self._kinds[source]
            take = chain(codec_of(BLOCK_CLASSES[kind]).decode, partial(self._take_block, source))
            self._needed.append(self._subscribe(BLOCK_TYPES[kind], block_topic(source), take, wakes=source in waking))

    def _subscribe(
        self, message_type: Any, topic: str, take: Callable[[bytes], None], *, wakes: bool
    ) -> Subscription[Any]:
        if wakes:
            received = self.readable(topic, partial(self._on_message, take))
            return self.create_subscription(message_type, topic, received, BLOCKS, raw=True)
        return self.poll(message_type, topic, take, BLOCKS)

    def set_parameters_atomically(self, parameter_list: Any) -> Any:
        """Refuses what cannot change, with the reason; ROS would only say that it is read-only."""
        refused = refused_change(self._machine.raw(self._own_name), parameter_list)
        return refused or super().set_parameters_atomically(parameter_list)

    def _write_parameters(self, wanted: Sequence[Any]) -> SetParametersResult:
        """ROS has found them in order: the unit takes them by a command, which is recorded, or refuses.

        Several at once are refused: the second one could fail when the first one has been taken already.
        """
        if self._shows_written:
            return SetParametersResult(successful=True)
        if len(wanted) != 1:
            return refusal(f"{self.unit.name}: parameters are set one by one; nothing was changed")
        self._shows_written = True
        record = self.command(write_command(self.unit.name, wanted[0]))
        self._shows_written = False
        if not record.accepted:
            return refusal(f"P-ERR-{record.error_id} {record.message}")
        self._compute_ready_blocks()
        return SetParametersResult(successful=True, reason=record.message)

    def _make_services(self) -> None:
        for command, service_type in SERVICES[self.unit.kind].items():
            callback = partial(self._on_service, command)
            self.create_service(service_type, f"{self.unit.name}/{command}", callback)

    def _report_ready(self) -> None:
        """Reports `ready` until the first tick, once all needed nodes have found each other."""
        if self._running:
            self._ready_timer.cancel()
            return
        found = self._handover is not None or process.is_read(self, self._block_publisher, self._readers)
        if found and all(subscription.get_publisher_count() for subscription in self._needed):
            self._report()

    # what arrives

    def _on_message(self, take: Callable[[bytes], None], data: bytes) -> None:
        """A message that wakes the node."""
        take(data)
        self.look()

    def look(self) -> None:
        """Takes what has come without waking the node, and computes what can be computed."""
        self.take_polled()
        self._compute_ready_blocks()
        self._end_if_over()

    def wait_time(self) -> float:
        """Seconds until the node looks on its own: it was woken, and another message of the block is still to come."""
        return SOON if self._handover is None and self._gate.waits_for_more() else process.SPIN_TIMEOUT

    def after_wait(self) -> None:
        if self._handover is None and self._gate.waits_for_more():
            self.look()

    def _take_tick(self, message: Tick) -> None:
        if self._alone:
            return
        if not self._running and message.first_cycle:
            self.failure = CncError(
                TOO_LATE,
                f"{self.unit.name}: the run is at cycle {message.first_cycle}",
                "the node takes no part and ends: nodes must be there before the clock starts",
            )
            return
        if not self._running and message.scheduled_monotonic_ns:
            process.take_priority()
        self._running, self.paced = True, bool(message.scheduled_monotonic_ns)
        self._watchdog.heard(CLOCK)
        self._stamps.start_ns = message.stamp_ns - message.first_cycle * self._cycle_ns
        if self.paced:
            self._scheduled_ns[message.first_cycle] = message.scheduled_monotonic_ns
        before = self._gate.duplicates
        if not self._gate.add_tick(CycleTick(message.first_cycle, message.count)):
            self._lose(CLOCK, f"tick {self._gate.next_cycle} of the clock is missing, {message.first_cycle} came")
        self._tell_twice(CLOCK, message.first_cycle, before)

    def _take_block(self, source: str, block: CycleBlock) -> None:
        self._watchdog.heard(source)
        if isinstance(block, PlcBlock):
            self.complete_commands(block)
        before = self._gate.duplicates
        self._gate.add_block(source, block)
        self._tell_twice(source, block.first_cycle, before)

    def _tell_twice(self, source: str, cycle: int, before: int) -> None:
        """An event for each source of which more came twice than `before`: perhaps two nodes have the same unit."""
        if self._gate.duplicates > before and source not in self._told_twice:
            self._told_twice.add(source)
            text = f"block {cycle} of '{source}' came twice, the first one counts; is there a second '{source}'?"
            self.tell(Severity.ERROR, CAME_TWICE, f"{self.unit.name}: {text}")

    def tell(self, severity: int, error_id: int, text: str) -> None:
        """An event of the node, not of its unit."""
        event = Event(self._gate.next_cycle, self.unit.name, severity, error_id, text)
        self._event_publisher.publish(convert.event_to_message(event, self.stamp(event.cycle)))

    def tell_unreadable(self, text: str) -> None:
        """As an event."""
        self.tell(Severity.WARNING, UNREADABLE_MESSAGE, text)

    def _on_heartbeat(self, message: msg.BlockReport) -> None:
        self._watchdog.heard(message.source)

    def _on_drive_stop(self, message: msg.DriveStop) -> None:
        """This process was silent for too long: what it computes is no longer what its drive has done."""
        if message.unit == self.unit.name:
            cycle, silence = (
                message.first_cycle,
                f"no setpoint came within the watchdog time of {self._watchdog.seconds:g} s",
            )
            self.failure = CncError(
                DRIVE_GONE,
                f"{self.unit.kind} {self.unit.name}: its drive has stopped on its own in cycle {cycle}, as {silence}",
                "the node ends: it does not know where the drive is",
            )

    def _on_service(self, command: str, request: Any, response: Any) -> Any:
        asked = Command(self.unit.name, command, self.arguments(command, request))
        if reason := objection(command, COMMANDS[self.unit.kind][command], request):
            record = self.refuse(asked, CncError(BAD_ARGUMENT, reason))
        else:
            record = self.command(asked)
        response.accepted, response.error_id = record.accepted, record.error_id
        response.message, response.values_json = record.message, record.values_json
        response.cycle, response.job = record.cycle, record.job
        self._compute_ready_blocks()  # an axis that is decoupled now no longer waits for its master
        return response

    def arguments(self, command: str, request: Any) -> dict[str, Any]:
        return given_arguments(COMMANDS[self.unit.kind][command], request)

    @property
    def next_cycle(self) -> int:
        """The cycle at which a command would act now."""
        return self._runner.next_cycle

    @property
    def is_over(self) -> bool:
        """No more block is computed."""
        return self._gate.closed

    def command(self, command: Command, source: str | None = OF_SERVICES) -> CommandRecord:
        """Carries out a command between two blocks: from a service or an action; None: of the machine itself.

        Before the first tick only an emergency stop is: a recorder may not listen yet.
        """
        if self._gate.closed:
            return self.refuse(command, CncError(RUN_OVER, "the run has ended"))
        if not self._running and source is not None and command.command != EMERGENCY_STOP:
            return self.refuse(command, CncError(NOT_BEGUN, "the run has not begun"))
        with self._working():
            record = self._runner.command(command) if source is None else self._runner.asked(command, source)
        self._publish_records()
        return record

    def why_closed(self, command: Command, source: str) -> CncError | None:
        """Why a unit of the machine does not take a command from `source`; None if it does."""
        unit = command.target
        closed = self._machine.closed.get(unit, ())
        return closed_to(self._kinds[unit], unit, command.command, command.arguments, source=source, closed=closed)

    def refuse(self, command: Command, error: CncError) -> CommandRecord:
        """The record of a command that does not reach the unit; it is published like all others."""
        record = self._runner.refuse(command, error)
        self._publish_records()
        return record

    # one block

    def _compute_ready_blocks(self) -> None:
        for source in self._gate.skipped():
            self._lose(source, f"block {self._gate.next_cycle} of '{source}' is missing, a later one came")
        while self.failure is None:
            if not self._gate.opened:
                begun = self._gate.begin()
                if begun is None:
                    return
                with self._working():
                    self._runner.apply(*begun)
            self._follow_master()
            ready = self._gate.complete()
            if ready is None:
                return
            self._compute(*ready)

    def _follow_master(self) -> None:
        """Subscribes to the blocks of the unit's present master; the first ones come from the topic's history."""
        master = self._runner.master
        self._gate.follow(master)
        if master is not None and master not in self._masters:
            self._watchdog.watch(master)
            self._masters.add(master)
            take = partial(self._take_master_block, master)
            if self._handover is not None:
                self._handover.on_block(master, take, self.look)
                return
            kind = self._kinds[master]
            on_message = partial(self._on_master_message, chain(codec_of(BLOCK_CLASSES[kind]).decode, take))
            received = self.readable(block_topic(master), on_message)
            self.create_subscription(BLOCK_TYPES[kind], block_topic(master), received, REMEMBERED_BLOCKS, raw=True)

    def _on_master_message(self, take: Callable[[bytes], None], data: bytes) -> None:
        """The first ones are the history of the topic, up to 10 s: old ones are not even decoded."""
        if not has_plain_header(data) or head_of(data)[1] >= self._gate.needed_of_master:
            self._on_message(take, data)

    def _take_master_block(self, master: str, block: CycleBlock) -> None:
        self._watchdog.heard(master)
        self._gate.add_master_block(master, block)

    def _compute(self, tick: CycleTick, inputs: dict[str, CycleBlock]) -> None:
        with self._working():
            block = self._runner.compute(tick, inputs)
        self._publish_records()  # first: a recording that ends here has all commands that led to its last states
        self._publish_block(block)
        self.diagnostics.add_block(block)
        scheduled = self._scheduled_ns.pop(tick.first_cycle, 0)
        if scheduled:
            self.diagnostics.add_lateness((time.monotonic_ns() - scheduled) // 1000)
        plc = block if isinstance(block, PlcBlock) else inputs.get(PLC)
        if isinstance(plc, PlcBlock) and plc.run_done:
            self._gate.close()
        self.after_block(block)
        if self._live_state is not None and not isinstance(block, PlcBlock):
            self._live_state.publish(block, self._stamps)
        if self._checkpoints is not None and self._checkpoints.is_due(self._runner.next_cycle):
            self._publish_checkpoint(self._checkpoints, block)
        self._end_if_over()

    def _end_if_over(self) -> None:
        if self._gate.closed and not self._ended:
            self._ended = True
            self._publish_diagnostics()
            self.run_ended()

    def _publish_checkpoint(self, checkpoints: UnitCheckpoints, block: CycleBlock) -> None:
        """An event for the first one that cannot be stored; later ones may be those of another program."""
        try:
            with self._working():
                checkpoints.publish(self._runner, block, self._stamps)
        except CncError as error:
            if not self._has_told_state:
                self._has_told_state = True
                self.tell(Severity.INFO, error.number, f"{self.unit.name}: {error.reason}; {WITHOUT_STATES}")

    def run_ended(self) -> None:
        """For subclasses: the last block has been computed."""

    def complete_commands(self, block: PlcBlock) -> None:
        """For subclasses: adds to commands of the PLC what does not travel in its block."""

    def after_block(self, block: CycleBlock) -> None:
        """For subclasses: publishes more of a block."""

    def stamp(self, cycle: int) -> Time:
        return convert.time_message(self._stamps.at(cycle))

    def _publish_block(self, block: CycleBlock) -> None:
        if self._handover is None or self._block_publisher.get_subscription_count():
            self._block_publisher.publish(encode_block(block, self._stamps))
        if self._handover is not None:
            self._handover.block(self.unit.name, block)
        self._heartbeat_at = time.monotonic()

    def _publish_records(self) -> None:
        for record in self.unit.take_records():
            self._show_written(record)
            self._record_publisher.publish(convert.record_to_message(record, self.stamp(record.cycle)))
        for event in self.unit.take_events():
            self.diagnostics.note(event)
            self._event_publisher.publish(convert.event_to_message(event, self.stamp(event.cycle)))

    def _show_written(self, record: CommandRecord) -> None:
        """A parameter that somebody else has written is what ROS shows from now on."""
        shown = None if self._shows_written else written_parameter(self._machine.raw(self._own_name), record)
        if shown is not None and self.has_parameter(shown.name):
            self._shows_written = True
            super().set_parameters_atomically([shown])
            self._shows_written = False

    # watchdog

    def _watch(self) -> None:
        """Reports that this node is alive while it waits, and drops sources silent for the watchdog time."""
        self.look()
        if self._watchdog.was_suspended() or self._gate.closed or not self._running:
            self._watchdog.restart()
            return
        if self._alone:
            self._tick_alone()
            return
        if time.monotonic() - self._heartbeat_at > self._watchdog.seconds / 4.0:
            self._publish_heartbeat()
        for source in self._watchdog.silent(self._gate.missing(), begun=self._gate.next_cycle > self._count):
            self._lose(source, None)
        self._compute_ready_blocks()

    def _lose(self, source: str, reason: str | None) -> None:
        """Continues without `source`; the unit decides what that means for its motion."""
        if reason is not None:
            self.diagnostics.lost_blocks += 1
            self.tell(Severity.ERROR, BLOCK_SKIPPED, f"{self.unit.name}: {reason}")
        self._gate.drop(source)
        if self._handover is None and not self._looking:
            self._looking = process.timer(self, LOOK_PERIOD, self.look)  # what has woken this node may be what is lost
        self.command(Command(self.unit.name, "upstream_lost", {"source": source}), None)
        if source == CLOCK:
            self._alone = True
            for other in self._gate.sources:
                self._gate.drop(other)

    def _tick_alone(self) -> None:
        """Without a clock the unit ticks on its own, so that it finishes its ramp."""
        blocks = max(1, round(self._watchdog.seconds / 4.0 * 1e9 / (self._cycle_ns * self._count)))
        for _ in range(blocks):
            self._gate.add_tick(CycleTick(self._gate.next_cycle, self._count))
            self._compute_ready_blocks()

    def _report(self) -> None:
        """To the clock: ready."""
        self._report_publisher.publish(msg.BlockReport(source=self.unit.name, first_cycle=-1))

    def _publish_heartbeat(self) -> None:
        """To all: this node is alive."""
        self._heartbeat_at = time.monotonic()
        self._heartbeat_publisher.publish(msg.BlockReport(source=self.unit.name, first_cycle=self._gate.next_cycle))

    @contextmanager
    def _working(self) -> Iterator[None]:
        self._busy = True
        try:
            yield
        finally:
            self._busy = False

    def _heartbeat_while_busy(self) -> None:
        """A long command (a big program is interpreted) must not look like a dead node, but an endless one must."""
        period = self._watchdog.seconds / 4.0
        busy_for = 0.0
        while self.context.ok():
            if self._busy and 0.0 < busy_for < LONGEST_COMMAND:
                self._publish_heartbeat()
            busy_for = busy_for + period if self._busy else 0.0
            time.sleep(period)

    def _publish_diagnostics(self) -> None:
        if not self._running:
            return
        message = DiagnosticArray(status=[self.diagnostics.status(self._gate.duplicates)])
        message.header.stamp = self.stamp(self._gate.next_cycle)
        self._diagnostics_publisher.publish(message)
        if self.diagnostics.lateness.counts:
            lateness = self.diagnostics.lateness.message(self.unit.name)
            lateness.header.stamp = message.header.stamp
            self._lateness_publisher.publish(lateness)

    def destroy_node(self) -> None:
        super().destroy_node()
        if self._claim is not None:
            self._claim.close()
