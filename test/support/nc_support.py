"""Helpers of the NC tests: run a text to its canonical blocks, read the machine that a program names."""

from pathlib import Path
from typing import Any

from cnc_ptp.commands.language.canonical_text import format_block
from cnc_ptp.nc.canonical import CanonicalBlock
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.program import Pair, Spindle, SpindleTable, Vocabulary
from cnc_ptp.nc.vocabularies import VOCABULARIES

AXES = ("X", "Y", "Z")
SPINDLES = ("S", "S2")
HERE = Path(__file__).parents[1] / "nc"


def run(text: str, axes: tuple[str, ...] = AXES, **options: Any) -> list[CanonicalBlock]:
    """All canonical blocks of a program text from position 0; the text needs no M30."""
    vocabulary = VOCABULARIES[options.pop("dialect", "twincat")]
    program = parse_program(text, "test.nc", mdi=True, files=options.pop("files", {}), vocabulary=vocabulary)
    start = options.pop("start", (0.0,) * len(axes))
    spindles = options.pop("spindles", SPINDLES)
    return list(interpret(program, start, axes, spindles, **options))


def lines(text: str, **options: Any) -> list[str]:
    """The same as text without line and block number."""
    return [format_block(block).partition(" | ")[2] for block in run(text, **options)]


GEARS = ((50.0, 560.0), (400.0, 800.0), (700.0, 3500.0), (3501.0, 4000.0), (3800.0, 5500.0), (5400.0, 7000.0))
"""The example of TF5200 spindle p.36, rpm."""


def three_spindles(**main: Any) -> SpindleTable:
    """S1 (6), S2 (11), S3 (30) as in TF5200 spindle p.65, S1 is the main spindle S; `main` changes S1."""
    first = Spindle("S", "S1", 6)._replace(**main)
    gear_change = "ranges" in main
    return SpindleTable((first, Spindle("S2", "S2", 11), Spindle("S3", "S3", 30)), "S", gear_change)


def limited_spindles() -> SpindleTable:
    """S up to 4000 rpm; S2 in the second of two gears, up to 2000 rpm."""
    second = Spindle("S2", "S2", 11, limits=(500.0, 2000.0), gear=2)
    return SpindleTable((Spindle("S", "S1", 6, limits=(4000.0,)), second), "S")


TABLES = {
    "three": three_spindles(),
    "gears": three_spindles(ranges=GEARS[:5]),
    "automatic": three_spindles(ranges=GEARS, automatic=True),
    "plc": three_spindles(plc_control=True)._replace(gear_change=True),
    "limited": limited_spindles(),
    "linked": three_spindles()._replace(default_link=(Pair("S2", "S"),)),
    "wrongly_linked": three_spindles()._replace(default_link=(Pair("S", "S2"),)),
}
"""What a program may name in its comment in place of spindles."""


def vocabulary_of(text: str) -> Vocabulary:
    """From a comment `; dialect iso` in one of the first three lines."""
    return VOCABULARIES["iso" if "; dialect iso" in text.split("\n")[:3] else "twincat"]


def machine(text: str) -> tuple[tuple[str, ...], tuple[str, ...] | SpindleTable]:
    """Axes and spindles from a comment `; machine X Y Z / S S2` in one of the first two lines, else the default."""
    for line in text.split("\n")[:2]:
        if line.startswith("; machine"):
            axes, spindles = line.removeprefix("; machine").split("/")
            return tuple(axes.split()), TABLES.get(spindles.strip()) or tuple(spindles.split())
    return AXES, SPINDLES
