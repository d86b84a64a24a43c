"""Cost of recording: 3 axes, spindle and channel in blocks of 10 cycles, compared with mcap.Writer."""

from __future__ import annotations

import math
import tempfile
import tracemalloc
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from mcap.writer import CompressionType, Writer

from bench.figures import Effort, Figure, ShowProgress, median_of, medians_of, stopwatch
from cnc_ptp.plots.report import report_page
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, CycleBlock, CycleTick, PlcBlock, SpindleBlock
from cnc_ptp.recording.reader import iter_messages, read_recording
from cnc_ptp.recording.stored_states import read_stored
from cnc_ptp.recording.verify import verify
from cnc_ptp.recording.writer import Recording
from cnc_ptp.wire.schemas import load_schema

BLOCKS = 2000
COUNT = 10
AXES = ("x", "y", "z")
MACHINE = "/machine: {}\n"
CYCLE_TIME = 1e-3

Run = list[list[tuple[str, CycleBlock]]]


def run_of_blocks(blocks: int) -> Run:
    """Sinusoidal motion, every number different: the worst case for compression."""
    return [unit_blocks(COUNT * index) for index in range(blocks)]


def unit_blocks(first: int, axes: tuple[str, ...] = AXES) -> list[tuple[str, CycleBlock]]:
    """The blocks of all units from cycle `first` on."""

    def wave(factor: float) -> list[float]:
        return [100.0 * math.sin(1e-3 * factor * (first + i)) for i in range(COUNT)]

    def flat(value: float) -> list[float]:
        return [value] * COUNT

    zero, on, off = [0] * COUNT, [True] * COUNT, [False] * COUNT

    def setpoints(factor: float) -> list[float]:
        return [value for axis in range(len(axes)) for value in wave(factor + axis)]

    channel = ChannelBlock(
        first,
        COUNT,
        path_active=True,
        axes=list(axes),
        set_position=setpoints(1.0),
        set_velocity=setpoints(2.0),
        set_acceleration=setpoints(3.0),
        set_jerk=setpoints(4.0),
        line=[first // 100] * COUNT,
        block_number=[first // 10] * COUNT,
        path_velocity=wave(1.5),
        programmed_feed=flat(50.0),
        override_percent=flat(100.0),
        distance_to_go=wave(2.5),
        state=[2] * COUNT,
        error_id=zero,
    )
    blocks: list[tuple[str, CycleBlock]] = [("plc", PlcBlock(first, COUNT, first)), ("channel", channel)]
    for index, axis in enumerate(axes):
        moving = [wave(1.0 + index + 0.1 * column) for column in range(8)]
        rest = [flat(0.0), flat(0.0), flat(0.0), flat(0.0), flat(0.0), flat(0.0), flat(100.0)]
        blocks.append((axis, AxisBlock(first, COUNT, *moving, *rest, [5] * COUNT, [256] * COUNT, zero)))
    turning = [wave(7.0), wave(7.1), flat(1000.0), flat(0.0), wave(8.0), wave(8.1), wave(8.0), flat(0.0), wave(9.0)]
    states = ([2] * COUNT, [1] * COUNT, on, off, off, on, off, [5] * COUNT, [4] * COUNT, zero)
    return [*blocks, ("s", SpindleBlock(first, COUNT, *turning, flat(100.0), flat(0.0), [12000] * COUNT, *states))]


def record_all(path: Path, run: Run) -> None:
    """As the offline run records: tick, PLC, and of each unit the block and its states."""
    with Recording(path, MACHINE) as recording:
        for blocks in run:
            recording.tick(CycleTick(blocks[0][1].first_cycle, COUNT))
            for name, block in blocks:
                recording.block(name, block)


class McapPeer:
    """mcap.Writer with the messages of a recording ready as bytes: it encodes none of them."""

    def __init__(self, recorded: Path) -> None:
        self.messages = list(iter_messages(recorded))

    def write(self, path: Path) -> None:
        with path.open("wb") as stream:
            writer = Writer(stream, compression=CompressionType.ZSTD)
            writer.start("ros2")
            types = {topic: type_name for topic, type_name, _, _ in self.messages}
            channels = {topic: self.channel(writer, topic, type_name) for topic, type_name in types.items()}
            for topic, _, time_ns, cdr in self.messages:
                writer.add_message(channels[topic], time_ns, cdr, time_ns)
            writer.finish()

    def channel(self, writer: Writer, topic: str, type_name: str) -> int:
        schema = load_schema(type_name)
        schema_id = writer.register_schema(type_name, "ros2msg", schema.text.encode())
        return int(writer.register_channel(topic, "cdr", schema_id))


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """Writing, then reading, comparing and the report."""
    run = run_of_blocks(effort.scaled(BLOCKS, least=4))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        record_all(path, run)
        show("writing")
        yield from writing(effort, run, path)
        show("reading")
        yield from reading(effort, run, path)


def seconds(call: Callable[[], object]) -> Callable[[], float]:
    def measure() -> float:
        with stopwatch() as watch:
            call()
        return watch.wall

    return measure


def largest_memory(call: Callable[[], object]) -> float:
    """Bytes that a call needs at once."""
    tracemalloc.start()
    try:
        call()
        return float(tracemalloc.get_traced_memory()[1])
    finally:
        tracemalloc.stop()


def writing(effort: Effort, run: Run, path: Path) -> Iterator[Figure]:
    """Messages per second compared with mcap.Writer; cost of a block."""
    peer = McapPeer(path)
    beside = path.with_name("peer.mcap")
    measures = [lambda: record_all(path, run), lambda: peer.write(beside)]
    everything, theirs = medians_of(effort.runs, [seconds(measure) for measure in measures])
    count, blocks = len(peer.messages), len(run)
    yield Figure(
        "unit blocks to states, blocks, ticks in the file",
        count / everything,
        "messages/s",
        peer="mcap.Writer, ready bytes",
        peer_value=count / theirs,
    )
    yield Figure(f"all of {count / blocks:.0f} messages a block", 1e6 * everything / blocks, "µs/block")
    size = path.stat().st_size / (blocks * COUNT * CYCLE_TIME)
    yield Figure("size of the file, every number different", size / 1e3, "kB/s")


def reading(effort: Effort, run: Run, path: Path) -> Iterator[Figure]:
    """Times real time of reading and comparing; seconds for the report."""
    length = len(run) * COUNT * CYCLE_TIME
    recorded = read_recording(path)
    measures = [
        lambda: read_recording(path),
        lambda: verify(recorded, lambda _: (pair for blocks in run for pair in blocks)),
        lambda: verify(read_stored(path), lambda _: (pair for blocks in run for pair in blocks)),
    ]
    read, compare, from_file = medians_of(effort.runs, [seconds(measure) for measure in measures])
    yield Figure("read a recording", length / read, "× real time")
    yield Figure("compare with a second run", length / compare, "× real time")
    yield Figure("read and compare, states left in the file", length / from_file, "× real time")
    for name, read_states in (("read", read_recording), ("looked through for a comparison", read_stored)):
        yield Figure(f"memory of {length:.0f} s {name}", largest_memory(partial(read_states, path)) / 1e6, "MB")
    page = path.with_suffix(".html")
    report = median_of(effort.runs, seconds(lambda: page.write_text(report_page(recorded), encoding="utf-8")))
    yield Figure(f"report of {length:.0f} s", report, "s")
