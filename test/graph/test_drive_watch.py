"""The watchdogs of simulated drives: an axis or spindle whose process says nothing any more brakes on its own."""

import os
import re
import signal
import time
from dataclasses import replace

import numpy as np
import pytest
import rclpy
from graph_support import MILL, PTP, Running, kill, one_axis_machine, verified, wait_until_gone
from ros_support import ros
from spin_support import spin_until

from cnc_ptp import msg
from cnc_ptp.errors import CncError
from cnc_ptp.nodes import drive_watch, process
from cnc_ptp.nodes.axis import AxisNode
from cnc_ptp.nodes.clock import ClockNode
from cnc_ptp.nodes.drive_watch import DriveWatch
from cnc_ptp.nodes.handover import Handover
from cnc_ptp.nodes.polling_node import PollingNode
from cnc_ptp.nodes.topics import BLOCKS, DRIVE_STOPS, EVENT, EVENTS, block_topic
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import AxisBlock, SpindleBlock
from cnc_ptp.protocol.unit import UPSTREAM_LOST
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.wire.block_codec import encode_block
from cnc_ptp.wire.stamps import Stamps

STAMPS = Stamps(1_000_000_000, 1_000_000)
"""Of PTP and MILL, whose watchdog time is 0.2 s."""
FLOATS, INTEGERS, BOOLEANS = [0.0] * 10, [0] * 10, [False] * 10


class Bus:
    """A drive watch with units whose blocks a test writes."""

    def __init__(self, machine, *units):
        self.node = PollingNode("clock", enable_rosout=False)
        self.outside = rclpy.create_node("outside", enable_rosout=False, start_parameter_services=False)
        self.watch = DriveWatch(self.node, read_machine(str(machine)))
        self.stops, self.events = [], []
        self.outside.create_subscription(msg.DriveStop, DRIVE_STOPS, self.stops.append, EVENTS)
        self.outside.create_subscription(msg.Event, EVENT, self.events.append, EVENTS)
        types = {"s": msg.SpindleBlock}
        self.writers = {
            unit: self.outside.create_publisher(types.get(unit, msg.AxisBlock), block_topic(unit), BLOCKS)
            for unit in units
        }
        self.executor = process.EventsExecutor()
        for node in (self.node, self.outside):
            self.executor.add_node(node)
        self.spin_until(lambda: all(writer.get_subscription_count() for writer in self.writers.values()))
        self.watch.longest_pause = 5.0  # a slow computer is another matter
        self.watch.restart()

    def axis(self, unit, first_cycle, position, velocity, master="", error=0):
        block = AxisBlock(first_cycle, 10, *(FLOATS for _ in range(15)), *(INTEGERS for _ in range(3)))
        block.actual_position = [position - velocity * 1e-3 * (9 - n) for n in range(10)]
        block.set_velocity = block.actual_velocity = [velocity] * 10
        block.master = master
        block.error_id = [error] * 10
        self.write(unit, block)

    def spindle(self, speed, gear=1):
        block = SpindleBlock(0, 10, *(FLOATS for _ in range(11)), INTEGERS, INTEGERS, [gear] * 10)
        for name in ("speed_reached", "speed_zero", "in_position", "referenced", "gear_change_active"):
            setattr(block, name, BOOLEANS)
        block.status_bits = block.state = block.error_id = INTEGERS
        block.set_speed_rpm = block.actual_speed_rpm = [speed] * 10
        self.write("s", block)

    def write(self, unit, block):
        self.writers[unit].publish(encode_block(block, STAMPS))

    def look(self):
        self.watch.look(STAMPS, begun=True)
        return bool(self.stops)

    def spin_until(self, condition):
        spin_until(self.executor, condition)

    def stop_of(self, unit):
        self.spin_until(lambda: self.look() and any(stop.unit == unit for stop in self.stops) and self.events)
        return next(stop for stop in self.stops if stop.unit == unit)

    def texts(self):
        return {(event.error_id, event.text) for event in self.events}

    def close(self):
        for node in (self.node, self.outside):
            node.destroy_node()
        self.executor.shutdown()


@pytest.fixture
def bus(request):
    with ros():
        bus = Bus(*request.param)
        yield bus
        bus.close()


@pytest.mark.parametrize("bus", [(PTP, "x", "y")], indirect=True)
def test_a_silent_axis_brakes_from_its_newest_block(bus):
    """100 mm/s with a jerk of 50 m/s³, far from 50 m/s²: 2√(v/J) = 89.4 ms, v√(v/J) = 4.4721 mm."""
    bus.axis("x", 0, 1.0, 50.0)
    bus.axis("x", 10, 2.0, 100.0)
    stop = bus.stop_of("x")
    assert stop.first_cycle == 20 and len(stop.actual_position) == len(stop.actual_velocity) == 90
    assert stop.actual_position[-1] == pytest.approx(6.4721, abs=1e-4) and stop.actual_velocity[-1] == 0.0
    assert np.diff([100.0, *stop.actual_velocity]).max() <= 0.0
    assert (stop.header.stamp.sec, stop.header.stamp.nanosec) == (1, 20_000_000)
    (event,) = bus.events
    assert (event.source, event.severity, event.cycle, event.error_id) == ("clock", 2, 20, 26265)
    assert event.text == (
        "drive of axis x: no setpoint came after cycle 19 within its watchdog time of 0.2 s; it has braked on its own from"
        " 100.0000 mm/s with 50000 mm/s² to a standstill at 6.4721 mm"
    )
    assert {(value.name, value.unit) for value in event.values} == {
        ("velocity", "mm/s"),
        ("deceleration", "mm/s²"),
        ("place", "mm"),
    }


@pytest.mark.parametrize("bus", [(PTP, "x", "y", "z")], indirect=True)
def test_a_clock_that_was_held_up_knows_no_drive_until_it_hears_of_its_unit_again(bus):
    """x says nothing any more, z lives on and dies later."""
    bus.watch.longest_pause = 0.2
    for unit in "xyz":
        bus.axis(unit, 0, 1.0, 50.0)
    bus.spin_until(lambda: not bus.look() and bus.watch._newest.keys() == {"x", "y", "z"})
    time.sleep(0.5)
    assert not bus.look()
    bus.watch.longest_pause = 5.0
    bus.spin_until(lambda: not bus.look() and not bus.watch._on_probation())
    bus.axis("z", 500, 3.0, 50.0)
    stop = bus.stop_of("z")
    assert stop.first_cycle == 510
    silent_until = time.monotonic() + 0.5
    bus.spin_until(lambda: bus.look() and time.monotonic() > silent_until)
    assert [each.unit for each in bus.stops] == ["z"]


@pytest.mark.parametrize("bus", [(PTP, "x", "y")], indirect=True)
def test_a_clock_that_was_held_up_ends_when_units_have_stopped_without_it(bus):
    for unit in "xy":
        bus.axis(unit, 0, 1.0, 50.0)
    bus.spin_until(lambda: not bus.look() and bus.watch._newest.keys() == {"x", "y"})
    bus.watch.longest_pause = 0.4
    time.sleep(0.5)
    bus.axis("y", 500, 2.0, 10.0, error=UPSTREAM_LOST)
    with pytest.raises(CncError) as refused:
        bus.spin_until(lambda: bus.look() and False)
    held = f"P-ERR-26268 clock: it was held up for {bus.watch._held_for:.1f} s"
    text = f"{held}, and units have stopped without it: y; the clock ends, and the run with it"
    assert str(refused.value) == text
    assert 0.4 < bus.watch._held_for < 5.0


@pytest.mark.parametrize("bus", [(PTP, "x", "y")], indirect=True)
def test_units_that_have_lost_others_do_not_end_a_clock_that_was_held_up_before(bus):
    for unit in "xy":
        bus.axis(unit, 0, 1.0, 50.0)
    bus.spin_until(lambda: not bus.look() and bus.watch._newest.keys() == {"x", "y"})
    bus.watch._resumed_at = time.monotonic() - 2.0
    bus.axis("y", 10, 2.0, 10.0, error=UPSTREAM_LOST)
    stop = bus.stop_of("y")
    assert stop.first_cycle == 20


@pytest.mark.parametrize("bus", [(PTP, "x", "y")], indirect=True)
def test_the_drives_of_a_group_brake_on_the_ramps_of_the_others(bus):
    bus.axis("y", 0, 0.0, 0.0, master="x")
    bus.axis("x", 0, 0.0, 2000.0)
    stop = bus.stop_of("x")
    assert np.diff(stop.actual_velocity).min() == pytest.approx(-5.0), "5 m/s², not 50"


@pytest.mark.parametrize("bus", [(PTP, "x")], indirect=True)
def test_a_drive_that_stands_only_says_so(bus):
    bus.axis("x", 0, 3.5, 0.0)
    stop = bus.stop_of("x")
    assert (stop.first_cycle, [*stop.actual_position], [*stop.actual_velocity]) == (10, [3.5], [0.0])
    text = "drive of axis x: no setpoint came after cycle 9 within its watchdog time of 0.2 s; it stands at 3.5000 mm"
    assert bus.texts() == {(26266, text)}


@pytest.mark.parametrize("bus", [(MILL, "s")], indirect=True)
def test_a_silent_spindle_brakes_in_its_gear(bus):
    """600 rpm = 3600 deg/s with 72000 deg/s²: 50 ms, 90 deg."""
    bus.spindle(600.0)
    stop = bus.stop_of("s")
    assert len(stop.actual_position) == 50 and stop.actual_position[-1] == pytest.approx(90.0)
    assert bus.texts() == {
        (
            26265,
            "drive of spindle s: no setpoint came after cycle 9 within its watchdog time of 0.2 s; it has braked on its own"
            " from 3600.0000 deg/s with 72000 deg/s² to a standstill at 90.0000 deg",
        )
    }


@pytest.mark.parametrize("bus", [(PTP, "x", "y")], indirect=True)
def test_a_unit_that_says_that_it_lives_is_left_alone(bus):
    """It waits for somebody else; a unit that has never sent a block has not moved."""
    bus.axis("x", 0, 0.0, 10.0)
    bus.axis("y", 0, 0.0, 10.0)

    def look():
        bus.watch.heard("x")
        return bus.look()

    bus.spin_until(lambda: look() and bus.events)
    assert [stop.unit for stop in bus.stops] == ["y"]


@pytest.mark.parametrize("bus", [(PTP, "x")], indirect=True)
def test_a_block_that_cannot_be_read_does_not_end_the_watch(bus):
    """The drive brakes from the last one that could be read; an empty block says nothing about it."""
    bus.axis("x", 0, 1.0, 50.0)
    bus.spin_until(lambda: bus.watch.look(STAMPS, begun=True) or "x" in bus.watch._newest)
    for data in (b"", b"\x00\x01\x00\x00", encode_block(AxisBlock(10, 0, *[[]] * 18), STAMPS)):
        bus.writers["x"].publish(data)
    assert bus.stop_of("x").first_cycle == 10


@pytest.mark.parametrize("bus", [(PTP, "x")], indirect=True)
def test_at_the_end_a_long_watchdog_time_is_not_waited_for(bus, monkeypatch):
    monkeypatch.setattr(bus.watch._watchdog, "seconds", 3600.0)
    monkeypatch.setattr(drive_watch, "LAST_PATIENCE", 0.1)
    bus.axis("x", 0, 1.0, 50.0)
    bus.spin_until(lambda: bus.watch.settled(STAMPS) and bus.stops and bus.events)
    assert [(stop.unit, stop.first_cycle) for stop in bus.stops] == [("x", 10)]


@pytest.mark.parametrize("bus", [(PTP, "x", "y")], indirect=True)
def test_at_the_end_only_what_moves_is_waited_for(bus):
    bus.axis("x", 0, 0.0, 0.0)
    bus.axis("y", 0, 0.0, 10.0)
    bus.spin_until(lambda: bus.watch.settled(STAMPS) and bus.events)
    assert [stop.unit for stop in bus.stops] == ["y"]


@pytest.mark.parametrize("bus", [(PTP, "x", "y")], indirect=True)
def test_at_the_end_a_drive_brakes_whose_unit_was_not_heard_since_the_clock_was_held_up(bus):
    """Seed 44, fault 347: nothing was said of how the drive of a dead spindle had braked."""
    bus.watch.longest_pause = 0.2
    bus.axis("x", 0, 1.0, 50.0)
    bus.axis("y", 0, 1.0, 0.0)
    bus.spin_until(lambda: not bus.look() and bus.watch._newest.keys() == {"x", "y"})
    time.sleep(0.5)
    assert not bus.look() and not bus.watch._known
    bus.spin_until(lambda: bus.watch.settled(STAMPS) and bus.events)
    assert [(stop.unit, stop.first_cycle) for stop in bus.stops] == [("x", 10)]


@pytest.mark.parametrize("milliseconds", [1, 50, 200])
def test_drives_are_looked_at_in_time_with_any_watchdog_time(milliseconds):
    """A clock that looks more seldom than half of the watchdog time takes itself for suspended each time."""
    with ros():
        clock = ClockNode(replace(read_machine(str(PTP)), watchdog_ms=milliseconds))
        assert clock._turn <= 0.25e-3 * milliseconds
        clock.destroy_node()


def test_an_axis_whose_drive_has_stopped_ends():
    with ros():
        outside = rclpy.create_node("outside", enable_rosout=False, start_parameter_services=False)
        axis = AxisNode(read_machine(str(PTP)), "x")
        axis.setup()
        writer = outside.create_publisher(msg.DriveStop, DRIVE_STOPS, EVENTS)
        executor = process.EventsExecutor()
        executor.add_node(axis)
        try:
            for unit in ("y", "x"):
                assert axis.failure is None
                writer.publish(msg.DriveStop(unit=unit, first_cycle=300))
                for _ in range(30 if unit == "y" else 1000):
                    if axis.failure is None:
                        executor.spin_once(timeout_sec=0.01)
            assert str(axis.failure) == (
                "P-ERR-26267 axis x: its drive has stopped on its own in cycle 300, as no setpoint came within the watchdog "
                "time of 0.2 s; the node ends: it does not know where the drive is"
            )
        finally:
            for node in (axis, outside):
                node.destroy_node()
            executor.shutdown()


@pytest.fixture
def moving(tmp_path):
    """x on a long way at 50 mm/s, as processes."""
    (tmp_path / "move.yaml").write_text("- {at: 0.05, to: x, do: move_absolute, target: 3000, velocity: 50}\n")
    recording = tmp_path / "run.mcap"
    with Running(one_axis_machine(tmp_path), "--scenario", tmp_path / "move.yaml", "--record", recording) as graph:
        nodes = dict(graph.wait_for_nodes(4))
        graph.wait_until_recorded(recording, 30_000)
        yield graph, nodes, recording


def check_braked(recorded):
    """The drive goes on from the last recorded block to a standstill, and nothing jumps."""
    (stop,) = recorded.drive_stops
    rows = recorded.states["/x/state"]
    assert stop.unit == "x" and stop.first_cycle == rows["cycle"][-1] + 1
    assert rows["set_velocity"][-1] == 50.0 and stop.actual_velocity[-1] == 0.0 and len(stop.actual_velocity) > 10
    positions = np.concatenate([rows["actual_position"], stop.actual_position])
    assert np.abs(np.diff(positions)).max() <= 0.05 + 1e-6
    (told,) = [event for event in recorded.events if event.error_id == 26265]
    begin = f"P-ERR-26265 drive of axis x: no setpoint came after cycle {rows['cycle'][-1]} within its watchdog time"
    assert told.source == "clock" and told.text.startswith(begin.removeprefix("P-ERR-26265 "))


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_the_drive_of_a_process_that_ends_brakes(moving, number):
    graph, nodes, recording = moving
    os.kill(nodes["x"], number)
    output = graph.finish(expect=1)
    name = signal.Signals(number).name
    assert f"P-ERR-26104 node 'x' (process {nodes['x']}) was ended by {name} during the run" in output
    recorded = verified(recording, whole=False)
    check_braked(recorded)
    assert wait_until_gone(nodes.values()) == []


def test_a_process_that_was_held_up_ends_when_its_drive_has_braked(moving):
    """What it would compute of the time that it has missed is not what its drive has done: none of it is recorded.

    It ends with 26267, or with the run, whichever comes first.
    """
    graph, nodes, recording = moving
    os.kill(nodes["x"], signal.SIGSTOP)
    time.sleep(1.0)
    os.kill(nodes["x"], signal.SIGCONT)
    assert "P-ERR-26101" in graph.finish(expect=1)
    check_braked(read_recording(recording))
    assert wait_until_gone(nodes.values()) == []


def test_a_process_that_is_held_up_for_a_moment_catches_up(moving):
    """Less than half of the watchdog time: nobody is lost, no cycle is missing, the drive has followed all setpoints."""
    graph, nodes, recording = moving
    for _ in range(3):
        os.kill(nodes["x"], signal.SIGSTOP)
        time.sleep(0.05)
        os.kill(nodes["x"], signal.SIGCONT)
        time.sleep(0.3)
    graph.process.send_signal(signal.SIGINT)
    output = graph.finish(expect=1)
    assert "P-ERR-26106" in output and "P-ERR-26101" not in output and "P-ERR-26265" not in output
    assert float(re.search(r"block lateness .* largest ([0-9.]+) ms", output)[1]) > 30.0
    recorded = verified(recording, whole=False)
    assert recorded.drive_stops == []
    assert np.all(np.diff(recorded.states["/x/state"]["cycle"].astype(int)) == 1)


def test_the_drives_brake_when_the_supervisor_is_killed(moving):
    """All nodes end at once then; clock and recorder stay until the drives stand."""
    graph, nodes, recording = moving
    kill(graph.process.pid)
    graph.process.wait()
    assert wait_until_gone(nodes.values()) == []
    recorded = read_recording(recording)
    assert recorded.complete
    check_braked(recorded)


def test_one_process_has_no_watch():
    """There drives end together with everything that could tell of them."""
    with ros():
        clock = ClockNode(read_machine(str(PTP)), handover=Handover())
        assert f"/{DRIVE_STOPS}" not in [publisher.topic_name for publisher in clock.publishers]
        assert clock.end_settled()
        clock.destroy_node()


def test_nobody_is_woken_by_the_blocks_that_the_clock_keeps():
    with ros():
        clock = ClockNode(read_machine(str(PTP)))
        waking = {subscription.topic_name for subscription in clock.subscriptions}
        assert waking.isdisjoint({"/x/block", "/y/block", "/z/block", "/c/block", "/plc/block"})
        clock.destroy_node()
