"""Blocks and commands as ROS messages, and back."""

from builtin_interfaces.msg import Time
from recording_support import Blocks

from cnc_ptp.nodes import convert
from cnc_ptp.protocol.blocks import CommandRecord, Refusal


def test_the_refusals_of_a_spindle_travel_as_texts():
    block = Blocks(10).spindle(0)
    block.refused = [
        Refusal("channel", 24012, "spindle s: orient refused: busy; nothing was changed"),
        Refusal("a", 1, ""),
    ]
    message = convert.block_to_message(block, Time())
    assert message.refused == [
        "channel: P-ERR-24012 spindle s: orient refused: busy; nothing was changed",
        "a: P-ERR-1 ",
    ]
    assert convert.message_to_block(message).refused == block.refused


def test_a_record_travels_without_its_values():
    record = CommandRecord(7, "x", "stop", "{}", False, 23017, "axis x: ...", 3, {"limit": 5.0})
    back = convert.message_to_record(convert.record_to_message(record, Time()))
    assert back == record and back.values == {}
