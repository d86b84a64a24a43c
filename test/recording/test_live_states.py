"""States as live messages: the bytes that a recording holds; modulo positions by exact fractions."""

from fractions import Fraction
from math import floor
from pathlib import Path
from random import Random

import pytest
from rclpy.serialization import deserialize_message

from cnc_ptp import msg
from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.nodes.unit.live_state import LiveState, period_cycles
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import Command, CycleTick
from cnc_ptp.recording.blocks import state_messages
from cnc_ptp.wire.stamps import Stamps

CONFIG = Path(__file__).parents[2] / "config"
PTP, MILL = CONFIG / "ptp.yaml", CONFIG / "mill.yaml"
START = 1_700_000_000_123_456_789
STAMPS = Stamps(START, 1_000_000)


def blocks_of(name, count, *commands, machine=PTP, blocks=20):
    runner = UnitRunner(build_unit(read_machine(machine), name), watchdog_cycles=10**9)
    for command, arguments in commands:
        assert runner.command(Command(name, command, arguments)).accepted
    return [runner.run(CycleTick(number * count, count), {}) for number in range(blocks)]


@pytest.mark.parametrize("seed", range(5))
def test_states_are_the_cycles_of_the_block(seed):
    random = Random(seed)
    target, count = random.uniform(-2e5, 2e5), random.choice([1, 3, 10, 40])
    move = ("move_absolute", {"target": target, "velocity": 400.0})
    begin, length = Fraction(0), Fraction(360)
    for block in blocks_of("c", count, move, blocks=10):
        assert (block.modulo_begin, block.modulo_length) == (0.0, 360.0)
        for index, data in enumerate(state_messages(block, STAMPS)):
            state, cycle = deserialize_message(data, msg.AxisState), block.first_cycle + index
            assert state.cycle == cycle
            assert state.header.stamp.sec * 10**9 + state.header.stamp.nanosec == START + cycle * 10**6
            assert state.header.frame_id == ""
            for name in ("set_position", "actual_velocity", "following_error", "state", "status_bits", "error_id"):
                assert getattr(state, name) == getattr(block, name)[index]
            for name in ("set_position", "actual_position"):
                exact = Fraction(getattr(block, name)[index])
                within = exact - floor((exact - begin) / length) * length
                assert getattr(state, f"{name}_modulo") == pytest.approx(float(within), abs=1e-9)
            velocity = block.set_velocity[index]
            assert state.set_direction == (velocity > 0.0) - (velocity < 0.0)


def test_spindles_and_channels_have_states_too():
    (block, *_) = blocks_of("s", 10, ("start", {"direction": "ccw", "speed_rpm": 300.0}), machine=MILL)
    states = [deserialize_message(data, msg.SpindleState) for data in state_messages(block, STAMPS)]
    assert [state.set_speed_rpm for state in states] == block.set_speed_rpm
    assert [state.speed_zero for state in states] == block.speed_zero
    (block, *_) = blocks_of("channel", 10, machine=MILL)
    states = [deserialize_message(data, msg.ChannelState) for data in state_messages(block, STAMPS)]
    assert [state.state for state in states] == block.state


class Publisher:
    """Stands for a publisher, and for the node that makes it."""

    def __init__(self, readers):
        self.readers, self.cycles = readers, []

    def create_publisher(self, message_type, topic, _quality):
        self.type, self.topic = message_type, topic
        return self

    def get_subscription_count(self):
        return self.readers

    def publish(self, data):
        self.cycles.append(deserialize_message(data, self.type).cycle)


@pytest.mark.parametrize(("period", "count"), [(1, 10), (20, 10), (10, 10), (3, 10), (33, 10), (7, 4), (100, 1)])
def test_the_last_cycle_of_each_period(period, count):
    publisher = Publisher(readers=1)
    live = LiveState(publisher, "x", "axis", period)
    for block in blocks_of("x", count, blocks=40):
        live.publish(block, STAMPS)
    assert publisher.topic == "x/state"
    assert publisher.cycles == list(range(period - 1, 40 * count, period))


def test_nobody_subscribes():
    publisher = Publisher(readers=0)
    live = LiveState(publisher, "x", "axis", 1)
    for block in blocks_of("x", 10):
        live.publish(block, STAMPS)
    assert publisher.cycles == []


@pytest.mark.parametrize(
    ("rate", "cycles"), [(None, 20), (0.0, 0), (50.0, 20), (1000.0, 1), (5000.0, 1), (30.0, 33), (0.1, 10_000)]
)
def test_rates(rate, cycles):
    assert period_cycles(read_machine(PTP), rate) == cycles
