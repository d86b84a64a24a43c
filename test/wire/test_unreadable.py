"""Bytes that are no message of their topic: refused with 26184, and nodes leave them out (found by bench.fuzz)."""

import struct
from dataclasses import replace
from math import inf
from types import SimpleNamespace

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.serialization import serialize_message
from recording_support import Blocks

from cnc_ptp.errors import CncError
from cnc_ptp.msg import Event, LatenessHistogram
from cnc_ptp.nodes.bridge.coupling_services import pairs_of
from cnc_ptp.nodes.client.latest_blocks import LatestBlocks
from cnc_ptp.nodes.convert import event_of
from cnc_ptp.nodes.monitor import RunMonitor
from cnc_ptp.nodes.polling_node import PollingNode, chain
from cnc_ptp.nodes.recorder import RecorderNode
from cnc_ptp.nodes.unit.unit_node import UnitNode
from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, JobEvent, PlcBlock, Severity, SpindleBlock
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


UNITS = {"axis": AxisBlock, "spindle": SpindleBlock, "channel": ChannelBlock}


@pytest.mark.parametrize("known", [False, True], ids=["first", "known form"])
@pytest.mark.parametrize("unit", UNITS)
def test_a_block_with_a_state_that_no_unit_has(unit, known):
    codec = BlockCodec(UNITS[unit])
    blocks = Blocks(2)
    block = getattr(blocks, unit)(0)
    if known:
        codec.decode(encode_block(block, STAMPS))
    block.state[4] = 99
    data = encode_block(block, STAMPS)
    reason = f"state 99 is not within 0 ... 7{IGNORED}"
    text = f"P-ERR-26184 {len(data)} bytes are no message {UNITS[unit].__name__}: {reason}"
    assert refusal(codec.decode, data) == refusal(codec.check, data, 10) == text
    block.state[4] = 7
    codec.check(encode_block(block, STAMPS), 10)


def test_a_job_with_a_status_that_there_is_not():
    block = Blocks(3).axis(0)
    block.job_events = [JobEvent(1, 5, 0, 0)]
    data = encode_block(block, STAMPS)
    text = f"{len(data)} bytes are no message AxisBlock: status of a job 5 is not within 1 ... 4{IGNORED}"
    assert (
        refusal(codec_of(AxisBlock).decode, data)
        == refusal(codec_of(AxisBlock).check, data, 10)
        == f"P-ERR-26184 {text}"
    )


def test_a_block_without_cycles():
    codec = BlockCodec(AxisBlock)
    data = encode_block(AxisBlock(10, 0), STAMPS)
    text = f"P-ERR-26184 {len(data)} bytes are no message AxisBlock: count is 0{IGNORED}"
    assert refusal(codec.decode, data) == refusal(codec.check, data, 10) == text
    without_columns = data[:28] + struct.pack("<I", 5) + data[32:]
    reason = "set_position holds 0 values, and count is 5"
    assert refusal(codec.decode, without_columns).endswith(f"AxisBlock: {reason}{IGNORED}")


@pytest.mark.parametrize("unit", UNITS)
def test_a_block_of_a_machine_with_other_blocks(unit):
    codec = BlockCodec(UNITS[unit])
    data = encode_block(getattr(Blocks(5), unit)(0, 8), STAMPS)
    reason = f"count is 8, and each tick has 10 cycles{IGNORED}"
    text = f"P-ERR-26184 {len(data)} bytes are no message {UNITS[unit].__name__}: {reason}"
    assert codec.decode(data).count == 8
    assert refusal(codec.decode, data, 10) == refusal(codec.check, data, 10) == text


@pytest.mark.parametrize("known", [False, True], ids=["first", "known form"])
def test_a_path_without_setpoints_of_all_its_axes(known):
    codec = BlockCodec(ChannelBlock)
    block = Blocks(4).channel(0, axes=("x", "y"))
    block.axes, block.path_active = ["x", "y", "z"], not known
    if known:
        codec.decode(encode_block(block, STAMPS))
        block.path_active = True
    data = encode_block(block, STAMPS)
    reason = f"set_position holds 20 values, and its axes have 30 setpoints{IGNORED}"
    text = f"P-ERR-26184 {len(data)} bytes are no message ChannelBlock: {reason}"
    assert refusal(codec.decode, data) == refusal(codec.check, data, 10) == text


def test_an_event_of_a_severity_that_there_is_not():
    for severity in (0, 1, 2):
        assert event_of(serialize_message(Event(severity=severity))).severity == severity
    data = serialize_message(Event(severity=3))
    text = f"P-ERR-26184 {len(data)} bytes are no message Event: severity 3 is not within 0 ... 2{IGNORED}"
    assert refusal(event_of, data) == text


def test_what_a_client_shows_of_a_unit_is_the_last_that_it_can_read():
    told, subscribed = [], {}
    node = SimpleNamespace(
        create_subscription=lambda _of, topic, take, *_rest, **_more: subscribed.update({topic: take}),
        leave_out=lambda topic, error: told.append((topic, str(error))),
    )
    blocks = LatestBlocks(node, {"x": "axis"}, rotary=())
    block = Blocks(1).axis(0)
    block.state[-1], stamps = AxisStateCode.HOMING, Stamps(1_500_000_000, 1_000_000)
    wrong = encode_block(replace(block, state=[99] * 10), stamps)
    subscribed["x/block"](wrong)
    assert blocks.views() == []
    subscribed["x/block"](encode_block(block, stamps))
    [view] = blocks.views()
    assert (view.state, view.cycle, view.stamp) == ("Homing", 10, 1.5)
    subscribed["x/block"](wrong)
    assert blocks.view("x") == view
    reason = f"{len(wrong)} bytes are no message AxisBlock: state 99 is not within 0 ... 7{IGNORED}"
    assert told == [("x/block", f"P-ERR-26184 {reason}")] * 2


def test_what_cannot_be_read_takes_no_place_in_a_recording():
    """Its head alone would be a reason to leave out the block of the unit that comes then."""
    taken = []
    recorder = SimpleNamespace(
        _recording=SimpleNamespace(stamps=STAMPS),
        _block_cycles=10,
        _last_tick=0,
        _next_cycle={"x": 0, "plc": 0},
        _ticked_at=inf,
        _most_ahead=60_000,
        _last_plc=b"",
        _is_new=lambda *head: taken.append(head),
    )
    block = Blocks(1).axis(10)
    good = encode_block(block, STAMPS)
    for wrong in (good[:100], encode_block(replace(block, state=[8] * 10), STAMPS)):
        assert "no message AxisBlock: " in refusal(RecorderNode._on_block, recorder, "x", AxisBlock, wrong)
    plc = encode_block(PlcBlock(10, 10), STAMPS)
    assert "no message PlcBlock: " in refusal(RecorderNode._on_block, recorder, "plc", PlcBlock, plc[:34])
    far = encode_block(PlcBlock(60_010, 10), STAMPS)
    assert "at most 60000 is possible now" in refusal(RecorderNode._on_block, recorder, "plc", PlcBlock, far)
    assert (taken, recorder._last_plc) == ([], b"")
    RecorderNode._on_block(recorder, "x", AxisBlock, good)
    RecorderNode._on_block(recorder, "plc", PlcBlock, plc)
    assert taken == [("x", STAMPS.at(10), 10, 10), ("plc", STAMPS.at(10), 10, 10)] and recorder._last_plc == plc


def test_a_run_that_ends_takes_no_figures_that_are_none():
    monitor = SimpleNamespace(diagnostics={}, _histograms={})
    status = DiagnosticStatus(name="x", hardware_id="cnc_ptp", values=[KeyValue(key="blocks", value="many")])
    data = serialize_message(DiagnosticArray(status=[status]))
    text = f"x: could not convert string to float: 'many'{IGNORED}"
    assert refusal(RunMonitor._on_diagnostics, monitor, data).endswith(f"no message DiagnosticArray: {text}")
    data = serialize_message(LatenessHistogram(source="x", step=[1, 2], blocks=[3]))
    text = f"no message LatenessHistogram: step holds 2 values, and blocks 1{IGNORED}"
    assert refusal(RunMonitor._on_lateness, monitor, data).endswith(text)
    assert monitor.diagnostics == monitor._histograms == {}


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

    readable, leave_out = PollingNode.readable, PollingNode.leave_out

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
