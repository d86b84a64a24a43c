"""`clock MACHINE.yaml`: issues the ticks, paced by the wall or as fast as every node reports back (free run)."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable
from typing import Any

import click

from cnc_ptp import msg
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes import node_command_line, process
from cnc_ptp.nodes.convert import message_of
from cnc_ptp.nodes.drive_watch import FAREWELL, DriveWatch
from cnc_ptp.nodes.free_run import FreeRunPace
from cnc_ptp.nodes.handover import Handover
from cnc_ptp.nodes.polling_node import PollingNode, chain
from cnc_ptp.nodes.topics import BLOCKS, HEARTBEAT, MONITOR, REPORT, TICK, block_topic
from cnc_ptp.nodes.watchdog import Watchdog
from cnc_ptp.number_range import DURATION
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.protocol.blocks import PlcBlock
from cnc_ptp.protocol.unit import CLOCK, PLC
from cnc_ptp.wire.block_codec import codec_of
from cnc_ptp.wire.stamps import Stamps
from cnc_ptp.wire.ticks import Tick, encode_tick

POLL = 0.02
TURN = 0.05
"""Seconds between two turns of the executor of a clock in real time."""
SLICE = 0.005
"""Seconds of a free run in one process between two turns of the executor."""
START_DELAY = 0.1
"""Seconds between the last ready node and the first tick: writers and readers find each other in both directions."""
SECOND_CLOCK = 26109
SECOND_NODE = 26140


class ClockNode(PollingNode):
    """The clock of the graph.

    Publishes /clock/tick (CycleTick). Subscriptions: /clock/report, /heartbeat (BlockReport), /plc/block (PlcBlock, for
    the end). In a process of its own it has the watchdogs of the drives, too (DriveWatch): /<unit>/block of each axis
    and spindle, /drive_stops and /events of those that have braked.
    Starts when every expected node has reported that it is ready; ends when the PLC ends the run or after `duration`.
    A node that is silent for the watchdog time no longer holds up a free run. While a free run waits, /heartbeat says
    that the clock is alive.
    The stamp of a cycle is the time at which it counts: the instant of the first tick plus one cycle time for each
    cycle since. Likewise in free run, so that stamps are ahead of the wall clock there, as far as the run is faster.
    """

    def __init__(
        self,
        machine: MachineParameters,
        *,
        wait_for: Iterable[str] = (),
        free_run: bool = False,
        cycles: int | None = None,
        handover: Handover | None = None,
    ) -> None:
        """`wait_for`: nodes besides the units that must be ready first. `cycles`: None = the PLC ends the run.

        `handover`: to and from the other nodes of this process.
        """
        super().__init__(CLOCK, enable_rosout=False)
        self._units = {*unit_kinds(machine)}
        self._expected = {*self._units, *wait_for}
        self._free_run = free_run
        self._cycles = cycles
        self._count = machine.block_cycles
        self._cycle_ns = machine.cycle_time_us * 1000
        self._block_time = machine.block_cycles * machine.cycle_time_us * 1e-6
        self._first_cycle = 0
        self._ready: set[str] = set() if handover is None else handover.ready
        self._watchdog = Watchdog(self._expected - {MONITOR}, seconds=machine.watchdog_ms / 1000.0)
        self._pace = FreeRunPace(
            self._expected, block_cycles=self._count, block_time=self._block_time, watchdog=self._watchdog
        )
        self._started_at: float | None = None
        self._start_ns = 0
        self._ended_at: float | None = None
        self._heartbeat_at = 0.0
        self._publisher = self.create_publisher(msg.CycleTick, TICK, BLOCKS)
        self._heartbeat_publisher = self.create_publisher(msg.BlockReport, HEARTBEAT, BLOCKS)
        self.create_subscription(msg.BlockReport, REPORT, self._on_report, BLOCKS)
        self._handover = handover
        self._plc = None
        self._turn = min(TURN, self._watchdog.seconds / 4.0) if handover is None else 0.0
        self._drives = None
        """In one process drives end together with all that could still be recorded."""
        if handover is None:
            self._drives = DriveWatch(self, machine)
            self.poll_input(msg.BlockReport, HEARTBEAT, self._take_heartbeat, BLOCKS)
        else:
            self.create_subscription(msg.BlockReport, HEARTBEAT, self._on_heartbeat, BLOCKS)
        self._must_settle = self._ends = False
        take = chain(codec_of(PlcBlock).decode, self._on_plc)
        if handover is not None:
            handover.on_block(PLC, self._on_plc)
        elif free_run:
            received = self.readable(block_topic(PLC), take)
            self._plc = self.create_subscription(msg.PlcBlock, block_topic(PLC), received, BLOCKS, raw=True)
        else:
            self._plc = self.poll(msg.PlcBlock, block_topic(PLC), take, BLOCKS)

    @property
    def done(self) -> bool:
        ended = self._ended_at is not None and time.monotonic() - self._ended_at > FAREWELL
        return ended and (not self._must_settle or self._drives_settled())

    def end_settled(self) -> bool:
        """After a signal to end: issues no more ticks; True when no drive is left in motion."""
        self._ends = True
        return self._started_at is None or self._drives_settled()

    def _drives_settled(self) -> bool:
        return self._drives is None or self._drives.settled(self._stamps)

    @property
    def _stamps(self) -> Stamps:
        return Stamps(self._start_ns, self._cycle_ns)

    def wait_time(self) -> float:
        """Seconds until there is something to do without a message."""
        if self._started_at is None or self._ended_at is not None or self._ends:
            return POLL
        if self._free_run:
            return self._pace.wait_time(POLL) if self._handover is None else 0.0
        return max(0.0, self._due_at() - time.monotonic())

    def advance(self) -> None:
        """Issues the ticks that are due."""
        self.take_polled()
        if self._ended_at is not None or self._ends:
            return
        if self._drives is not None and self._first_cycle:
            self._drives.look(self._stamps, begun=self._first_cycle > self._count)
        if self._started_at is None:
            self._start_when_ready()
        elif time.monotonic() < self._started_at:
            return
        elif self._free_run and self._handover is not None:
            self._run_freely(self._handover)
        elif self._free_run:
            if self._pace.may_tick(self._first_cycle):
                self._tick(0)
            elif time.monotonic() - self._heartbeat_at > self._watchdog.seconds / 4.0:
                self._publish_heartbeat()
        else:
            self._tick_in_time()

    def _tick_in_time(self) -> None:
        """Issues what is due; a clock in its own process sleeps between ticks: its executor has few turns.

        Where a tick computes the machine, each one is followed by a turn of the executor, however late the run is.
        """
        turn = time.monotonic() + self._turn
        while self._ended_at is None:
            if time.monotonic() >= self._due_at():
                self._tick(int(self._due_at() * 1e9))
            elif self._due_at() < turn:
                time.sleep(max(0.0, self._due_at() - time.monotonic()))
                self.take_polled()
            else:
                return
            if time.monotonic() >= turn:
                return

    def _run_freely(self, handover: Handover) -> None:
        """Ticks for a while; then the executor has its turn."""
        end = time.monotonic() + SLICE
        while self._ended_at is None and time.monotonic() < end:
            if not handover.have_computed(self._units, self._first_cycle - self._count):
                return
            self._tick(0)

    def _due_at(self) -> float:
        return (self._started_at or 0.0) + self._first_cycle // self._count * self._block_time

    def _start_when_ready(self) -> None:
        if not self._expected <= self._ready:
            return
        if self.count_publishers(self._publisher.topic_name) > 1:
            raise CncError(SECOND_CLOCK, "another clock is on this ROS domain", "this one ends, nothing was started")
        self._require_one_node_each()
        if self._plc is None or (
            self._plc.get_publisher_count() and process.is_read(self, self._publisher, self._expected - {MONITOR})
        ):
            if not self._free_run:
                process.take_priority()
            self._start_ns = time.time_ns() + round(START_DELAY * 1e9)
            self._started_at = time.monotonic() + START_DELAY
            if self._drives is not None:
                self._drives.restart()

    def _require_one_node_each(self) -> None:
        """Raises CncError 26140 when two nodes have a unit: on two computers no claim (claim.py) keeps them apart."""
        for unit in sorted(self._units):
            writers = self.get_publishers_info_by_topic(self.resolve_topic_name(block_topic(unit)))
            if len(writers) > 1:
                nodes = " and ".join(sorted(f"{w.node_namespace.rstrip('/')}/{w.node_name}" for w in writers))
                reason = f"{len(writers)} nodes have the unit '{unit}' ({nodes})"
                raise CncError(SECOND_NODE, reason, "the clock ends, nothing was started. End all but one of them")

    def _tick(self, scheduled_ns: int) -> None:
        if self._cycles is not None and self._first_cycle >= self._cycles:
            self._publish_tick(0, 0)
            self._end()
            return
        self._publish_tick(self._count, scheduled_ns)
        self._first_cycle += self._count
        self._pace.ticked()

    def _publish_tick(self, count: int, scheduled_ns: int) -> None:
        stamp_ns = self._start_ns + self._first_cycle * self._cycle_ns
        if self._handover is None or self._publisher.get_subscription_count():
            self._publisher.publish(encode_tick(self._first_cycle, count, scheduled_ns, stamp_ns))
        if self._handover is not None:
            self._handover.tick(Tick(self._first_cycle, count, scheduled_ns, stamp_ns))
        self._heartbeat_at = time.monotonic()

    def _publish_heartbeat(self) -> None:
        self._heartbeat_publisher.publish(msg.BlockReport(source=CLOCK, first_cycle=self._first_cycle))
        self._heartbeat_at = time.monotonic()

    def _on_report(self, message: msg.BlockReport) -> None:
        if message.first_cycle < 0:
            self._ready.add(message.source)
        elif self._watchdog.heard(message.source):
            self._pace.heard(message.source, message.first_cycle)

    def _take_heartbeat(self, data: bytes) -> None:
        """With the blocks, so that whoever lives has been heard before the silent ones are looked for."""
        self._on_heartbeat(message_of(data, msg.BlockReport))

    def _on_heartbeat(self, message: msg.BlockReport) -> None:
        self._watchdog.heard(message.source)
        if self._drives is not None:
            self._drives.heard(message.source)

    def _on_plc(self, block: Any) -> None:
        self._watchdog.heard(PLC)
        self._pace.heard(PLC, block.first_cycle)
        if block.run_done:
            self._must_settle = True
            self._end()

    def _end(self) -> None:
        if self._ended_at is None:
            self._ended_at = time.monotonic()


def cycles_of(machine: MachineParameters, duration: float | None) -> int | None:
    """Cycles of a run of `duration` seconds, None when the run ends automatically."""
    return None if duration is None else round(duration * 1e6 / machine.cycle_time_us)


@click.command()
@node_command_line.MACHINE
@click.option("--duration", type=DURATION, help="End after this many seconds; default: when everything is finished.")
@click.option("--wait-for", multiple=True, help="Node besides the units that must be ready first, e.g. recorder.")
@click.option("--free-run", is_flag=True, help="As fast as all nodes report their blocks.")
def command(machine: str, duration: float | None, wait_for: tuple[str, ...], free_run: bool) -> None:
    """Runs the clock of MACHINE as a ROS node."""

    def make() -> ClockNode:
        parameters = read_machine(machine)
        return ClockNode(parameters, wait_for=wait_for, free_run=free_run, cycles=cycles_of(parameters, duration))

    status = process.run_node(
        make,
        name=CLOCK,
        done=lambda node: node.done,
        settled=lambda node: node.end_settled(),
        wait=lambda node: node.wait_time(),
        after=lambda node: node.advance(),
    )
    sys.exit(status)


def main() -> None:
    node_command_line.call(command)


if __name__ == "__main__":
    main()
