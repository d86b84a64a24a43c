"""Bytes that are no message of their topic: refused with 26184, and nodes leave them out (found by bench.fuzz)."""

import struct
from types import SimpleNamespace

import pytest
from recording_support import Blocks

from cnc_ptp.errors import CncError
from cnc_ptp.nodes.bridge.coupling_services import pairs_of
from cnc_ptp.nodes.polling_node import PollingNode, chain
from cnc_ptp.nodes.unit.unit_node import UnitNode
from cnc_ptp.protocol.blocks import AxisBlock, PlcBlock, Severity
from cnc_ptp.srv import CoupleCam
from cnc_ptp.wire.block_codec import BlockCodec, codec_of, encode_block, has_plain_header, head_of
from cnc_ptp.wire.fixed_message import FixedMessage
from cnc_ptp.wire.stamps import Stamps
from cnc_ptp.wire.ticks import decode_tick, encode_tick

STAMPS = Stamps(0, 1_000_000)
IGNORED = "; they are ignored"


def refusal(call, *arguments):
    with pytest.raises(CncError) as caught:
        call(*arguments)
    return str(caught.value)


def test_a_block_that_was_cut():
    data = encode_block(Blocks(1).axis(0), STAMPS)
    text = refusal(BlockCodec(AxisBlock).decode, data[:100])
    assert text.startswith("P-ERR-26184 100 bytes are no message AxisBlock: ") and text.endswith(IGNORED)
    text = refusal(BlockCodec(AxisBlock).layout, data[:100])
    assert text.startswith("P-ERR-26184 100 bytes are no message AxisBlock: ") and text.endswith(IGNORED)


@pytest.mark.parametrize("known", [False, True], ids=["first", "known form"])
def test_a_block_with_another_number_of_values_than_cycles(known):
    codec = BlockCodec(AxisBlock)
    data = encode_block(Blocks(1).axis(0), STAMPS)
    if known:
        codec.decode(data)
    wrong = data[:28] + struct.pack("<I", 9) + data[32:]
    assert head_of(wrong)[2] == 9
    reason = "set_position holds 10 values, and count is 9"
    assert refusal(codec.decode, wrong) == f"P-ERR-26184 {len(data)} bytes are no message AxisBlock: {reason}{IGNORED}"
    assert codec.decode(data).count == 10


def test_a_block_without_a_head():
    for read in (head_of, has_plain_header):
        assert (
            refusal(read, b"\0\1\0\0")
            == f"P-ERR-26184 4 bytes are no message of a block: its head alone has 32{IGNORED}"
        )


def test_a_tick_that_was_cut():
    text = refusal(decode_tick, encode_tick(10, 10, 0, 0)[:20])
    assert text.startswith("P-ERR-26184 20 bytes are no message CycleTick: ") and text.endswith(IGNORED)


def test_a_value_topic():
    reader = FixedMessage("cnc_ptp/msg/Switch")
    begin = "P-ERR-26184 8 bytes are no message Switch: "
    assert refusal(reader.read, b"\0\1\0\0\0\0\0\0") == f"{begin}its header alone has 16{IGNORED}"
    assert refusal(reader.read, b"\0\0\0\1\0\0\0\0") == f"{begin}their encapsulation is 00000001, not 00010000{IGNORED}"
    long = b"\0\1\0\0" + bytes(8) + struct.pack("<I", 1 << 31) + bytes(8)
    text = refusal(reader.read, long)
    assert text.startswith("P-ERR-26184 24 bytes are no message Switch: ") and text.endswith(IGNORED)


def test_another_encapsulation_that_cannot_be_read():
    def decode(_data):
        raise RuntimeError("failed to deserialize")

    text = refusal(FixedMessage("cnc_ptp/msg/Switch", decode).read, b"\0\0\0\1")
    assert text == f"P-ERR-26184 4 bytes are no message Switch: failed to deserialize{IGNORED}"


class Unready:
    """What `readable` needs of a node, without a graph."""

    readable, _leave_out = PollingNode.readable, PollingNode._leave_out

    def __init__(self):
        self._unreadable, self.told = set(), []

    def get_name(self):
        return "x"

    def tell_unreadable(self, text):
        self.told.append(text)


def test_a_node_leaves_out_what_it_cannot_read_and_says_so_once():
    node, taken = Unready(), []
    received = node.readable("plc/block", chain(codec_of(PlcBlock).decode, taken.append))
    good = encode_block(PlcBlock(10, 10), STAMPS)
    for data in (good, b"\0\1\0\0", good, b"rubbish", good):
        received(data)
    assert [block.first_cycle for block in taken] == [10, 10, 10]
    [text] = node.told
    assert text.startswith("x: topic plc/block: 4 bytes are no message PlcBlock: ") and text.endswith(IGNORED)


def test_other_errors_of_a_node_are_not_hidden():
    def take(_data):
        raise CncError(22001, "a reason")

    assert refusal(Unready().readable("plc/block", take), b"") == "P-ERR-22001 a reason"


def test_other_nodes_write_it_into_their_log():
    told = []
    node = SimpleNamespace(get_logger=lambda: SimpleNamespace(warning=told.append))
    text = "clock: topic plc/block: 4 bytes are no message of a block: its head alone has 32; they are ignored"
    PollingNode.tell_unreadable(node, text)
    assert told == [f"P-WARN-26184 {text}"]


def test_a_unit_makes_a_warning_of_it():
    told = []

    class Told:
        tell = staticmethod(lambda *words: told.append(words))

    UnitNode.tell_unreadable(Told(), "a text")
    assert told == [(Severity.WARNING, 26184, "a text")]


def test_a_cam_whose_points_are_no_pairs():
    request = CoupleCam.Request(master_points=[0.0, 1.0], slave_points=[5.0])
    text = (
        "P-ERR-22001 axis y: couple_cam refused: 2 master_points and 1 slave_points are no pairs; nothing was changed"
    )
    assert refusal(pairs_of, request, "axis y: couple_cam refused") == text
    request = CoupleCam.Request(master_points=[0.0, 1.0], slave_points=[5.0, 6.0])
    assert pairs_of(request, "") == [[0.0, 5.0], [1.0, 6.0]]
