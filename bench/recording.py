"""What recording costs: 3 axes, spindle and channel in blocks of 10 cycles; prints figures, the best of n passes."""

import math
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from cnc_ptp.machine.blocks import AxisBlock, Block, ChannelBlock, CycleTick, PlcBlock, SpindleBlock
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.report import write_report
from cnc_ptp.recording.verify import verify
from cnc_ptp.recording.writer import Recording

BLOCKS = 2000
COUNT = 10
AXES = ("x", "y", "z")
MACHINE = "/machine: {}\n"

Run = list[list[tuple[str, Block]]]


def run_of_blocks() -> Run:
    """Sinusoidal motion, every number different: the worst case for compression."""
    return [_blocks(COUNT * index) for index in range(BLOCKS)]


def _blocks(first: int) -> list[tuple[str, Block]]:
    def wave(factor: float) -> list[float]:
        return [100.0 * math.sin(1e-3 * factor * (first + i)) for i in range(COUNT)]

    def flat(value: float) -> list[float]:
        return [value] * COUNT

    zero, on, off = [0] * COUNT, [True] * COUNT, [False] * COUNT

    def setpoints(factor: float) -> list[float]:
        return [value for axis in range(len(AXES)) for value in wave(factor + axis)]

    channel = ChannelBlock(
        first,
        COUNT,
        path_active=True,
        axes=list(AXES),
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
    blocks: list[tuple[str, Block]] = [("plc", PlcBlock(first, COUNT, first)), ("channel", channel)]
    for number, axis in enumerate(AXES):
        moving = [wave(1.0 + number + 0.1 * index) for index in range(8)]
        rest = [flat(0.0), flat(0.0), flat(0.0), flat(0.0), flat(100.0)]
        blocks.append((axis, AxisBlock(first, COUNT, *moving, *rest, [5] * COUNT, [256] * COUNT, zero)))
    turning = [wave(7.0), wave(7.1), flat(0.0), wave(8.0), wave(8.1), wave(9.0), flat(100.0)]
    states = ([2] * COUNT, [1] * COUNT, on, off, on, [4] * COUNT, zero)
    return [*blocks, ("s", SpindleBlock(first, COUNT, *turning, *states))]


def record_all(path: Path, run: Run) -> None:
    """As the offline run records: tick, PLC, and of each unit the block and its states."""
    with Recording(path, MACHINE) as recording:
        for blocks in run:
            recording.tick(CycleTick(blocks[0][1].first_cycle, COUNT))
            for name, block in blocks:
                recording.block(name, block)


def record_states(path: Path, run: Run) -> None:
    """The per-cycle states alone."""
    with Recording(path, MACHINE) as recording:
        for blocks in run:
            for name, block in blocks:
                if not isinstance(block, PlcBlock):
                    recording.states(name, block)


def best(call: Callable[[], object], passes: int) -> float:
    times = []
    for _ in range(passes):
        begin = time.perf_counter()
        call()
        times.append(time.perf_counter() - begin)
    return min(times)


def main() -> None:
    """Measures and prints."""
    passes = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    run = run_of_blocks()
    seconds = BLOCKS * COUNT * 1e-3
    with tempfile.TemporaryDirectory() as folder:
        path, page = Path(folder) / "run.mcap", Path(folder) / "run.html"
        states = best(lambda: record_states(path, run), passes)
        everything = best(lambda: record_all(path, run), passes)
        size = path.stat().st_size / seconds / 1e3
        reading = best(lambda: read_recording(path), passes)
        recorded = read_recording(path)
        verifying = best(lambda: verify(recorded, lambda _: (pair for blocks in run for pair in blocks)), passes)
        reporting = best(lambda: write_report(recorded, page), passes)
    units, messages = len(AXES) + 2, COUNT * (len(AXES) + 2)
    block_us, all_us = 1e6 * states / BLOCKS, 1e6 * everything / BLOCKS
    rates = [seconds / duration for duration in (everything, reading, verifying)]
    print(f"recording: states of {units} units {block_us:.0f} us a block ({block_us / messages:.2f} us a message)")
    print(f"recording: states, blocks, ticks {all_us:.0f} us a block ({rates[0]:.0f} times real time), {size:.0f} kB/s")
    print(f"recording: read {rates[1]:.0f}, compare {rates[2]:.0f} times real time; report {reporting:.2f} s")


if __name__ == "__main__":
    main()
