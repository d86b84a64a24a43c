"""Writes a program as a CAM system does: a surface in rows and a pocket in rings, nearly all of it short chords.

    python examples/contour.py contour.nc [BLOCKS]

150,000 blocks by default, with points rounded to 0.001 mm. The chords are as long as 0.001 mm of deviation permits,
from 0.02 to 0.5 mm: the surface has radii from 3 mm to nearly flat, the rings straight sides, round and sharp corners.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from itertools import chain, islice
from math import cos, exp, hypot, pi, sin, sqrt
from pathlib import Path

BLOCKS = 150_000
DEVIATION = 0.001
SHORTEST, LONGEST = 0.02, 0.5
ROW_LENGTH, ROW_STEP = 120.0, 0.25
Point = tuple[float, float, float]


def height(x: float, y: float) -> float:
    """mm: long waves, and a hill whose flanks are steep."""
    hill = 8.0 * exp(-((x - 70.0) ** 2 + (y - 40.0) ** 2) / 120.0)
    return hill + 3.0 * sin(x / 9.0) * cos(y / 14.0) + 0.15 * sin(x / 1.5) * exp(-(((x - 30.0) / 12.0) ** 2))


def chord(x: float, y: float) -> float:
    """mm that a chord may have at a place of a row, by the curvature of the row."""
    step = 0.01
    before, here, behind = height(x - step, y), height(x, y), height(x + step, y)
    slope, bend = (behind - before) / (2.0 * step), (before - 2.0 * here + behind) / (step * step)
    curvature = abs(bend) / (1.0 + slope * slope) ** 1.5
    length = sqrt(8.0 * DEVIATION / curvature) if curvature > 8.0 * DEVIATION / LONGEST**2 else LONGEST
    return max(length, SHORTEST) / hypot(1.0, slope)


def row(y: float, *, forward: bool) -> Iterator[Point]:
    x = 0.0
    while x < ROW_LENGTH:
        at = x if forward else ROW_LENGTH - x
        yield at, y, height(at, y)
        x += chord(at, y)
    at = ROW_LENGTH if forward else 0.0
    yield at, y, height(at, y)


def surface(rows: int) -> Iterator[Point]:
    """Rows to and fro, with a step aside and a sharp corner between them."""
    for number in range(rows):
        yield from row(number * ROW_STEP, forward=number % 2 == 0)


def ring(inset: float, depth: float) -> Iterator[Point]:
    """A rectangle with round corners of 12 mm less the inset, and sharp ones where nothing is left."""
    radius = max(12.0 - inset, 0.0)
    width, breadth = 60.0 - inset, 40.0 - inset
    turn = min(sqrt(8.0 * DEVIATION / radius), 0.2) if radius > 0.0 else pi
    count = max(1, round(0.5 * pi / turn))
    for quarter, (side_x, side_y) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        x, y = side_x * (width - radius), side_y * (breadth - radius)
        for number in range(count + 1):
            angle = 0.5 * pi * (quarter + number / count)
            yield x + radius * cos(angle), y + radius * sin(angle), depth


def pocket(layers: int) -> Iterator[Point]:
    for layer in range(layers):
        for number in range(36):
            yield from ring(number * 0.75, -0.5 * (layer + 1))


def points(blocks: int = BLOCKS) -> Iterator[Point]:
    """The first `blocks` points of pocket and surface."""
    return islice(rounded(chain(pocket(6), surface(10**6))), blocks)


def rounded(path: Iterable[Point]) -> Iterator[Point]:
    """Points to 0.001 mm; none follows itself."""
    last = (0.0, 0.0, 0.0)
    for x, y, z in path:
        point = (round(x, 3), round(y, 3), round(z, 3))
        if point != last:
            yield point
            last = point


def program(path: Iterable[Point]) -> Iterator[str]:
    """The lines: only the words that change, as CAM systems write them."""
    yield "%CONTOUR"
    yield "N10 G90 G17 G21"
    yield "N20 #HSC ON [BSPLINE PATH_DEV=0.005]"
    last: list[str] = ["", "", ""]
    for number, point in enumerate(path):
        words = [f"{axis}{value:.3f}".rstrip("0").rstrip(".") for axis, value in zip("XYZ", point, strict=True)]
        changed = "".join(word for word, before in zip(words, last, strict=True) if word != before)
        yield f"G01 {changed} F6000" if number == 0 else changed
        last = words
    yield "#HSC OFF"
    yield "M30"


def main() -> None:
    blocks = int(sys.argv[2]) if len(sys.argv) > 2 else BLOCKS
    with Path(sys.argv[1]).open("w") as file:
        file.writelines(f"{line}\n" for line in program(points(blocks)))


if __name__ == "__main__":
    main()
