"""CDR against two independent implementations: the decoder of mcap-ros2-support and rclpy with Fast CDR."""

import struct
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples
from mcap.records import Schema as McapSchema
from mcap_ros2.decoder import DecoderFactory

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import CommandRecord, Event
from cnc_ptp.wire.layout import Header, Layout, encode, fixed_layout, header_at, zero
from cnc_ptp.wire.schemas import PRIMITIVES, load_schema, parse_schema

STATE_TYPES = ["AxisState", "SpindleState", "ChannelState"]
BLOCK_TYPES = {
    "axis": "AxisBlock",
    "spindle": "SpindleBlock",
    "channel": "ChannelBlock",
    "channel_with_commands": "ChannelBlock",
}


def decode(schema, data):
    """The library's decoder."""
    text = McapSchema(id=1, data=schema.text.encode(), encoding="ros2msg", name=schema.name)
    return DecoderFactory().decoder_for("cdr", text)(data)


def same(decoded, value, schema, type_name=""):
    """Whether a decoded message holds the numbers and texts of a block (bits, so NaN counts as equal)."""
    for field in schema.types[type_name or schema.name]:
        if field.type == "std_msgs/Header":
            continue
        left, right = getattr(decoded, field.name), getattr(value, field.name)
        if field.length is None:
            left, right = [left], [right]
        assert len(left) == len(right), field.name
        for one, other in zip(left, right, strict=True):
            if field.type in schema.types:
                same(one, other, schema, field.type)
            elif isinstance(other, float):
                assert struct.pack("<d", one) == struct.pack("<d", other), field.name
            else:
                assert one == other, field.name


@pytest.mark.parametrize(("maker", "type_name"), BLOCK_TYPES.items())
def test_encoded_blocks_are_read_by_the_library(blocks, maker, type_name):
    schema = load_schema(f"cnc_ptp/msg/{type_name}")
    block = getattr(blocks, maker)(120)
    decoded = decode(schema, encode(schema, block, lambda value: Header(7, 8)))
    same(decoded, block, schema)
    assert (decoded.header.stamp.sec, decoded.header.stamp.nanosec, decoded.header.frame_id) == (7, 8, "")


@given(cycle=st.integers(0, 2**64 - 1), text=st.text(), source=st.text(), line=st.integers(0, 2**32 - 1))
def test_any_text_is_read_by_the_library(cycle, text, source, line):
    schema = load_schema("cnc_ptp/msg/Event")
    event = Event(cycle, source, 2, 23001, text, line)
    same(decode(schema, encode(schema, event)), event, schema)


def test_what_is_no_character_becomes_a_question_mark():
    """A file whose name is no UTF-8, a goal of a client in Python."""
    schema = load_schema("cnc_ptp/msg/Event")
    event = Event(0, "x", 2, 23001, "part\udcff.nc", 1)
    assert decode(schema, encode(schema, event)).text == "part?.nc"


@pytest.mark.parametrize("type_name", STATE_TYPES)
def test_many_states_at_once_are_read_by_the_library(type_name):
    schema = load_schema(f"cnc_ptp/msg/{type_name}")
    layout = fixed_layout(schema)
    rows = layout.empty(50)
    generator = np.random.default_rng(1)
    for name in rows.dtype.names:
        rows[name] = generator.integers(0, 2, 50) if rows.dtype[name].kind == "b" else generator.integers(0, 200, 50)
    data = np.ascontiguousarray(rows).tobytes()
    size = layout.dtype.itemsize
    for index in range(50):
        decoded = decode(schema, data[index * size : (index + 1) * size])
        assert decoded.cycle == rows["cycle"][index]
        assert decoded.header.stamp.nanosec == rows["header.stamp.nanosec"][index]
        for field in schema.fields[2:]:
            assert getattr(decoded, field.name) == rows[field.name][index]
    assert np.array_equal(layout.read(data), rows)


@settings(max_examples=examples(50))
@given(count=st.integers(0, 12), first=st.integers(0, 2**63), values=st.lists(st.floats(), min_size=15, max_size=15))
def test_layout_of_a_block_gives_the_bytes_of_encode(count, first, values):
    schema = load_schema("cnc_ptp/msg/AxisBlock")
    names = [field.name for field in schema.fields[3:] if field.length is not None and field.type in PRIMITIVES]
    of_the_block = {
        "master": "y",
        "target_velocity": 5.0,
        "modulo_begin": -180.0,
        "modulo_length": 360.0,
        "torque_digits": 250.0,
    }
    of_the_block |= {"couples_actual": True, "job": 7}
    probe = {"probe_on": True, "probe_switched": True, "probe_cycle": 3.25, "probe_position": -12.5}
    of_the_block |= probe
    block = {"header": Header(), "first_cycle": first, "count": count, **of_the_block}
    block |= {"job_events": [], "answers": [], "control_units": []}
    block |= {name: [value] * count for name, value in zip(names, [*values, 3, 4, 5], strict=True)}
    row = Layout(schema, block | dict.fromkeys(names, [0] * count)).empty(1)
    row["first_cycle"] = first
    for name in ("target_velocity", "modulo_begin", "modulo_length", "torque_digits", "couples_actual", "job", *probe):
        row[name] = of_the_block[name]
    for name in names if count else ():
        row[name] = block[name]
    assert row.tobytes() == encode(schema, block)


def test_alignment_of_every_number_type():
    types = [
        "uint8",
        "int64",
        "bool",
        "int16",
        "float32",
        "uint8",
        "float64[2]",
        "string",
        "uint16[]",
        "float64[]",
        "int8",
    ]
    schema = parse_schema(
        "my/msg/Mix", "".join(f"{kind} {name}\n" for kind, name in zip(types, "abcdefghijk", strict=True))
    )
    values = SimpleNamespace(a=1, b=-2, c=True, d=-3, e=0.5, f=4, g=[1.5, 2.5], h="ä", i=[5, 6, 7], j=[], k=-8)
    data = encode(schema, values)
    decoded = decode(schema, data)
    assert data == encode(schema, vars(values))
    for field in schema.fields:
        value = getattr(decoded, field.name)
        assert (list(value) if field.length is not None else value) == getattr(values, field.name)
    places = {place.name: place.offset for place in Layout(schema, values).places}
    assert places == {"a": 4, "b": 12, "c": 20, "d": 22, "e": 24, "f": 28, "g": 36, "i": 64, "k": 76}


def test_rclpy_reads_and_writes_the_same(blocks):
    serialization = pytest.importorskip("rclpy.serialization", reason="ROS 2 is not installed")
    messages = pytest.importorskip("cnc_ptp.msg", reason="the interfaces are not built (make setup)")
    for maker, type_name in BLOCK_TYPES.items():
        schema = load_schema(f"cnc_ptp/msg/{type_name}")
        block = getattr(blocks, maker)(990)
        data = encode(schema, block, lambda value: header_at(1_500_000_002))
        message = serialization.deserialize_message(data, getattr(messages, type_name))
        same(message, block, schema)
        assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1, 500_000_002)
        back = serialization.serialize_message(message)
        # Fast CDR initialises no padding, and reserves some for empty columns
        empty = sum(1 for field in schema.fields if field.length is not None and not getattr(block, field.name))
        assert 0 <= len(back) - len(data) <= 4 * empty + 3
        same(decode(schema, back), block, schema)


def test_states_written_by_rclpy_are_read_at_once():
    serialization = pytest.importorskip("rclpy.serialization", reason="ROS 2 is not installed")
    messages = pytest.importorskip("cnc_ptp.msg", reason="the interfaces are not built (make setup)")
    layout = fixed_layout(load_schema("cnc_ptp/msg/SpindleState"))
    written = []
    for cycle in range(20):
        message = messages.SpindleState(
            cycle=cycle, set_speed_rpm=cycle * 1.5, mode=cycle, speed_zero=cycle % 2 == 0, error_id=9
        )
        written.append(serialization.serialize_message(message))
    rows = layout.read(b"".join(written))
    assert rows["cycle"].tolist() == list(range(20))
    assert rows["set_speed_rpm"].tolist() == [cycle * 1.5 for cycle in range(20)]
    assert rows["mode"].tolist() == list(range(20))
    assert rows["speed_zero"].tolist() == [cycle % 2 == 0 for cycle in range(20)]
    assert rows["error_id"].tolist() == [9] * 20


def test_zero_has_every_field():
    schema = load_schema("cnc_ptp/msg/CommandRecord")
    same(decode(schema, encode(schema, zero(schema))), CommandRecord(0, "", "", "", False, 0, ""), schema)


def struct_reason(code, value):
    """What this version of Python says of a value that does not fit."""
    with pytest.raises(struct.error) as error:
        struct.pack(code, value)
    return str(error.value)


@pytest.mark.parametrize(
    ("text", "value", "reason"),
    [
        ("uint8 a\n", {"a": 300}, struct_reason("B", 300)),
        ("float64[3] a\n", {"a": [1.0]}, "a holds 1 values instead of 3"),
        ("uint8 a\n", {}, "'a'"),
        ("uint8 a\n", SimpleNamespace(), "'types.SimpleNamespace' object has no attribute 'a'"),
        ("string a\n", {"a": None}, "object of type 'NoneType' has no len()"),
    ],
)
def test_values_that_do_not_fit_are_refused(text, value, reason):
    with pytest.raises(CncError) as error:
        encode(parse_schema("my/msg/Thing", text), value)
    assert str(error.value) == f"P-ERR-26006 recording: my/msg/Thing cannot be encoded: {reason}; it was not recorded"
