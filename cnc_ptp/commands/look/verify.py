"""`cnc_ptp verify`: is a recording what the kernel computes, and does its motion keep to the limits?"""

from __future__ import annotations

import json
import sys

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from cnc_ptp.commands.console import RUN_FAILED
from cnc_ptp.recording.motion_check.check import check_recording
from cnc_ptp.recording.motion_check.findings import MotionResult, Violation

WIDTH = 120
"""Columns that the table has at least: where it is no terminal, nobody cuts it."""


def verify_motion(recording: str, *, as_json: bool = False) -> int:
    """Checks the motion of a recording. Status 1 when there is a violation."""
    result = check_recording(recording)
    if as_json:
        json.dump(result.as_json(), sys.stdout, indent=1)
        print()
    else:
        print_result(result)
    return 0 if result.clean else RUN_FAILED


def print_result(result: MotionResult) -> None:
    """One line, and a table of what is wrong and of what was told."""
    console = Console(highlight=False, soft_wrap=True)
    console.print(result.text().splitlines()[0], markup=False)
    console.width = max(console.width, WIDTH)
    if result.violations:
        console.print(_table("violation", result.violations))
    if result.further:
        console.print(f"{result.further} further violations")
    if result.told:
        console.print(_table("told by a command", result.told))


def _table(title: str, rows: list[Violation]) -> Table:
    table = Table("unit", title, "cycle", "cycles", "time s", "value", "limit", "", box=SIMPLE_HEAD, pad_edge=False)
    for column in table.columns:
        column.no_wrap = True
    for row in rows:
        numbers = [f"{row.time:.4f}", f"{row.value:.9g}", f"{row.limit:.9g}"]
        table.add_row(row.unit, row.what, str(row.cycle), str(row.cycles), *numbers, row.units)
    return table
