"""Command records as ROS messages, and back."""

from builtin_interfaces.msg import Time

from cnc_ptp.nodes import convert
from cnc_ptp.protocol.blocks import CommandRecord


def test_a_record_travels_with_its_values_and_job():
    record = CommandRecord(7, "x", "stop", "{}", False, 23017, "axis x: ...", 3, {"limit": 5.0, "axis": "x"}, 4)
    back = convert.message_to_record(convert.record_to_message(record, Time()))
    assert back == record and (back.values, back.job) == ({"limit": 5.0, "axis": "x"}, 4)
