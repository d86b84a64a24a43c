"""`recorder MACHINE.yaml OUT.mcap`: records every block, event and command of the graph, and what the PLC writes.

With `--foxglove PORT` it streams them, too.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial, wraps
from math import inf
from typing import Any

import click
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import Log
from rclpy.qos import qos_profile_rosout_default
from rclpy.subscription import Subscription

from cnc_ptp import msg
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes import convert, node_command_line, process
from cnc_ptp.nodes.events import ROSOUT, EventPublisher
from cnc_ptp.nodes.free_run import RECORDER_BLOCKS
from cnc_ptp.nodes.handover import Handover
from cnc_ptp.nodes.live_stream import LiveServer, live_stream
from cnc_ptp.nodes.observed_topics import observed_topics, type_name
from cnc_ptp.nodes.polling_node import PollingNode, chain
from cnc_ptp.nodes.recording_services import RecordingServices
from cnc_ptp.nodes.topics import (
    BLOCK_CLASSES,
    BLOCK_TYPES,
    BLOCKS,
    CHECKPOINTS,
    COMMAND,
    DIAGNOSTICS,
    DRIVE_STOPS,
    EVENT,
    EVENTS,
    LATENESS,
    PLC_INPUT,
    RECORDER,
    REPORT,
    STATES_OF_UNITS,
    TICK,
    block_topic,
    recorded_topic,
)
from cnc_ptp.nodes.watchdog import Pause
from cnc_ptp.parameters import MachineParameters, machine_text, read_machine
from cnc_ptp.protocol.blocks import CycleBlock, CycleTick, Event, PlcBlock, Severity
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.mcap_file import NOT_WRITTEN
from cnc_ptp.recording.on_demand import OnDemand, without_what
from cnc_ptp.recording.recorder_options import FROM_THE_START, RecorderOptions
from cnc_ptp.recording.settings import COMPRESSIONS
from cnc_ptp.recording.trigger import Condition, make_recording
from cnc_ptp.recording.writer import Recording
from cnc_ptp.state.encoding import digest_of
from cnc_ptp.wire.block_codec import codec_of, head_of, with_plain_header
from cnc_ptp.wire.stamps import Stamps
from cnc_ptp.wire.ticks import Tick, decode_tick
from cnc_ptp.wire.unreadable import UNREADABLE_MESSAGE, unreadable

Sink = Recording | OnDemand

BLOCKS_MISSING = 26114
LOST_AFTER = 1.0
"""Seconds for which a recorder must be held up to miss the end of a run; a busy computer holds it up for less."""
STALE = 0.2
"""Seconds in which it gets what has waited for it."""
QUIET = 0.2
"""Seconds without a message after which a recorder that is to end has seen everything."""
ALONE_AFTER = 1.0
"""Seconds without a tick after which units go on alone, as far as they get."""
LOOK_PERIOD = 0.05
"""Seconds between two looks for ticks and blocks."""


class RecorderNode(PollingNode):
    """Writes the recording of a run.

    Subscriptions: /clock/tick, /<unit>/block of every unit (as raw bytes), /events, /commands, /drive_stops,
    /checkpoints, /diagnostics, /lateness, the topics of observed_topics, and of /rosout the messages of the nodes of
    its namespace: these come as raw bytes and are stamped with the time of their arrival, in free run with that of the
    last tick.
    Publishes /clock/report: ready, and in free run the newest tick that it has taken; /events: blocks that did not
    arrive, snapshots. A block that comes twice is recorded once.
    Services: ~/start and ~/stop of a recording, ~/snapshot of the last seconds.
    """

    def __init__(
        self,
        machine: MachineParameters,
        path: str | None,
        machine_yaml: str,
        *,
        options: RecorderOptions = FROM_THE_START,
        foxglove: int | None = None,
        handover: Handover | None = None,
    ) -> None:
        """`path`: of the recording of the whole run, None = on demand alone. `foxglove`: port of a live stream.

        `handover`: from nodes of this process.
        """
        super().__init__(RECORDER, enable_rosout=False)
        self._units = unit_kinds(machine)
        self._options = options
        options.require_places(path)
        self._condition = None if options.when is None else Condition(options.when, self._units)
        self._settings = options.settings()
        self._snapshots = options.snapshots_of(self._units)
        self._server = None if foxglove is None else LiveServer(foxglove, "cnc_ptp")
        self._sinks: list[Sink] = []
        """The live stream and the recording, since the first tick."""
        self._machine_yaml = machine_yaml
        self._path = path
        self._cycle_ns = machine.cycle_time_us * 1000
        self._block_cycles = machine.block_cycles
        self._most_ahead = RECORDER_BLOCKS * machine.block_cycles
        self._free_run = False
        self._tick_ns = 0
        self._last_tick = -1
        """First cycle of the newest tick."""
        self._recording: OnDemand | None = None
        self._early: list[Callable[[], None]] = []
        self._next_cycle = dict.fromkeys(self._units, 0)
        self._stopped: dict[str, int] = {}
        """The first cycle of units whose drives have stopped on their own."""
        self._heard = self._ticked_at = time.monotonic()
        self._pause = Pause()
        self._last_plc = b""
        """The newest block of the PLC: it says whether the run has ended."""
        self._held_for, self._resumed_at = 0.0, -inf
        """How long this process was held up last, and when it resumed."""
        self._report_publisher = self.create_publisher(msg.BlockReport, REPORT, BLOCKS)
        self._event_publisher = EventPublisher(self)
        self.failure: CncError | None = None
        """The error that ended the writing."""
        self._handover = handover
        self._needed = [] if handover else [*self._subscribe_to_blocks()]
        if handover:
            handover.on_tick(self._guarded(self._on_tick), self._guarded(self._look))
            for unit in self._units:
                handover.on_block(unit, self._guarded(partial(self._take_block, unit)))
        self.create_subscription(msg.Event, EVENT, self._readable(EVENT, self._on_event), EVENTS, raw=True)
        self.create_subscription(msg.CommandRecord, COMMAND, self._guarded(self._on_command), EVENTS)
        for topic, message_type in ((DIAGNOSTICS, DiagnosticArray), (LATENESS, msg.LatenessHistogram)):
            received = self._readable(topic, partial(self._on_stamped, topic, message_type))
            self.create_subscription(message_type, topic, received, PLC_INPUT, raw=True)
        received = self._readable(DRIVE_STOPS, self._on_drive_stop)
        self.create_subscription(msg.DriveStop, DRIVE_STOPS, received, EVENTS, raw=True)
        received = self._readable(CHECKPOINTS, self._on_checkpoint)
        self.create_subscription(msg.UnitCheckpoint, CHECKPOINTS, received, STATES_OF_UNITS, raw=True)
        for topic, message_type, quality in observed_topics(machine):
            received = self._guarded(partial(self._on_observed, recorded_topic(topic), type_name(message_type)))
            self.create_subscription(message_type, topic, received, quality, raw=True)
        received = self._readable(ROSOUT, self._on_log)
        self.create_subscription(Log, ROSOUT, received, qos_profile_rosout_default, raw=True)
        RecordingServices(self, lambda: self._recording)
        self._ready_timer = process.timer(self, process.READY_PERIOD, self._report_ready)
        process.timer(self, LOOK_PERIOD, self._guarded(self._look))

    def _subscribe_to_blocks(self) -> Iterator[Subscription[Any]]:
        yield self._subscribe(msg.CycleTick, TICK, chain(decode_tick, self._on_tick))
        for unit, kind in self._units.items():
            take = partial(self._on_block, unit, BLOCK_CLASSES[kind])
            yield self._subscribe(BLOCK_TYPES[kind], block_topic(unit), take)

    def _subscribe(self, message_type: Any, topic: str, received: Callable[[bytes], None]) -> Subscription[Any]:
        return self.poll(message_type, topic, self._guarded(received), BLOCKS)

    def _readable(self, topic: str, received: Callable[[bytes], None]) -> Callable[[bytes], None]:
        return self.readable(topic, self._guarded(received))

    def _guarded(self, callback: Callable[..., None]) -> Callable[..., None]:
        """The callback, whose CncError ends the node."""

        @wraps(callback)
        def call(*arguments: Any) -> None:
            try:
                callback(*arguments)
            except CncError as error:
                if error.number == UNREADABLE_MESSAGE:
                    raise  # for `readable`: the message is left out
                if error.number == NOT_WRITTEN and self._recording is not None:
                    self._recording.fail(error, max(0, self._last_tick))
                else:
                    self.failure = self.failure or error

        return call

    def _publish(self, event: Event) -> None:
        stamp = convert.time_message(self._recorded.stamps.at(event.cycle))
        self._event_publisher.publish(convert.event_to_message(event, stamp))

    def destroy_node(self) -> None:
        self._note_cut()
        for sink in self._sinks:
            try:
                sink.close()
            except CncError as error:  # its events would reach nobody
                self.failure = self.failure or error
        super().destroy_node()

    def _note_cut(self) -> None:
        """Who is held up while the run ends does not get what came last: the recording says so."""
        ended = bool(self._last_plc) and codec_of(PlcBlock).decode(self._last_plc).run_done
        if self._recording is not None and self._ticked_at < self._resumed_at + STALE and not ended:
            end = max(self._next_cycle.values())
            text = f"the recorder was held up for {self._held_for:.1f} s, and the run has ended meanwhile"
            self._guarded(self._recording.note_missing)(f"{text}; what came after cycle {end - 1} is missing")
            self._resumed_at = -inf  # once

    @property
    def has_begun(self) -> bool:
        """With the first tick; a file at its place before that is one of an earlier run."""
        return self._recording is not None

    @property
    def settled(self) -> bool:
        """Nothing has arrived for a while since the clock has ended: it may have to say that drives have braked."""
        if any(each.get_publisher_count() for each in self._needed[:1]):
            self._heard = time.monotonic()
        return time.monotonic() - self._heard > QUIET

    def _report_ready(self) -> None:
        if self._recording is not None:
            self._ready_timer.cancel()
        elif self._handover is not None:
            self._handover.ready.add(RECORDER)
        elif all(subscription.get_publisher_count() for subscription in self._needed):
            self._report(-1)

    def _report(self, first_cycle: int) -> None:
        self._report_publisher.publish(msg.BlockReport(source=RECORDER, first_cycle=first_cycle))

    def _on_tick(self, message: Tick) -> None:
        self._heard = self._ticked_at = time.monotonic()
        self._tick_ns, self._last_tick = message.stamp_ns, message.first_cycle
        if self._recording is None:
            start_ns = self._tick_ns - message.first_cycle * self._cycle_ns
            self._free_run = not message.scheduled_monotonic_ns
            if not self._free_run:
                process.take_priority()
            if self._server is not None:
                self._sinks.append(live_stream(self._server, start_ns, self._cycle_ns))
            self._recording = self._begin(start_ns, message.first_cycle)
            self._sinks.append(self._recording)
            for record in self._early:
                record()
            self._early.clear()
        if message.count:
            tick = CycleTick(message.first_cycle, message.count)
            for sink in self._sinks:
                sink.tick(tick, message.scheduled_monotonic_ns)

    def _begin(self, start_ns: int, first_cycle: int) -> OnDemand:
        """With the first tick."""
        whole_run = None
        if self._path is not None:
            late = without_what(first_cycle)
            times = start_ns, self._cycle_ns
            whole_run = make_recording(
                self._path, self._machine_yaml, *times, self._condition, self._settings, notes=late
            )
        return OnDemand(
            self._machine_yaml,
            Stamps(start_ns, self._cycle_ns),
            self._units,
            current=whole_run,
            first_cycle=first_cycle,
            settings=self._settings,
            snapshots=self._snapshots,
            publish=self._publish,
        )

    def _on_block(self, unit: str, block_class: type, data: bytes) -> None:
        self._heard = time.monotonic()
        if self._recording is None:
            later = self.readable(block_topic(unit), partial(self._on_block, unit, block_class))
            self._early.append(lambda: later(data))
            return
        data = with_plain_header(block_class, data, self._recording.stamps)
        codec_of(block_class).check(data, self._block_cycles)  # what units leave out takes no place of a block
        stamp_ns, first_cycle, count = head_of(data)
        most = max(self._last_tick + self._most_ahead, self._next_cycle[unit])
        if first_cycle > most and time.monotonic() < self._ticked_at + ALONE_AFTER:
            where = f"its first cycle is {first_cycle}, and at most {most} is possible now"
            raise unreadable(block_class.__name__, data, where)
        if unit == PLC:
            self._last_plc = data
        if self._is_new(unit, stamp_ns, first_cycle, count):
            for sink in self._sinks:
                sink.encoded_block(unit, block_class, data)

    def _take_block(self, unit: str, block: CycleBlock) -> None:
        """Of a node of this process; now, because the commands in it get more arguments on their way."""
        self._heard = time.monotonic()
        for sink in self._sinks:  # none: the file could not be opened, and the node fails
            sink.block(unit, block, handshakes=False)

    def _is_new(self, unit: str, stamp_ns: int, cycle: int, count: int) -> bool:
        """False for a block that is recorded already, or that no drive has followed; an event when others are missing.

        A process that was suspended computes what it has missed; its drive has braked meanwhile.
        """
        expected = self._next_cycle[unit]
        if cycle > expected:
            text = f"recorder: blocks of '{unit}' from cycle {expected} to {cycle - 1} are missing in the recording"
            event = Event(cycle, RECORDER, Severity.ERROR, BLOCKS_MISSING, text)
            self._event_publisher.publish(convert.event_to_message(event, convert.time_message(stamp_ns)))
        self._next_cycle[unit] = max(expected, cycle + count)
        return bool(expected <= cycle < self._stopped.get(unit, cycle + 1))

    def _on_event(self, data: bytes) -> None:
        event = convert.event_of(data)
        self._single(lambda sink: sink.event(event))

    def _on_drive_stop(self, data: bytes) -> None:
        message = convert.message_of(data, msg.DriveStop)
        self._stopped[message.unit] = message.first_cycle
        self._on_stamped(DRIVE_STOPS, msg.DriveStop, data)

    def _on_checkpoint(self, data: bytes) -> None:
        """Raises CncError 26184 for one that no unit of the machine has sent."""
        message = convert.message_of(data, msg.UnitCheckpoint)
        try:
            texts = json.loads(message.texts_json)
        except (ValueError, RecursionError):
            texts = None
        if message.unit not in self._units or not isinstance(texts, list) or {*map(type, texts)} - {str}:
            raise unreadable("cnc_ptp/msg/UnitCheckpoint", data, "it is of no unit, or has no list of texts")
        if self._recording is None:
            self._early.append(lambda: self._on_checkpoint(data))
            return
        self._recording.checkpoint_texts({digest_of(text): text for text in texts})
        self._recording.checkpoint(message.next_cycle, message.state.tobytes(), message.unit)

    def _on_command(self, message: msg.CommandRecord) -> None:
        command = convert.message_to_record(message)
        self._single(lambda sink: sink.command(command))

    def _on_stamped(self, topic: str, message_type: Any, data: bytes) -> None:
        """A message with a header that is recorded as it came."""
        stamp_ns = convert.nanoseconds(convert.message_of(data, message_type).header.stamp)
        self._single(lambda sink: sink.raw(recorded_topic(topic), type_name(message_type), data, stamp_ns))

    def _on_observed(self, topic: str, type_name: str, data: bytes) -> None:
        """A PLC may continue to publish when the run has ended, so this does not count as a message of the run."""
        stamp_ns = self._tick_ns if self._free_run else time.time_ns()
        self._keep(lambda sink: sink.raw(topic, type_name, data, stamp_ns))

    def _on_log(self, data: bytes) -> None:
        """The topic is one for all namespaces; messages of nodes of other namespaces are left out."""
        if _namespace(convert.message_of(data, Log).name) == _namespace(self.get_logger().name):
            self._on_observed(ROSOUT, type_name(Log), data)

    def _single(self, record: Callable[[Sink], None]) -> None:
        self._heard = time.monotonic()
        self._keep(record)

    def _keep(self, record: Callable[[Sink], None]) -> None:
        """Records it, or keeps it until the first tick has come."""
        if self._recording is None:
            self._early.append(lambda: self._keep(record))
            return
        for sink in self._sinks:
            record(sink)

    @property
    def _recorded(self) -> OnDemand:
        assert self._recording is not None
        return self._recording

    def _look(self) -> None:
        """Takes the ticks and blocks that have come, and writes when it is time."""
        pause = self._pause.take()
        if pause > LOST_AFTER and self._recording is not None and self._handover is None:
            self._held_for, self._resumed_at = pause, time.monotonic()
        self.take_polled()
        if self._free_run and self._handover is None:
            self._report(self._last_tick)
        for sink in self._sinks:
            sink.flush_if_due(time.monotonic())


def _namespace(logger: str) -> str:
    return logger.rpartition(".")[0]


@click.command()
@node_command_line.MACHINE
@click.argument("output", type=click.Path(), required=False)
@click.option("--when", help="Begin when a field has this value: 'x.set_velocity != 0'.")
@click.option("--split", help="Parts of a size or a time, 500MB or 10min; OUTPUT is a folder.")
@click.option("--compression", type=click.Choice(COMPRESSIONS), default="zstd", help="Of the recording.")
@click.option("--keep", type=float, default=0.0, help="Seconds that are kept in memory for a snapshot.")
@click.option("--snapshots", type=click.Path(), help="Folder for a snapshot at each error.")
@click.option("--snapshot-when", help="A snapshot also when this becomes true: 'x.following_error > 0.1'.")
@click.option("--scenario", type=click.Path(), help="Kept in the recording.")
@click.option("--plc", type=click.Path(), help="Kept in the recording.")
@click.option("--foxglove", type=int, help="Port of a live stream for Foxglove.")
def command(machine: str, output: str | None, foxglove: int | None, **options: Any) -> None:
    """Records the graph of MACHINE to the MCAP file OUTPUT, without it on demand."""

    def make() -> RecorderNode:
        given = RecorderOptions(**options)
        text = machine_text(machine)
        return RecorderNode(read_machine(machine), output, text, options=given, foxglove=foxglove)

    sys.exit(process.run_node(make, name=RECORDER, settled=lambda node: node.settled))


def main() -> None:
    node_command_line.call(command)


if __name__ == "__main__":
    main()
