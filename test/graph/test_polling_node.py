"""Inputs that a node takes when it looks: what is written is taken at each look, the first message a little later."""

from __future__ import annotations

import time

import pytest
import rclpy
from ros_support import ros

from cnc_ptp import msg
from cnc_ptp.nodes import polling_node
from cnc_ptp.nodes.polling_node import PollingNode
from cnc_ptp.nodes.topics import PLC_INPUT

PERIOD = 0.5
"""Seconds between two looks at what nobody writes: enough for what lies between."""


@pytest.fixture
def outside(ros_domain, monkeypatch):
    monkeypatch.setattr(polling_node, "UNWRITTEN_PERIOD", PERIOD)
    with ros():
        yield rclpy.create_node("outside", enable_rosout=False, start_parameter_services=False)


def until(condition, *, look=lambda: None):
    """Raises TimeoutError."""
    deadline = time.monotonic() + 20.0
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError
        look()
        time.sleep(0.005)


def written(outside, percent):
    """A publisher that has found its reader and has sent a message."""
    writer = outside.create_publisher(msg.Override, "/x/override", PLC_INPUT)
    until(lambda: writer.get_subscription_count())
    writer.publish(msg.Override(percent=percent))
    return writer


def test_what_is_written_is_taken_at_each_look_and_what_was_not_within_a_period(outside):
    node, taken = PollingNode("node", enable_rosout=False), []
    node.poll_input(msg.Override, "/x/override", taken.append, PLC_INPUT)
    node.take_written_inputs()  # nobody writes
    writer = written(outside, 50.0)
    until(lambda: taken, look=node.take_written_inputs)
    looked = time.monotonic()
    while len(taken) < 4:
        writer.publish(msg.Override(percent=60.0))
        time.sleep(0.01)
        node.take_written_inputs()
    assert time.monotonic() - looked < PERIOD


def test_the_message_of_a_publisher_that_has_gone_at_once_is_taken(outside):
    node, taken = PollingNode("node", enable_rosout=False), []
    node.poll_input(msg.Override, "/x/override", taken.append, PLC_INPUT)
    node.take_written_inputs()
    writer = written(outside, 50.0)
    time.sleep(0.05)
    outside.destroy_publisher(writer)
    until(lambda: not outside.get_publishers_info_by_topic("/x/override"))
    until(lambda: taken, look=node.take_written_inputs)
    assert len(taken) == 1
