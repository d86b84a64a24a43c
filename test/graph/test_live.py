"""A run in real time as rqt, PlotJuggler and `ros2 topic delay` see it: stamps, live states, joint states, /rosout."""

import math
import time

import pytest
from client_support import beside_composed_run
from diagnostic_msgs.msg import DiagnosticArray
from graph_support import MILL
from rcl_interfaces.msg import Log
from rclpy.qos import qos_profile_rosout_default
from sensor_msgs.msg import JointState

from cnc_ptp import msg
from cnc_ptp.nodes import convert
from cnc_ptp.nodes.topics import BLOCKS, DIAGNOSTICS, JOINT_STATES, LATENESS, PLC_INPUT, TICK

MESSAGES = 100


@pytest.fixture(scope="module")
def client():
    with beside_composed_run(MILL) as node:
        yield node


def heard(client, topic, message_type, quality, number=MESSAGES):
    """Messages with their delay in s, receive time less stamp, as `ros2 topic delay` measures it."""
    seen = []

    def received(message):
        seen.append((time.time_ns() * 1e-9 - convert.nanoseconds(message.header.stamp) * 1e-9, message))

    subscription = client.create_subscription(message_type, topic, received, quality)
    client.spin_until(lambda: len(seen) >= number, f"{number} messages on {topic}")
    client.destroy_subscription(subscription)
    return [delay for delay, _ in seen], [message for _, message in seen]


@pytest.mark.parametrize(
    ("topic", "message_type", "ahead"),
    [
        (TICK, msg.CycleTick, 0.0),
        ("/x/block", msg.AxisBlock, 0.0),
        ("/channel/block", msg.ChannelBlock, 0.0),
        ("/plc/block", msg.PlcBlock, 0.0),
        ("/y/state", msg.AxisState, 0.009),  # the last cycle of a block lies 9 ms behind its first
        (JOINT_STATES, JointState, 0.0),
    ],
)
def test_a_stamp_is_the_time_at_which_its_cycle_counts(client, topic, message_type, ahead):
    """Nothing comes before its block is due, and the quickest soon after it; with wrong stamps it was 106 ms."""
    delays, _ = heard(client, topic, message_type, BLOCKS)
    assert -ahead - 0.001 <= min(delays) < 0.05


def test_live_states_are_those_of_the_blocks_50_times_a_second(client):
    client.done("x", "power", enabled=True)
    client.done("x", "move_absolute", target=50.0, velocity=20.0)
    begun = time.monotonic()
    _, states = heard(client, "/x/state", msg.AxisState, BLOCKS)
    took = time.monotonic() - begun
    cycles = [state.cycle for state in states]
    assert cycles == list(range(cycles[0], cycles[0] + 20 * len(cycles), 20)) and cycles[0] % 20 == 19
    assert 1.5 < took < 6.0
    for state in states[::10]:
        for field in ("set_position", "set_velocity", "actual_position", "following_error", "state", "status_bits"):
            assert client.state_at("x", state.cycle, field) == getattr(state, field)
        assert state.set_position_modulo == state.set_position  # a linear axis has no modulo range
    assert states[-1].set_position > states[0].set_position and states[-1].set_direction == 1


def test_one_joint_state_for_the_machine_in_si_units(client):
    client.done("s", "start", direction="ccw", speed_rpm=600.0)
    client.wait_last("s", lambda block: abs(block.actual_speed_rpm[-1] + 600.0) < 1.0, "600 rpm")
    _, messages = heard(client, JOINT_STATES, JointState, PLC_INPUT)
    last = messages[-1]
    assert list(last.name) == ["x", "y", "z", "s"]
    assert last.velocity[3] == pytest.approx(-600.0 * 2.0 * math.pi / 60.0, rel=1e-3)
    assert math.isnan(last.effort[3]) and all(math.isfinite(effort) for effort in last.effort[:3])
    turned = (last.position[3] - messages[0].position[3]) / (stamp(last) - stamp(messages[0]))
    assert turned == pytest.approx(last.velocity[3], rel=1e-3)
    block = client.blocks["x"][-1]
    cycle = block.first_cycle + round((stamp(last) - stamp(block)) * 1e3)
    assert last.position[0] == client.state_at("x", cycle, "actual_position") * 1e-3
    assert cycle % 10 == 9
    client.done("s", "stop")


def stamp(message):
    return convert.nanoseconds(message.header.stamp) * 1e-9


def test_warnings_are_on_rosout_for_late_joiners(client):
    refused = client.call("y", "move_absolute", target=1e6)
    assert not refused.accepted
    client.wait_blocks("y", 10)
    logs = []
    client.create_subscription(Log, "/rosout", logs.append, qos_profile_rosout_default)
    text = f"P-WARN-{refused.error_id} {refused.message}"
    client.spin_until(lambda: any(log.msg == text for log in logs), "the warning")
    log = next(log for log in logs if log.msg == text)
    event = next(event for event in client.events if event.text == refused.message)
    assert (log.level, log.name, log.stamp) == (Log.WARN, "y", event.header.stamp)
    assert {log.level for log in logs} <= {Log.WARN, Log.ERROR}  # changes of state are events alone


def test_the_histogram_of_lateness_is_a_topic_of_its_own(client):
    _, messages = heard(client, LATENESS, msg.LatenessHistogram, PLC_INPUT, 6)
    assert {message.source for message in messages} <= {"plc", "channel", "s", "x", "y", "z"}
    for message in messages:
        assert message.step_us == 100 and sum(message.blocks) > 10
        assert max(message.step) * 100 <= message.largest_us < (max(message.step) + 1) * 100
    _, (array, *_) = heard(client, DIAGNOSTICS, DiagnosticArray, PLC_INPUT, 1)
    assert all("{" not in value.value for status in array.status for value in status.values)
    assert all(float(value.value) >= 0.0 for status in array.status for value in status.values)
