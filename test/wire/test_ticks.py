"""Ticks as messages."""

from __future__ import annotations

import pytest
from rclpy.serialization import deserialize_message, serialize_message

from cnc_ptp import msg
from cnc_ptp.wire.ticks import Tick, decode_tick, encode_tick


def test_ros_reads_a_tick() -> None:
    message = deserialize_message(encode_tick(1000, 10, 123_456_789, 2_000_000_003), msg.CycleTick)
    assert (message.first_cycle, message.count, message.scheduled_monotonic_ns) == (1000, 10, 123_456_789)
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (2, 3)


@pytest.mark.parametrize("frame", ["", "w", "cell", "world"])
def test_a_tick_of_any_clock_is_read(frame: str) -> None:
    message = msg.CycleTick(first_cycle=1000, count=10, scheduled_monotonic_ns=-5)
    message.header.stamp.sec, message.header.stamp.nanosec = 2, 3
    message.header.frame_id = frame
    assert decode_tick(serialize_message(message)) == Tick(1000, 10, -5, 2_000_000_003)
