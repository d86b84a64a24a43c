"""NC programs, in both vocabularies: with tables of tools and offsets and a clamp position, or without them; some are
checked on a machine of config or examples, too.
"""

from __future__ import annotations

import random
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

from bench.fuzzing.engine import Target
from bench.fuzzing.mutation import mutated_text
from bench.jobs import ROOT
from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.nc.canonical_text import format_block
from cnc_ptp.nc.coordinates.codes import initial_state
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import parse_all
from cnc_ptp.nc.plain_channel import plain_channel
from cnc_ptp.nc.program import Limits
from cnc_ptp.nc.vocabularies import VOCABULARIES
from cnc_ptp.parameters import NO_OFFSET_TABLES, NO_TOOLS, OffsetTables, Tool, ToolTable, read_machine

AXES = ("X", "Y", "Z")
SPINDLES = ("S", "S2")
LIMITS = Limits(call_depth=5, repeats=200)
RECORDS = {
    1: Tool(number=1, length=75.0, radius=5.0, wear_length=-0.25),
    2: Tool(number=2, length=110.5, offsets=(0.5, -0.25, 0.0), values=(12.0, 0.5)),
    3: Tool(number=3, length=40.0, offsets=(10.0, 20.0, 0.0), fixed=True),
    7: Tool(number=7, valid=False),
}
TOOLS = (
    NO_TOOLS,
    *(ToolTable(RECORDS, True, with_t, at_once) for with_t in (False, True) for at_once in (False, True)),
)
OFFSETS = (
    NO_OFFSET_TABLES,
    OffsetTables({1: (100.0, -50.5, 3.0), 7: (1.0, 2.0, 3.0)}, {7: frozenset({1})}, clamp={1: (1.5, 0.0, -2.0)}),
    OffsetTables({0: (1.0, 1.0, 1.0), 1: (5.0, 5.0, 5.0)}, default=1, g53=True, clamp={0: (0.5, 0.5, 0.5)}),
)
WORDS = (
    *(
        "P1",
        "P[",
        "]",
        "[",
        "V.P.A",
        "V.L.B[1]",
        "@P1",
        "=",
        "==",
        "+",
        "-",
        "*",
        "/",
        "**",
        " MOD ",
        "SIN[",
        "SQRT[",
        '"',
    ),
    *("$IF ", "$ELSE", "$ENDIF", "$FOR P1=1,3,1", "$ENDFOR", "$WHILE ", "$ENDWHILE", "$GOTO ", "N10:", "[A]", "#VAR"),
    *(
        "#ENDVAR",
        "#CS ON [",
        "#CS OFF",
        "#ROTATION ON [ANGLE=",
        "#SCALE X2",
        "#PSET X1",
        "#MSG [",
        "#ERROR [ID=",
        "#FLUSH",
    ),
    *(
        "G54",
        "G159=",
        "G92 X1",
        "G21",
        "G70",
        "G98 X",
        "LL UP",
        "L CYCLE [NAME=a.nc @P1=",
        "%L UP",
        "M29",
        "M30",
        "\\",
        "\n",
    ),
    *("G81 X1 Y1 Z-1 R1", "G83 Z-5 R1 Q", "L3", "G28 X0", "G53 ", "G43 H", "G54.1 P", "G10 L20 P1 X", "M98 P", "M99"),
    *("O100", "%", "G92.2", "G80", "#1=", "o<a> call", "G64 P", "K2", "G90.1", "G93", "F"),
    *(
        "T1 M6",
        "D1",
        "D2 ",
        "D0",
        "T3 ",
        "G160=1 X1",
        "G160=0 Y",
        "V.G.NP[1].V.X=",
        "V.G.NP_AKT.V.Y",
        "V.G.NP_DEFAULT=",
    ),
    *("V.G.WZ[2].L", "V.G.WZ_AKT.R=", "V.A.PZV.X", "#MCS ON", "#MCS OFF", "#ACS ON [0,0,0,30,", "G02 X10 I5 F100"),
    *("G18 G03 Z5 R4 F9", "#CONTOUR MODE [DEV PATH_DEV=", "#HSC ON [BSPLINE PATH_DEV=0.1]", "G261", "G49", "G43 H2 Z5"),
    *("'H", "/2", "(", ")", ";", "%d", "9" * 12, ".", ",", "\t", "\x00", "\ufeff", "é", "1e9", "-113.0", "0.1"),
)
"""Pieces that make mutations meaningful."""


MACHINES = (
    "config/mill.yaml",
    "config/lathe.yaml",
    "examples/probe.yaml",
    "examples/spindles/three_spindles.yaml",
    "examples/spindles/gears_programmed.yaml",
)
ON_MACHINES = 0.1
"""Part of the programs that are checked on one of them."""


def corpus(dialect: str = "") -> list[str]:
    """Programs to start from: all of the tests and the examples, or those of one vocabulary."""
    files = [*(ROOT / "test" / "nc").rglob("*.nc"), *(ROOT / "examples").rglob("*.n*c")]
    texts = [file.read_text(encoding="utf-8") for file in sorted({*files})]
    return [text for text in texts if dialect in ("", dialect_of(text))]


def dialect_of(text: str) -> str:
    return "iso" if "dialect iso" in text else "twincat"


@cache
def machine_check(machine: str) -> ProgramCheck:
    """Of the first channel of a machine file."""
    parameters = read_machine(ROOT / machine)
    channels = {name: replace(channel, repeats=LIMITS.repeats) for name, channel in parameters.channels.items()}
    return ProgramCheck.of_first_channel(replace(parameters, channels=channels), "fuzz.nc")


class Given(NamedTuple):
    """A program, and what it is interpreted with. `machine`: also checked on this one, if any."""

    text: str
    dialect: str
    tools: ToolTable
    offsets: OffsetTables
    clamp: int
    machine: str


def target(dialect: str) -> Target:
    """Programs of a vocabulary, or of both, each in its own."""
    texts = corpus(dialect)

    def make(draw: random.Random) -> Given:
        text = mutated_text(texts, draw, WORDS)
        tables = draw.choice(TOOLS), draw.choice(OFFSETS), draw.randrange(2)
        machine = draw.choice(MACHINES) if draw.random() < ON_MACHINES else ""
        return Given(text, dialect or dialect_of(text), *tables, machine)

    return Target(make, interpret_program)


def interpret_program(given: Given) -> None:
    """Raises whatever is no ProgramError."""
    vocabulary = VOCABULARIES[given.dialect]
    files = {"a.nc": "X[@P1]\nM29", "g81.nc": "G00 Z[@P2]\nG01 Z[@P1]\nM29"}
    program, errors = parse_all(given.text, "fuzz.nc", files=files, vocabulary=vocabulary)
    settings: dict[str, Any] = {"tools": given.tools, "offsets": given.offsets, "limits": LIMITS}
    channel = plain_channel(AXES, SPINDLES, vocabulary)._replace(**settings)
    state = initial_state(channel, clamp_index=given.clamp)
    try:
        for block in interpret(program, (0.0, 0.0, 0.0), channel, state=state):
            format_block(block)
    except ProgramError as error:
        errors.append(error)
    if given.machine:
        errors += machine_check(given.machine).errors(given.text, "fuzz.nc", files, vocabulary)
    for error in errors:
        assert error.line >= 1 and error.column >= 1 and error.caret and str(error)
    if errors:
        raise errors[0]
