"""Messages of numbers are read as rclpy reads them, whatever name is in their header."""

import random

import pytest
from rclpy.serialization import deserialize_message, serialize_message

from cnc_ptp import msg
from cnc_ptp.wire.fixed_message import FixedMessage, nested

TYPES = [msg.AxisHliControl, msg.SpindleHliControl, msg.ChannelHliControl, msg.Override, msg.Switch, msg.FeedRelease]


def filled(message, chance):
    """Every number of a message with a value of its own."""
    for name, kind in message.get_fields_and_field_types().items():
        value = getattr(message, name)
        if name == "header":
            continue
        if hasattr(value, "get_fields_and_field_types"):
            filled(value, chance)
        elif kind == "boolean":
            setattr(message, name, chance.random() < 0.5)
        elif kind in ("double", "float"):
            setattr(message, name, chance.uniform(-1e6, 1e6))
        elif "[" in kind:
            setattr(message, name, [chance.randrange(2**60) for _ in value])
        else:
            setattr(message, name, chance.randrange(100))
    return message


@pytest.mark.parametrize("frame", ["", "p", "plc1", "a PLC with ünicode", "x" * 200])
@pytest.mark.parametrize("of", TYPES)
def test_every_field_as_rclpy_has_it(of, frame):
    reader = FixedMessage(f"cnc_ptp/msg/{of.__name__}")
    chance = random.Random(len(frame))
    message = filled(of(), chance)
    message.header.frame_id = frame
    message.header.stamp.sec = 5
    data = serialize_message(message)
    source, fields = reader.read(data)
    again = deserialize_message(data, of)
    assert source == frame
    for name, value in fields.items():
        expected = nested(again, name)
        assert value == (tuple(expected) if isinstance(value, tuple) else expected), name
    assert len(fields) > 2


def test_another_encapsulation_is_read_by_the_decoder_that_is_given():
    message = msg.Override(sequence=3, percent=5.0)
    message.header.frame_id = "p"
    data = b"\x00\x00" + serialize_message(message)[2:]
    reader = FixedMessage("cnc_ptp/msg/Override", lambda _data: message)
    assert reader.split(data) == ("", -1)
    assert reader.read(data) == ("p", {"sequence": 3, "valid": False, "percent": 5.0})
