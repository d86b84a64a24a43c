"""Faults of starting and recording that a good run never meets, with their exact texts."""

import time
from functools import partial
from types import SimpleNamespace

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from graph_support import MILL, PTP, run
from long_support import long
from rcl_interfaces.msg import Log, Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.node import Node
from rclpy.qos import qos_profile_rosout_default
from recording_support import Blocks
from ros_support import ros
from spin_support import spin_until

from cnc_ptp import msg
from cnc_ptp.client.graph_link import GraphLink, Jogging
from cnc_ptp.errors import CncError
from cnc_ptp.nodes import process
from cnc_ptp.nodes.client.latest_blocks import LatestBlocks
from cnc_ptp.nodes.clock import ClockNode
from cnc_ptp.nodes.monitor import RunMonitor
from cnc_ptp.nodes.recorder import ALONE_AFTER, RecorderNode
from cnc_ptp.nodes.topics import (
    BLOCKS,
    CHECKPOINTS,
    COMMAND,
    DIAGNOSTICS,
    DRIVE_STOPS,
    EVENT,
    EVENTS,
    LATENESS,
    PLC_INPUT,
    REPORT,
    STATES_OF_UNITS,
    TICK,
    block_topic,
)
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import AxisBlock, CommandRecord, PlcBlock, Severity
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.recording.writing_place import require_writable
from cnc_ptp.wire.block_codec import encode_block
from cnc_ptp.wire.stamps import Stamps
from cnc_ptp.wire.ticks import Tick

STAMPS = Stamps(0, 1_000_000)
UNITS = ("plc", "x", "y", "z", "c")
"""Of ptp.yaml."""
NO_MESSAGE = b"\x00\x01\x00\x00\x07"


class Outside(Node):
    """Everything around a node, in the hands of a test."""

    def __init__(self):
        super().__init__("outside", enable_rosout=False, start_parameter_services=False)
        self.ticks = self.create_publisher(msg.CycleTick, TICK, BLOCKS)
        self.plc = self.create_publisher(msg.PlcBlock, block_topic("plc"), BLOCKS)
        self.reports = self.create_publisher(msg.BlockReport, REPORT, BLOCKS)
        self.events = []
        self.create_subscription(msg.Event, EVENT, self.events.append, EVENTS)

    def plc_block(self, first_cycle):
        block = PlcBlock(first_cycle, 10)
        self.plc.publish(encode_block(block, STAMPS))


@pytest.fixture
def around():
    """Makes a node beside `outside`; gives both, and a function that spins them until something holds."""
    with ros():
        executor = process.EventsExecutor()
        nodes = [Outside()]

        def start(make):
            nodes.append(make())
            for node in nodes:
                executor.add_node(node)
            return (*nodes, partial(spin_until, executor))

        yield start
        for node in nodes:
            node.destroy_node()
        executor.shutdown()


def test_a_second_clock_starts_nothing(around):
    outside, clock, spin_until = around(lambda: ClockNode(read_machine(str(PTP))))
    spin_until(outside.reports.get_subscription_count)
    spin_until(lambda: clock.count_publishers(TICK) == 2)
    clock.advance()
    for unit in UNITS:
        outside.reports.publish(msg.BlockReport(source=unit, first_cycle=-1))

    def advance():
        clock.advance()
        return False

    with pytest.raises(CncError) as refused:
        spin_until(advance)
    assert str(refused.value) == ("P-ERR-26109 another clock is on this ROS domain; this one ends, nothing was started")


def test_a_foreign_reader_is_not_taken_for_one_of_ours(around):
    """Otherwise the clock would start before the recorder is found, and its first blocks would be missing."""
    outside, echo, spin_until = around(lambda: Node("echo", enable_rosout=False))
    echo.create_subscription(msg.PlcBlock, block_topic("plc"), print, BLOCKS)
    spin_until(outside.plc.get_subscription_count)
    spin_until(lambda: process.is_read(outside, outside.plc, {"echo"}))
    assert not process.is_read(outside, outside.plc, {"recorder"})
    assert not process.is_read(outside, outside.plc, {"echo", "recorder"})


def test_blocks_that_are_not_recorded_are_told(around, tmp_path):
    def make():
        return RecorderNode(read_machine(str(PTP)), str(tmp_path / "a.mcap"), PTP.read_text())

    outside, recorder, spin_until = around(make)
    spin_until(lambda: outside.ticks.get_subscription_count() and outside.plc.get_subscription_count())
    outside.ticks.publish(msg.CycleTick(first_cycle=0, count=10))
    for first_cycle in (0, 30, 40):
        outside.plc_block(first_cycle)
    spin_until(lambda: outside.events)
    spin_until(lambda: recorder._next_cycle["plc"] == 50)
    assert [(event.cycle, event.source, event.severity, event.error_id, event.text) for event in outside.events] == [
        (
            30,
            "recorder",
            Severity.ERROR,
            26114,
            "recorder: blocks of 'plc' from cycle 10 to 29 are missing in the recording",
        )
    ]


@pytest.mark.parametrize("what", ["the end is missing", "it continues", "the end has come"])
def test_a_recorder_that_is_held_up_until_the_run_has_ended_says_so(around, tmp_path, what):
    """Nothing is missing where there are ticks after that, too, or where the last block of the run is there."""
    path = tmp_path / "a.mcap"
    outside, recorder, spin_until = around(lambda: RecorderNode(read_machine(str(PTP)), str(path), PTP.read_text()))
    spin_until(lambda: outside.ticks.get_subscription_count() and outside.plc.get_subscription_count())
    outside.ticks.publish(msg.CycleTick(first_cycle=0, count=10))
    outside.plc.publish(encode_block(PlcBlock(0, 10, run_done=what == "the end has come"), STAMPS))
    spin_until(lambda: recorder._next_cycle["plc"] == 10)
    time.sleep(1.1)
    spin_until(lambda: recorder._held_for > 1.0)
    if what == "it continues":
        later = time.monotonic() + 0.3
        spin_until(lambda: time.monotonic() > later)
        outside.ticks.publish(msg.CycleTick(first_cycle=10, count=10))
        outside.plc_block(10)
        spin_until(lambda: recorder._last_tick == 10 and recorder._next_cycle["plc"] == 20)
    recorder.destroy_node()
    held = f"{recorder._held_for:.1f}"
    text = f"the recorder was held up for {held} s, and the run has ended meanwhile; what came after cycle 9 is missing"
    recorded = read_recording(path)
    assert recorded.missing == (text if what == "the end is missing" else "")


@pytest.mark.motion_unchecked("random numbers")
def test_blocks_behind_the_stop_of_a_drive_are_not_recorded(around, tmp_path):
    """A process that was suspended computes what it has missed; its drive has braked meanwhile."""
    path = tmp_path / "a.mcap"
    outside, recorder, spin_until = around(lambda: RecorderNode(read_machine(str(PTP)), str(path), PTP.read_text()))
    blocks = Blocks(1)
    axis = outside.create_publisher(msg.AxisBlock, block_topic("x"), BLOCKS)
    stops = outside.create_publisher(msg.DriveStop, DRIVE_STOPS, EVENTS)
    spin_until(lambda: outside.ticks.get_subscription_count() and axis.get_subscription_count())
    spin_until(stops.get_subscription_count)
    outside.ticks.publish(msg.CycleTick(first_cycle=0, count=10))
    axis.publish(encode_block(blocks.axis(0), STAMPS))
    spin_until(lambda: recorder._next_cycle["x"] == 10)
    stops.publish(msg.DriveStop(unit="x", first_cycle=10))
    spin_until(lambda: recorder._stopped == {"x": 10})
    axis.publish(encode_block(blocks.axis(10), STAMPS))
    spin_until(lambda: recorder._next_cycle["x"] == 20)
    recorder.destroy_node()
    assert read_recording(path).states["/x/state"]["cycle"].tolist() == list(range(10))


@pytest.mark.motion_unchecked("random numbers")
@pytest.mark.parametrize("foreign", [2001, 60_010])
def test_a_block_that_is_far_ahead_of_the_clock_costs_none_of_those_that_follow(around, tmp_path, foreign):
    path = tmp_path / "a.mcap"
    outside, recorder, spin_until = around(lambda: RecorderNode(read_machine(str(PTP)), str(path), PTP.read_text()))
    blocks = Blocks(1)
    axis = outside.create_publisher(msg.AxisBlock, block_topic("x"), BLOCKS)
    spin_until(lambda: outside.ticks.get_subscription_count() and axis.get_subscription_count())
    told = []
    recorder.tell_unreadable = told.append
    outside.ticks.publish(msg.CycleTick(first_cycle=0, count=10))
    for first_cycle in (0, foreign, 10):
        axis.publish(encode_block(blocks.axis(first_cycle), STAMPS))
    spin_until(lambda: recorder._next_cycle["x"] == 20)
    recorder.destroy_node()
    assert read_recording(path).states["/x/state"]["cycle"].tolist() == list(range(20))
    (text,) = told
    assert text.startswith("recorder: topic x/block: ") and text.endswith(
        f" bytes are no message AxisBlock: its first cycle is {foreign}, and at most 2000 is possible now; they are ignored"
    )


@pytest.mark.motion_unchecked("random numbers")
def test_a_unit_that_goes_on_without_a_clock_is_recorded_to_its_standstill(around, tmp_path):
    """Also when the clock comes back far behind it."""
    path = tmp_path / "a.mcap"
    _, recorder, _ = around(lambda: RecorderNode(read_machine(str(PTP)), str(path), PTP.read_text()))
    blocks = Blocks(1)
    recorder._on_tick(Tick(0, 10, 1, 0))
    for first_cycle in range(0, 5000, 10):
        recorder._on_block("x", AxisBlock, encode_block(blocks.axis(first_cycle), STAMPS))
    recorder._on_tick(Tick(10, 10, 1, 10_000_000))
    recorder._on_block("x", AxisBlock, encode_block(blocks.axis(5000), STAMPS))
    recorder.destroy_node()
    assert read_recording(path).states["/x/state"]["cycle"].tolist() == list(range(5010))


@pytest.mark.motion_unchecked("random numbers")
def test_after_a_gap_a_unit_without_a_clock_is_recorded_and_with_one_nobody_climbs_ahead(around, tmp_path):
    path = tmp_path / "a.mcap"
    _, recorder, _ = around(lambda: RecorderNode(read_machine(str(PTP)), str(path), PTP.read_text()))
    blocks = Blocks(1)
    recorder._on_tick(Tick(0, 10, 1, 0))
    for first_cycle in (0, 2000):
        recorder._on_block("x", AxisBlock, encode_block(blocks.axis(first_cycle), STAMPS))
    with pytest.raises(CncError, match="its first cycle is 4000, and at most 2010 is possible now"):
        recorder._on_block("x", AxisBlock, encode_block(blocks.axis(4000), STAMPS))
    recorder._ticked_at -= ALONE_AFTER
    recorder._on_block("x", AxisBlock, encode_block(blocks.axis(4000), STAMPS))
    recorder.destroy_node()
    cycles = [*range(10), *range(2000, 2010), *range(4000, 4010)]
    assert read_recording(path).states["/x/state"]["cycle"].tolist() == cycles


@pytest.mark.motion_unchecked("random numbers")
def test_a_block_that_comes_before_the_first_tick_is_recorded_at_a_machine_that_has_run_for_long(around, tmp_path):
    """A recorder that is started by hand."""
    path = tmp_path / "a.mcap"
    _, recorder, _ = around(lambda: RecorderNode(read_machine(str(PTP)), str(path), PTP.read_text()))
    told = []
    recorder.tell_unreadable = told.append
    recorder._on_block("x", AxisBlock, encode_block(Blocks(1).axis(600_000), STAMPS))
    recorder._on_tick(Tick(600_000, 10, 1, 600_000_000_000))
    recorder.destroy_node()
    assert told == [] and read_recording(path).states["/x/state"]["cycle"].tolist() == list(range(600_000, 600_010))


def test_states_that_no_unit_has_sent_are_left_out(around, tmp_path):
    """A foreign message must not end the recorder: without it everything stops."""
    path = tmp_path / "a.mcap"
    outside, recorder, spin_until = around(lambda: RecorderNode(read_machine(str(PTP)), str(path), PTP.read_text()))
    states = outside.create_publisher(msg.UnitCheckpoint, CHECKPOINTS, STATES_OF_UNITS)
    spin_until(lambda: outside.ticks.get_subscription_count() and states.get_subscription_count())
    outside.ticks.publish(msg.CycleTick(first_cycle=0, count=10))
    spin_until(lambda: recorder._last_tick == 0)
    for unit, texts in (("", ""), ("x", "[1]"), ("x", "{}"), ("q", "[]"), ("x", '["a program"]')):
        states.publish(msg.UnitCheckpoint(unit=unit, next_cycle=10, texts_json=texts, state=b"abc"))
    spin_until(lambda: recorder._recording._texts)
    assert recorder.failure is None and [*recorder._recording._texts.values()] == ["a program"]
    recorder.destroy_node()
    with RunInputs(path) as recorded:
        assert [name for name in recorded._attachments if name.startswith("checkpoint/")] == ["checkpoint/10/x"]
        assert [*recorded.checkpoint_texts().values()] == ["a program"]


def test_bytes_that_are_no_messages_do_not_end_a_recorder(around, tmp_path):
    """Found by mutated inputs, seed 430: without the recorder everything stops."""
    path = tmp_path / "a.mcap"
    outside, recorder, spin_until = around(lambda: RecorderNode(read_machine(str(PTP)), str(path), PTP.read_text()))
    foreign = [
        outside.create_publisher(of, topic, quality)
        for topic, of, quality in (
            (CHECKPOINTS, msg.UnitCheckpoint, STATES_OF_UNITS),
            (DRIVE_STOPS, msg.DriveStop, EVENTS),
            (DIAGNOSTICS, DiagnosticArray, PLC_INPUT),
            (LATENESS, msg.LatenessHistogram, PLC_INPUT),
            ("/rosout", Log, qos_profile_rosout_default),
        )
    ]
    commands = outside.create_publisher(msg.CommandRecord, COMMAND, EVENTS)
    spin_until(lambda: all(each.get_subscription_count() for each in (*foreign, commands, outside.ticks)))
    outside.ticks.publish(msg.CycleTick(first_cycle=0, count=10))
    spin_until(lambda: recorder._last_tick == 0)
    for each in foreign:
        each.publish(NO_MESSAGE)
    for values in ("[1]", "{", "[" * 3000):
        commands.publish(msg.CommandRecord(target="x", command="move", values_json=values))
    foreign[0].publish(msg.UnitCheckpoint(unit="x", texts_json="[" * 3000))
    spin_until(lambda: len(recorder._unreadable) == len(foreign))
    outside.ticks.publish(msg.CycleTick(first_cycle=10, count=10))
    spin_until(lambda: recorder._last_tick == 10)
    assert recorder.failure is None
    recorder.destroy_node()
    assert [record.values for record in read_recording(path).commands] == [{}] * 3


def test_bytes_that_are_no_block_do_not_cost_the_beginning_of_a_recording(around, tmp_path):
    path = tmp_path / "a.mcap"
    outside, recorder, spin_until = around(lambda: RecorderNode(read_machine(str(PTP)), str(path), PTP.read_text()))
    foreign = outside.create_publisher(msg.AxisBlock, block_topic("x"), BLOCKS)
    events = outside.create_publisher(msg.Event, EVENT, EVENTS)
    spin_until(lambda: all(each.get_subscription_count() for each in (foreign, events, outside.ticks)))
    foreign.publish(NO_MESSAGE)
    spin_until(lambda: recorder.take_polled() or recorder._early)
    events.publish(msg.Event(cycle=0, source="x", severity=Severity.WARNING, text="early"))
    spin_until(lambda: len(recorder._early) == 2)
    outside.ticks.publish(msg.CycleTick(first_cycle=0, count=10))
    spin_until(lambda: recorder._last_tick == 0)
    assert recorder.failure is None and not recorder._early and recorder._unreadable == {block_topic("x")}
    recorder.destroy_node()
    assert [event.text for event in read_recording(path).events] == ["early"]


def test_a_recording_that_cannot_be_closed_is_an_error_of_the_recorder(around, tmp_path):
    """Its events would reach nobody: all others have ended."""
    _, recorder, _ = around(lambda: RecorderNode(read_machine(str(PTP)), str(tmp_path / "a.mcap"), PTP.read_text()))

    def close():
        raise CncError(26007, "recording a.mcap: cannot be written: No space left on device", "nothing is recorded")

    recorder._sinks.append(SimpleNamespace(close=close))
    recorder.destroy_node()
    with pytest.raises(CncError, match=r"P-ERR-26007 recording a\.mcap: cannot be written"):
        process.raise_failure([recorder])


def test_bytes_that_are_no_message_end_no_client():
    link = GraphLink.__new__(GraphLink)
    for take, of in ((link._take_event, "Event"), (link._take_record, "CommandRecord")):
        with pytest.raises(CncError) as error:  # which `poll` leaves out
            take(NO_MESSAGE)
        assert error.value.number == 26184 and f"no message {of}" in error.value.reason
    subscribed = {}
    node = SimpleNamespace(
        create_subscription=lambda _of, topic, take, *_rest, **_more: subscribed.update({topic: take}),
        leave_out=lambda topic, error: None,
    )
    blocks = LatestBlocks(node, {"x": "axis"}, rotary=())
    subscribed[block_topic("x")](NO_MESSAGE)
    assert blocks.views() == []


def test_foreign_records_of_a_jog_are_no_answers():
    jogging = Jogging("x", "me", SimpleNamespace(velocity=5.0))
    for arguments in ("", "{", "[5.0]", "[" * 100_000, '{"velocity": 4.0}', '{"velocity": 5.0}'):
        jogging.take_record(CommandRecord(0, "x", "jog", arguments, True, 0, ""))
    assert [record.arguments for record in jogging._records] == ['{"velocity": 5.0}']


@pytest.mark.parametrize("service", [SetParameters, SetParametersAtomically])
def test_a_parameter_of_a_type_that_there_is_not(around, service):
    """Found by mutated inputs, seed 430: rclpy's own service would end the node."""
    _, clock, _ = around(lambda: ClockNode(read_machine(str(PTP))))
    asked = next(each for each in clock.services if each.srv_type is service)
    for kind in (10, 77, 255):
        value = ParameterValue(type=kind)
        answer = asked.callback(
            service.Request(parameters=[Parameter(name="use_sim_time", value=value)]), service.Response()
        )
        result = answer.results[0] if service is SetParameters else answer.result
        assert not result.successful and result.reason


def test_a_fault_in_the_last_block_fails_the_run(around):
    """The PLC would know of it in the block after."""
    outside, monitor, spin_until = around(lambda: RunMonitor(read_machine(str(PTP))))
    errors = outside.create_publisher(msg.Event, EVENT, EVENTS)
    spin_until(lambda: errors.get_subscription_count() and outside.plc.get_subscription_count())

    def fault(cycle, number):
        errors.publish(msg.Event(cycle=cycle, source="x", severity=Severity.ERROR, error_id=1, text="fault"))
        spin_until(lambda: monitor.take_polled() or len(monitor.errors) == number)

    fault(3, 1)
    assert monitor.run_failed
    outside.plc_block(10)
    spin_until(lambda: monitor.take_polled() or monitor.cycle == 20)
    assert not monitor.run_failed, "it was reset before"
    fault(10, 2)
    assert monitor.run_failed


def test_looking_whether_a_recording_can_be_written_changes_nothing(tmp_path):
    new, old, link, aim = (tmp_path / name for name in ("new.mcap", "old.mcap", "link.mcap", "aim.mcap"))
    old.write_bytes(b"before")
    link.symlink_to(aim)
    for path in (new, old, link):
        require_writable(str(path))
    assert sorted(tmp_path.iterdir()) == [link, old] and link.is_symlink() and old.read_bytes() == b"before"
    with pytest.raises(CncError) as refused:
        require_writable(str(tmp_path))
    assert (
        str(refused.value) == f"P-ERR-26113 recording {tmp_path} cannot be written: Is a directory; nothing was started"
    )


@pytest.mark.parametrize(
    ("domain", "reason"),
    [
        ("1000", "ROS_DOMAIN_ID = 1000 is not within 0 ... 232"),
        ("two", "failed to initialize rcl: ROS_DOMAIN_ID is not an integral number"),
    ],
)
@pytest.mark.parametrize("options", [[], *long([["--composed"]])], ids=str)
def test_no_such_domain(domain, reason, options, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    error = run("run", MILL, *options, expect=2).stderr
    assert error == f"P-ERR-26108 ROS does not start: {reason}; nothing was started\n"
