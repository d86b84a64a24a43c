"""Command records as ROS messages, and back."""

from builtin_interfaces.msg import Time

from cnc_ptp.nodes import convert
from cnc_ptp.protocol.blocks import CommandRecord


def test_a_record_travels_without_its_values():
    record = CommandRecord(7, "x", "stop", "{}", False, 23017, "axis x: ...", 3, {"limit": 5.0})
    back = convert.message_to_record(convert.record_to_message(record, Time()))
    assert back == record and back.values == {}
