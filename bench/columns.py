"""Reading a long recording: an hour of 8 axes at 1 ms, made of one second of blocks that is written again and again."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from mcap.records import Channel

import cnc_ptp.recording
from bench import recording as short
from bench.figures import Effort, Figure, ShowProgress, median_of
from cnc_ptp.recording.mcap_file import McapFile
from cnc_ptp.recording.mcap_index import McapIndex
from cnc_ptp.recording.writer import Recording

HOUR = 3600
AXES = tuple("xyzabcuv")
SECOND_NS = 1_000_000_000
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
        opened = median_of(effort.runs, short.seconds(lambda: cnc_ptp.recording.open(path).close()))
        yield Figure(f"open {length}", opened, "s", goal=2.0, at_most=True)
        column = median_of(effort.runs, short.seconds(lambda: read_column(path)))
        yield Figure(f"open and one column of {length}", column, "s", goal=3.0, at_most=True)
        with cnc_ptp.recording.open(path) as recording:
            middle = seconds / 2
            one = short.seconds(lambda: recording.frame("/x/state", start=middle, end=middle + 1.0))
            yield Figure("table of a second in the middle", 1e3 * median_of(effort.runs, one), "ms")
        yield Figure("size of the file for each axis", path.stat().st_size / seconds / len(AXES) / 1e3, "kB/s")


def read_column(path: Path) -> None:
    with cnc_ptp.recording.open(path) as recording:
        recording.columns("/x/state")["actual_position"]


def one_second(path: Path) -> Path:
    """All axes move, every number of a moving axis different."""
    with Recording(path, short.MACHINE) as recording:
        for first in range(0, 1000, short.COUNT):
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
                    file.messages(run.channel_id, run.rows.copy(), times + index * SECOND_NS)
                file.close_chunk()
    source.close()


def announce(file: McapFile, source: McapIndex, channel: Channel) -> None:
    schema = source.schemas[channel.schema_id]
    assert file.channel(channel.topic, schema.name, schema.data.decode(), channel.metadata) == channel.id
