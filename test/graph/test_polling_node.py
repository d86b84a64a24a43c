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


@pytest.fixture
def outside(ros_domain):
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


def test_what_is_written_is_taken_at_each_look_and_what_was_not_within_a_period(outside, monkeypatch):
    node, taken = PollingNode("node", enable_rosout=False), []
    for axis in "xy":
        node.poll_input(msg.Override, f"/{axis}/override", taken.append, PLC_INPUT)
    node.take_written_inputs()  # nobody writes
    writer = written(outside, 50.0)
    until(lambda: taken, look=node.take_written_inputs)
    monkeypatch.setattr(polling_node, "UNWRITTEN_PERIOD", 1e9)
    whole = []
    monkeypatch.setattr(node, "take_inputs", lambda: whole.append(PollingNode.take_inputs(node)))
    until(lambda: whole, look=node.take_written_inputs)  # the last one
    looked = len(taken)
    writer.publish(msg.Override(percent=60.0))
    until(lambda: len(taken) > looked, look=node.take_written_inputs)
    assert len(whole) == 1


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
