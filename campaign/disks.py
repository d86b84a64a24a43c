"""Disks that are full, and disks that write nothing for seconds: the machine runs on.

Both are real file systems, which only root can mount.
"""

from __future__ import annotations

import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from campaign import motion
from campaign.load import LoadRow, NotTriedError, condition, finished, started
from cnc_ptp.recording.reader import read_recording

SMALL_KB = 600
"""Of the disk that gets full: some seconds of the mill."""
LARGE_MB = 64
STALLS, STALL = 3, 2.0
"""How often a disk writes nothing, for how many seconds; a reader of blocks has 10 s until some are lost."""
BETWEEN = 1.0
DISK_FULL = 26015


def call(*words: str) -> None:
    """Raises NotTriedError where no file system can be mounted."""
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        raise NotTriedError(f"{' '.join(words[:2])}: {done.stderr.strip()}")


@contextmanager
def mounted(folder: Path, *words: str) -> Iterator[Path]:
    """Raises NotTriedError."""
    folder.mkdir(parents=True, exist_ok=True)
    call("mount", *words, str(folder))
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", str(folder)], check=False)


@condition("disk full")
def full_disk(row: LoadRow, folder: Path, domain: int) -> None:
    """The disk of the recording gets full on the way."""
    with mounted(folder / "small", "-t", "tmpfs", "-o", f"size={SMALL_KB}k", "tmpfs") as disk:
        with started("program", disk, domain) as graph:
            size = -1
            while graph.running and size < graph.recording.stat().st_size:
                size = graph.recording.stat().st_size
                time.sleep(BETWEEN)
            if not graph.running:
                row.problems.append("the run has ended with the disk")
            graph.interrupt()
            if not graph.wait(60.0):
                row.problems.append("the run does not end")
        if f"P-ERR-{DISK_FULL} " not in graph.output:
            row.problems.append(f"the run does not say that the disk was full: {graph.output[-300:]}")
        recorded = read_recording(graph.recording)
        row.figures |= {"cycles": recorded.last_cycle + 1, "kB": graph.recording.stat().st_size / 1e3}
        row.problems += motion.violations(graph.recording)


@condition(f"disk that stalls {STALLS} times for {STALL:g} s")
def slow_disk(row: LoadRow, folder: Path, domain: int) -> None:
    """The disk of the recording writes nothing for some seconds, several times."""
    image = folder / "disk.ext4"
    folder.mkdir(parents=True, exist_ok=True)
    call("truncate", "-s", f"{LARGE_MB}M", str(image))
    call("mkfs.ext4", "-q", str(image))
    with mounted(folder / "slow", "-o", "loop", str(image)) as disk, started("program", disk, domain) as graph:
        for _ in range(STALLS):
            with frozen(disk):
                time.sleep(STALL)
            time.sleep(BETWEEN)
        finished(row, graph, "program")


@contextmanager
def frozen(disk: Path) -> Iterator[None]:
    """Who writes to it waits."""
    call("fsfreeze", "--freeze", str(disk))
    try:
        yield
    finally:
        call("fsfreeze", "--unfreeze", str(disk))
