"""How far a trial run is, as lines for a program that reads them."""

from __future__ import annotations

import re

WANTED = "CNC_PTP_PROGRESS_LINES"
"""Set in the environment of a command whose reader wants them."""
LINE = re.compile(r".+: (\d{1,3}) %")


def line(label: str, percent: int) -> str:
    return f"{label}: {percent} %"


def percent_of(text: str) -> int | None:
    """None for a line that says something else."""
    found = LINE.fullmatch(text.strip())
    return int(found[1]) if found else None
