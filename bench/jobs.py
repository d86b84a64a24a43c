"""The jobs that are measured."""

from __future__ import annotations

import math
from pathlib import Path

ROOT = Path(__file__).parent.parent
MACHINE = str(ROOT / "config" / "mill.yaml")
BRACKET = str(ROOT / "examples" / "bracket.nc")
OVERRIDES = str(ROOT / "examples" / "bracket_overrides.yaml")

SHORTEST_ROUND = 4.0
"""Seconds that one round of the long program takes at least."""


def long_program(seconds: float) -> str:
    """A program of more than `seconds`: round after round of short lines, corner arcs and a helix, spindle turning."""
    rounds = math.ceil(seconds / SHORTEST_ROUND)
    lines = ["%ROUNDS", "N1 G17 G90 G162 S3000 M03", "N2 G00 X0 Y0 Z2"]
    for n in range(rounds):
        lines += one_round(half=12.0 + n % 40, corner=3.0 + n % 7, feed=2000 + 100 * (n % 20))
    return "\n".join([*lines, "G00 X0 Y0 Z5", "M05", "M30", ""])


def one_round(*, half: float, corner: float, feed: int) -> list[str]:
    """A square of side 2·`half` with rounded corners, counter-clockwise, and a helix in it (mm, mm/min)."""
    h, r = half, corner
    return [
        f"G01 X{h} Y0 F{feed}",
        f"Y{h - r}",
        f"G03 X{h - r} Y{h} I{-r} J0",
        f"G01 X{r - h}",
        f"G03 X{-h} Y{h - r} I0 J{-r}",
        f"G01 Y{r - h}",
        f"G03 X{r - h} Y{-h} I{r} J0",
        f"G01 X{h - r}",
        f"G03 X{h} Y{r - h} I0 J{r}",
        "G01 Y0",
        f"X{r} Z1",
        f"G03 X{r} Y0 Z-1 I{-r} J0",
        f"G03 X{r} Y0 Z2 I{-r} J0",
    ]
