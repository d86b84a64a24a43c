"""Helpers of the NC tests: run a text to its canonical blocks, read the machine that a program names."""

from pathlib import Path
from typing import Any

from cnc_ptp.nc.canonical import CanonicalBlock, format_block
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import parse_program

AXES = ("X", "Y", "Z")
SPINDLES = ("S", "S2")
HERE = Path(__file__).parent


def run(text: str, axes: tuple[str, ...] = AXES, **options: Any) -> list[CanonicalBlock]:
    """All canonical blocks of a program text from position 0; the text needs no M30."""
    program = parse_program(text, "test.nc", mdi=True)
    start = options.pop("start", (0.0,) * len(axes))
    spindles = options.pop("spindles", SPINDLES)
    return list(interpret(program, start, axes, spindles, **options))


def lines(text: str, **options: Any) -> list[str]:
    """The same as text without line and block number."""
    return [format_block(block).partition(" | ")[2] for block in run(text, **options)]


def machine(text: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Axes and spindles from a comment `; machine X Y Z / S S2` in one of the first two lines, else the default."""
    for line in text.split("\n")[:2]:
        if line.startswith("; machine"):
            axes, spindles = line.removeprefix("; machine").split("/")
            return tuple(axes.split()), tuple(spindles.split())
    return AXES, SPINDLES
