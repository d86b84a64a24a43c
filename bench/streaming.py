"""`python -m bench.streaming BLOCKS`: a channel runs a program of many short blocks that it reads as it runs.

Prints the resident size in MiB before the load, with the loaded text and at each tenth of the run. At its end: the
largest of all, how much it has grown since the first tenth, and the blocks per second of processor time. The text alone
is 16 bytes per block; what is beyond it must not grow. `python -m bench streaming` makes figures of the last line.
"""

from __future__ import annotations

import re
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from bench.figures import Effort, Figure, ShowProgress
from bench.jobs import ROOT
from cnc_ptp.channel.channel_unit import ChannelUnit
from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.machine.wiring import build_unit
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import Command, CycleTick

MACHINE = ROOT / "config" / "mill.yaml"
COUNT = 100
"""Cycles of a block."""
MANY = 10_000_000
KIB = 1024.0


def program(blocks: int) -> str:
    """Chords of 0.05 mm on a wave of 40 mm, to and fro along X."""
    lines = [f"X{0.05 * abs(n % 4000 - 2000):.3f} Y{(n % 80 - 40) ** 2 / 1600:.4f}" for n in range(8000)]
    repeats, rest = divmod(blocks, len(lines))
    body = "\n".join(lines)
    return "\n".join(
        ["G01 F6000", "#HSC ON [BSPLINE PATH_DEV=0.01]", *[body] * repeats, "\n".join(lines[:rest]), "#HSC OFF", "M30"]
    )


def resident(what: str) -> float:
    """VmRSS or VmHWM of this process, MiB."""
    found = re.search(rf"{what}:\s+(\d+) kB", Path("/proc/self/status").read_text())
    return int(found[1]) / KIB if found else 0.0


def main(blocks: int) -> None:
    machine = read_machine(MACHINE)
    channel = replace(machine.channels["channel"], checked_text=0)
    unit = build_unit(replace(machine, channels={"channel": channel}), "channel")
    assert isinstance(unit, ChannelUnit)
    runner = UnitRunner(unit, watchdog_cycles=10**12)
    print(f"before the load {resident('VmRSS'):.0f} MiB")
    runner.command(Command("channel", "load", {"program": "big.nc", "text": program(blocks)}))
    unit.take_records()
    assert runner.command(Command("channel", "start", {})).accepted
    print(f"with the text {resident('VmRSS'):.0f} MiB, largest {resident('VmHWM'):.0f} MiB")
    begin, tenth, cycle, early = time.process_time(), 0, 0, 0.0
    while True:
        block = runner.compute(CycleTick(cycle, COUNT), {})
        cycle += COUNT
        unit.take_events()
        unit.take_records()
        if 10 * block.blocks_done >= (tenth + 1) * blocks or block.done:
            tenth += 1
            seconds = time.process_time() - begin
            early = early or resident("VmHWM")
            print(
                f"{block.blocks_done} blocks: {resident('VmRSS'):.1f} MiB, {block.blocks_done / seconds:.0f} blocks/s,"
                f" progress {100.0 * block.progress:.1f} %",
                flush=True,
            )
        if block.done:
            assert block.error_id[-1] == 0
            largest = resident("VmHWM")
            print(largest, largest - early, block.blocks_done / (time.process_time() - begin))
            return


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """A whole run in a process of its own."""
    blocks = effort.scaled(MANY)
    show(f"{blocks:,} blocks")
    done = subprocess.run(
        [sys.executable, "-m", "bench.streaming", str(blocks)], cwd=ROOT, check=True, capture_output=True, text=True
    )
    largest, growth, rate = map(float, done.stdout.splitlines()[-1].split())
    yield Figure(f"largest memory, run of {blocks:,} blocks with its text", largest, "MiB", goal=300.0, at_most=True)
    yield Figure("growth behind the first tenth of the run", growth, "MiB", goal=5.0, at_most=True)
    yield Figure("blocks read, planned and run by a channel", rate, "blocks/s")


if __name__ == "__main__":
    main(int(sys.argv[1]))
