"""Reading a long recording: an hour of 8 axes at 1 ms, made of one second of blocks that is written again and again."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np
from mcap.records import Channel

import cnc_ptp.recording
from bench import recording as short
from bench.figures import Effort, Figure, ShowProgress, median_of
from cnc_ptp.recording.mcap_chunks import MessageRun
from cnc_ptp.recording.mcap_file import HEAD_SIZE, McapFile
from cnc_ptp.recording.mcap_index import McapIndex
from cnc_ptp.recording.reader import STATE_TYPES
from cnc_ptp.recording.writer import Recording
from cnc_ptp.wire.layout import Bytes, fixed_layout
from cnc_ptp.wire.schemas import parse_schema

HOUR = 3600
AXES = tuple("xyzabcuv")
SECOND_NS = 1_000_000_000
CYCLES = 1000
"""Of a second."""
GIB_MB = 2**30 / 1e6
Write = Callable[[McapFile], None]
NOTHING: Mapping[int, Write] = {}


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """Opening, a column, a second of a recording; goals are those for a whole hour."""
    seconds = effort.scaled(HOUR)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hour.mcap"
        show("writing")
        repeat_second(one_second(Path(folder) / "second.mcap"), path, seconds)
        show("reading")
        length = f"{seconds / 60:.0f} min of {len(AXES)} axes"
        yield from both_times(effort, f"open {length}", 2.0, lambda: cnc_ptp.recording.open(path).close())
        yield from both_times(effort, f"open and one column of {length}", 3.0, lambda: read_column(path))
        with cnc_ptp.recording.open(path) as recording:
            middle = seconds / 2
            one = short.seconds(lambda: recording.frame("/x/state", start=middle, end=middle + 1.0))
            yield Figure("table of a second in the middle", 1e3 * median_of(effort.runs, one), "ms")
        show("report")
        yield from report_figures(path, length)
        yield Figure("size of the file for each axis", path.stat().st_size / seconds / len(AXES) / 1e3, "kB/s")


def both_times(effort: Effort, name: str, goal: float, call: Callable[[], object]) -> Iterator[Figure]:
    """Seconds on the clock, for which the goal is, and of the processors, which other programs do not make longer."""
    spent: list[float] = []

    def measured() -> None:
        begin = time.process_time()
        call()
        spent.append(time.process_time() - begin)

    yield Figure(name, median_of(effort.runs, short.seconds(measured)), "s", goal=goal, at_most=True)
    yield Figure(f"{name}: processor time", statistics.median(spent), "s")


def report_figures(path: Path, length: str) -> Iterator[Figure]:
    """Time and memory of `cnc_ptp report`, in a process of its own; once, as it takes long."""
    command = [sys.executable, "-m", "cnc_ptp", "report", str(path), "-o", str(path.with_suffix(".html"))]
    begin = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - begin
    assert status == 0
    yield Figure(f"report of {length}", seconds, "s", goal=60.0, at_most=True)
    yield Figure(f"report of {length}: processor time", usage.ru_utime + usage.ru_stime, "s")
    yield Figure(f"memory of a report of {length}", usage.ru_maxrss * 1024e-6, "MB", goal=GIB_MB, at_most=True)


def read_column(path: Path) -> None:
    with cnc_ptp.recording.open(path) as recording:
        recording.columns("/x/state")["actual_position"]


def one_second(path: Path) -> Path:
    """All axes move, every number of a moving axis different."""
    with Recording(path, short.MACHINE) as recording:
        for first in range(0, CYCLES, short.COUNT):
            for name, block in short.unit_blocks(first, AXES):
                recording.block(name, block)
    return path


def repeat_second(second: Path, path: Path, seconds: int, before: Mapping[int, Write] = NOTHING) -> None:
    """The chunks of a file of one second, written for each of many seconds; `before` some of them something else."""
    source = McapIndex(second)
    groups = [[(run, run.head["log_time"].copy()) for run in source.runs(c, [*source.channels])] for c in source.chunks]
    with McapFile(path) as file:
        for channel in sorted(source.channels.values(), key=lambda channel: channel.id):
            announce(file, source, channel)
        for index in range(seconds):
            file.finish_chunks()
            if index in before:
                before[index](file)
            for runs in groups:
                for run, times in runs:
                    file.messages(run.channel_id, later(source, run, index), times + index * SECOND_NS)
                file.close_chunk()
    source.close()


def later(source: McapIndex, run: MessageRun, seconds: int) -> Bytes:
    """The messages, the cycles of states and blocks that much later."""
    rows = run.rows.copy()
    schema = source.schemas[source.channels[run.channel_id].schema_id]
    content = rows[:, HEAD_SIZE:]
    if schema.name in STATE_TYPES:
        layout = fixed_layout(parse_schema(schema.name, schema.data.decode()))
        content.view(layout.dtype)["cycle"] += np.uint64(CYCLES * seconds)
    elif schema.name.endswith("Block"):
        place = place_of_first_cycle(content[0])
        cycles = np.ascontiguousarray(content[:, place : place + 8]).view("<u8") + np.uint64(CYCLES * seconds)
        content[:, place : place + 8] = cycles.view(np.uint8)
    return rows


def place_of_first_cycle(block: Bytes) -> int:
    """In its CDR: behind the four bytes before all, two of 4 bytes, and a text with its length; of 8 bytes."""
    text = int.from_bytes(block[12:16].tobytes(), "little")
    return 4 + -(-(12 + text) // 8) * 8


def announce(file: McapFile, source: McapIndex, channel: Channel) -> None:
    schema = source.schemas[channel.schema_id]
    assert file.channel(channel.topic, schema.name, schema.data.decode(), channel.metadata) == channel.id
