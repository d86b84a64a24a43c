"""`python -m bench.fuzz [BYTES] [SEED]`: mutated programs; nothing but ProgramError may come, no hang, no growth."""

from __future__ import annotations

import random
import resource
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow.execution import Limits
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.nc.parser import parse_all
from cnc_ptp.nc.vocabularies import VOCABULARIES

ROOT = Path(__file__).parents[1]
AXES = ("X", "Y", "Z")
SPINDLES = ("S", "S2")
LIMITS = Limits(call_depth=5, repeats=200)
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
    *("'H", "/2", "(", ")", ";", "%d", "9" * 12, ".", ",", "\t", "\x00", "\ufeff", "é", "1e9", "-113.0", "0.1"),
)
"""Pieces that make mutations meaningful."""


def corpus() -> list[str]:
    """Programs to start from: all of the tests and the examples."""
    files = [*(ROOT / "test" / "nc").rglob("*.nc"), *(ROOT / "examples").rglob("*.nc")]
    return [file.read_text(encoding="utf-8") for file in sorted(files)]


def mutated(texts: Sequence[str], draw: random.Random) -> str:
    """One program with a few changes."""
    text = draw.choice(texts)
    for _ in range(draw.randint(1, 6)):
        at = draw.randint(0, len(text))
        end = min(len(text), at + draw.choice((0, 1, 1, 2, 5, 30)))
        kind = draw.randrange(5)
        if kind == 0:
            piece = draw.choice(WORDS)
        elif kind == 1:
            piece = chr(draw.choice((draw.randrange(32, 127), draw.randrange(256))))
        elif kind == 2:
            other = draw.choice(texts)
            begin = draw.randint(0, len(other))
            piece = other[begin : begin + draw.randint(0, 60)]
        elif kind == 3:
            piece = text[at:end] * draw.choice((0, 2, 3, 50))
        else:
            piece = ""
        text = text[:at] + piece + text[end:]
    return text[:20_000]


def survives(text: str) -> None:
    """Raises whatever is no ProgramError."""
    vocabulary = VOCABULARIES["iso" if "dialect iso" in text else "twincat"]
    program, errors = parse_all(text, "fuzz.nc", files={"a.nc": "X[@P1]\nM29"}, vocabulary=vocabulary)
    try:
        for _ in interpret(program, (0.0, 0.0, 0.0), AXES, SPINDLES, limits=LIMITS):
            pass
    except ProgramError as error:
        errors.append(error)
    for error in errors:
        assert error.line >= 1 and error.column >= 1 and error.caret and str(error)


def run(size: int, seed: int) -> Iterator[int]:
    """Mutates programs until `size` bytes were tried; yields the bytes so far. Raises at the first failure."""
    draw, texts, done = random.Random(seed), corpus(), 0
    while done < size:
        text = mutated(texts, draw)
        done += len(text.encode("utf-8", errors="replace"))
        try:
            survives(text)
        except Exception:
            print(repr(text), file=sys.stderr)
            raise
        yield done


def main(size: int, seed: int) -> None:
    begin, slowest, last, programs = time.monotonic(), 0.0, time.monotonic(), 0
    half = 0
    for done in run(size, seed):
        now = time.monotonic()
        slowest, last, programs = max(slowest, now - last), now, programs + 1
        if done > size / 2 and not half:
            half = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    growth = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - half
    seconds = time.monotonic() - begin
    print(f"{size:,} bytes in {programs:,} programs, {seconds:.0f} s, slowest {slowest:.2f} s, growth {growth} KiB")


if __name__ == "__main__":
    main(*(int(word) for word in [*sys.argv[1:], *["1000000", "1"][len(sys.argv) - 1 :]]))
