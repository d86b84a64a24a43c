"""The node around a unit: store messages, compute a block when all its inputs are there, publish."""

from __future__ import annotations

import socket
import time
from collections.abc import Callable
from functools import partial
from math import inf
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.subscription import Subscription

from cnc_ptp import msg
from cnc_ptp.errors import CncError
from cnc_ptp.machine.gate import BlockGate
from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.machine.wiring import Inputs, unit_kinds, wiring
from cnc_ptp.nodes import process
from cnc_ptp.nodes.handover import Handover
from cnc_ptp.nodes.polling_node import PollingNode, chain
from cnc_ptp.nodes.topics import (
    BLOCK_CLASSES,
    BLOCK_TYPES,
    BLOCKS,
    DRIVE_STOPS,
    EVENTS,
    HEARTBEAT,
    RECORDER,
    REMEMBERED_BLOCKS,
    SERVICES,
    TICK,
    block_topic,
)
from cnc_ptp.nodes.unit.claim import claim_unit
from cnc_ptp.nodes.unit.diagnostics import UnitDiagnostics
from cnc_ptp.nodes.unit.heartbeat import Heartbeat
from cnc_ptp.nodes.unit.live_state import period_cycles
from cnc_ptp.nodes.unit.parameters import declare_parameters, refused_change
from cnc_ptp.nodes.unit.publications import UnitPublications
from cnc_ptp.nodes.unit.requests import NOT_BEGUN, RUN_OVER, given_arguments, objection
from cnc_ptp.nodes.unit.shown_parameters import ShownParameters
from cnc_ptp.nodes.watchdog import Watchdog
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.parameters.view.authority import OF_SERVICES
from cnc_ptp.protocol.authority import closed_to
from cnc_ptp.protocol.blocks import Command, CommandRecord, CycleBlock, CycleTick, PlcBlock, Severity
from cnc_ptp.protocol.commands import BAD_ARGUMENT, COMMANDS
from cnc_ptp.protocol.unit import CLOCK, PLC, Unit
from cnc_ptp.state.machine_state import CHECKPOINT_SECONDS
from cnc_ptp.wire.block_codec import codec_of, has_plain_header, head_of
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
EARLY = 0.6
"""Part of a block's time, from the end of the last computation, after which a node with feedback takes what has come
already: less is left to do when it is woken."""
LOOK_PERIOD = 0.005
"""Seconds between two looks of a node that has lost a source."""
DIAGNOSTICS_PERIOD = 1.0


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
        self._scheduled_ns: dict[int, int] = {}
        self._told_twice: set[str] = set()
        self._masters: set[str] = set()
        self._waking: set[str] = set()
        """Sources whose messages wake the node; empty in one process, where every block is handed over."""
        self._early_at = inf
        """When the node looks before it is woken; infinite: not before the next block."""
        self._looking: process.SteadyTimer | None = None
        self._free_run = free_run
        self._handover = handover
        self._running = False
        self.paced = False
        """The clock runs in real time."""
        self._alone = False
        self._ended = False
        self.failure: CncError | None = None
        """Why the node cannot continue."""
        self._watchdog = Watchdog((CLOCK, *self._gate.sources), seconds=machine.watchdog_ms / 1000.0)
        self._claim: socket.socket | None = None
        self._machine = machine
        self._own_name = MACHINE if unit.kind == PLC else unit.name

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
        own, look = self._machine.raw(self._own_name), self._compute_ready_blocks
        self._shown = ShownParameters(self, self.unit.name, own, give=self.command, look=look)
        self._make_publishers()
        self._make_subscriptions()
        self._make_services()
        self._ready_timer = process.timer(self, process.READY_PERIOD, self._report_ready)
        process.timer(self, self._watchdog.seconds / 4.0, self._watch)
        process.timer(self, DIAGNOSTICS_PERIOD, self._publish_diagnostics)

    @property
    def unit(self) -> Unit:
        return self._runner.unit

    # set-up

    def _make_publishers(self) -> None:
        self._publications = UnitPublications(
            self,
            self._machine,
            self.unit,
            self._stamps,
            state_period=self._state_period,
            checkpoint_seconds=self._checkpoint_seconds,
            handover=self._handover,
        )
        seconds = self._watchdog.seconds
        self._heartbeat = Heartbeat(
            self, self.unit.name, watchdog_seconds=seconds, next_cycle=lambda: self._gate.next_cycle
        )

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
        self._waking = {self._inputs.upstream[-1] if self._inputs.upstream else CLOCK}
        if self._free_run and not self._inputs.upstream:
            self._waking = {*self._inputs.feedback} or {CLOCK}
        take_tick = chain(decode_tick, self._take_tick)
        self._needed = [self._subscribe(msg.CycleTick, TICK, take_tick, wakes=CLOCK in self._waking)]
        for source in self._gate.sources:
            take = chain(self._decoder(source), partial(self._take_block, source))
            block_type = BLOCK_TYPES[self._kinds[source]]
            self._needed.append(self._subscribe(block_type, block_topic(source), take, wakes=source in self._waking))

    def _decoder(self, unit: str) -> Callable[[bytes], CycleBlock]:
        """Of the blocks of a unit; raises CncError 26184 for what is none of this machine."""
        return partial(codec_of(BLOCK_CLASSES[self._kinds[unit]]).decode, count=self._count)

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

    def _make_services(self) -> None:
        for command, service_type in SERVICES[self.unit.kind].items():
            callback = partial(self._on_service, command)
            self.create_service(service_type, f"{self.unit.name}/{command}", callback)

    def _report_ready(self) -> None:
        """Reports `ready` until the first tick, once all needed nodes have found each other."""
        if self._running:
            self._ready_timer.cancel()
            return
        found = self._handover is not None or process.is_read(self, self._publications.blocks, self._readers)
        if found and all(subscription.get_publisher_count() for subscription in self._needed):
            self._publications.ready()

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
        """Seconds until the node looks on its own: soon while a message is missing behind the one that woke it."""
        return SOON if self._waits_for_others else min(process.SPIN_TIMEOUT, self._early_at - time.monotonic())

    def after_wait(self) -> None:
        is_early = time.monotonic() >= self._early_at
        if is_early:
            self._early_at = inf
        if is_early or self._waits_for_others:
            self.look()

    @property
    def _waits_for_others(self) -> bool:
        """A node that is late has ticks enough: it must not look for what will wake it, that makes it later still."""
        return self._handover is None and self._gate.waits_for_others(self._waking)

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
        self._publications.tell(self._gate.next_cycle, severity, error_id, text)

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
        with self._heartbeat.working():
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
                if not self._gate.closed and not self._gate.missing():
                    with self._heartbeat.working():
                        self.before_block()
                begun = self._gate.begin()
                if begun is None:
                    return
                with self._heartbeat.working():
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
            on_message = partial(self._on_master_message, chain(self._decoder(master), take))
            received, block_type = self.readable(block_topic(master), on_message), BLOCK_TYPES[self._kinds[master]]
            self.create_subscription(block_type, block_topic(master), received, REMEMBERED_BLOCKS, raw=True)

    def _on_master_message(self, take: Callable[[bytes], None], data: bytes) -> None:
        """The first ones are the history of the topic, up to 10 s: old ones are not even decoded."""
        if not has_plain_header(data) or head_of(data)[1] >= self._gate.needed_of_master:
            self._on_message(take, data)

    def _take_master_block(self, master: str, block: CycleBlock) -> None:
        self._watchdog.heard(master)
        self._gate.add_master_block(master, block)

    def _compute(self, tick: CycleTick, inputs: dict[str, CycleBlock]) -> None:
        with self._heartbeat.working():
            block = self._runner.compute(tick, inputs)
        self._publish_records()  # first: a recording that ends here has all commands that led to its last states
        self._publications.block(block)
        self._heartbeat.block_sent()
        if self.paced and self._inputs.feedback and self._handover is None:
            self._early_at = time.monotonic() + EARLY * 1e-9 * self._cycle_ns * self._count
        self.diagnostics.add_block(block)
        scheduled = self._scheduled_ns.pop(tick.first_cycle, 0)
        if scheduled:
            self.diagnostics.add_lateness((time.monotonic_ns() - scheduled) // 1000)
        plc = block if isinstance(block, PlcBlock) else inputs.get(PLC)
        if isinstance(plc, PlcBlock) and plc.run_done:
            self._gate.close()
        self.after_block(block)
        self._publications.live_state(block)
        with self._heartbeat.working():
            self._publications.checkpoint(self._runner, block)
        self._end_if_over()

    def _end_if_over(self) -> None:
        if self._gate.closed and not self._ended:
            self._ended = True
            self._publish_diagnostics()
            self.run_ended()

    def run_ended(self) -> None:
        """For subclasses: the last block has been computed."""

    def complete_commands(self, block: PlcBlock) -> None:
        """For subclasses: adds to commands of the PLC what does not travel in its block."""

    def before_block(self) -> None:
        """For subclasses: takes what the next block must act on, besides its blocks."""

    def after_block(self, block: CycleBlock) -> None:
        """For subclasses: publishes more of a block."""

    def stamp(self, cycle: int) -> Time:
        return self._publications.stamp(cycle)

    def _publish_records(self) -> None:
        for record in self.unit.take_records():
            self._shown.follow(record)
            self._publications.record(record)
        for event in self.unit.take_events():
            self.diagnostics.note(event)
            self._publications.event(event)

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
        self._heartbeat.send_if_due()
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

    def _publish_diagnostics(self) -> None:
        if self._running:
            came_twice, next_cycle = self._gate.duplicates, self._gate.next_cycle
            self._publications.diagnostics(self.diagnostics, came_twice=came_twice, next_cycle=next_cycle)

    def destroy_node(self) -> None:
        super().destroy_node()
        if self._claim is not None:
            self._claim.close()
