"""NC blocks per second: `G1 X Y Z F` lines parsed and modally resolved."""

from __future__ import annotations

import random
import subprocess
import sys
from collections.abc import Iterator

from gcodeparser import parse_gcode_lines

from bench.figures import Effort, Figure, ShowProgress, medians_of, stopwatch
from bench.jobs import ROOT
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel

BLOCKS = 100_000
MANY_BLOCKS = 10_000_000


def program_text(blocks: int) -> str:
    """A program of random straight moves, three axes and a feed in every block."""
    draw = random.Random(1)
    lines = []
    for n in range(1, blocks + 1):
        x, y, z = (draw.uniform(-99, 99) for _ in range(3))
        lines.append(f"N{10 * n} G1 X{x:.3f} Y{y:.3f} Z{z:.3f} F{draw.randint(100, 9000)}")
    return "\n".join([*lines, "M30"])


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """Parsing and interpretation together, then apart."""
    blocks = effort.scaled(BLOCKS)
    text = program_text(blocks)

    def parse() -> float:
        with stopwatch() as watch:
            parse_program(text, "bench.nc")
        return watch.wall / blocks

    program = parse_program(text, "bench.nc")

    def resolve() -> float:
        with stopwatch() as watch:
            for _ in interpret(program, (0.0, 0.0, 0.0), plain_channel("XYZ")):
                pass
        return watch.wall / blocks

    def peer() -> float:
        with stopwatch() as watch:
            list(parse_gcode_lines(text))
        return watch.wall / blocks

    show(f"{blocks:,} blocks")
    parsing, resolving, words_only = medians_of(effort.runs, [parse, resolve, peer])
    yield Figure(
        "`G1 X Y Z F` blocks, text to end points",
        1.0 / (parsing + resolving),
        "blocks/s",
        goal=1.5,
        aim=2.0,
        of_ratio=True,
        peer="gcodeparser, text to words",
        peer_value=1.0 / words_only,
    )
    yield Figure("text to words", 1e6 * parsing, "µs/block")
    yield Figure("modal states, end points", 1e6 * resolving, "µs/block")
    many = effort.scaled(MANY_BLOCKS)
    show(f"a file of {many:,} blocks")
    command = [sys.executable, "-m", "bench.big_program", str(many)]
    done = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    memory, time_us = map(float, done.stdout.split())
    yield Figure(f"largest memory for a file of {many:,} blocks", memory, "MiB", goal=200.0, at_most=True)
    yield Figure("checked and interpreted line by line", time_us, "µs/block")
    show("a loop with assignments")
    yield Figure("assignments in a $FOR loop", medians_of(effort.runs, [assignments])[0], "/s", goal=300_000.0)


def assignments() -> float:
    """P2 = P2 + P1 * 2 for a counter; assignments per second."""
    program = parse_program(f"P2 = 0\n$FOR P1 = 1, {BLOCKS}, 1\nP2 = P2 + P1 * 2\n$ENDFOR\nM30", "loop.nc")
    with stopwatch() as watch:
        for _ in interpret(program, (0.0,), plain_channel("X")):
            pass
    return BLOCKS / watch.wall
