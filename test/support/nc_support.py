"""Helpers of the NC tests: run a text to its canonical blocks, read the machine that a program names."""

from pathlib import Path
from typing import Any

from cnc_ptp.machine.program_files import called_programs
from cnc_ptp.nc.canonical import CanonicalBlock
from cnc_ptp.nc.canonical_text import format_block
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.iso.vocabulary import ISO
from cnc_ptp.nc.modal_state import FacingAxis, Pair
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.program import NO_TURNING_AXES, Channel, Spindle, SpindleTable, TurningAxes, Vocabulary
from cnc_ptp.nc.vocabularies import VOCABULARIES
from cnc_ptp.parameters import NO_TOOLS, Tool, ToolTable

AXES = ("X", "Y", "Z")
SPINDLES = ("S", "S2")
HERE = Path(__file__).parents[1] / "nc"


def run(text: str, axes: tuple[str, ...] = AXES, **options: Any) -> list[CanonicalBlock]:
    """All canonical blocks of a program text from position 0; the text needs no M30.

    `options`: those of `interpret`, fields of its channel, `files`, `dialect`, `spindles`.
    """
    vocabulary = VOCABULARIES[options.pop("dialect", "twincat")]
    program = parse_program(text, "test.nc", mdi=True, files=options.pop("files", {}), vocabulary=vocabulary)
    start = options.pop("start", (0.0,) * len(axes))
    spindles, rotary = options.pop("spindles", SPINDLES), options.pop("rotary", ())
    settings = {name: options.pop(name) for name in Channel._fields if name in options}
    channel = plain_channel(axes, spindles, vocabulary, rotary)._replace(**settings)
    return list(interpret(program, start, channel, **options))


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
    "unpositioned": three_spindles(positioned=False),
    "c_axis": three_spindles()._replace(c_axis="C"),
    "c_axis_milling": three_spindles()._replace(c_axis="C", face_kind=2),
    "linked": three_spindles()._replace(default_link=(Pair("S2", "S"),)),
    "wrongly_linked": three_spindles()._replace(default_link=(Pair("S", "S2"),)),
}
"""What a program may name in its comment in place of spindles."""


def vocabulary_of(text: str) -> Vocabulary:
    """From a comment `; dialect iso` in one of the first three lines."""
    return VOCABULARIES["iso" if "; dialect iso" in text.split("\n")[:3] else "twincat"]


MILLING = {
    1: Tool(number=1, length=75.0, radius=5.0, wear_length=-0.25, wear_radius=-0.01, name="end mill 10 mm"),
    2: Tool(number=2, length=110.5, radius=3.0, offsets=(0.5, -0.25, 0.0), values=(12.0, 0.5)),
    3: Tool(number=3, length=40.0, radius=2.0, offsets=(10.0, 20.0, 0.0), fixed=True, spindle=4),
    7: Tool(number=7, length=60.0, valid=False),
    13: Tool(number=3, length=41.0, radius=2.0),
}
TURNING = {
    5: Tool(number=5, radius=0.8, offsets=(20.5, 41.0), wear=(-0.02, 0.03), orientation=3, type=1),
    15: Tool(number=5, radius=0.8, offsets=(20.5, 38.0), wear=(-0.02, 0.03), orientation=4, type=1),
    6: Tool(number=6, length=30.0, radius=0.4, orientation=8, type=1),
}
TOOLS = {
    "milling": ToolTable(MILLING, True),
    "turning": ToolTable(TURNING, True),
    "with_t": ToolTable(MILLING, True, True),
    "at_once": ToolTable(MILLING, True, False, True),
    "none": ToolTable(complete=True),
    "with_t_none": ToolTable(with_t=True, complete=True),
    "limits": ToolTable({1: Tool(), 2: Tool()}, complete=True),
}
"""What a program may name in a comment `; tools milling` in one of its first three lines."""


def tools(text: str) -> ToolTable:
    """The tool table that a program names."""
    for line in text.split("\n")[:3]:
        if line.startswith("; tools"):
            return TOOLS[line.split()[2]]
    return NO_TOOLS


FACING = {
    "X": TurningAxes((FacingAxis(0),)),
    "incremental": TurningAxes((FacingAxis(0, True, True),), shown=True, feet=True),
    "off": TurningAxes((FacingAxis(0, False, False),)),
    "X and Z": TurningAxes((FacingAxis(0), FacingAxis(2))),
}
"""What a program may name in a comment `; facing X` in one of its first three lines."""


def turning_axes(text: str) -> TurningAxes:
    """The facing axes that a program names."""
    for line in text.split("\n")[:3]:
        if line.startswith("; facing "):
            return FACING[line.removeprefix("; facing ")]
    return NO_TURNING_AXES


def files_of(text: str) -> dict[str, str]:
    """Programs that a text calls: of the test's own library, or of those that ship; none in the vocabulary iso."""
    if vocabulary_of(text) is ISO:
        return {}
    return called_programs(text, [str(HERE / "library")])


def machine(text: str) -> tuple[tuple[str, ...], tuple[str, ...] | SpindleTable]:
    """Axes and spindles from a comment `; machine X Y Z / S S2` in one of the first two lines, else the default."""
    for line in text.split("\n")[:2]:
        if line.startswith("; machine"):
            axes, spindles = line.removeprefix("; machine").split("/")
            return tuple(axes.split()), TABLES.get(spindles.strip()) or tuple(spindles.split())
    return AXES, SPINDLES


def channel_of(text: str) -> Channel:
    """The channel that the comments of a program name: machine, dialect, tools, facing axes."""
    axes, spindles = machine(text)
    channel = plain_channel(axes, spindles, vocabulary_of(text))
    return channel._replace(tools=tools(text), turning=turning_axes(text))
