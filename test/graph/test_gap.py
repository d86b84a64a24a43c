"""A clock that leaves out a tick, and other faults of what arrives: the axis stops automatically, no cycle is left out."""

import time

import numpy as np
import pytest
from graph_support import PTP
from rclpy.node import Node
from ros_support import ros
from spin_support import spin_until

from cnc_ptp import msg
from cnc_ptp.nodes import process
from cnc_ptp.nodes.axis import AxisNode
from cnc_ptp.nodes.topics import BLOCKS, COMMAND, EVENT, EVENTS, TICK, block_topic
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.blocks import Command, PlcBlock
from cnc_ptp.wire.block_codec import encode_block
from cnc_ptp.wire.stamps import Stamps

WATCHDOG = 0.2
STAMPS = Stamps(0, 1_000_000)
"""s, of ptp.yaml"""
MOVE = {"target": 100.0, "velocity": 200.0}


class Surroundings(Node):
    """Clock and PLC in the hands of a test, around one axis node."""

    def __init__(self):
        super().__init__("surroundings", enable_rosout=False, start_parameter_services=False)
        self.ticks = self.create_publisher(msg.CycleTick, TICK, BLOCKS)
        self.plc = self.create_publisher(msg.PlcBlock, block_topic("plc"), BLOCKS)
        self.blocks, self.events, self.records = [], [], []
        self.create_subscription(msg.AxisBlock, block_topic("x"), self.blocks.append, BLOCKS)
        self.create_subscription(msg.Event, EVENT, self.events.append, EVENTS)
        self.create_subscription(msg.CommandRecord, COMMAND, self.records.append, EVENTS)

    def tick(self, first_cycle, count=10):
        self.ticks.publish(msg.CycleTick(first_cycle=first_cycle, count=count))

    def plc_block(self, first_cycle, commands=()):
        block = PlcBlock(first_cycle, 10, life_sign=first_cycle, commands=list(commands))
        self.plc.publish(encode_block(block, STAMPS))

    def samples(self, field):
        return np.concatenate([getattr(block, field) for block in self.blocks])


class Bench:
    def __init__(self):
        self.outside = Surroundings()
        self.axis = AxisNode(read_machine(str(PTP)), "x")
        self.axis.setup()
        self.executor = process.EventsExecutor()
        for node in (self.outside, self.axis):
            self.executor.add_node(node)
        publishers = (self.outside.ticks, self.outside.plc, self.axis._publications.blocks)
        self.spin_until(lambda: all(publisher.get_subscription_count() for publisher in publishers))

    def spin_until(self, condition):
        spin_until(self.executor, condition)

    def run_blocks(self, number):
        """So many blocks in good order, the move in the first one."""
        for first_cycle in range(0, 10 * number, 10):
            self.outside.tick(first_cycle)
            self.outside.plc_block(first_cycle, [] if first_cycle else [Command("x", "move_absolute", MOVE, 1)])
        self.spin_until(lambda: len(self.outside.blocks) >= number)

    def wait_for_standstill(self):
        self.spin_until(lambda: self.outside.blocks[-1].state[-1] == AxisStateCode.ERROR_STOP)
        self.spin_until(lambda: self.outside.blocks[-1].set_velocity[-1] == 0.0)

    def close(self):
        for node in (self.axis, self.outside):
            node.destroy_node()
        self.executor.shutdown()


@pytest.fixture
def bench():
    with ros():
        bench = Bench()
        yield bench
        bench.close()


def check_smooth(outside):
    """Every cycle once, and no step in position or velocity."""
    cycles = np.concatenate([range(block.first_cycle, block.first_cycle + block.count) for block in outside.blocks])
    assert cycles.tolist() == list(range(len(cycles)))
    assert np.abs(np.diff(outside.samples("set_position"))).max() <= 0.2 + 1e-9
    assert np.abs(np.diff(outside.samples("set_acceleration"))).max() <= 10_000.0 * 1e-3 * 10.0 + 1e-6


def errors(outside):
    return [(event.error_id, event.text) for event in outside.events if event.severity == 2]


def test_a_missing_tick_ends_in_a_controlled_stop(bench):
    bench.run_blocks(30)
    bench.outside.tick(310)
    bench.wait_for_standstill()
    check_smooth(bench.outside)
    assert errors(bench.outside) == [
        (26102, "x: tick 300 of the clock is missing, 310 came"),
        (
            26101,
            "axis x: no block of 'clock' came within the watchdog time; the axis stops on its own ramp (ErrorStop)",
        ),
    ]
    lost = [(record.cycle, record.command, record.arguments_json) for record in bench.outside.records[1:]]
    assert lost == [(300, "upstream_lost", '{"source": "clock"}')]
    assert bench.outside.blocks[-1].error_id[-1] == 26101
    assert bench.axis.diagnostics.lost_blocks == 1


def test_a_missing_block_ends_in_a_controlled_stop(bench):
    bench.run_blocks(30)
    for first_cycle in range(300, 800, 10):
        bench.outside.tick(first_cycle)
        if first_cycle != 300:
            bench.outside.plc_block(first_cycle)
    bench.wait_for_standstill()
    check_smooth(bench.outside)
    assert errors(bench.outside)[0] == (26102, "x: block 300 of 'plc' is missing, a later one came")
    assert bench.outside.records[-1].arguments_json == '{"source": "plc"}'


def test_silence_of_the_plc_ends_in_a_controlled_stop(bench):
    bench.run_blocks(30)
    for first_cycle in range(300, 800, 10):
        bench.outside.tick(first_cycle)
    bench.wait_for_standstill()
    check_smooth(bench.outside)
    assert [error_id for error_id, _ in errors(bench.outside)] == [26101]


def test_silence_of_the_clock_ends_in_a_controlled_stop(bench):
    bench.run_blocks(30)
    bench.wait_for_standstill()
    check_smooth(bench.outside)
    assert bench.outside.records[-1].arguments_json == '{"source": "clock"}'


def test_a_first_block_may_take_long(bench):
    """Processes that have just started are slow, and nothing has moved yet: the watchdog waits ten times as long."""
    bench.outside.tick(0)
    late = time.monotonic() + 3.0 * WATCHDOG
    bench.spin_until(lambda: time.monotonic() > late)
    assert bench.outside.blocks == [] and errors(bench.outside) == []
    bench.outside.plc_block(0)
    bench.spin_until(lambda: len(bench.outside.blocks) == 1)
    assert errors(bench.outside) == []


def test_a_first_block_that_does_not_come_is_lost(bench, monkeypatch):
    monkeypatch.setattr(process, "START_PATIENCE", 0.0)
    bench.outside.tick(0)
    bench.spin_until(lambda: bench.outside.blocks)
    assert [(event.error_id, event.cycle) for event in bench.outside.events if event.severity == 2] == [(26101, 0)]


def test_a_sign_of_life_keeps_a_waiting_axis_from_stopping(bench):
    """A source that works long (a big program is interpreted) says so, and nobody stops."""
    bench.run_blocks(30)
    heartbeat = bench.outside.create_publisher(msg.BlockReport, "/heartbeat", BLOCKS)
    bench.spin_until(heartbeat.get_subscription_count)
    signs = 0

    def sign():
        nonlocal signs
        signs += 1
        heartbeat.publish(msg.BlockReport(source="clock", first_cycle=300))

    bench.outside.create_timer(0.04, sign)
    bench.spin_until(lambda: signs == 15)  # three times the watchdog time
    assert errors(bench.outside) == []
    bench.outside.tick(300)
    bench.outside.plc_block(300)
    bench.spin_until(lambda: len(bench.outside.blocks) == 31)
    assert errors(bench.outside) == []


def test_what_comes_twice_is_computed_once(bench):
    bench.run_blocks(3)
    bench.outside.tick(20)
    bench.outside.plc_block(20)
    bench.outside.tick(30)
    bench.outside.plc_block(30)
    bench.spin_until(lambda: len(bench.outside.blocks) == 4)
    assert [block.first_cycle for block in bench.outside.blocks] == [0, 10, 20, 30]
    assert bench.axis._gate.duplicates == 2
    text = "x: block 20 of '{0}' came twice, the first one counts; is there a second '{0}'?"
    bench.spin_until(lambda: len(errors(bench.outside)) == 2)
    assert sorted(errors(bench.outside)) == [(26142, text.format("clock")), (26142, text.format("plc"))]
    status = bench.axis.diagnostics.status(bench.axis._gate.duplicates)
    assert (status.level, status.message) == (b"\x02", "2 blocks came twice")


def test_a_command_before_the_first_tick_is_refused(bench):
    record = bench.axis.command(Command("x", "move_absolute", MOVE))
    text = "axis x: move_absolute refused: the run has not begun; nothing was changed"
    assert (record.error_id, record.message) == (26207, text)
    assert (record.accepted, record.cycle) == (False, 0)
    bench.run_blocks(1)
    assert bench.axis.command(Command("x", "halt", {})).error_id != 26207


def test_the_last_tick_ends_the_run_after_the_blocks_before_it(bench):
    bench.run_blocks(3)
    bench.outside.tick(30)
    bench.outside.tick(40, count=0)
    bench.spin_until(lambda: len(bench.axis._gate._ticks) == 1)
    bench.outside.plc_block(30)
    bench.spin_until(lambda: len(bench.outside.blocks) == 4)
    record = bench.axis.command(Command("x", "move_absolute", MOVE))
    assert (record.accepted, record.error_id) == (False, 26115)
    assert record.message == "axis x: move_absolute refused: the run has ended; nothing was changed"
    bench.spin_until(lambda: bench.outside.records[-1].error_id == 26115)
