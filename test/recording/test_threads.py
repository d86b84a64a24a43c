"""Threads in a recording: written per cycle from the channel's blocks, read, chosen, compared."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from recording_support import Blocks, record

from cnc_ptp.protocol.blocks import ChannelBlock, CycleBlock
from cnc_ptp.recording.fields import chosen_rows
from cnc_ptp.recording.reader import Recorded, read_recording
from cnc_ptp.recording.selection import selected
from cnc_ptp.recording.verify import verify
from cnc_ptp.recording.writer import Recording
from cnc_ptp.wire.block_codec import codec_of, encode_block
from cnc_ptp.wire.stamps import Stamps

NUMBERS = ("axis", "spindle")
FIELDS = ("lead", "set_pitch_error", "actual_pitch_error", "set_phase_error_deg", "actual_phase_error_deg")
COUNT = 30
THREAD_BLOCKS = range(10, 20)


def run(*, threads: bool = True) -> Iterator[tuple[str, CycleBlock]]:
    """Blocks of ten cycles; those from 10 to 19 hold a thread, which begins with the third cycle of block 9."""
    for name, block in Blocks(5).machine(COUNT):
        if threads and isinstance(block, ChannelBlock) and block.first_cycle // 10 in THREAD_BLOCKS:
            for number, field in enumerate(FIELDS):
                values = [100.0 * number + block.first_cycle - 10.0 + cycle for cycle in range(10)]
                if block.first_cycle == 100:
                    values[:3] = [math.nan] * 3
                setattr(block, f"thread_{field}", values)
            for number, field in enumerate(NUMBERS):
                setattr(block, f"thread_{field}", [7 + number] * 10)
        yield name, block


def recorded_run(path: Path, *, threads: bool = True) -> Recorded:
    record(path, list(run(threads=threads)), chunk_seconds=0.05)
    return read_recording(path)


def test_states_of_threads_are_those_of_the_cycles_before_the_block(tmp_path):
    recorded = recorded_run(tmp_path / "run.mcap")
    rows = recorded.threads["channel"]
    assert rows["cycle"].tolist() == list(range(90, 190))
    for number, field in enumerate(FIELDS):
        assert rows[field][3:].tolist() == [100.0 * number + cycle for cycle in range(93, 190)]
        assert np.isnan(rows[field][:3]).all()
    stamps = rows["header.stamp.sec"] * 1_000_000_000 + rows["header.stamp.nanosec"]
    assert (stamps - recorded.start_ns).tolist() == [cycle * 1_000_000 for cycle in range(90, 190)]
    assert recorded.topics["/channel/thread"].type_name == "cnc_ptp/msg/ThreadState"
    assert "/channel/thread" not in recorded.states
    assert [set(rows[name].tolist()) for name in NUMBERS] == [{7}, {8}]


def test_encoded_blocks_give_the_same_states(tmp_path):
    """In the graph the recorder gets bytes."""
    recorded, path = recorded_run(tmp_path / "run.mcap"), tmp_path / "graph.mcap"
    stamps = Stamps(recorded.start_ns, 1_000_000)
    with Recording(path, "", recorded.start_ns) as recording:
        for name, block in run():
            recording.encoded_block(name, type(block), encode_block(block, stamps))
    assert read_recording(path).threads["channel"].tobytes() == recorded.threads["channel"].tobytes()


def test_a_block_comes_back_from_its_bytes_to_the_bit():
    for _, block in run():
        if isinstance(block, ChannelBlock):
            codec = codec_of(ChannelBlock)
            data = codec.encode(block, Stamps(0, 1_000_000))
            assert codec.encode(codec.decode(data), Stamps(0, 1_000_000)) == data


def test_a_recording_without_a_thread_has_no_topic_for_it(tmp_path):
    recorded = recorded_run(tmp_path / "run.mcap", threads=False)
    assert recorded.threads == {}
    assert "/channel/thread" not in recorded.topics


def test_verify_compares_threads(tmp_path):
    recorded = recorded_run(tmp_path / "run.mcap")
    assert verify(recorded, lambda _: run()).equal
    recorded.threads["channel"] = recorded.threads["channel"].copy()
    recorded.threads["channel"]["set_pitch_error"][40] += 1e-9
    [difference] = verify(recorded, lambda _: run()).first
    assert (difference.topic, difference.cycle, difference.field) == ("/channel/thread", 130, "set_pitch_error")


def test_an_older_recording_is_verified_without_its_threads(tmp_path):
    recorded = recorded_run(tmp_path / "run.mcap", threads=False)
    result = verify(recorded, lambda _: run())
    assert result.equal
    assert result.text().splitlines()[1] == "note: recorded without /channel/thread (/channel/state): not compared"


def test_a_part_of_a_recording_has_the_threads_of_its_time(tmp_path):
    recorded = recorded_run(tmp_path / "run.mcap")
    part = selected(recorded, begin=0.1, end=0.12)
    assert part.threads["channel"]["cycle"].tolist() == list(range(100, 120))
    assert selected(recorded, begin=0.25).threads == {}


@pytest.mark.parametrize(
    ("word", "measure"), [("channel/thread/set_pitch_error", "mm"), ("actual_phase_error", "deg"), ("lead", "mm")]
)
def test_fields_of_threads_can_be_drawn(tmp_path, word, measure):
    [row] = chosen_rows(recorded_run(tmp_path / "run.mcap"), [word], {}, {})
    assert row.measure == measure
    assert row.unit == "channel/thread"
