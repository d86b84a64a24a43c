"""The NC program of a circle test, and the evaluated part of its run.

Each circle starts and ends at rest, and the effects of starting and stopping are not to be measured. So each direction
turns twice, from opposite starting points between the quadrants, and of each turn the half opposite its start counts:
90° of run-in, 180° measured, 90° of run-out. Both halves make a whole circle.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cnc_ptp.commissioning.faults import BAD_PLANE, NOT_COVERED
from cnc_ptp.commissioning.trace import Array
from cnc_ptp.errors import CncError

RUN_IN = 90.0
STARTS = (45.0, 225.0)
"""Degrees; between the quadrants, so that no reversal lies near a seam."""
DWELL = 0.5
"""Seconds of rest before each turn."""


@dataclass(frozen=True, slots=True)
class Plane:
    """A main plane: G function, its axes and the words of the centre along them."""

    code: str
    axes: tuple[str, str]
    words: tuple[str, str]


PLANES = {
    "XY": Plane("G17", ("X", "Y"), ("I", "J")),
    "ZX": Plane("G18", ("Z", "X"), ("K", "I")),
    "YZ": Plane("G19", ("Y", "Z"), ("J", "K")),
}


@dataclass(frozen=True, slots=True)
class Turn:
    """One full circle of the program: its line (from 1), direction, and the angle where it starts."""

    line: int
    clockwise: bool
    start: float


@dataclass(frozen=True, slots=True)
class CircleProgram:
    """The text and its turns; `centre`, `radius` in mm."""

    text: str
    turns: tuple[Turn, ...]
    plane: Plane
    centre: tuple[float, float]
    radius: float


def find_plane(name: str) -> Plane:
    """XY, ZX or YZ, in either order and case. Raises CncError 27024."""
    wanted = set(name.upper())
    for known, plane in PLANES.items():
        if len(name) == 2 and set(known) == wanted:
            return plane
    raise CncError(BAD_PLANE, f"plane {name} is not one of {', '.join(PLANES)}", "nothing was started")


def circle_program(
    plane: Plane,
    *,
    centre: tuple[float, float],
    radius: float,
    feed: float,
    directions: Sequence[bool] = (False, True),
    before: Sequence[str] = (),
) -> CircleProgram:
    """The program for the `directions` (True = clockwise); `before`: blocks ahead of it, without numbers.

    `centre`, `radius` in mm, `feed` in mm/min.
    """
    lines = ["%CIRCLE"]
    blocks = [f"{plane.code} G90 G162", *before]
    turns: list[tuple[int, bool, float]] = []
    for clockwise in directions:
        for start in STARTS:
            offset = [radius * math.cos(math.radians(start)), radius * math.sin(math.radians(start))]
            place = " ".join(_word(axis, c + o) for axis, c, o in zip(plane.axes, centre, offset, strict=True))
            to_centre = " ".join(_word(word, -o) for word, o in zip(plane.words, offset, strict=True))
            blocks += [f"G00 {place}", f"G04 {DWELL:g}"]
            turns.append((len(blocks), clockwise, start))
            blocks.append(f"{'G02' if clockwise else 'G03'} {to_centre} F{feed:.10g}")
    blocks += [f"G04 {DWELL:g}", "M30"]
    lines += [f"N{10 * number} {block}" for number, block in enumerate(blocks, start=1)]
    # Line 1 is the name, block 0 is in line 2.
    placed = tuple(Turn(block + 2, clockwise, start) for block, clockwise, start in turns)
    return CircleProgram("\n".join([*lines, ""]), placed, plane, centre, radius)


def _word(letter: str, value: float) -> str:
    return f"{letter}{value:.9f}".rstrip("0").rstrip(".")


def measured_turn(
    program: CircleProgram, clockwise: bool, line: npt.NDArray[np.int64], points: Array
) -> npt.NDArray[np.bool_]:
    """The cycles that count for a direction: `line` (n,) of the active program, `points` (n, 2) actual positions, mm.

    Raises CncError 27022 if a turn was not driven to its end.
    """
    chosen = np.zeros(len(line), dtype=bool)
    for turn in (turn for turn in program.turns if turn.clockwise == clockwise):
        rows = np.flatnonzero(line == turn.line)
        offsets = points[rows] - np.array(program.centre)
        angles = np.degrees(np.unwrap(np.arctan2(offsets[:, 1], offsets[:, 0])))
        driven = -(angles - turn.start) if clockwise else angles - turn.start
        driven = driven - 360.0 * np.round(driven[:1] / 360.0)
        furthest = float(driven.max()) if len(driven) else 0.0
        if furthest < 360.0 - RUN_IN:
            raise CncError(
                NOT_COVERED,
                f"circle test: the turn in line {turn.line} went {furthest:.1f}° of 360°",
                "nothing was evaluated",
            )
        chosen[rows[(driven >= RUN_IN) & (driven < 360.0 - RUN_IN)]] = True
    return chosen
