"""`python -m bench.long_path BLOCKS`: plans and runs so many short blocks; prints the largest resident size in MiB."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from math import cos, sin

from bench.big_program import largest
from bench.lookahead import Point, run


def points(blocks: int) -> Iterator[Point]:
    """Chords of 0.05 mm along a closed curve, rounded to 1 µm, again and again."""
    for n in range(blocks + 1):
        angle = 0.05 / 40.0 * (n % 1_000_000)
        yield round(40.0 * cos(angle), 3), round(40.0 * sin(angle), 3), round(5.0 * sin(3.0 * angle), 3)


if __name__ == "__main__":
    run(points(int(sys.argv[1])))
    print(largest())
