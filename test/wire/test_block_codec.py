"""Blocks as bytes: rclpy's own serialisation, and the encoder that walks field by field, are the oracles."""

import math
from dataclasses import fields
from random import Random

import pytest
from rclpy.serialization import deserialize_message
from recording_support import Blocks

from cnc_ptp import msg
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, Command, PlcBlock, Refusal, SpindleBlock
from cnc_ptp.wire.block_codec import BlockCodec, codec_of, encode_block, has_plain_header, head_of, with_plain_header
from cnc_ptp.wire.layout import encode, header_at
from cnc_ptp.wire.schemas import load_schema
from cnc_ptp.wire.stamps import Stamps
from cnc_ptp.wire.ticks import decode_tick, encode_tick

STAMPS = Stamps(1_700_000_000_123_456_789, 1_000_000)
KINDS = ("axis", "spindle", "channel", "channel_with_commands")


def with_texts(block, random):
    """The block with names, flags and numbers beside its columns."""
    if isinstance(block, AxisBlock):
        block.master, block.couples_actual = random.choice(["", "y", "längs"]), random.random() < 0.5
        block.target_velocity, block.modulo_length = random.uniform(0.0, 1e3), 360.0
    elif isinstance(block, SpindleBlock):
        block.master, block.source = random.choice(["", "s2"]), random.choice(["", "channel"])
        block.plc_commands, block.gear_request = random.getrandbits(32), random.getrandbits(8)
    else:
        block.blocks_done, block.done, block.path_active = random.getrandbits(32), True, random.random() < 0.5
    return block


def same(one, other):
    """Equal field for field, NaN equal to NaN, of the same types."""
    if isinstance(one, list):
        return len(one) == len(other) and all(same(*pair) for pair in zip(one, other, strict=True))
    if isinstance(one, float) and math.isnan(one):
        return math.isnan(other)
    return type(one) is type(other) and one == other


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(5))
def test_blocks_come_back_as_they_were(kind, seed):
    """Twice: the first one of a form goes field by field, later ones by the form."""
    random, blocks = Random(seed), Blocks(seed)
    for first_cycle in (0, 10, 20, 24):
        block = with_texts(getattr(blocks, kind)(first_cycle, 10 if first_cycle < 24 else 4), random)
        data = encode_block(block, STAMPS)
        again = codec_of(type(block)).decode(data)
        for field in fields(block):
            assert same(getattr(block, field.name), getattr(again, field.name)), field.name
        assert head_of(data) == (STAMPS.at(first_cycle), first_cycle, block.count)


@pytest.mark.parametrize("kind", KINDS)
def test_the_bytes_are_those_of_the_encoder(kind):
    for seed in range(5):
        block = with_texts(getattr(Blocks(seed), kind)(30), Random(seed))
        schema = load_schema(f"cnc_ptp/msg/{type(block).__name__}")
        assert encode_block(block, STAMPS) == encode(schema, block, STAMPS.header_of)


def test_ros_reads_what_a_plc_sends():
    block = PlcBlock(20, 10, 7, False, True, True, [Command("x", "stop", {}, 3), Command("s", "start", {"mode": "ö"})])
    message = deserialize_message(encode_block(block, STAMPS), msg.PlcBlock)
    assert (message.first_cycle, message.life_sign, message.run_failed) == (20, 7, True)
    assert [(sent.target, sent.arguments_json) for sent in message.commands] == [("x", "{}"), ("s", '{"mode": "ö"}')]
    assert codec_of(PlcBlock).decode(encode_block(block, STAMPS)) == block


def test_the_refusals_of_a_spindle_travel_as_texts():
    block = Blocks(10).spindle(0)
    block.refused = [
        Refusal("channel", 24012, "spindle s: orient refused: busy; nothing was changed"),
        Refusal("a", 1, ""),
    ]
    data = encode_block(block, STAMPS)
    assert deserialize_message(data, msg.SpindleBlock).refused == [
        "channel: P-ERR-24012 spindle s: orient refused: busy; nothing was changed",
        "a: P-ERR-1 ",
    ]
    assert codec_of(SpindleBlock).decode(data).refused == block.refused


def test_messages_of_equal_size_and_another_form():
    """Four more letters in one name, four fewer in another: the lengths inside decide, not the size."""
    codec, blocks = codec_of(SpindleBlock), Blocks(3)
    for master, source in (("abcde", "x"), ("x", "abcde"), ("abcde", "x")):
        block = blocks.spindle(0)
        block.master, block.source = master, source
        data = encode_block(block, STAMPS)
        again = codec.decode(data)
        assert (again.master, again.source, again.error_id) == (master, source, block.error_id)
        assert codec.layout(data).read(data)["error_id"][0].tolist() == block.error_id


def test_forms_of_equal_size_are_kept_beside_each_other(monkeypatch):
    """A PLC reads axes with masters of names of any length in turn: none of them is decoded field by field again."""
    codec = BlockCodec(AxisBlock)
    messages = []
    for master in ("", "x", "xy", "a1"):
        block = Blocks(6).axis(0)
        block.master = master
        messages.append(encode_block(block, STAMPS))
    assert len({len(data) for data in messages}) < len(messages)
    first = [codec.decode(data) for data in messages]
    monkeypatch.setattr(codec, "_decode", None)
    assert [encode_block(codec.decode(data), STAMPS) for data in messages] == messages
    assert [block.master for block in first] == ["", "x", "xy", "a1"]


def test_columns_that_make_up_for_each_other_are_refused():
    block = Blocks(7).axis(0)
    encode_block(block, STAMPS)
    block.set_velocity.append(block.set_position.pop())
    with pytest.raises(CncError) as error:
        encode_block(block, STAMPS)
    assert "set_position holds 9 values; it was not recorded" in str(error.value)


def test_a_message_with_a_frame_id_is_read_too():
    block = Blocks(4).axis(50)
    message = deserialize_message(encode_block(block, STAMPS), msg.AxisBlock)
    schema = load_schema("cnc_ptp/msg/AxisBlock")
    message.header.frame_id = "world"
    data = encode(schema, message)
    assert not has_plain_header(data) and has_plain_header(encode_block(block, STAMPS))
    assert codec_of(AxisBlock).decode(data).error_id == block.error_id
    plain = with_plain_header(AxisBlock, data, STAMPS)
    assert plain == encode_block(block, STAMPS) == with_plain_header(AxisBlock, plain, STAMPS)


def test_a_block_with_columns_of_another_length_is_neither_decoded_nor_recorded():
    """A unit that computed with it would fail."""
    message = encode(load_schema("cnc_ptp/msg/AxisBlock"), AxisBlock(10, 10), lambda _: header_at(0))
    with pytest.raises(CncError) as error:
        codec_of(AxisBlock).decode(message)
    assert str(error.value) == (
        "P-ERR-26184 192 bytes are no message AxisBlock: set_position holds 0 values, and count is 10; they are ignored"
    )
    with pytest.raises(CncError) as error:
        codec_of(AxisBlock).layout(message)
    assert str(error.value) == (
        "P-ERR-26006 recording: AxisBlock with first cycle 10, count 10 does not fit its message: set_position holds 0 "
        "values; it was not recorded"
    )


@pytest.mark.parametrize("filling", range(4))
def test_dds_fills_messages_up(filling):
    """What lies behind a message is not read."""
    for master in ("", "x", "xy", "xyz", "xyzu"):
        block = Blocks(5).axis(0)
        block.master = master
        data = encode_block(block, STAMPS)
        padded = data + b"\xff" * min(filling, -len(data) % 4)
        for _ in range(2):
            assert codec_of(AxisBlock).decode(padded).master == master
        assert codec_of(AxisBlock).layout(padded).dtype.itemsize == len(data)


def test_many_forms_are_not_kept_for_ever():
    codec = codec_of(ChannelBlock)
    for number in range(1100):
        block = Blocks(number).channel(0, count=1, axes=(f"axis{number}",))
        assert codec.decode(codec.encode(block, STAMPS)).axes == block.axes
    assert len(codec._forms) <= 1000 and len(codec._of_words) <= 1000


def test_ticks():
    data = encode_tick(120, 10, 987_654_321, STAMPS.at(120))
    message = deserialize_message(data, msg.CycleTick)
    assert (message.first_cycle, message.count, message.scheduled_monotonic_ns) == (120, 10, 987_654_321)
    assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == STAMPS.at(120)
    assert decode_tick(data) == (120, 10, 987_654_321, STAMPS.at(120))
    assert encode(load_schema("cnc_ptp/msg/CycleTick"), message) == data
