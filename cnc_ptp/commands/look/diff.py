"""`cnc_ptp diff`, `cnc_ptp replay --diff`: two recorded runs beside each other, as a table and as a page."""

from __future__ import annotations

from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from cnc_ptp.commands.output_file import check_page, write_output
from cnc_ptp.recording.difference import RUN
from cnc_ptp.recording.long_recording import read_own
from cnc_ptp.recording.run_difference import RunDifference, difference
from cnc_ptp.recording.selection import selected

WIDTH = 100
"""Columns that the table has at least: where it is no terminal, nobody cuts it."""


def diff(first: str, second: str, output: str | None, begin: float | None = None, end: float | None = None) -> int:
    """Prints where the runs part; `output`: a page of both."""
    check_diff_page(output, recording=first, second_recording=second)
    show_difference(first, second, output, (first, second), begin, end)
    return 0


def check_diff_page(page: str | None, **inputs: str | None) -> None:
    """Raises CncError 27030 before anything is computed."""
    if page is not None:
        check_page(page, **inputs)


def show_difference(
    first: str,
    second: str,
    page: str | None,
    names: tuple[str, str],
    begin: float | None = None,
    end: float | None = None,
) -> None:
    """`names` of the runs. Raises CncError as difference, and 26021 for a page of too long runs."""
    found = difference(first, second, begin, end, names)
    print_difference(found)
    if page is not None:
        from cnc_ptp.plots.comparison import comparison_page

        pair = [selected(read_own(path, found.begin, end), begin=found.begin, end=end) for path in (first, second)]
        on_page = (Path(names[0]).name, Path(names[1]).name)
        write_output(page, comparison_page(*pair, align=RUN, names=on_page))
        print(f"{page}: {Path(page).stat().st_size / 1e6:.1f} MB")


def print_difference(found: RunDifference) -> None:
    """A table of all columns that differ."""
    console = Console(highlight=False, soft_wrap=True)
    console.print(f"compared from {found.begin:g} s to {found.end:g} s", markup=False)
    for note in found.notes:
        console.print(f"note: {note}", markup=False)
    for channel, (one, two) in found.program_times.items():
        console.print(f"program time {channel}: {one:.3f} s -> {two:.3f} s ({two - one:+.3f} s)", markup=False)
    if found.parts_at is None:
        console.print("both runs are equal to the bit in the columns that are compared")
        return
    console.print(f"the runs part at {found.parts_at:g} s")
    table = Table("unit", "column", "largest", "now", "differ by", "at s", "part at s", box=SIMPLE_HEAD, pad_edge=False)
    for column in table.columns:
        column.no_wrap = True
    for row in [row for row in found.rows if row.parted >= 0]:
        numbers = [f"{value:.6g}" for value in (row.first, row.second, row.largest)]
        times = [f"{cycle * found.cycle_time:.3f}" for cycle in (row.cycle, row.parted)]
        table.add_row(row.unit, row.field.replace("_", " "), *numbers, *times)
    console.width = max(console.width, WIDTH)
    console.print(table)
