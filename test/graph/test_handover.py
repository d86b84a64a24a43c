"""Blocks between nodes of one process, the pace of a free run, subscriptions that wake nobody."""

import time

import pytest
from graph_support import small_machine
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from ros_support import ros

from cnc_ptp import msg
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes import free_run, process
from cnc_ptp.nodes.clock import ClockNode
from cnc_ptp.nodes.composed import unit_nodes
from cnc_ptp.nodes.free_run import RECORDER_BLOCKS, FreeRunPace
from cnc_ptp.nodes.handover import Handover
from cnc_ptp.nodes.monitor import RunMonitor
from cnc_ptp.nodes.polling_node import PollingNode
from cnc_ptp.nodes.recorder import RecorderNode
from cnc_ptp.nodes.supervisor import RunOptions
from cnc_ptp.nodes.topics import BLOCKS, MONITOR, RECORDER, REPORT
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import AxisBlock, PlcBlock
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.recorder_options import RecorderOptions
from cnc_ptp.wire.ticks import Tick


def test_nobody_computes_while_another_one_does():
    """A chain plc -> x -> y, each passing on its block while it computes."""
    handover, order = Handover(), []

    def unit(name):
        def look():
            order.append(f"{name} begins")
            handover.block(name, AxisBlock(0, 10))
            order.append(f"{name} ends")

        return look

    handover.on_tick(lambda tick: order.append(f"tick {tick.first_cycle}"), unit("plc"))
    handover.on_block("plc", lambda block: order.append("x takes"), unit("x"))
    handover.on_block("x", lambda block: order.append("y takes"), unit("y"))
    handover.tick(Tick(0, 10, 0, 0))
    assert order == [
        *("tick 0", "plc begins", "x takes", "plc ends"),
        *("x begins", "y takes", "x ends", "y begins", "y ends"),
    ]


def test_who_comes_later_gets_the_newest_block():
    """A slave that is coupled to a master which has computed already."""
    handover, taken = Handover(), []
    for first_cycle in (0, 10):
        handover.block("x", AxisBlock(first_cycle, 10))
    handover.on_block("x", lambda block: taken.append(block.first_cycle))
    handover.block("x", AxisBlock(20, 10))
    assert taken == [10, 20]
    handover.block("y", AxisBlock(10, 10))
    assert handover.have_computed(("x", "y"), 10) and not handover.have_computed(("x", "y"), 20)


def test_a_unit_without_its_first_block_holds_up_the_run():
    handover = Handover()
    assert handover.have_computed((PLC, "x"), -10) and not handover.have_computed((PLC, "x"), 0)
    handover.block(PLC, PlcBlock(0, 10))
    assert not handover.have_computed((PLC, "x"), 0)
    handover.block("x", AxisBlock(0, 10))
    assert handover.have_computed((PLC, "x"), 0) and not handover.have_computed((PLC, "x"), 10)


def test_a_late_composed_run_gives_the_executor_a_turn_after_each_tick(tmp_path):
    """A tick computes the whole machine there: timers, services and signals must not wait until the run is in time."""
    with ros():
        machine = read_machine(str(small_machine(tmp_path)))
        handover, ticks = Handover(), []
        handover.on_tick(lambda tick: ticks.append(tick.first_cycle), lambda: None)
        clock = ClockNode(machine, handover=handover)
        clock.advance()
        for unit in unit_kinds(machine):
            assert clock._started_at is None
            handover.ready.add(unit)
            clock.advance()
        clock._started_at -= 1.0  # a hundred ticks are due
        for turn in range(1, 4):
            clock.advance()
            assert len(ticks) == turn and clock.wait_time() == 0.0
        clock.destroy_node()


def test_nodes_of_one_process_are_ready_without_a_message(tmp_path):
    path = small_machine(tmp_path)
    machine, handover, told = read_machine(str(path)), Handover(), []
    options = RunOptions(str(path), stay=True)
    with ros():
        outside = Node("outside", enable_rosout=False)
        outside.create_subscription(msg.BlockReport, f"/{REPORT}", told.append, BLOCKS)
        nodes = [
            outside,
            RunMonitor(machine, handover=handover),
            *unit_nodes(machine, options, handover=handover),
            RecorderNode(
                machine, str(tmp_path / "run.mcap"), path.read_text(), options=RecorderOptions(), handover=handover
            ),
        ]
        wanted = {*unit_kinds(machine), MONITOR, RECORDER}
        end = time.monotonic() + 30.0
        process.spin(nodes, done=lambda: handover.ready == wanted or time.monotonic() > end, wait=lambda: 0.01)
    assert (handover.ready, told) == (wanted, [])


def test_an_error_of_one_node_does_not_stop_the_others():
    handover, looks = Handover(), []

    def fail():
        raise ValueError("x")

    handover.on_tick(lambda tick: None, fail)
    handover.on_tick(lambda tick: None, lambda: looks.append(1))
    with pytest.raises(ValueError, match="x"):
        handover.tick(Tick(0, 10, 0, 0))
    with pytest.raises(ValueError, match="x"):
        handover.tick(Tick(10, 10, 0, 0))
    assert looks == [1]


class Silences:
    """Stands for a watchdog: `names` are silent."""

    def __init__(self):
        self.names = set()

    def silent(self, names, *, begun):
        return [name for name in names if name in self.names]

    def restart(self):
        pass


def test_a_free_run_waits_for_plc_and_recorder():
    pace = FreeRunPace([PLC, RECORDER, "x"], block_cycles=10, block_time=0.01, watchdog=Silences())
    assert pace.may_tick(0) and not pace.may_tick(10)
    pace.heard("x", 0)
    assert not pace.may_tick(10)
    pace.heard(PLC, 0)
    assert pace.may_tick(10) and not pace.may_tick(20)
    for first_cycle in range(10, 10 * RECORDER_BLOCKS, 10):
        pace.heard(PLC, first_cycle)
    last = 10 * RECORDER_BLOCKS
    assert pace.may_tick(last - 10) and not pace.may_tick(last)
    pace.heard(RECORDER, 9)
    assert pace.may_tick(last)


def test_a_free_run_goes_on_without_those_who_are_silent(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(free_run.time, "monotonic", lambda: now[0])
    silences = Silences()
    pace = FreeRunPace([PLC, "x"], block_cycles=10, block_time=0.01, watchdog=silences)
    pace.ticked()
    assert not pace.may_tick(10)
    silences.names = {PLC}
    assert not pace.may_tick(10), "now it is known to be silent"
    assert not pace.may_tick(10), "in real time"
    now[0] += 0.01
    assert pace.may_tick(10)
    pace.heard(PLC, 0)
    assert pace.may_tick(10) and not pace.may_tick(20), "it is back"


def test_messages_are_taken_in_their_order_when_the_node_looks():
    with ros():
        writer, reader, seen = Node("writer", enable_rosout=False), PollingNode("reader", enable_rosout=False), []
        publisher = writer.create_publisher(msg.BlockReport, "polled", BLOCKS)
        polled = reader.poll(msg.BlockReport, "polled", seen.append, BLOCKS)
        assert polled not in list(reader.subscriptions)
        executor = process.EventsExecutor()
        executor.add_node(reader)
        while not publisher.get_subscription_count():
            executor.spin_once(timeout_sec=0.01)
        for number in range(5):
            publisher.publish(msg.BlockReport(first_cycle=number))
        for _ in range(20):
            executor.spin_once(timeout_sec=0.01)
        assert seen == []
        reader.take_polled()
        reader.take_polled()
        read = [deserialize_message(data, msg.BlockReport).first_cycle for data in seen]
        assert read == list(range(5))
        executor.shutdown()
